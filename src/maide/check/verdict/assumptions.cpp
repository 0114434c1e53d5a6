#include "maide/check/verdict/assumptions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <tuple>
#include <utility>

#include "maide/automata/strength.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/model_words.hpp"

namespace maide {
namespace {

bool has_beyond(const InterfaceAutomaton& automaton, Symbol input) {
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (is_beyond_learned(automaton, state, input)) return true;
  }
  return false;
}

std::string input_name(const System& system, const InputUse& use) {
  const ModelInstance& model = system.models[use.model];
  return model.name + "." + model.automaton.inputs().name(use.input);
}

// What the return of a call is called in models that observe it.
std::string return_name(const std::string& input) { return input == "write" ? "written" : "done"; }

// Models that some program meets, in the order of the system.
std::set<std::uint32_t> find_used(const System& system) {
  std::set<std::uint32_t> used;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& use : program.uses_of(edge)) {
        used.insert(use.model);
      }
    }
  }
  return used;
}

// Those of them that come from files or were learned.
std::vector<const ModelInstance*> find_used_models(const System& system) {
  std::vector<const ModelInstance*> models;
  for (const std::uint32_t index : find_used(system)) {
    const ModelInstance& model = system.models[index];
    if (model.source == ModelInstance::Source::file) models.push_back(&model);
  }
  return models;
}

bool is_weak(const ModelInstance& model) {
  const auto stated = find_strength(model.automaton.origin);
  return stated && stated->is_weak;
}

// What to do for a model that is stronger.
std::string describe_strengthening(const ModelInstance& model) {
  if (model.is_learned)
    return "write `learning: {effort: 10}`, or more, at the model, without `eq` and `max-tests`";
  const auto sul = model.automaton.origin.find("sul");
  const std::string file = quote_shell_word(model.origin);
  return fmt::format("run `maide learn {} --start-from {} -o {} --effort 10`, or more",
                     sul == model.automaton.origin.end() ? "SUL" : sul->second, file, file);
}

// Inputs that a model has in states where an output is due: the meaning of systems leaves them out.
std::size_t count_inputs_while_due(const InterfaceAutomaton& automaton) {
  std::size_t count = 0;
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (automaton.is_quiescent(state)) continue;
    for (const auto& transition : automaton.transitions(state)) {
      count += transition.action.is_input() ? 1 : 0;
    }
  }
  return count;
}

// Whether a run that is not fair might violate the property.
bool depends_on_fairness(const Property& property) {
  if (property.kind == Property::Kind::never) return true;
  if (property.is_always_possible) return false;
  return property.kind == Property::Kind::ltl && !is_syntactically_safe(property.formula);
}

// Gathers what verdicts rest on.
class AssumptionList {
 public:
  AssumptionList(const System& system, const std::vector<InputUse>& uses)
      : system_(system), uses_(uses) {}

  StatedAssumptions state(const std::vector<Property>& properties,
                          const std::vector<PropertyResult>& results) {
    state_holes();
    state_unexplored();
    state_fairness(properties);
    if (const auto hidden = find_hidden_return(system_, uses_)) doubt(*hidden);
    state_inputs_while_due();
    state_hypotheses();
    state_strengths();
    state_unreal();
    state_middlewares();
    state_discovery();
    state_deliveries();
    state_best_effort();
    state_executors();
    state_callbacks_that_are_not_run(results);
    state_time_outs(results);
    state_reduction(results);
    return {std::move(lines_), std::move(doubts_), std::move(brief_)};
  }

 private:
  void doubt(const std::string& line) {
    lines_.push_back(line);
    doubts_.push_back(line);
  }

  // What a violation may rest on, too.
  void state_holes() {
    for (const std::string& hole : system_.holes) doubt("the file leaves out: " + hole);
  }

  void state_unexplored() {
    for (const InputUse& use : uses_) {
      const ModelInstance& model = system_.models[use.model];
      if (model.when_unexplored == WhenUnexplored::stop) continue;
      if (!has_beyond(model.automaton, use.input)) continue;
      lines_.push_back(fmt::format("{} {} (when_unexplored: {}; {})", input_name(system_, use),
                                   model.when_unexplored == WhenUnexplored::wait
                                       ? "waits where it was never tried, until it is possible"
                                       : "is taken where it was never tried, and changes nothing",
                                   model.when_unexplored == WhenUnexplored::wait ? "wait" : "drop",
                                   describe_bound(model)));
    }
  }

  void state_fairness(const std::vector<Property>& properties) {
    for (const Property& property : properties) {
      if (!depends_on_fairness(property)) continue;
      if (property.fairness == Fairness::none) continue;
      const bool is_weak = property.fairness == Fairness::weak;
      lines_.push_back(fmt::format("{}: {} fairness: no program waits for ever that could go on {}",
                                   property.name, is_weak ? "weak" : "strong",
                                   is_weak ? "all the time" : "again and again"));
    }
  }

  void state_inputs_while_due() {
    for (const ModelInstance& model : system_.models) {
      if (model.source != ModelInstance::Source::file) continue;
      const std::size_t count = count_inputs_while_due(model.automaton);
      if (count > 0) {
        lines_.push_back(fmt::format(
            "{} takes no input while an output is due: {} transitions of its file are not used",
            model.name, count));
      }
    }
  }

  // A line for all models that passed the same tests: instances of one model, mostly.
  void state_hypotheses() {
    std::vector<std::pair<std::string, std::vector<std::string>>> models_of;  // tests
    std::map<std::string, std::string> strengths;                             // by tests
    for (const ModelInstance& model : system_.models) {
      const auto tests = model.automaton.origin.find("tests");
      if (tests == model.automaton.origin.end()) continue;
      // Values that no test gave are said in full.
      const bool has_rule = model.automaton.origin.contains("values");
      if (const auto stated = find_strength(model.automaton.origin); stated && !has_rule) {
        strengths.emplace(tests->second, to_string(stated->strength));
      }
      const auto known = std::ranges::find_if(
          models_of, [&](const auto& entry) { return entry.first == tests->second; });
      if (known == models_of.end()) {
        models_of.push_back({tests->second, {model.name}});
      } else {
        known->second.push_back(model.name);
      }
    }
    for (const auto& [tests, models] : models_of) {
      lines_.push_back(fmt::format("{} {}: {}", join(models, ", "),
                                   models.size() == 1 ? "is a hypothesis" : "are hypotheses",
                                   tests));
      const auto strength = strengths.find(tests);
      if (strength == strengths.end()) continue;
      brief_[lines_.back()] =
          fmt::format("{}: {} as its tests ({})", join(models, ", "),
                      models.size() == 1 ? "as good" : "each as good", strength->second);
    }
  }

  // Says which models are weak, and of which nobody knows whether they are.
  void state_strengths() {
    std::vector<std::string> unknown;
    for (const ModelInstance* model : find_used_models(system_)) {
      const auto stated = find_strength(model->automaton.origin);
      if (!stated) unknown.push_back(model->name);
      if (stated && !stated->is_known()) {
        doubt(fmt::format("{}: strength unknown, for the model does not say {}", model->name,
                          stated->unstated));
      }
      if (!stated || !stated->is_weak) continue;
      doubt(fmt::format(
          "{} is weak{}: its tests reached {}", model->name,
          model->when_weak == WhenWeak::accept ? " and accepted (when_weak: accept)" : "",
          to_string(stated->strength)));
    }
    if (unknown.empty()) return;
    doubt(join(unknown, ", ") + ": strength unknown, for the model does not say how it was tested");
  }

  // Built-in models and shared variables.
  void state_unreal() {
    const std::set<std::uint32_t> used = find_used(system_);
    for (const std::string& line : describe_unreal(system_, {used.begin(), used.end()})) {
      lines_.push_back(line);
    }
  }

  // Over what ROS 2 ran where models were learned from it.
  void state_middlewares() {
    constexpr std::string_view key = " rmw=";
    std::map<std::string, std::vector<std::string>> models;
    for (const ModelInstance* model : find_used_models(system_)) {
      if (!is_learned_from_ros2(*model)) continue;
      const std::string& sul = model->automaton.origin.at("sul");
      const std::size_t at = sul.find(key);
      if (at == std::string::npos) continue;
      const std::size_t begin = at + key.size();
      models[sul.substr(begin, sul.find(' ', begin) - begin)].push_back(model->name);
    }
    for (const auto& [rmw, names] : models) {
      lines_.push_back(fmt::format("{} {} learned from rclcpp over {}", join(names, ", "),
                                   names.size() == 1 ? "was" : "were", rmw));
    }
  }

  // Callbacks run by rules; and programs that use what has callbacks in reality have none.
  void state_executors() {
    std::map<std::string, std::set<std::string>> nodes;  // by execution
    std::set<std::string> programs, models;
    bool has_timer = false;
    for (const Program& program : system_.programs) {
      nodes[program.execution].insert(program.nodes.begin(), program.nodes.end());
      for (const ProgramEdge& edge : program.edges) {
        has_timer = has_timer || program.role_of(edge) == CombinedStep::Role::timer;
        const auto note = [&](const ModelUse& use) {
          const ModelInstance& model = system_.models[use.model];
          if (!program.nodes.empty() || !is_of_nodes(model)) return;
          programs.insert(program.name);
          models.insert(model.name);
        };
        std::ranges::for_each(program.uses_of(edge), note);
        std::ranges::for_each(program.events_of(edge), note);  // it sends, and that arrives later
      }
    }
    nodes.erase("");
    for (const auto& [execution, of_it] : nodes) {
      lines_.push_back(fmt::format("the callbacks of {} run {} (the rules of executors)",
                                   fmt::join(of_it, ", "), execution));
    }
    state_order_of_groups();
    if (has_timer) lines_.emplace_back("time is not modelled: a timer may be due at any moment");
    if (programs.empty()) return;
    lines_.push_back(fmt::format(
        "{} {} {} without executors: callbacks that wait, their order and threads are not looked "
        "at (`nodes:` does)",
        fmt::join(programs, ", "), programs.size() == 1 ? "uses" : "use", fmt::join(models, ", ")));
  }

  // What runs callbacks is a program for `stuck`, and a callback is none.
  void state_callbacks_that_are_not_run(const std::vector<PropertyResult>& results) {
    const bool holds = std::ranges::any_of(results, [](const auto& result) {
      return result.name == "stuck" && result.verdict == Verdict::holds;
    });
    std::set<std::string> names;
    for (const Program& program : system_.programs) {
      std::set<std::uint32_t> callbacks;
      for (const CombinedStep& combined : program.combined) {
        if (combined.callback) callbacks.insert(*combined.callback);
      }
      if (callbacks.size() > 1) names.insert(program.nodes.begin(), program.nodes.end());
    }
    if (!holds || names.empty()) return;
    lines_.push_back(fmt::format(
        "stuck: of {} it is looked at whether callbacks run, not whether each does (a formula says "
        "`G F node.callback@label`)",
        fmt::join(names, ", ")));
  }

  // rclcpp's order among groups is that of their addresses.
  void state_order_of_groups() {
    using Group = std::pair<std::string, std::string>;  // of a node
    std::map<std::pair<std::uint32_t, CallbackInstance::Kind>, std::set<Group>> groups;
    for (const CallbackInstance& callback : system_.callbacks) {
      groups[{callback.executor, callback.kind}].emplace(callback.node, callback.group);
    }
    std::set<std::string> executors;
    for (const auto& [place, of_kind] : groups) {
      const ExecutorInstance& executor = system_.executors[place.first];
      if (executor.goes_by_rounds && of_kind.size() > 1) executors.insert(executor.name);
    }
    if (executors.empty()) return;
    lines_.push_back(fmt::format(
        "{}: callbacks of one kind in several groups or nodes come in the file's order; rclcpp's "
        "is that of addresses, which no program controls (`order: any` covers all)",
        fmt::join(executors, ", ")));
  }

  // Those who use it in reality are callbacks.
  static bool is_of_nodes(const ModelInstance& model) {
    const bool is_rule = model.source == ModelInstance::Source::service;
    const bool is_asked_for = model.is_learned && model.origin == "ros2";  // of unknown depth, too
    return is_rule || is_asked_for || is_learned_from_ros2(model);
  }

  static bool is_learned_from_ros2(const ModelInstance& model) {
    const auto sul = model.automaton.origin.find("sul");
    return model.source == ModelInstance::Source::file && sul != model.automaton.origin.end() &&
           sul->second.starts_with("ros2 ");
  }

  // Ends that come while the system runs count from the moment at which both sides know them.
  void state_discovery() {
    std::set<std::string> names;
    for (const Program& program : system_.programs) {
      for (const ProgramEdge& edge : program.edges) {
        for (const ModelUse& use : program.uses_of(edge)) {
          if (use.kind != ModelUse::Kind::give) continue;
          const ModelInstance& model = system_.models[use.model];
          const std::string& input = model.automaton.inputs().name(use.index);
          const bool makes_end = input == "start" || input == "subscribe";
          if (makes_end && is_learned_from_ros2(model)) names.insert(model.name);
        }
      }
    }
    if (!names.empty()) {
      lines_.push_back(fmt::format(
          "{}: an end that comes is there when both sides know it; what is lost before (a request, "
          "an answer, a message) is not looked at",
          fmt::join(names, ", ")));
    }
    state_presence();
    state_open_ends();
    std::vector<std::string> meeting;
    for (const TopicInstance& topic : system_.topics) {
      if (topic.meets) meeting.push_back(topic.name);
    }
    if (!meeting.empty()) {
      lines_.push_back(fmt::format(
          "{}: each writer and reader meet some time after the start, on fair runs surely",
          some_of(meeting)));
    }
    const std::size_t others = system_.topics.size() - meeting.size() + system_.services.size();
    if (system_.callbacks.empty() || others == 0) return;
    lines_.push_back(
        fmt::format("nodes begin when all {}ends know each other: what is lost before, at the "
                    "start, is not looked at (`discovery: any` at a topic does)",
                    meeting.empty() ? "" : "other "));
  }

  // What is said of whom the file does not know.
  void state_open_ends() {
    for (const std::string& line : system_.open_ends) lines_.push_back(line);
  }

  // Servers of which no text says that they come or go.
  void state_presence() {
    std::vector<std::string> names;
    for (const ServiceInstance& service : system_.services) {
      const auto is_server = [&](const Program& program) {
        return program.name == service.server ||
               std::ranges::find(program.nodes, service.server) != program.nodes.end();
      };
      const bool may_die = std::ranges::any_of(system_.programs, [&](const Program& program) {
        return is_server(program) && program.may_die();
      });
      const std::string presence = presence_of(service.name);
      const bool may_come =
          std::ranges::find(system_.models, presence, &ModelInstance::name) != system_.models.end();
      if (!may_die && !may_come) names.push_back(service.name);
    }
    if (names.empty()) return;
    lines_.push_back(fmt::format(
        "{}: {} there from the beginning and never dies (`offer` and `may_die` say otherwise)",
        some_of(names), names.size() == 1 ? "the server is" : "each server is"));
  }

  // "a, b", or of many "a, b, ..., and 90 more".
  static std::string some_of(const std::vector<std::string>& names) {
    constexpr std::size_t most = 8;
    if (names.size() <= most) return join(names, ", ");
    return fmt::format("{}, and {} more", fmt::join(names.begin(), names.begin() + most, ", "),
                       names.size() - most);
  }

  // When messages arrive, by what the file and its models say.
  void state_deliveries() {
    std::vector<std::string> late, losing;
    std::map<std::string, std::vector<std::string>> at_once;  // by the reason
    for (const ConnectionInstance& connection : system_.connections) {
      if (!connection.is_late) {
        if (!connection.why.empty()) at_once[connection.why].push_back(connection.name);
      } else {
        (connection.loses ? losing : late).push_back(connection.name);
      }
    }
    if (!late.empty()) {
      lines_.push_back(
          fmt::format("{}: what is sent arrives some time later, in order; that a network loses "
                      "nothing is taken for granted",
                      some_of(late)));
    }
    if (!losing.empty()) {
      lines_.push_back(fmt::format("{}: what is sent arrives some time later, in order, or is lost",
                                   some_of(losing)));
    }
    if (const std::vector<std::string> names = find_acknowledged(); !names.empty()) {
      lines_.push_back(
          fmt::format("{}: a call returns when all readers have what it sent", some_of(names)));
    }
    for (const auto& [why, names] : at_once) {
      lines_.push_back(fmt::format("{}: what is sent arrives at once ({})", some_of(names), why));
    }
  }
  // The connections on which a call may end with an arrival.
  std::vector<std::string> find_acknowledged() const {
    std::set<std::string> names;
    for (const Program& program : system_.programs) {
      for (const CombinedStep& step : program.combined) {
        if (step.role != CombinedStep::Role::arrival) continue;
        names.insert(step.text.substr(0, step.text.find_first_of("[!")));
      }
    }
    return {names.begin(), names.end()};
  }

  void state_best_effort() {
    std::set<std::string> names;
    for (const std::uint32_t number : find_used(system_)) {
      const ModelInstance& model = system_.models[number];
      const bool is_late = std::ranges::any_of(system_.models, [&](const ModelInstance& wire) {
        return wire.source == ModelInstance::Source::wire && is_wire_to(wire.name, model.name);
      });
      if (is_late) continue;  // what may be lost is said
      for (const char* key : {"sul", "reliability"}) {
        const auto said = model.automaton.origin.find(key);
        if (said == model.automaton.origin.end()) continue;
        if (said->second.find("best_effort") != std::string::npos) names.insert(model.name);
      }
    }
    if (names.empty()) return;
    lines_.push_back(fmt::format(
        "{}: best_effort, as where nothing is lost on the way; a network loses messages",
        fmt::join(names, ", ")));
  }

  void state_time_outs(const std::vector<PropertyResult>& results) {
    const bool holds = std::ranges::any_of(
        results, [](const auto& result) { return result.verdict == Verdict::holds; });
    std::set<int> lines;
    for (const Program& program : system_.programs) {
      for (const ProgramEdge& edge : program.edges) {
        if (program.role_of(edge) == CombinedStep::Role::timeout) lines.insert(edge.line);
      }
    }
    if (!holds || lines.empty()) return;
    const bool is_one = lines.size() == 1;
    lines_.push_back(fmt::format(
        "time is not modelled: the time-out{} at line{} {} may come as soon as nothing else can",
        is_one ? "" : "s", is_one ? "" : "s", fmt::join(lines, ", ")));
  }

  void state_reduction(const std::vector<PropertyResult>& results) {
    std::vector<std::string> reduced;
    for (const PropertyResult& result : results) {
      if (result.reduction != Reduction::none) reduced.push_back(result.name);
    }
    if (!reduced.empty()) {
      lines_.push_back(join(reduced) + ": partial-order reduction (--reduction none does without)");
    }
  }

  const System& system_;
  const std::vector<InputUse>& uses_;
  std::vector<std::string> lines_, doubts_;
  std::map<std::string, std::string> brief_;
};

}  // namespace

std::vector<InputUse> find_uses(const System& system) {
  std::vector<InputUse> uses;
  std::set<std::tuple<std::uint32_t, Symbol>> seen;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& event : program.events_of(edge)) {
        if (event.kind != ModelUse::Kind::give) continue;
        if (!seen.insert({event.model, event.index}).second) continue;
        uses.push_back({event.model, event.index, &program, &edge});
      }
    }
  }
  return uses;
}

std::optional<std::string> find_hidden_return(const System& system,
                                              const std::vector<InputUse>& uses) {
  for (const InputUse& use : uses) {
    const InterfaceAutomaton& automaton = system.models[use.model].automaton;
    const std::string& input = automaton.inputs().name(use.input);
    const auto& hidden = automaton.hidden_returns;
    if (std::ranges::find(hidden, input) == hidden.end()) continue;
    std::vector<std::string> observed = automaton.outputs().names();
    observed.push_back(return_name(input));
    return fmt::format(
        "{}'s {} at line {} really blocks, and the model of {} does not show when it returns: "
        "learn "
        "with observe={}, write `{} -> {};`",
        use.program->name, input_name(system, use), use.edge->line, system.models[use.model].name,
        fmt::join(observed, ","), input_name(system, use), return_name(input));
  }
  return std::nullopt;
}

std::optional<std::string> find_weakness(const System& system) {
  std::vector<std::string> names;
  const ModelInstance* first = nullptr;
  for (const ModelInstance* model : find_used_models(system)) {
    if (!is_weak(*model) || model->when_weak == WhenWeak::accept) continue;
    if (first == nullptr) first = model;
    names.push_back(model->name);
  }
  if (first == nullptr) return std::nullopt;
  return fmt::format(
      "it leans on {} ({}), whose tests may have missed a part of the system: {}, or write "
      "`when_weak: accept` there",
      names.size() == 1 ? "a weak model" : "weak models", join(names),
      describe_strengthening(*first));
}

StatedAssumptions state_assumptions(const System& system, const std::vector<InputUse>& uses,
                                    const std::vector<Property>& properties,
                                    const std::vector<PropertyResult>& results) {
  return AssumptionList(system, uses).state(properties, results);
}

}  // namespace maide
