#include "maide/check/system/trace_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

constexpr std::size_t max_steps = 10'000'000;

std::string to_string(const StepText& step) {
  const std::string actor = step.actor.empty() ? "nobody" : step.actor;
  const std::string place = step.line == 0 ? "" : fmt::format(" line {}", step.line);
  return fmt::format("{}{} {}{}", actor, place, step.model, step.event);
}

// Whatever the order.
bool is_same(std::vector<ConstantSetting> left, std::vector<ConstantSetting> right) {
  std::ranges::sort(left, {}, &ConstantSetting::name);
  std::ranges::sort(right, {}, &ConstantSetting::name);
  return left == right;
}

std::string describe(const std::vector<ConstantSetting>& settings) {
  return settings.empty() ? "the file's values of all constants" : maide::to_string(settings);
}

// Walks along the text through all states that the steps named so far may have led to.
class TraceReader {
 public:
  TraceReader(const std::string& file, const System& system) : file_(file), system_(system) {
    layers_.push_back({{initial_state(system), {}, 0, 0}});
  }

  TraceFile read(const Json& root) {
    if (!root.is_object() || !root.contains("steps") || !root["steps"].is_array()) {
      throw UsageError("no trace: it must be an object with 'steps' (" + file_ + ")");
    }
    read_version(root);
    if (const auto settings = settings_of_trace(root, file_);
        !is_same(settings, system_.settings)) {
      throw UsageError(fmt::format("the trace was found with {}, and not with {} ({})",
                                   describe(settings), describe(system_.settings), file_));
    }
    const Json& steps = root["steps"];
    if (steps.size() > max_steps) throw UsageError("a trace has too many steps (" + file_ + ")");
    read_loop_start(root, steps.size());
    for (const Json& step : steps) take(read_step(step));
    TraceFile result;
    if (const auto property = root.find("property");
        property != root.end() && property->is_string()) {
      result.property = property->get<std::string>();
    }
    finish(result.trace);
    return result;
  }

 private:
  struct Node {
    GlobalState state;
    Step step;               // that led to it
    std::size_t parent = 0;  // in the layer before
    std::size_t entry = 0;   // where it entered the loop, in that layer
  };

  [[noreturn]] void fail(const std::string& message) const {
    throw UsageError(fmt::format("step {}: {} ({})", layers_.size(), message, file_));
  }

  void read_version(const Json& root) {
    const auto version = root.find("version");
    if (version == root.end()) return;
    if (version->is_number_unsigned()) version_ = version->get<std::uint64_t>();
    if (version_ >= 1 && version_ <= trace_file_version && version->is_number_unsigned()) return;
    throw UsageError(fmt::format("a trace of version {}; this maide reads up to version {} ({})",
                                 version->dump(), trace_file_version, file_));
  }

  std::string member(const Json& step, const char* name) const {
    const auto found = step.find(name);
    if (found == step.end() || !found->is_string()) {
      fail(fmt::format("there is no text '{}'", name));
    }
    return found->get<std::string>();
  }

  StepText read_step(const Json& step) const {
    if (!step.is_object()) fail("it must be an object");
    StepText text;
    const char* const who = version_ == 1 ? "program" : "actor";
    const auto actor = step.find(who);
    if (actor == step.end() || !actor->is_null()) text.actor = member(step, who);
    text.event = member(step, "event");
    const auto model = step.find("model");
    if (model != step.end() && !model->is_null()) text.model = member(step, "model");
    const auto line = step.find("line");
    if (line != step.end() && line->is_null()) return checked(std::move(text));
    if (line == step.end() || !line->is_number_integer()) fail("there is no number 'line'");
    const auto number = line->get<std::int64_t>();  // of one beyond it, something negative
    if (number < 0 || number > std::numeric_limits<int>::max()) fail("'line' is no line's number");
    text.line = static_cast<int>(number);
    return checked(std::move(text));
  }

  // Names that are nowhere say more than a step that is not possible.
  StepText checked(StepText text) const {
    const auto is_named = [](const auto& list, const std::string& name) {
      return std::ranges::any_of(list, [&](const auto& it) { return it.name == name; });
    };
    if (!text.actor.empty() && !is_named(system_.programs, text.actor)) {
      fail(fmt::format("there is no program '{}' in {}", text.actor, system_.file));
    }
    if (!text.model.empty() && !is_named(system_.models, text.model)) {
      fail(fmt::format("there is no model '{}' in {}", text.model, system_.file));
    }
    return text;
  }

  void take(const StepText& text) {
    std::vector<Node> next;
    std::vector<std::string> possible;
    for (std::size_t parent = 0; parent < layers_.back().size(); ++parent) {
      const GlobalState& state = layers_.back()[parent].state;
      for (const Step& step : enabled_steps(system_, state)) {
        const StepText candidate = describe_step(system_, step);
        if (candidate != text) {
          possible.push_back(to_string(candidate));
          continue;
        }
        const bool is_entry = loop_start_ == layers_.size() - 1;
        Node node{apply(system_, state, step), step, parent,
                  is_entry ? parent : layers_.back()[parent].entry};
        const bool is_known = std::ranges::any_of(next, [&](const Node& other) {
          return other.entry == node.entry && other.state == node.state;
        });
        if (!is_known) next.push_back(std::move(node));
      }
    }
    if (next.empty()) {
      std::ranges::sort(possible);
      possible.erase(std::unique(possible.begin(), possible.end()), possible.end());
      fail(fmt::format("{} is not possible in {}; possible: {}", to_string(text), system_.file,
                       possible.empty() ? "nothing" : join(possible)));
    }
    layers_.push_back(std::move(next));
  }

  void read_loop_start(const Json& root, std::size_t steps) {
    const auto start = root.find("loop_start");
    if (start == root.end() || start->is_null()) return;
    if (!start->is_number_unsigned() || start->get<std::uint64_t>() >= steps) {
      throw UsageError("'loop_start' must be the index of a step (" + file_ + ")");
    }
    loop_start_ = start->get<std::size_t>();
  }

  // The path to one of the last states; with a loop, to one at which it closes, or else to one from
  // which it goes on.
  void finish(Trace& trace) const {
    const auto& last = layers_.back();
    const auto found = std::ranges::find_if(last, [&](const Node& node) {
      return !loop_start_ || layers_[*loop_start_][node.entry].state == node.state;
    });
    if (found != last.end()) {
      trace = path_to(*found);
      return;
    }
    for (const Node& node : last) {
      trace = path_to(node);
      std::vector<GlobalState> states{initial_state(system_)};
      for (const Step& step : trace.steps) states.push_back(apply(system_, states.back(), step));
      if (closed(system_, trace, states)) return;
    }
    throw UsageError(fmt::format("the steps from {} on do not come back to where they began ({})",
                                 *loop_start_ + 1, file_));
  }

  Trace path_to(const Node& last) const {
    Trace trace;
    trace.loop_start = loop_start_;
    trace.steps.resize(layers_.size() - 1);
    const Node* node = &last;
    for (std::size_t at = trace.steps.size(); at > 0; --at) {
      trace.steps[at - 1] = node->step;
      node = &layers_[at - 1][node->parent];
    }
    return trace;
  }

  const std::string& file_;
  const System& system_;
  std::uint64_t version_ = 1;
  std::optional<std::size_t> loop_start_;
  std::vector<std::vector<Node>> layers_;  // what may be after each step
};

}  // namespace

std::vector<ConstantSetting> settings_of_trace(const Json& trace, const std::string& file) {
  std::vector<ConstantSetting> settings;
  if (!trace.is_object() || !trace.contains("set")) return settings;
  const Json& set = trace["set"];
  const auto is_text = [](const Json& value) { return value.is_string(); };
  if (!set.is_object() || !std::ranges::all_of(set, is_text)) {
    throw UsageError("'set' must name constants, each with its value as a text (" + file + ")");
  }
  for (const auto& [name, value] : set.items()) {
    settings.push_back({name, value.get<std::string>()});
  }
  return settings;
}

std::vector<ChangedValue> find_changes(const System& system, const GlobalState& before,
                                       const GlobalState& after, std::uint32_t actor) {
  std::vector<ChangedValue> changes;
  const std::size_t variables = actor == nobody ? 0 : system.programs[actor].variables.size();
  for (std::uint32_t index = 0; index < variables; ++index) {
    const Program& own = system.programs[actor];
    const auto value = own.value_of(after.programs[actor], index);
    const auto old = own.value_of(before.programs[actor], index);
    if (!value || value == old) continue;
    changes.push_back({own.variables[index].name, *value, own.variables[index].type.kind, old});
  }
  for (std::size_t model = 0; model < system.models.size(); ++model) {
    const ModelInstance& shared = system.models[model];
    if (shared.source != ModelInstance::Source::variable) continue;
    if (before.models[model] == after.models[model]) continue;
    changes.push_back({shared.name, shared.type.at(after.models[model]), shared.type.kind,
                       shared.type.at(before.models[model])});
  }
  return changes;
}

namespace {

Json to_json(const ChangedValue& changed, const WordTable& words) {
  switch (changed.kind) {
    case ValueKind::boolean: return changed.value != 0;
    case ValueKind::word: return words.name(changed.value);
    case ValueKind::integer:
    case ValueKind::unknown: break;
  }
  return changed.value;
}

}  // namespace

namespace {

// `who`: the name of the member that has the actor.
Json to_json(const StepText& step, const char* who) {
  return {{who, step.actor.empty() ? Json() : Json(step.actor)},
          {"line", step.line == 0 ? Json() : Json(step.line)},
          {"model", step.model.empty() ? Json() : Json(step.model)},
          {"event", step.event}};
}

Json to_json(const SourcePosition& origin) {
  Json place{{"file", origin.file}, {"line", origin.line}};
  if (origin.column != 0) place["column"] = origin.column;
  return place;
}

// What is on its way, by wire; null: nothing.
Json find_on_its_way(const System& system, const GlobalState& state) {
  Json found;
  for (std::size_t index = 0; index < system.models.size(); ++index) {
    const ModelInstance& wire = system.models[index];
    if (wire.source != ModelInstance::Source::wire) continue;
    if (state.models[index] >= wire.state_texts.size()) continue;
    const std::string& text = wire.state_texts[state.models[index]];
    if (!text.empty()) found[wire.name] = text;
  }
  return found;
}

Json to_json(const System& system, const Trace& trace, const char* who) {
  Json steps = Json::array();
  const std::vector<GlobalState> states = replay(system, trace);
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const Step& taken = trace.steps[at];
    Json step = to_json(describe_step(system, taken), who);
    for (const ChangedValue& changed :
         find_changes(system, states[at], states[at + 1], taken.actor)) {
      step["values"][changed.name] = to_json(changed, system.words);
    }
    if (const auto origin = origin_of(system, taken)) step["origin"] = to_json(*origin);
    if (Json found = find_on_its_way(system, states[at + 1]); !found.is_null()) {
      step["on_its_way"] = std::move(found);
    }
    if (std::string lost = lost_by(system, taken); !lost.empty()) step["lost"] = std::move(lost);
    steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace

Json step_to_json(const StepText& step) { return to_json(step, "program"); }

Json trace_to_json(const System& system, const Trace& trace) {
  return to_json(system, trace, "program");
}

Json trace_file_to_json(const System& system, const std::string& property, const Trace& trace) {
  Json file{{"version", trace_file_version}, {"system", system.file}};
  for (const auto& [name, value] : system.settings) file["set"][name] = value;
  file["property"] = property;
  file["steps"] = to_json(system, trace, "actor");
  file["loop_start"] = trace.loop_start ? Json(*trace.loop_start) : Json();
  return file;
}

TraceFile parse_trace(std::string_view text, const std::string& file, const System& system) {
  return TraceReader(file, system).read(parse_json(text, file));
}

TraceFile read_trace(const std::string& path, const System& system, const RunControl& control) {
  return parse_trace(read_file(path, control), path, system);
}

}  // namespace maide
