// A system as a plug-in of LTSmin. The idea: the text is tables, and one piece of code that reads
// them. It is the same for every system, so a compiler takes a second for a large one, too. What
// partial-order reduction wants to know is computed from the tables when the plug-in is loaded.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <ostream>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/engines/export/pins_code.hpp"
#include "maide/check/engines/export/step_rules.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "maide/check/reduce/reduction.hpp"
#include "maide/check/system/atom_view.hpp"
#include "maide/formats/names.hpp"

namespace maide {

namespace {

constexpr std::size_t most_combined = std::size_t{1} << 20;  // that one comparison may combine

// In double quotes, as a string of C++.
std::string cpp_string(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += {'\\', c};
    } else if (byte < 32 || byte >= 127) {
      quoted += fmt::format("\\{:03o}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + '"';
}

class PinsWriter {
 public:
  PinsWriter(std::ostream& out, const System& system, std::span<const Property> properties)
      : out_(out),
        system_(system),
        properties_(properties),
        rules_(system),
        names_(system),
        identifiers_(cpp_reserved()),
        has_errors_(has_errors(system)) {
    for (std::uint32_t program = 0; program < system.programs.size(); ++program) {
      std::map<std::pair<RuleAction, bool>, std::size_t> known;
      for (ControlState at = 0; at < system.programs[program].states.size(); ++at) {
        add_place(program, at, known);
      }
    }
    std::map<std::pair<RuleAction, bool>, std::size_t> known;
    if (!system.nobodys_actions.empty()) add_place(nobody, 0, known);
  }

  void write() {
    out_ << fmt::format("// {}: a plug-in of LTSmin's PINS interface.\n",
                        comment_text(system_.file))
         << "// To make it: c++ -std=c++17 -O2 -shared -fPIC -o system.so THIS_FILE\n"
         << pins_declarations;
    write_slots();
    write_rules();
    write_relations();
    out_ << pins_steps;
    write_labels();
    out_ << pins_labels;
  }

 private:
  struct Group {
    StepRule rule;  // one of its
    bool is_error = false, is_idle = false;
  };
  struct Rule {
    std::size_t group = 0;
    ControlState target = 0;
  };

  // The rules of one place, by their groups: LTSmin wants a state's transitions in their order.
  void add_place(std::uint32_t actor, ControlState at,
                 std::map<std::pair<RuleAction, bool>, std::size_t>& known) {
    std::vector<Rule> here;
    for (const StepRule& rule : rules_.rules_of(actor, at)) {
      const Step step = StepRules::begun_step(rule);
      const ControlState target =
          rule.is_cut || actor == nobody ? at : edge_of(system_, step).target;
      const bool is_error =
          !rule.is_cut && actor != nobody && system_.programs[actor].is_error(target);
      const auto [entry, is_new] =
          known.try_emplace({rules_.action_of(rule), is_error}, groups_.size());
      if (is_new) groups_.push_back({rule, is_error, !is_progress(system_, step)});
      here.push_back({entry->second, target});
    }
    std::ranges::stable_sort(here, {}, &Rule::group);
    first_rule_.push_back(place_rules_.size());
    place_rules_.insert(place_rules_.end(), here.begin(), here.end());
  }

  std::size_t slot_of_model(std::uint32_t model) const { return actor_count(system_) + model; }
  std::size_t slots() const {
    return actor_count(system_) + system_.models.size() + (has_errors_ ? 1 : 0);
  }

  void constant(std::string_view name, std::size_t value) {
    out_ << fmt::format("constexpr int {} = {};\n", name, value);
  }
  // A table with one more row than is used: C++ has none without rows.
  template <typename Rows>
  void table(std::string_view type, std::string_view name, const Rows& rows) {
    out_ << fmt::format("constexpr {} {}[] = {{", type, name);
    std::size_t width = 100;
    for (const std::string& row : rows) {
      if (width + row.size() > 96) {
        out_ << "\n   ";
        width = 3;
      }
      out_ << ' ' << row << ',';
      width += row.size() + 2;
    }
    out_ << " {}};\n";
  }
  template <typename Numbers>
  void numbers(std::string_view name, const Numbers& values) {
    std::vector<std::string> rows;
    for (const auto value : values) rows.push_back(std::to_string(value));
    table("int", name, rows);
  }

  void write_slots() {
    out_ << "\n// ---- The state: each program's place, each model's state";
    out_ << (has_errors_ ? ", and whether a program is at an error ----\n\n" : " ----\n\n");
    constant("programs", actor_count(system_));
    constant("slots", slots());
    out_ << fmt::format("constexpr int halted = {};  // its slot; -1: nothing goes wrong\n",
                        has_errors_ ? static_cast<int>(slots()) - 1 : -1);
    std::vector<std::string> names;
    std::vector<std::size_t> initial(actor_count(system_), 0);
    for (const Program& program : system_.programs) {
      names.push_back(cpp_string(identifiers_.unique("p_" + program.name)));
    }
    if (!system_.nobodys_actions.empty())
      names.push_back(cpp_string(identifiers_.unique("nobody")));
    for (const ModelInstance& model : system_.models) {
      names.push_back(cpp_string(identifiers_.unique("m_" + model.name)));
      initial.push_back(model.automaton.initial());
    }
    if (has_errors_) {
      names.push_back(cpp_string("halted"));
      initial.push_back(is_error(system_, initial_state(system_)) ? 1 : 0);
    }
    table("const char *", "slot_names", names);
    numbers("initial", initial);
    std::vector<std::size_t> first_place;
    std::vector<int> may_stay;
    for (const Program& program : system_.programs) {
      first_place.push_back(may_stay.size());
      for (ControlState at = 0; at < program.states.size(); ++at) {
        may_stay.push_back(program.is_end(at) || program.may_rest(at) ? 1 : 0);
      }
    }
    if (!system_.nobodys_actions.empty()) {
      first_place.push_back(may_stay.size());
      may_stay.push_back(1);
    }
    first_place.push_back(may_stay.size());
    numbers("first_place", first_place);
    numbers("may_stay", may_stay);
  }

  void write_rules() {
    out_ << "\n// ---- What programs do ----\n\n";
    std::map<std::string, std::size_t> actions;
    std::vector<std::string> action_names, groups, relations, rules;
    std::size_t most_parts = 1;
    std::vector<std::uint32_t> part;
    for (const Group& group : groups_) {
      const std::string name = names_.of(rules_.action_of(group.rule).action);
      const auto [entry, is_new] = actions.try_emplace(name, actions.size());
      if (is_new) action_names.push_back(cpp_string(name));
      const std::size_t first = part.size();
      part.insert(part.end(), group.rule.relations.begin(), group.rule.relations.end());
      most_parts = std::max(most_parts, part.size() - first);
      groups.push_back(fmt::format(
          "{{{}, {}, {}, {}, {}, {}, {}}}", actor_number(system_, group.rule.actor), first,
          part.size(), entry->second, group.rule.is_cut, group.is_error, group.is_idle));
    }
    for (const Rule& rule : place_rules_) {
      rules.push_back(fmt::format("{{{}, {}}}", rule.group, rule.target));
    }
    constant("group_count", groups_.size());
    constant("action_count", action_names.size());
    constant("most_parts", most_parts);
    table("const char *", "action_names", action_names);
    table("group_row", "groups", groups);
    numbers("part", part);
    std::vector<std::size_t> first_rule = first_rule_;
    first_rule.push_back(place_rules_.size());
    numbers("first_rule", first_rule);
    table("rule_row", "rules", rules);
  }

  void write_relations() {
    out_ << "\n// ---- What models do ----\n\n";
    std::vector<std::string> rows;
    std::vector<std::size_t> first_move;
    std::vector<StateId> targets;
    for (const ModelRelation& relation : rules_.relations()) {
      const auto states = static_cast<StateId>(system_.models[relation.model()].automaton.size());
      rows.push_back(fmt::format("{{{}, {}, {}}}", slot_of_model(relation.model()),
                                 first_move.size(), states));
      auto move = relation.moves.begin();
      for (StateId state = 0; state < states; ++state) {
        first_move.push_back(targets.size());
        for (; move != relation.moves.end() && move->first == state; ++move) {
          targets.push_back(move->second);
        }
      }
      first_move.push_back(targets.size());
    }
    constant("relation_count", rows.size());
    table("relation_row", "relations", rows);
    numbers("first_move", first_move);
    numbers("next_state", targets);
  }

  // ---- Labels ----

  struct Label {
    std::string name, function;
    std::set<std::size_t> slots;  // that it sees
  };

  void write_labels() {
    std::vector<Label> labels = built_in_labels();
    std::string functions;
    for (const Property& property : properties_) {
      const std::string why = why_no_label(system_, property);
      if (!why.empty()) continue;
      Label label;
      label.name = identifiers_.unique("always_" + property.name);
      label.function = fmt::format("holds_{}", labels.size());
      if (has_errors_) label.slots.insert(slots() - 1);
      functions += fmt::format("// {}\nint {}(const int *state) {{\n  return {}{};\n}}\n",
                               comment_text(property.name), label.function,
                               has_errors_ ? "is_halted(state) || " : "",
                               condition(negation_normal_form(invariant_of(property)), label));
      labels.push_back(std::move(label));
    }
    numbers("seen_class", classes_);
    table("seen_row", "seen", seen_);
    numbers("atom_value", values_);
    table("atom_row", "atoms", atom_rows_);
    out_ << pins_atoms << functions;
    std::vector<std::string> rows;
    std::vector<int> sees;
    for (const Label& label : labels) {
      rows.push_back(fmt::format("{{{}, {}}}", cpp_string(label.name), label.function));
      for (std::size_t slot = 0; slot < slots(); ++slot) {
        sees.push_back(label.slots.contains(slot) ? 1 : 0);
      }
    }
    constant("further_count", rows.size());
    table("further_row", "further", rows);
    numbers("sees", sees);
  }

  std::vector<Label> built_in_labels() {
    Label end{"valid_end_state", "valid_end", {}};
    for (std::size_t slot = 0; slot < actor_count(system_); ++slot) end.slots.insert(slot);
    if (has_errors_) end.slots.insert(slots() - 1);
    Label deadlock{"deadlock", "deadlock", end.slots};
    Label beyond{"beyond", "beyond", {}};
    for (const Group& group : groups_) {
      for (const std::uint32_t number : group.rule.relations) {
        const std::size_t slot = slot_of_model(rules_.relations()[number].model());
        deadlock.slots.insert(slot);
        if (group.rule.is_cut) beyond.slots.insert(slot);
      }
      if (group.rule.is_cut) beyond.slots.insert(actor_number(system_, group.rule.actor));
    }
    if (has_errors_) beyond.slots.insert(slots() - 1);
    Label error{"error", "error", {}};
    if (has_errors_) error.slots.insert(slots() - 1);
    return {end, deadlock, error, beyond};
  }

  // In C++, over atoms.
  std::string condition(const Formula& formula, Label& label) {
    using Operator = FormulaNode::Operator;
    const auto part = [&](const Formula& operand) { return condition(operand, label); };
    switch (formula->op) {
      case Operator::truth: return "true";
      case Operator::falsity: return "false";
      case Operator::atom: return atom(formula->atom, label);
      case Operator::negation: return "!" + part(formula->left);
      case Operator::conjunction:
        return fmt::format("({} && {})", part(formula->left), part(formula->right));
      case Operator::disjunction:
        return fmt::format("({} || {})", part(formula->left), part(formula->right));
      default: throw std::logic_error("a condition has a temporal operator");
    }
  }

  std::string atom(const Atom& atom, Label& label) {
    const AtomView view(atom, system_);
    const AtomTable table = table_of(view, {&view, 1}, system_, most_combined);
    const std::size_t first_seen = seen_.size(), first_value = values_.size();
    for (std::size_t i = 0; i < table.classes.size(); ++i) {
      const auto& [is_model, index, variables] = view.fields()[i];
      const auto& [of_states, examples] = table.classes[i];
      const std::size_t slot = is_model ? slot_of_model(index) : index;
      label.slots.insert(slot);
      seen_.push_back(fmt::format("{{{}, {}, {}}}", slot, classes_.size(), examples.size()));
      classes_.insert(classes_.end(), of_states.begin(), of_states.end());
    }
    values_.insert(values_.end(), table.values->begin(), table.values->end());
    atom_rows_.push_back(fmt::format("{{{}, {}, {}}}", first_seen, seen_.size(), first_value));
    return fmt::format("is_true({}, state)", atom_rows_.size() - 1);
  }

  std::ostream& out_;
  const System& system_;
  std::span<const Property> properties_;
  StepRules rules_;
  ActionNames names_;
  Identifiers identifiers_;
  bool has_errors_;
  std::vector<Group> groups_;
  std::vector<std::size_t> first_rule_;  // by place, of all programs
  std::vector<Rule> place_rules_;
  std::vector<std::uint32_t> classes_;
  std::vector<int> values_;
  std::vector<std::string> seen_, atom_rows_;
};

}  // namespace

std::string why_no_label(const System& system, const Property& property) {
  const Formula condition = invariant_of(property);
  if (!condition) return "is no `always`";
  for (const Atom& atom : atoms_of(condition)) {
    if (atom.is_event()) return "sees events, and not states alone";
    const AtomView view(atom, system);
    if (!table_of(view, {&view, 1}, system, most_combined).values)
      return "compares too many values";
  }
  return "";
}

void write_pins(std::ostream& out, const System& system, std::span<const Property> properties) {
  PinsWriter(out, system, properties).write();
}

}  // namespace maide
