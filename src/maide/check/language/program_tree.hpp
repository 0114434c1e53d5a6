// The syntax tree of a control program, between its parser and its unrolling into an automaton.
// Names are resolved while parsing, where their place is known; procedures stand in the tree where
// they are called. A variable is a row of slots: one, or one for each member of an array.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/check/language/code.hpp"
#include "maide/check/language/expression.hpp"
#include "maide/check/language/program.hpp"
#include "maide/check/language/system_names.hpp"

namespace maide {
struct ModelInstance;
}

namespace maide::program_syntax {

struct Statement;
struct Block {
  std::vector<Statement> statements;
  std::vector<std::uint32_t> slots;  // of the variables declared in it; they end with it
  bool is_procedure = false;         // `return` leaves it
  bool is_callback = false;          // so does `stop`
};

// A model or topic; of an array the member that the indices name.
struct ModelReference {
  Expression leaf;  // as of a shared variable: `index` is the first instance or topic
  bool is_topic = false;
  const ModelName* known = nullptr;
  std::string reader;  // of what was sent to a topic: the one that is meant; empty: all
  std::string name() const { return leaf.name; }
};

// `write`, `write(e)`, `message(x)`: an input or an output with its arguments.
struct Event {
  struct Argument {
    Expression expression;  // of a value; or the variable that takes it
    bool binds = false;
    ValueType type;  // of the variable
  };
  std::string name;
  std::string node;            // of the callback that it is in; empty: it is in none
  bool is_any = false;         // an output, whatever its name
  bool has_arguments = false;  // without, an output is any of that name
  std::vector<Argument> arguments;
  int line = 0, column = 0;
};

// What comes back from a model, and what is done then.
struct Arm {
  bool is_quiet = false;
  Event output;  // unless quiet
  int line = 0, column = 0;
  std::unique_ptr<Block> body;
};

// A callback of a node, as the thread that runs it sees it.
struct Callback {
  using Kind = CallbackKind;
  Kind kind = Kind::timer;
  std::uint32_t number = 0;                    // among all callbacks
  std::string node;                            // "detector[0]"
  std::string name;                            // "on_image"; of a client its service
  std::shared_ptr<const syntax::Taken> takes;  // of a subscription: "t.read -> message(var k)"
  // What it does. Null: a client that hands answers to the callbacks that asked, or there are
  // outcomes.
  std::shared_ptr<const syntax::Code> code;
  // `do: {next: "...", gap: "..."}`: outputs, and what is done then.
  std::vector<std::pair<std::shared_ptr<const syntax::Event>, std::shared_ptr<const syntax::Code>>>
      outcomes;
  std::map<std::string, Expression> indices;  // of an array of nodes: this one's
  std::uint32_t model = 0;                    // of a service or client
  std::shared_ptr<const syntax::Term> when;   // where it does not hold it does not start
  bool comes_once = false;                    // of a timer
  bool goes_by_clock = false;                 // so: it is due when a variable says so
  std::uint32_t copies = 1;                   // of a thread
  std::uint32_t run = 0;                      // of its runs at one time: the number
  std::uint32_t asker = 0;                    // among all runs of its node's callbacks
  std::vector<ModelUse> start, end;  // what starting and ending does with threads and its group
  SourcePosition position;

  std::string whole_name() const { return node + "." + name; }
};

// What runs callbacks one after the other: a single-threaded executor, or one group of a node's.
struct Thread {
  std::vector<Callback> starts;     // of its nodes: they come first, once
  std::optional<Callback> main;     // what spins then; none: it spins for ever
  std::vector<Callback> callbacks;  // in a round's order
  bool goes_by_rounds = false;      // else whichever can start
  std::string executor;             // its name
  bool may_spin = true;             // it has all that its starts may spin

  std::vector<const Callback*> all() const {
    std::vector<const Callback*> all;
    for (const Callback& callback : callbacks) all.push_back(&callback);
    return all;
  }
};

struct SelectArm {
  enum class Kind : std::uint8_t {
    input,
    output,
    arrival,
    guard,
    otherwise,
    timeout,
    service,
    wake,           // at the condition `model`: it was notified, and has its mutex again
    wake_causeless  // it was not notified
  };
  Kind kind = Kind::guard;
  std::optional<Expression> guard;
  ModelReference model;         // of an input, an output, an arrival, or of waking
  Event event;                  // so
  std::vector<Arm> arms;        // of an input: the outputs that may follow at once; else empty
  std::unique_ptr<Block> body;  // unless there are arms
  std::unique_ptr<Block> end;   // of an arm that starts a callback: what is behind its code
  const Callback* callback = nullptr;  // in whose code it stands
  const Callback* starts = nullptr;    // the arm starts it; of Kind::service by what came for it
  std::optional<Expression> came;      // of a timer that comes once: the variable that says it has
  std::optional<Expression> due;  // of one that goes by a clock: the shared one that says it is
  int line = 0, column = 0;
};

struct Statement {
  enum class Kind : std::uint8_t {
    give,     // `input` to `model`, then one of `arms` (none: nothing is awaited)
    wait,     // one of `arms` of `model`
    arrival,  // until all that was sent to `model` has arrived
    matched,  // until `copies` other ends of the topic `model` are met
    loop,     // `body`
    repeat,   // `body`, `expression` times
    choice,   // `body` or `otherwise`
    skip,
    stop,
    assign,  // `expression` to `target`; a declaration, too, which sets every slot
    choose,  // a value of `expression`..`upper` to `target`; without them any of its type
    when,    // `body` if `expression`, else `otherwise`
    repeat_while,
    repeat_for,  // `body` with `target` from `expression` to `upper`
    leave,       // break
    next_round,  // continue
    leave_procedure,
    leave_callback,
    inner,   // `body`: a procedure
    atomic,  // `body`: assignments and `when` alone
    select,
    rounds,        // its arms, as a look finds something for them; the look's result is `target`
    end_callback,  // whose requests to `services` are nobody's from here on
    withdraw,      // the service `model`
    run,           // a copy of the thread whose copies are `copies`
    join,          // until all of them are ended
    relock,        // takes the mutex of the condition `model` again
    spin,          // runs callbacks, which are arms, as `spin` says
    kill,          // the process whose place among Names::lives is `life`
    restart,       // so, and it begins anew
    end_process,   // so: the own one
    refused_spin,  // the node has been added to an executor
  };
  Kind kind = Kind::skip;
  int line = 0, column = 0;
  std::optional<SourcePosition> origin;  // what it was made from, in another file
  bool is_idle = false;                  // may rest here
  bool is_fair = false;                  // of a choice
  bool is_one_sided = false;             // so: fair to `body` alone
  std::vector<std::uint32_t> labels;     // indices into Tree::labels
  ModelReference model;
  Event input;
  std::vector<Arm> arms;
  std::vector<SelectArm> select_arms;
  Expression target;        // a variable
  ValueType type;           // its type
  std::uint32_t slots = 0;  // of a declaration: how many it sets; else 0
  std::optional<Expression> expression;
  Expression upper;
  std::unique_ptr<Block> body, otherwise;
  const Callback* callback = nullptr;  // in whose code it stands
  std::vector<std::uint32_t> services;
  std::uint32_t copies = 0;  // the model; of Kind::matched: how many
  std::size_t life = 0;
  syntax::Statement::Spin spin = syntax::Statement::Spin::once;
  bool goes_by_rounds = false;           // of a spin: in the order of the arms
  std::optional<std::uint32_t> counter;  // of a spin of `upper` callbacks at most: the variable
};

struct Tree {
  Block statements;
  std::vector<std::string> labels;
  std::vector<ProgramVariable> slots;
  std::vector<std::optional<Value>> initial;  // by slot: where the program begins
  std::vector<std::uint32_t> names;           // models that the text names, arrays whole; sorted
  std::set<std::string> file_variables;       // of those under `variables:`, the ones that it names
};

// What a program's text is read with.
struct Context {
  const std::vector<ModelInstance>& models;
  const Names& names;
  WordTable& words;
  std::uint32_t program = 0;  // its number
  // Variables that belong to this program alone, of those under `variables:`.
  std::set<std::string> own;
  std::map<std::string, Expression> indices;  // of an array of programs: this one's
  const Callback* callback = nullptr;         // in whose code this stands
  const Callback* starts = nullptr;           // what it takes is this text
  // Called for each argument of an input, with the values that it may have; for queues, whose
  // values are those that are written.
  std::function<void(std::uint32_t model, const Event& input, std::size_t place,
                     const ValueType& type)>
      on_value;
  // What is not known yet is not checked. Each stage knows what those before it know.
  enum class Stage : std::uint8_t {
    names,   // of the file's own
    models,  // their inputs and outputs, but for the values that queues carry
    owners,  // which variables are shared, and the types of what queues carry
    values,  // that occur in queues
  };
  Stage stage = Stage::values;
};

// What the values of an output's or input's argument are in an alphabet: of "message(3)" and
// "message(5)" the numbers 3 to 5. None: no such name has an argument there.
std::optional<ValueType> argument_type(const Alphabet& alphabet, const std::string& name,
                                       std::size_t place, WordTable& words);
// "message(3)" is message and 3; "message" alone is message and nothing.
struct NameParts {
  std::string name;
  std::vector<std::string> arguments;
};
NameParts split_name(const std::string& symbol);
// What such an argument stands for.
std::pair<ValueKind, Value> read_value(const std::string& text, WordTable& words);

}  // namespace maide::program_syntax
