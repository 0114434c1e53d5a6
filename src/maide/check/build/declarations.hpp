// What a system file declares, with its names resolved: constants, programs, nodes and who runs
// their callbacks, models and where they come from, topics and services with their ends. No model
// was asked for yet, so what its inputs and outputs are is not known.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/build/model_source.hpp"
#include "maide/check/language/program_tree.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/rules/service_model.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/tree/system_tree.hpp"

namespace maide {

inline constexpr std::size_t max_components = 10'000;  // models, and programs

using Indices = std::map<std::string, Expression>;     // of an array, those of one member
using Ends = std::map<std::string, std::vector<End>>;  // of a model, by actor

struct ProgramDeclaration {
  std::string name;
  std::shared_ptr<const syntax::Code> code;  // null: it runs callbacks
  Indices indices;
  bool may_die = false;        // by whatever
  bool is_anybody = false;     // it stands for whom the file does not know
  bool may_stay_away = false;  // and need not do anything on formulas' runs
  std::shared_ptr<program_syntax::Thread> thread;
  std::vector<std::string> nodes;  // whose callbacks it runs
  std::string execution;           // "on one thread, in any order"
  std::string process;             // programs of one process have the same name here
  SourcePosition position;         // where its text begins, or what runs it is named
};

// The tree of its text, or of the thread that runs its callbacks. Throws ParseError.
program_syntax::Tree resolve(const ProgramDeclaration& program,
                             const program_syntax::Context& known);

struct ExecutorDeclaration {
  std::string name;
  std::uint32_t threads = 1;
  bool goes_by_rounds = false;
  const TreeNode* entry = nullptr;  // of the executor, or of the node that has one of its own
  std::vector<std::uint32_t> nodes;
};

struct NodeDeclaration {
  std::string name;
  Indices indices;
  const TreeNode* entry = nullptr;
  std::uint32_t executor = 0;
  std::map<std::string, bool> groups;  // whether it is reentrant, by name
  std::vector<program_syntax::Callback> callbacks;
  std::vector<std::string> callback_groups;  // "" is the node's own
  std::vector<std::uint32_t> programs;       // that run them
  std::optional<std::uint32_t> clock;        // the program that reads its clock
};

// Where the automaton of a model comes from.
struct ModelOrigin {
  enum class Kind : std::uint8_t {
    made,      // it is there: by rules, or what runs callbacks
    asked,     // of a ModelSource
    copied,    // of an array: that of its first member
    built_in,  // `built_in`, of `count`
    recursive_mutex,
    condition,
    queue,  // of `size`
  };
  Kind kind = Kind::made;
  ModelRequest request;
  std::vector<const TreeNode*> options;  // those of the request, for messages
  std::uint32_t first = 0;               // of a copy
  const BuiltInModel* built_in = nullptr;
  std::uint32_t count = 0;                 // of a mutex: whether it has `trylock`
  const TreeNode* of_condition = nullptr;  // the option that names its mutex
  QueueSize size;
  const YamlNode* ends = nullptr;  // what the file says under `ends:`
};

// What the file says about how messages get to a model.
struct DeliveryWish {
  std::optional<Delivery> delivery;
  std::optional<bool> loses;
  std::optional<std::uint32_t> pub_depth, depth;  // its own, not those of one reader
  bool has_depth = false;                         // it says one, be it no plain number
  bool keeps_all = false;                         // `pub-history`, or `history`
  bool is_best_effort = false;
  std::string stream;  // one order with all that says the same; may be empty
};

struct Declarations {
  std::shared_ptr<const SystemTree> source;  // entries point into it
  WordTable words;
  Names names;
  std::vector<ProgramDeclaration> programs;
  std::vector<ExecutorDeclaration> executors;
  std::vector<NodeDeclaration> nodes;
  std::vector<ModelInstance> models;
  std::vector<ModelOrigin> origins;              // by model
  std::map<std::uint32_t, ServiceShape> shapes;  // of the rules of services, by model
  std::vector<ServiceInstance> services;
  std::vector<CallbackInstance> callbacks;
  // Of a reader's model its topic, and its place among the readers.
  std::map<std::uint32_t, std::pair<std::size_t, std::size_t>> topic_of;
  bool is_at_rest = false;    // all messages arrive at once, whatever the file says
  bool asks_at_once = false;  // some text has `tryread`, which queues then have as an input
  bool tries_locks = false;   // some text has `trylock`, which mutexes then have
  std::map<std::uint32_t, DeliveryWish> deliveries;  // by model, of topics' readers, too
  std::map<std::uint32_t, std::string> ends_of;      // of models with ends: their name, in `names`

  // Names of the file. `first` of an array is the number of its first member.
  std::map<std::string, SourcePosition> taken;
  std::map<std::string, ModelName> program_arrays, node_arrays, service_arrays;
  std::map<std::string, std::uint32_t> executor_names;

  // The program that stands for anybody where he does nothing that has a step.
  std::optional<std::uint32_t> silent_anybody{};
  std::vector<std::string> open_ends{};  // what he does, one line each

  const SystemTree& tree() const { return *source; }
  program_syntax::Context context(Indices indices = {}) {
    return {models, names, words, 0, {}, std::move(indices), nullptr, nullptr, {}};
  }
  // Models, programs, constants and variables share one space of names.
  void take_name(const std::string& name, SourcePosition place);
};

// Resolves all names of the file's own. Throws ParseError.
Declarations declare(SystemTree tree, Deliveries deliveries = Deliveries::as_said);

// ---- The parts of declare() ----

void declare_constants(Declarations& file);
void declare_programs(Declarations& file);
void declare_executors(Declarations& file);
void declare_nodes(Declarations& file);
void declare_services(Declarations& file);
void declare_callbacks(Declarations& file);
// Models that know nothing, for code that says `unknown`.
void declare_unknown(Declarations& file);
// Variables that say which timers are due that go by a clock.
void declare_due(Declarations& file);
// Variables that say whether services are there, for those that are offered by some text.
void declare_presence(Declarations& file);
// The programs that run the callbacks, the models of their threads, the shapes of the services.
void declare_threads(Declarations& file);
// Which processes may die and begin anew. Part of declare_threads().
void declare_lives(Declarations& file);
void declare_models(Declarations& file);
void declare_topics(Declarations& file);
void declare_procedures(Declarations& file);
// Who uses mutexes that know their holder, and conditions.
void declare_locks(Declarations& file);
void declare_variables(Declarations& file);

// ---- What they share ----

struct DeclaredArray {
  std::string name;
  std::vector<std::string> indices;
  Dimensions dimensions;

  std::uint64_t count() const { return member_count(dimensions); }
  std::string member(std::uint64_t number) const {
    return name + member_suffix(dimensions, number);
  }
  Indices indices_of(std::uint64_t number) const;
};
// What the entry's key declares; the name is taken.
DeclaredArray declare_array(Declarations& file, const TreeNode& entry);
// The value of a number that is known at once.
Expression constant_of(Declarations& file, const syntax::Term& term, const Indices& indices = {});
// A number from 1 to `most`; 0 of any other.
std::uint32_t count_of(const Expression& value, std::uint32_t most);
// A name without signs that have a meaning elsewhere. `what`: "an executor".
void check_plain_name(const Declarations& file, const TreeNode& entry, const std::string& what);
// `options`: those of the connection itself, by name.
DeliveryWish read_delivery(const Declarations& file, const TreeNode& entry,
                           const std::map<std::string, std::string>& options);
// The process that the entry of a program or executor names, or one of its own.
std::string process_of(const TreeNode& entry, const std::string& name);
// That of the program or node.
std::string process_of_end(const Declarations& file, const End& end);
// The programs that run its code.
std::vector<std::uint32_t> programs_at(const Declarations& file, const End& end);
// Any of them may.
bool may_die(const Declarations& file, const End& end);
// A model that no text names. Throws ParseError: there are too many.
std::uint32_t add_hidden_model(Declarations& file, const std::string& name,
                               InterfaceAutomaton automaton, const SourcePosition& position);
// What a callback does: of one with outcomes several texts; of a client perhaps none.
std::vector<const syntax::Code*> codes_of(const program_syntax::Callback& callback);
// Runs of a callback at one time.
std::uint32_t runs_of(const Declarations& file, const NodeDeclaration& node, std::size_t callback);

}  // namespace maide
