// `maide export MODEL --to FORMAT`: a model in another tool's language.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "maide/base/file.hpp"
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

struct Size {
  std::size_t states = 0;
  std::size_t transitions = 0;
};

Size size_of(const Model& model) {
  if (const auto* machine = std::get_if<Mealy>(&model)) {
    return {machine->size(), machine->size() * machine->inputs().size()};
  }
  const auto& automaton = std::get<InterfaceAutomaton>(model);
  return {automaton.size(), automaton.transition_count()};
}

const Exporter& requested_exporter(const std::string& format) {
  if (format == "mcrl2") throw UsageError("export to mcrl2 is not built yet; aut is read by mCRL2");
  return find_exporter(format);
}

ExitStatus run_export(const ExportArguments& arguments, Context& context) {
  const Exporter& exporter = requested_exporter(arguments.format);
  const Model model = read_model(arguments.source);
  const std::filesystem::path named =
      arguments.output.empty() ? arguments.source : arguments.output;
  std::ostringstream text;
  exporter.write(text, model,
                 {named.stem().string(), arguments.lossy ? MarkLoss::accept : MarkLoss::refuse});
  const Size size = size_of(model);
  Json result{{"source", arguments.source},
              {"format", exporter.name},
              {"states", size.states},
              {"transitions", size.transitions}};
  if (arguments.output.empty()) {
    context.print(text.str());
    result["text"] = text.str();
  } else {
    write_file_atomically(arguments.output, text.str());
    context.print(fmt::format("{}: {} states, {} transitions\n", arguments.output, size.states,
                              size.transitions));
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
  app.add_option("MODEL", arguments->source, "A model file (.dot, .gv or .aut)")->required();
  app.add_option("--to", arguments->format, "The format: " + formats)->required();
  app.add_option("-o,--output", arguments->output,
                 "The file to write; standard output if not given");
  app.add_flag("--lossy", arguments->lossy,
               "Write a model to aut though that cannot carry what was never tried");
  return [arguments](Context& context) { return run_export(*arguments, context); };
}

}  // namespace maide::cli
