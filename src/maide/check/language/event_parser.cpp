// Models, topics and their inputs and outputs in a program's text: `M.write(e)`, `message(var x)`.
#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/base/text_cursor.hpp"
#include "maide/check/language/program_parser.hpp"
#include "maide/check/system/system.hpp"
#include "maide/formats/names.hpp"

namespace maide::program_syntax {

// ---- models and their inputs and outputs --------------------------------------------------------

ModelReference EventParser::parse_model() {
  const Token name = tokens_.next();
  if (!name.is_name()) {
    tokens_.fail("expected a model instance, not " + to_string(name), name);
  }
  const auto binding = find(name.text);
  if (!binding || binding->kind != Binding::Kind::model) fail_unknown_model(name, !binding);
  ModelReference model{binding->expression, binding->model->is_topic, binding->model};
  const SourcePosition place = tokens_.position(name);
  model.leaf.line = place.line;
  model.leaf.column = place.column;
  if (model.leaf.operands.empty()) {
    model.leaf.operands = expressions_.parse_indices(model.leaf.dimensions, name);
    for (const Expression& index : model.leaf.operands) without_shared(index, name, "an index");
  }
  for_each_member(model, [&](std::uint32_t member) {
    if (!model.is_topic) {
      work_.names.insert(member);
      return;
    }
    for (const Topic::Reader& reader : context_.names.topics[member].readers) {
      work_.names.insert(reader.model);
    }
  });
  return model;
}

void EventParser::fail_unknown_model(const Token& name, bool is_unknown) {
  if (!is_unknown) tokens_.fail("'" + name.text + "' is no model", name);
  if (is_reserved(name)) tokens_.fail("'" + name.text + "' is a keyword here", name);
  std::map<std::pair<bool, std::uint32_t>, std::string> in_order;
  for (const auto& [other, model] : context_.names.models) {
    in_order.emplace(std::pair(model.is_topic, model.first), other);
  }
  std::vector<std::string> known;
  for (const auto& [first, other] : in_order) known.push_back(other);
  tokens_.fail("unknown model '" + name.text + "'; there is: " + known_instead(name.text, known),
               name);
}

const ModelInstance& EventParser::instance(const ModelReference& model) const {
  if (!model.is_topic) return context_.models[model.leaf.index];
  return context_.models[context_.names.topics[model.leaf.index].readers.front().model];
}

std::string EventParser::name_at_end(const ModelReference& model, const std::string& name) const {
  for (const auto& [role, ends] : model.known->ends) {
    const auto place = std::find_if(ends.begin(), ends.end(), [&](const End& end) {
      return end.is_of(node(), context_.program);
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

const Service* EventParser::service_of(const ModelReference& model) const {
  if (model.is_topic) return nullptr;
  const auto place = context_.names.services.find(model.leaf.index);
  return place == context_.names.services.end() ? nullptr : &place->second;
}

std::string EventParser::name_at_service(const ModelReference& model, const std::string& name,
                                         bool is_input, const Token& token) {
  const bool is_servers = name == "serve" || name == "request" || (name == "answer" && is_input);
  const bool is_clients = name == "send" || name == "receive" || (name == "answer" && !is_input);
  if (!is_servers && !is_clients) return name;  // unknown, as check_event() says
  std::optional<std::string> at_end;
  std::string services;
  for_each_member(model, [&](std::uint32_t member) {
    const Service& service = context_.names.services.at(member);
    services += (services.empty() ? "" : ", ") + service.name;
    if (is_servers) {
      if (service.is_server(node(), context_.program)) at_end = name;
      const bool serves =
          context_.callback == nullptr || context_.callback->kind == Callback::Kind::service;
      if (name == "answer" && service.server_runs > 1 && !serves) {
        tokens_.fail("which request of " + service.name +
                         " this answers is not known: its callback may run several times at once",
                     token);
      }
      return;
    }
    const auto client = service.client_of(node(), context_.program);
    if (!client) return;
    if (name == "answer" && service.own_code.contains(node())) {
      tokens_.fail("answers of " + service.name + " go to the code of its client in " + node(),
                   token);
    }
    const std::string numbered = name_at_client(name, *client);
    if (at_end && at_end != numbered) {
      tokens_.fail("at which client of " + services + " this is depends on the index", token);
    }
    at_end = numbered;
  });
  if (!at_end && !services.empty()) {
    tokens_.fail("this " + std::string(node().empty() ? "program" : "node") + " is no " +
                     (is_servers ? "server" : "client") + " of " + services,
                 token);
  }
  return at_end.value_or(name);
}

void EventParser::check_received(const ModelReference& model, const Event& event, bool is_input,
                                 const Token& name) {
  if (context_.callback == nullptr) return;
  const std::string& word = name.text;
  const bool of_reader = model.is_topic && !is_of_writer(instance(model).automaton, event.name);
  if (!of_reader && !(is_input && (word == "read" || word == "receive" || word == "serve"))) return;
  std::string instead = "say `takes: " + model.name() + "." + word + "`";
  if (word == "receive") instead = "say `wait " + model.name() + " -> answer`";
  if (word == "serve") instead = "say `serves: " + model.name() + "`";
  tokens_.fail("in a callback nothing is received but through its executor: " + instead, name);
}

void EventParser::check_role(const ModelReference& model, const Event& event, const Token& name) {
  bool may = !model.is_topic || context_.starts != nullptr;
  std::string topics;
  const bool is_write = model.is_topic && is_of_writer(instance(model).automaton, event.name);
  for_each_topic(model, [&](const Topic& topic) {
    may = may || topic.has_end(context_.program, is_write, node());
    topics += (topics.empty() ? "" : ", ") + topic.name;
  });
  if (may || topics.empty()) return;
  tokens_.fail("this " + std::string(node().empty() ? "program" : "node") + " is no " +
                   (is_write ? "writer" : "reader") + " of " + topics,
               name);
}

Event EventParser::parse_event_name(const ModelReference& model, std::string_view what) {
  const Token name = tokens_.next();
  if (!name.is_name()) {
    tokens_.fail(
        "expected an " + std::string(what) + " of " + model.name() + ", not " + to_string(name),
        name);
  }
  const SourcePosition place = tokens_.position(name);
  Event event;
  const bool is_input = what == "input";
  event.name = service_of(model) != nullptr ? name_at_service(model, name.text, is_input, name)
                                            : name_at_end(model, name.text);
  event.node = node();
  event.line = place.line;
  event.column = place.column;
  event.has_arguments = tokens_.peek().is("(");
  check_event(model, event, name, what);
  check_received(model, event, is_input, name);
  check_role(model, event, name);
  return event;
}

void EventParser::check_event(const ModelReference& model, const Event& event, const Token& name,
                              std::string_view what) {
  const ModelInstance& instance = this->instance(model);
  const bool is_built_in = instance.source == ModelInstance::Source::built_in;
  if (context_.on_value && (is_built_in || instance.is_learned)) return;
  const Alphabet& alphabet =
      what == "input" ? instance.automaton.inputs() : instance.automaton.outputs();
  if (!event.has_arguments && alphabet.find(event.name)) return;
  if (!event.has_arguments && is_built_in && what == "input") {
    const bool has_values =
        std::any_of(alphabet.names().begin(), alphabet.names().end(),
                    [&](const std::string& other) { return split_name(other).name == event.name; });
    if (has_values) {
      tokens_.fail("model " + model.name() + " is given '" + event.name +
                       "' with values elsewhere, so it takes it with values alone",
                   name);
    }
  }
  const bool may_have_arguments = event.has_arguments || what == "output";
  for (const std::string& other : alphabet.names()) {
    const NameParts parts = split_name(other);
    if (may_have_arguments && !parts.arguments.empty() && parts.name == event.name) return;
  }
  tokens_.fail("model " + model.name() + " has no " + std::string(what) + " '" + event.name + "'" +
                   (event.has_arguments ? " with values" : "") +
                   "; it has: " + known_instead(event.name, alphabet.names()),
               name);
}

Event EventParser::parse_input(const ModelReference& model) {
  const Token name = tokens_.peek();
  Event event = parse_event_name(model, "input");
  if (context_.callback != nullptr && service_of(model) != nullptr && name.is("send")) {
    for_each_member(model, [&](std::uint32_t member) { work_.asked.insert(member); });
  }
  if (!tokens_.accept("(")) return event;
  do {
    const Token first = tokens_.peek();
    Event::Argument argument;
    argument.expression = without_shared(parse_argument(model), first, "an argument");
    if (context_.on_value) {
      note_value(model, event, type_of(argument.expression));
    }
    event.arguments.push_back(std::move(argument));
  } while (tokens_.accept(","));
  tokens_.expect(")", "behind the values");
  if (!context_.on_value) check_constant_input(model, event, name);
  return event;
}

void EventParser::note_value(const ModelReference& model, const Event& event,
                             const ValueType& type) {
  const std::size_t place = event.arguments.size();
  const auto count = static_cast<std::uint32_t>(member_count(model.leaf.dimensions));
  for (std::uint32_t member = model.leaf.index; member < model.leaf.index + count; ++member) {
    if (!model.is_topic) {
      context_.on_value(member, event, place, type);
      continue;
    }
    for (const Topic::Reader& reader : context_.names.topics[member].readers) {
      context_.on_value(reader.model, event, place, type);
    }
  }
}

void EventParser::check_constant_input(const ModelReference& model, const Event& event,
                                       const Token& name) {
  std::string values;
  for (const auto& [expression, binds, type] : event.arguments) {
    if (!expression.is_constant()) return;
    values +=
        (values.empty() ? "" : ",") + to_string(expression.value, expression.kind, context_.words);
  }
  const std::string symbol = event.name + "(" + values + ")";
  if (!instance(model).automaton.inputs().find(symbol)) {
    tokens_.fail("model " + model.name() + " has no input '" + symbol + "'", name);
  }
}

Expression EventParser::parse_argument(const ModelReference& model) {
  const Token& first = tokens_.peek();
  const bool is_alone = tokens_.peek(1).is(",") || tokens_.peek(1).is(")");
  if (first.is_name() && is_alone && !first.is("true") && !first.is("false") && !find(first.text)) {
    const ModelInstance& its = instance(model);
    if (its.source == ModelInstance::Source::built_in || its.is_learned) {
      return make_constant(context_.words.intern(tokens_.next().text), ValueKind::word);
    }
  }
  return expressions_.parse();
}

Event EventParser::parse_output(const ModelReference& model) {
  Event event = parse_event_name(model, "output");
  if (!tokens_.accept("(")) return event;
  do {
    event.arguments.push_back(parse_pattern(model, event));
  } while (tokens_.accept(","));
  tokens_.expect(")", "behind the values");
  return event;
}

Event::Argument EventParser::parse_pattern(const ModelReference& model, const Event& event) {
  Event::Argument argument;
  const Token first = tokens_.peek();
  if (tokens_.accept("var")) {
    const Token name = parse_new_name("a variable");
    const auto type = argument_type(instance(model).automaton.outputs(), event.name,
                                    event.arguments.size(), context_.words);
    if (!type && !context_.on_value) {
      tokens_.fail("'" + event.name + "' of " + model.name() + " never has a value here", name);
    }
    argument.type = type.value_or(ValueType{});
    argument.expression = declare(name, argument.type, {});
    argument.binds = true;
    return argument;
  }
  const auto binding = first.is_name() ? find(first.text) : std::nullopt;
  if (binding && binding->kind == Binding::Kind::variable && !binding->is_counted) {
    auto [target, type] = parse_target();
    argument.expression = without_shared(std::move(target), first, "an output");
    argument.type = std::move(type);
    argument.binds = true;
    return argument;
  }
  argument.expression = parse_argument(model);
  return argument;
}

// ---- symbols with values ------------------------------------------------------------------------

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
