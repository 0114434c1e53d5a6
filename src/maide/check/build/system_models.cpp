// Models of a system file, and what is written into queues.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/build/system_reader.hpp"
#include "maide/check/language/expression_parser.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {

void SystemReader::read_models(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'models'", {})) {
    const program_syntax::Declared array = declared(key);
    const std::uint64_t count = member_count(array.dimensions);
    if (system_.models.size() + count > max_components) fail("too many models", key);
    const auto first = static_cast<std::uint32_t>(system_.models.size());
    names_.models.emplace(array.name, ModelName{first, array.dimensions, false, {}});
    ModelInstance model = read_model(array.name, key, value);
    auto& ends = names_.models.at(array.name).ends;
    if (value["ends"]) ends = read_ends(value["ends"]);
    for (std::uint64_t member = 0; member < count; ++member) {
      model.name = array.name + member_suffix(array.dimensions, member);
      if (value["use"]) {
        make_built_in(model, first + static_cast<std::uint32_t>(member), indices_of(array, member),
                      value);
      }
      if (member == 0) check_ends(model, value["ends"]);
      system_.models.push_back(model);
      if (!ends.empty()) {
        const auto number = static_cast<std::uint32_t>(system_.models.size() - 1);
        ends_of_.emplace(number, &ends);
        add_ends(number);
      }
      if (ends.empty()) note_learned(first + static_cast<std::uint32_t>(member));
    }
  }
}

SystemReader::Ends SystemReader::read_ends(const YAML::Node& node) {
  Ends ends;
  for (const auto& [role, names] : entries(node, "'ends'", {})) {
    ends.emplace(role.Scalar(), ends_named(names, {}));
  }
  return ends;
}

void SystemReader::check_ends(const ModelInstance& model, const YAML::Node& ends) const {
  std::vector<std::string> actors;
  for (const Actor& actor : model.automaton.actors) actors.push_back(actor.name);
  if (!ends || actors.empty()) return;
  for (const auto& entry : ends) {
    const std::string& role = entry.first.Scalar();
    if (std::find(actors.begin(), actors.end(), role) != actors.end()) continue;
    fail(fmt::format("model {} has no end '{}'; it has: {}", model.name, role,
                     known_instead(role, actors)),
         entry.first);
  }
}

ModelInstance SystemReader::read_model(const std::string& instance, const YAML::Node& key,
                                       const YAML::Node& value) {
  ModelInstance model;
  model.name = instance;
  model.position = at(key);
  ModelRequest request;
  request.instance = model.name;
  std::string from;
  for (const auto& [name, node] : entries(
           value, "model '" + model.name + "'",
           {"file", "learn", "use", "with", "learning", "when_unexplored", "when_weak", "ends"})) {
    const std::string& word = name.Scalar();
    if (word == "ends") continue;  // read_ends()
    if (word == "when_unexplored") {
      model.when_unexplored = one_of<WhenUnexplored>(node, "'when_unexplored'",
                                                     {{"stop", WhenUnexplored::stop},
                                                      {"wait", WhenUnexplored::wait},
                                                      {"drop", WhenUnexplored::drop}});
    } else if (word == "when_weak") {
      model.when_weak = one_of<WhenWeak>(
          node, "'when_weak'",
          {{"inconclusive", WhenWeak::inconclusive}, {"accept", WhenWeak::accept}});
    } else if (word == "with" || word == "learning") {
      auto& options = word == "with" ? request.with : request.learning;
      for (const auto& [option, setting] : entries(node, "'" + word + "'", {})) {
        options.emplace_back(option.Scalar(), option_value(setting));
      }
    } else {
      if (!from.empty()) fail("a model has one of 'file', 'learn' and 'use'", name);
      from = word;
      request.position = at(node);
      (word == "learn" ? request.learn : model.origin) = scalar(node, "'" + word + "'");
      if (node.Scalar().empty()) fail("'" + word + "' is empty", node);
    }
  }
  if (from.empty()) fail("model '" + model.name + "' needs 'file:', 'learn:' or 'use:'", key);
  if (from == "use") {
    if (!request.learning.empty()) fail("'learning' goes with 'learn'", key);
    model.source = ModelInstance::Source::built_in;
    return model;
  }
  if (from == "file" && !(request.with.empty() && request.learning.empty())) {
    fail("'with' and 'learning' go with 'learn'; a model from a file has its options behind it",
         key);
  }
  if (from == "file") {
    request.file = std::filesystem::path(system_.file).parent_path() / model.origin;
  } else {
    model.origin = request.learn;
    model.is_learned = true;
  }
  model.automaton = ask_source(request, value);
  if (has_unknown_depth(model.automaton)) model.source = ModelInstance::Source::built_in;
  last_request_ = request;
  if (model.automaton.size() == 0) fail("model '" + model.name + "' has no state", key);
  for (const Alphabet* alphabet : {&model.automaton.inputs(), &model.automaton.outputs()}) {
    for (const std::string& name : alphabet->names()) {
      for (const std::string& argument : program_syntax::split_name(name).arguments) {
        program_syntax::read_value(argument, system_.words);  // a word is known from here on
      }
    }
  }
  return model;
}

InterfaceAutomaton SystemReader::ask_source(const ModelRequest& request,
                                            const YAML::Node& model) const {
  try {
    return source_(request);
  } catch (const UsageError& error) {
    const std::string message = error.what();
    SourcePosition place = request.position;
    for (const char* word : {"with", "learning"}) {
      if (!model.IsMap() || !model[word]) continue;
      for (const auto& [key, value] : entries(model[word], "", {})) {
        for (const std::string& named : {"'" + key.Scalar() + "'", key.Scalar() + "=",
                                         key.Scalar() + ": ", "'" + value.Scalar() + "'"}) {
          if (message.find(named) != std::string::npos) place = at(key);
        }
      }
    }
    throw ParseError(message, place);
  }
}

std::string SystemReader::option_value(const YAML::Node& setting) const {
  std::string value = scalar(setting, "an option's value");
  const auto constant = names_.constants.find(value);
  if (constant == names_.constants.end() || setting.Tag() == "!") return value;  // in quotes
  return to_string(constant->second.value, constant->second.kind, system_.words);
}

void SystemReader::make_built_in(ModelInstance& model, std::uint32_t number, const Indices& indices,
                                 const YAML::Node& value) {
  const YAML::Node use = value["use"];
  const std::string kind = one_of<std::string>(
      use, "'use'", {{"mutex", "mutex"}, {"semaphore", "semaphore"}, {"queue", "queue"}});
  const YAML::Node with = value["with"];
  std::vector<std::string> known;
  if (kind == "semaphore") known = {"count"};
  if (kind == "queue") known = {"size", "depth"};
  Entries options;
  if (with) {
    if (known.empty()) fail("a mutex has no options", with);
    options = entries(with, "'with' of a " + kind, known);
  }
  if (kind == "mutex") {
    model.automaton = make_mutex();
    return;
  }
  if (options.size() != 1) {
    fail("a " + kind + " needs " +
             (kind == "queue" ? "'with: {size: N}' or 'with: {depth: N}'" : "'with: {count: N}'"),
         use);
  }
  const auto& [name, node] = options.front();
  scalar(node, "'" + name.Scalar() + "'");
  if (name.Scalar() == "depth" && node.Scalar() == unknown_depth) {
    Queue queue;
    queue.size = {1, true, {}, true};
    make_queue_of(model, number, queue.size);
    queues_.emplace(number, std::move(queue));
    return;
  }
  const ScalarText text = text_of(node);
  const Expression size = program_syntax::parse_constant(text, context(indices));
  constexpr Value most = 1'000'000;
  if (size.kind != ValueKind::integer || size.value < 1 || size.value > most) {
    fail("'" + name.Scalar() + "' goes from 1 to " + std::to_string(most), node);
  }
  if (kind == "semaphore") {
    model.automaton = make_semaphore(static_cast<std::uint32_t>(size.value));
    return;
  }
  Queue queue;
  queue.size.size = static_cast<std::uint32_t>(size.value);
  queue.size.drops_oldest = name.Scalar() == "depth";
  make_queue_of(model, number, queue.size);
  queues_.emplace(number, std::move(queue));
}

void SystemReader::make_queue_of(ModelInstance& model, std::uint32_t number,
                                 const QueueSize& size) {
  model.is_grown = queue_states(size) > static_cast<double>(limits_.states);
  if (model.is_grown && size.is_unknown) fail_large_queue(number);
  growing_.erase(number);
  if (model.is_grown) {
    // What is behind its bound was left out by us, and is no place where nothing can happen.
    model.when_unexplored = WhenUnexplored::stop;
    model.automaton =
        growing_.emplace(number, std::make_unique<GrowingQueue>(size)).first->second->start();
  } else {
    model.automaton = make_queue(size);
  }
}

void SystemReader::note_learned(std::uint32_t model) {
  const ModelInstance& instance = system_.models[model];
  const InterfaceAutomaton& automaton = instance.automaton;
  if (!instance.is_learned || !automaton.inputs().find("write")) return;
  if (!automaton.outputs().find("message")) return;
  Queue queue;
  queue.learned = last_request_;
  queue.learned->instance = instance.name;
  queues_.emplace(model, std::move(queue));
}

void SystemReader::note_value(std::uint32_t model, const program_syntax::Event& input,
                              std::size_t place, const ValueType& type) {
  const auto queue = queues_.find(model);
  if (queue == queues_.end() || input.name != "write") return;
  auto& types = queue->second.types;
  if (types.size() <= place) {
    types.resize(place + 1, type);
    has_new_values_ = true;
  }
  ValueType& known = types[place];
  const ValueType before = known;
  if (known.kind != type.kind) return;  // found again: the queue has no such input
  known.low = std::min(known.low, type.low);
  known.high = std::max(known.high, type.high);
  for (const Value word : type.words) {
    if (!known.contains(word)) known.words.push_back(word);
  }
  has_new_values_ = has_new_values_ || known != before;
}

void SystemReader::make_valued(std::uint32_t model) {
  Queue& queue = queues_.at(model);
  std::vector<std::string> values = {""};
  for (const ValueType& type : queue.types) {
    std::vector<std::string> longer;
    if (type.count() > max_queue_states) fail_large_queue(model);
    for (const std::string& value : values) {
      for (std::uint64_t place = 0; place < type.count(); ++place) {
        longer.push_back((value.empty() ? "(" : value + ",") +
                         to_string(type.at(place), type.kind, system_.words));
        if (longer.size() > max_queue_states) fail_large_queue(model);
      }
    }
    values = std::move(longer);
  }
  for (std::string& value : values) value += ")";
  queue.size.values = values;
  if (queue.learned) {
    const InterfaceAutomaton& known = system_.models[model].automaton;
    const InterfaceAutomaton valued = make_queue({1, false, values});
    std::vector<std::string> inputs = valued.inputs().names(), outputs = valued.outputs().names();
    const auto add = [](std::vector<std::string>& names, const Alphabet& more) {
      for (const std::string& name : more.names()) {
        const std::string base = name.substr(0, name.find('('));
        if (base == "write" || base == "message") continue;
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      }
    };
    add(inputs, known.inputs());
    add(outputs, known.outputs());
    InterfaceAutomaton names_alone(Alphabet(std::span<const std::string>(inputs)),
                                   Alphabet(std::span<const std::string>(outputs)), 1);
    names_alone.actors = known.actors;
    queue.learned->values.clear();
    for (const std::string& value : values) {
      queue.learned->values.push_back(value.substr(1, value.size() - 2));
    }
    system_.models[model].read(std::move(names_alone));
    return;
  }
  system_.models[model].as_read.reset();
  make_queue_of(system_.models[model], model, queue.size);
  add_ends(model);
}

void SystemReader::learn_values() {
  for (const auto& [model, queue] : queues_) {
    if (!queue.learned || queue.types.empty()) continue;
    system_.models[model].read(ask_source(*queue.learned, YAML::Node()));
    add_ends(model);
  }
}

void SystemReader::fail_large_queue(std::uint32_t model) const {
  const ModelInstance& instance = system_.models[model];
  std::string types;
  for (const ValueType& type : queues_.at(model).types) {
    types += (types.empty() ? " with the values " : ", ") + to_string(type, system_.words);
  }
  throw ParseError(
      "queue '" + instance.name + "'" + types + " has more than " + std::to_string(limits_.states) +
          " states: give it fewer values, or a smaller size" +
          (instance.is_grown ? " (only a queue that is no topic's, and whose ends cannot die, may "
                               "have more)"
                             : ""),
      instance.position);
}

}  // namespace maide
