#include "maide/experiment/open_system.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/base/thread_team.hpp"
#include "maide/experiment/other_machines.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/sul/simulated_sul.hpp"
#include "maide/sul/sul_pool.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/protocol/tcp.hpp"

namespace maide {
namespace {

// What the running program has told of itself.
struct Surroundings {
  std::mutex mutex;
  std::map<std::string, std::function<OpenedSystem()>> systems;  // by their names
  std::uint64_t made = 0;                                        // systems, so far
  std::optional<std::filesystem::path> wrappers;
};

Surroundings& surroundings() {
  static Surroundings the_one;
  return the_one;
}

std::function<OpenedSystem()> find_embedded(const std::string& name) {
  const std::lock_guard lock(surroundings().mutex);
  const auto found = surroundings().systems.find(name);
  return found == surroundings().systems.end() ? nullptr : found->second;
}

bool take_prefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

void parse_target(SystemSpec& spec) {
  std::string_view rest = spec.text;
  if (take_prefix(rest, "sim:")) {
    spec.kind = SystemSpec::Kind::simulated;
  } else if (take_prefix(rest, "tcp://")) {
    spec.kind = SystemSpec::Kind::tcp;
  } else if (take_prefix(rest, "exec:")) {
    spec.kind = SystemSpec::Kind::program;
    spec.command = split_shell_words(rest);
  } else if (find_embedded(spec.text)) {
    spec.kind = SystemSpec::Kind::embedded;
  } else if (rest.find_first_of(":/= \t") != std::string_view::npos) {
    std::error_code ignored;
    throw UsageError("unknown system '" + spec.text + "': " +
                     (std::filesystem::exists(spec.text, ignored)
                          ? "a model is simulated as sim:" + spec.text
                          : "give a wrapper's name (port, cyclonedds), sim:FILE, tcp://HOST:PORT "
                            "or exec:PROGRAM"));
  }
  spec.target = rest;
  if (spec.target.empty() || (spec.kind == SystemSpec::Kind::program && spec.command.empty())) {
    throw UsageError("nothing follows '" + spec.text + "' in the system's name");
  }
}

}  // namespace

SystemSpec parse_system_spec(const std::string& sul, std::span<const std::string> key_values) {
  if (sul.empty()) throw UsageError("the system's name is empty");
  SystemSpec spec;
  spec.text = sul;
  parse_target(spec);
  for (const std::string& word : key_values) {
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == std::string::npos) {
      throw UsageError("'" + word + "' is not an option of the system: write KEY=VALUE");
    }
    std::string key = word.substr(0, equals);
    std::replace(key.begin(), key.end(), '_', '-');
    if (!spec.options.emplace(key, word.substr(equals + 1)).second) {
      throw UsageError("option '" + key + "' of the system is given twice");
    }
  }
  return spec;
}

std::string origin_of(const SystemSpec& spec, const std::map<std::string, std::string>& options) {
  std::string text = quote_shell_word(spec.text);
  for (const auto& [key, value] : options) text += " " + quote_shell_word(key + "=" + value);
  return text;
}

// The folders are computed for each call: PATH may change, and calls are rare.

namespace {

namespace fs = std::filesystem;

constexpr std::string_view wrapper_prefix = "maide-wrap-";

bool is_program(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0;
}

std::vector<fs::path> path_folders() {
  std::vector<fs::path> folders;
  const char* path = std::getenv("PATH");
  for (const auto folder : split(path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin", ':')) {
    // An empty element means the current folder; programs are not taken from there unasked.
    if (!folder.empty()) folders.emplace_back(folder);
  }
  return folders;
}

// Beside the program and in libexec; empty if /proc is not there.
std::vector<fs::path> own_folders() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const fs::path folder = program.parent_path();
  return {folder, folder.parent_path() / "libexec" / "maide"};
}

// Besides, where look_for_wrappers_in() said.
std::vector<fs::path> program_folders() {
  std::vector<fs::path> folders = own_folders();
  const std::lock_guard lock(surroundings().mutex);
  if (surroundings().wrappers) folders.insert(folders.begin(), *surroundings().wrappers);
  return folders;
}

std::vector<fs::path> search_folders() {
  std::vector<fs::path> folders = program_folders();
  for (fs::path& folder : path_folders()) folders.push_back(std::move(folder));
  return folders;
}

std::optional<fs::path> find_program(std::string_view name, const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    if (fs::path candidate = folder / name; is_program(candidate)) return candidate;
  }
  return std::nullopt;
}

bool is_wrapper_name(std::string_view name) {
  return !name.empty() && std::ranges::all_of(name, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

}  // namespace

void look_for_wrappers_in(const fs::path& folder) {
  const std::lock_guard lock(surroundings().mutex);
  surroundings().wrappers = folder;
}

std::optional<fs::path> find_wrapper(std::string_view name) {
  if (!is_wrapper_name(name)) return std::nullopt;
  return find_program(std::string(wrapper_prefix) + std::string(name), search_folders());
}

std::optional<fs::path> find_own_file(std::string_view name) {
  for (const fs::path& folder : own_folders()) {
    std::error_code error;
    if (fs::path candidate = folder / name; fs::exists(candidate, error)) return candidate;
  }
  return std::nullopt;
}

std::optional<fs::path> find_own_program(std::string_view name) {
  return find_program(name, program_folders());
}

std::optional<fs::path> find_on_path(std::string_view name) {
  return find_program(name, path_folders());
}

std::vector<std::string> list_wrappers() {
  std::set<std::string> names;
  for (const fs::path& folder : search_folders()) {
    std::error_code error;
    for (auto entry = fs::directory_iterator(folder, error);
         !error && entry != fs::directory_iterator(); entry.increment(error)) {
      const std::string file = entry->path().filename().string();
      if (!file.starts_with(wrapper_prefix) || !is_program(entry->path())) continue;
      if (std::string name = file.substr(wrapper_prefix.size()); is_wrapper_name(name)) {
        names.insert(std::move(name));
      }
    }
  }
  return {names.begin(), names.end()};
}

std::string describe_wrapper_search() {
  const std::vector<std::string> names = list_wrappers();
  std::string places = "beside maide, in ../libexec/maide and on PATH";
  return names.empty() ? "no wrapper was found " + places
                       : "found: " + join(names) + "; looked " + places;
}

namespace {

// A model's text as a short number, so that a cache knows when the file was changed.
std::string text_version(const std::string& path) {
  return fmt::format("{:016x}", hash_text(read_file(path)));
}

std::size_t wanted_jobs(const SystemSpec& spec, const SystemAccess& access) {
  if (access.jobs > most_jobs) {
    throw UsageError(fmt::format("{} systems at once are more than {}", access.jobs, most_jobs));
  }
  return access.jobs != 0 ? access.jobs : default_jobs(spec);
}

std::unique_ptr<Sul> make_pool(std::vector<SulPool::Member> members) {
  if (members.size() == 1) return std::move(members.front().sul);
  return std::make_unique<SulPool>(std::move(members), log_warning);
}

OpenedSystem simulate(Model model, const SystemSpec& spec, const SystemAccess& access) {
  if (const auto* machine = std::get_if<Mealy>(&model); machine != nullptr && access.translation) {
    model = to_interface_automaton(*machine, Translation::eager, machine->actors);
  }
  if (const auto* machine = std::get_if<NondeterministicMealy>(&model);
      machine != nullptr && access.translation) {
    model = to_interface_automaton(*machine, machine->actors);
  }
  const std::string version = text_version(spec.target);
  std::vector<SulPool::Member> members;
  std::optional<Mealy> reference;
  for (std::size_t job = 0; job < wanted_jobs(spec, access); ++job) {
    auto simulated = std::visit(
        [&](const auto& its) { return std::make_unique<SimulatedSul>(its, spec.text); }, model);
    simulated->add_version("model", version);
    if (simulated->is_deterministic()) {
      reference = simulated->reference(access.translation.value_or(Translation::eager));
    }
    members.push_back({spec.text, std::move(simulated)});
  }
  return {make_pool(std::move(members)), std::move(reference)};
}

OpenedSystem open_simulation(const SystemSpec& spec, const SystemAccess& access) {
  ModelReading reading;
  for (const auto& [key, value] : spec.options) {
    if (key != "initial") {
      throw UsageError("unknown option '" + key +
                       "': a simulated model has 'initial' alone, the name of the state in which "
                       "it begins (" +
                       spec.text + ")");
    }
    reading.initial = value;
  }
  Model model = read_model(spec.target, reading);
  const auto* partial = std::get_if<NondeterministicMealy>(&model);
  if (partial != nullptr && !partial->is_complete()) {
    log_note(fmt::format("{} is a {}: to an input without an answer it says 'refused'", spec.target,
                         name_of_kind(model)));
  }
  try {
    return simulate(std::move(model), spec, access);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} ({})", error.what(), spec.target));
  }
}

// As it is started on a machine where it can be anywhere.
std::vector<std::string> wrapper_command(const SystemSpec& spec) {
  if (spec.kind == SystemSpec::Kind::program) return spec.command;
  return {std::string(wrapper_prefix) + spec.target};
}

std::vector<WrapperEndpoint> endpoints_of(const SystemSpec& spec, const SystemAccess& access) {
  if (spec.kind == SystemSpec::Kind::tcp) {
    const auto file =
        access.token_file.empty() ? std::nullopt : std::optional<std::string>(access.token_file);
    const std::string token = read_token(file).value_or("");
    std::vector<WrapperEndpoint> endpoints;
    for (std::string_view host : split(spec.target, ',')) {  // "a:1,b:2", or "a:1,tcp://b:2"
      if (host.starts_with("tcp://")) host.remove_prefix(6);
      endpoints.push_back(WrapperEndpoint::tcp(std::string(host), token));
    }
    return endpoints;
  }
  if (!access.launch.empty()) {
    return launched_endpoints(access, wrapper_command(spec));
  }
  if (spec.kind == SystemSpec::Kind::program) {
    return {WrapperEndpoint::program(spec.command, spec.text)};
  }
  const auto program = find_wrapper(spec.target);
  if (!program) {
    const std::string near = did_you_mean(spec.target, list_wrappers());
    if (!near.empty()) throw UsageError("unknown system '" + spec.target + "'" + near);
    const std::string hint =
        std::filesystem::exists(spec.target) ? "; a model is simulated as sim:" + spec.target : "";
    throw UsageError("unknown system '" + spec.target + "', or its wrapper maide-wrap-" +
                     spec.target + " is not built here; " + describe_wrapper_search() + hint);
  }
  return {WrapperEndpoint::program({program->string()}, spec.target)};
}

// What became of a wrapper that was to be opened.
struct Opening {
  SulPool::Member member;
  std::exception_ptr error;
};

// All at the same time: the start of some takes seconds.
std::vector<Opening> open_wrappers(const std::vector<WrapperEndpoint>& endpoints,
                                   const SystemSpec& spec, std::size_t jobs,
                                   const RunControl& control) {
  std::vector<Opening> openings(jobs);
  std::vector<std::jthread> threads;
  for (std::size_t job = 0; job < jobs; ++job) {
    const WrapperEndpoint& endpoint = endpoints[job % endpoints.size()];
    openings[job].member.name = endpoint.name();
    if (spec.kind != SystemSpec::Kind::tcp && endpoints.size() < jobs) {
      openings[job].member.name += fmt::format(" (process {})", job + 1);
    }
    const auto open = [&, job] {
      try {
        openings[job].member.sul =
            std::make_unique<WrapperProxy>(endpoint, spec.options, ProxySettings{}, control);
      } catch (...) {
        openings[job].error = std::current_exception();
      }
    };
    if (job + 1 == jobs) {
      open();
    } else {
      threads.emplace_back(open);
    }
  }
  threads.clear();
  return openings;
}

// The first error counts.
std::vector<SulPool::Member> require_all(std::vector<Opening> openings) {
  std::vector<SulPool::Member> members;
  for (Opening& opening : openings) {
    if (opening.error) std::rethrow_exception(opening.error);
    members.push_back(std::move(opening.member));
  }
  return members;
}

// One that cannot be started is a warning, as long as another can.
std::vector<SulPool::Member> require_one(std::vector<Opening> openings) {
  std::vector<SulPool::Member> members;
  std::exception_ptr first;
  for (Opening& opening : openings) {
    if (!opening.error) {
      members.push_back(std::move(opening.member));
      continue;
    }
    try {
      std::rethrow_exception(opening.error);
    } catch (const WrapperError& error) {
      log_warning(opening.member.name + " is given up: " + error.what());
      if (!first) first = opening.error;
    }
  }
  if (members.empty()) std::rethrow_exception(first);
  return members;
}

// The first that can be started.
std::vector<SulPool::Member> open_any(const std::vector<WrapperEndpoint>& endpoints,
                                      const SystemSpec& spec, const RunControl& control) {
  std::vector<Opening> openings;
  for (const WrapperEndpoint& endpoint : endpoints) {
    openings.push_back(std::move(open_wrappers({endpoint}, spec, 1, control).front()));
    if (!openings.back().error) break;
  }
  return require_one(std::move(openings));
}

}  // namespace

std::size_t default_jobs(const SystemSpec& spec) {
  switch (spec.kind) {
    case SystemSpec::Kind::wrapper: return processor_count();
    case SystemSpec::Kind::tcp: return split(spec.target, ',').size();
    case SystemSpec::Kind::simulated:
    case SystemSpec::Kind::program:
    case SystemSpec::Kind::embedded: break;
  }
  return 1;
}

namespace {

OpenedSystem open_embedded(const SystemSpec& spec, const SystemAccess& access) {
  if (!spec.options.empty()) {
    throw UsageError("unknown option '" + spec.options.begin()->first +
                     "': the options of an object are its own");
  }
  if (wanted_jobs(spec, access) != 1) throw UsageError("an object is one system: jobs=1");
  const auto open = find_embedded(spec.text);
  if (!open) throw UsageError("there is no such object any more (" + spec.text + ")");
  return open();
}

}  // namespace

EmbeddedSystem::EmbeddedSystem(std::function<OpenedSystem()> open) {
  const std::lock_guard lock(surroundings().mutex);
  text_ = "object:" + std::to_string(++surroundings().made);
  surroundings().systems.emplace(text_, std::move(open));
}

EmbeddedSystem::~EmbeddedSystem() {
  const std::lock_guard lock(surroundings().mutex);
  surroundings().systems.erase(text_);  // what it holds is the owner's, who is still there
}

OpenedSystem open_system(const SystemSpec& spec, const SystemAccess& access,
                         const RunControl& control) {
  check_machines(spec, access);
  if (spec.kind == SystemSpec::Kind::embedded) return open_embedded(spec, access);
  if (spec.kind == SystemSpec::Kind::simulated) return open_simulation(spec, access);
  if (!access.accept.empty()) {
    const std::string wrapper = join(wrapper_command(spec), " ");
    return {await_wrappers(spec, access, wrapper, control), std::nullopt};
  }
  const std::vector<WrapperEndpoint> endpoints = endpoints_of(spec, access);
  if (!access.launch.empty()) {
    return {make_pool(access.jobs == 1
                          ? open_any(endpoints, spec, control)
                          : require_one(open_wrappers(endpoints, spec, endpoints.size(), control))),
            std::nullopt};
  }
  const std::size_t jobs = wanted_jobs(spec, access);
  if (jobs < endpoints.size()) {
    throw UsageError(fmt::format("{} hosts need at least as many jobs, not {} ({})",
                                 endpoints.size(), jobs, spec.text));
  }
  return {make_pool(require_all(open_wrappers(endpoints, spec, jobs, control))), std::nullopt};
}

std::size_t count_systems(const Sul& sul) {
  const auto* pool = dynamic_cast<const SulPool*>(&sul);
  return pool == nullptr ? 1 : pool->most();
}

std::vector<OptionSpec> list_system_options(const SystemSpec& spec, const SystemAccess& access,
                                            const RunControl& control) {
  check_machines(spec, access);
  const bool has_options =
      spec.kind != SystemSpec::Kind::simulated && spec.kind != SystemSpec::Kind::embedded;
  if (!has_options) return {};
  return ask_hello(endpoints_of(spec, access).front(), {}, control).options;
}

}  // namespace maide
