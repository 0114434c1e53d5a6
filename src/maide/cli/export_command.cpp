// `maide export MODEL|SYSTEM --to FORMAT`: a model in another tool's language, or a whole system -
// its models and programs - as Promela, as `maide check` hands it to SPIN.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "maide/base/file.hpp"
#include "maide/check/promela_system.hpp"
#include "maide/check/system_file.hpp"
#include "maide/cli/command.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"

namespace maide::cli {

namespace {

struct ExportArguments {
  std::string source;
  std::string format;
  std::string output;
  bool lossy = false;
};

// What is written, and what --json tells of it.
struct Export {
  std::string text;
  std::string summary;
  Json details;
};

Export export_model(const ExportArguments& arguments, const Exporter& exporter) {
  const Model model = read_model(arguments.source);
  const std::filesystem::path named =
      arguments.output.empty() ? arguments.source : arguments.output;
  std::ostringstream text;
  exporter.write(text, model,
                 {named.stem().string(), arguments.lossy ? MarkLoss::accept : MarkLoss::refuse});
  std::size_t states = 0;
  std::size_t transitions = 0;
  if (const auto* machine = std::get_if<Mealy>(&model)) {
    states = machine->size();
    transitions = machine->size() * machine->inputs().size();
  } else if (const auto* other = std::get_if<NondeterministicMealy>(&model)) {
    states = other->size();
    transitions = other->transition_count();
  } else {
    const auto& automaton = std::get<InterfaceAutomaton>(model);
    states = automaton.size();
    transitions = automaton.transition_count();
  }
  return {std::move(text).str(), fmt::format("{} states, {} transitions", states, transitions),
          Json{{"states", states}, {"transitions", transitions}}};
}

bool is_system(const std::string& source) {
  const std::string extension = std::filesystem::path(source).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

// Deadlocks are the text's invalid end states; properties are not part of it.
Export export_system(const ExportArguments& arguments, const Exporter& exporter) {
  if (exporter.name != "promela") {
    throw UsageError(fmt::format("a system is exported to promela alone, not to {} ({})",
                                 exporter.name, arguments.source));
  }
  const System system = read_system(arguments.source);
  return {write_promela(system).text,
          fmt::format("{} models, {} programs", system.models.size(), system.programs.size()),
          Json{{"models", system.models.size()}, {"programs", system.programs.size()}}};
}

const Exporter& requested_exporter(const std::string& format) {
  if (format == "mcrl2") throw UsageError("export to mcrl2 is not built yet; aut is read by mCRL2");
  return find_exporter(format);
}

ExitStatus run_export(const ExportArguments& arguments, Context& context) {
  const Exporter& exporter = requested_exporter(arguments.format);
  const Export exported = is_system(arguments.source) ? export_system(arguments, exporter)
                                                      : export_model(arguments, exporter);
  Json result{{"source", arguments.source}, {"format", exporter.name}};
  result.update(exported.details);
  if (arguments.output.empty()) {
    context.print(exported.text);
    result["text"] = exported.text;
  } else {
    write_file_atomically(arguments.output, exported.text);
    context.print(fmt::format("{}: {}\n", arguments.output, exported.summary));
    result["output"] = arguments.output;
  }
  context.set_result(result);
  return ExitStatus::ok;
}

}  // namespace

RunFunction set_up_export(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  std::string formats;
  for (const Exporter& exporter : exporters()) {
    formats +=
        fmt::format("{}{} ({})", formats.empty() ? "" : "; ", exporter.name, exporter.summary);
  }
  app.add_option("SOURCE", arguments->source,
                 "A model file (.dot, .gv or .aut), or a system file (.yaml) for --to promela")
      ->required();
  app.add_option("--to", arguments->format, "The format: " + formats)->required();
  app.add_option("-o,--output", arguments->output,
                 "The file to write; standard output if not given");
  app.add_flag("--lossy", arguments->lossy,
               "Write a model to aut though that cannot carry what was never tried");
  return [arguments](Context& context) { return run_export(*arguments, context); };
}

}  // namespace maide::cli
