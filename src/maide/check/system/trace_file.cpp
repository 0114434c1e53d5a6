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
  return fmt::format("{} line {} {}{}", step.program, step.line, step.model, step.event);
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
    text.program = member(step, "program");
    text.event = member(step, "event");
    const auto model = step.find("model");
    if (model != step.end() && !model->is_null()) text.model = member(step, "model");
    const auto line = step.find("line");
    if (line == step.end() || !line->is_number_integer()) fail("there is no number 'line'");
    const auto number = line->get<std::int64_t>();  // of one beyond it, something negative
    if (number < 0 || number > std::numeric_limits<int>::max()) fail("'line' is no line's number");
    text.line = static_cast<int>(number);
    check_names(text);
    return text;
  }

  // Names that are nowhere say more than a step that is not possible.
  void check_names(const StepText& text) const {
    const auto is_named = [](const auto& list, const std::string& name) {
      return std::any_of(list.begin(), list.end(), [&](const auto& it) { return it.name == name; });
    };
    if (!is_named(system_.programs, text.program)) {
      fail(fmt::format("there is no program '{}' in {}", text.program, system_.file));
    }
    if (!text.model.empty() && !is_named(system_.models, text.model)) {
      fail(fmt::format("there is no model '{}' in {}", text.model, system_.file));
    }
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
        const bool is_known = std::any_of(next.begin(), next.end(), [&](const Node& other) {
          return other.entry == node.entry && other.state == node.state;
        });
        if (!is_known) next.push_back(std::move(node));
      }
    }
    if (next.empty()) {
      std::sort(possible.begin(), possible.end());
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

  // The path to one of the last states; with a loop, to one at which it closes.
  void finish(Trace& trace) const {
    const auto& last = layers_.back();
    const auto found = std::find_if(last.begin(), last.end(), [&](const Node& node) {
      return !loop_start_ || layers_[*loop_start_][node.entry].state == node.state;
    });
    if (found == last.end()) {
      throw UsageError(fmt::format("the steps from {} on do not come back to where they began ({})",
                                   *loop_start_ + 1, file_));
    }
    trace.loop_start = loop_start_;
    trace.steps.resize(layers_.size() - 1);
    const Node* node = &*found;
    for (std::size_t at = trace.steps.size(); at > 0; --at) {
      trace.steps[at - 1] = node->step;
      node = &layers_[at - 1][node->parent];
    }
  }

  const std::string& file_;
  const System& system_;
  std::optional<std::size_t> loop_start_;
  std::vector<std::vector<Node>> layers_;  // what may be after each step
};

}  // namespace

StepText describe_step(const System& system, const Step& step) {
  using Kind = ProgramEdge::Kind;
  const Program& program = system.programs[step.program];
  const ProgramEdge& edge = program.edges[step.edge];
  StepText text{program.name, edge.line, "", ""};
  if (edge.kind == Kind::combined) {
    const auto& events = program.combined[edge.symbol].events;
    const bool is_of_one = std::all_of(events.begin(), events.end(), [&](const ModelUse& event) {
      return event.model == events.front().model;
    });
    if (events.empty() || !is_of_one) {
      text.event = program.combined[edge.symbol].text;
      return text;
    }
    const InterfaceAutomaton& automaton = system.models[events.front().model].automaton;
    text.model = system.models[events.front().model].name;
    for (const ModelUse& event : events) {
      text.event += event.kind == Kind::give ? "?" + automaton.inputs().name(event.symbol)
                                             : "!" + automaton.outputs().name(event.symbol);
    }
    return text;
  }
  if (edge.kind == Kind::choice) {
    text.event = edge.symbol == 0 ? "if" : "else";
    return text;
  }
  const ModelInstance& instance = system.models[edge.model];
  if (edge.kind == Kind::act) {
    text.event = instance.actions[edge.symbol].name;
    return text;
  }
  text.model = instance.name;
  if (edge.kind == Kind::give) text.event = "?" + instance.automaton.inputs().name(edge.symbol);
  if (edge.kind == Kind::take) text.event = "!" + instance.automaton.outputs().name(edge.symbol);
  if (edge.kind == Kind::quiet) text.event = "quiet";
  return text;
}

std::vector<ChangedValue> find_changes(const System& system, const GlobalState& before,
                                       const GlobalState& after, std::uint32_t program) {
  std::vector<ChangedValue> changes;
  const Program& own = system.programs[program];
  for (std::uint32_t index = 0; index < own.variables.size(); ++index) {
    const auto value = own.value_of(after.programs[program], index);
    const auto old = own.value_of(before.programs[program], index);
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

Json step_to_json(const StepText& step) {
  return {{"program", step.program},
          {"line", step.line},
          {"model", step.model.empty() ? Json() : Json(step.model)},
          {"event", step.event}};
}

Json trace_to_json(const System& system, const Trace& trace) {
  Json steps = Json::array();
  const std::vector<GlobalState> states = replay(system, trace);
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    Json step = step_to_json(describe_step(system, trace.steps[at]));
    for (const ChangedValue& changed :
         find_changes(system, states[at], states[at + 1], trace.steps[at].program)) {
      step["values"][changed.name] = to_json(changed, system.words);
    }
    steps.push_back(std::move(step));
  }
  return steps;
}

Json trace_file_to_json(const System& system, const std::string& property, const Trace& trace) {
  return {{"system", system.file},
          {"property", property},
          {"steps", trace_to_json(system, trace)},
          {"loop_start", trace.loop_start ? Json(*trace.loop_start) : Json()}};
}

TraceFile parse_trace(std::string_view text, const std::string& file, const System& system) {
  return TraceReader(file, system).read(parse_json(text, file));
}

TraceFile read_trace(const std::string& path, const System& system, const RunControl& control) {
  return parse_trace(read_file(path, control), path, system);
}

}  // namespace maide
