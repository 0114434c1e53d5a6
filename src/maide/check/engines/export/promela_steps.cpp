// Systems in Promela whose models are variables: each step is one line, a `d_step` of what makes it
// possible and what it changes, and a goto, which costs nothing.
//
// What a model does is written as it is read best: as comparisons and assignments where these are
// short, else as a table by its state. Tables are `hidden`, no part of pan's states. A step that
// has several outcomes is a line for each.
//
// What happens by itself is a process that may stand for ever.
//
// Where a program comes to an error, `is_halted` keeps all others from stepping. Deaths are a step
// of their own that nobody has to take. SPIN's end states and fairness know no such step, so a
// process says at any moment that there will be no more of them: what comes then is a deadlock, or
// a run that is fair, by SPIN's own measure.
//
// What a formula sees of a program, its labels, its end and its variables, stands in a variable
// too. Programs' control states that look alike to the formula have one value there.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/engines/export/promela_text.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/check/system/atom_view.hpp"

namespace maide {
namespace {

using Purpose = PromelaOptions::Purpose;

constexpr StateId no_state = 32767;           // `none` in a table
constexpr std::size_t longest_table = 8000;   // SPIN's parser takes no longer lists
constexpr std::size_t most_intervals = 3;     // of a comparison, before a table takes its place
constexpr std::size_t most_values = 100'000;  // that an atom is evaluated for

std::string_view type_for(std::size_t values) {
  return values <= 256 ? "byte" : values <= 32768 ? "short" : "int";
}

// "m == 3 || m >= 5 && m <= 7": `values` ascending, among 0 to below `size`; "" if they are all.
// Nothing if that takes too many intervals.
std::optional<std::string> membership(const std::string& variable,
                                      const std::vector<std::uint32_t>& values, std::size_t size,
                                      std::size_t intervals) {
  if (values.size() == size) return "";
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < values.size();) {
    std::size_t end = begin + 1;
    while (end < values.size() && values[end] == values[end - 1] + 1) ++end;
    const std::uint32_t low = values[begin], high = values[end - 1];
    const bool to_end = high + 1 == size && low != high;
    if (low == high) {
      parts.push_back(fmt::format("{} == {}", variable, low));
    } else if (low == 0 || to_end) {
      parts.push_back(
          fmt::format("{} {} {}", variable, low == 0 ? "<=" : ">=", low == 0 ? high : low));
    } else {
      parts.push_back(fmt::format("({0} >= {1} && {0} <= {2})", variable, low, high));
    }
    begin = end;
  }
  if (parts.size() > intervals) return std::nullopt;
  if (parts.empty()) return "false";
  return parts.size() == 1 ? parts.front() : "(" + join(parts, " || ") + ")";
}

// What one choice of moves of a relation is in Promela.
struct Move {
  std::string guard;   // "" if it is always possible
  std::string effect;  // "" if nothing changes
};

// SPIN's MAXDSTEP is 2048, which some texts pass with the 2,046th step.
constexpr std::size_t most_d_steps = 2000;

class StepWriter {
 public:
  StepWriter(const System& system, const PromelaOptions& options)
      : system_(system),
        options_(options),
        rules_(std::make_shared<const StepRules>(system)),
        has_errors_(has_errors(system)),
        has_idle_steps_(has_idle_steps(system)) {
    knows_deaths_ = has_idle_steps_ && (is_ltl() || options.purpose == Purpose::deadlock);
    has_cuts_ = rules_->may_cut() || has_errors_;
    if (is_ltl()) atoms_ = atoms_of(options.formula);
    views_ = views_of(atoms_, system);
    for (const Atom& atom : atoms_) has_events_ |= atom.is_event();
  }

  PromelaSystem run() {
    PromelaSystem& result = text_.result();
    result.processes = actor_count(system_) + (is_ltl() ? 1 : 0) + (knows_deaths_ ? 1 : 0);
    if (result.processes > most_promela_names) {
      throw UsageError(
          fmt::format("SPIN takes at most {} programs ({})", most_promela_names - 2, system_.file));
    }
    result.rules = rules_;
    result.is_doubled = knows_deaths_;
    text_.heading(system_, options_.purpose);
    find_views();
    write_models();
    write_flags();
    for (std::uint32_t index = 0; index < system_.programs.size(); ++index) write_program(index);
    if (!system_.nobodys_actions.empty()) write_nobody();
    if (knows_deaths_) write_survival();
    if (!options_.has_trails && result.steps.size() > most_d_steps) make_atomic();
    if (is_ltl()) {
      text_.idling("active proctype", has_events_);
      std::vector<std::string> expressions;
      for (std::size_t i = 0; i < atoms_.size(); ++i) expressions.push_back(expression(i));
      text_.claim(options_.formula, expressions, has_cuts_);
    }
    return std::move(result);
  }

 private:
  bool is_ltl() const { return options_.purpose == Purpose::ltl; }

  // ---- Models ----

  const std::string& variable(std::uint32_t model) {
    return names_.of("model_", system_.models[model].name);
  }

  void write_models() {
    for (std::uint32_t index = 0; index < system_.models.size(); ++index) {
      const ModelInstance& model = system_.models[index];
      if (model.automaton.size() >= no_state) {
        throw UsageError(fmt::format("SPIN takes at most {} states of a model: {} has {} ({})",
                                     no_state, model.name, model.automaton.size(), system_.file));
      }
      text_.line(fmt::format("{} {} = {};  /* {} */", type_for(model.automaton.size()),
                             variable(index), model.automaton.initial(),
                             promela_comment(model.origin.empty() ? model.name : model.origin)));
    }
    for (const ModelRelation& relation : rules_->relations()) {
      moves_.push_back(write_relation(relation));
    }
  }

  // The relation's moves: the first from each state, the second, ...
  std::vector<Move> write_relation(const ModelRelation& relation) {
    std::vector<std::vector<std::pair<StateId, StateId>>> ranks;
    std::size_t rank = 0;
    for (std::size_t i = 0; i < relation.moves.size(); ++i) {
      rank = i > 0 && relation.moves[i].first == relation.moves[i - 1].first ? rank + 1 : 0;
      if (rank == ranks.size()) ranks.emplace_back();
      ranks[rank].push_back(relation.moves[i]);
    }
    std::vector<Move> moves;
    for (rank = 0; rank < ranks.size(); ++rank) {
      moves.push_back(write_move(relation, ranks[rank], rank));
    }
    return moves;
  }

  Move write_move(const ModelRelation& relation,
                  const std::vector<std::pair<StateId, StateId>>& moves, std::size_t rank) {
    const std::string& name = variable(relation.model());
    const std::size_t size = system_.models[relation.model()].automaton.size();
    std::vector<std::uint32_t> sources;
    bool is_constant = true, is_shift = true;
    const auto shift = [](const auto& move) {
      return std::int64_t{move.second} - std::int64_t{move.first};
    };
    for (const auto& move : moves) {
      sources.push_back(move.first);
      is_constant = is_constant && move.second == moves.front().second;
      is_shift = is_shift && shift(move) == shift(moves.front());
    }
    std::string table;
    const auto needs_table = [&] {
      if (table.empty()) table = write_table(relation, moves, rank);
      return fmt::format("{}[{}]", table, name);
    };
    Move move;
    const auto guard = membership(name, sources, size, most_intervals);
    move.guard = guard ? *guard : needs_table() + " != none";
    if (is_constant && !(is_shift && shift(moves.front()) == 0)) {
      move.effect = fmt::format("{} = {}", name, moves.front().second);
    } else if (is_shift) {
      const std::int64_t by = shift(moves.front());
      if (by != 0)
        move.effect = fmt::format("{0} = {0} {1} {2}", name, by > 0 ? '+' : '-', std::abs(by));
    } else {
      move.effect = fmt::format("{} = {}", name, needs_table());
    }
    // SPIN leaves a variable that nothing reads out of its states.
    if (move.guard.empty() && !move.effect.empty()) {
      move.guard = fmt::format("{} <= {}", name, size - 1);
    }
    return move;
  }

  std::string write_table(const ModelRelation& relation,
                          const std::vector<std::pair<StateId, StateId>>& moves, std::size_t rank) {
    const ModelInstance& model = system_.models[relation.model()];
    if (model.automaton.size() > longest_table) {
      throw UsageError(fmt::format("SPIN takes no table of more than {} states: {} has {} ({})",
                                   longest_table, model.name, model.automaton.size(),
                                   system_.file));
    }
    const std::string what = rules_->describe(relation);
    // Tables of several models may be for the same.
    std::string name =
        names_.another("after_", what + (rank > 0 ? " " + std::to_string(rank + 1) : ""));
    if (!has_tables_) text_.line(fmt::format("#define none {}", no_state));
    has_tables_ = true;
    std::vector<StateId> targets(model.automaton.size(), no_state);
    for (const auto& [from, to] : moves) targets[from] = to;
    std::vector<std::string> entries;
    for (const StateId target : targets) {
      entries.push_back(target == no_state ? "none" : std::to_string(target));
    }
    text_.line(fmt::format("hidden short {}[{}] = {{ {} }};  /* {} */", name, entries.size(),
                           join(entries, ", "), promela_comment(what)));
    return name;
  }

  // ---- What a formula sees ----

  void find_views() {
    for (const AtomView& view : views_) {
      for (const AtomField& field : view.fields()) {
        if (field.is_model || seen_.contains(field.index)) continue;
        seen_.emplace(field.index, classes_of(field, views_, system_));
      }
    }
  }

  const std::string& view_variable(std::uint32_t program) {
    return names_.of("seen_", system_.programs[program].name);
  }

  std::string expression(std::size_t atom) {
    if (atoms_[atom].is_event()) {
      std::vector<std::uint32_t> codes;
      for (const auto& [events, code] : event_codes_) {
        if (events[atom]) codes.push_back(code);
      }
      std::ranges::sort(codes);
      const auto text = membership("event", codes, event_codes_.size() + 2, codes.size());
      return *text;
    }
    const AtomTable table = table_of(views_[atom], views_, system_, most_values);
    if (!table.values) {
      throw UsageError(
          fmt::format("SPIN takes no formula that compares so many values: more than "
                      "{} ({})",
                      most_values, system_.file));
    }
    std::vector<std::pair<std::string, std::size_t>> fields;
    for (std::size_t i = 0; i < table.classes.size(); ++i) {
      const AtomField& field = views_[atom].fields()[i];
      fields.emplace_back(field.is_model ? variable(field.index) : view_variable(field.index),
                          table.classes[i].examples.size());
    }
    auto value = table.values->begin();
    return decide(fields, value);
  }

  // Where an atom is true, by its fields, which are variables and how many values each has. Its
  // values are read from `next` on.
  static std::string decide(std::span<const std::pair<std::string, std::size_t>> fields,
                            std::vector<bool>::const_iterator& next) {
    if (fields.empty()) return *next++ ? "true" : "false";
    const auto& [variable, size] = fields.front();
    std::map<std::string, std::vector<std::uint32_t>> values;  // by what is left to ask
    for (std::uint32_t value = 0; value < size; ++value) {
      values[decide(fields.subspan(1), next)].push_back(value);
    }
    std::vector<std::string> parts;
    for (const auto& [rest, of_rest] : values) {
      if (rest == "false") continue;
      const std::string here = *membership(variable, of_rest, size, of_rest.size());
      if (here.empty()) return rest;
      parts.push_back(rest == "true" ? here : "(" + here + " && " + rest + ")");
    }
    if (parts.empty()) return "false";
    return parts.size() == 1 ? parts.front() : "(" + join(parts, " || ") + ")";
  }

  // The number of what a step of the actor gives and takes, as far as the formula's atoms see it;
  // 0: nothing.
  std::uint32_t event_code(std::uint32_t actor, std::span<const ModelUse> of_step) {
    std::vector<bool> events;
    for (const Atom& atom : atoms_) {
      events.push_back(atom.is_event() && is_event_of(atom, actor, of_step));
    }
    if (std::ranges::find(events, true) == events.end()) return 0;
    return event_codes_.try_emplace(events, static_cast<std::uint32_t>(event_codes_.size() + 1))
        .first->second;
  }

  // ---- Programs ----

  void write_flags() {
    if (has_errors_) {
      text_.line(
          fmt::format("bool is_halted = {};  /* a program is at an error: nothing follows */",
                      is_error(system_, initial_state(system_))));
    }
    if (knows_deaths_) text_.line("bool no_more_deaths;");
    if (has_events_) text_.line("short event;  /* of the step that reached this state; 0: none */");
    if (is_ltl() && has_cuts_)
      text_.line("bit cut;  /* the run left what was learned, or failed */");
    for (const auto& [program, classes] : seen_) {
      text_.line(fmt::format("{} {} = {};  /* what the formula sees of it */",
                             type_for(classes.examples.size()), view_variable(program),
                             classes.of_states.front()));
    }
  }

  static std::string label(const Program& program, ControlState state) {
    const bool may_stay = program.is_end(state) || program.may_rest(state);
    return (may_stay ? "end_s" : "s") + std::to_string(state);
  }

  void write_program(std::uint32_t index) {
    const Program& program = system_.programs[index];
    text_.line("");
    text_.line(fmt::format("/* program {}, line {} */", promela_comment(program.name),
                           program.position.line));
    text_.line(fmt::format("active proctype {}() {{", names_.of("program_", program.name)));
    for (ControlState state = 0; state < program.states.size(); ++state) {
      if (program.is_error(state)) {
        write_error(program, state);
        continue;
      }
      const std::vector<StepRule> rules = rules_->rules_of(index, state);
      if (rules.empty()) {
        text_.line(label(program, state) + ": false;");
        continue;
      }
      text_.line(label(program, state) + ": if");
      for (const StepRule& rule : rules) write_rule(rule, {});
      text_.line("  fi;");
    }
    text_.line("}");
  }

  // Each step in an `atomic`: the states are the same.
  void make_atomic() {
    constexpr std::string_view from = "  :: d_step {", to = "  :: atomic {";
    std::string& text = text_.result().text;
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos;) {
      text.replace(at, from.size(), to);
    }
  }

  void write_error(const Program& program, ControlState state) {
    const std::string here = label(program, state);
    const ProgramError& error = program.errors[program.states[state].error];
    text_.line(fmt::format("/* line {}: {} */", error.position.line, promela_comment(error.text)));
    if (options_.purpose == Purpose::cut) {
      text_.line(here + ": false;");
    } else {
      text_.line(fmt::format("{}: if :: d_step {{ is_halted -> {} }} -> goto {} fi;", here,
                             is_ltl() ? "cut = 1" : "assert(false)", here));
    }
  }

  // A line for each choice of moves of the rule's relations.
  void write_rule(const StepRule& rule, std::vector<std::uint32_t> ranks) {
    if (ranks.size() < rule.relations.size()) {
      const std::size_t count = moves_[rule.relations[ranks.size()]].size();
      ranks.push_back(0);
      for (std::uint32_t rank = 0; rank < count; ++rank) {
        ranks.back() = rank;
        write_rule(rule, ranks);
      }
      return;
    }
    const Step step = StepRules::begun_step(rule);
    std::vector<std::string> guards, effects;
    if (has_errors_) guards.push_back("!is_halted");
    if (knows_deaths_ && !is_progress(system_, step)) guards.push_back("!no_more_deaths");
    for (std::size_t i = 0; i < ranks.size(); ++i) {
      const Move& move = moves_[rule.relations[i]][ranks[i]];
      if (!move.guard.empty()) guards.push_back(move.guard);
      if (!move.effect.empty() && !rule.is_cut) effects.push_back(move.effect);
    }
    if (rule.is_cut) {
      if (options_.purpose == Purpose::cut) effects.push_back("assert(false)");
      if (is_ltl()) effects.push_back("cut = 1");
    } else {
      add_effects(rule, effects);
    }
    const std::string text =
        fmt::format("  :: d_step {{ {}{}{} }} -> goto {}  /* line {}: {}{} */",
                    guards.empty() ? "true" : join(guards, " && "), effects.empty() ? "" : " -> ",
                    join(effects, "; "), label_behind(rule), place_of(system_, step).line,
                    promela_comment(describe_action(system_, step)),
                    rule.is_cut      ? ", beyond"
                    : rule.is_beyond ? ", dropped"
                                     : "");
    auto& steps = text_.result().steps;
    text_.line(text, {PromelaLine::Kind::step, rule.actor, static_cast<std::uint32_t>(steps.size()),
                      0, rule.is_beyond});
    steps.push_back({rule, std::move(ranks)});
  }

  std::string label_behind(const StepRule& rule) const {
    if (rule.actor == nobody) return "end_s0";
    const Program& program = system_.programs[rule.actor];
    return label(program, rule.is_cut ? rule.source : program.edges[rule.action].target);
  }

  // But for those on models.
  void add_effects(const StepRule& rule, std::vector<std::string>& effects) {
    const Step step = StepRules::begun_step(rule);
    if (has_events_ && rule.actor == nobody) {
      effects.push_back(fmt::format("event = {}", event_code(nobody, events_of(system_, step))));
    }
    if (rule.actor == nobody) return;
    const Program& program = system_.programs[rule.actor];
    const ProgramEdge& edge = program.edges[rule.action];
    if (program.is_error(edge.target)) {
      effects.emplace_back("is_halted = true");
      if (is_ltl()) effects.emplace_back("cut = 1");
    }
    if (has_events_) {
      effects.push_back(
          fmt::format("event = {}", event_code(doer_of(system_, step), events_of(system_, step))));
    }
    const auto seen = seen_.find(rule.actor);
    if (seen == seen_.end()) return;
    const std::vector<std::uint32_t>& classes = seen->second.of_states;
    if (classes[rule.source] == classes[edge.target]) return;
    effects.push_back(fmt::format("{} = {}", view_variable(rule.actor), classes[edge.target]));
  }

  // A process that may stand for ever, for the steps that no program takes.
  void write_nobody() {
    text_.line("");
    text_.line("/* what happens by itself */");
    text_.line("active proctype nobody() {");
    const std::vector<StepRule> rules = rules_->rules_of(nobody, 0);
    text_.line(rules.empty() ? "end_s0: false;" : "end_s0: if");
    for (const StepRule& rule : rules) write_rule(rule, {});
    if (!rules.empty()) text_.line("  fi;");
    text_.line("}");
  }

  void write_survival() {
    text_.line("");
    text_.line("/* Nobody has to die: at any moment it may be that nobody does any more. */");
    text_.line("active proctype survival() {");
    text_.line(
        "end_s0: if :: d_step { !no_more_deaths -> no_more_deaths = true } -> goto end_s0 fi;");
    text_.line("}");
  }

  const System& system_;
  const PromelaOptions& options_;
  std::shared_ptr<const StepRules> rules_;
  PromelaNames names_;
  PromelaText text_;
  bool has_errors_, has_idle_steps_, has_cuts_ = false, has_events_ = false;
  bool knows_deaths_ = false;  // the text has them as steps that nobody has to take
  bool has_tables_ = false;
  std::vector<std::vector<Move>> moves_;        // by relation, rank
  std::vector<Atom> atoms_;                     // of the formula
  std::vector<AtomView> views_;                 // by atom
  std::map<std::uint32_t, StateClasses> seen_;  // by program that atoms see: by what they see
  std::map<std::vector<bool>, std::uint32_t> event_codes_;  // by which atoms are true
};

}  // namespace

PromelaSystem write_promela_steps(const System& system, const PromelaOptions& options) {
  return StepWriter(system, options).run();
}

}  // namespace maide
