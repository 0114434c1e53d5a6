#include "maide/check/build/build_system.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/check/build/arrivals.hpp"
#include "maide/check/build/first_values.hpp"
#include "maide/check/build/wires.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/rules/life.hpp"
#include "maide/check/system/model_actions.hpp"
#include "maide/check/unroll/make_program.hpp"

namespace maide {
namespace {

constexpr std::size_t max_properties = 1000;

class SystemBuilder {
 public:
  SystemBuilder(const Declarations& file, Models models, const QueueLimits& limits,
                const RunControl& control)
      : file_(file), models_(std::move(models)), limits_(limits), control_(control) {}

  System build() {
    system_.connections = add_wires(file_, models_);
    system_.file = file_.tree().file();
    system_.sources.emplace(system_.file, file_.tree().document->text);
    system_.models = std::move(models_.instances);
    system_.words = std::move(models_.words);
    system_.services = file_.services;
    system_.open_ends = file_.open_ends;
    if (const TreeNode* const holes = file_.tree().root.find("holes")) add_holes(*holes);
    system_.callbacks = file_.callbacks;
    for (const ExecutorDeclaration& executor : file_.executors) {
      system_.executors.push_back({executor.name, executor.threads, executor.goes_by_rounds});
    }
    find_own_models();
    make_all_programs();
    find_own_variables();
    choose_first_values();
    add_topics();
    interfaces_ = system_.interfaces();
    for (const TreeNode& entry : file_.tree().entries("properties")) add_property(entry);
    add_remarks(system_, models_.unused);
    return std::move(system_);
  }

 private:
  // ---- Variables --------------------------------------------------------------------------------

  // For formulas: where the variables stand that belong to one program.
  void find_own_variables() {
    for (std::uint32_t index = 0; index < models_.own.size(); ++index) {
      for (const std::string& name : models_.own[index]) {
        Expression& leaf = models_.names.variables.at(name).leaf;
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

  // Of variables that several programs use: a program's own are chosen in its code.
  void choose_first_values() {
    std::vector<std::uint32_t> variables;
    for (const auto& [name, variable] : models_.names.variables) {
      if (!variable.is_any || variable.leaf.op != Expression::Operator::shared) continue;
      const std::uint64_t count = member_count(variable.leaf.dimensions);
      for (std::uint32_t member = 0; member < count; ++member) {
        variables.push_back(variable.leaf.index + member);
      }
    }
    std::ranges::sort(variables);
    if (!variables.empty()) maide::choose_first_values(system_, variables);
  }

  // What the file says that it leaves out.
  void add_holes(const TreeNode& holes) {
    if (holes.yaml->is_scalar()) system_.holes.push_back(holes.text());
    for (const YamlEntry& one : holes.yaml->entries) system_.holes.push_back(one.value.value);
  }

  // ---- Programs ---------------------------------------------------------------------------------

  // What begins anew with a process: what nobody else uses, and is neither an end nor what leads to
  // one.
  void find_own_models() {
    if (models_.names.lives.empty()) return;
    std::map<std::uint32_t, std::set<std::size_t>> users;  // lives, by model; its number: others
    const std::size_t others = models_.names.lives.size();
    for (std::uint32_t number = 0; number < file_.programs.size(); ++number) {
      const auto life = models_.names.life_of_program.find(number);
      const std::size_t user = life == models_.names.life_of_program.end() ? others : life->second;
      for (const std::uint32_t model : resolve(number).names) users[model].insert(user);
      if (!file_.programs[number].thread) continue;
      const program_syntax::Thread& thread = *file_.programs[number].thread;
      for (const auto* const callbacks : {&thread.starts, &thread.callbacks}) {
        for (const program_syntax::Callback& callback : *callbacks) {
          for (const ModelUse& use : callback.start) users[use.model].insert(user);
          for (const ModelUse& use : callback.end) users[use.model].insert(user);
        }
      }
    }
    for (const auto& [model, service] : models_.names.services) {
      users.erase(model);
      if (service.presence) users.erase(*service.presence);
    }
    for (const auto& [model, topic] : file_.topic_of) users.erase(model);
    for (const Life& life : models_.names.lives) users.erase(life.model);
    for (const auto& [model, lives] : users) {
      if (lives.size() != 1 || *lives.begin() == others) continue;
      models_.names.lives[*lives.begin()].own_models.push_back(model);
    }
  }

  void make_all_programs() {
    ModelActions actions(system_);
    make_programs(actions);
    if (models_.growing.empty()) return;
    grow_models(system_, actions, models_.growing, limits_, control_);
    system_.programs.clear();
    ModelActions known(system_, actions.take_all());
    make_programs(known);
  }

  // Actions of models are made as they are needed.
  void make_programs(ModelActions& actions) {
    for (std::uint32_t number = 0; number < file_.programs.size(); ++number) {
      const ProgramDeclaration& declared = file_.programs[number];
      const program_syntax::Tree tree = resolve(number);
      const int last_line = declared.code ? declared.code->last.line : declared.position.line;
      Program& program = system_.programs.emplace_back(program_syntax::make_program(
          tree, {declared.name, number, declared.position, declared.may_die, declared.nodes},
          last_line, actions, models_.names, control_));
      program.nodes = declared.nodes;
      program.execution = declared.execution;
      program.process = declared.process;
      if (const Life* const life = models_.names.life_of(number)) {
        program.life = life_of(*life, number, tree.initial);
        program.names.insert(std::ranges::upper_bound(program.names, life->model), life->model);
      }
      for (CombinedStep& combined : program.combined) {
        combined.awaits_anybody = combined.awaits_anybody || declared.may_stay_away;
      }
      if (declared.thread) name_callbacks(program, *declared.thread);
      if (declared.may_die) name_ends(program, number);
    }
    add_arrivals(file_, models_.names, system_, actions);
  }

  ProgramLife life_of(const Life& life, std::uint32_t program,
                      const std::vector<std::optional<Value>>& first_values) const {
    ProgramLife own{life.model, {}, {}, first_values};
    for (StateId at = 0; at < system_.models[life.model].automaton.size(); ++at) {
      own.is_dead.push_back(life.rules->is_dead(at, life.number_of(program)));
      own.is_dead_for_good.push_back(!life.is_told && life.rules->is_over(at));
    }
    return own;
  }

  program_syntax::Tree resolve(std::uint32_t number) {
    const ProgramDeclaration& program = file_.programs[number];
    const program_syntax::Context known{
        system_.models,  models_.names, system_.words, number, models_.own[number],
        program.indices, nullptr,       nullptr,       {}};
    return maide::resolve(program, known);
  }

  static void name_callbacks(Program& program, const program_syntax::Thread& thread) {
    for (const program_syntax::Callback& callback : thread.callbacks) {
      const auto add = [&](const syntax::Code& code) {
        program.callbacks.push_back({callback.whole_name(), code.begin.line, code.end.line});
      };
      if (callback.code && callback.outcomes.empty()) add(*callback.code);
      for (const auto& [output, code] : callback.outcomes) add(*code);
    }
  }

  // A program that may die belongs to the component of all models at whose ends it stands, also of
  // those that its text does not name.
  void name_ends(Program& program, std::uint32_t number) const {
    std::set<std::uint32_t> named(program.names.begin(), program.names.end());
    for (const Topic& topic : models_.names.topics) {
      if (!topic.has_end(number, true) && !topic.has_end(number, false)) continue;
      for (const Topic::Reader& reader : topic.readers) named.insert(reader.model);
    }
    for (const auto& [model, name] : file_.ends_of) {
      for (const auto& [actor, at_it] : models_.names.models.at(name).ends) {
        const bool has_end = std::any_of(at_it.begin(), at_it.end(), [&](const End& end) {
          if (end.node.empty()) return end.program == number;
          const std::vector<std::string>& nodes = file_.programs[number].nodes;
          return std::find(nodes.begin(), nodes.end(), end.node) != nodes.end();
        });
        if (has_end) named.insert(model);
      }
    }
    program.names.assign(named.begin(), named.end());
  }

  void add_topics() {
    for (const Topic& topic : models_.names.topics) {
      TopicInstance& added = system_.topics.emplace_back();
      added.name = topic.name;
      added.writer_names = topic.writer_names;
      added.writers.assign(topic.writers.begin(), topic.writers.end());
      added.delivers_one = topic.delivers_one;
      added.meets = topic.meets;
      for (const Topic::Reader& reader : topic.readers) {
        std::optional<std::uint32_t> callback;
        for (std::uint32_t number = 0; number < system_.callbacks.size(); ++number) {
          if (system_.callbacks[number].name == reader.callback) callback = number;
        }
        added.readers.push_back({reader.program, reader.model, callback, reader.collected});
      }
    }
  }

  // ---- Properties -------------------------------------------------------------------------------

  void add_property(const TreeNode& entry) {
    const std::string& name = entry.name_text();
    if (system_.properties.size() == max_properties) {
      file_.tree().fail_at_name("too many properties", entry);
    }
    if (name == "deadlock" || name == "stuck" || name == "error") {
      file_.tree().fail_at_name("'" + name + "' is always there; give this property another name",
                                entry);
    }
    Property property;
    property.name = name;
    property.position = file_.tree().at_name(entry);
    if (!entry.is_map()) {
      add_formulas(entry, property, formulas(entry));
      return;
    }
    const TreeNode* what = nullptr;
    for (const TreeNode& field : entry.children) {
      if (field.name_text() == "fairness") continue;
      if (what != nullptr) {
        file_.tree().fail_at_name(
            "a property has one of 'ltl', 'always', 'possible', "
            "'always_possible' and 'never'",
            field);
      }
      what = &field;
    }
    if (what == nullptr) {
      file_.tree().fail_at_name(
          "a property needs 'ltl:', 'always:', 'possible:', 'always_possible:' or 'never:'", entry);
    }
    property.is_possibility = what->name_text() == "possible";
    property.is_always_possible = what->name_text() == "always_possible";
    const bool is_of_states =
        property.is_possibility || property.is_always_possible || what->name_text() == "always";
    if (const TreeNode* const fairness = entry.find("fairness")) {
      if (is_of_states) {
        const bool is_possible = property.is_possibility || property.is_always_possible;
        file_.tree().fail_at_name((is_possible ? "what is possible" : "an invariant") +
                                      std::string(" does not depend on fairness"),
                                  entry);
      }
      property.fairness = fairness->is("none")   ? Fairness::none
                          : fairness->is("weak") ? Fairness::weak
                                                 : Fairness::strong;
    }
    if (what->name_text() == "never") {
      property.kind = Property::Kind::never;
      property.never = read_never(*what);
      add(entry, property);
      return;
    }
    add_formulas(entry, property, is_of_states ? of_states(*what) : formulas(*what));
  }

  void add_formulas(const TreeNode& entry, Property property,
                    std::vector<FormulaInstance> instances) {
    const std::string name = property.name;
    for (FormulaInstance& instance : instances) {
      property.name = name + instance.suffix;
      property.formula = std::move(instance.formula);
      add(entry, property);
    }
  }

  void add(const TreeNode& entry, const Property& property) {
    for (const Property& other : system_.properties) {
      if (other.name != property.name) continue;
      file_.tree().fail_at_name("the property '" + other.name + "' is there twice", entry);
    }
    system_.properties.push_back(property);
  }

  FormulaScope scope() const {
    return {system_.programs, interfaces_, system_.expressions, &system_.words, &models_.names};
  }
  std::vector<FormulaInstance> formulas(const TreeNode& field) {
    std::vector<std::string> at_once;
    FormulaScope scope = this->scope();
    if (!file_.is_at_rest) scope.at_once = &at_once;
    std::vector<FormulaInstance> found =
        resolve_formulas(*field.formula, scope, &system_.expressions);
    for (const std::string& event : std::set<std::string>(at_once.begin(), at_once.end())) {
      system_.remarks.push_back(event + " never holds: it arrives at once (" +
                                to_string(file_.tree().at(field)) + ")");
    }
    return found;
  }
  // `G e` of what always holds, `G !e` of what is possible.
  std::vector<FormulaInstance> of_states(const TreeNode& field) {
    using Operator = FormulaNode::Operator;
    std::vector<FormulaInstance> instances = formulas(field);
    for (FormulaInstance& instance : instances) {
      if (!is_boolean(instance.formula)) {
        file_.tree().fail("'" + field.name_text() +
                              "' takes an expression without X, F, G, U, R, W; use 'ltl' for those",
                          field);
      }
      if (field.name_text() == "always_possible") continue;
      if (field.name_text() == "possible") {
        instance.formula = make_formula(Operator::negation, instance.formula);
      }
      instance.formula = make_formula(Operator::globally, instance.formula);
    }
    return instances;
  }

  // The automaton of a file, whose name is relative to the system file's folder.
  std::shared_ptr<const LtlAutomaton> read_never(const TreeNode& field) const {
    const std::filesystem::path file =
        std::filesystem::path(system_.file).parent_path() / field.text();
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(file, ignored)) {
      file_.tree().fail("there is no file '" + file.string() + "'", field);
    }
    return std::make_shared<LtlAutomaton>(read_hoa(read_file(file), file.string(), scope()));
  }

  const Declarations& file_;
  Models models_;
  const QueueLimits& limits_;
  const RunControl& control_;
  System system_;
  std::vector<ProgramInterface> interfaces_;
};

}  // namespace

System build_system(const Declarations& file, Models models, const QueueLimits& limits,
                    const RunControl& control) {
  return SystemBuilder(file, std::move(models), limits, control).build();
}

}  // namespace maide
