// What the texts of a system file may name: models, variables, constants, procedures. An array's
// name stands for all its members, which lie side by side, the last index running fastest.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/language/code.hpp"
#include "maide/check/language/expression.hpp"
#include "maide/check/language/program.hpp"

namespace maide {

class LifeRules;
class ServiceModel;
class StreamModel;
class WireModel;

using Dimensions = std::vector<Expression::Dimension>;  // none: no array

// Members of an array; 1 without dimensions. At most max_array_members, which readers check.
std::uint64_t member_count(const Dimensions& dimensions);
inline constexpr std::uint64_t max_array_members = 10'000;
// "[0,2]" of the member with that number; "" without dimensions.
std::string member_suffix(const Dimensions& dimensions, std::uint64_t member);
// The indices of the member with that number.
std::vector<Value> member_indices(const Dimensions& dimensions, std::uint64_t member);

// Who stands at an end: a program, or a node, whose callbacks may be several programs.
struct End {
  std::uint32_t program = 0;
  std::string node;  // empty: it is a program
  // Whether the code that runs there is the end's: that of a node's callback, or of the program.
  bool is_of(const std::string& its_node, std::uint32_t its_program) const {
    return node == its_node && (!node.empty() || program == its_program);
  }
};

struct ModelName {
  std::uint32_t first = 0;  // the instance or topic; of an array its first member
  Dimensions dimensions;
  bool is_topic = false;
  // Who stands at which end, in order: the second writer's `write` is `write2`. By actor.
  std::map<std::string, std::vector<End>> ends;
};

// What a topic's readers see is a model each; its writers' inputs go to all of them.
struct Topic {
  struct Reader {
    std::uint32_t program = 0;
    std::uint32_t model = 0;  // the instance
    std::string callback;     // of a node, that takes from it: "detector.on_image"; else empty
    // By state of that model: the output of the writer's actor that was collected, and the state
    // behind its taking.
    std::vector<std::optional<Symbol>> collected;
    std::vector<StateId> cleared;
    std::optional<StateId> gone;  // the state in which the reader has died; none if it may not
    // By state: what the death of the writer does whose call has not returned; empty: nothing.
    std::vector<std::vector<ModelStep>> writer_death;

    bool has_returns() const {
      return std::ranges::any_of(collected, [](const auto& output) { return output.has_value(); });
    }
  };
  std::string name;
  SourcePosition position;
  std::vector<std::string> writer_names;  // as the file has them
  std::set<std::uint32_t> writers;
  std::set<std::string> writer_nodes;  // of them those that are nodes
  std::vector<Reader> readers;         // at least one
  bool delivers_one = false;           // a write goes to one of the models that take it
  bool meets = false;                  // each writer and reader meet some time after the start
  bool keeps_for_late = false;         // what is written before they meet comes then, the newest
  // The variable that says whose call has not returned, where there are several writers of which
  // some may die. Its values: `nobody`, and a word for each of `mortal`.
  std::optional<std::uint32_t> caller;
  Value nobody = 0;
  std::map<std::uint32_t, Value> mortal;  // writers that may die

  // `node`: that of the callback whose code is meant; empty: any code of the program.
  bool has_end(std::uint32_t program, bool writes, const std::string& node = "") const {
    if (writes) return writers.contains(program) && (node.empty() || writer_nodes.contains(node));
    return std::ranges::any_of(readers, [&](const Reader& reader) {
      return reader.program == program && reader.callback.empty();
    });
  }
};

// Where what is on its way comes in one order with what else is: the model of that order, and the
// number there.
struct PlaceInStream {
  std::shared_ptr<StreamModel> order;  // null: nowhere
  std::uint32_t stream = 0, number = 0;
};

// Who stands at the ends of a service: programs and nodes.
struct Service {
  std::string name;
  End server;
  std::vector<End> clients;
  std::uint32_t depth = 10;
  bool is_depth_unknown = false;
  std::string rmw;                // of ROS 2: "cyclonedds", "fastrtps"; empty: not said
  bool takes_one_by_one = false;  // of Fast DDS: one answer, whosever it is
  ServiceModel* rules = nullptr;
  std::uint32_t group = 0;  // the first of its arrivals among System::nobodys_groups
  // The programs that may answer, where an answer returns when all clients have it; else empty.
  std::vector<std::uint32_t> callers;
  // By client, where what is on its way is in a stream.
  std::vector<PlaceInStream> requests_in, answers_in;
  std::uint32_t server_runs = 1;  // of its callback, at once
  // Nodes whose client has code of its own, and whose other code waits for no answer.
  std::set<std::string> own_code;
  // The variable that says whether the server is there; none: it always is.
  std::optional<std::uint32_t> presence;
  // Anybody is the server: he answers what he likes when he likes, each request at last, or, where
  // that is said, some never.
  bool is_server_anybody = false, may_not_answer = false;
  // The client that is anybody; and whether he is the only one, so that a request may be there at
  // any time.
  std::optional<std::uint32_t> anybody;
  bool is_open = false;

  // The number of the client; none if it is none.
  std::optional<std::uint32_t> client_of(const std::string& node, std::uint32_t program) const;
  bool is_server(const std::string& node, std::uint32_t program) const;
};

// What a node's code is for. Callbacks come first, in the order in which a round has them; the
// node's start and its threads are no callbacks of an executor, nor is what spins the executor,
// which is of its first node.
enum class CallbackKind : std::uint8_t {
  timer,
  subscription,
  service,
  client,
  start,
  thread,
  main
};
inline bool is_of_executor(CallbackKind kind) { return kind < CallbackKind::start; }

// The variable that says whether the service is there: "lookup.there".
inline std::string presence_of(const std::string& service) { return service + ".there"; }
// The variable that says whether a timer that goes by a clock is due: "robot.tick.due".
inline std::string due_of(const std::string& callback) { return callback + ".due"; }

// The input or output `name` of the client with that number, from 0, of a service: "send" of the
// first client, "send2" of the second.
std::string name_at_client(const std::string& name, std::uint32_t client);

// Whether the actor "writer" has that input or output, which stands without values.
bool is_of_writer(const InterfaceAutomaton& model, const std::string& name);

// Whether the input of a model that is no topic's sends something: "write", "send2", "publish(3)".
bool is_sending(const std::string& input);

// Whether the output is one of the actor that the input belongs to.
bool is_of_same_actor(const InterfaceAutomaton& automaton, Symbol input, Symbol output);

// "send2" of "send".
inline bool is_numbered(const std::string& known, const std::string& name) {
  return known.starts_with(name) &&
         known.find_first_not_of("0123456789", name.size()) == std::string::npos;
}

// A node's subscriptions are readers of their own: "image[detector.on_image]".
inline bool is_reader_of(const std::string& model, const std::string& name) {
  return name.ends_with(']') && model.starts_with(name.substr(0, name.size() - 1) + ".");
}

// What the instance of a wire is called: "map<-server", "image[logger]<-camera"; without a writer
// the one that counts for all of them.
std::string wire_name(const std::string& model, const std::string& writer);
bool is_wire_to(const std::string& wire, const std::string& model);
struct WireEnds {
  std::string model, writer;  // "image[logger]", "camera"
};
WireEnds ends_of_wire(const std::string& wire);
// "via" of "via[2,0]": of what is no member of an array, its name.
std::string array_of(const std::string& name);

// From a writer to a model: what was sent and has not arrived.
struct Wire {
  std::uint32_t model = 0;  // the instance
  std::uint32_t to = 0;     // the model that it leads to
  End from;
  std::string writer;           // its name in the file
  std::vector<Symbol> letters;  // the inputs that lie on it, in the order of its own
  std::vector<Symbol> others;   // inputs of the same actor: they come behind what lies on it
  std::shared_ptr<WireModel> rules;
  // Where that model may refuse an input: the model that counts what is on all wires to it, and by
  // the model's state how many it takes at least, none: any number.
  std::optional<std::uint32_t> counter;
  std::shared_ptr<const std::vector<std::optional<std::uint32_t>>> room;
  PlaceInStream place;
  std::uint32_t group = 0;  // of its arrivals: among System::nobodys_groups
  // Where a call returns when all readers have its message: the programs that may call. Each has
  // one message at most on the wire. Empty: a call returns at once.
  std::vector<std::uint32_t> callers;
};

// A condition: the mutex that it gives back, and the programs that may wait, in order.
struct ConditionVariable {
  std::uint32_t mutex = 0;
  std::vector<std::uint32_t> waiters;
};

// A process of which programs may begin anew, or of which several end at once (life.hpp).
struct Life {
  std::string process;  // what its programs say: "driver"
  std::uint32_t model = 0;
  std::shared_ptr<const LifeRules> rules;
  std::vector<std::uint32_t> programs;    // in the order in which they end and begin
  std::vector<std::string> nodes;         // whose code they run
  std::vector<std::uint32_t> own_models;  // that nobody else uses: they begin anew with it
  bool may_die = false;                   // by itself, at any time
  bool is_told = false;                   // some code tells it to begin anew
  bool may_begin_anew = false;
  std::uint32_t group = 0;  // of its ends and beginnings: among System::nobodys_groups

  // The place among `programs`, of which it is one.
  std::uint32_t number_of(std::uint32_t program) const {
    return static_cast<std::uint32_t>(std::ranges::find(programs, program) - programs.begin());
  }
};

struct VariableName {
  Expression leaf;  // without indices
  ValueType type;
  Value initial = 0;
  bool is_any = false;  // any of its type at first, and `initial` before that is chosen
  SourcePosition position;
  // Whether it says that services are there, of which this is the first. It is shared, whoever
  // uses it.
  std::optional<std::uint32_t> service{};
};

struct Procedure {
  std::vector<std::string> parameters;
  std::shared_ptr<const syntax::Code> code;
  SourcePosition position;
};

struct Names {
  std::map<std::string, ModelName> models;  // and topics
  std::vector<Topic> topics;
  std::map<std::uint32_t, Service> services;         // by model
  std::map<std::uint32_t, std::vector<Wire>> wires;  // by the model that they lead to
  // The types of what programs write into queues, by model and place in `write(3, go)`. The queue's
  // automaton has the values of these that occur. A queue of which nothing is written with values
  // is not there.
  std::map<std::uint32_t, std::vector<ValueType>> carried;
  // What a program's death does to the models at whose ends it stands, by program, model and state.
  std::map<std::uint32_t, std::map<std::uint32_t, std::vector<std::vector<ModelStep>>>> deaths;
  // Those under `variables:`: shared ones are models, others belong to one program.
  std::map<std::string, VariableName> variables;
  std::map<std::string, Expression> constants;
  std::map<std::string, Procedure> procedures;
  std::set<std::string> nodes;
  std::map<std::string, std::uint32_t> threads;  // models of their copies, by "robot.work"
  // Of mutexes that know who holds them, by model: the programs that use it, in order.
  std::map<std::uint32_t, std::vector<std::uint32_t>> holders;
  std::map<std::uint32_t, ConditionVariable> conditions;  // by model
  // What code asks that says `unknown`: models that know nothing.
  std::map<std::string, std::uint32_t> unknown_callbacks;
  std::map<std::uint32_t, std::uint32_t> unknown_programs;

  std::vector<Life> lives;
  std::map<std::string, std::size_t> life_of_name;  // what `kill` takes, to its place there
  std::map<std::uint32_t, std::size_t> life_of_program;

  // Null: it has none, and ends alone.
  const Life* life_of(std::uint32_t program) const {
    const auto place = life_of_program.find(program);
    return place == life_of_program.end() ? nullptr : &lives[place->second];
  }
  // What the code of that program and node sends to the model lies on it; null: it arrives at once.
  const Wire* wire_of(std::uint32_t to, const std::string& node, std::uint32_t program) const;
};

}  // namespace maide
