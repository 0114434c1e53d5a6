// Topics of a system file, and what becomes of models because programs stand at their ends.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/check/build/system_reader.hpp"
#include "maide/check/language/expression_parser.hpp"
#include "maide/check/rules/model_ends.hpp"
#include "maide/check/text/tokens.hpp"

namespace maide {

void SystemReader::read_topics(const YAML::Node& section) {
  for (const auto& [key, value] : entries(section, "'topics'", {})) {
    const program_syntax::Declared array = declared(key);
    const auto first = static_cast<std::uint32_t>(names_.topics.size());
    names_.models.emplace(array.name, ModelName{first, array.dimensions, true, {}});
    const std::uint64_t count = member_count(array.dimensions);
    for (std::uint64_t member = 0; member < count; ++member) {
      const std::string name = array.name + member_suffix(array.dimensions, member);
      read_topic(name, indices_of(array, member), key, value);
    }
  }
}

std::vector<std::uint32_t> SystemReader::programs_named(const YAML::Node& node,
                                                        const Indices& indices) {
  if (node.IsSequence()) {
    std::vector<std::uint32_t> all;
    for (const YAML::Node& one : node) {
      for (const std::uint32_t program : programs_named(one, indices)) {
        if (std::find(all.begin(), all.end(), program) != all.end()) {
          fail("program " + texts_[program].name + " is there twice", one);
        }
        all.push_back(program);
      }
    }
    return all;
  }
  const std::string text = scalar(node, "a program's name");
  const std::string name = text.substr(0, text.find('['));
  if (const auto array = node_arrays_.find(name); array != node_arrays_.end()) {
    std::vector<std::uint32_t> programs;
    for (const std::uint32_t member : members_named(node, array->second, indices)) {
      for (const std::uint32_t program : nodes_[member].programs) programs.push_back(program);
    }
    return programs;
  }
  const auto array = program_arrays_.find(name);
  if (array == program_arrays_.end()) {
    std::vector<std::string> known;
    for (const auto& [other, programs] : program_arrays_) known.push_back(other);
    for (const auto& [other, nodes] : node_arrays_) known.push_back(other);
    fail("unknown program '" + name + "'; there is: " + known_instead(name, known), node);
  }
  return members_named(node, array->second, indices);
}

std::vector<std::uint32_t> SystemReader::members_named(const YAML::Node& node,
                                                       const ModelName& array,
                                                       const Indices& indices) {
  const ScalarText text = text_of(node);
  if (text.value().find('[') == std::string::npos) {
    std::vector<std::uint32_t> members;
    const auto count = static_cast<std::uint32_t>(member_count(array.dimensions));
    for (std::uint32_t i = 0; i < count; ++i) members.push_back(array.first + i);
    return members;
  }
  const std::vector<Value> place =
      program_syntax::parse_member(text, context(indices), array.dimensions);
  Expression leaf;
  leaf.name = text.value().substr(0, text.value().find('['));
  leaf.dimensions = array.dimensions;
  try {
    return {array.first + element_of(leaf, place)};
  } catch (const EvaluationError& error) {
    fail(error.text, node);
  }
}

std::vector<std::uint32_t> SystemReader::writers_named(const YAML::Node& node,
                                                       const Indices& indices) {
  if (!node.IsSequence()) return programs_named(node, indices);
  std::set<std::uint32_t> programs;
  std::set<std::string> names;
  for (const YAML::Node& one : node) {
    if (!names.insert(scalar(one, "a writer")).second) {
      fail("program " + one.Scalar() + " is there twice", one);
    }
    for (const std::uint32_t program : programs_named(one, indices)) programs.insert(program);
  }
  return {programs.begin(), programs.end()};
}

std::vector<SystemReader::ReaderEnd> SystemReader::readers_named(const YAML::Node& node,
                                                                 const Indices& indices,
                                                                 const std::string& topic) {
  std::vector<ReaderEnd> ends;
  if (node.IsSequence()) {
    for (const YAML::Node& one : node) {
      for (ReaderEnd& end : readers_named(one, indices, topic)) {
        for (const ReaderEnd& other : ends) {
          if (other.program != end.program || other.callback != end.callback) continue;
          fail("program " + end.name + " is there twice", one);
        }
        ends.push_back(std::move(end));
      }
    }
    return ends;
  }
  const std::string text = scalar(node, "a reader");
  const std::size_t dot = text.find('.');
  const std::string name = text.substr(0, std::min(text.find('['), dot));
  const auto array = node_arrays_.find(name);
  if (array == node_arrays_.end()) {
    for (const std::uint32_t program : programs_named(node, indices)) {
      ends.push_back({program, "", texts_[program].name});
    }
    return ends;
  }
  std::vector<std::uint32_t> members;
  if (dot == std::string::npos) {
    members = members_named(node, array->second, indices);
  } else {
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].name == text.substr(0, dot)) members.push_back(i);
    }
  }
  for (const std::uint32_t member : members) {
    const NodeOf& of = nodes_[member];
    const std::string only = dot == std::string::npos ? "" : text.substr(dot + 1);
    const std::vector<std::string> callbacks = takers_of(of, only, topic);
    if (callbacks.empty()) fail("no callback of " + of.name + " takes from '" + topic + "'", node);
    for (const std::string& callback : callbacks) {
      const std::string whole = of.name + "." + callback;
      for (const std::uint32_t program : of.programs) {
        const auto& run = texts_[program].thread->callbacks;
        const bool has = std::any_of(
            run.begin(), run.end(), [&](const auto& other) { return other.whole_name() == whole; });
        if (!has) continue;
        ends.push_back({program, whole, callbacks.size() == 1 && only.empty() ? of.name : whole});
        break;  // the runs of a callback are one reader
      }
    }
  }
  if (members.empty()) fail("unknown node '" + text + "'", node);
  return ends;
}

void SystemReader::read_topic(const std::string& name, const Indices& indices,
                              const YAML::Node& key, const YAML::Node& value) {
  const Entries parts =
      entries(value, "topic '" + name + "'",
              {"writers", "readers", "file", "learn", "use", "with", "readers_with", "learning",
               "when_unexplored", "when_weak", "deliver"});
  const auto part = [&](std::string_view word) {
    for (const auto& [other, node] : parts) {
      if (other.Scalar() == word) return node;
    }
    return YAML::Node(YAML::NodeType::Undefined);
  };
  Topic topic;
  topic.name = name;
  for (const std::string_view word : {"writers", "readers"}) {
    if (!part(word)) fail("topic '" + name + "' needs '" + std::string(word) + ":'", key);
  }
  for (const std::uint32_t writer : writers_named(part("writers"), indices)) {
    topic.writers.insert(writer);
  }
  const auto add_writer = [&](const YAML::Node& one) {
    topic.writer_names.push_back(one.Scalar());
    for (const End& end : ends_named(one, indices)) {
      if (!end.node.empty()) topic.writer_nodes.insert(end.node);
    }
  };
  if (part("writers").IsSequence()) {
    for (const YAML::Node& one : part("writers")) add_writer(one);
  } else {
    add_writer(part("writers"));
  }
  if (const YAML::Node deliver = part("deliver")) {
    topic.delivers_one = one_of<bool>(deliver, "'deliver'", {{"one", true}, {"all", false}});
  }
  const std::vector<ReaderEnd> readers = readers_named(part("readers"), indices, name);
  if (readers.empty() || topic.writers.empty()) fail("a topic has a writer and a reader", key);
  if (const YAML::Node own = part("readers_with")) check_own_options(own, indices, name);
  for (const ReaderEnd& reader : readers) {
    topic.readers.push_back(make_reader(name, reader, indices, key, value, part("readers_with")));
  }
  const auto mortal_readers = std::count_if(
      readers.begin(), readers.end(), [&](const auto& end) { return texts_[end.program].may_die; });
  if (mortal_readers > max_mortal_readers) {
    fail("at most " + std::to_string(max_mortal_readers) + " readers of a topic may die, and of '" +
             name + "' " + std::to_string(mortal_readers) + " may",
         part("readers"));
  }
  for (std::size_t i = 0; i < topic.readers.size(); ++i) {
    topic_of_[topic.readers[i].model] = {names_.topics.size(), i};
  }
  names_.topics.push_back(std::move(topic));
  make_caller(names_.topics.back(), key);
  for (const Topic::Reader& reader : names_.topics.back().readers) add_ends(reader.model);
}

void SystemReader::check_own_options(const YAML::Node& own, const Indices& indices,
                                     const std::string& topic) {
  std::set<std::pair<std::uint32_t, std::string>> met;
  for (const auto& [who, settings] : entries(own, "'readers_with'", {})) {
    for (const ReaderEnd& end : readers_named(who, indices, topic)) {
      if (met.emplace(end.program, end.callback).second) continue;
      fail("the options of reader " + end.name + " are there twice", who);
    }
  }
}

void SystemReader::make_caller(Topic& topic, const YAML::Node& key) {
  bool has_returns = false;
  for (const Topic::Reader& reader : topic.readers) {
    const InterfaceAutomaton& automaton = system_.models[reader.model].automaton;
    for (const std::string& output : automaton.outputs().names()) {
      has_returns = has_returns || is_of_writer(automaton, output);
    }
  }
  for (const std::uint32_t writer : topic.writers) {
    if (!texts_[writer].may_die) continue;
    topic.mortal.emplace(writer, system_.words.intern(texts_[writer].name));
  }
  if (!has_returns || topic.mortal.empty() || topic.writers.size() == 1) return;
  topic.nobody = system_.words.intern("nobody");
  ModelInstance caller;
  caller.name = topic.name + ".writer";
  caller.source = ModelInstance::Source::variable;
  caller.type.kind = ValueKind::word;
  caller.type.words = {topic.nobody};
  for (const auto& [writer, word] : topic.mortal) caller.type.words.push_back(word);
  caller.automaton = InterfaceAutomaton({}, {}, caller.type.count());
  caller.position = at(key);
  topic.caller = static_cast<std::uint32_t>(system_.models.size());
  system_.models.push_back(std::move(caller));
}

Topic::Reader SystemReader::make_reader(const std::string& topic, const ReaderEnd& end,
                                        const Indices& indices, const YAML::Node& key,
                                        const YAML::Node& value, const YAML::Node& own_options) {
  if (system_.models.size() == max_components) fail("too many models", key);
  YAML::Node options(YAML::NodeType::Map);
  YAML::Node with(YAML::NodeType::Map);
  for (const auto& [word, node] : entries(value, "topic '" + topic + "'", {})) {
    const std::string name = word.Scalar();
    if (name == "with") {
      for (const auto& [option, setting] : entries(node, "'with'", {})) {
        with[option.Scalar()] = setting;
      }
    } else if (name != "writers" && name != "readers" && name != "readers_with" &&
               name != "deliver") {
      options[name] = node;
    }
  }
  if (own_options) {
    for (const auto& [who, settings] : entries(own_options, "'readers_with'", {})) {
      const std::vector<ReaderEnd> meant = readers_named(who, indices, topic);
      const bool is_meant = std::any_of(meant.begin(), meant.end(), [&](const ReaderEnd& other) {
        return other.program == end.program && other.callback == end.callback;
      });
      if (!is_meant) continue;
      for (const auto& [option, setting] : entries(settings, "a reader's options", {})) {
        with[option.Scalar()] = setting;
      }
    }
  }
  if (with.size() > 0) options["with"] = with;
  ModelInstance model = read_model(topic + "[" + end.name + "]", key, options);
  const auto number = static_cast<std::uint32_t>(system_.models.size());
  if (options["use"]) make_built_in(model, number, indices, options);
  system_.models.push_back(std::move(model));
  note_learned(number);
  return {end.program, number, end.callback, {}, {}, {}, {}};
}

namespace {

using Death = std::vector<std::vector<ModelStep>>;  // by state

// What a death does to each state, and then another one.
Death compose(const Death& one, const Death& other) {
  Death both(one.size());
  for (std::size_t state = 0; state < one.size(); ++state) {
    for (const ModelStep& first : one[state]) {
      for (const ModelStep& second : other[first.target]) {
        const ModelStep step{second.target, first.is_beyond || second.is_beyond};
        if (std::find(both[state].begin(), both[state].end(), step) == both[state].end()) {
          both[state].push_back(step);
        }
      }
    }
  }
  return both;
}

void replace_automaton(ModelInstance& instance, InterfaceAutomaton by) {
  if (!instance.as_read) {
    instance.as_read = std::make_shared<const InterfaceAutomaton>(std::move(instance.automaton));
  }
  instance.automaton = std::move(by);
}

bool changes_nothing(const Death& death) {
  for (StateId state = 0; state < death.size(); ++state) {
    if (death[state] != std::vector<ModelStep>{{state, false}}) return false;
  }
  return true;
}

}  // namespace

void SystemReader::keep_topics() {
  for (const Topic& topic : names_.topics) {
    TopicInstance& kept = system_.topics.emplace_back();
    kept.name = topic.name;
    kept.writer_names = topic.writer_names;
    kept.writers.assign(topic.writers.begin(), topic.writers.end());
    kept.delivers_one = topic.delivers_one;
    for (const Topic::Reader& reader : topic.readers) {
      std::optional<std::uint32_t> callback;
      for (std::uint32_t number = 0; number < system_.callbacks.size(); ++number) {
        if (system_.callbacks[number].name == reader.callback) callback = number;
      }
      kept.readers.push_back({reader.program, reader.model, callback, reader.collected});
    }
  }
}

void SystemReader::add_ends(std::uint32_t model) {
  ModelInstance& instance = system_.models[model];
  try {
    if (const auto place = topic_of_.find(model); place != topic_of_.end()) {
      if (instance.is_grown) fail_large_queue(model);
      Topic& topic = names_.topics[place->second.first];
      add_topic_ends(topic, topic.readers[place->second.second], instance);
    } else if (const auto ends = ends_of_.find(model); ends != ends_of_.end()) {
      add_model_ends(model, *ends->second);
    }
  } catch (const UsageError& error) {
    throw ParseError(error.what(), instance.position);
  }
}

void SystemReader::name_ends(Program& program, std::uint32_t number) const {
  std::set<std::uint32_t> named(program.names.begin(), program.names.end());
  for (const Topic& topic : names_.topics) {
    if (!topic.has_end(number, true) && !topic.has_end(number, false)) continue;
    for (const Topic::Reader& reader : topic.readers) named.insert(reader.model);
  }
  for (const auto& [model, ends] : ends_of_) {
    for (const auto& [actor, at_it] : *ends) {
      const bool has_end = std::any_of(at_it.begin(), at_it.end(), [&](const End& end) {
        if (end.node.empty()) return end.program == number;
        const std::vector<std::string>& nodes = texts_[number].nodes;
        return std::find(nodes.begin(), nodes.end(), end.node) != nodes.end();
      });
      if (has_end) named.insert(model);
    }
  }
  program.names.assign(named.begin(), named.end());
}

void SystemReader::add_topic_ends(const Topic& topic, Topic::Reader& reader,
                                  ModelInstance& instance) {
  EndOptions options;
  options.collects = true;
  options.may_leave = texts_[reader.program].may_die;
  options.when_unexplored = instance.when_unexplored;
  if (!topic.mortal.empty()) {
    options.ends.push_back(find_end(instance.automaton, "writer", 0, 1, {"reader"}));
    if (topic.writers.size() > 1) options.ends.front().disconnect.reset();
  }
  EndedModel ended = with_ends(instance.automaton, options);
  replace_automaton(instance, std::move(ended.automaton));
  reader.collected = std::move(ended.collected);
  reader.cleared = std::move(ended.cleared);
  reader.gone = ended.gone;
  reader.writer_death.clear();
  if (!ended.deaths.empty() && !changes_nothing(ended.deaths.front())) {
    reader.writer_death = std::move(ended.deaths.front());
  }
}

void SystemReader::add_model_ends(std::uint32_t model, const Ends& ends) {
  ModelInstance& instance = system_.models[model];
  EndOptions options;
  options.when_unexplored = instance.when_unexplored;
  std::vector<std::uint32_t> dying;  // by end
  for (const auto& [actor, at_it] : ends) {
    std::set<std::string> others;
    for (const auto& [other, at_other] : ends) {
      if (other != actor) others.insert(other);
    }
    for (std::size_t place = 0; place < at_it.size(); ++place) {
      if (!at_it[place].node.empty() || !texts_[at_it[place].program].may_die) continue;
      options.ends.push_back(find_end(instance.automaton, actor, place, at_it.size(), others));
      dying.push_back(at_it[place].program);
    }
  }
  if (dying.empty()) return;
  if (instance.is_grown) fail_large_queue(model);
  EndedModel ended = with_ends(instance.automaton, options);
  replace_automaton(instance, std::move(ended.automaton));
  for (const std::uint32_t program : dying) names_.deaths[program].erase(model);
  for (std::size_t end = 0; end < dying.size(); ++end) {
    auto& deaths = names_.deaths[dying[end]];
    const auto [place, is_new] = deaths.try_emplace(model, ended.deaths[end]);
    if (!is_new) place->second = compose(place->second, ended.deaths[end]);
  }
  for (const std::uint32_t program : dying) {
    auto& deaths = names_.deaths[program];
    const auto place = deaths.find(model);
    if (place != deaths.end() && changes_nothing(place->second)) deaths.erase(place);
  }
}

}  // namespace maide
