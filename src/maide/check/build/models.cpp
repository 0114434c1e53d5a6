#include "maide/check/build/models.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "maide/check/rules/locks.hpp"
#include "maide/check/rules/model_ends.hpp"
#include "maide/check/text/tokens.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {

program_syntax::Context Models::context(const Declarations& file, std::uint32_t program) {
  program_syntax::Context known{
      instances, names, words, program, {}, file.programs[program].indices, nullptr, nullptr, {}};
  if (program < own.size()) known.own = own[program];
  return known;
}

namespace {

std::string normalised(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

// The option that a message is about: "option inputs=write,size: 'size' is not one of ...",
// "unknown option 'inptus'". Else one whose value it quotes; null: none.
const TreeNode* find_option(const std::string& message,
                            const std::vector<const TreeNode*>& options) {
  constexpr std::string_view before = "option ";
  if (const std::size_t at = message.find(before); at != std::string::npos) {
    std::size_t begin = at + before.size();
    if (begin < message.size() && message[begin] == '\'') ++begin;
    const std::string name = message.substr(begin, message.find_first_of("'= :", begin) - begin);
    for (const TreeNode* option : options) {
      if (normalised(option->name_text()) == normalised(name)) return option;
    }
  }
  for (const TreeNode* option : options) {
    if (message.find("'" + option->text() + "'") != std::string::npos) return option;
  }
  return nullptr;
}

}  // namespace

InterfaceAutomaton ask_source(const Declarations& file, const ModelSource& source,
                              const ModelOrigin& origin, const ModelRequest& request) {
  try {
    return source(request);
  } catch (const UsageError& error) {
    const TreeNode* const option = find_option(error.what(), origin.options);
    throw ParseError(error.what(),
                     option == nullptr ? request.position : file.tree().at_name(*option));
  }
}

void make_queue_of(Models& models, std::uint32_t number, const QueueSize& size,
                   const QueueLimits& limits) {
  ModelInstance& model = models.instances[number];
  model.is_grown = queue_states(size) > static_cast<double>(limits.states);
  if (model.is_grown && size.is_unknown) fail_large_queue(models, number, limits);
  models.growing.erase(number);
  if (model.is_grown) {
    // What is behind its bound was left out by us, and is no place where nothing can happen.
    model.when_unexplored = WhenUnexplored::stop;
    model.automaton =
        models.growing.emplace(number, std::make_shared<GrowingQueue>(size)).first->second->start();
  } else {
    model.automaton = make_queue(size);
  }
}

void fail_large_queue(const Models& models, std::uint32_t model, const QueueLimits& limits) {
  const ModelInstance& instance = models.instances[model];
  std::string types;
  const auto carried = models.names.carried.find(model);
  if (carried != models.names.carried.end()) {
    for (const ValueType& type : carried->second) {
      types += (types.empty() ? " with the values " : ", ") + to_string(type, models.words);
    }
  }
  throw ParseError(
      "queue '" + instance.name + "'" + types + " has more than " + std::to_string(limits.states) +
          " states: give it fewer values, or a smaller size" +
          (instance.is_grown ? " (only a queue that is no topic's, and whose ends cannot die, may "
                               "have more)"
                             : ""),
      instance.position);
}

namespace {

class ModelFinder {
 public:
  ModelFinder(const Declarations& file, const ModelSource& source, const QueueLimits& limits,
              const RunControl& control)
      : file_(file), source_(source), limits_(limits), control_(control) {}

  Models find() {
    models_.instances = file_.models;
    models_.names = file_.names;
    models_.words = file_.words;
    for (std::uint32_t model = 0; model < file_.models.size(); ++model) {
      make(model);
      // The models of a topic's readers lie side by side.
      const auto reader = file_.topic_of.find(model);
      if (reader == file_.topic_of.end()) continue;
      const Topic& topic = models_.names.topics[reader->second.first];
      if (reader->second.second + 1 == topic.readers.size()) finish_topic(reader->second.first);
    }
    find_values(file_, models_, source_, limits_, control_);
    return std::move(models_);
  }

 private:
  void make(std::uint32_t number) {
    ModelInstance& model = models_.instances[number];
    const ModelOrigin& origin = file_.origins[number];
    switch (origin.kind) {
      case ModelOrigin::Kind::made:
        if (model.source == ModelInstance::Source::service) make_service(number);
        return;
      case ModelOrigin::Kind::built_in:
        model.automaton = origin.built_in->make(origin.count);
        break;
      case ModelOrigin::Kind::recursive_mutex:
        model.automaton =
            make_recursive_mutex(file_.names.holders.at(number).size(), origin.count != 0);
        break;
      case ModelOrigin::Kind::condition:
        model.automaton = make_condition(file_.names.conditions.at(number).waiters.size());
        break;
      case ModelOrigin::Kind::queue:
        models_.queues.emplace(number, QueueModel{origin.size, {}});
        make_queue_of(models_, number, origin.size, limits_);
        break;
      case ModelOrigin::Kind::asked: ask(number); break;
      case ModelOrigin::Kind::copied: copy(number, origin.first); break;
    }
    const auto ends = file_.ends_of.find(number);
    if (ends != file_.ends_of.end()) {
      check_ends(number);
      add_ends(file_, models_, number, limits_);
    } else {
      note_learned(number);
    }
  }

  void make_service(std::uint32_t number) {
    auto rules = std::make_shared<ServiceModel>(file_.shapes.at(number));
    models_.names.services.at(number).rules = rules.get();
    models_.instances[number].automaton = rules->start();
    models_.growing.emplace(number, std::move(rules));
  }

  void ask(std::uint32_t number) {
    const ModelOrigin& origin = file_.origins[number];
    InterfaceAutomaton automaton = ask_source(file_, source_, origin, origin.request);
    ModelInstance& model = models_.instances[number];
    model.automaton = std::move(automaton);
    if (has_unknown_depth(model.automaton)) model.source = ModelInstance::Source::built_in;
    if (model.automaton.size() == 0) {
      throw ParseError("model '" + model.name + "' has no state", model.position);
    }
    for (const Alphabet* alphabet : {&model.automaton.inputs(), &model.automaton.outputs()}) {
      for (const std::string& name : alphabet->names()) {
        for (const std::string& argument : program_syntax::split_name(name).arguments) {
          program_syntax::read_value(argument, models_.words);  // a word is known from here on
        }
      }
    }
  }

  void copy(std::uint32_t number, std::uint32_t first) {
    ModelInstance& model = models_.instances[number];
    const std::string name = std::move(model.name);
    model = models_.instances[first];
    model.name = name;
    if (!model.as_read) return;  // the first one, as it was before programs stood at its ends
    model.automaton = *model.as_read;
    model.as_read.reset();
  }

  // Each is one of the model's actors, where it names actors.
  void check_ends(std::uint32_t number) const {
    const ModelInstance& model = models_.instances[number];
    const YamlNode* const ends = file_.origins[number].ends;
    std::vector<std::string> actors;
    for (const Actor& actor : model.automaton.actors) actors.push_back(actor.name);
    if (ends == nullptr || actors.empty()) return;
    for (const YamlEntry& entry : ends->entries) {
      const std::string& role = entry.key.value;
      if (std::find(actors.begin(), actors.end(), role) != actors.end()) continue;
      file_.tree().fail("model " + model.name + " has no end '" + role +
                            "'; it has: " + known_instead(role, actors),
                        entry.key);
    }
  }

  // A learned model that programs may write values into.
  void note_learned(std::uint32_t number) {
    const ModelInstance& model = models_.instances[number];
    if (!model.is_learned || !model.automaton.inputs().find("write")) return;
    if (!model.automaton.outputs().find("message")) return;
    QueueModel queue;
    queue.learned = file_.origins[number].request;
    queue.learned->instance = model.name;
    models_.queues.emplace(number, std::move(queue));
  }

  void finish_topic(std::size_t number) {
    make_caller(models_.names.topics[number]);
    check_further_writer(models_.names.topics[number]);
    for (const Topic::Reader& reader : models_.names.topics[number].readers) {
      add_ends(file_, models_, reader.model, limits_);
    }
  }

  // He takes nothing that a call returns.
  void check_further_writer(const Topic& topic) const {
    const bool has_anybody = std::ranges::any_of(
        topic.writers, [&](std::uint32_t writer) { return file_.programs[writer].is_anybody; });
    if (!has_anybody || !has_returns(topic)) return;
    throw ParseError("anybody beside other writers takes no output of his writes, and '" +
                         topic.name + "' has one: that is not built",
                     topic.position);
  }

  bool has_returns(const Topic& topic) const {
    return std::ranges::any_of(topic.readers, [&](const Topic::Reader& reader) {
      const InterfaceAutomaton& automaton = models_.instances[reader.model].automaton;
      return std::ranges::any_of(automaton.outputs().names(), [&](const std::string& output) {
        return is_of_writer(automaton, output);
      });
    });
  }

  // The variable that says whose call has not returned, where that matters.
  void make_caller(Topic& topic) {
    for (const std::uint32_t writer : topic.writers) {
      const ProgramDeclaration& program = file_.programs[writer];
      if (program.may_die) topic.mortal.emplace(writer, models_.words.intern(program.name));
    }
    if (!has_returns(topic) || topic.mortal.empty() || topic.writers.size() == 1) return;
    topic.nobody = models_.words.intern("nobody");
    ModelInstance caller;
    caller.name = topic.name + ".writer";
    caller.source = ModelInstance::Source::variable;
    caller.type.kind = ValueKind::word;
    caller.type.words = {topic.nobody};
    for (const auto& [writer, word] : topic.mortal) caller.type.words.push_back(word);
    caller.automaton = InterfaceAutomaton({}, {}, caller.type.count());
    caller.position = topic.position;
    topic.caller = static_cast<std::uint32_t>(models_.instances.size());
    models_.instances.push_back(std::move(caller));
  }

  const Declarations& file_;
  const ModelSource& source_;
  const QueueLimits& limits_;
  const RunControl& control_;
  Models models_;
};

}  // namespace

Models find_models(const Declarations& file, const ModelSource& source, const QueueLimits& limits,
                   const RunControl& control) {
  return ModelFinder(file, source, limits, control).find();
}

InterfaceAutomaton read_requested_model(const ModelRequest& request) {
  if (request.known) return *request.known;
  if (!request.learn.empty()) {
    throw ParseError("model '" + request.instance + "' is to be learned: run `maide learn " +
                         request.learn + " -o model.dot` and name the file here",
                     request.position);
  }
  std::error_code ignored;
  if (!std::filesystem::exists(request.file, ignored)) {
    throw ParseError("there is no file '" + request.file.string() + "'", request.position);
  }
  Model model = read_model(request.file);
  if (auto* automaton = std::get_if<InterfaceAutomaton>(&model)) return std::move(*automaton);
  throw ParseError("'" + request.file.string() +
                       "' is a Mealy machine and programs meet interface automata (?input, "
                       "!output): learn it with `--as ia`, or `maide learn sim:" +
                       request.file.filename().string() +
                       " -o model.dot --translation eager` makes one of it",
                   request.position);
}

}  // namespace maide
