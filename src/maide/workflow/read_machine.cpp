#include "maide/workflow/read_machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {

Mealy read_machine(const std::filesystem::path& path, Translation translation) {
  Model model = read_model(path);
  if (auto* machine = std::get_if<Mealy>(&model)) return std::move(*machine);
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton == nullptr) {
    throw UsageError("the model is nondeterministic (" + path.string() + ")");
  }
  try {
    return to_mealy(*automaton, translation);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} ({})", error.what(), path.string()));
  }
}

bool shares_inputs(const Mealy& machine, const Alphabet& inputs) {
  const auto is_known = [&](const std::string& name) { return inputs.find(name).has_value(); };
  return std::any_of(machine.inputs().names().begin(), machine.inputs().names().end(), is_known);
}

Alphabet input_alphabet(const SulInfo& system) {
  Alphabet inputs;
  for (const SulInput& input : system.inputs) inputs.intern(input.name);
  return inputs;
}

Mealy read_old_machine(const std::filesystem::path& path, Translation translation,
                       const Alphabet& inputs) {
  Mealy machine = read_machine(path, translation);
  if (shares_inputs(machine, inputs)) return machine;
  throw UsageError(
      fmt::format("a run cannot start from a model with none of the system's inputs, "
                  "which are {} ({})",
                  join(inputs.names()), path.string()));
}

namespace {

TraceLog read_cache(const std::filesystem::path& path, const RunControl& control) {
  CacheFile file(path);
  TraceLog log{file.inputs(), file.outputs(), {}, path.string()};
  file.for_each([&](const Word& inputs, const Word& outputs) {
    if (log.traces.size() % 4096 == 0) control.check("reading the cache");
    // A word that did not complete has fewer outputs.
    log.traces.push_back({head(inputs, outputs.size()), outputs});
  });
  return log;
}

// By its first bytes. What is no regular file can be read once only, and is no database.
bool is_sqlite(const std::filesystem::path& path) {
  constexpr std::string_view magic = "SQLite format 3";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::string start(magic.size(), '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), std::ssize(start));
  return start == magic;
}

}  // namespace

TraceLog read_traces(const std::filesystem::path& path, const RunControl& control) {
  if (is_sqlite(path)) return read_cache(path, control);
  return read_trace_log(read_file(path, control), path.string(), control);
}

}  // namespace maide
