#include "maide/check/build/system_file.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <variant>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/make_program.hpp"
#include "maide/check/build/system_reader.hpp"
#include "maide/check/language/expression_parser.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/system/model_actions.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

constexpr int max_value_rounds = 20;  // of finding what is written into queues
constexpr std::size_t max_properties = 1000;

}  // namespace

SystemReader::SystemReader(std::string_view text, const std::string& file,
                           const ModelSource& source, const QueueLimits& limits, RunControl control)
    : YamlReader(text, file), source_(source), limits_(limits), control_(std::move(control)) {
  system_.file = file;
  system_.sources.emplace(file, text);
}

System SystemReader::read() {
  const YAML::Node root = load();
  const Entries sections = entries(root, "a system file",
                                   {"constants", "models", "topics", "services", "procedures",
                                    "variables", "programs", "executors", "nodes", "properties"});
  const auto section = [&](std::string_view name) {
    for (const auto& [key, value] : sections) {
      if (key.Scalar() == name) return value;
    }
    return YAML::Node(YAML::NodeType::Undefined);
  };
  if (!section("programs") && !section("nodes")) {
    throw ParseError("there is no 'programs:' and no 'nodes:'", at(root));
  }
  if (const YAML::Node constants = section("constants")) read_constants(constants);
  if (const YAML::Node programs = section("programs")) declare_programs(programs);
  if (const YAML::Node executors = section("executors")) declare_executors(executors);
  if (const YAML::Node nodes = section("nodes")) declare_nodes(nodes);
  if (const YAML::Node services = section("services")) read_services(services);
  make_threads();
  if (const YAML::Node models = section("models")) read_models(models);
  if (const YAML::Node topics = section("topics")) read_topics(topics);
  if (const YAML::Node procedures = section("procedures")) read_procedures(procedures);
  if (const YAML::Node variables = section("variables")) read_variables(variables);
  for (const NodeOf& node : nodes_) read_node_variables(node);
  read_programs();
  keep_topics();
  interfaces_ = system_.interfaces();
  if (const YAML::Node properties = section("properties")) read_properties(properties);
  remark_on_what_is_unknown();
  remark_on_unused_models();
  remark_on_silent_connections();
  remark_on_unused_variables();
  remark_on_unreachable_statements();
  remark_on_idle_atoms();
  return std::move(system_);
}

program_syntax::Context SystemReader::context(Indices indices) {
  return {system_.models, names_, system_.words, 0, {}, std::move(indices), nullptr, nullptr, {}};
}

void SystemReader::take_name(const std::string& name, const YAML::Node& key) {
  const auto [place, is_new] = taken_.emplace(name, at(key));
  if (!is_new) {
    fail("the name '" + name + "' is taken: " + to_string(place->second), key);
  }
}

program_syntax::Declared SystemReader::declared(const YAML::Node& key) {
  // Names of old files need not be identifiers.
  program_syntax::Declared result;
  if (key.Scalar().find('[') == std::string::npos) {
    result.name = key.Scalar();
  } else {
    const ScalarText text = text_of(key);
    result = program_syntax::parse_declared(text, context());
  }
  take_name(result.name, key);
  return result;
}

SystemReader::Indices SystemReader::indices_of(const program_syntax::Declared& declared,
                                               std::uint64_t member) {
  Indices indices;
  const std::vector<Value> values = member_indices(declared.dimensions, member);
  for (std::size_t i = 0; i < values.size(); ++i) {
    indices.emplace(declared.indices[i], make_constant(values[i], ValueKind::integer));
  }
  return indices;
}

void SystemReader::read_constants(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'constants'", {})) {
    take_name(key.Scalar(), key);
    scalar(value, "constant '" + key.Scalar() + "'");
    const ScalarText text = text_of(value);
    names_.constants.emplace(key.Scalar(), program_syntax::parse_constant(text, context()));
  }
}

void SystemReader::read_procedures(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'procedures'", {})) {
    std::string name;
    const ScalarText head = text_of(key);
    Procedure procedure = program_syntax::parse_head(head, context(), name);
    scalar(value, "procedure '" + name + "'");
    procedure.text = text_of(value);
    if (!names_.procedures.emplace(name, std::move(procedure)).second) {
      fail("procedure '" + name + "' is there twice", key);
    }
  }
}

void SystemReader::read_variables(const YAML::Node& section) {
  if (!section.IsScalar()) {
    fail("'variables' must be a text, as in variables: \"var n: 0..3; var ok: bool;\"", section);
  }
  const ScalarText text = text_of(section);
  for (VariableName& variable : program_syntax::parse_variables(text, context())) {
    const std::string name = variable.leaf.name;
    const auto [place, is_new] = taken_.emplace(name, variable.position);
    if (!is_new) {
      throw ParseError("the name '" + name + "' is taken: " + to_string(place->second),
                       variable.position);
    }
    variable.leaf.op = Expression::Operator::shared;
    names_.variables.emplace(name, std::move(variable));
  }
}

void SystemReader::declare_programs(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'programs'", {})) {
    const program_syntax::Declared array = declared(key);
    ProgramText text;
    YAML::Node code = value;
    if (value.IsMap()) {
      for (const auto& [name, node] :
           entries(value, "program '" + array.name + "'", {"do", "may_die", "source", "entry"})) {
        if (name.Scalar() == "source" || name.Scalar() == "entry") {
          fail("programs out of sources are not built yet: write '" + array.name +
                   "' in the program language",
               value);
        }
        if (name.Scalar() == "do") code.reset(node);
        if (name.Scalar() == "may_die") {
          text.may_die = one_of<bool>(node, "'may_die'", {{"true", true}, {"false", false}});
        }
      }
      if (code.IsMap()) fail("program '" + array.name + "' needs 'do:'", key);
    }
    scalar(code, "program '" + array.name + "'");
    text.text = text_of(code);
    const std::uint64_t count = member_count(array.dimensions);
    if (texts_.size() + count > max_components) fail("too many programs", key);
    program_arrays_[array.name] = {
        static_cast<std::uint32_t>(texts_.size()), array.dimensions, false, {}};
    for (std::uint64_t member = 0; member < count; ++member) {
      text.name = array.name + member_suffix(array.dimensions, member);
      text.indices = indices_of(array, member);
      texts_.push_back(text);
    }
  }
  if (texts_.empty()) fail("there is no program", section);
}

void SystemReader::read_programs() {
  if (!queues_.empty() || !names_.variables.empty()) collect();
  make_shared_variables();
  ModelActions actions(system_);
  make_programs(actions);
  if (!growing_.empty()) {
    grow_models(system_, actions, growing_, limits_, control_);
    system_.programs.clear();
    ModelActions known(system_, actions.take_all());
    make_programs(known);
  }
  find_own_variables();
}

// Behind an error it was not found out which variables are the program's own. So what is wrong with
// others is not told in its place.
program_syntax::Tree SystemReader::parse_as_known(std::uint32_t program,
                                                  const program_syntax::Context& known) const {
  const auto before = first_errors_.find(program);
  if (before == first_errors_.end()) return parse(program, known);
  try {
    return parse(program, known);
  } catch (const ParseError&) {
    throw before->second;
  }
}

void SystemReader::make_programs(ModelActions& actions) {
  for (std::uint32_t number = 0; number < texts_.size(); ++number) {
    const ProgramText& text = texts_[number];
    program_syntax::Context known = context(text.indices);
    known.program = number;
    known.own = text.own;
    const program_syntax::Tree tree = parse_as_known(number, known);
    system_.programs.push_back(program_syntax::make_program(
        tree, {text.name, number, {}, text.may_die}, text.text, actions, names_));
    system_.programs.back().nodes = text.nodes;
    system_.programs.back().execution = text.execution;
    if (text.thread) name_callbacks(system_.programs.back(), *text.thread);
    if (text.may_die) name_ends(system_.programs.back(), number);
  }
}

void SystemReader::name_callbacks(Program& program, const program_syntax::Thread& thread) {
  for (const program_syntax::Callback& callback : thread.callbacks) {
    std::vector<ScalarText> texts;
    if (callback.has_code && callback.outcomes.empty()) texts.push_back(callback.code);
    for (const auto& [output, code] : callback.outcomes) texts.push_back(code);
    for (const ScalarText& text : texts) {
      program.callbacks.push_back(
          {callback.whole_name(), text.position(0).line, text.position(text.value().size()).line});
    }
  }
}

void SystemReader::collect() {
  std::map<std::string, std::set<std::size_t>> users;
  for (int round = 0;; ++round) {
    has_new_values_ = false;
    for (std::size_t index = 0; index < texts_.size(); ++index) {
      program_syntax::Context known = context(texts_[index].indices);
      known.program = static_cast<std::uint32_t>(index);
      known.on_value = [&](std::uint32_t model, const program_syntax::Event& input,
                           std::size_t place,
                           const ValueType& type) { note_value(model, input, place, type); };
      std::set<std::string> used;
      try {
        used = parse(known.program, known).file_variables;
        first_errors_.erase(index);
      } catch (const ParseError& error) {
        first_errors_.insert_or_assign(index, error);
      }
      for (const std::string& name : used) users[name].insert(index);
    }
    if (!has_new_values_) break;
    for (const auto& [model, queue] : queues_) {
      if (!queue.types.empty()) make_valued(model);
    }
    if (round == max_value_rounds) fail_growing_queue();
  }
  learn_values();
  for (const auto& [name, programs] : users) {
    if (programs.size() != 1) continue;
    texts_[*programs.begin()].own.insert(name);
    own_.insert(name);
  }
  for (const auto& [name, variable] : names_.variables) {
    if (!users.contains(name)) unused_variables_.push_back(variable);
  }
}

void SystemReader::fail_growing_queue() const {
  for (const auto& [model, queue] : queues_) {
    if (queue.types.empty()) continue;
    const ModelInstance& instance = system_.models[model];
    throw ParseError("the values of queue '" + instance.name +
                         "' grow and grow: read them into a variable that is declared with its "
                         "range",
                     instance.position);
  }
  throw ParseError("the values of queues grow and grow", {system_.file, 0, 0});
}

void SystemReader::make_shared_variables() {
  for (auto& [name, variable] : names_.variables) {
    if (own_.contains(name)) continue;
    constexpr std::uint64_t most = 4096;
    if (variable.type.count() > most) {
      throw ParseError("a shared variable has at most " + std::to_string(most) + " values",
                       variable.position);
    }
    variable.leaf.index = static_cast<std::uint32_t>(system_.models.size());
    for (std::uint64_t member = 0; member < member_count(variable.leaf.dimensions); ++member) {
      ModelInstance model;
      model.name = name + member_suffix(variable.leaf.dimensions, member);
      model.automaton = InterfaceAutomaton({}, {}, variable.type.count());
      model.automaton.set_initial(static_cast<StateId>(variable.type.place_of(variable.initial)));
      model.source = ModelInstance::Source::variable;
      model.type = variable.type;
      model.position = variable.position;
      system_.models.push_back(std::move(model));
    }
  }
}

void SystemReader::find_own_variables() {
  for (std::uint32_t index = 0; index < texts_.size(); ++index) {
    for (const std::string& name : texts_[index].own) {
      Expression& leaf = names_.variables.at(name).leaf;
      leaf.op = Expression::Operator::local;
      leaf.owner = index;
      const auto& variables = system_.programs[index].variables;
      const std::string first = name + member_suffix(leaf.dimensions, 0);
      leaf.index = static_cast<std::uint32_t>(
          std::find_if(variables.begin(), variables.end(),
                       [&](const ProgramVariable& known) { return known.name == first; }) -
          variables.begin());
    }
  }
}

void SystemReader::read_properties(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'properties'", {})) {
    if (system_.properties.size() == max_properties) fail("too many properties", key);
    if (key.Scalar() == "deadlock" || key.Scalar() == "stuck" || key.Scalar() == "error") {
      fail("'" + key.Scalar() + "' is always there; give this property another name", key);
    }
    read_property(key, value);
  }
}

void SystemReader::read_property(const YAML::Node& key, const YAML::Node& value) {
  Property property;
  property.name = key.Scalar();
  property.position = at(key);
  std::vector<FormulaInstance> instances;
  if (value.IsScalar()) {
    instances = formulas(value);
  } else {
    bool has_fairness = false, is_invariant = false;
    for (const auto& [name, node] : entries(value, "property '" + property.name + "'",
                                            {"ltl", "always", "never", "fairness"})) {
      if (name.Scalar() == "fairness") {
        has_fairness = true;
        property.fairness = one_of<Fairness>(
            node, "'fairness'",
            {{"none", Fairness::none}, {"weak", Fairness::weak}, {"strong", Fairness::strong}});
        continue;
      }
      if (!instances.empty() || property.never) {
        fail("a property has one of 'ltl', 'always' and 'never'", name);
      }
      if (name.Scalar() == "never") {
        property.kind = Property::Kind::never;
        property.never = read_never(node);
        continue;
      }
      is_invariant = name.Scalar() == "always";
      scalar(node, "'" + name.Scalar() + "'");
      instances = is_invariant ? invariants(node) : formulas(node);
    }
    if (instances.empty() && !property.never) {
      fail("a property needs 'ltl:', 'always:' or 'never:'", key);
    }
    if (is_invariant && has_fairness) fail("an invariant does not depend on fairness", key);
  }
  const auto add = [&] {
    for (const Property& other : system_.properties) {
      if (other.name == property.name)
        fail("the property '" + other.name + "' is there twice", key);
    }
    system_.properties.push_back(property);
  };
  if (property.never) add();
  const std::string name = property.name;
  for (FormulaInstance& instance : instances) {
    property.name = name + instance.suffix;
    property.formula = std::move(instance.formula);
    add();
  }
}

std::vector<FormulaInstance> SystemReader::formulas(const YAML::Node& node) {
  if (!node.IsScalar()) fail("a property must be a formula or a map", node);
  const ScalarText text = text_of(node);
  if (text.has_tag()) {
    fail("to YAML, this '!' begins a tag and no formula: put the formula in quotes", node);
  }
  return parse_formulas(text, scope(), &system_.expressions);
}

FormulaScope SystemReader::scope() const {
  return {system_.programs, interfaces_, system_.expressions, &system_.words, &names_};
}

std::vector<FormulaInstance> SystemReader::invariants(const YAML::Node& node) {
  std::vector<FormulaInstance> result = formulas(node);
  for (FormulaInstance& instance : result) {
    if (!is_boolean(instance.formula)) {
      fail("'always' takes an expression without X, F, G, U, R, W; use 'ltl' for those", node);
    }
    instance.formula = std::make_shared<FormulaNode>(
        FormulaNode{FormulaNode::Operator::globally, {}, std::move(instance.formula), nullptr});
  }
  return result;
}

std::shared_ptr<const LtlAutomaton> SystemReader::read_never(const YAML::Node& node) const {
  const std::filesystem::path file =
      std::filesystem::path(system_.file).parent_path() / scalar(node, "'never'");
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    fail("there is no file '" + file.string() + "'", node);
  }
  return std::make_shared<LtlAutomaton>(read_hoa(read_file(file), file.string(), scope()));
}

void SystemReader::remark_on_what_is_unknown() {
  std::vector<std::string> depths, code;
  for (const ModelInstance& model : system_.models) {
    const std::string place = " (" + to_string(model.position) + ")";
    if (has_unknown_depth(model.automaton)) depths.push_back(model.name + place);
    if (const auto callback = find_unknown_code(model.automaton)) code.push_back(*callback + place);
  }
  if (!depths.empty()) {
    system_.remarks.push_back(
        "'depth: unknown': write how many messages are kept, as in 'depth: 10', for " +
        join(depths, ", "));
  }
  if (!code.empty()) {
    system_.remarks.push_back("'do: unknown': write what is done, or 'skip;', for " +
                              join(code, ", "));
  }
}

void SystemReader::remark_on_unused_models() {
  std::set<std::uint32_t> used;
  for (const Program& program : system_.programs) {
    used.insert(program.names.begin(), program.names.end());
  }
  for (std::uint32_t index = 0; index < system_.models.size(); ++index) {
    const ModelInstance& model = system_.models[index];
    if (used.contains(index) || model.source == ModelInstance::Source::variable) continue;
    system_.remarks.push_back("no program uses model '" + model.name + "' (" +
                              to_string(model.position) + ")");
  }
}

// As in a file whose programs are still to be written.
void SystemReader::remark_on_silent_connections() {
  std::set<std::uint32_t> written;  // models
  for (const Program& program : system_.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& event : program.events_of(edge)) {
        if (event.kind != ModelUse::Kind::give) continue;
        const std::string& input =
            system_.models[event.model].automaton.inputs().name(event.symbol);
        if (input.starts_with("write")) written.insert(event.model);
      }
    }
  }
  std::vector<std::string> silent;
  for (const TopicInstance& topic : system_.topics) {
    const bool is_written =
        std::any_of(topic.readers.begin(), topic.readers.end(),
                    [&](const auto& reader) { return written.contains(reader.model); });
    if (!is_written) silent.push_back("writes " + topic.name);
  }
  for (const ServiceInstance& service : system_.services) {
    const auto& actions = system_.models[service.model].actions;
    const bool is_asked = std::any_of(actions.begin(), actions.end(), [](const auto& action) {
      return action.name.starts_with("send");
    });
    if (!is_asked) silent.push_back("asks " + service.name);
  }
  const bool is_known = std::none_of(
      system_.models.begin(), system_.models.end(),
      [](const ModelInstance& model) { return find_unknown_code(model.automaton).has_value(); });
  if (!silent.empty() && is_known) system_.remarks.push_back("no program " + join(silent, ", or "));
}

void SystemReader::remark_on_unused_variables() {
  for (const VariableName& variable : unused_variables_) {
    system_.remarks.push_back("no program uses variable '" + variable.leaf.name + "' (" +
                              to_string(variable.position) + ")");
  }
}

void SystemReader::remark_on_unreachable_statements() {
  for (const Program& program : system_.programs) {
    for (const SourcePosition& place : program.unreachable) {
      system_.remarks.push_back("program " + program.name +
                                " never comes to this statement: the one before it does not end "
                                "(" +
                                to_string(place) + ")");
    }
  }
}

void SystemReader::remark_on_idle_atoms() {
  for (const Property& property : system_.properties) {
    for (const Atom& atom : atoms_of(property.formula)) {
      if (atom.is_event() || atom.kind == Atom::Kind::expression) continue;
      const Program& program = system_.programs[atom.owner];
      const bool is_end = atom.kind == Atom::Kind::end;
      if (is_end ? program.may_end() : program.may_reach(atom.symbol)) continue;
      system_.remarks.push_back("in property '" + property.name + "', " + program.name + "@" +
                                (is_end ? "end" : program.labels[atom.symbol]) + " never holds: " +
                                program.name + (is_end ? " never ends" : " never comes there") +
                                " (" + to_string(property.position) + ")");
    }
  }
}

InterfaceAutomaton read_requested_model(const ModelRequest& request) {
  if (!request.learn.empty()) {
    throw ParseError("model '" + request.instance + "' is to be learned: run `maide learn " +
                         request.learn + " -o model.dot` and name the file here",
                     request.position);
  }
  std::error_code ignored;
  if (!std::filesystem::exists(request.file, ignored)) {
    throw ParseError("there is no file '" + request.file.string() + "'", request.position);
  }
  Model model = read_model(request.file);
  if (auto* automaton = std::get_if<InterfaceAutomaton>(&model)) return std::move(*automaton);
  throw ParseError("'" + request.file.string() +
                       "' is a Mealy machine and programs meet interface automata (?input, "
                       "!output): learn it with `--as ia`, or `maide learn sim:" +
                       request.file.filename().string() +
                       " -o model.dot --translation eager` makes one of it",
                   request.position);
}

System parse_system(std::string_view text, const std::string& file, const ModelSource& source,
                    const RunControl& control) {
  return SystemReader(text, file, source, {}, control).read();
}

System read_system(const std::filesystem::path& path, const ModelSource& source,
                   const RunControl& control) {
  const std::string text = read_file(path, control);
  return parse_system(text, path.string(), source, control);
}

}  // namespace maide
