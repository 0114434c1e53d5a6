// `maide extract`: a system file from C++ sources of ROS 2 nodes, and what was not understood.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/source_arguments.hpp"
#include "maide/extract/extract.hpp"

namespace maide::cli {

namespace {

// Each hole by itself, under its line of source.
std::string explain_holes(const extract::Extracted& found) {
  std::string text;
  for (const extract::Hole& hole : found.holes) {
    text += fmt::format("  {}: {}\n", to_string(hole.place), hole.text);
    const auto line = found.lines.find(hole.place);
    if (line != found.lines.end()) text += "      " + line->second + "\n";
    text += hole.is_placed ? "      the run is cut there\n"
                           : "      nowhere in the file: nothing \"holds\"\n";
  }
  return text;
}

struct ExtractArguments {
  std::vector<std::string> sources;
  std::string output;
  bool explains = false;
  SourceArguments options;
};

ExitStatus run_extract(const ExtractArguments& arguments, Context& context) {
  const extract::Extracted found = extract_sources(arguments.sources, arguments.options, context);
  if (arguments.output.empty()) {
    context.print_data(found.system);
  } else {
    write_file_atomically(arguments.output, found.system);
    std::filesystem::path beside = arguments.output;
    beside.replace_extension(".holes.yaml");
    write_file_atomically(beside.string(), found.holes_file.empty() ? "[]\n" : found.holes_file);
    std::string text =
        fmt::format("{}: {} from {}, {}\n", arguments.output, counted(found.nodes, "node"),
                    counted(found.files, "file"), counted(found.holes.size(), "hole"));
    text += arguments.explains ? explain_holes(found) : describe_holes(found);
    text += describe_assumptions(found);
    context.print(text);
  }
  context.set_result({{"system", found.system},
                      {"nodes", found.nodes},
                      {"files", found.files},
                      {"holes", holes_to_json(found)},
                      {"assumptions", found.assumptions}});
  return found.is_whole() ? ExitStatus::ok : ExitStatus::inconclusive;
}

}  // namespace

RunFunction set_up_extract(CommandLine& line) {
  auto arguments = std::make_shared<ExtractArguments>();
  line.add("SOURCE", arguments->sources, "C++ sources, or folders of them").required();
  line.add("-o,--output", arguments->output,
           "Write the system file there, and the holes beside it (default: print it)")
      .no_default();
  line.add_flag("--explain", arguments->explains,
                "Beside -o: each hole with its line of source, and whether it has a place");
  add_reading_options(line, arguments->options);
  add_source_options(line, arguments->options);
  return [arguments](Context& context) { return run_extract(*arguments, context); };
}

}  // namespace maide::cli
