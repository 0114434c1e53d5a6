// A system to check: instances of learned models, control programs that use them, and properties.
// Its meaning, that is global states and steps, is defined here, once. Engines, traces and tests
// refer to it.
//
// Programs run asynchronously and meet on a model's inputs and outputs. One step is one rendezvous,
// one `quiet`, one internal choice, or a combined step: of one program with several models at once.
// A model with an output due takes no input. If several programs wait for an output, any one of
// them gets it. An input that was never tried where the model stands (unexplored, or an absorbed
// self-loop) does what the instance's `when_unexplored` says. A program that comes to an error
// stops the system: nothing follows.
//
// A step has an actor, which is a program, or nobody. What nobody does is an action of the system
// that changes models alone: a message arrives, a clock ticks. It is possible where all its uses
// are. Where it is possible is no deadlock. It is no program's step, so a program is stuck if from
// some point on nobody steps alone. What happens by itself and ends a call of a program is an edge
// of that program, which nobody does (doer_of): the program goes on in the same step.
//
// Shared variables are model instances, too: a state for each value, and actions that read and
// write.
#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/language/program.hpp"
#include "maide/check/language/system_names.hpp"
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

// A use of a model that is not one of its inputs or outputs alone: an input with the output that
// follows at once, a condition on its state, an assignment to a shared variable.
struct ModelAction {
  std::string name;                           // for messages
  std::vector<std::vector<ModelStep>> steps;  // by state; none: not possible there
  // Made of two steps by a reduction (reduce/merged_calls.hpp). Between the two nobody else can
  // use the model.
  bool is_call = false;
};

// What a service holds in one of its states.
struct ServiceContents {
  std::vector<std::uint32_t> requests;  // their clients, oldest first: not served
  std::vector<std::uint32_t> served;    // their clients: served and not answered
  std::vector<std::uint32_t> answers;   // by client: answers to it that have come to it
  std::vector<std::uint32_t> sent;      // by client: its requests that are on their way
  std::vector<std::uint32_t> coming;    // by client: answers to it that are on their way
  bool operator==(const ServiceContents&) const = default;
};

// When what is sent comes to a model.
enum class Delivery : std::uint8_t {
  late,          // some time after the sending
  at_once,       // in the step of the sending
  acknowledged,  // before the sender goes on
};

struct ModelInstance {
  // What stands behind it.
  enum class Source : std::uint8_t {
    file,      // a model file, or a system that was learned
    built_in,  // a mutex, semaphore or queue, written by hand
    service,   // made by the rules of services
    executor,  // its idle threads, or which runs of a callback there are
    variable,  // a shared variable: state i is the value number i of its type
    wire,      // what is on its way between two ends
    anybody,   // what anybody may write at any time, or takes
  };
  std::string name;
  InterfaceAutomaton automaton;
  std::vector<ModelAction> actions;
  Source source = Source::file;
  ValueType type;  // of a variable
  // Of a queue that has too many states to make them all: it has those that programs reach.
  bool is_grown = false;
  std::vector<std::string> state_texts;  // of a service or wire, by state: what is on its way
  std::vector<std::uint32_t> held;       // of a wire, by state: how many messages are on it
  std::vector<ServiceContents> service_contents;  // of a service, by state
  WhenUnexplored when_unexplored = WhenUnexplored::stop;
  WhenWeak when_weak = WhenWeak::inconclusive;
  std::string origin;  // the file, or what it was learned from; for messages
  // The automaton as it was read, where programs at its ends made another one of it; else null.
  std::shared_ptr<const InterfaceAutomaton> as_read;
  // What is taken from it comes from anybody, who need not send anything: formulas' runs may end
  // where only he can act.
  bool awaits_anybody = false;
  bool is_learned = false;  // `origin` is a system: learned for this check, or an earlier one
  SourcePosition position;

  // How many messages are on the wire there; 0 of what is no wire, or where it is not known.
  std::uint32_t held_in(StateId state) const { return state < held.size() ? held[state] : 0; }
  const InterfaceAutomaton& read_automaton() const { return as_read ? *as_read : automaton; }
  // What was read is another one now.
  void read(InterfaceAutomaton other) {
    automaton = std::move(other);
    as_read.reset();
  }
};

// Something that happens by itself.
struct NobodysAction {
  // Its uses, events and text; `role` is Role::step. `fair`: its group among
  // System::nobodys_groups. Groups are treated fairly on weakly fair runs, too: if one of the
  // group's actions is possible again and again, one is taken again and again. 0: nothing asks for
  // it.
  CombinedStep what;
  bool counts_for_deadlock = true;  // see ActorFlags
  bool is_shown = true;
  std::string lost{};                      // by it, in words: "a message of image"; "": nothing
  SourcePosition position;                 // in the system file
  std::optional<SourcePosition> origin{};  // in another file
};

// A topic of the file, for who plays runs on a real one: its steps are combined steps of these
// models.
struct TopicInstance {
  struct Reader {
    std::uint32_t program = 0, model = 0;
    std::optional<std::uint32_t> callback;  // of a node, that takes from it
    // By state of the model: the output of the writer's actor that was collected.
    std::vector<std::optional<Symbol>> collected;
  };
  std::string name;
  std::vector<std::string> writer_names;  // programs and nodes, as the file has them
  std::vector<std::uint32_t> writers;     // programs
  std::vector<Reader> readers;            // at least one
  bool delivers_one = false;              // a write goes to one of the models that take it
  bool meets = false;                     // its ends meet some time after the start
};

// A service of the file: programs and nodes, as the file names them.
struct ServiceInstance {
  std::string name, server;
  std::vector<std::string> clients;
  std::uint32_t model = 0;
};

// A connection of the file, and when its messages arrive.
struct ConnectionInstance {
  std::string name;
  bool is_late = false;
  bool loses = false;  // any message may be lost on its way
  std::string why;     // it is late or not, in words; may be empty
};

// What runs callbacks, and the callbacks of the nodes, in the order of the file. A step that starts
// one names it (CombinedStep::starts).
struct ExecutorInstance {
  std::string name;
  std::uint32_t threads = 1;
  bool goes_by_rounds = false;
};
struct CallbackInstance {
  using Kind = CallbackKind;
  Kind kind = Kind::timer;
  std::string node, name;  // "detector", "detector.on_image"
  std::uint32_t executor = 0;
  std::string group;  // of its node; "" is the node's own
  bool is_reentrant = false;
  std::uint32_t model = 0;  // of a service or client
};

enum class Fairness : std::uint8_t { none, weak, strong };

// A property of the system file. `deadlock`, `stuck` and `error` are there without being written.
struct Property {
  enum class Kind : std::uint8_t { deadlock, stuck, error, ltl, never };
  std::string name;
  Kind kind = Kind::ltl;
  // Of Kind::ltl. An invariant is `G expression`; `possible` is `G !expression`, for it asks for a
  // run that violates this.
  Formula formula;
  bool is_possibility = false;
  // Of Kind::ltl: `formula` is an expression to which some run comes from every state.
  bool is_always_possible = false;
  std::shared_ptr<const LtlAutomaton> never;  // of Kind::never: accepts the runs that are bad
  Fairness fairness = Fairness::weak;
  SourcePosition position;
};

// A constant of the file that has another value than the file's.
struct ConstantSetting {
  std::string name, value;
  bool operator==(const ConstantSetting&) const = default;
};
// "n=5, k=2".
std::string to_string(const std::vector<ConstantSetting>& settings);

struct System {
  std::string file;
  std::vector<ConstantSetting> settings;  // each of another constant
  std::vector<ModelInstance> models;
  std::vector<TopicInstance> topics;
  std::vector<ServiceInstance> services;
  std::vector<ConnectionInstance> connections;
  std::vector<ExecutorInstance> executors;
  std::vector<CallbackInstance> callbacks;
  std::vector<Program> programs;
  std::vector<NobodysAction> nobodys_actions;
  std::vector<std::string> nobodys_groups;  // what their fair groups are called; [0] is not used
  std::vector<Property> properties;         // those of the file
  std::vector<std::string> remarks;         // one line each: what looks like an oversight
  std::vector<std::string> holes;           // what the file leaves out, as it says: nothing "holds"
  std::vector<std::string> open_ends;       // what is said of anybody at the ends, one line each
  std::vector<Expression> expressions;      // of formulas' atoms, which have their numbers
  WordTable words;
  std::map<std::string, std::string> sources;  // texts of the files that programs stand in, by name

  std::vector<ProgramInterface> interfaces() const;  // of the models, in order
  // "s.yaml", or "s.yaml with n=5".
  std::string title() const {
    return settings.empty() ? file : file + " with " + to_string(settings);
  }
};

struct GlobalState {
  std::vector<StateId> models;
  std::vector<ControlState> programs;
  bool is_cut = false;  // the run left what was learned; it has no further step
  bool operator==(const GlobalState&) const = default;
};

// The actor of a step that is no program's.
inline constexpr std::uint32_t nobody = ~std::uint32_t{0};

struct Step {
  std::uint32_t actor = 0;       // a program, or nobody
  std::uint32_t action = 0;      // index into the program's edges, or into nobodys_actions
  std::vector<StateId> targets;  // states afterwards of the models that it uses, in order
  bool is_beyond = false;        // gives an input where it was never tried
  bool is_cut = false;           // and there the model says `stop`: the run is cut
  bool operator==(const Step&) const = default;
};

// Every way in which `model`, in state `at`, can be used so; in the order of its transitions.
// `use` is neither a choice nor combined. O(transitions of the state).
std::vector<ModelStep> model_steps(const ModelInstance& model, StateId at, const ModelUse& use);

GlobalState initial_state(const System& system);
// Every step that is possible in `state`, in a fixed order: those of programs, then nobody's. None
// if the run is cut. O(programs x edges).
std::vector<Step> enabled_steps(const System& system, const GlobalState& state);
// Those of one actor, whatever errors others have come to. None if the run is cut.
std::vector<Step> enabled_steps(const System& system, const GlobalState& state,
                                std::uint32_t actor);
// Whether its actor can take the step, whatever errors others have come to: those of another
// component do not stop it.
bool is_possible(const System& system, const GlobalState& state, const Step& step);
// The state after one of its enabled steps.
GlobalState apply(const System& system, const GlobalState& state, const Step& step);
// The uses of the step, which is one of `state`'s, that give an input where it was never tried.
std::vector<ModelUse> uses_beyond(const System& system, const GlobalState& state, const Step& step);
// The step beyond that model's bounds cuts the run.
bool cuts(const ModelInstance& model, const ModelStep& step);
// No step is left that is progress.
bool is_over(const System& system, const GlobalState& state);
// It is over there, and some program neither has ended nor may rest. A cut run is no
// deadlock, nor is an error.
bool is_deadlock(const System& system, const GlobalState& state);
bool has_ended(const System& system, const GlobalState& state);
// A program is at an error: nothing follows.
bool is_error(const System& system, const GlobalState& state);
// The value of a formula's expression: 0 or 1; 0 if it names a variable that is out of scope, or
// cannot be evaluated.
bool is_true(const Expression& expression, const System& system, const GlobalState& state);

// ---- What a step does, whoever takes it ----

// The models that it uses, in the order of its targets. Valid as long as the system.
std::span<const ModelUse> uses_of(const System& system, const Step& step);
// What an edge of that use is as a combined step, to which other uses may be added. `model`: the
// one that it uses; null of a choice.
CombinedStep as_combined_step(const ModelUse& use, const ModelInstance* model);
// The inputs that it gives and the outputs that it takes.
std::span<const ModelUse> events_of(const System& system, const Step& step);
// Who takes it, for formulas and readers: nobody, where it happens by itself and ends the call of
// the program that is its actor.
std::uint32_t doer_of(const System& system, const Step& step);
// What is lost by it, in words: "a message of image"; "": nothing.
std::string lost_by(const System& system, const Step& step);
// Null if it is one use of one model by a program, or `if *`.
const CombinedStep* combined_step_of(const System& system, const Step& step);
// The edge of a program's step.
const ProgramEdge& edge_of(const System& system, const Step& step);
// It counts for deadlocks (ActorFlags).
bool is_progress(const System& system, const Step& step);
bool is_shown(const System& system, const Step& step);
// Where it stands in the system file.
SourcePosition place_of(const System& system, const Step& step);
// What it was made from, in another file.
std::optional<SourcePosition> origin_of(const System& system, const Step& step);
// The program's name, or "nobody".
std::string actor_name(const System& system, std::uint32_t actor);
// The program's number; nobody's is the next behind them.
std::size_t actor_number(const System& system, std::uint32_t actor);
// Programs, and nobody if he has actions.
std::size_t actor_count(const System& system);

// The program's process has died, and it has not begun anew.
bool is_dead(const System& system, const GlobalState& state, std::uint32_t program);

// Some control state of a program is an error.
bool has_errors(const System& system);
// Some step is no progress.
bool has_idle_steps(const System& system);

// The line of the program's source, without blanks around it; "" if it is not known.
std::string source_line(const System& system, const Program& program, int line);

// What an atom of a formula is in `state`, which was reached by `last` (null: the initial state, or
// one that repeats for ever).
bool is_true(const Atom& atom, const System& system, const GlobalState& state, const Step* last);

// Whether the atom, an event, names one of these inputs and outputs of a step by that actor.
bool is_event_of(const Atom& atom, std::uint32_t actor, std::span<const ModelUse> events);

// Whether `input` was never tried in `state` of the automaton: marked, or drawn as absorbed.
bool is_beyond_learned(const InterfaceAutomaton& automaton, StateId state, Symbol input);

}  // namespace maide
