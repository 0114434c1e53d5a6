#include "maide/check/system/components.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <utility>

#include "maide/base/invariant.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/system/atom_view.hpp"

namespace maide {
namespace {

constexpr std::uint32_t not_there = ~std::uint32_t{0};

// The programs and models that a property names.
struct Named {
  std::set<std::uint32_t> programs, models;
};

Named names_of(const System& system, const Property& property) {
  Named named;
  for (const Atom& atom : atoms_of(property)) {
    const AtomView view(atom, system);
    for (const AtomField& field : view.fields()) {
      (field.is_model ? named.models : named.programs).insert(field.index);
    }
    if (!atom.is_event()) continue;
    named.models.insert(atom.owner);
    if (atom.program != Atom::any_program) named.programs.insert(atom.program);
  }
  return named;
}

// Adds the models of each action of nobody that uses one of them, until there are no more.
void add_models_joined(const System& system, std::set<std::uint32_t>& models) {
  std::size_t before = 0;
  do {
    before = models.size();
    for (const NobodysAction& action : system.nobodys_actions) {
      const auto& uses = action.what.uses;
      const bool meets = std::ranges::any_of(
          uses, [&](const ModelUse& use) { return models.contains(use.model); });
      for (const ModelUse& use : uses) {
        if (meets) models.insert(use.model);
      }
    }
  } while (before != models.size());
}

// On runs of formulas anybody need not do anything.
void count_on_nobody(System& system) {
  for (Program& program : system.programs) {
    program.flags.counts_on_anybody = false;
    for (CombinedStep& combined : program.combined) {
      if (combined.awaits_anybody) combined.fair = 0;
    }
  }
}

Formula with_atoms(const Formula& formula, const std::function<Atom(const Atom&)>& change) {
  if (!formula) return formula;
  FormulaNode node = *formula;
  if (node.op == FormulaNode::Operator::atom) node.atom = change(node.atom);
  node.left = with_atoms(node.left, change);
  node.right = with_atoms(node.right, change);
  return std::make_shared<const FormulaNode>(std::move(node));
}

void for_each_leaf(Expression& expression, const std::function<void(Expression&)>& change) {
  using Operator = Expression::Operator;
  if (expression.op == Operator::local || expression.op == Operator::shared) change(expression);
  for (Expression& operand : expression.operands) for_each_leaf(operand, change);
}

}  // namespace

std::set<std::uint32_t> models_of(const Program& program) {
  std::set<std::uint32_t> models(program.names.begin(), program.names.end());
  for (const ProgramEdge& edge : program.edges) {
    for (const ModelUse& use : program.uses_of(edge)) models.insert(use.model);
  }
  return models;
}

bool is_whole(const System& system, const std::vector<std::uint32_t>& programs) {
  if (programs.size() != system.programs.size()) return false;
  if (system.nobodys_actions.empty()) return true;
  std::set<std::uint32_t> models;
  for (const Program& program : system.programs) models.merge(models_of(program));
  add_models_joined(system, models);
  return std::ranges::all_of(system.nobodys_actions, [&](const NobodysAction& action) {
    return action.what.uses.empty() || models.contains(action.what.uses.front().model);
  });
}

// Each program leads to an earlier one of its component, the first to itself.
std::vector<std::vector<std::uint32_t>> find_components(const System& system) {
  std::vector<std::uint32_t> earlier(system.programs.size());
  std::iota(earlier.begin(), earlier.end(), 0);
  const auto first_of = [&](std::uint32_t program) {
    while (earlier[program] != program) program = earlier[program] = earlier[earlier[program]];
    return program;
  };
  std::vector<std::uint32_t> user(system.models.size(), not_there);
  for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
    std::set<std::uint32_t> models = models_of(system.programs[program]);
    add_models_joined(system, models);
    for (const std::uint32_t model : models) {
      if (user[model] == not_there) user[model] = program;
      const std::uint32_t one = first_of(user[model]), other = first_of(program);
      earlier[std::max(one, other)] = std::min(one, other);
    }
  }
  std::vector<std::vector<std::uint32_t>> components;
  std::vector<std::uint32_t> number(system.programs.size());
  for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
    const std::uint32_t first = first_of(program);
    if (first == program) {
      number[program] = static_cast<std::uint32_t>(components.size());
      components.emplace_back();
    }
    components[number[first]].push_back(program);
  }
  return components;
}

std::vector<std::uint32_t> programs_of(const System& system, const Property& property,
                                       const std::vector<std::vector<std::uint32_t>>& components) {
  Named named = names_of(system, property);
  add_models_joined(system, named.models);
  std::vector<std::uint32_t> programs;
  for (const auto& component : components) {
    const bool is_named = std::ranges::any_of(component, [&](std::uint32_t program) {
      if (named.programs.contains(program)) return true;
      if (named.models.empty()) return false;
      const auto models = models_of(system.programs[program]);
      return std::ranges::any_of(models,
                                 [&](std::uint32_t model) { return named.models.contains(model); });
    });
    if (is_named) programs.insert(programs.end(), component.begin(), component.end());
  }
  if (programs.empty() && !components.empty()) programs = components.front();
  std::ranges::sort(programs);
  return programs;
}

std::vector<std::uint32_t> deadlocked_programs(const System& system, const GlobalState& state) {
  std::vector<std::uint32_t> deadlocked;
  if (state.is_cut || is_error(system, state)) return deadlocked;
  std::vector<bool> can_step(system.programs.size());
  std::set<std::uint32_t> moving;  // models that nobody's steps may change
  for (const Step& step : enabled_steps(system, state)) {
    if (!is_progress(system, step)) continue;
    if (step.actor != nobody) can_step[step.actor] = true;
    if (step.actor != nobody) continue;
    for (const ModelUse& use : uses_of(system, step)) moving.insert(use.model);
  }
  for (const auto& component : find_components(system)) {
    bool is_able = false, is_at_rest = true;
    std::set<std::uint32_t> models;
    for (const std::uint32_t index : component) {
      const Program& program = system.programs[index];
      const ControlState at = state.programs[index];
      is_able = is_able || can_step[index];
      is_at_rest = is_at_rest && (program.is_end(at) || program.may_rest(at));
      if (!moving.empty()) models.merge(models_of(program));
    }
    if (!moving.empty()) add_models_joined(system, models);
    is_able = is_able || std::ranges::any_of(
                             moving, [&](std::uint32_t model) { return models.contains(model); });
    if (is_able || is_at_rest) continue;
    deadlocked.insert(deadlocked.end(), component.begin(), component.end());
  }
  return deadlocked;
}

bool awaits_anybody(const System& system) {
  return std::ranges::any_of(system.programs, [](const Program& program) {
    return std::ranges::any_of(program.combined, &CombinedStep::awaits_anybody);
  });
}

SystemPart::SystemPart(const System& whole) : whole_(&whole), programs_(whole.programs.size()) {
  std::iota(programs_.begin(), programs_.end(), 0);
  nobodys_actions_.resize(whole.nobodys_actions.size());
  std::iota(nobodys_actions_.begin(), nobodys_actions_.end(), 0);
}

SystemPart::SystemPart(const System& whole, std::vector<std::uint32_t> programs,
                       const Property* property)
    : SystemPart(whole) {
  const bool is_of_runs = property != nullptr && (property->kind == Property::Kind::ltl ||
                                                  property->kind == Property::Kind::never);
  const bool may_hear_nothing =
      is_of_runs && !property->is_always_possible && awaits_anybody(whole);
  if (programs.empty() || maide::is_whole(whole, programs)) {
    if (may_hear_nothing) count_on_nobody(own_.emplace(whole));
    return;
  }
  programs_ = std::move(programs);
  std::set<std::uint32_t> models;
  if (property != nullptr) models = names_of(whole, *property).models;
  for (const std::uint32_t program : programs_) models.merge(models_of(whole.programs[program]));
  add_models_joined(whole, models);
  System& own = own_.emplace();
  own.file = whole.file;
  own.settings = whole.settings;
  own.words = whole.words;
  own.holes = whole.holes;
  program_numbers_.resize(whole.programs.size(), not_there);
  model_numbers_.resize(whole.models.size(), not_there);
  for (const std::uint32_t model : models) {
    model_numbers_[model] = static_cast<std::uint32_t>(own.models.size());
    own.models.push_back(whole.models[model]);
  }
  add_programs();
  add_ends();
  add_nobodys_actions();
  if (property != nullptr) {
    own.sources = whole.sources;
    for (const Atom& atom : atoms_of(*property)) {
      if (atom.kind == Atom::Kind::expression) own.expressions = whole.expressions;
    }
  }
  if (may_hear_nothing) count_on_nobody(own);
  for (Expression& expression : own.expressions) {
    for_each_leaf(expression, [&](Expression& leaf) {
      if (leaf.op == Expression::Operator::local) {
        leaf.owner = program_numbers_[leaf.owner];
      } else {
        leaf.index = model_numbers_[leaf.index];
      }
    });
  }
}

void SystemPart::add_programs() {
  for (const std::uint32_t number : programs_) {
    program_numbers_[number] = static_cast<std::uint32_t>(own_->programs.size());
    Program& program = own_->programs.emplace_back(whole_->programs[number]);
    for (std::uint32_t& model : program.names) model = model_numbers_[model];
    if (program.life) program.life->model = model_numbers_[program.life->model];
    for (ProgramEdge& edge : program.edges) static_cast<ModelUse&>(edge) = renumbered(edge);
    for (CombinedStep& combined : program.combined) combined = renumbered(std::move(combined));
  }
}

// Steps name callbacks by their numbers, so all of them stay. Topics and services are those whose
// models are there.
void SystemPart::add_ends() {
  own_->executors = whole_->executors;
  own_->callbacks = whole_->callbacks;
  for (CallbackInstance& callback : own_->callbacks) {
    const bool has_model =
        callback.kind == CallbackKind::service || callback.kind == CallbackKind::client;
    if (has_model) callback.model = model_numbers_[callback.model];
  }
  for (ServiceInstance service : whole_->services) {
    service.model = model_numbers_[service.model];
    if (service.model != not_there) own_->services.push_back(std::move(service));
  }
  for (TopicInstance topic : whole_->topics) {
    for (TopicInstance::Reader& reader : topic.readers) {
      reader.program = program_numbers_[reader.program];
      reader.model = model_numbers_[reader.model];
    }
    for (std::uint32_t& writer : topic.writers) writer = program_numbers_[writer];
    const bool is_there = std::ranges::all_of(
        topic.readers, [](const auto& reader) { return reader.model != not_there; });
    if (is_there) own_->topics.push_back(std::move(topic));
  }
}

void SystemPart::add_nobodys_actions() {
  nobodys_actions_.clear();
  own_->nobodys_groups = whole_->nobodys_groups;
  for (std::uint32_t number = 0; number < whole_->nobodys_actions.size(); ++number) {
    const NobodysAction& action = whole_->nobodys_actions[number];
    const auto& uses = action.what.uses;
    if (uses.empty() || model_numbers_[uses.front().model] == not_there) continue;
    nobodys_actions_.push_back(number);
    NobodysAction& own = own_->nobodys_actions.emplace_back(action);
    own.what = renumbered(std::move(own.what));
  }
}

CombinedStep SystemPart::renumbered(CombinedStep step) const {
  for (ModelUse& use : step.uses) use = renumbered(use);
  for (ModelUse& event : step.events) event = renumbered(event);
  return step;
}

ModelUse SystemPart::renumbered(ModelUse use) const {
  const bool has_model = use.kind != ModelUse::Kind::choice && use.kind != ModelUse::Kind::combined;
  if (has_model) use.model = model_numbers_[use.model];
  return use;
}

Property SystemPart::property(const Property& of_whole) const {
  Property result = of_whole;
  if (is_whole()) return result;
  const auto change = [&](Atom atom) {
    switch (atom.kind) {
      case Atom::Kind::label:
      case Atom::Kind::end: atom.owner = program_numbers_[atom.owner]; break;
      case Atom::Kind::input:
      case Atom::Kind::output:
        atom.owner = model_numbers_[atom.owner];
        if (atom.program != Atom::any_program) atom.program = program_numbers_[atom.program];
        break;
      case Atom::Kind::expression: break;
    }
    return atom;
  };
  if (result.formula) result.formula = with_atoms(result.formula, change);
  if (result.never) {
    LtlAutomaton automaton = *result.never;
    for (Atom& atom : automaton.atoms) atom = change(atom);
    result.never = std::make_shared<const LtlAutomaton>(std::move(automaton));
  }
  return result;
}

bool SystemPart::has(const Step& step) const {
  const auto& own = step.actor == nobody ? nobodys_actions_ : programs_;
  return std::ranges::binary_search(own, step.actor == nobody ? step.action : step.actor);
}

Step SystemPart::to_whole(Step step) const {
  if (step.actor == nobody) {
    step.action = nobodys_actions_[step.action];
  } else {
    step.actor = programs_[step.actor];
  }
  return step;
}

Step SystemPart::from_whole(Step step) const {
  if (is_whole()) return step;
  if (step.actor == nobody) {
    const auto own = std::ranges::lower_bound(nobodys_actions_, step.action);
    MAIDE_CHECK(own != nobodys_actions_.end() && *own == step.action);
    step.action = static_cast<std::uint32_t>(own - nobodys_actions_.begin());
  } else {
    step.actor = program_numbers_[step.actor];
    MAIDE_CHECK(step.actor != not_there);
  }
  return step;
}

}  // namespace maide
