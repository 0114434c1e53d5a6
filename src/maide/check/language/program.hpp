// A control program as an automaton. Each transition is one step: an input given to a model
// instance, an output taken from one, a `quiet` observed, an internal choice made, or several of
// these at once (a combined step). `loop`, `repeat`, `skip`, labels and what is done with the
// program's own variables cost no step: a control state is a place in the text with the values of
// the variables there. Every transition knows its place in the system file. A plain value type.
// Transitions lie in one flat table, so that 10^6 control states fit.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/language/expression.hpp"
#include "maide/check/text/scalar_text.hpp"

namespace maide {

using ControlState = std::uint32_t;

// What a step does with one model.
struct ModelUse {
  enum class Kind : std::uint8_t {
    give,      // gives input `index` to instance `model`
    take,      // takes output `index` of instance `model`
    quiet,     // sees that instance `model` has no output due
    act,       // does action `index` of the instance's `actions`
    choice,    // of an edge: no model; takes branch number `index` of an `if *`
    combined,  // of an edge: what Program::combined[index] says; `model` is not used
  };
  Kind kind = Kind::choice;
  std::uint32_t model = 0;
  std::uint32_t index = 0;
  auto operator<=>(const ModelUse&) const = default;
};

// What a model does in one of its states when a program's step uses it.
struct ModelStep {
  StateId target = 0;
  bool is_beyond = false;  // an input where it was never tried
  auto operator<=>(const ModelStep&) const = default;
};

struct ProgramEdge : ModelUse {
  ControlState target = 0;
  int line = 0, column = 0;  // in the system file
  std::uint32_t origin = 0;  // index into Program::origins; 0: none
};

// A step that is more than one use of one model: with several models at once or with none, with
// other events than its uses, or with a role of its own.
struct CombinedStep {
  enum class Role : std::uint8_t {
    step,
    choice,     // one of the outcomes of `any` or `if fair *`
    arm,        // of a `select`
    otherwise,  // of a `select`: no arm can be taken
    timeout,    // so is this
    timer,      // an arm: a callback that starts at any moment
    end,        // of a callback
    look,       // of an executor that goes by rounds
    discard,    // so is this: a client that was found has answers to others alone, or one of them
    death,      // the program ends here: no progress, and no fairness asks for it
    // A message arrives, by itself, and with it the call ends in which the program stands: who
    // waits for it is the program, and who does it is nobody.
    arrival,
    loss,       // so is it if the message is lost: no progress
    fate,       // it ends with its process, or begins anew with it: by itself, as messages arrive
    causeless,  // who waits at a condition wakes by himself: no progress
  };
  Role role = Role::step;
  std::vector<ModelUse> uses;    // all at once, each of another model; none is choice or combined
  std::vector<ModelUse> events;  // the inputs given and outputs taken, for formulas: give, take
  std::string text;              // in the file's words: "images.read -> message", "n = 3"
  // Its fair group in the program; of what happens by itself among System::nobodys_groups. 0:
  // none.
  std::uint32_t fair = 0;
  // Of a start or a discard: the callback, of the system's.
  std::optional<std::uint32_t> callback{};
  bool awaits_anybody = false;  // it takes what anybody may send, or is what he does
};

// How runs and properties count what an actor does.
struct ActorFlags {
  // Its steps are progress: where one is possible is no deadlock. Else they count as a death does:
  // where nothing else is possible is a deadlock, and no fairness asks for them.
  bool counts_for_deadlock = true;
  bool is_fair = true;    // on fair runs it steps, if it can go on
  bool may_rest = false;  // may stand for ever wherever it is: no deadlock, and not stuck
  bool is_shown = true;   // its steps stand in texts and charts of a run
  // What anybody may send counts as what comes. Else a run may go on without it, as formulas have
  // it.
  bool counts_on_anybody = true;
  bool operator==(const ActorFlags&) const = default;
};

// Edges of which one is to be taken again and again if one of them can be taken again and again, on
// runs that are fair: an arm of a `select`, one outcome of an `if fair *`, in all copies and
// rounds.
struct FairGroup {
  bool on_weak_runs = false;  // on weakly fair runs, too: an outcome
  std::string text;
};

struct ProgramVariable {
  std::string name;
  ValueType type;
  SourcePosition position;
};

struct ProgramError {
  std::string text;  // "x = 4 is outside of 0..3"
  SourcePosition position;
};

// Of a program whose process begins anew, or of which several programs end at once: the model that
// says whether the process lives, and what the program is by that model's state. A dead one is at
// no label, and its variables are as at first.
struct ProgramLife {
  std::uint32_t model = 0;
  std::vector<bool> is_dead;
  std::vector<bool> is_dead_for_good;              // it never begins anew: it has ended
  std::vector<std::optional<Value>> first_values;  // by variable; none: in no scope at first
};

struct Program {
  struct State {
    std::uint32_t first_edge = 0;
    std::uint32_t edge_count = 0;
    std::uint32_t label_set = 0;  // index into label_sets
    std::uint32_t round = 0;      // index into rounds: of the innermost loop
    std::uint32_t valuation = 0;  // index into valuations
    std::uint32_t error = 0;      // index into errors; 0: none. Nothing follows an error
    bool may_rest = false;        // may stand here for ever: no deadlock, and not stuck
    bool waits = false;           // without an edge, for what never comes: no end
    bool is_over = false;         // an end, behind which the end of its process comes
  };
  // A round of a `loop` or `repeat`, in one round of each loop around it.
  struct Round {
    std::uint32_t outer = 0;   // the round around it; 0: none
    int line = 0, column = 0;  // of the loop
    std::uint32_t number = 0;  // from 1; 0 in a `loop`, whose rounds are all the same
    std::uint32_t count = 0;   // of the `repeat`; 0 in a `loop`
    bool operator==(const Round&) const = default;
  };
  // An arm `when (e)` of a `select`.
  struct Guard {
    std::string text;  // "late && n > 3"
    int line = 0, column = 0;
    std::vector<std::uint32_t> variables;  // of the program's own, those that it reads
    bool operator==(const Guard&) const = default;
  };
  // A control state before a `select` that has guards.
  struct Select {
    ControlState state = 0;
    std::uint32_t guards = 0;  // index into guard_lists
  };
  std::string name;
  ActorFlags flags;
  std::vector<std::string> nodes;   // whose callbacks it runs; else empty
  std::string execution;            // of callbacks: "on one thread, in any order"
  std::string process;              // programs of one process have the same name here
  std::optional<ProgramLife> life;  // none: see may_die()
  struct CallbackLines {
    std::string name;  // "detector.on_image"
    int first = 0, last = 0;
  };
  std::vector<CallbackLines> callbacks;
  SourcePosition position;                             // of the program in the system file
  int last_line = 0;                                   // of its text there
  std::vector<State> states;                           // state 0 is the initial one
  std::vector<ProgramEdge> edges;                      // grouped by state
  std::vector<std::string> labels;                     // names, in the order of the text
  std::vector<std::vector<std::uint32_t>> label_sets;  // [0] is empty; each sorted
  std::vector<Round> rounds;                           // [0] is outside of every loop
  std::vector<SourcePosition> unreachable;  // statements behind one that does not come to its end
  std::vector<CombinedStep> combined;
  std::vector<FairGroup> fair_groups;  // [0] is not used
  std::vector<ProgramVariable> variables;
  // Values by variable; none where it is out of scope. [0]: no variable is in scope.
  std::vector<std::vector<std::optional<Value>>> valuations;
  std::vector<ProgramError> errors;  // [0] is not used
  // Where it runs callbacks until an answer is there.
  std::vector<SourcePosition> spins_until;
  // For messages: a guard that reads own variables has no edge where it does not hold.
  std::vector<Select> selects;  // by control state
  std::vector<std::vector<Guard>> guard_lists;
  // Places in other files that edges were made from, such as a line of C++; [0] is not used.
  std::vector<SourcePosition> origins;
  // The models and shared variables that its text names, reached or not; of an array all members.
  std::vector<std::uint32_t> names;  // sorted

  std::span<const ProgramEdge> edges_of(ControlState state) const {
    return std::span(edges).subspan(states[state].first_edge, states[state].edge_count);
  }
  // The program has ended, if perhaps not its process. A program's other states have a transition,
  // but for errors and a `select` of which no arm is possible.
  bool is_end(ControlState state) const {
    const State& at = states[state];
    return at.is_over || (at.edge_count == 0 && at.error == 0 && !at.waits);
  }
  // It is an executor's, or a part of one: no thread of a node's own, and no program.
  bool runs_callbacks() const { return !execution.empty(); }
  bool is_error(ControlState state) const { return states[state].error != 0; }
  // It runs callbacks until an answer is there, and stands between two.
  bool spins_until_answer(ControlState state) const;
  // It may stand there for ever.
  bool may_rest(ControlState state) const { return flags.may_rest || states[state].may_rest; }
  // The control state that has the edge. O(log control states).
  ControlState source_of(std::uint32_t edge) const;
  // The models that the edge uses: none for a choice. Valid as long as the program and the edge.
  std::span<const ModelUse> uses_of(const ProgramEdge& edge) const {
    if (edge.kind == ModelUse::Kind::combined) return combined[edge.index].uses;
    if (edge.kind == ModelUse::Kind::choice) return {};
    return {static_cast<const ModelUse*>(&edge), 1};
  }
  // The inputs that it gives and the outputs that it takes.
  std::span<const ModelUse> events_of(const ProgramEdge& edge) const {
    if (edge.kind == ModelUse::Kind::combined) return combined[edge.index].events;
    if (edge.kind == ModelUse::Kind::give || edge.kind == ModelUse::Kind::take) {
      return {static_cast<const ModelUse*>(&edge), 1};
    }
    return {};
  }
  CombinedStep::Role role_of(const ProgramEdge& edge) const {
    return edge.kind == ModelUse::Kind::combined ? combined[edge.index].role
                                                 : CombinedStep::Role::step;
  }
  // A step by it counts for deadlocks, and fairness asks for it.
  bool is_progress(const ProgramEdge& edge) const {
    const CombinedStep::Role role = role_of(edge);
    return flags.counts_for_deadlock && !is_death(edge) && role != CombinedStep::Role::loss &&
           role != CombinedStep::Role::causeless &&
           (flags.counts_on_anybody || !awaits_anybody(edge));
  }
  // It happens by itself: the program waits for it in a call, or ends or begins with its process.
  bool is_by_itself(const ProgramEdge& edge) const {
    const CombinedStep::Role role = role_of(edge);
    return role == CombinedStep::Role::arrival || role == CombinedStep::Role::loss ||
           role == CombinedStep::Role::fate;
  }
  // Nobody has to do what it waits for.
  bool awaits_anybody(const ProgramEdge& edge) const {
    return edge.kind == ModelUse::Kind::combined && combined[edge.index].awaits_anybody;
  }
  bool is_death(const ProgramEdge& edge) const {
    return role_of(edge) == CombinedStep::Role::death;
  }
  // What befalls it, not what it does: its death, or that of its process.
  bool is_fate(const ProgramEdge& edge) const {
    return is_death(edge) || role_of(edge) == CombinedStep::Role::fate;
  }
  // The program's group.
  std::uint32_t fair_group_of(const ProgramEdge& edge) const {
    return edge.kind == ModelUse::Kind::combined && !is_by_itself(edge) ? combined[edge.index].fair
                                                                        : 0;
  }
  // Nobody's group, of what happens by itself.
  std::uint32_t nobodys_group_of(const ProgramEdge& edge) const {
    return is_by_itself(edge) ? combined[edge.index].fair : 0;
  }
  // The value of the variable there; none where it is out of scope.
  std::optional<Value> value_of(ControlState state, std::uint32_t variable) const {
    const auto& values = valuations[states[state].valuation];
    return variable < values.size() ? values[variable] : std::nullopt;
  }
  // The guards of the `select` that control stands at. O(log control states).
  std::span<const Guard> guards_at(ControlState state) const;
  // "line 18 (detector.on_image)", in code of one callback alone; or its origin, "a.cpp:3".
  std::string place_of(int line) const;
  bool has_label(ControlState state, std::uint32_t label) const;
  // What control can come to, whatever the models do. O(control states).
  bool may_end() const;
  bool may_die() const;
  bool may_reach(std::uint32_t label) const;
};

// A model instance as a program's text sees it.
struct ProgramInterface {
  std::string name;
  const Alphabet* inputs = nullptr;
  const Alphabet* outputs = nullptr;
};

// Most control states of one program after unrolling.
inline constexpr std::size_t max_control_states = 1'000'000;

}  // namespace maide
