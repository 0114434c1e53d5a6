#include "maide/join/check_every.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string_view>

#include "maide/base/file.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/check/search/filled.hpp"
#include "maide/check/text/yaml_node.hpp"
#include "maide/check/tree/edit.hpp"
#include "maide/check/verdict/message_account.hpp"
#include "maide/join/check_system_file.hpp"

namespace maide {

Every parse_every(const std::string& text) {
  const auto fail = [&]() -> Every {
    throw UsageError(
        "--every takes CONSTANT=LOW..HIGH, MODEL.depth or MODEL.depth=LOW..HIGH, and "
        "not '" +
        text + "'");
  };
  Every every;
  const std::size_t sign = text.find('=');
  every.name = text.substr(0, sign);
  if (const std::size_t dot = every.name.rfind('.'); dot != std::string::npos) {
    every.option = every.name.substr(dot + 1);
    every.name.resize(dot);
    if (every.option != "depth" && every.option != "size") return fail();
  }
  if (every.name.empty() || (sign == std::string::npos && every.option.empty())) return fail();
  if (sign == std::string::npos) return every;
  const std::string range = text.substr(sign + 1);
  const std::size_t dots = range.find("..");
  if (dots == std::string::npos) return fail();
  const auto low = parse_number<std::int64_t>(range.substr(0, dots));
  const auto high = parse_number<std::int64_t>(range.substr(dots + 2));
  if (!low || !high) return fail();
  if (*low > *high || *high - *low >= most_values) {
    throw UsageError(
        fmt::format("--every {}: the range must have 1 to {} values", text, most_values));
  }
  if (!every.option.empty() && *low < 1) {
    throw UsageError(fmt::format("--every {}: a {} is at least 1", text, every.option));
  }
  every.range = {*low, *high};
  return every;
}

namespace {

using Clock = std::chrono::steady_clock;

// The number in the text of a file that stands at a queue.
class DepthInFile {
 public:
  DepthInFile(const std::string& text, const std::string& file, const Every& every)
      : document_(read_yaml(text, file, "a system file")) {
    for (const std::string_view section : {"models", "topics"}) {
      const YamlNode* const entries = document_.root.find(section);
      if (entries == nullptr) continue;
      for (const YamlEntry& entry : entries->entries) {
        const std::string& key = entry.key.value;
        if (key != every.name && !key.starts_with(every.name + "[")) continue;
        if (entry.value.find("readers_with") != nullptr) {
          throw UsageError(
              fmt::format("readers of {} have a {} of their own: --every takes a "
                          "constant for it ({})",
                          every.name, every.option, file));
        }
        const YamlNode* const use = entry.value.find("use");
        const YamlNode* const with = entry.value.find("with");
        if (use == nullptr || use->value != "queue" || with == nullptr) continue;
        number_ = with->find(every.option);
      }
    }
    if (number_ == nullptr) {
      throw UsageError(
          fmt::format("there is no model or topic '{}' with `use: queue` and a {} ({})", every.name,
                      every.option, file));
    }
  }
  DepthInFile(const DepthInFile&) = delete;
  DepthInFile& operator=(const DepthInFile&) = delete;

  std::string text_with(std::int64_t value) const {
    return with_value(document_, *number_, std::to_string(value));
  }

 private:
  YamlDocument document_;
  const YamlNode* number_ = nullptr;
};

bool is_named(const std::string& model, const std::string& name) {
  return model == name || model.starts_with(name + "[");
}

// Of the queue, and of each wire to it, how many messages each state holds.
FillableQueue fillable(const System& system, std::uint32_t queue, std::int64_t room) {
  FillableQueue result;
  result.room = static_cast<std::uint32_t>(room);
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    const ModelInstance& model = system.models[index];
    FillableQueue::Part part{index, {}};
    if (index == queue) {
      part.held = count_held(system, index);
    } else if (model.source == ModelInstance::Source::wire &&
               is_wire_to(model.name, system.models[queue].name)) {
      part.held = model.held;
      part.held.resize(model.automaton.size());
    } else {
      continue;
    }
    result.parts.push_back(std::move(part));
  }
  return result;
}

// Whether some run fills one of the queues; nothing if that was not found out.
std::optional<bool> is_filled(const System& system, const std::string& name, std::int64_t room,
                              const EngineOptions& options) {
  // A queue whose reader has died may hold what nobody can ask for any more.
  if (std::ranges::any_of(system.programs, &Program::may_die)) return std::nullopt;
  std::vector<FillableQueue> queues;
  bool is_grown = false;
  for (std::uint32_t index = 0; index < system.models.size(); ++index) {
    const ModelInstance& model = system.models[index];
    if (model.source != ModelInstance::Source::built_in || !is_named(model.name, name)) continue;
    queues.push_back(fillable(system, index, room));
    is_grown = is_grown || model.is_grown;
  }
  SearchLimits limits;
  limits.bytes = memory_limit_mib(options) << 20;
  limits.threads = thread_count(options);
  limits.control = options.control;
  const SearchResult result = find_filled(system, queues, limits);
  if (result.end == SearchResult::End::found) return true;
  // What lies behind a cut at a queue with some of its states alone is not known.
  if (result.end != SearchResult::End::complete || (is_grown && result.has_cut)) return {};
  return false;
}

class EveryChecker {
 public:
  EveryChecker(const std::string& path, const Every& every, Engine& engine,
               const CheckRequest& request, const LearnedModelsOptions& models,
               const std::vector<ConstantSetting>& settings)
      : path_(path),
        every_(every),
        engine_(engine),
        request_(request),
        models_(make_learning_source(models)),
        settings_(settings),
        deadline_(request.options.control.deadline),
        text_(read_file(path, request.options.control)) {
    require_fitting(engine, request.options);
    if (!every.option.empty()) depth_.emplace(text_, path, every);
    for (const ConstantSetting& setting : settings) {
      if (every.option.empty() && setting.name == every.name) {
        throw UsageError("--every and --set both say what " + every.name + " is");
      }
    }
  }

  CheckedValues run() {
    using End = CheckedValues::End;
    CheckedValues result{every_, {}, End::range};
    const std::int64_t low = every_.range ? every_.range->first : 1;
    const std::int64_t high = every_.range ? every_.range->second : most_depths;
    for (std::int64_t value = low; value <= high; ++value) {
      if (every_.range && deadline_) {
        const auto now = Clock::now();
        request_.options.control.deadline = now + (*deadline_ - now) / (high - value + 1);
      }
      request_.options.control.report({"checking", 0, 0, 0, static_cast<std::uint64_t>(value - low),
                                       static_cast<std::uint64_t>(high - low + 1)});
      result.values.push_back(check(value));
      const RunControl& control = request_.options.control;
      if (control.stop.stop_requested() || (deadline_ && Clock::now() >= *deadline_)) {
        if (value < high) result.end = End::stopped;
        return result;
      }
      if (!every_.range && result.values.back().is_filled == false) {
        result.end = End::never_filled;
        return result;
      }
    }
    if (!every_.range) result.end = End::limit;
    return result;
  }

 private:
  CheckedValue check(std::int64_t value) try {
    const auto start = Clock::now();
    std::vector<ConstantSetting> settings = settings_;
    if (!depth_) settings.push_back({every_.name, std::to_string(value)});
    CheckedSystem checked = check_system_text(depth_ ? depth_->text_with(value) : text_, path_,
                                              engine_, request_, models_, settings);
    CheckedValue result;
    result.value = value;
    result.report = std::move(checked.report);
    for (const PropertyResult& property : result.report.properties) {
      result.states = std::max(result.states, property.states);
    }
    if (depth_) result.is_filled = is_filled(checked.system, every_.name, value, request_.options);
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return result;
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    throw Error(error.status(),
                fmt::format("with {} = {}: {}", every_.text(), value, error.what()));
  }

  const std::string& path_;
  const Every& every_;
  Engine& engine_;
  CheckRequest request_;
  ModelSource models_;
  const std::vector<ConstantSetting>& settings_;
  std::optional<Clock::time_point> deadline_;
  std::string text_;
  std::optional<DepthInFile> depth_;
};

}  // namespace

CheckedValues check_every(const std::string& path, const Every& every, Engine& engine,
                          const CheckRequest& request, const LearnedModelsOptions& models,
                          const std::vector<ConstantSetting>& settings) {
  return EveryChecker(path, every, engine, request, models, settings).run();
}

}  // namespace maide
