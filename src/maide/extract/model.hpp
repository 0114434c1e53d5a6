// What was found in the sources: nodes, their ends, callbacks and programs, and what is not known.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "maide/extract/extracted_code.hpp"
#include "maide/extract/sources.hpp"

namespace maide::extract {

struct Frame;
struct Callable;

// What an expression is worth, as far as it matters: which end, object or function it is.
struct Value {
  enum class Kind : std::uint8_t {
    data,      // anything else
    null,      // nullptr
    text,      // a string
    number,    // a literal
    qos,       // text is its depth, empty if it is not known
    status,    // of a wait: condition says whether it was ready
    entity,    // index
    object,    // index
    callable,  // callable
    future,    // index
    mixed,     // one of several that matter
  };
  Kind kind = Kind::data;
  std::string type;       // class; empty: a plain value; `?`: not known
  std::string text;       // of a text or number
  std::string condition;  // of a truth value: over variables of the program; `true`, `false`
  std::string presence;   // of a truth value: the service whose presence it says
  int program = 0;        // in which condition means something
  int index = none;       // of an entity, object, future
  bool is_best_effort = false, is_transient = false;  // of a qos
  bool is_pointer = false;  // of an object: to it, so that a copy is the same object
  std::shared_ptr<Callable> callable;

  // Whether it is lost if nobody follows it.
  bool matters() const {
    return kind == Kind::entity || kind == Kind::object || kind == Kind::callable ||
           kind == Kind::future || kind == Kind::mixed;
  }
};

// An argument that std::bind was given: a value, or the place of an argument of the call.
struct BoundArgument {
  Value value;
  int placeholder = none;
};

struct Callable {
  int function = none;
  Value self;
  std::vector<BoundArgument> bound;
  bool is_bound = false;  // by std::bind
  std::shared_ptr<Frame> frame;
};

// The variables of one activation.
struct Frame {
  std::map<int, Value> values;
  Value self;
  std::shared_ptr<Frame> outer;
  std::vector<Value> returns;
  std::string return_flag, return_value;
  bool has_lambda = false;  // one was made here, and may change what it refers to later
  std::string scope;        // the class or namespace in which the function's names are looked for
};

struct Object {
  std::string of_class;
  std::map<std::string, Value> fields;  // of a class of the sources: by class and name
  int node = none;
  std::string being_made{};    // the class whose constructor runs now
  std::vector<int> holders{};  // objects that have it in a field; none: it stays as long as main
};

struct Entity {
  enum class Kind : std::uint8_t {
    publisher,
    subscription,
    service,
    client,
    timer,
    group,
    mutex,
    condition,
    executor,
    thread
  };
  Kind kind = Kind::publisher;
  std::string name;    // of the topic or service, as in ROS; of a mutex, in the file
  std::string label;   // in the system file
  std::string depth;   // of a publisher or subscription; empty: not known
  std::string type;    // of its messages, as it is written
  std::string period;  // of a timer, in milliseconds; empty: not known
  bool is_best_effort = false, is_transient = false;
  int node = none;
  int group_entity = none;
  bool is_reentrant = false;
  bool is_cancelled = false;      // by some code: then it has a variable
  bool is_once = false;           // a timer that cancels itself
  bool is_looked_for = false;     // its presence, by some code
  std::vector<int> holders;       // objects that have it in a field; none: it stays as long as main
  bool is_asked_without = false;  // a client: requests of which no callback is told
  std::vector<Value> callbacks;
  Place place;
};

struct Program {
  std::vector<Code> code;
  std::vector<CodeVariable> variables;
};

struct Thread {
  std::string label;
  int node = none;
  Value function;
  std::vector<Value> arguments;
  Program program;
  Place place;
};

struct Node {
  std::string name, label;
  std::string space;  // its namespace
  int object = none;
  int executor = none;
  bool is_made_by_main = false;
  Program start;
  std::vector<int> entities;
  Place place;
};

struct Executor {
  std::string label;
  bool is_multi = false;
  std::string threads;  // a number; empty: as many as the machine has
  std::vector<int> nodes;
  Program main;
  bool has_main = false;  // its program is more than `spin;`
  bool is_spun = false;
  Place place;
};

// A function that a library calls when it likes.
struct Watcher {
  Value function;
  Place place;
};

struct Hole {
  std::string text;
  Place place;
  bool is_placed = false;
  auto operator<=>(const Hole&) const = default;
};

struct Model {
  std::vector<Object> objects;
  std::vector<Entity> entities;
  std::vector<Node> nodes;
  std::vector<Executor> executors;
  std::vector<Thread> threads;
  std::vector<Watcher> watchers;
  std::map<int, Program> programs;  // of entities with callbacks
  std::vector<Hole> holes;
  std::vector<std::string> remarks;
};

}  // namespace maide::extract
