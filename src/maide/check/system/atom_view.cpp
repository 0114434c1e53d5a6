#include "maide/check/system/atom_view.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "maide/check/ltl/ltl_automaton.hpp"

namespace maide {
namespace {

// It is no condition.
bool may_change(const ModelInstance& model, const ModelUse& use) {
  if (use.kind == ModelUse::Kind::quiet) return false;
  if (use.kind != ModelUse::Kind::act) return true;
  const auto& steps = model.actions[use.index].steps;
  for (StateId at = 0; at < steps.size(); ++at) {
    if (std::ranges::any_of(steps[at], [&](const ModelStep& step) { return step.target != at; })) {
      return true;
    }
  }
  return false;
}

}  // namespace

AtomView::AtomView(const Atom& atom, const System& system) : atom_(atom), system_(&system) {
  if (atom.is_event()) return;
  if (atom.kind != Atom::Kind::expression) {
    program_field(atom.owner);
    return;
  }
  for_each_variable(system.expressions[atom.owner], [&](const Expression& leaf) {
    for (std::uint32_t i = 0; i < element_count(leaf); ++i) {
      if (leaf.op == Expression::Operator::local) {
        program_field(leaf.owner).variables.push_back(leaf.index + i);
      } else {
        field(true, leaf.index + i);
      }
    }
  });
}

AtomField& AtomView::program_field(std::uint32_t program) {
  if (const auto& life = system_->programs[program].life) field(true, life->model);
  return field(false, program);
}

AtomField& AtomView::field(bool is_model, std::uint32_t index) {
  for (AtomField& known : fields_) {
    if (known.is_model == is_model && known.index == index) return known;
  }
  return fields_.emplace_back(AtomField{is_model, index, {}});
}

bool AtomView::sees(std::uint32_t actor, std::uint32_t action) const {
  const Step step{actor, action, {}, false, false};
  if (atom_.is_event())
    return is_event_of(atom_, doer_of(*system_, step), events_of(*system_, step));
  const auto uses = uses_of(*system_, step);
  return std::ranges::any_of(fields_, [&](const AtomField& field) {
    if (field.is_model) {
      return std::ranges::any_of(uses, [&](const ModelUse& use) {
        return use.model == field.index && may_change(system_->models[field.index], use);
      });
    }
    if (field.index != actor) return false;
    const Program& program = system_->programs[actor];
    return seen_at(field, program.source_of(action)) !=
           seen_at(field, program.edges[action].target);
  });
}

std::vector<std::optional<Value>> AtomView::seen_at(const AtomField& field,
                                                    ControlState place) const {
  const Program& program = system_->programs[field.index];
  if (atom_.kind == Atom::Kind::label) return {program.has_label(place, atom_.symbol)};
  if (atom_.kind == Atom::Kind::end) return {program.is_end(place)};
  std::vector<std::optional<Value>> values;
  for (const std::uint32_t number : field.variables) {
    values.push_back(program.value_of(place, number));
  }
  return values;
}

AtomView::Values AtomView::values(const std::vector<std::vector<std::uint32_t>>& states,
                                  std::size_t most) const {
  std::size_t count = 1;
  for (const auto& of_field : states) {
    if (of_field.size() > most / count) return std::nullopt;
    count *= of_field.size();
  }
  GlobalState state = initial_state(*system_);
  std::vector<bool> values(count);
  for (std::size_t number = 0; number < count; ++number) {
    std::size_t rest = number;
    for (std::size_t i = fields_.size(); i-- > 0; rest /= states[i].size()) {
      auto& component = fields_[i].is_model ? state.models : state.programs;
      component[fields_[i].index] = states[i][rest % states[i].size()];
    }
    values[number] = is_true(atom_, *system_, state, nullptr);
  }
  return values;
}

std::vector<Atom> atoms_of(const Property& property) {
  if (property.never) return property.never->atoms;
  return property.formula ? atoms_of(property.formula) : std::vector<Atom>();
}

std::vector<AtomView> views_of(std::span<const Atom> atoms, const System& system) {
  std::vector<AtomView> views;
  for (const Atom& atom : atoms) views.emplace_back(atom, system);
  return views;
}

bool is_visible(std::span<const AtomView> views, std::uint32_t actor, std::uint32_t action) {
  return std::ranges::any_of(views, [&](const AtomView& view) { return view.sees(actor, action); });
}

std::size_t count_states(const AtomField& field, const System& system) {
  return field.is_model ? system.models[field.index].automaton.size()
                        : system.programs[field.index].states.size();
}

StateClasses classes_of(const AtomField& field, std::span<const AtomView> views,
                        const System& system) {
  StateClasses classes;
  std::map<std::vector<std::optional<Value>>, std::uint32_t> known;
  for (std::uint32_t at = 0; at < count_states(field, system); ++at) {
    std::vector<std::optional<Value>> seen;
    if (field.is_model) seen.emplace_back(at);
    for (const AtomView& view : views) {
      for (const AtomField& other : view.fields()) {
        if (field.is_model || other.is_model || other.index != field.index) continue;
        std::ranges::copy(view.seen_at(other, at), std::back_inserter(seen));
      }
    }
    const auto [entry, is_new] =
        known.try_emplace(std::move(seen), static_cast<std::uint32_t>(classes.examples.size()));
    if (is_new) classes.examples.push_back(at);
    classes.of_states.push_back(entry->second);
  }
  return classes;
}

AtomTable table_of(const AtomView& view, std::span<const AtomView> all, const System& system,
                   std::size_t most) {
  AtomTable table;
  std::vector<std::vector<std::uint32_t>> states;
  for (const AtomField& field : view.fields()) {
    table.classes.push_back(classes_of(field, all, system));
    states.push_back(table.classes.back().examples);
  }
  table.values = view.values(states, most);
  return table;
}

}  // namespace maide
