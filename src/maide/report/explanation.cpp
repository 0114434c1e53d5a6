#include "maide/report/explanation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/text.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/atom_view.hpp"
#include "maide/check/verdict/message_account.hpp"
#include "maide/check/verdict/on_its_way.hpp"
#include "maide/check/verdict/waiting.hpp"
#include "maide/report/ways_out_text.hpp"

namespace maide {
namespace {

using Operator = FormulaNode::Operator;

class Violation {
 public:
  Violation(const System& system, const Trace& trace, const std::vector<GlobalState>& states)
      : system_(system), trace_(trace), states_(states), interfaces_(system.interfaces()) {
    const bool loops = trace.loop_start.has_value();
    length_ = states.size() + (loops ? 0 : 1);
    loop_ = loops ? *trace.loop_start + 1 : length_ - 1;
  }

  // Why the formula is `value` at the position.
  std::string why(const Formula& formula, std::size_t at, bool value) {
    const auto left = [&](std::size_t where, bool wanted) {
      return why(formula->left, where, wanted);
    };
    switch (formula->op) {
      case Operator::negation: return left(at, !value);
      case Operator::next: return left(at + 1 < length_ ? at + 1 : loop_, value);
      case Operator::conjunction:
      case Operator::disjunction: return why_of_two(formula, at, value);
      case Operator::implication:
        if (value) return holds(formula, at, true);
        return left(at, true) + ", but " + why(formula->right, at, false);
      case Operator::globally:
        if (value) return text(formula->left) + " holds for ever " + from(at);
        return left(first(at, [&](std::size_t i) { return !truth(formula->left)[i]; }), false);
      case Operator::finally:
        if (!value) return never(formula->left, at);
        return left(first(at, [&](std::size_t i) { return truth(formula->left)[i]; }), true);
      case Operator::until:
      case Operator::weak_until: return why_until(formula, at, value);
      case Operator::release: return why_release(formula, at, value);
      default: return holds(formula, at, value);
    }
  }

 private:
  const std::vector<bool>& truth(const Formula& formula) {
    const auto [place, is_new] = truths_.try_emplace(formula.get());
    if (is_new) place->second = evaluate_on_run(system_, formula, trace_, states_);
    return place->second;
  }

  // The first position from `at` on, in the order of the run.
  std::optional<std::size_t> find_first(std::size_t at,
                                        const std::function<bool(std::size_t)>& is_it) const {
    for (std::size_t i = at; i < length_; ++i) {
      if (is_it(i)) return i;
    }
    for (std::size_t i = loop_; i < at; ++i) {
      if (is_it(i)) return i;
    }
    return std::nullopt;
  }

  // find_first(), or `at` itself where only what follows a cut would show it.
  std::size_t first(std::size_t at, const std::function<bool(std::size_t)>& is_it) const {
    return find_first(at, is_it).value_or(at);
  }

  std::string text(const Formula& formula) const {
    std::string result =
        to_string(formula, {system_.programs, interfaces_, system_.expressions, &system_.words});
    if (result.starts_with('(')) result = result.substr(1, result.size() - 2);
    return result;
  }

  std::string where(std::size_t at) const {
    if (at == 0) return "at the start";
    return at > trace_.steps.size() ? "at the end" : fmt::format("after step {}", at);
  }
  std::string from(std::size_t at) const {
    return at == 0                    ? "from the start"
           : at > trace_.steps.size() ? "from the end on"
                                      : fmt::format("from step {} on", at);
  }

  std::string holds(const Formula& formula, std::size_t at, bool value) const {
    const bool is_event = formula->op == Operator::atom && formula->atom.is_event();
    if (is_event && value) return fmt::format("step {} is {}", at, text(formula));
    return text(formula) + (value ? " holds " : " does not hold ") + where(at);
  }

  std::string never(const Formula& formula, std::size_t at) {
    if (formula->op == Operator::negation) {
      return text(formula->left) + " holds always " + from(at);
    }
    if (formula->op == Operator::globally) {  // fails again and again
      const std::size_t place =
          first(loop_, [&](std::size_t i) { return !truth(formula->left)[i]; });
      const std::string reason = why(formula->left, place, false);
      return place >= trace_.steps.size() + 1 ? reason : "again and again, " + reason;
    }
    return text(formula) + " never holds" + (at == 0 ? "" : " " + from(at));
  }

  // && and ||, either of which may be wanted true or false.
  std::string why_of_two(const Formula& formula, std::size_t at, bool value) {
    const bool one_is_enough = (formula->op == Operator::disjunction) == value;
    const auto is = [&](const Formula& part) { return truth(part)[at] == value; };
    if (one_is_enough) {
      return why(is(formula->left) ? formula->left : formula->right, at, value);
    }
    return why(formula->left, at, value) + ", and " + why(formula->right, at, value);
  }

  std::string why_until(const Formula& formula, std::size_t at, bool value) {
    const auto& left = truth(formula->left);
    const auto& right = truth(formula->right);
    const auto end = find_first(at, [&](std::size_t i) { return right[i] || !left[i]; });
    if (!end) return value ? holds(formula, at, true) : never(formula->right, at);
    if (value) return why(formula->right, *end, true);
    return why(formula->left, *end, false) + ", before " + text(formula->right) + " holds";
  }

  std::string why_release(const Formula& formula, std::size_t at, bool value) {
    if (value) return holds(formula, at, true);
    const std::size_t end = first(at, [&](std::size_t i) { return !truth(formula->right)[i]; });
    return why(formula->right, end, false) + ", and " + text(formula->left) +
           " did not hold before";
  }

  const System& system_;
  const Trace& trace_;
  const std::vector<GlobalState>& states_;
  std::vector<ProgramInterface> interfaces_;
  std::size_t length_ = 0, loop_ = 0;
  std::map<const FormulaNode*, std::vector<bool>> truths_;
};

}  // namespace

std::string describe_violation(const System& system, const Formula& formula, const Trace& trace,
                               const std::vector<GlobalState>& states) {
  return Violation(system, trace, states).why(formula, 0, false);
}

namespace {

using Kind = ProgramEdge::Kind;
using Reason = Waiting::Reason;
using Loss = MessageAccount::Loss;

constexpr std::size_t most_clauses = 4;  // of programs that wait, in one sentence

// What it is called to have given an input, and to give it.
std::string past_of(const std::string& input) {
  const std::string word = input.substr(0, input.find('('));
  return word == "write" ? "wrote" : word == "publish" ? "published" : "gave " + input;
}

class Sentence {
 public:
  Sentence(const System& system, const Trace& trace)
      : system_(system), trace_(trace), states_(replay(system, trace)) {}

  std::string write(const Property& property) {
    if (property.kind == Property::Kind::error) return describe_error(states_.back());
    std::string end = trace_.loop_start ? describe_loop() : describe_end();
    if (is_weakly_fair_only(property)) end += "; `fairness: strong` leaves such runs out";
    if (property.kind == Property::Kind::never) {
      const std::string accepted = property.name + " accepts this run, which must never happen";
      return end.empty() ? accepted : accepted + ": " + end;
    }
    if (property.kind != Property::Kind::ltl) return end;
    std::string violation = describe_violation(system_, property.formula, trace_, states_);
    // What comes after a bad prefix does not matter; a promise that is not kept has its reason.
    if (end.empty() || is_syntactically_safe(property.formula)) return violation;
    return violation + ": " + end + describe_losses(end);
  }

  std::string write_waiting(std::uint32_t index) const {
    std::vector<Clause> clauses;
    add_clause(find_waiting(system_, trace_, states_, states_.size() - 1, index), states_.back(),
               clauses);
    return clauses.front().text("; ");
  }

  // Of a run that another property was told of: its own violation, and what keeps the programs from
  // stepping that could change what the formula sees, if the other sentence does not begin with it.
  std::string write_again(const Property& property, const std::string& same) const {
    if (property.kind != Property::Kind::ltl) return same;
    std::string text = describe_violation(system_, property.formula, trace_, states_) + ": ";
    if (is_syntactically_safe(property.formula)) return text + same;
    const std::string end = trace_.loop_start ? describe_loop() : describe_end();
    std::vector<std::string> causes;
    const std::vector<std::uint32_t> watched = watched_programs(property);
    for (const std::uint32_t index : watched) {
      for (const Clause& clause : describe_those_that_stand({index})) {
        if (end.starts_with(clause.text("; "))) return text + same;
      }
    }
    for (const Clause& clause : describe_those_that_stand(watched)) {
      std::string cause = clause.text("; ");
      if (end.starts_with(cause)) return text + same;
      if (causes.size() < most_own_causes) causes.push_back(std::move(cause));
    }
    return text + (causes.empty() ? same : list_words(causes, "; and ") + "; " + same);
  }

 private:
  static constexpr std::size_t most_own_causes = 2;

  // Programs with a step that may change an atom of the formula.
  std::vector<std::uint32_t> watched_programs(const Property& property) const {
    const std::vector<Atom> atoms = atoms_of(property);
    const std::vector<AtomView> views = views_of(atoms, system_);
    std::vector<std::uint32_t> programs;
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) {
      const auto edges = static_cast<std::uint32_t>(system_.programs[index].edges.size());
      for (std::uint32_t edge = 0; edge < edges; ++edge) {
        if (!is_visible(views, index, edge)) continue;
        programs.push_back(index);
        break;
      }
    }
    return programs;
  }

  // In the end, or all the time in the loop.
  bool stands_still(std::uint32_t index) const {
    if (!trace_.loop_start) {
      const auto blocked = blocked_programs(system_, states_.back());
      return is_deadlock(system_, states_.back()) &&
             std::ranges::find(blocked, index) != blocked.end();
    }
    const Program& program = system_.programs[index];
    const ControlState at = states_.back().programs[index];
    if (program.is_end(at) || program.may_rest(at)) return false;
    const auto loop = std::span(trace_.steps).subspan(*trace_.loop_start);
    return std::ranges::none_of(loop, [&](const Step& step) { return step.actor == index; });
  }

  // The property is about weakly fair runs, and this one is not strongly fair.
  bool is_weakly_fair_only(const Property& property) const {
    const bool has_fairness =
        property.kind == Property::Kind::ltl || property.kind == Property::Kind::never;
    if (!has_fairness || property.fairness != Fairness::weak || !trace_.loop_start) return false;
    return !is_fair(system_, trace_, states_, Fairness::strong);
  }

  const std::string& program(std::uint32_t index) const { return system_.programs[index].name; }
  const ModelInstance& model(const Waiting& waiting) const { return system_.models[waiting.model]; }

  std::string programs(const std::vector<std::uint32_t>& indices) const {
    std::vector<std::string> names;
    for (const std::uint32_t index : indices) names.push_back(program(index));
    return list_words(names);
  }

  std::string input_name(std::uint32_t model, Symbol input) const {
    return file_word(system_, model, system_.models[model].automaton.inputs().name(input));
  }

  std::string input_names(std::uint32_t model, const std::vector<Symbol>& inputs) const {
    std::vector<std::string> names;
    for (const Symbol input : inputs) names.push_back(input_name(model, input));
    return list_words(without_values(names), " or ");
  }

  std::string output_names(const Waiting& waiting, const std::vector<Symbol>& outputs) const {
    std::vector<std::string> names;
    for (const Symbol output : outputs) {
      const std::string& name = model(waiting).automaton.outputs().name(output);
      names.push_back(file_word(system_, waiting.model, name));
    }
    return list_words(without_values(names), " or ");
  }

  std::vector<Symbol> awaited_outputs(const Waiting& waiting) const {
    std::vector<Symbol> outputs;
    for (const ProgramEdge& edge : waiting.awaited) {
      if (edge.kind == Kind::take) outputs.push_back(edge.index);
    }
    return outputs;
  }

  // What comes out are messages, and not answers of other kinds.
  bool is_about_messages(const Waiting& waiting) const {
    const auto outputs = awaited_outputs(waiting);
    return std::ranges::any_of(outputs, [&](Symbol output) {
      return is_message_name(model(waiting).automaton.outputs().name(output));
    });
  }

  // "waits at line 13 for message 2 of 6 from via"
  std::string what_is_awaited(const Waiting& waiting) const {
    if (waiting.reason == Reason::several) {
      std::vector<Program::Guard> guards;
      for (const WayOut& way : waiting.ways) {
        if (way.guard) guards.push_back(*way.guard);
      }
      if (guards.empty() && waiting.awaited.empty()) {
        return system_.programs[waiting.program].may_die() ? "can do nothing but die"
                                                           : "waits for what never comes";
      }
      return describe_waiting(system_, system_.programs[waiting.program], waiting.awaited, guards);
    }
    const ProgramEdge& first = waiting.awaited.front();
    const std::string& name = model(waiting).name;
    const std::string of_all = fmt::format("{} of {}", waiting.number, waiting.rounds);
    const std::string in_round =
        waiting.rounds == 0 || waiting.is_once_a_round
            ? ""
            : fmt::format(" in round {} of {}", waiting.round, waiting.rounds);
    const std::string in_brackets = waiting.is_once_a_round ? " (" + of_all + ")" : in_round;
    std::string text =
        fmt::format("waits at {} ", system_.programs[waiting.program].place_of(first.line));
    if (first.kind == Kind::give) {
      const std::string input = input_name(waiting.model, first.index);
      return text + fmt::format("to give {}.{}", name, input) + in_brackets;
    }
    if (is_about_messages(waiting)) {
      const std::string which = waiting.rounds == 0 ? "a message"
                                : waiting.is_once_a_round
                                    ? "message " + of_all
                                    : fmt::format("message {}", waiting.number);
      return fmt::format("{}for {} from {}{}", text, which, name, in_round);
    }
    const auto outputs = awaited_outputs(waiting);
    if (outputs.empty()) return text + "until " + name + " is quiet";
    return text + "for " + output_names(waiting, outputs) + " of " + name + in_brackets;
  }

  // The input that the step gives to the model.
  Symbol given_input(std::uint32_t model, const Step& step) const {
    // What arrives is no event of the connection, which the sending was.
    const bool arrives = doer_of(system_, step) == nobody;
    const auto events = arrives ? uses_of(system_, step) : events_of(system_, step);
    const auto event = std::ranges::find_if(
        events, [&](const ModelUse& use) { return use.kind == Kind::give && use.model == model; });
    MAIDE_CHECK(event != events.end());
    return event->index;
  }

  // The first loss, before which it is known which messages the model held: "message 1, overwritten
  // when planner wrote message 2 before message 1 was read (step 2)".
  std::string describe_loss(std::uint32_t index, const MessageAccount& account) const {
    const Loss& loss = account.losses.front();
    const Step& step = trace_.steps[loss.step];
    const auto& messages = account.messages;
    const ModelInstance& model = system_.models[index];
    const Symbol given = given_input(index, step);
    const std::string who = doer_of(system_, step) == nobody
                                ? ""
                                : fmt::format("{} {}", describe_actor(system_, step),
                                              past_of(input_name(index, given)));
    // "when planner wrote message 2", "when message 2 arrived".
    const auto when = [&](const std::string& message) {
      return who.empty() ? fmt::format("when {} arrived", message)
                         : fmt::format("when {} {}", who, message);
    };
    const std::string place = fmt::format("(step {})", loss.step + 1);
    if (std::ranges::find(messages, given) == messages.end()) {
      return fmt::format("{}, when {} {}", counted(loss.count, "message"),
                         who.empty() ? "one arrived" : who, place);
    }
    const std::string last = fmt::format("message {}", loss.given);
    if (step.is_beyond) {
      return fmt::format("{}, which was never tried there and is taken to be dropped {}", last,
                         place);
    }
    if (loss.held == 0 || loss.held >= loss.given) {
      return fmt::format("one {}, which made no difference to {} {}", when(last), model.name,
                         place);
    }
    const std::size_t oldest = loss.given - loss.held;
    const std::string unread =
        loss.held == 1 ? fmt::format("message {} was read", oldest)
                       : fmt::format("any of messages {} to {} was read", oldest, loss.given - 1);
    const std::string how = fmt::format("{} before {} {}", when(last), unread, place);
    switch (loss.which) {
      case Loss::Which::oldest: return fmt::format("message {}, overwritten {}", oldest, how);
      case Loss::Which::newest: return fmt::format("{}, dropped {}", last, how);
      case Loss::Which::unknown: break;
    }
    return loss.held == 1 ? fmt::format("message {} or {}, {}", oldest, loss.given, how)
                          : fmt::format("one of messages {} to {}, {}", oldest, loss.given, how);
  }

  // "planner wrote 6, 1 was read and 5 were lost, the first ..."
  std::string describe_account(std::uint32_t index, const MessageAccount& account) const {
    if (account.given == 0) return "";
    const std::string verb = past_of(input_names(index, account.messages));
    const std::string givers = programs({account.givers.begin(), account.givers.end()});
    // Of messages with values it is said that they are counted, and not listed.
    const std::string given = account.messages.size() == 1 ? std::to_string(account.given)
                                                           : counted(account.given, "message");
    std::string text = fmt::format("{} {} {}", givers, verb, given);
    const std::size_t lost = account.lost();
    const auto were = [](std::size_t count) { return count == 1 ? "was" : "were"; };
    if (lost == 0 && account.given == account.taken) {
      return text + (account.given == 1 ? ", and it was read" : ", and all were read");
    }
    std::vector<std::string> parts{text};
    if (account.taken > 0)
      parts.push_back(fmt::format("{} {} read", account.taken, were(account.taken)));
    if (lost > 0) parts.push_back(fmt::format("{} {} lost", lost, were(lost)));
    text = list_words(parts);
    if (lost == 0) return text;
    return text + (lost > 1 ? ", first " : ": ") + describe_loss(index, account);
  }

  // What was lost and `told` does not say: "; image[detector]: camera wrote 12, 10 were read ...".
  std::string describe_losses(const std::string& told) const {
    std::string text;
    for (const auto& [index, account] : find_losses(system_, trace_, states_)) {
      const std::string losses = describe_account(index, account);
      if (told.find(losses) == std::string::npos) {
        text += fmt::format("; {}: {}", system_.models[index].name, losses);
      }
    }
    return text;
  }

  // What would help: "writes there", "gives fork.release", "takes it".
  std::string help_verb(const Waiting& waiting) const {
    if (waiting.reason == Reason::output_due) return "take it";
    const std::string inputs = input_names(waiting.model, waiting.wanted);
    return inputs == "write" ? "write to " + model(waiting).name
                             : fmt::format("give {}.{}", model(waiting).name, inputs);
  }

  // Who could change it: "p1 has ended", "nobody else would write to q1".
  std::string describe_helpers(const Waiting& waiting, const GlobalState& state) const {
    if (waiting.reason == Reason::several) return describe_ways_out(system_, waiting);
    if (waiting.wanted.empty()) return "nothing that programs do there would change that";
    if (waiting.helpers.empty()) return "no other program would ever " + help_verb(waiting);
    if (!waiting.reachable_helpers.empty()) {
      const bool is_only = waiting.helpers.size() == 1;
      return fmt::format("{}{} would {}", is_only ? "only " : "",
                         programs(waiting.reachable_helpers), help_verb(waiting));
    }
    std::vector<std::uint32_t> ended, others;
    for (const std::uint32_t helper : waiting.helpers) {
      const bool is_end = system_.programs[helper].is_end(state.programs[helper]);
      (is_end ? ended : others).push_back(helper);
    }
    std::vector<std::string> parts;
    if (!ended.empty()) {
      parts.push_back(
          fmt::format("{} {} ended", programs(ended), ended.size() == 1 ? "has" : "have"));
    }
    if (!others.empty()) {
      parts.push_back(fmt::format("{} will never {} again", programs(others), help_verb(waiting)));
    }
    return list_words(parts);
  }

  // What the model does instead: "via holds none: ..."
  std::string describe_model(const Waiting& waiting) const {
    const std::string& name = model(waiting).name;
    const std::string maker =
        waiting.cause ? describe_actor(system_, trace_.steps[*waiting.cause]) : std::string();
    const std::size_t step = waiting.cause.value_or(0) + 1;
    switch (waiting.reason) {
      case Reason::output_due:
        return fmt::format("{} has {} due{} and does nothing else until that is taken", name,
                           output_names(waiting, waiting.due),
                           waiting.cause ? fmt::format(" since step {} of {}", step, maker) : "");
      case Reason::busy:
        if (model(waiting).source == ModelInstance::Source::built_in) {
          return describe_refusal_of(waiting);
        }
        return name + " takes none now" +
               (waiting.cause ? fmt::format(": the call that {} made at step {} has not returned",
                                            maker, step)
                              : "");
      case Reason::bound: return describe_bound(model(waiting)) + ", and there it waits";
      case Reason::several:  // the ways out say it
      case Reason::nothing_due: break;
    }
    if (!waiting.account || !is_about_messages(waiting)) return name + " has nothing to give";
    if (waiting.account->held > 0) {
      return fmt::format("{} holds {}, but was not asked for it", name, waiting.account->held);
    }
    const std::string account = describe_account(waiting.model, *waiting.account);
    return account.empty() ? name + " was given none" : name + " holds none: " + account;
  }

  // Why a built-in model refuses: "fork[2] is held: p[2] locked it at step 1", "q is full".
  std::string describe_refusal_of(const Waiting& waiting) const {
    const Symbol symbol = waiting.awaited.front().index;
    std::string text = model(waiting).name + " " + describe_refusal(model(waiting), symbol);
    const std::string& input = model(waiting).automaton.inputs().name(symbol);
    const char* done = input == "lock"      ? "locked it"
                       : input == "unlock"  ? "unlocked it"
                       : input == "acquire" ? "acquired the last"
                       : input == "release" ? "released the last"
                       : input == "read"    ? "reads it since"
                                            : nullptr;
    if (done == nullptr || !waiting.cause) return text;
    return fmt::format("{}: {} {}{} step {}", text,
                       describe_actor(system_, trace_.steps[*waiting.cause]), done,
                       input == "read" ? "" : " at", *waiting.cause + 1);
  }

  // What the model does instead, and who could change it.
  std::string describe_cause(const Waiting& waiting, const GlobalState& state) const {
    if (waiting.reason == Reason::nothing_due) {
      const std::string mismatch = describe_mismatch(model(waiting));
      if (!mismatch.empty()) return model(waiting).name + " delivers nothing: " + mismatch;
    }
    const std::string helpers = describe_helpers(waiting, state);
    return waiting.reason == Reason::several ? helpers : describe_model(waiting) + "; " + helpers;
  }

  // Programs that wait for the same, and why.
  struct Clause {
    std::vector<std::string> programs;  // none: what is awaited is a whole sentence
    std::string awaited, cause;         // the cause may be said with what is awaited

    std::string text(const std::string& between) const {
      if (programs.empty()) return awaited;
      std::string what = awaited;
      if (programs.size() > 1 && what.starts_with("waits ")) what.replace(0, 6, "wait ");
      return list_words(programs) + " " + what + (cause.empty() ? "" : between + cause);
    }
  };

  void add_clause(const Waiting& waiting, const GlobalState& state,
                  std::vector<Clause>& clauses) const {
    Clause clause{
        {program(waiting.program)}, what_is_awaited(waiting), describe_cause(waiting, state)};
    if (waiting.reason == Reason::nothing_due && !clauses.empty()) {
      clause.awaited += ", and " + describe_helpers(waiting, state);
      clause.cause.clear();
    }
    const auto same = std::ranges::find_if(clauses, [&](const Clause& other) {
      return waiting.reason == Reason::several && other.awaited == clause.awaited &&
             other.cause == clause.cause;
    });
    if (same == clauses.end()) {
      clauses.push_back(std::move(clause));
    } else {
      same->programs.push_back(program(waiting.program));
    }
  }

  // What keeps them from stepping, of those that do not step any more.
  std::vector<Clause> describe_those_that_stand(const std::vector<std::uint32_t>& programs) const {
    std::vector<Clause> clauses;
    for (const std::uint32_t index : programs) {
      if (!stands_still(index)) continue;
      if (trace_.loop_start) {
        clauses.push_back({{}, describe_standstill(index), ""});
      } else {
        add_clause(find_waiting(system_, trace_, states_, states_.size() - 1, index),
                   states_.back(), clauses);
      }
    }
    return clauses;
  }

  // The program by which to begin: one whose message was lost, or whom nobody can help any more.
  static int rank(const Waiting& waiting) {
    if (waiting.account && !waiting.account->losses.empty()) return 0;
    if (std::ranges::any_of(waiting.services,
                            [](const auto& wait) { return wait.loss.has_value(); }))
      return 0;
    return waiting.reachable_helpers.empty() ? 1 : 2;
  }

  std::string describe_deadlock(const GlobalState& state) const {
    std::vector<Waiting> waitings;
    for (const std::uint32_t index : blocked_programs(system_, state)) {
      waitings.push_back(find_waiting(system_, trace_, states_, states_.size() - 1, index));
    }
    std::ranges::stable_sort(waitings,
                             [](const Waiting& a, const Waiting& b) { return rank(a) < rank(b); });
    const std::vector<std::uint32_t> circle = find_circle(waitings);
    std::vector<Clause> clauses;
    for (const Waiting& waiting : waitings) add_clause(waiting, state, clauses);
    std::string text = clauses.front().text("; ");
    const std::size_t shown = std::min(clauses.size(), circle.size() > 2 ? 1 : most_clauses);
    for (std::size_t i = 1; i < shown; ++i) text += "; " + clauses[i].text(": ");
    if (circle.size() == 2) text += ": each waits for the other";
    if (circle.size() > 2) {
      text += "; they wait in a circle: " + program(circle[0]) + " for " + program(circle[1]);
      for (std::size_t i = 1; i < circle.size(); ++i) {
        text += ", " + program(circle[i]) + " for " + program(circle[(i + 1) % circle.size()]);
      }
    } else if (shown < clauses.size()) {
      std::size_t more = 0;
      for (std::size_t i = shown; i < clauses.size(); ++i) more += clauses[i].programs.size();
      text += fmt::format("; {} more wait", counted(more, "program"));
    }
    return text;
  }

  // "p comes to an error at step 4: x = 4 is outside of 0..3 (system.yaml:7:3)".
  std::string describe_error(const GlobalState& state) const {
    for (std::size_t index = 0; index < system_.programs.size(); ++index) {
      const Program& own = system_.programs[index];
      if (!own.is_error(state.programs[index])) continue;
      const ProgramError& error = own.errors[own.states[state.programs[index]].error];
      const std::string step =
          trace_.steps.empty() ? "at once" : fmt::format("at step {}", trace_.steps.size());
      return fmt::format("{} comes to an error {}: {} ({})", own.name, step, error.text,
                         to_string(error.position));
    }
    return "";
  }

  std::string describe_end() const {
    const GlobalState& state = states_.back();
    if (is_deadlock(system_, state)) return describe_deadlock(state);
    return has_ended(system_, state) ? "all programs have ended" : "";
  }

  // Programs that have not ended and do not step in the loop.
  std::string describe_loop() const {
    std::vector<bool> steps(system_.programs.size());
    for (std::size_t at = *trace_.loop_start; at < trace_.steps.size(); ++at) {
      if (trace_.steps[at].actor != nobody) steps[trace_.steps[at].actor] = true;
    }
    std::vector<std::uint32_t> running;
    std::vector<std::string> clauses;
    for (std::uint32_t index = 0; index < steps.size(); ++index) {
      const Program& program = system_.programs[index];
      const ControlState at = states_.back().programs[index];
      if (steps[index]) {
        running.push_back(index);
      } else if (!program.is_end(at) && !program.may_rest(at)) {
        clauses.push_back(describe_standstill(index));
      }
    }
    const std::size_t first = *trace_.loop_start + 1, last = trace_.steps.size();
    const std::string which =
        first == last ? fmt::format("step {}", last) : fmt::format("steps {} to {}", first, last);
    const std::string who = running.empty() ? "what happens by itself" : programs(running);
    std::vector<std::string> filling, changing;
    for (const std::uint32_t index : models_that_change(trace_, states_)) {
      const ModelInstance& model = system_.models[index];
      const bool is_variable = model.source == ModelInstance::Source::variable;
      (is_variable ? changing : filling).push_back(model.name);
    }
    std::vector<std::string> effects;
    if (!filling.empty()) effects.push_back("fill " + list_words(filling));
    if (!changing.empty()) effects.push_back("change " + list_words(changing));
    const std::string fill = effects.empty() ? "" : "; the first rounds " + list_words(effects);
    const std::string loop = fmt::format("{} {} on for ever ({}{})", who,
                                         running.size() > 1 ? "go" : "goes", which, fill);
    return clauses.empty() ? loop : list_words(clauses, "; and ") + "; " + loop;
  }

  std::string describe_standstill(std::uint32_t index) const {
    std::size_t blocked = 0, where = 0;
    const std::size_t length = trace_.steps.size() - *trace_.loop_start;
    for (std::size_t at = trace_.steps.size(); at-- > *trace_.loop_start;) {
      const auto waiting = blocked_programs(system_, states_[at]);
      if (std::ranges::find(waiting, index) == waiting.end()) continue;
      ++blocked;
      where = at;
    }
    const std::string never = program(index) + " never steps again: it ";
    if (blocked == 0) return never + "could, but never gets its turn";
    const Waiting waiting = find_waiting(system_, trace_, states_, where, index);
    if (blocked < length) {
      return never + what_is_awaited(waiting) + ", and each time it could go on, others are faster";
    }
    return fmt::format("{}{}; {}", never, what_is_awaited(waiting),
                       describe_cause(waiting, states_[where]));
  }

  const System& system_;
  const Trace& trace_;
  std::vector<GlobalState> states_;
};

}  // namespace

namespace {

// "; still on its way: a message from mapper to map, sent at step 1"; "": nothing, or it goes on.
std::string describe_on_its_way(const System& system, const Trace& trace) {
  if (trace.loop_start || system.nobodys_actions.empty()) return "";
  const std::vector<std::string> found = find_on_its_way(system, trace, replay(system, trace));
  return found.empty() ? "" : "; still on its way: " + join(found, "; ");
}

// "; lost on its way: a message of map at step 4, a request of robot at step 7 (and 2 more)".
std::string describe_lost_on_its_way(const System& system, const Trace& trace) {
  std::map<std::string, std::vector<std::size_t>> steps;  // by what was lost, from 1
  for (std::size_t at = 0; at < trace.steps.size(); ++at) {
    const std::string lost = lost_by(system, trace.steps[at]);
    if (!lost.empty()) steps[lost].push_back(at + 1);
  }
  std::vector<std::string> parts;
  for (const auto& [lost, at] : steps) {
    parts.push_back(fmt::format("{} at step {}", lost, at.front()));
    if (at.size() > 1) parts.back() += fmt::format(" (and {} more)", at.size() - 1);
  }
  return parts.empty() ? "" : "; lost on its way: " + join(parts, ", ");
}

}  // namespace

std::string explain(const System& system, const Property& property, const Trace& trace) {
  return Sentence(system, trace).write(property) + describe_lost_on_its_way(system, trace) +
         describe_on_its_way(system, trace);
}

std::string explain_waiting(const System& system, const Trace& trace, std::uint32_t program) {
  return Sentence(system, trace).write_waiting(program);
}

std::string explain_again(const System& system, const Property& property, const Trace& trace,
                          const PropertyResult& before) {
  return Sentence(system, trace).write_again(property, "the same run as " + before.name);
}

}  // namespace maide
