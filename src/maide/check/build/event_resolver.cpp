#include "maide/check/build/event_resolver.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "maide/base/text.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/check/language/code_parser.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/text/tokens.hpp"
#include "maide/formats/names.hpp"

namespace maide::program_syntax {
namespace {

// Values that occur show later.
bool is_made_by_us(const ModelInstance& model) {
  return model.source == ModelInstance::Source::built_in ||
         model.source == ModelInstance::Source::anybody;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

// ---- Models -------------------------------------------------------------------------------------

ModelReference EventResolver::model(const syntax::Term& term) const {
  const auto binding = names_.find(term.name.text);
  if (!binding || binding->kind != Binding::Kind::model) fail_unknown_model(term.name, !binding);
  ModelReference model{binding->expression, binding->model->is_topic, binding->model, ""};
  model.leaf.line = term.place.line;
  model.leaf.column = term.place.column;
  if (model.leaf.operands.empty()) {
    model.leaf.operands = names_.indices(term, model.leaf.dimensions);
    for (const Expression& index : model.leaf.operands) {
      names_.without_shared(index, term.place, "an index");
    }
  } else if (term.has_indices) {
    names_.fail("'" + term.name.text + "' is no array", term.place);
  }
  for_each_member(model, [&](std::uint32_t member) {
    if (!model.is_topic) {
      work_.names.insert(member);
      const auto condition = context().names.conditions.find(member);
      if (condition != context().names.conditions.end()) {
        work_.names.insert(condition->second.mutex);
      }
      return;
    }
    for (const Topic::Reader& reader : context().names.topics[member].readers) {
      work_.names.insert(reader.model);
    }
  });
  return model;
}

void EventResolver::fail_unknown_model(const syntax::Name& name, bool is_unknown) const {
  if (!is_unknown) names_.fail("'" + name.text + "' is no model", name.place);
  if (syntax::is_reserved(name)) {
    names_.fail("'" + name.text + "' is a keyword here", name.place);
  }
  std::map<std::pair<bool, std::uint32_t>, std::string> in_order;
  for (const auto& [other, model] : context().names.models) {
    in_order.emplace(std::pair(model.is_topic, model.first), other);
  }
  std::vector<std::string> known;
  for (const auto& [first, other] : in_order) known.push_back(other);
  names_.fail("unknown model '" + name.text + "'; there is: " + known_instead(name.text, known),
              name.place);
}

const ModelInstance& EventResolver::instance(const ModelReference& model) const {
  if (!model.is_topic) return context().models[model.leaf.index];
  return context().models[context().names.topics[model.leaf.index].readers.front().model];
}

const std::vector<ValueType>* EventResolver::carried(const ModelReference& model) const {
  const auto number = static_cast<std::uint32_t>(&instance(model) - context().models.data());
  const auto known = context().names.carried.find(number);
  return known == context().names.carried.end() ? nullptr : &known->second;
}

std::optional<ValueType> EventResolver::type_of(const ModelReference& model,
                                                const Event& event) const {
  const std::size_t place = event.arguments.size();
  const std::vector<ValueType>* const types = carried(model);
  if (types != nullptr && event.name == "message") {
    return place < types->size() ? std::optional((*types)[place]) : std::nullopt;
  }
  return argument_type(instance(model).automaton.outputs(), event.name, place, context().words);
}

const Service* EventResolver::service_of(const ModelReference& model) const {
  if (model.is_topic) return nullptr;
  const auto place = context().names.services.find(model.leaf.index);
  return place == context().names.services.end() ? nullptr : &place->second;
}

bool EventResolver::is_condition(const ModelReference& model) const {
  bool is_it = !model.is_topic;
  for_each_member(model, [&](std::uint32_t member) {
    is_it = is_it && context().names.conditions.contains(member);
  });
  return is_it;
}

bool EventResolver::is_server(const ModelReference& model) const {
  if (service_of(model) == nullptr) return false;
  bool is = true;
  for_each_member(model, [&](std::uint32_t member) {
    is = is && context().names.services.at(member).is_server(node(), context().program);
  });
  return is;
}

std::string EventResolver::node() const {
  const Callback* const callback =
      context().callback != nullptr ? context().callback : context().starts;
  return callback == nullptr ? "" : callback->node;
}

// ---- Names of inputs and outputs ----------------------------------------------------------------

std::string EventResolver::name_at_end(const ModelReference& model, const std::string& name) const {
  for (const auto& [role, ends] : model.known->ends) {
    const auto place = std::find_if(ends.begin(), ends.end(), [&](const End& end) {
      return end.is_of(node(), context().program);
    });
    if (place == ends.begin() || place == ends.end()) continue;
    for (const Actor& actor : instance(model).automaton.actors) {
      if (actor.name == role && (contains(actor.inputs, name) || contains(actor.outputs, name))) {
        return name + std::to_string(place - ends.begin() + 1);
      }
    }
  }
  return name;
}

std::string EventResolver::name_at_service(const ModelReference& model, const syntax::Name& name,
                                           Direction direction) const {
  const std::string& word = name.text;
  const bool is_input = direction == Direction::input;
  const bool is_servers = word == "serve" || word == "request" || (word == "answer" && is_input);
  const bool is_clients = word == "send" || word == "receive" || (word == "answer" && !is_input);
  if (!is_servers && !is_clients) return word;  // unknown, as check_event() says
  std::optional<std::string> at_end;
  std::string services;
  for_each_member(model, [&](std::uint32_t member) {
    const Service& service = context().names.services.at(member);
    services += (services.empty() ? "" : ", ") + service.name;
    if (is_servers) {
      if (service.is_server(node(), context().program)) at_end = word;
      const bool serves =
          context().callback == nullptr || context().callback->kind == Callback::Kind::service;
      if (word == "answer" && service.server_runs > 1 && !serves) {
        names_.fail("which request of " + service.name +
                        " this answers is not known: its callback may run several times at once",
                    name.place);
      }
      return;
    }
    const auto client = service.client_of(node(), context().program);
    if (!client) return;
    const std::string numbered = name_at_client(word, *client);
    if (at_end && at_end != numbered) {
      names_.fail("at which client of " + services + " this is depends on the index", name.place);
    }
    at_end = numbered;
  });
  if (!at_end && !services.empty()) {
    names_.fail("this " + std::string(node().empty() ? "program" : "node") + " is no " +
                    (is_servers ? "server" : "client") + " of " + services,
                name.place);
  }
  return at_end.value_or(word);
}

Event EventResolver::event_named(const ModelReference& model, const syntax::Event& event,
                                 Direction direction) const {
  Event made;
  made.name = service_of(model) != nullptr ? name_at_service(model, event.name, direction)
                                           : name_at_end(model, event.name.text);
  made.node = node();
  made.line = event.name.place.line;
  made.column = event.name.place.column;
  made.has_arguments = event.has_arguments;
  if (context().stage == Context::Stage::names) return made;
  check_event(model, made, event.name, direction);
  check_received(model, made, event.name, direction);
  check_role(model, made, event.name);
  return made;
}

void EventResolver::check_event(const ModelReference& model, const Event& event,
                                const syntax::Name& name, Direction direction) const {
  const ModelInstance& instance = this->instance(model);
  const bool is_built_in = is_made_by_us(instance);
  const bool is_input = direction == Direction::input;
  if (context().stage != Context::Stage::values && (is_built_in || instance.is_learned)) return;
  const Alphabet& alphabet = is_input ? instance.automaton.inputs() : instance.automaton.outputs();
  if (!event.has_arguments && alphabet.find(event.name)) return;
  if (!event.has_arguments && is_built_in && is_input) {
    const bool has_values =
        std::any_of(alphabet.names().begin(), alphabet.names().end(),
                    [&](const std::string& other) { return split_name(other).name == event.name; });
    if (has_values) {
      names_.fail("model " + model.name() + " is given '" + event.name +
                      "' with values elsewhere, so it takes it with values alone",
                  name.place);
    }
  }
  if (event.has_arguments && service_of(model) != nullptr) {
    names_.fail("requests and answers carry no values: write '" + model.name() +
                    (is_input ? "." : " -> ") + name.text +
                    "' without one, and keep the value in a shared variable ('variables:')",
                name.place);
  }
  const bool may_have_arguments = event.has_arguments || !is_input;
  for (const std::string& other : alphabet.names()) {
    const NameParts parts = split_name(other);
    if (may_have_arguments && !parts.arguments.empty() && parts.name == event.name) return;
  }
  names_.fail("model " + model.name() + " has no " + (is_input ? "input" : "output") + " '" +
                  event.name + "'" + (event.has_arguments ? " with values" : "") +
                  "; it has: " + known_instead(event.name, alphabet.names()),
              name.place);
}

void EventResolver::check_received(const ModelReference& model, const Event& event,
                                   const syntax::Name& name, Direction direction) const {
  if (context().callback == nullptr) return;
  const std::string& word = name.text;
  const bool of_reader = model.is_topic && !is_of_writer(instance(model).automaton, event.name);
  const bool is_taken =
      direction == Direction::input && (word == "read" || word == "receive" || word == "serve");
  if (!of_reader && !is_taken) return;
  std::string instead = "say `takes: " + model.name() + "." + word + "`";
  if (word == "receive") instead = "say `wait " + model.name() + " -> answer`";
  if (word == "serve") instead = "say `serves: " + model.name() + "`";
  names_.fail("in a callback nothing is received but through its executor: " + instead, name.place);
}

void EventResolver::check_role(const ModelReference& model, const Event& event,
                               const syntax::Name& name) const {
  check_role(model, model.is_topic && is_of_writer(instance(model).automaton, event.name), name);
}

void EventResolver::check_role(const ModelReference& model, bool is_write,
                               const syntax::Name& name) const {
  bool may = !model.is_topic || context().starts != nullptr;
  std::string topics;
  for_each_topic(model, [&](const Topic& topic) {
    may = may || topic.has_end(context().program, is_write, node());
    topics += (topics.empty() ? "" : ", ") + topic.name;
  });
  if (may || topics.empty()) return;
  names_.fail("this " + std::string(node().empty() ? "program" : "node") + " is no " +
                  (is_write ? "writer" : "reader") + " of " + topics,
              name.place);
}

// ---- What was sent ------------------------------------------------------------------------------

bool EventResolver::is_arrival(const ModelReference& model, const syntax::Event& output) const {
  if (!output.name.is("arrived")) return false;
  const InterfaceAutomaton& automaton = instance(model).automaton;
  const auto is_output = [](const std::string& name) { return split_name(name).name == "arrived"; };
  if (std::ranges::any_of(automaton.outputs().names(), is_output)) return false;
  if (model.is_topic || service_of(model) != nullptr) return true;
  return context().stage != Context::Stage::values ||
         std::ranges::any_of(automaton.inputs().names(), is_sending);
}

bool EventResolver::names_reader(const syntax::Term& term) const {
  const auto binding = names_.find(term.name.text);
  return binding && binding->kind == Binding::Kind::model && binding->model->is_topic &&
         binding->model->dimensions.empty() && term.operands.size() == 1 &&
         term.operands.front().is_name();
}

ModelReference EventResolver::sent_to(const syntax::Term& term) const {
  if (!names_reader(term)) return model(term);
  const syntax::Term& reader = term.operands.front();
  syntax::Term topic = term;
  topic.has_indices = false;
  topic.operands.clear();
  ModelReference made = model(topic);
  made.reader = reader.name.text;
  if (reader.has_indices) {
    std::string indices;
    for (const syntax::Term& index : reader.operands) {
      indices += (indices.empty() ? "" : ",") + std::to_string(names_.constant(index, "an index"));
    }
    made.reader += "[" + indices + "]";
  }
  check_reader(made, reader);
  return made;
}

void EventResolver::check_reader(const ModelReference& model, const syntax::Term& reader) const {
  const Topic& topic = context().names.topics[model.leaf.index];
  const std::string name = topic.name + "[" + model.reader + "]";
  std::string known;
  for (const Topic::Reader& other : topic.readers) {
    const std::string& its = context().models[other.model].name;
    if (its == name || is_reader_of(its, name)) return;
    known += (known.empty() ? "" : ", ") +
             its.substr(topic.name.size() + 1, its.size() - topic.name.size() - 2);
  }
  names_.fail("'" + model.reader + "' is no reader of " + topic.name + "; there is: " + known,
              reader.place);
}

Event EventResolver::arrival(const ModelReference& model, const syntax::Event& output) const {
  if (service_of(model) != nullptr) {
    names_.fail("what was sent to a service has no 'arrived': its answer says that it has",
                output.name.place);
  }
  check_role(model, true, output.name);
  if (output.has_arguments) names_.fail("'arrived' carries no values", output.name.place);
  Event made;
  made.name = output.name.text;
  made.node = node();
  made.line = output.name.place.line;
  made.column = output.name.place.column;
  return made;
}

// ---- Inputs and outputs with their values -------------------------------------------------------

Event EventResolver::input(const ModelReference& model, const syntax::Event& event) const {
  Event made = event_named(model, event, Direction::input);
  const Service* const service = service_of(model);
  if (service != nullptr && event.name.is("send")) {
    // What is sent is lost where the server is not there, which a variable says.
    names_.find(presence_of(array_of(service->name)));
    if (context().callback != nullptr) {
      for_each_member(model, [&](std::uint32_t member) { work_.asked.insert(member); });
    }
  }
  for (const syntax::Argument& value : event.arguments) {
    Event::Argument argument;
    argument.expression =
        names_.without_shared(this->argument(model, value.term), value.term.begin, "an argument");
    if (context().on_value) note_value(model, made, names_.type_of(argument.expression));
    made.arguments.push_back(std::move(argument));
  }
  if (made.has_arguments && context().stage == Context::Stage::values) {
    check_constant_input(model, made, event.name);
  }
  return made;
}

void EventResolver::note_value(const ModelReference& model, const Event& event,
                               const ValueType& type) const {
  const std::size_t place = event.arguments.size();
  const auto count = static_cast<std::uint32_t>(member_count(model.leaf.dimensions));
  for (std::uint32_t member = model.leaf.index; member < model.leaf.index + count; ++member) {
    if (!model.is_topic) {
      context().on_value(member, event, place, type);
      continue;
    }
    for (const Topic::Reader& reader : context().names.topics[member].readers) {
      context().on_value(reader.model, event, place, type);
    }
  }
}

void EventResolver::check_constant_input(const ModelReference& model, const Event& event,
                                         const syntax::Name& name) const {
  std::string values;
  for (const auto& [expression, binds, type] : event.arguments) {
    if (!expression.is_constant()) return;
    values +=
        (values.empty() ? "" : ",") + to_string(expression.value, expression.kind, context().words);
  }
  const std::string symbol = event.name + "(" + values + ")";
  if (instance(model).automaton.inputs().find(symbol) || carried(model) != nullptr) return;
  names_.fail("model " + model.name() + " has no input '" + symbol + "'", name.place);
}

Expression EventResolver::argument(const ModelReference& model, const syntax::Term& term) const {
  if (term.is_name() && !term.has_indices && !names_.find_value(term.name)) {
    const ModelInstance& its = instance(model);
    if (is_made_by_us(its) || its.is_learned || context().stage == Context::Stage::names) {
      return make_constant(context().words.intern(term.name.text), ValueKind::word);
    }
  }
  return names_.expression(term);
}

Event EventResolver::output(const ModelReference& model, const syntax::Event& event) const {
  Event made = event_named(model, event, Direction::output);
  for (const syntax::Argument& argument : event.arguments) {
    made.arguments.push_back(pattern(model, made, argument));
  }
  return made;
}

Event::Argument EventResolver::pattern(const ModelReference& model, const Event& event,
                                       const syntax::Argument& argument) const {
  Event::Argument made;
  const syntax::Term& term = argument.term;
  if (argument.is_declared) {
    names_.check_new(term.name);
    const auto type = type_of(model, event);
    if (!type && context().stage == Context::Stage::values) {
      names_.fail("'" + event.name + "' of " + model.name() + " never has a value here",
                  term.place);
    }
    made.type = type.value_or(ValueType{});
    made.expression = names_.declare(term.name, made.type, {});
    made.binds = true;
    return made;
  }
  const auto binding = term.is_name() ? names_.find(term.name.text) : std::nullopt;
  if (binding && binding->kind == Binding::Kind::variable && !binding->is_counted) {
    auto [target, type] = names_.target(term);
    made.expression = names_.without_shared(std::move(target), term.begin, "an output");
    made.type = std::move(type);
    made.binds = true;
    return made;
  }
  made.expression = this->argument(model, term);
  return made;
}

// ---- Symbols with values ------------------------------------------------------------------------

NameParts split_name(const std::string& symbol) {
  NameParts parts;
  const std::size_t open = symbol.find('(');
  if (open == std::string::npos || open == 0 || symbol.back() != ')') {
    parts.name = symbol;
    return parts;
  }
  parts.name = symbol.substr(0, open);
  const std::string_view inside =
      std::string_view(symbol).substr(open + 1, symbol.size() - open - 2);
  for (const std::string_view part : split(inside, ',')) parts.arguments.emplace_back(trim(part));
  return parts;
}

std::optional<ValueType> argument_type(const Alphabet& alphabet, const std::string& name,
                                       std::size_t place, WordTable& words) {
  std::vector<Value> values;
  std::optional<ValueType> type;
  for (const std::string& symbol : alphabet.names()) {
    const NameParts parts = split_name(symbol);
    if (parts.name != name || parts.arguments.size() <= place) continue;
    const auto [kind, value] = read_value(parts.arguments[place], words);
    if (!type) type = ValueType{kind, value, value, {}};
    if (type->kind != kind) type->kind = ValueKind::word;
    type->low = std::min(type->low, value);
    type->high = std::max(type->high, value);
    const Value word = words.intern(parts.arguments[place]);
    if (std::find(values.begin(), values.end(), word) == values.end()) values.push_back(word);
  }
  if (!type) return type;
  if (type->kind == ValueKind::word) type->words = values;
  if (type->kind == ValueKind::boolean) {
    type->low = 0;
    type->high = 1;
  }
  return type;
}

std::pair<ValueKind, Value> read_value(const std::string& text, WordTable& words) {
  if (text == "true" || text == "false") return {ValueKind::boolean, text == "true" ? 1 : 0};
  const std::size_t first = text.starts_with('-') ? 1 : 0;
  const bool is_number = text.size() > first && text.size() < 19 &&
                         std::all_of(text.begin() + static_cast<std::ptrdiff_t>(first), text.end(),
                                     [](char c) { return is_digit(c); });
  if (is_number) return {ValueKind::integer, std::stoll(text)};
  return {ValueKind::word, words.intern(text)};
}

}  // namespace maide::program_syntax
