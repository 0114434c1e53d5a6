#include "maide/check/unroll/edge_writer.hpp"

#include <algorithm>
#include <utility>

#include "maide/check/unroll/wire_uses.hpp"

namespace maide::program_syntax {

void EdgeWriter::add_edge(const ModelUse& use, ControlState target, int line, int column) {
  if (life_ != nullptr && use.kind != ModelUse::Kind::combined) {
    const bool is_choice = use.kind == ModelUse::Kind::choice;
    return add_combined(as_combined_step(use, is_choice ? nullptr : &actions_.model(use.model)),
                        target, line, column);
  }
  look_sometimes();
  if (use.kind == ModelUse::Kind::take && actions_.model(use.model).awaits_anybody) {
    const ModelInstance& model = actions_.model(use.model);
    return add_combined({CombinedStep::Role::step,
                         {use},
                         {use},
                         model.name + "!" + model.automaton.outputs().name(use.index),
                         0},
                        target, line, column);
  }
  program_.edges.push_back({use, target, line, column, origin_});
}

void EdgeWriter::add_combined(CombinedStep combined, ControlState target, int line, int column) {
  const auto is_of_life = [this](const ModelUse& use) { return use.model == life_->model; };
  if (life_ != nullptr && std::ranges::none_of(combined.uses, is_of_life)) {
    combined.uses.push_back(use(*life_, LifeRules::Operation::Kind::is_alive));
  }
  std::sort(combined.uses.begin(), combined.uses.end(),
            [](const ModelUse& a, const ModelUse& b) { return a.model < b.model; });
  combined.awaits_anybody =
      combined.awaits_anybody ||
      (!was_found_ && std::ranges::any_of(combined.events, [&](const ModelUse& event) {
        return event.kind == ModelUse::Kind::take && actions_.model(event.model).awaits_anybody;
      }));
  const auto number = static_cast<Symbol>(program_.combined.size());
  program_.combined.push_back(std::move(combined));
  add_edge({ModelUse::Kind::combined, 0, number}, target, line, column);
}

std::uint32_t EdgeWriter::fair_group(const Callback* callback, int line, int column, Value outcome,
                                     bool on_weak_runs, const std::string& text) {
  const auto [place, is_new] = fair_ids_.try_emplace(
      {callback, line, column, outcome}, static_cast<std::uint32_t>(program_.fair_groups.size()));
  if (is_new) program_.fair_groups.push_back({on_weak_runs, text});
  return place->second;
}

std::uint32_t EdgeWriter::intern_origin(const std::optional<SourcePosition>& origin) {
  if (!origin) return 0;
  auto& origins = program_.origins;
  if (origins.empty()) origins.emplace_back();
  const auto [known, is_new] = origin_ids_.try_emplace({origin->file, origin->line, origin->column},
                                                       static_cast<std::uint32_t>(origins.size()));
  if (is_new) origins.push_back(*origin);
  return known->second;
}

std::string EdgeWriter::text_of(const Uses& uses, const ModelActions& actions) {
  std::string text;
  for (const ModelUse& use : uses) {
    text += (text.empty() ? "" : ", ") + actions.model(use.model).actions[use.index].name;
  }
  return text;
}

const Wire* EdgeWriter::wire_for(std::uint32_t model, Symbol input,
                                 const Callback* callback) const {
  const Wire* const wire = names_.wire_of(model, node_of(callback), number_);
  if (wire == nullptr || std::ranges::find(wire->letters, input) == wire->letters.end())
    return nullptr;
  return wire;
}

std::optional<ModelUse> EdgeWriter::when_own_arrived(std::uint32_t model, Symbol input,
                                                     const Callback* callback) {
  const Wire* const wire = names_.wire_of(model, node_of(callback), number_);
  if (wire == nullptr || wire->others.empty()) return std::nullopt;
  if (std::ranges::find(wire->others, input) == wire->others.end()) return std::nullopt;
  return when_empty(*wire, actions_);
}

std::vector<const Wire*> EdgeWriter::own_wires(const ModelReference& model,
                                               const Callback* callback,
                                               const Values& values) const {
  std::vector<const Wire*> wires;
  const auto add = [&](std::uint32_t to) {
    const Wire* const wire = names_.wire_of(to, node_of(callback), number_);
    if (wire != nullptr) wires.push_back(wire);
  };
  const std::uint32_t number = element(model.leaf, values);
  if (!model.is_topic) {
    add(number);
    return wires;
  }
  const Topic& topic = names_.topics[number];
  const std::string name = topic.name + "[" + model.reader + "]";
  for (const Topic::Reader& reader : topic.readers) {
    const std::string& its = actions_.model(reader.model).name;
    if (model.reader.empty() || its == name || is_reader_of(its, name)) add(reader.model);
  }
  return wires;
}

std::string EdgeWriter::text_of_arrival(const ModelReference& model, const Values& values) const {
  const std::uint32_t number = element(model.leaf, values);
  const std::string& name =
      model.is_topic ? names_.topics[number].name : actions_.model(number).name;
  return name + (model.reader.empty() ? "" : "[" + model.reader + "]") + "!arrived";
}

}  // namespace maide::program_syntax
