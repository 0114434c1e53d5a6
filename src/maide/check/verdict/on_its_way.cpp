#include "maide/check/verdict/on_its_way.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "maide/base/text.hpp"
#include "maide/check/rules/wire.hpp"

namespace maide {
namespace {

// The step that put the oldest of so many messages on the wire, from 1: messages keep their order.
std::size_t find_sending(const System& system, const Trace& trace, std::uint32_t wire,
                         std::size_t held) {
  for (std::size_t at = trace.steps.size(); at-- > 0;) {
    const Step& step = trace.steps[at];
    if (step.actor == nobody) continue;
    const auto uses = uses_of(system, step);
    const bool sends =
        std::ranges::any_of(uses, [&](const ModelUse& use) { return use.model == wire; });
    const CombinedStep* const combined = combined_step_of(system, step);
    const bool dies = combined != nullptr && combined->role == CombinedStep::Role::death;
    if (sends && !dies && --held == 0) return at + 1;
  }
  return 0;
}

// "map" of a topic with one reader, "map[robot]" of one of several.
std::string target_of(const System& system, const std::string& model) {
  for (const TopicInstance& topic : system.topics) {
    if (topic.readers.size() == 1 && system.models[topic.readers.front().model].name == model) {
      return topic.name;
    }
  }
  return model;
}

}  // namespace

std::vector<std::string> find_on_its_way(const System& system, const Trace& trace,
                                         const std::vector<GlobalState>& states) {
  std::vector<std::string> found;
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    const ModelInstance& model = system.models[index];
    const StateId state = states.back().models[index];
    if (state >= model.state_texts.size()) continue;
    const std::string& text = model.state_texts[state];
    if (model.source == ModelInstance::Source::service) {
      constexpr std::string_view on_its_way = " on its way";
      for (const std::string_view part : split(text, ',')) {
        if (!part.ends_with(on_its_way)) continue;
        const std::string_view what = part.substr(0, part.size() - on_its_way.size());
        found.emplace_back(what.starts_with(' ') ? what.substr(1) : what);
      }
    }
    if (model.source != ModelInstance::Source::wire) continue;
    const std::size_t held = WireModel::count_in(text);
    const std::size_t sign = model.name.find("<-");
    if (held == 0) continue;
    const std::size_t sending = find_sending(system, trace, index, held);
    found.push_back(fmt::format("{} from {} to {}", text, model.name.substr(sign + 2),
                                target_of(system, model.name.substr(0, sign))));
    if (sending != 0) {
      found.back() += fmt::format(", {}sent at step {}", held > 1 ? "the first " : "", sending);
    }
  }
  return found;
}

}  // namespace maide
