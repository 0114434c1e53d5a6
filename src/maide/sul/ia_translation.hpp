// Interface automata to Mealy machines and back, in both translations (Aarts & Vaandrager,
// "Learning I/O automata", CONCUR 2010; the eager one is ours). A step with outputs becomes one
// state for each pair (outputs still due, next state). These states are shared, then minimised,
// which gives the sizes of the paper's models (a strict queue of N: 2N+2 states, 3N+2 transitions).
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

// ---- Steps ----
//
// A step of a translated machine goes from quiescence to quiescence. `MacroStep` says what it does,
// and `IaExpander` makes the interface automaton of such steps, for deterministic and
// nondeterministic machines alike.

// What a machine of a translation does at a quiescent state on an input.
struct MacroStep {
  StepStatus status = StepStatus::taken;
  std::vector<std::string> outputs;  // in canonical order
  StateId target = 0;
};

// The step that an answer of the eager translation says: "quiet", "refused", "a,b", ...
MacroStep read_eager_step(const std::string& output, StateId target);

// Builds the interface automaton: quiescent states first, states with outputs due as they are met.
class IaExpander {
 public:
  // `states` quiescent states. Outputs of one actor keep their order; those of different actors may
  // be taken in any order.
  IaExpander(const Alphabet& inputs, std::size_t states, std::span<const Actor> actors);

  // What the input does in a quiescent state. A state may be given several steps for one input.
  void add_step(StateId state, Symbol input, const MacroStep& step);

  InterfaceAutomaton take() { return std::move(automaton_); }

 private:
  using Due = std::vector<std::vector<Symbol>>;  // for each actor that owes some: what, in order
  struct Unfinished {
    Due due;
    StateId target, source;
  };

  Due by_actor(const std::vector<std::string>& outputs);
  StateId due_state(const Due& due, StateId target);
  void take_each_first(const Due& due, StateId target, StateId source);

  InterfaceAutomaton automaton_;
  std::map<std::string, std::size_t> actor_of_;  // 0: of no actor
  std::map<std::pair<Due, StateId>, StateId> due_states_;
  std::vector<Unfinished> unfinished_;
};

// The name of the extra input of Translation::av.
inline constexpr const char* delta_input = "Delta";

// The interface automaton that `machine` stands for, minimal. `actors` gives the actor of each
// output. One actor's outputs keep their order. Outputs of different actors that are due at the
// same time may be taken in any order. Outputs of no actor count as one actor's. Throws UsageError
// if the machine breaks an assumption of the translation: a refusal or delta that changes the
// state, an input that is taken while an output is due, outputs without end.
InterfaceAutomaton to_interface_automaton(const Mealy& machine, Translation translation,
                                          std::span<const Actor> actors);

// The same for a nondeterministic machine of the eager translation. The system chooses when it
// takes the input. So an input with several answers has several targets, each with the outputs of
// one answer due. An input without an answer is unexplored. Throws UsageError for an input that is
// taken at some times, and refused or beyond the bound at others.
InterfaceAutomaton to_interface_automaton(const NondeterministicMealy& machine,
                                          std::span<const Actor> actors);

// The minimal Mealy machine of `automaton` in a translation. Of several outputs that are due, the
// one of the first actor comes first (the canonical order). Throws UsageError if the automaton is
// not deterministic, is not quiescent at the start, or emits outputs without end.
Mealy to_mealy(const InterfaceAutomaton& automaton, Translation translation);

// The transition of the output that comes first in the canonical order among those due in `state`;
// null if the state is quiescent.
const InterfaceAutomaton::Transition* find_first_due(const InterfaceAutomaton& automaton,
                                                     StateId state);

// Inputs that were seen busy at quiescence and not all of whose returns are observed, in the order
// of the inputs. `machine` is a learned machine over the inputs of `info`.
std::vector<std::string> find_hidden_returns(const Mealy& machine, Translation translation,
                                             const SulInfo& info);
std::vector<std::string> find_hidden_returns(const NondeterministicMealy& machine,
                                             const SulInfo& info);

}  // namespace maide
