#include "maide/check/explore/check_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "maide/automata/strength.hpp"
#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/language/program_syntax.hpp"
#include "maide/check/trace/trace.hpp"

namespace maide {
namespace {

// A use of an input by some program: the first place of each.
struct Use {
  std::uint32_t model = 0;
  Symbol input = 0;
  const Program* program = nullptr;
  const ProgramEdge* edge = nullptr;
};

std::vector<Use> find_uses(const System& system) {
  std::vector<Use> uses;
  std::set<std::tuple<std::uint32_t, Symbol>> seen;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      if (edge.kind != ProgramEdge::Kind::give) continue;
      if (!seen.insert({edge.model, edge.symbol}).second) continue;
      uses.push_back({edge.model, edge.symbol, &program, &edge});
    }
  }
  return uses;
}

bool has_beyond(const InterfaceAutomaton& automaton, Symbol input) {
  for (StateId state = 0; state < automaton.size(); ++state) {
    if (is_beyond_learned(automaton, state, input)) return true;
  }
  return false;
}

std::string input_name(const System& system, const Use& use) {
  const ModelInstance& model = system.models[use.model];
  return model.name + "." + model.automaton.inputs().name(use.input);
}

// What the return of a call is called in models that observe it.
std::string return_name(const std::string& input) { return input == "write" ? "written" : "done"; }

std::optional<std::string> find_hidden_return(const System& system, const std::vector<Use>& uses) {
  for (const Use& use : uses) {
    const InterfaceAutomaton& automaton = system.models[use.model].automaton;
    const std::string& input = automaton.inputs().name(use.input);
    const auto& hidden = automaton.hidden_returns;
    if (std::find(hidden.begin(), hidden.end(), input) == hidden.end()) continue;
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

// Models that some program meets, in the order of the system.
std::vector<const ModelInstance*> find_used_models(const System& system) {
  std::set<std::uint32_t> used;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      if (edge.kind != ProgramEdge::Kind::choice) used.insert(edge.model);
    }
  }
  std::vector<const ModelInstance*> models;
  for (const std::uint32_t index : used) models.push_back(&system.models[index]);
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

// Why a "holds" is none, as far as that is because of weak models.
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
  return property.kind == Property::Kind::ltl && !is_syntactically_safe(property.formula);
}

class Checker {
 public:
  Checker(const System& system, Engine& engine, const CheckRequest& request)
      : system_(system), engine_(engine), options_(request.options), uses_(find_uses(system)) {
    select(request.properties);
  }

  CheckReport run() {
    for (const Property& property : properties_) {
      options_.control.report({"checking", 0, 0, 0, report_.properties.size(), properties_.size()});
      report_.properties.push_back(check(property));
    }
    for (const Verdict verdict : {Verdict::inconclusive, Verdict::violated}) {
      for (const PropertyResult& result : report_.properties) {
        if (result.verdict == verdict) report_.verdict = verdict;
      }
    }
    state_assumptions();
    return std::move(report_);
  }

 private:
  // An error of Maide's own leaves this property undecided, unless its violation was found before,
  // and the others' verdicts alone.
  PropertyResult check(const Property& property) {
    PropertyResult result;
    try {
      result = engine_.check(system_, property, options_);
      if (result.verdict == Verdict::holds) weaken(result);
      if (result.trace) result.trace = with_fewest_switches(system_, property, *result.trace);
    } catch (const Error&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      if (result.verdict == Verdict::holds) result.verdict = Verdict::inconclusive;
      result.name = property.name;
      result.reason = describe_internal_error(error.what());
      result.is_internal_error = true;
    }
    return result;
  }

  void select(const std::vector<std::string>& names) {
    std::set<std::string> seen;
    for (const std::string& name : names) {
      if (seen.insert(name).second) properties_.push_back(find_property(system_, name));
    }
    if (names.empty()) {
      properties_.push_back(find_property(system_, "deadlock"));
      const Property stuck = find_property(system_, "stuck");
      leaves_out_stuck_ = !engine_.obstacle(stuck).empty();
      if (!leaves_out_stuck_) properties_.push_back(stuck);
      properties_.insert(properties_.end(), system_.properties.begin(), system_.properties.end());
    }
    for (const Property& property : properties_) {
      const std::string obstacle = engine_.obstacle(property);
      if (obstacle.empty()) continue;
      const std::string place = to_string(property.position);
      throw UsageError(fmt::format("property '{}': {}{}", property.name, obstacle,
                                   place.empty() ? "" : " (" + place + ")"));
    }
  }

  // A "holds" that leans on something that is not known.
  void weaken(PropertyResult& result) {
    if (!cut_ && result.stays_within_learned) cut_ = CutResult{Verdict::holds, "", std::nullopt};
    if (!cut_) cut_ = engine_.find_cut(system_, options_);
    const std::optional<std::string> hidden = find_hidden_return(system_, uses_);
    std::vector<std::string> reasons;
    if (const auto weakness = find_weakness(system_)) reasons.push_back(*weakness);
    if (cut_->verdict == Verdict::violated) {
      reasons.push_back(describe_cut(*cut_->trace));
    } else if (cut_->verdict == Verdict::inconclusive) {
      reasons.push_back("whether a run goes beyond what was learned: " + cut_->reason);
    } else if (hidden) {
      reasons.push_back(*hidden);
    }
    if (reasons.empty()) return;
    result.reason = join(reasons, "; ");
    result.verdict = Verdict::inconclusive;
  }

  std::string describe_cut(const Trace& trace) const {
    const Step& step = trace.steps.back();
    const Program& program = system_.programs[step.program];
    const ProgramEdge& edge = program.edges[step.edge];
    return fmt::format("{}; {}'s {} at line {} goes beyond",
                       describe_bound(system_.models[edge.model]), program.name,
                       describe_edge(system_, edge), edge.line);
  }

  void state_assumptions() {
    auto& assumptions = report_.assumptions;
    for (const Use& use : uses_) {
      const ModelInstance& model = system_.models[use.model];
      if (model.when_unexplored == WhenUnexplored::stop) continue;
      if (!has_beyond(model.automaton, use.input)) continue;
      assumptions.push_back(fmt::format(
          "{} {} (when_unexplored: {}; {})", input_name(system_, use),
          model.when_unexplored == WhenUnexplored::wait
              ? "waits where it was never tried, until it is possible"
              : "is taken where it was never tried, and changes nothing",
          model.when_unexplored == WhenUnexplored::wait ? "wait" : "drop", describe_bound(model)));
    }
    for (const Property& property : properties_) {
      if (!depends_on_fairness(property)) continue;
      if (property.fairness == Fairness::none) continue;
      const bool is_weak = property.fairness == Fairness::weak;
      assumptions.push_back(fmt::format(
          "{}: {} fairness: no program waits for ever that could go on {}", property.name,
          is_weak ? "weak" : "strong", is_weak ? "all the time" : "again and again"));
    }
    if (const auto hidden = find_hidden_return(system_, uses_)) assumptions.push_back(*hidden);
    for (const ModelInstance& model : system_.models) {
      const std::size_t count = count_inputs_while_due(model.automaton);
      if (count > 0) {
        assumptions.push_back(fmt::format(
            "{} takes no input while an output is due: {} transitions of its file are not used",
            model.name, count));
      }
    }
    state_hypotheses();
    state_strengths();
    std::vector<std::string> reduced;
    for (const PropertyResult& result : report_.properties) {
      if (result.reduction != Reduction::none) reduced.push_back(result.name);
    }
    if (!reduced.empty()) {
      assumptions.push_back(join(reduced) +
                            ": partial-order reduction (--reduction none does without)");
    }
    if (leaves_out_stuck_) {
      assumptions.push_back("stuck was not checked: " +
                            engine_.obstacle(find_property(system_, "stuck")));
    }
  }

  // A line for all models that passed the same tests: instances of one model, mostly.
  void state_hypotheses() {
    std::vector<std::pair<std::string, std::vector<std::string>>> models_of;  // tests
    for (const ModelInstance& model : system_.models) {
      const auto tests = model.automaton.origin.find("tests");
      if (tests == model.automaton.origin.end()) continue;
      const auto known = std::find_if(models_of.begin(), models_of.end(), [&](const auto& entry) {
        return entry.first == tests->second;
      });
      if (known == models_of.end()) {
        models_of.push_back({tests->second, {model.name}});
      } else {
        known->second.push_back(model.name);
      }
    }
    for (const auto& [tests, models] : models_of) {
      report_.assumptions.push_back(
          fmt::format("{} {}: {}", join(models, ", "),
                      models.size() == 1 ? "is a hypothesis" : "are hypotheses", tests));
    }
  }

  // Of the models that are weak, or of which nobody knows whether they are.
  void state_strengths() {
    std::vector<std::string> unknown;
    for (const ModelInstance* model : find_used_models(system_)) {
      const auto stated = find_strength(model->automaton.origin);
      if (!stated) unknown.push_back(model->name);
      if (stated && !stated->is_known()) {
        report_.assumptions.push_back(fmt::format(
            "{}: strength unknown, for the model does not say {}", model->name, stated->unstated));
      }
      if (!stated || !stated->is_weak) continue;
      report_.assumptions.push_back(fmt::format(
          "{} is weak{}: its tests reached {}", model->name,
          model->when_weak == WhenWeak::accept ? " and accepted (when_weak: accept)" : "",
          to_string(stated->strength)));
    }
    if (unknown.empty()) return;
    report_.assumptions.push_back(join(unknown, ", ") +
                                  ": strength unknown, for the model does not say how it was "
                                  "tested");
  }

  const System& system_;
  Engine& engine_;
  const EngineOptions& options_;
  std::vector<Use> uses_;
  std::vector<Property> properties_;
  bool leaves_out_stuck_ = false;
  std::optional<CutResult> cut_;
  CheckReport report_;
};

}  // namespace

Property find_property(const System& system, const std::string& name) {
  Property property;
  property.name = name;
  if (name == "deadlock" || name == "stuck") {
    property.kind = name == "stuck" ? Property::Kind::stuck : Property::Kind::deadlock;
    return property;
  }
  std::vector<std::string> known{"deadlock", "stuck"};
  for (const Property& candidate : system.properties) {
    if (candidate.name == name) return candidate;
    known.push_back(candidate.name);
  }
  throw UsageError(
      fmt::format("there is no property '{}'; there is: {} ({})", name, join(known), system.file));
}

std::string describe_bound(const ModelInstance& model) {
  const auto bound = model.automaton.origin.find("bound");
  if (bound == model.automaton.origin.end()) {
    return model.name + " was learned up to a bound that its file does not name";
  }
  const std::string& text = bound->second;
  const bool is_number = !text.empty() && std::all_of(text.begin(), text.end(),
                                                      [](char c) { return c >= '0' && c <= '9'; });
  if (!is_number) return fmt::format("{} was learned for {}", model.name, text);
  return fmt::format("{} was learned for at most {} message{} in flight", model.name, text,
                     text == "1" ? "" : "s");
}

std::string describe_edge(const System& system, const ProgramEdge& edge) {
  if (edge.kind == ProgramEdge::Kind::choice) return edge.symbol == 0 ? "if *" : "if * ... else";
  const ModelInstance& model = system.models[edge.model];
  switch (edge.kind) {
    case ProgramEdge::Kind::give:
      return model.name + "." + model.automaton.inputs().name(edge.symbol);
    case ProgramEdge::Kind::take:
      return model.name + "!" + model.automaton.outputs().name(edge.symbol);
    default: return model.name + " quiet";
  }
}

ExitStatus exit_status_of(const CheckReport& report) {
  if (report.verdict == Verdict::violated) return ExitStatus::violated;
  if (std::any_of(report.properties.begin(), report.properties.end(),
                  [](const PropertyResult& result) { return result.is_internal_error; })) {
    return ExitStatus::internal;
  }
  return report.verdict == Verdict::holds ? ExitStatus::ok : ExitStatus::inconclusive;
}

CheckReport check_system(const System& system, Engine& engine, const CheckRequest& request) {
  return Checker(system, engine, request).run();
}

}  // namespace maide

// Statements that control never reaches, by structure alone: those behind a `loop`, a `stop`, or a
// statement of which every branch ends in such. What a model never does is not looked at.

namespace maide::program_syntax {
namespace {

class Finder {
 public:
  explicit Finder(const std::string& file) : file_(file) {}

  // Whether control can come to the end of the block.
  bool can_end(const Block& block) {
    bool is_reached = true;
    for (const Statement& statement : block) {
      if (!is_reached) {
        found_.push_back({file_, statement.line, statement.column});
        return false;
      }
      is_reached = can_end(statement);
    }
    return is_reached;
  }

  std::vector<SourcePosition> take() { return std::move(found_); }

 private:
  bool can_end(const Statement& statement) {
    switch (statement.kind) {
      case Statement::Kind::stop: return false;
      case Statement::Kind::loop: can_end(*statement.body); return false;
      case Statement::Kind::repeat: return can_end(*statement.body) || statement.count == 0;
      case Statement::Kind::choice: {
        const bool first = can_end(*statement.body);
        return can_end(*statement.otherwise) || first;
      }
      default: break;
    }
    bool any = statement.arms.empty();
    for (const Arm& arm : statement.arms) any = can_end(*arm.body) || any;
    return any;
  }

  std::string file_;
  std::vector<SourcePosition> found_;
};

}  // namespace

std::vector<SourcePosition> find_unreachable(const Tree& tree, const std::string& file) {
  Finder finder(file);
  finder.can_end(tree.statements);
  std::vector<SourcePosition> found = finder.take();
  std::sort(found.begin(), found.end(), [](const SourcePosition& a, const SourcePosition& b) {
    return std::pair(a.line, a.column) < std::pair(b.line, b.column);
  });
  return found;
}

}  // namespace maide::program_syntax
