#include "maide/workflow/real_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/log.hpp"
#include "maide/sul/ia_translator.hpp"
#include "maide/workflow/open_system.hpp"
#include "maide/workflow/pacing.hpp"

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

std::unique_ptr<RealSystem> open(const ModelInstance& instance, const ModelRequest& request,
                                 const RealSystemOptions& options) {
  SystemSpec spec = find_system_of(instance, request);
  auto real = std::make_unique<RealSystem>();
  real->instance = instance.name;
  real->description = spec.text;
  for (const auto& [key, value] : request.with) real->description += " " + key + "=" + value;
  if (request.learn.empty()) real->description += " as in " + instance.origin;
  SystemAccess access;
  access.translation = Translation::eager;
  access.jobs = spec.kind == SystemSpec::Kind::tcp ? 0 : options.jobs;  // at least all hosts
  access.token_file = options.token_file;
  try {
    const auto waits = waits_of(instance, spec, options);
    if (!waits.empty()) real->description += ", waiting longer:";
    for (const auto& [key, value] : waits) {
      spec.options[key] = value;
      real->description += fmt::format(" {}={}", key, value);
    }
    OpenedSystem opened = open_system(spec, access, options.control);
    real->sul = std::move(opened.sul);
    real->jobs = opened.jobs;
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("model {}: {} ({})", instance.name, error.what(),
                                 to_string(instance.position)));
  }
  warn_of_other_version(instance, real->sul->info());
  real->inputs = match_inputs(instance, real->sul->info());
  return real;
}

// A step that does something with several models at once is a topic's: its readers' models are put
// together, and no system is behind that.
void refuse_topics(const System& system) {
  for (const Program& program : system.programs) {
    for (const Joint& joint : program.joints) {
      for (const ModelUse& event : joint.events) {
        const ModelUse& first = joint.events.front();
        if (event.kind != first.kind || event.model == first.model) continue;
        const ModelInstance& model = system.models[event.model];
        if (model.source != ModelInstance::Source::file) continue;
        throw UsageError(
            fmt::format("model {} is one of several readers' of a topic, and such "
                        "topics are not tried on real systems ({})",
                        model.name, to_string(model.position)));
      }
    }
  }
}

}  // namespace

ModelSource record_requests(ModelSource source, ModelRequests& requests) {
  return [source = std::move(source), &requests](const ModelRequest& request) {
    requests[request.instance] = request;
    return source(request);
  };
}

SystemSpec find_system_of(const ModelInstance& instance, const ModelRequest& request) {
  SystemSpec spec;
  if (!request.learn.empty()) {
    std::vector<std::string> key_values;
    for (const auto& [key, value] : request.with) key_values.push_back(key + "=" + value);
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
  refuse_topics(system);
  std::set<std::uint32_t> used;
  for (const Program& program : system.programs) {
    for (const ProgramEdge& edge : program.edges) {
      for (const ModelUse& use : program.uses_of(edge)) {
        if (system.models[use.model].source == ModelInstance::Source::file) used.insert(use.model);
      }
    }
  }
  std::vector<std::unique_ptr<RealSystem>> real(system.models.size());
  for (const std::uint32_t index : used) {
    const ModelInstance& instance = system.models[index];
    real[index] = open(instance, requests.at(instance.name), options);
  }
  return real;
}

Trace draw_run(const System& system, std::size_t most_steps, Random& random) {
  Trace trace;
  GlobalState state = initial_state(system);
  while (trace.steps.size() < most_steps) {
    std::vector<Step> steps = enabled_steps(system, state);
    std::erase_if(steps, [](const Step& step) { return step.is_beyond; });
    if (steps.empty()) break;
    std::vector<std::uint32_t> programs;
    for (const Step& step : steps) {
      if (programs.empty() || programs.back() != step.program) programs.push_back(step.program);
    }
    const std::uint32_t program = programs[random.below(programs.size())];
    std::erase_if(steps, [&](const Step& step) { return step.program != program; });
    const Step& step = steps[random.below(steps.size())];
    trace.steps.push_back(step);
    state = apply(system, state, step);
  }
  return trace;
}

}  // namespace maide
