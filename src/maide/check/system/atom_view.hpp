// What an atom of a formula depends on. An atom that is no event sees a few components of a state,
// its fields: a program's place, as far as a label, the end or variables tell places apart, and the
// values of shared variables. Monitors and exports make a table of the atom's values from them.
//
// A program whose process is dead is at no label, and its variables are as at first. So the model
// that says whether it lives is a field, too.
//
// An example: `camera.left < n`, with a variable `left` of a program and a shared variable `n`, has
// two fields. A step of `camera` that leaves `left` as it is is not seen. An event, `port.write`,
// has no fields: it depends on the last step, and not on the state.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "maide/check/system/system.hpp"

namespace maide {

struct AtomField {
  bool is_model = false;
  std::uint32_t index = 0;               // of the program or model
  std::vector<std::uint32_t> variables;  // of the program; none: a label, or its end
};

class AtomView {
 public:
  // Keeps a reference to the system.
  AtomView(const Atom& atom, const System& system);

  // Each component once, in the order of the atom.
  const std::vector<AtomField>& fields() const { return fields_; }
  // Whether that edge of a program, or action of nobody, may change what the atom is, or is an
  // event that it names.
  bool sees(std::uint32_t actor, std::uint32_t action) const;
  // What the atom sees of the field's program there.
  std::vector<std::optional<Value>> seen_at(const AtomField& field, ControlState place) const;
  // The atom's value for each combination of states: for each field those that may be combined. The
  // last field's run fastest. Nothing where there are more combinations than `most`.
  using Values = std::optional<std::vector<bool>>;
  Values values(const std::vector<std::vector<std::uint32_t>>& states, std::size_t most) const;

 private:
  AtomField& program_field(std::uint32_t program);
  AtomField& field(bool is_model, std::uint32_t index);

  Atom atom_;
  const System* system_;
  std::vector<AtomField> fields_;
};

std::vector<Atom> atoms_of(const Property& property);
std::vector<AtomView> views_of(std::span<const Atom> atoms, const System& system);

// Whether one of them sees the step of the actor.
bool is_visible(std::span<const AtomView> views, std::uint32_t actor, std::uint32_t action);

// Places of a program, or states of a model.
std::size_t count_states(const AtomField& field, const System& system);

// The states of a field, in one class where no view tells them apart.
struct StateClasses {
  std::vector<std::uint32_t> of_states;  // by state; classes are numbered as they occur
  std::vector<std::uint32_t> examples;   // by class: its first state
};
StateClasses classes_of(const AtomField& field, std::span<const AtomView> views,
                        const System& system);

// An atom as a table: its values by the classes of its fields, where no view of `all` tells states
// apart (AtomView::values).
struct AtomTable {
  std::vector<StateClasses> classes;  // by field
  AtomView::Values values;
};
AtomTable table_of(const AtomView& view, std::span<const AtomView> all, const System& system,
                   std::size_t most);

}  // namespace maide
