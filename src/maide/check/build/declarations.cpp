#include "maide/check/build/declarations.hpp"

#include <functional>
#include <string_view>

#include "maide/check/build/code_resolver.hpp"
#include "maide/check/ltl/formula.hpp"

namespace maide {

program_syntax::Tree resolve(const ProgramDeclaration& program,
                             const program_syntax::Context& known) {
  return program.thread ? program_syntax::resolve_thread(*program.thread, program.position, known)
                        : program_syntax::resolve_program(*program.code, known);
}

void Declarations::take_name(const std::string& name, SourcePosition place) {
  const auto [known, is_new] = taken.emplace(name, place);
  if (is_new) return;
  throw ParseError("the name '" + name + "' is taken: " + to_string(known->second), place);
}

Indices DeclaredArray::indices_of(std::uint64_t number) const {
  Indices made;
  const std::vector<Value> values = member_indices(dimensions, number);
  for (std::size_t i = 0; i < values.size(); ++i) {
    made.emplace(indices[i], make_constant(values[i], ValueKind::integer));
  }
  return made;
}

DeclaredArray declare_array(Declarations& file, const TreeNode& entry) {
  const syntax::Declared& declared = *entry.declared;
  DeclaredArray array;
  array.name = declared.name.text;
  if (!declared.indices.empty()) {
    const program_syntax::Context context = file.context();
    program_syntax::Work work(context, file.tree().at_name(entry));
    array.dimensions = program_syntax::NameResolver(work).dimensions(declared.indices);
    for (const syntax::Index& index : declared.indices) array.indices.push_back(index.name.text);
  }
  file.take_name(array.name, file.tree().at_name(entry));
  return array;
}

Expression constant_of(Declarations& file, const syntax::Term& term, const Indices& indices) {
  const program_syntax::Context context = file.context(indices);
  program_syntax::Work work(context, {file.tree().file(), term.begin.line, term.begin.column});
  const program_syntax::NameResolver resolver(work);
  Expression value = resolver.expression(term);
  if (value.is_constant()) return value;
  resolver.fail("this constant has no value: it divides by zero, or is too large for 64 bits",
                term.begin);
}

std::uint32_t count_of(const Expression& value, std::uint32_t most) {
  if (value.kind != ValueKind::integer || value.value < 1 || value.value > Value{most}) return 0;
  return static_cast<std::uint32_t>(value.value);
}

void check_plain_name(const Declarations& file, const TreeNode& entry, const std::string& what) {
  if (entry.name_text().find_first_of(".@:[] ") == std::string::npos) return;
  file.tree().fail_at_name("the name of " + what + " is a word without '.', '@', ':' and '['",
                           entry);
}

bool may_die(const Declarations& file, const End& end) {
  return std::ranges::any_of(programs_at(file, end),
                             [&](std::uint32_t program) { return file.programs[program].may_die; });
}

std::uint32_t add_hidden_model(Declarations& file, const std::string& name,
                               InterfaceAutomaton automaton, const SourcePosition& position) {
  if (file.models.size() == max_components) throw ParseError("too many models", position);
  ModelInstance model;
  model.position = position;
  file.take_name(name, position);
  model.name = name;
  model.automaton = std::move(automaton);
  model.source = ModelInstance::Source::executor;
  file.models.push_back(std::move(model));
  file.origins.emplace_back();
  return static_cast<std::uint32_t>(file.models.size() - 1);
}

std::vector<const syntax::Code*> codes_of(const program_syntax::Callback& callback) {
  std::vector<const syntax::Code*> codes;
  if (callback.code) codes.push_back(callback.code.get());
  for (const auto& [output, code] : callback.outcomes) codes.push_back(code.get());
  return codes;
}

std::uint32_t runs_of(const Declarations& file, const NodeDeclaration& node, std::size_t callback) {
  const program_syntax::Callback& code = node.callbacks[callback];
  if (code.kind == program_syntax::Callback::Kind::thread) return code.copies;
  const std::string& group = node.callback_groups[callback];
  const bool is_reentrant = !group.empty() && node.groups.at(group) && !code.comes_once;
  return is_reentrant ? file.executors[node.executor].threads : 1;
}

// ---- Constants, procedures, variables, programs -------------------------------------------------

void declare_constants(Declarations& file) {
  for (const TreeNode& entry : file.tree().entries("constants")) {
    file.take_name(entry.name_text(), file.tree().at_name(entry));
    file.names.constants.emplace(entry.name_text(), constant_of(file, *entry.number));
  }
}

void declare_procedures(Declarations& file) {
  for (const TreeNode& entry : file.tree().entries("procedures")) {
    const syntax::Head& head = *entry.head;
    Procedure procedure;
    procedure.position = file.tree().at_name(entry);
    procedure.code = entry.code;
    for (const syntax::Name& parameter : head.parameters) {
      procedure.parameters.push_back(parameter.text);
    }
    if (!file.names.procedures.emplace(head.name.text, std::move(procedure)).second) {
      file.tree().fail_at_name("procedure '" + head.name.text + "' is there twice", entry);
    }
  }
}

namespace {

// The declarations of `variables:`, in order; their leaves name no place yet.
std::vector<VariableName> variables_of(Declarations& file, const syntax::Code& code,
                                       const Indices& indices) {
  const program_syntax::Context context = file.context(indices);
  program_syntax::Work work(context, {code.file, code.begin.line, code.begin.column});
  const program_syntax::NameResolver resolver(work);
  std::vector<VariableName> variables;
  for (const syntax::Statement& statement : code.block.statements) {
    resolver.check_new(statement.name);
    VariableName variable;
    variable.position = resolver.position(statement.name.place);
    variable.leaf.name = statement.name.text;
    variable.leaf.op = Expression::Operator::shared;
    variable.leaf.dimensions = resolver.dimensions(statement.dimensions);
    variable.type = resolver.type(statement.type);
    variable.leaf.kind = variable.type.kind;
    variable.initial = variable.type.at(0);
    variable.is_any = statement.is_any;
    if (statement.expression) {
      const TextPlace begin = statement.expression->begin;
      const Expression value =
          resolver.value_for(*statement.expression, variable.type, statement.name.text);
      if (!value.is_constant()) resolver.fail("the first value must be known here", begin);
      if (!variable.type.contains(value.value)) {
        resolver.fail("the first value is outside of " + to_string(variable.type, file.words),
                      begin);
      }
      variable.initial = value.value;
    }
    variables.push_back(std::move(variable));
  }
  return variables;
}

void declare_node_variables(Declarations& file, const NodeDeclaration& node) {
  const TreeNode* const section = node.entry->find("variables");
  if (section == nullptr) return;
  for (VariableName& variable : variables_of(file, *section->code, node.indices)) {
    variable.leaf.name = node.name + "." + variable.leaf.name;
    const std::string name = variable.leaf.name;
    const SourcePosition place = variable.position;
    if (!file.names.variables.emplace(name, std::move(variable)).second) {
      throw ParseError("the variable '" + name + "' is there twice", place);
    }
  }
}

}  // namespace

void declare_variables(Declarations& file) {
  if (const TreeNode* const section = file.tree().root.find("variables")) {
    for (VariableName& variable : variables_of(file, *section->code, {})) {
      const std::string name = variable.leaf.name;
      file.take_name(name, variable.position);
      file.names.variables.emplace(name, std::move(variable));
    }
  }
  for (const NodeDeclaration& node : file.nodes) declare_node_variables(file, node);
}

void declare_programs(Declarations& file) {
  const TreeNode* const section = file.tree().root.find("programs");
  if (section == nullptr) return;
  for (const TreeNode& entry : section->children) {
    const DeclaredArray array = declare_array(file, entry);
    const TreeNode* text = &entry;
    ProgramDeclaration program;
    if (entry.is_map()) {
      text = entry.find("do");
      if (text == nullptr) {
        file.tree().fail_at_name("program '" + array.name + "' needs 'do:'", entry);
      }
    }
    program.code = text->code;
    program.position = {file.tree().file(), text->code->begin.line, text->code->begin.column};
    if (file.programs.size() + array.count() > max_components) {
      file.tree().fail_at_name("too many programs", entry);
    }
    file.program_arrays[array.name] = {
        static_cast<std::uint32_t>(file.programs.size()), array.dimensions, false, {}};
    for (std::uint64_t member = 0; member < array.count(); ++member) {
      program.name = array.member(member);
      program.process = process_of(entry, program.name);
      program.indices = array.indices_of(member);
      file.programs.push_back(program);
    }
  }
  if (file.programs.empty()) file.tree().fail("there is no program", *section);
}

// ---- What texts say -----------------------------------------------------------------------------

namespace {

bool says_unknown(const syntax::Code& code) {
  bool found = false;
  syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
    found = found || statement.kind == syntax::Statement::Kind::unknown;
  });
  return found;
}

// `owner`: the program or callback.
std::uint32_t add_unknown(Declarations& file, const std::string& owner, const syntax::Code& code) {
  return add_hidden_model(file, "_unknown_" + std::to_string(file.models.size()),
                          make_unknown_code(owner),
                          {code.file, code.begin.line, code.begin.column});
}

}  // namespace

void declare_unknown(Declarations& file) {
  bool is_in_procedure = false;
  for (const TreeNode& entry : file.tree().entries("procedures")) {
    is_in_procedure = is_in_procedure || says_unknown(*entry.code);
  }
  for (std::uint32_t number = 0; number < file.programs.size(); ++number) {
    const ProgramDeclaration& program = file.programs[number];
    if (!is_in_procedure && !says_unknown(*program.code)) continue;
    file.names.unknown_programs[number] = add_unknown(file, program.name, *program.code);
  }
  for (const NodeDeclaration& node : file.nodes) {
    for (const program_syntax::Callback& callback : node.callbacks) {
      for (const syntax::Code* const code : codes_of(callback)) {
        const std::string name = callback.whole_name();
        const bool is_known = file.names.unknown_callbacks.contains(name);
        if (is_known || (!is_in_procedure && !says_unknown(*code))) continue;
        file.names.unknown_callbacks[name] = add_unknown(file, name, *code);
      }
    }
  }
}

namespace {

// Which services texts offer, and of which they ask whether they are there.
struct NamedServices {
  std::set<std::string> offered, asked;
};

void note_terms(const syntax::Term& term, NamedServices& services) {
  if (!term.parts.empty()) services.asked.insert(term.name.text);
  for (const syntax::Term& operand : term.operands) note_terms(operand, services);
}

NamedServices find_named_services(const Declarations& file) {
  NamedServices services;
  for_each_code(file.tree().root, [&](const syntax::Code& code) {
    syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
      using Kind = syntax::Statement::Kind;
      const std::string& name = statement.model.name.text;
      if (statement.kind == Kind::offer) services.offered.insert(name);
      if (statement.kind == Kind::wait && statement.arms.front().output.name.is("there")) {
        services.asked.insert(name);
      }
      if (statement.expression) note_terms(*statement.expression, services);
      for (const syntax::SelectArm& arm : statement.select_arms) {
        if (arm.guard) note_terms(*arm.guard, services);
      }
    });
  });
  const std::function<void(const TreeNode&)> visit = [&](const TreeNode& at) {
    if (at.number) note_terms(*at.number, services);
    if (at.formula) note_terms(at.formula->root, services);
    for (const TreeNode& child : at.children) visit(child);
  };
  visit(file.tree().root);
  return services;
}

VariableName make_flag(const std::string& name, const SourcePosition& position) {
  VariableName flag;
  flag.position = position;
  flag.leaf.name = name;
  flag.leaf.op = Expression::Operator::shared;
  flag.leaf.kind = flag.type.kind = ValueKind::boolean;
  flag.type.high = 1;
  return flag;
}

bool may_server_die(const Declarations& file, const ModelName& service) {
  for (std::uint32_t member = 0; member < member_count(service.dimensions); ++member) {
    if (may_die(file, file.names.services.at(service.first + member).server)) return true;
  }
  return false;
}

}  // namespace

void declare_due(Declarations& file) {
  for (const NodeDeclaration& node : file.nodes) {
    for (const program_syntax::Callback& callback : node.callbacks) {
      if (!callback.goes_by_clock) continue;
      const std::string name = due_of(callback.whole_name());
      file.names.variables.emplace(name, make_flag(name, callback.position));
    }
  }
}

void declare_presence(Declarations& file) {
  const NamedServices named = find_named_services(file);
  for (const auto& [name, service] : file.service_arrays) {
    const bool is_offered = named.offered.contains(name);
    const bool comes = file.names.services.at(service.first).is_server_anybody;
    const bool goes = named.asked.contains(name) && may_server_die(file, service);
    if (!is_offered && !comes && !goes) continue;
    const std::string presence = presence_of(name);
    VariableName variable = make_flag(presence, file.models[service.first].position);
    variable.leaf.dimensions = service.dimensions;
    variable.initial = is_offered || comes ? 0 : 1;
    variable.service = service.first;
    file.names.variables.emplace(presence, std::move(variable));
  }
}

// ---- The whole file -----------------------------------------------------------------------------

namespace {

// Whether all names of programs and formulas mean something, as far as the file alone tells. What
// depends on inputs and outputs of models is found when these are known.
void check_names(const Declarations& declared) {
  Declarations file = declared;  // texts may bring words of their own
  std::vector<Program> programs;
  for (std::uint32_t number = 0; number < file.programs.size(); ++number) {
    const ProgramDeclaration& program = file.programs[number];
    program_syntax::Context context = file.context(program.indices);
    context.program = number;
    context.stage = program_syntax::Context::Stage::names;
    program_syntax::Tree tree = resolve(program, context);
    Program& shown = programs.emplace_back();
    shown.name = program.name;
    shown.nodes = program.nodes;
    shown.labels = std::move(tree.labels);
    shown.variables = std::move(tree.slots);
  }
  std::vector<ProgramInterface> interfaces;
  for (const ModelInstance& model : file.models) {
    interfaces.push_back({model.name, &model.automaton.inputs(), &model.automaton.outputs()});
  }
  std::vector<Expression> expressions;
  FormulaScope scope{programs, interfaces, expressions, &file.words, &file.names};
  scope.knows_models = false;
  for (const TreeNode& property : file.tree().entries("properties")) {
    if (property.formula) resolve_formulas(*property.formula, scope, &expressions);
    for (const TreeNode& field : property.children) {
      if (field.formula) resolve_formulas(*field.formula, scope, &expressions);
    }
  }
}

// A text of the file gives the input, or a callback takes what it brings.
bool is_given(const TreeNode& node, std::string_view input) {
  bool found = false;
  const auto visit = [&](const syntax::Event& event) { found = found || event.name.text == input; };
  for_each_code(node, [&](const syntax::Code& code) {
    syntax::for_each_statement(code.block, [&](const syntax::Statement& statement) {
      visit(statement.event);
      for (const syntax::SelectArm& arm : statement.select_arms) visit(arm.event);
    });
  });
  const std::function<void(const TreeNode&)> visit_taken = [&](const TreeNode& at) {
    if (at.taken) visit(at.taken->event);
    for (const TreeNode& child : at.children) visit_taken(child);
  };
  visit_taken(node);
  return found;
}

}  // namespace

Declarations declare(SystemTree tree, Deliveries deliveries) {
  Declarations file;
  file.is_at_rest = deliveries == Deliveries::at_rest;
  file.source = std::make_shared<const SystemTree>(std::move(tree));
  file.asks_at_once = is_given(file.tree().root, "tryread");
  file.tries_locks = is_given(file.tree().root, "trylock");
  const TreeNode& root = file.tree().root;
  if (root.find("programs") == nullptr && root.find("nodes") == nullptr) {
    file.tree().fail("there is no 'programs:' and no 'nodes:'", root);
  }
  declare_constants(file);
  declare_programs(file);
  declare_executors(file);
  declare_nodes(file);
  declare_services(file);
  declare_callbacks(file);
  declare_unknown(file);
  declare_threads(file);
  declare_models(file);
  declare_topics(file);
  declare_procedures(file);
  declare_locks(file);
  declare_variables(file);
  declare_due(file);
  declare_presence(file);
  check_names(file);
  return file;
}

}  // namespace maide
