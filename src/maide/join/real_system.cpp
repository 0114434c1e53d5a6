#include "maide/join/real_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/log.hpp"
#include "maide/check/system/simulation.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/join/valued_queue.hpp"
#include "maide/sul/ia_translator.hpp"

namespace maide {
namespace {

// "port kind=strict size=6", as models name their systems.
SystemSpec parse_origin(const std::string& text) {
  std::vector<std::string> words = split_shell_words(text);
  if (words.empty()) throw UsageError("the name of its system is empty");
  const std::string name = std::move(words.front());
  words.erase(words.begin());
  return parse_system_spec(name, words);
}

const std::string* find_origin(const ModelInstance& instance, const std::string& key) {
  const auto found = instance.automaton.origin.find(key);
  return found == instance.automaton.origin.end() ? nullptr : &found->second;
}

// Options under which the system waits longer than when it was learned; where the model does not
// say how long that was, than by itself. None for a system without such options, and for one that
// runs by itself (tcp, exec).
std::map<std::string, std::string> waits_of(const ModelInstance& instance, const SystemSpec& spec,
                                            const RealSystemOptions& options) {
  if (spec.kind != SystemSpec::Kind::wrapper) return {};
  try {
    const std::string* sul = find_origin(instance, "sul");
    auto waits = longer_waits(parse_origin(sul == nullptr ? "" : *sul).options);
    if (!waits.empty()) return waits;
  } catch (const UsageError&) {
    // It says nothing of its options, or in words of somebody else's.
  }
  SystemAccess access;
  access.jobs = 1;
  return longer_waits(open_system(spec, access, options.control).sul->info().options);
}

void warn_of_other_version(const ModelInstance& instance, const SulInfo& info) {
  const std::string* learned = find_origin(instance, "versions");
  const Origin now = describe_origin(info);
  const auto versions = now.find("versions");
  if (learned == nullptr || versions == now.end() || versions->second == *learned) return;
  log_warning(fmt::format("{} was learned from other versions ({}) than these ({})", instance.name,
                          *learned, versions->second));
}

std::vector<Symbol> match_inputs(const ModelInstance& instance, const SulInfo& info) {
  std::vector<Symbol> inputs;
  for (const std::string& name : instance.automaton.inputs().names()) {
    Symbol symbol = 0;
    while (symbol < info.inputs.size() && info.inputs[symbol].name != name) ++symbol;
    if (symbol == info.inputs.size()) {
      throw UsageError(fmt::format("the system {} has no input '{}' with these options (model {})",
                                   info.name, name, instance.name));
    }
    inputs.push_back(symbol);
  }
  return inputs;
}

// The topic whose reader's model it is.
const TopicInstance* topic_of(const System& system, std::uint32_t model) {
  for (const TopicInstance& topic : system.topics) {
    for (const TopicInstance::Reader& reader : topic.readers) {
      if (reader.model == model) return &topic;
    }
  }
  return nullptr;
}

// The system of a whole topic: that of its readers' models, with as many ends as it has.
SystemSpec find_system_of_topic(const System& system, const TopicInstance& topic,
                                const ModelRequests& requests) {
  std::optional<SystemSpec> spec;
  for (const TopicInstance::Reader& reader : topic.readers) {
    const ModelInstance& instance = system.models[reader.model];
    SystemSpec its = find_system_of(instance, request_of(instance, requests));
    if (spec && (its.text != spec->text || its.options != spec->options)) {
      throw UsageError(fmt::format(
          "topic {}: its readers have options of their own, and a system has the same for all ({})",
          topic.name, to_string(instance.position)));
    }
    spec = std::move(its);
  }
  if (topic.writers.size() > 1) spec->options["writers"] = std::to_string(topic.writers.size());
  if (topic.readers.size() > 1) spec->options["readers"] = std::to_string(topic.readers.size());
  return *spec;
}

// Sets the options, and says so: ", with rmw=fastrtps".
std::string change(SystemSpec& spec, const std::map<std::string, std::string>& settings,
                   const std::string& what) {
  std::string text = settings.empty() ? "" : ", " + what;
  for (const auto& [key, value] : settings) {
    spec.options[key] = value;
    text += fmt::format(" {}={}", key, value);
  }
  return text;
}

// What a person says stands.
std::string wait_longer(SystemSpec& spec, std::map<std::string, std::string> waits,
                        const RealSystemOptions& options) {
  for (const auto& [key, value] : options.settings) waits.erase(key);
  return change(spec, waits, "waiting longer:");
}

// As waits_of(), for the nodes.
std::unique_ptr<RealSystem> open_nodes(const RealSystemOptions& options) {
  auto real = std::make_unique<RealSystem>();
  real->nodes = options.nodes;
  real->instance = "nodes";
  SystemSpec spec = options.nodes->spec();
  real->description = "ros2";
  if (const auto rmw = spec.options.find("rmw"); rmw != spec.options.end()) {
    real->description += " rmw=" + rmw->second;
  }
  real->description += change(spec, options.settings, "with");
  SystemAccess access;
  access.translation = Translation::eager;
  access.jobs = 1;
  const auto waits = longer_waits(open_system(spec, access, options.control).sul->info().options);
  real->description += wait_longer(spec, waits, options);
  access.jobs = options.jobs;
  real->sul = open_system(spec, access, options.control).sul;
  real->jobs = count_systems(*real->sul);
  return real;
}

std::unique_ptr<RealSystem> open(const System& system, std::uint32_t index,
                                 const ModelRequests& requests, const RealSystemOptions& options) {
  const ModelInstance& instance = system.models[index];
  const TopicInstance* topic = topic_of(system, index);
  const ModelRequest& request = request_of(instance, requests);
  SystemSpec spec = topic == nullptr ? find_system_of(instance, request)
                                     : find_system_of_topic(system, *topic, requests);
  auto real = std::make_unique<RealSystem>();
  real->instance = topic == nullptr ? instance.name : topic->name;
  real->description = spec.text;
  for (const auto& [key, value] : request.with) real->description += " " + key + "=" + value;
  if (!request.values.empty()) real->description += " payload=" + payload_of(request.values);
  if (topic != nullptr) {
    real->description +=
        fmt::format(" writers={} readers={}", topic->writers.size(), topic->readers.size());
  }
  if (request.learn.empty()) real->description += " as in " + instance.origin;
  real->description += change(spec, options.settings, "with");
  SystemAccess access;
  access.translation = Translation::eager;
  access.jobs = spec.kind == SystemSpec::Kind::tcp ? 0 : options.jobs;  // at least all hosts
  access.token_file = options.token_file;
  try {
    real->description += wait_longer(spec, waits_of(instance, spec, options), options);
    real->sul = open_system(spec, access, options.control).sul;
    real->jobs = count_systems(*real->sul);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} {}: {} ({})", topic == nullptr ? "model" : "topic",
                                 real->instance, error.what(), to_string(instance.position)));
  }
  warn_of_other_version(instance, real->sul->info());
  if (topic == nullptr) real->inputs = match_inputs(instance, real->sul->info());
  return real;
}

}  // namespace

bool is_real(const ModelInstance& model) {
  using Source = ModelInstance::Source;
  return model.source == Source::file ||
         (model.source == Source::service && model.automaton.origin.contains("sul"));
}

ModelSource record_requests(ModelSource source, ModelRequests& requests) {
  return [source = std::move(source), &requests](const ModelRequest& request) {
    requests[request.instance] = request;
    return source(request);
  };
}

const ModelRequest& request_of(const ModelInstance& instance, const ModelRequests& requests) {
  static const ModelRequest none;
  if (instance.source == ModelInstance::Source::service) return none;
  auto place = requests.find(instance.name);
  if (place == requests.end()) {
    place = requests.find(instance.name.substr(0, instance.name.find('[')));
  }
  if (place == requests.end()) {
    throw UsageError("which system model " + instance.name +
                     " stands for is not known: of dumps, those of the stages 'names' and 'models' "
                     "say it");
  }
  return place->second;
}

SystemSpec find_system_of(const ModelInstance& instance, const ModelRequest& request) {
  SystemSpec spec;
  if (!request.learn.empty()) {
    std::vector<std::string> key_values;
    for (const auto& [key, value] : request.with) key_values.push_back(key + "=" + value);
    if (!request.values.empty()) key_values.push_back("payload=" + payload_of(request.values));
    spec = parse_system_spec(request.learn, key_values);
  } else {
    const std::string* sul = find_origin(instance, "sul");
    if (sul == nullptr) {
      throw UsageError(fmt::format(
          "model {} does not say what it was learned from (graph attribute 'sul'), so there is "
          "nothing real to run ({})",
          instance.name, to_string(instance.position)));
    }
    spec = parse_origin(*sul);
  }
  if (spec.kind == SystemSpec::Kind::simulated) {
    // Like every file that is named there.
    const auto beside = std::filesystem::path(instance.position.file).parent_path() / spec.target;
    if (!request.learn.empty() || std::filesystem::exists(beside)) spec.target = beside.string();
  }
  return spec;
}

std::vector<std::unique_ptr<RealSystem>> open_real_systems(const System& system,
                                                           const ModelRequests& requests,
                                                           const RealSystemOptions& options) {
  std::set<std::uint32_t> used;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& use : program.uses_of(edge)) {
        if (!is_real(system.models[use.model])) continue;
        if (options.nodes && options.nodes->contains(use.model)) continue;
        const TopicInstance* topic = topic_of(system, use.model);
        used.insert(topic == nullptr ? use.model : topic->readers.front().model);
      }
    }
  }
  std::vector<std::unique_ptr<RealSystem>> real(system.models.size());
  for (const std::uint32_t index : used) real[index] = open(system, index, requests, options);
  if (options.nodes) real[options.nodes->models().front()] = open_nodes(options);
  return real;
}

std::shared_ptr<const ReplayedNodes> find_nodes(const System& system,
                                                const ModelRequests& requests) {
  std::vector<SystemSpec> topics;
  for (const TopicInstance& topic : system.topics) {
    topics.emplace_back();
    if (!ReplayedNodes::has_node(system, topic)) continue;
    const ModelInstance& model = system.models[topic.readers.front().model];
    if (model.source == ModelInstance::Source::built_in) {
      const std::string reason =
          model.is_learned ? "has an unknown depth, so it is not known what to run"
                           : "is a queue that is written by hand, so there is nothing real to run";
      throw UsageError(
          fmt::format("topic {} {} ({})", topic.name, reason, to_string(model.position)));
    }
    topics.back() = find_system_of_topic(system, topic, requests);
  }
  return std::make_shared<const ReplayedNodes>(system, topics);
}

Trace draw_run(const System& system, std::size_t most_steps, Random& random, bool of_nodes) {
  std::optional<NodeRuns> nodes;
  if (of_nodes) nodes.emplace(system);
  Trace trace;
  GlobalState state = initial_state(system);
  while (trace.steps.size() < most_steps) {
    std::vector<Step> steps = enabled_steps(system, state);
    std::erase_if(
        steps, [&](const Step& step) { return step.is_beyond || doer_of(system, step) == nobody; });
    if (nodes) nodes->restrict(state, steps);
    if (steps.empty()) break;
    const Step& step = steps[draw_step(steps, random)];
    trace.steps.push_back(step);
    if (nodes) nodes->take(state, step);
    state = apply(system, state, step);
  }
  return trace;
}

}  // namespace maide
