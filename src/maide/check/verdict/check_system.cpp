#include "maide/check/verdict/check_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/reduce/reduction.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/assumptions.hpp"
#include "maide/check/verdict/endless_callbacks.hpp"
#include "maide/check/verdict/vacuity.hpp"

namespace maide {
namespace {

// The state at the end of a trace, which an engine found and was held against the meaning. In the
// whole system: what another component does, even an error, is no part of it.
GlobalState last_state(const System& system, const Trace& trace) {
  GlobalState state = initial_state(system);
  for (const Step& step : trace.steps) state = apply(system, state, step);
  return state;
}

// Checks properties of one part of a system, all of whose runs they are about.
class PartChecker {
 public:
  PartChecker(SystemPart part, Engine& engine, const EngineOptions& options)
      : part_(std::move(part)),
        system_(part_.system()),
        engine_(engine),
        options_(options),
        uses_(find_uses(system_)),
        has_errors_(has_errors(system_)) {}
  PartChecker(const PartChecker&) = delete;
  PartChecker& operator=(const PartChecker&) = delete;

  // `of_whole` is a property of the whole system. An error of Maide's own leaves this property
  // undecided, unless its violation was found before, and the others' verdicts alone.
  PropertyResult check(const Property& of_whole) {
    const Property property = part_.property(of_whole);
    PropertyResult result;
    try {
      result = property.kind == Property::Kind::error ? find_error()
                                                      : engine_.check(system_, property, options_);
      if (result.verdict == Verdict::holds) weaken(result, property);
      if (result.trace && !property.is_always_possible) {
        result.trace = with_fewest_switches(system_, property, *result.trace);
      }
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
    if (result.trace) result.trace = to_whole(part_, std::move(*result.trace));
    if (result.remarkable) result.remarkable = to_whole(part_, std::move(*result.remarkable));
    if (!part_.is_whole()) result.programs = part_.programs();
    return result;
  }

  // What could not be decided is looked for again when it is needed.
  void forget_undecided() {
    if (cut_ && cut_->verdict == Verdict::inconclusive) cut_.reset();
    if (error_ && error_->verdict == Verdict::inconclusive) error_.reset();
  }

 private:
  PropertyResult find_error() {
    if (error_) return *error_;
    Property property;
    property.name = "error";
    property.kind = Property::Kind::error;
    PropertyResult result;
    result.name = property.name;
    result.verdict = Verdict::holds;
    if (has_errors_) result = engine_.check(system_, property, options_);
    if (result.trace) result.reason = describe_error(system_, last_state(system_, *result.trace));
    error_ = result;
    return result;
  }

  // Where callbacks go round for ever on fair runs, or may, or run for ever in a spin.
  EndlessLines find_endless() {
    EndlessLines all;
    for (auto& [program, lines] : find_endless_callbacks(system_)) {
      if (!lines.loops.empty() && may_be_endless(program, false)) all.loops.merge(lines.loops);
      if (!lines.spins.empty() && may_be_endless(program, true)) all.spins.merge(lines.spins);
    }
    return all;
  }

  bool may_be_endless(std::uint32_t program, bool spins) {
    const EndlessQuestion asked = ask_whether_endless(system_, program, spins);
    return !engine_.obstacle(asked.system, asked.property).empty() ||
           engine_.check(asked.system, asked.property, options_).verdict != Verdict::holds;
  }

  // A "holds" that leans on something that is not known.
  void weaken(PropertyResult& result, const Property& property) {
    std::vector<std::string> reasons;
    for (const std::string& hole : system_.holes) reasons.push_back("the file leaves out: " + hole);
    if (property.kind == Property::Kind::error) {
      if (!has_errors_ && !has_unknown_code() && reasons.empty()) return;
    } else if (has_errors_) {
      const PropertyResult error = find_error();
      if (error.verdict == Verdict::violated) {
        reasons.push_back("runs end at an error: " + error.reason);
      } else if (error.verdict == Verdict::inconclusive) {
        reasons.push_back("whether a run ends at an error: " + error.reason);
      }
    }
    if (!cut_ && result.stays_within_learned) cut_ = CutResult{Verdict::holds, "", std::nullopt};
    if (!cut_) cut_ = engine_.find_cut(system_, options_);
    const std::optional<std::string> hidden = find_hidden_return(system_, uses_);
    if (const auto weakness = find_weakness(system_)) reasons.push_back(*weakness);
    if (property.kind == Property::Kind::stuck) {
      const EndlessLines lines = find_endless();
      if (!lines.loops.empty() || !lines.spins.empty()) {
        reasons.push_back(describe_endless(lines));
      }
    }
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

  // It may come to an error, too.
  bool has_unknown_code() const {
    return std::ranges::any_of(system_.models, [](const ModelInstance& model) {
      return find_unknown_code(model.automaton).has_value();
    });
  }

  std::string describe_cut(const Trace& trace) const {
    const Step& step = trace.steps.back();
    Trace before = trace;
    before.steps.pop_back();
    for (const ModelUse& use : uses_beyond(system_, last_state(system_, before), step)) {
      const ModelInstance& model = system_.models[use.model];
      if (model.when_unexplored != WhenUnexplored::stop) continue;
      if (find_unknown_code(model.automaton)) return describe_bound(model);
      if (model.automaton.origin.contains("recursive")) {
        return fmt::format(
            "a callback of {} keeps {} over its end at line {}, and which thread "
            "runs the next one is not known",
            actor_name(system_, step.actor), model.name, place_of(system_, step).line);
      }
      return fmt::format("{}; {}'s {} at line {} goes beyond", describe_bound(model),
                         actor_name(system_, step.actor), describe_action(system_, step),
                         place_of(system_, step).line);
    }
    throw std::logic_error("the step does not go beyond what was learned");
  }

  SystemPart part_;
  const System& system_;
  Engine& engine_;
  const EngineOptions& options_;
  std::vector<InputUse> uses_;
  bool has_errors_;
  std::optional<CutResult> cut_;
  std::optional<PropertyResult> error_;
};

constexpr std::size_t most_reasons = 3;  // of components, in one line

// What was found in several components, as one result. Of the first that is violated it has the
// trace.
class Merger {
 public:
  explicit Merger(const std::string& name) {
    whole_.name = name;
    whole_.verdict = Verdict::holds;
    whole_.stays_within_learned = true;
  }

  void add(PropertyResult part) {
    whole_.states += part.states;
    whole_.transitions += part.transitions;
    whole_.seconds += part.seconds;
    whole_.peak_bytes = std::max(whole_.peak_bytes, part.peak_bytes);
    whole_.sent_bytes += part.sent_bytes;
    whole_.reduction = std::max(whole_.reduction, part.reduction);
    whole_.stays_within_learned = whole_.stays_within_learned && part.stays_within_learned;
    whole_.is_internal_error = whole_.is_internal_error || part.is_internal_error;
    if (part.remarkable && !whole_.remarkable) {
      whole_.remarkable = std::move(part.remarkable);
      whole_.programs = part.programs;
    }
    ++count_;
    if (part.verdict == Verdict::violated && ++violated_ > 1) return;
    if (part.verdict == Verdict::violated) {
      whole_.verdict = Verdict::violated;
      whole_.trace = std::move(part.trace);
      whole_.programs = std::move(part.programs);
      reasons_.clear();
      seen_.clear();
    } else if (violated_ > 0) {
      return;
    } else if (part.verdict == Verdict::inconclusive) {
      whole_.verdict = Verdict::inconclusive;
    }
    if (!part.reason.empty() && seen_.insert(part.reason).second) reasons_.push_back(part.reason);
  }

  PropertyResult take() {
    if (violated_ > 1) {
      reasons_.push_back(
          fmt::format("{} of {} components violate it, and the first is shown", violated_, count_));
    }
    const std::size_t more = reasons_.size() - std::min(reasons_.size(), most_reasons);
    if (more > 0) reasons_.resize(most_reasons);
    whole_.reason = join(reasons_, "; ");
    if (more > 0) whole_.reason += fmt::format("; and {} reasons more", more);
    return std::move(whole_);
  }

 private:
  PropertyResult whole_;
  std::size_t count_ = 0, violated_ = 0;  // components
  std::vector<std::string> reasons_;
  std::set<std::string> seen_;
};

class Checker {
 public:
  Checker(const System& system, Engine& engine, const CheckRequest& request)
      : system_(system),
        engine_(engine),
        options_(request.options),
        finds_races_(request.finds_races && engine.name() == "native"),
        awaits_anybody_(awaits_anybody(system)),
        deadline_(request.options.control.deadline),
        uses_(find_uses(system)) {
    select(request.properties);
    components_ = find_components(system);
    for (const auto& component : components_) report_.components.push_back({component, 0, 0, {}});
  }

  CheckReport run() {
    if (finds_races_) find_races();
    std::vector<Late> late;
    for (std::size_t at = 0; at < properties_.size(); ++at) {
      const auto share = take_share(deadline_, properties_.size() - at);
      report_.properties.push_back(check_next(at));
      if (is_late(report_.properties.back())) late.push_back({at, share});
    }
    check_again(late);
    for (const PropertyResult& result : report_.properties) state_remark(result);
    state_lone_time_outs();
    for (std::size_t at = 0; at < properties_.size(); ++at) {
      state_vacuity(properties_[at], report_.properties[at]);
    }
    StatedAssumptions stated = state_assumptions(system_, uses_, properties_, report_.properties);
    for (PropertyResult& result : report_.properties) turn_round(result);
    for (const Verdict verdict : {Verdict::inconclusive, Verdict::violated}) {
      for (const PropertyResult& result : report_.properties) {
        if (result.verdict == verdict) report_.verdict = verdict;
      }
    }
    report_.assumptions = std::move(stated.lines);
    report_.doubts = std::move(stated.doubts);
    report_.brief = std::move(stated.brief);
    if (leaves_out_stuck_) {
      report_.assumptions.push_back("stuck was not checked: " +
                                    engine_.obstacle(system_, find_property(system_, "stuck")));
    }
    return std::move(report_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  // A property that was not decided in the time that it had.
  struct Late {
    std::size_t property = 0;
    Clock::duration share{};
  };

  // Gives the next of `count` things to do its share of the time until `end`.
  Clock::duration take_share(const std::optional<Clock::time_point>& end, std::size_t count) {
    if (!end) return {};
    const Clock::time_point now = Clock::now();
    const Clock::duration share = (*end - now) / static_cast<std::int64_t>(count);
    options_.control.deadline = now + share;
    return share;
  }

  bool is_late(const PropertyResult& result) const {
    const RunControl& control = options_.control;
    return result.verdict == Verdict::inconclusive && control.deadline &&
           !control.stop.stop_requested() && Clock::now() >= *control.deadline;
  }

  void check_again(const std::vector<Late>& late) {
    for (auto& [programs, checker] : checkers_) checker->forget_undecided();
    for (std::size_t i = 0; i < late.size(); ++i) {
      if (take_share(deadline_, late.size() - i) <= late[i].share) return;
      report_.properties[late[i].property] = check_next(late[i].property);
    }
  }

  PropertyResult check_next(std::size_t at) {
    options_.control.report({"checking", 0, 0, 0, at, properties_.size()});
    PropertyResult result = check(properties_[at]);
    result.is_possibility = properties_[at].is_possibility;
    share_run(properties_[at], result);
    return result;
  }

  // What no run does was searched for like a violation.
  static void turn_round(PropertyResult& result) {
    if (!result.is_possibility) return;
    if (result.verdict == Verdict::violated) {
      result.verdict = Verdict::holds;
    } else if (result.verdict == Verdict::holds) {
      result.verdict = Verdict::violated;
      result.reason = "no run comes to it";
    }
  }

  // One cause is shown by one run.
  void share_run(const Property& property, PropertyResult& result) const {
    if (!result.trace) return;
    for (const PropertyResult& before : report_.properties) {
      if (before.name == result.name || !before.trace || before.programs != result.programs ||
          before.trace->steps.size() > result.trace->steps.size()) {
        continue;
      }
      if (!find_flaw_in_parts(system_, property, *before.trace).empty()) continue;
      result.trace = before.trace;
      return;
    }
  }

  bool is_of_each_component(const Property& property) const {
    return property.kind != Property::Kind::ltl && property.kind != Property::Kind::never &&
           components_.size() > 1;
  }

  PropertyResult check(const Property& property) {
    if (!is_of_each_component(property)) {
      return check(property, programs_of(system_, property, components_));
    }
    Merger merger(property.name);
    const auto end = options_.control.deadline;
    for (std::size_t i = 0; i < components_.size(); ++i) {
      take_share(end, components_.size() - i);
      merger.add(check(property, components_[i]));
    }
    options_.control.deadline = end;
    return merger.take();
  }

  // On the runs of those programs.
  PropertyResult check(const Property& property, const std::vector<std::uint32_t>& programs) {
    const bool is_whole = maide::is_whole(system_, programs);
    const bool has_atoms =
        property.kind == Property::Kind::ltl || property.kind == Property::Kind::never;
    PropertyResult result;
    if (has_atoms && (!is_whole || awaits_anybody_)) {
      result =
          PartChecker(SystemPart(system_, programs, &property), engine_, options_).check(property);
    } else {
      auto& checker = checkers_[programs];
      if (!checker) {
        checker = std::make_unique<PartChecker>(
            is_whole ? SystemPart(system_) : SystemPart(system_, programs), engine_, options_);
      }
      result = checker->check(property);
    }
    for (CheckReport::Component& component : report_.components) {
      if (component.programs != programs) continue;
      if (!has_atoms) component.verdicts[property.name] = result.verdict;
      if (component.states > 0) continue;
      component.states = result.states;
      component.transitions = result.transitions;
    }
    return result;
  }

  void select(const std::vector<std::string>& names) {
    std::set<std::string> seen;
    for (const std::string& name : names) {
      for (Property& property : find_properties(system_, name)) {
        if (seen.insert(property.name).second) properties_.push_back(std::move(property));
      }
    }
    const bool has_error = has_errors(system_);
    if (names.empty()) {
      properties_.push_back(find_property(system_, "deadlock"));
      const Property stuck = find_property(system_, "stuck");
      leaves_out_stuck_ = !engine_.obstacle(system_, stuck).empty();
      if (!leaves_out_stuck_) properties_.push_back(stuck);
      if (has_error) properties_.push_back(find_property(system_, "error"));
      properties_.insert(properties_.end(), system_.properties.begin(), system_.properties.end());
    } else if (has_error && !seen.contains("error")) {
      properties_.push_back(find_property(system_, "error"));
    }
    for (const Property& property : properties_) {
      const std::string obstacle = engine_.obstacle(system_, property);
      if (obstacle.empty()) continue;
      const std::string place = to_string(property.position);
      throw UsageError(fmt::format("property '{}': {}{}", property.name, obstacle,
                                   place.empty() ? "" : " (" + place + ")"));
    }
  }

  // The run of a property has a loop in which the program could step, and does not: its sentence
  // says so.
  bool is_shown_to_starve(std::uint32_t index) const {
    return std::ranges::any_of(report_.properties, [&](const PropertyResult& result) {
      if (!result.trace || !result.trace->loop_start) return false;
      GlobalState state = initial_state(system_);
      bool could_step = false;
      for (std::size_t at = 0; at < result.trace->steps.size(); ++at) {
        const Step& step = result.trace->steps[at];
        if (at >= *result.trace->loop_start) {
          if (step.actor == index) return false;
          could_step = could_step || !enabled_steps(system_, state, index).empty();
        }
        state = apply(system_, state, step);
      }
      return could_step;
    });
  }

  // Who starves on weakly fair runs, and is not stuck.
  void state_remark(const PropertyResult& result) {
    if (!result.remarkable) return;
    const Trace& trace = *result.remarkable;
    const GlobalState last = last_state(system_, trace);
    std::vector<bool> steps(system_.programs.size());
    for (std::size_t at = *trace.loop_start; at < trace.steps.size(); ++at) {
      if (trace.steps[at].actor != nobody) steps[trace.steps[at].actor] = true;
    }
    const std::vector<std::uint32_t>& programs =
        result.programs.empty() ? components_.front() : result.programs;
    std::map<int, std::vector<std::string>> starving;  // by the line at which they wait
    for (const std::uint32_t index : programs) {
      const Program& program = system_.programs[index];
      const ControlState at = last.programs[index];
      if (steps[index] || program.edges_of(at).empty() || program.may_rest(at)) continue;
      if (!is_shown_to_starve(index)) {
        starving[program.edges_of(at).front().line].push_back(program.name);
      }
    }
    for (const auto& [line, names] : starving) {
      report_.remarks.push_back(fmt::format(
          "{} may never step again on a run that is weakly fair only, which `stuck` leaves out, as "
          "a property with `fairness: strong` does: {} at line {}, and each time {} could go on, "
          "others are faster",
          first_names(names), names.size() == 1 ? "it waits" : "they wait", line,
          names.size() == 1 ? "it" : "one"));
    }
  }

  // "a, b, c and 6 more".
  static std::string first_names(std::vector<std::string> names) {
    constexpr std::size_t most = 3;
    if (names.size() <= most + 1) return join(names);
    const std::size_t more = names.size() - most;
    names.resize(most);
    return fmt::format("{} and {} more", join(names), more);
  }

  // Whose waiting only a time-out ends: who would be stuck without it. So `stuck` is what is asked,
  // and about as many states are searched as were for it.
  void state_lone_time_outs() {
    const auto stuck = std::ranges::find_if(
        report_.properties, [](const auto& result) { return result.name == "stuck"; });
    if (stuck == report_.properties.end() || !has_time_outs(system_)) return;
    SearchLimits limits;
    limits.bytes = memory_limit_mib(options_) << 20;
    limits.states = std::max(most_lone_states, stuck->states);
    limits.control = options_.control;
    limits.control.deadline = deadline_;
    for (const auto& programs : components_) {
      const SystemPart part =
          is_whole(system_, programs) ? SystemPart(system_) : SystemPart(system_, programs);
      for (const LoneTimeOut& lone : find_lone_time_outs(part.system(), limits)) {
        const Program& program = part.system().programs[lone.program];
        report_.remarks.push_back(
            fmt::format("only its time-out wakes {} from some point on: it {}, and nothing of that "
                        "can come again",
                        program.name, describe_waiting(part.system(), program, lone.arms)));
      }
    }
  }

  // Whose messages come before those of others, whatever that means for the properties. It takes a
  // tenth of the time at most, and comes first: of a system that is too large it is what can be
  // said.
  void find_races() {
    if (!has_late_messages(system_)) return;
    SearchLimits limits;
    limits.states = most_race_states;
    limits.control = options_.control;
    if (deadline_) {
      const Clock::time_point now = Clock::now();
      limits.control.deadline = now + (*deadline_ - now) / 10;
    }
    report_.races = maide::find_races(system_, limits);
  }

  // Why a formula that holds says nothing. That a premise can come true is mostly found at once;
  // that it cannot takes a search of about as many states as the formula's own.
  void state_vacuity(const Property& property, PropertyResult& result) {
    if (result.verdict != Verdict::holds || property.kind != Property::Kind::ltl) return;
    if (property.is_possibility || property.is_always_possible) return;
    if (engine_.name() != "native") return;
    RunControl control = options_.control;
    control.deadline = deadline_;
    try {
      if (holds_of_everything(property.formula, control)) {
        result.reason = "it holds of every run of everything, and says nothing of this system";
        return;
      }
      for (const Premise& premise : premises_of(property.formula)) {
        if (!is_never_met(property, premise, result, control)) continue;
        const std::vector<ProgramInterface> interfaces = system_.interfaces();
        const FormulaScope scope{system_.programs, interfaces, system_.expressions, &system_.words};
        result.reason = "it says nothing here: its premise never comes true where it is asked: " +
                        to_string(premise.premise, scope);
        return;
      }
    } catch (const Interrupted&) {
    }
  }

  bool is_never_met(const Property& property, const Premise& premise, const PropertyResult& result,
                    const RunControl& control) {
    Property denied = property;
    denied.formula = premise.denied;
    const SystemPart part(system_, programs_of(system_, property, components_), &property);
    EngineOptions options = options_;
    options.control = control;
    // A search for a state ends at the first one, and a search for a cycle may go far before.
    const bool is_state = invariant_of(denied) != nullptr;
    options.most_states =
        std::max(most_premise_states, is_state ? result.states : result.states / 64);
    options.shortens = false;
    options.checkpoints.clear();
    const PropertyResult found = engine_.check(part.system(), part.property(denied), options);
    return found.verdict == Verdict::holds;
  }

  static constexpr std::uint64_t most_race_states = 100'000;
  static constexpr std::uint64_t most_premise_states = std::uint64_t{1} << 16;
  static constexpr std::uint64_t most_lone_states = std::uint64_t{1} << 20;

  const System& system_;
  Engine& engine_;
  EngineOptions options_;  // until the end of the share of what is checked
  bool finds_races_ = false;
  bool awaits_anybody_ = false;  // some step does
  std::optional<Clock::time_point> deadline_;
  std::vector<InputUse> uses_;
  std::vector<Property> properties_;
  bool leaves_out_stuck_ = false;
  std::vector<std::vector<std::uint32_t>> components_;
  std::map<std::vector<std::uint32_t>, std::unique_ptr<PartChecker>> checkers_;  // by programs
  CheckReport report_;
};

}  // namespace

namespace {

std::optional<Property> find_built_in(const std::string& name) {
  using Kind = Property::Kind;
  Property property;
  property.name = name;
  if (name != "deadlock" && name != "stuck" && name != "error") return std::nullopt;
  property.kind = name == "stuck" ? Kind::stuck : name == "error" ? Kind::error : Kind::deadlock;
  return property;
}

UsageError no_such_property(const System& system, const std::string& name) {
  std::vector<std::string> known{"deadlock", "stuck", "error"};
  for (const Property& candidate : system.properties) known.push_back(candidate.name);
  return UsageError(fmt::format("there is no property '{}'; there is: {}{} ({})", name, join(known),
                                did_you_mean(name, known), system.file));
}

}  // namespace

Property find_property(const System& system, const std::string& name) {
  if (const auto built_in = find_built_in(name)) return *built_in;
  for (const Property& candidate : system.properties) {
    if (candidate.name == name) return candidate;
  }
  throw no_such_property(system, name);
}

std::vector<Property> find_properties(const System& system, const std::string& name) {
  if (const auto built_in = find_built_in(name)) return {*built_in};
  std::vector<Property> instances;
  for (const Property& candidate : system.properties) {
    if (candidate.name == name) return {candidate};
    if (candidate.name.starts_with(name + "[")) instances.push_back(candidate);
  }
  if (instances.empty()) throw no_such_property(system, name);
  return instances;
}

std::string find_flaw_in_parts(const System& system, const Property& property, const Trace& trace) {
  const bool has_atoms =
      property.kind == Property::Kind::ltl || property.kind == Property::Kind::never;
  std::vector<std::vector<std::uint32_t>> candidates = find_components(system);
  if (has_atoms) candidates = {programs_of(system, property, candidates)};
  std::string flaw = "its steps are of several components";
  for (const auto& programs : candidates) {
    const bool is_within = std::ranges::all_of(trace.steps, [&](const Step& step) {
      return step.actor == nobody || std::ranges::binary_search(programs, step.actor);
    });
    if (!is_within) continue;
    const SystemPart part(system, programs, &property);
    if (!std::ranges::all_of(trace.steps, [&](const Step& step) { return part.has(step); })) {
      continue;
    }
    flaw = find_flaw(part.system(), part.property(property), from_whole(part, trace));
    if (flaw.empty()) break;
  }
  return flaw;
}

Shown shown_part(const System& system, const PropertyResult& result) {
  const Property property = find_property(system, result.name);
  SystemPart part(system, result.programs, &property);
  Trace trace = from_whole(part, *result.trace);
  Property of_part = part.property(property);
  return {std::move(part), std::move(of_part), std::move(trace)};
}

std::vector<std::string> all_remarks(const System& system, const CheckReport& report) {
  std::vector<std::string> remarks = system.remarks;
  if (!system.settings.empty()) {
    remarks.insert(remarks.begin(),
                   "constants have other values than in the file: " + to_string(system.settings));
  }
  remarks.insert(remarks.end(), report.remarks.begin(), report.remarks.end());
  return remarks;
}

std::string describe_verdict(const PropertyResult& result) {
  if (!result.is_possibility || result.verdict == Verdict::inconclusive) {
    return to_string(result.verdict);
  }
  return result.verdict == Verdict::holds ? "possible" : "not possible";
}

ExitStatus exit_status_of(const CheckReport& report) {
  if (report.verdict == Verdict::violated) return ExitStatus::violated;
  if (std::ranges::any_of(report.properties, &PropertyResult::is_internal_error)) {
    return ExitStatus::internal;
  }
  return report.verdict == Verdict::holds ? ExitStatus::ok : ExitStatus::inconclusive;
}

CheckReport check_system(const System& system, Engine& engine, const CheckRequest& request) {
  return Checker(system, engine, request).run();
}

const PropertyResult* find_same_run(const CheckReport& report, const PropertyResult& result) {
  for (const PropertyResult& before : report.properties) {
    if (&before == &result) break;
    if (before.trace && before.programs == result.programs &&
        before.trace->steps == result.trace->steps &&
        before.trace->loop_start == result.trace->loop_start) {
      return &before;
    }
  }
  return nullptr;
}

}  // namespace maide
