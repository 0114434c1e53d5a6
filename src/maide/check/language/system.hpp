// A system to check: instances of learned models, control programs that use them, and properties.
// Its meaning, that is global states and steps, is defined here, once. Engines, traces and tests
// refer to it.
//
// Components run asynchronously and meet on a model's inputs and outputs. One step is one
// rendezvous, one `quiet` or one internal choice. A model with an output due takes no input. If
// several programs wait for an output, any one of them gets it. An input that was never tried where
// the model stands (unexplored, or an absorbed self-loop) does what the instance's
// `when_unexplored` says.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/language/program.hpp"
#include "maide/check/ltl/formula.hpp"

namespace maide {

struct LtlAutomaton;

enum class WhenUnexplored : std::uint8_t {
  stop,  // the run leaves what was learned and is cut there
  wait,  // the program waits until the input is possible
  drop,  // the input is taken and nothing changes
};

// What becomes of a "holds" that rests on a weak model (automata/strength.hpp).
enum class WhenWeak : std::uint8_t {
  inconclusive,  // the verdict is inconclusive
  accept,        // it stands
};

struct ModelInstance {
  std::string name;
  InterfaceAutomaton automaton;
  WhenUnexplored when_unexplored = WhenUnexplored::stop;
  WhenWeak when_weak = WhenWeak::inconclusive;
  std::string origin;       // the file, or what it was learned from; for messages
  bool is_learned = false;  // `origin` is a system: learned for this check, or an earlier one
  SourcePosition position;
};

enum class Fairness : std::uint8_t { none, weak, strong };

// A property of the system file. `deadlock` and `stuck` are there without being written.
struct Property {
  enum class Kind : std::uint8_t { deadlock, stuck, ltl, never };
  std::string name;
  Kind kind = Kind::ltl;
  Formula formula;                            // of Kind::ltl; an invariant is `G expression`
  std::shared_ptr<const LtlAutomaton> never;  // of Kind::never: accepts the runs that are bad
  Fairness fairness = Fairness::weak;
  SourcePosition position;
};

struct System {
  std::string file;
  std::vector<ModelInstance> models;
  std::vector<Program> programs;
  std::vector<Property> properties;            // those of the file
  std::vector<std::string> remarks;            // one line each: what looks like an oversight
  std::map<std::string, std::string> sources;  // texts of the files that programs stand in, by name

  std::vector<ProgramInterface> interfaces() const;  // of the models, in order
};

struct GlobalState {
  std::vector<StateId> models;
  std::vector<ControlState> programs;
  bool is_cut = false;  // the run left what was learned; it has no further step
  bool operator==(const GlobalState&) const = default;
};

struct Step {
  std::uint32_t program = 0;
  std::uint32_t edge = 0;    // index into the program's edges
  StateId model_target = 0;  // state of the edge's model afterwards (not for a choice)
  bool is_beyond = false;    // gives an input where it was never tried
  bool operator==(const Step&) const = default;
};

// What a model does in one of its states when a program takes an edge there.
struct ModelStep {
  StateId target = 0;
  bool is_beyond = false;  // as in Step
};
// Every way in which `model`, in state `at`, can take part in `edge`, which is not a choice; in the
// order of its transitions. O(transitions of the state).
std::vector<ModelStep> model_steps(const ModelInstance& model, StateId at, const ProgramEdge& edge);

GlobalState initial_state(const System& system);
// Every step that is possible in `state`, in a fixed order. None if the run is cut. O(programs x
// edges).
std::vector<Step> enabled_steps(const System& system, const GlobalState& state);
// The state after one of its enabled steps.
GlobalState apply(const System& system, const GlobalState& state, const Step& step);
// Nothing can happen, and some program has not ended. A cut run is no deadlock.
bool is_deadlock(const System& system, const GlobalState& state);
bool has_ended(const System& system, const GlobalState& state);

// The line of the program's source, without blanks around it; "" if it is not known.
std::string source_line(const System& system, const Program& program, int line);

// What an atom of a formula is in `state`, which was reached by `last` (null: the initial state, or
// one that repeats for ever).
bool is_true(const Atom& atom, const System& system, const GlobalState& state, const Step* last);

// Whether `input` was never tried in `state` of the automaton: marked, or drawn as absorbed.
bool is_beyond_learned(const InterfaceAutomaton& automaton, StateId state, Symbol input);

}  // namespace maide
