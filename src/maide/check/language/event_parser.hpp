// Models, topics and their inputs and outputs in a program's text: `M.write(e)`, `message(var x)`.
// An index whose value is not known before the run may name any member of its array.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/language/name_parser.hpp"

namespace maide::program_syntax {

class EventParser : public NameParser {
 public:
  using NameParser::NameParser;

 protected:
  ModelReference parse_model();
  // The instances or topics that the reference may mean: one, if its indices are known.
  template <typename Visit>
  void for_each_member(const ModelReference& model, const Visit& visit) const {
    std::vector<Value> indices;
    for (const Expression& index : model.leaf.operands) {
      if (index.is_constant()) indices.push_back(index.value);
    }
    if (indices.size() == model.leaf.operands.size()) {
      try {
        visit(model.leaf.index + element_of(model.leaf, indices));
      } catch (const EvaluationError&) {  // an error of the run that comes there
      }
      return;
    }
    const auto count = static_cast<std::uint32_t>(member_count(model.leaf.dimensions));
    for (std::uint32_t i = 0; i < count; ++i) visit(model.leaf.index + i);
  }
  template <typename Visit>
  void for_each_topic(const ModelReference& model, const Visit& visit) const {
    if (!model.is_topic) return;
    for_each_member(model, [&](std::uint32_t member) { visit(context_.names.topics[member]); });
  }
  [[noreturn]] void fail_unknown_model(const Token& name, bool is_unknown);
  // The model, or one like it: the first member's, the first reader's.
  const ModelInstance& instance(const ModelReference& model) const;
  // The name in the model of what this program calls so: the second writer's `write` is `write2`.
  std::string name_at_end(const ModelReference& model, const std::string& name) const;
  // A topic's writers write, and its readers read. Which topic it is that an index names shows when
  // control comes there.
  void check_role(const ModelReference& model, const Event& event, const Token& name);
  // Of a service, by its members that the program or node stands at; null: it is none.
  const Service* service_of(const ModelReference& model) const;
  std::string name_at_service(const ModelReference& model, const std::string& name, bool is_input,
                              const Token& token);
  // Nothing is received in a callback but through its executor.
  void check_received(const ModelReference& model, const Event& event, bool is_input,
                      const Token& name);
  Event parse_event_name(const ModelReference& model, std::string_view what);
  // The model has a symbol of that name. A model whose alphabet is not known yet has any.
  void check_event(const ModelReference& model, const Event& event, const Token& name,
                   std::string_view what);
  Event parse_input(const ModelReference& model);
  // Tells it of all members of the array: they have one alphabet.
  void note_value(const ModelReference& model, const Event& event, const ValueType& type);
  // What is known at once is an input of the model.
  void check_constant_input(const ModelReference& model, const Event& event, const Token& name);
  // A value of a model's: its words need be known nowhere else.
  Expression parse_argument(const ModelReference& model);
  Event parse_output(const ModelReference& model);
  // A variable that takes the value, or a value.
  Event::Argument parse_pattern(const ModelReference& model, const Event& event);
};

}  // namespace maide::program_syntax
