#include "maide/workflow/learned_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/hash.hpp"
#include "maide/formats/dot.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/workflow/learn_model.hpp"
#include "maide/workflow/open_system.hpp"
#include "maide/workflow/patient_system.hpp"

namespace maide {
namespace {

std::string describe(const ModelRequest& request) {
  std::string text = request.learn;
  for (const auto& [key, value] : request.with) text += " " + key + "=" + value;
  return text;
}

// A system and how it was opened.
struct Opened {
  SystemSpec spec;
  SystemAccess access;
  OpenedSystem system;
};

Opened open(const ModelRequest& request, const LearnedModelsOptions& options) {
  std::vector<std::string> key_values;
  for (const auto& [key, value] : request.with) key_values.push_back(key + "=" + value);
  SystemSpec spec = parse_system_spec(request.learn, key_values);
  if (spec.kind == SystemSpec::Kind::simulated) {
    spec.target = (options.folder / spec.target).string();  // like every file that is named there
  }
  SystemAccess access;
  access.translation = Translation::eager;
  access.jobs = options.jobs;
  OpenedSystem system = open_system(spec, access, options.control);
  return {std::move(spec), std::move(access), std::move(system)};
}

InterfaceAutomaton learn(const ModelRequest& request, const Opened& opened,
                         const RunControl& control) {
  Sul& sul = *opened.system.sul;
  ExperimentOptions experiment;
  experiment.confirm = !opened.system.reference;
  experiment.patient = make_patient_system(opened.spec, opened.access, sul, {}, control);
  const LearnedModel learned = learn_model(sul, Translation::eager, experiment, control);
  if (!learned.experiment.is_complete()) std::rethrow_exception(learned.experiment.error);
  const auto* automaton = std::get_if<InterfaceAutomaton>(&*learned.model);
  if (automaton == nullptr) {
    throw UsageError("'" + request.learn +
                     "' is a plain Mealy machine, and programs meet interface automata");
  }
  return *automaton;
}

// The kept model, if it was learned from this very system: name, options, versions, bound.
std::optional<InterfaceAutomaton> read_kept(const std::filesystem::path& file,
                                            const SulInfo& system) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  InterfaceAutomaton automaton = read_interface_automaton(file);
  for (const auto& [key, value] : describe_origin(system)) {
    const auto kept = automaton.origin.find(key);
    if (kept == automaton.origin.end() || kept->second != value) return std::nullopt;
  }
  return automaton;
}

void keep(const std::filesystem::path& file, const InterfaceAutomaton& automaton) {
  std::error_code failure;  // the write that follows says it better
  std::filesystem::create_directories(file.parent_path(), failure);
  std::ostringstream text;
  write_dot(text, automaton);
  write_file_atomically(file, text.str());
}

}  // namespace

std::filesystem::path kept_model_path(const std::filesystem::path& folder,
                                      const ModelRequest& request) {
  const std::string text = describe(request);
  std::string name;
  for (const char c : text) {
    const bool is_plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '=' || c == '-';
    name += is_plain ? c : '_';
  }
  name.resize(std::min<std::size_t>(name.size(), 100));
  return folder / learned_models_folder / fmt::format("{}-{:016x}.dot", name, hash_text(text));
}

ModelSource make_learning_source(LearnedModelsOptions options) {
  return [options = std::move(options)](const ModelRequest& request) {
    if (request.learn.empty()) return read_requested_model(request);
    const std::filesystem::path kept = kept_model_path(options.folder, request);
    const auto note = [&](const std::string& line) {
      if (options.note) options.note(line);
    };
    try {
      const Opened opened = open(request, options);
      if (const auto before = read_kept(kept, opened.system.sul->info())) {
        note(fmt::format("{}: learned before ({})", request.instance, kept.string()));
        return *before;
      }
      note(fmt::format("{}: learning {}", request.instance, describe(request)));
      const InterfaceAutomaton automaton = learn(request, opened, options.control);
      keep(kept, automaton);
      return automaton;
    } catch (const Error& error) {
      throw Error(error.status(), fmt::format("model {}: {} ({})", request.instance, error.what(),
                                              to_string(request.position)));
    }
  };
}

}  // namespace maide
