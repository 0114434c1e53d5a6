// Models, topics and services in a program's text, and their inputs and outputs: `M.write(e)`,
// `message(var x)`. An index whose value is not known before the run may name any member of its
// array.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "maide/check/build/name_resolver.hpp"

namespace maide::program_syntax {

class EventResolver {
 public:
  // Keeps references.
  EventResolver(NameResolver& names, Work& work) : names_(names), work_(work) {}

  ModelReference model(const syntax::Term& term) const;
  Event input(const ModelReference& model, const syntax::Event& event) const;
  // Declares the variables that take its values.
  Event output(const ModelReference& model, const syntax::Event& event) const;

  // Whether `M -> output` is about what this program sent to the model, which has no such output.
  bool is_arrival(const ModelReference& model, const syntax::Event& output) const;
  // A model or topic, or one reader of a topic: `image[logger]`.
  ModelReference sent_to(const syntax::Term& term) const;
  Event arrival(const ModelReference& model, const syntax::Event& output) const;

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
    for_each_member(model, [&](std::uint32_t member) { visit(context().names.topics[member]); });
  }
  // The model, or one like it: the first member's, the first reader's.
  const ModelInstance& instance(const ModelReference& model) const;
  // Of a service, by its members that the program or node stands at; null: it is none.
  const Service* service_of(const ModelReference& model) const;
  bool is_condition(const ModelReference& model) const;
  // The program or node is the server of that service; of each that it may be.
  bool is_server(const ModelReference& model) const;

 private:
  enum class Direction : std::uint8_t { input, output };
  const Context& context() const { return names_.context(); }
  // Whether what stands in brackets behind the name is a reader of the topic.
  bool names_reader(const syntax::Term& term) const;
  void check_reader(const ModelReference& model, const syntax::Term& reader) const;
  // A topic's writer or reader is meant, and this program or node is it.
  void check_role(const ModelReference& model, bool is_write, const syntax::Name& name) const;
  // Whose callback this is code of, or starts; empty: a program's.
  std::string node() const;
  [[noreturn]] void fail_unknown_model(const syntax::Name& name, bool is_unknown) const;
  // What is written into it, if it is a queue whose values programs decide; else null.
  const std::vector<ValueType>* carried(const ModelReference& model) const;
  // The values of the output's next argument. None: it never has one there.
  std::optional<ValueType> type_of(const ModelReference& model, const Event& event) const;
  // An input or output without its arguments.
  Event event_named(const ModelReference& model, const syntax::Event& event,
                    Direction direction) const;
  // The name in the model of what this program calls so: the second writer's `write` is `write2`.
  std::string name_at_end(const ModelReference& model, const std::string& name) const;
  std::string name_at_service(const ModelReference& model, const syntax::Name& name,
                              Direction direction) const;
  // The model has a symbol of that name.
  void check_event(const ModelReference& model, const Event& event, const syntax::Name& name,
                   Direction direction) const;
  // Nothing is received in a callback but through its executor.
  void check_received(const ModelReference& model, const Event& event, const syntax::Name& name,
                      Direction direction) const;
  // A topic's writers write, and its readers read. Which topic it is that an index names shows when
  // control comes there.
  void check_role(const ModelReference& model, const Event& event, const syntax::Name& name) const;
  // Tells the values to all members of the array: they carry values of one type.
  void note_value(const ModelReference& model, const Event& event, const ValueType& type) const;
  // An input whose values are known at once is one of the model.
  void check_constant_input(const ModelReference& model, const Event& event,
                            const syntax::Name& name) const;
  // A value of a model's: its words need be known nowhere else.
  Expression argument(const ModelReference& model, const syntax::Term& term) const;
  // A variable that takes the value, or a value.
  Event::Argument pattern(const ModelReference& model, const Event& event,
                          const syntax::Argument& argument) const;

  NameResolver& names_;
  Work& work_;
};

}  // namespace maide::program_syntax
