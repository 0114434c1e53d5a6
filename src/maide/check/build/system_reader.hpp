// The reader of a system file: what it knows while it reads, and the order in which it does. Names
// of programs come first, for topics refer to them; texts of programs come last, for they name all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/check/build/queue_growth.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/language/program_syntax.hpp"
#include "maide/check/rules/built_in_models.hpp"
#include "maide/check/text/yaml_reader.hpp"

namespace maide {

inline constexpr std::size_t max_components = 10'000;  // models, and programs
// Of a topic. A write is a step for each set of readers that live.
inline constexpr std::ptrdiff_t max_mortal_readers = 8;

class SystemReader : private YamlReader {
 public:
  SystemReader(std::string_view text, const std::string& file, const ModelSource& source,
               const QueueLimits& limits = {}, RunControl control = {});

  System read();

 private:
  using Indices = std::map<std::string, Expression>;
  using Ends = std::map<std::string, std::vector<End>>;  // by actor
  program_syntax::Context context(Indices indices = {});
  // Models, programs, constants and variables share one space of names.
  void take_name(const std::string& name, const YAML::Node& key);
  program_syntax::Declared declared(const YAML::Node& key);
  static Indices indices_of(const program_syntax::Declared& declared, std::uint64_t member);
  void read_constants(const YAML::Node& section);
  void read_procedures(const YAML::Node& section);
  void read_variables(const YAML::Node& section);
  void read_models(const YAML::Node& section);
  Ends read_ends(const YAML::Node& node);
  // Each is one of the model's actors, where it names actors.
  void check_ends(const ModelInstance& model, const YAML::Node& ends) const;
  ModelInstance read_model(const std::string& instance, const YAML::Node& key,
                           const YAML::Node& value);
  // The model that the request asks for. A UsageError has its place: the option that it names, or
  // else the system.
  InterfaceAutomaton ask_source(const ModelRequest& request, const YAML::Node& model) const;
  // As it is written, or the value of the constant of that name.
  std::string option_value(const YAML::Node& setting) const;
  void make_built_in(ModelInstance& model, std::uint32_t number, const Indices& indices,
                     const YAML::Node& value);
  struct Queue {
    QueueSize size;
    std::vector<ValueType> types;         // of what is written, by place; none: nothing has a value
    std::optional<ModelRequest> learned;  // the queue is a model that was learned without values
  };
  // What is written has a value of that type, too.
  void note_value(std::uint32_t model, const program_syntax::Event& input, std::size_t place,
                  const ValueType& type);
  // A learned model that programs may write values into.
  void note_learned(std::uint32_t model);
  // The queue's automaton with all values that are written into it; of a learned one as yet only
  // the names of its inputs and outputs.
  void make_valued(std::uint32_t model);
  // The learned models with all values that are written into them.
  void learn_values();
  // A queue of the file: the automaton with all its states, or one that grows.
  void make_queue_of(ModelInstance& model, std::uint32_t number, const QueueSize& size);
  [[noreturn]] void fail_large_queue(std::uint32_t model) const;
  struct ProgramText {
    std::string name;
    ScalarText text;
    Indices indices;
    bool may_die = false;
    std::set<std::string> own;  // variables of the file that are this one's alone
    std::shared_ptr<program_syntax::Thread> thread;  // it runs callbacks, and has no text
    std::vector<std::string> nodes;                  // whose they are
    std::string execution;                           // "on one thread, in any order"
  };
  // Names and texts, which topics refer to.
  void declare_programs(const YAML::Node& section);
  // ---- services, executors, nodes ---------------------------------------------------------------

  struct Executor {
    std::string name;
    std::uint32_t threads = 1;
    bool goes_by_rounds = false;
    YAML::Node key;
    std::vector<std::uint32_t> nodes;
  };
  struct NodeOf {
    std::string name;
    Indices indices;
    YAML::Node key, value;
    std::uint32_t executor = 0;
    std::map<std::string, bool> groups;  // whether it is reentrant, by name
    std::vector<program_syntax::Callback> callbacks;
    std::vector<std::string> callback_groups;  // "" is the node's own
    std::vector<std::uint32_t> programs;       // that run them
  };
  void declare_executors(const YAML::Node& section);
  void declare_nodes(const YAML::Node& section);
  void read_services(const YAML::Node& section);
  void read_service(const std::string& name, const Indices& indices, const YAML::Node& key,
                    const YAML::Node& value);
  // Programs and nodes that the text names.
  std::vector<End> ends_named(const YAML::Node& node, const Indices& indices);
  // The members of the array that a text names: "a", "a[i]".
  std::vector<std::uint32_t> members_named(const YAML::Node& node, const ModelName& array,
                                           const Indices& indices);
  std::vector<std::uint32_t> services_named(const YAML::Node& node, const Indices& indices);
  void read_callbacks(NodeOf& node);
  void read_callback(NodeOf& node, const YAML::Node& key, const YAML::Node& value);
  // The code of `do: unknown`: it asks a model that knows nothing.
  ScalarText make_unknown(const program_syntax::Callback& callback, const YAML::Node& key);
  // Of each service that has the node as a client.
  void read_clients(NodeOf& node);
  void check_plain_name(const YAML::Node& key, const std::string& what) const;
  void check_taken(const program_syntax::Callback& callback) const;
  void check_server(const NodeOf& node) const;
  std::string group_named(const NodeOf& node, const YAML::Node& value) const;
  // The programs that run the callbacks, and the models of the services.
  void make_threads();
  void make_thread(const std::string& name, const Executor& executor,
                   std::vector<program_syntax::Callback> callbacks,
                   const std::vector<std::uint32_t>& nodes);
  void make_groups(const Executor& executor, NodeOf& node, std::uint32_t number);
  std::uint32_t add_hidden_model(const std::string& name, InterfaceAutomaton automaton,
                                 const YAML::Node& key);
  std::uint32_t runs_of(const NodeOf& node, std::size_t callback) const;
  void make_services();
  void read_node_variables(const NodeOf& node);
  // The node's callbacks that take from that topic; only the one of that name, unless it is empty.
  std::vector<std::string> takers_of(const NodeOf& node, const std::string& callback,
                                     const std::string& topic);
  program_syntax::Tree parse(std::uint32_t program, const program_syntax::Context& known) const;
  // When collect() is done.
  program_syntax::Tree parse_as_known(std::uint32_t program,
                                      const program_syntax::Context& known) const;

  void read_programs();
  // Parses their texts; actions of models are made as they are needed.
  void make_programs(ModelActions& actions);
  static void name_callbacks(Program& program, const program_syntax::Thread& thread);
  void read_topics(const YAML::Node& section);
  // A program's number for each that the text names: "a", "a[2]", or all members of "a"; of a node
  // those of the programs that run its callbacks.
  std::vector<std::uint32_t> programs_named(const YAML::Node& node, const Indices& indices);
  // Nodes that share an executor are run by one program, which is there once.
  std::vector<std::uint32_t> writers_named(const YAML::Node& node, const Indices& indices);
  // Readers of a topic: programs, and callbacks of nodes.
  struct ReaderEnd {
    std::uint32_t program = 0;
    std::string callback, name;  // "detector.on_image" and "detector", where that says it
  };
  std::vector<ReaderEnd> readers_named(const YAML::Node& node, const Indices& indices,
                                       const std::string& topic);
  void read_topic(const std::string& name, const Indices& indices, const YAML::Node& key,
                  const YAML::Node& value);
  // Under `readers_with:` each reader is there once.
  void check_own_options(const YAML::Node& own, const Indices& indices, const std::string& topic);
  // The variable that says whose call has not returned, where that matters.
  void make_caller(Topic& topic, const YAML::Node& key);
  // The reader's model, with its own options.
  Topic::Reader make_reader(const std::string& topic, const ReaderEnd& end, const Indices& indices,
                            const YAML::Node& key, const YAML::Node& value,
                            const YAML::Node& own_options);
  // What becomes of the model because programs stand at its ends: it is a topic's reader's, or some
  // of them may die.
  void add_ends(std::uint32_t model);
  // A program that may die is of the component of all models at whose ends it stands, named or not.
  void name_ends(Program& program, std::uint32_t number) const;
  void add_topic_ends(const Topic& topic, Topic::Reader& reader, ModelInstance& instance);
  void add_model_ends(std::uint32_t model, const Ends& ends);
  // Topics as the system has them.
  void keep_topics();
  // Which programs use which variables of the file, and which values are written into queues: found
  // by reading the programs until nothing new comes. Errors are found again afterwards.
  void collect();
  [[noreturn]] void fail_growing_queue() const;
  // Variables that several programs use become models of their own.
  void make_shared_variables();
  // For formulas: where the variables stand that belong to one program.
  void find_own_variables();
  void read_properties(const YAML::Node& section);
  void read_property(const YAML::Node& key, const YAML::Node& value);
  std::vector<FormulaInstance> formulas(const YAML::Node& node);
  FormulaScope scope() const;
  std::vector<FormulaInstance> invariants(const YAML::Node& node);
  // The automaton of a file, whose name is relative to the system file's folder.
  std::shared_ptr<const LtlAutomaton> read_never(const YAML::Node& node) const;
  void remark_on_what_is_unknown();
  void remark_on_unused_models();
  void remark_on_silent_connections();
  void remark_on_unused_variables();
  void remark_on_unreachable_statements();
  // Atoms that hold nowhere, for the program never ends, or never comes to the label.
  void remark_on_idle_atoms();
  const ModelSource& source_;
  QueueLimits limits_;
  RunControl control_;
  System system_;
  Names names_;
  std::map<std::string, SourcePosition> taken_;
  std::map<std::uint32_t, Queue> queues_;  // by model
  GrowingModels growing_;                  // large queues, and services
  std::vector<Executor> executors_;
  std::map<std::string, std::uint32_t> executor_names_;
  std::vector<NodeOf> nodes_;
  std::map<std::string, ModelName> node_arrays_;     // `first` is a node
  std::map<std::string, ModelName> service_arrays_;  // `first` is a model
  ModelRequest last_request_;                        // of the model that was read last
  std::vector<ProgramText> texts_;
  std::map<std::string, ModelName> program_arrays_;  // `first` is a program
  // Of a reader's model its topic, and its place among the readers.
  std::map<std::uint32_t, std::pair<std::size_t, std::size_t>> topic_of_;
  std::map<std::uint32_t, const Ends*> ends_of_;  // of models, those of names_
  bool has_new_values_ = false;
  std::map<std::size_t, ParseError> first_errors_;  // by program: what collect() met last
  std::set<std::string> own_;                       // variables of the file that one program uses
  std::vector<VariableName> unused_variables_;
  std::vector<ProgramInterface> interfaces_;
};

}  // namespace maide
