#include "maide/workflow/open_system.hpp"

#include <fmt/format.h>

#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/hash.hpp"
#include "maide/base/suggest.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/sul/simulated_sul.hpp"
#include "maide/wire/token.hpp"
#include "maide/wire/wrapper_proxy.hpp"
#include "maide/workflow/wrapper_search.hpp"

namespace maide {
namespace {

// A model's text as a short number, so that a cache knows when the file was changed.
std::string text_version(const std::string& path) {
  return fmt::format("{:016x}", hash_text(read_file(path)));
}

OpenedSystem simulate(Model model, const SystemSpec& spec, const SystemAccess& access) {
  if (const auto* machine = std::get_if<Mealy>(&model); machine != nullptr && access.translation) {
    model = to_interface_automaton(*machine, Translation::eager, machine->actors);
  }
  auto simulated = std::visit(
      [&](auto& its) { return std::make_unique<SimulatedSul>(std::move(its), spec.text); }, model);
  simulated->add_version("model", text_version(spec.target));
  OpenedSystem opened;
  opened.reference = simulated->reference(access.translation.value_or(Translation::eager));
  opened.sul = std::move(simulated);
  return opened;
}

OpenedSystem open_simulation(const SystemSpec& spec, const SystemAccess& access) {
  if (!spec.options.empty()) {
    throw UsageError("unknown option '" + spec.options.begin()->first +
                     "': a simulated model has none (" + spec.text + ")");
  }
  Model model = read_model(spec.target);
  try {
    return simulate(std::move(model), spec, access);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} ({})", error.what(), spec.target));
  }
}

WrapperEndpoint endpoint_of(const SystemSpec& spec, const SystemAccess& access) {
  if (spec.kind == SystemSpec::Kind::tcp) {
    const auto file =
        access.token_file.empty() ? std::nullopt : std::optional<std::string>(access.token_file);
    return WrapperEndpoint::tcp(spec.target, read_token(file).value_or(""));
  }
  if (spec.kind == SystemSpec::Kind::program) {
    return WrapperEndpoint::program(spec.command, spec.text);
  }
  const auto program = find_wrapper(spec.target);
  if (!program) {
    const std::string hint = std::filesystem::exists(spec.target)
                                 ? "; a model is simulated as sim:" + spec.target
                                 : did_you_mean(spec.target, list_wrappers());
    throw UsageError("unknown system '" + spec.target + "', or its wrapper maide-wrap-" +
                     spec.target + " is not built here; " + describe_wrapper_search() + hint);
  }
  return WrapperEndpoint::program({program->string()}, spec.target);
}

}  // namespace

OpenedSystem open_system(const SystemSpec& spec, const SystemAccess& access,
                         const RunControl& control) {
  if (spec.kind == SystemSpec::Kind::simulated) return open_simulation(spec, access);
  OpenedSystem opened;
  opened.sul = std::make_unique<WrapperProxy>(endpoint_of(spec, access), spec.options,
                                              ProxySettings{}, control);
  return opened;
}

std::string list_system_options(const SystemSpec& spec, const SystemAccess& access,
                                const RunControl& control) {
  if (spec.kind == SystemSpec::Kind::simulated) return "a simulated model has no options\n";
  return to_string(ask_hello(endpoint_of(spec, access), {}, control).options);
}

}  // namespace maide
