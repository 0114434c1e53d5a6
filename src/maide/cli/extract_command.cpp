// `maide extract`: a system file from C++ sources of ROS 2 nodes, and what was not understood.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/extract/extract.hpp"

namespace maide::cli {

namespace {

struct ExtractArguments {
  std::vector<std::string> sources;
  std::string output, executor, assume;
  std::vector<std::string> includes, tables;
  bool is_closed = false;
};

extract::ExtractOptions options_of(const ExtractArguments& arguments) {
  extract::ExtractOptions options;
  options.front_end.include_folders = arguments.includes;
  options.tables = arguments.tables;
  options.is_closed = arguments.is_closed;
  options.executor = arguments.executor;
  for (const std::string_view word : split(arguments.assume, ',')) {
    if (word == "ok")
      options.assumes_ok = true;
    else if (word == "exceptions")
      options.assumes_exceptions = true;
    else if (!word.empty()) {
      throw UsageError("--assume takes ok and exceptions, not '" + std::string(word) + "'");
    }
  }
  if (!options.executor.empty() && options.executor != "single" &&
      (!options.executor.starts_with("multi:") || options.executor.size() != 7 ||
       options.executor[6] < '1' || options.executor[6] > '8')) {
    throw UsageError("--executor is single or multi:N, N from 1 to 8");
  }
  return options;
}

ExitStatus run_extract(const ExtractArguments& arguments, Context& context) {
  const extract::Extracted found =
      extract::extract_system(arguments.sources, options_of(arguments), context.control());
  const auto holes = static_cast<std::size_t>(found.holes.size());
  std::string text;
  if (arguments.output.empty()) {
    context.print_data(found.system);
  } else {
    write_file_atomically(arguments.output, found.system);
    std::filesystem::path beside = arguments.output;
    beside.replace_extension(".holes.yaml");
    write_file_atomically(beside.string(), found.holes_file.empty() ? "[]\n" : found.holes_file);
    text = fmt::format("{}: {} from {}, {}\n", arguments.output, counted(found.nodes, "node"),
                       counted(found.files, "file"), counted(holes, "hole"));
    for (const extract::Hole& hole : found.holes) {
      text += fmt::format("  {}: {}{}\n", to_string(hole.place), hole.text,
                          hole.is_placed ? "" : " (nowhere in the file)");
    }
    for (const std::string& assumption : found.assumptions) {
      text += "  taken for granted: " + assumption + "\n";
    }
    context.print(text);
  }
  Json list = Json::array();
  for (const extract::Hole& hole : found.holes) {
    list.push_back({{"text", hole.text},
                    {"file", hole.place.file},
                    {"line", hole.place.line},
                    {"placed", hole.is_placed}});
  }
  context.set_result(
      {{"system", found.system}, {"holes", list}, {"assumptions", found.assumptions}});
  return found.is_whole() ? ExitStatus::ok : ExitStatus::inconclusive;
}

}  // namespace

RunFunction set_up_extract(CommandLine& line) {
  auto arguments = std::make_shared<ExtractArguments>();
  line.add("SOURCE", arguments->sources, "C++ sources, or folders of them").required();
  line.add("-o,--output", arguments->output,
           "Write the system file there, and the holes beside it (default: print it)")
      .no_default();
  line.add("-I,--include", arguments->includes, "Look for headers in this folder").no_default();
  line.add("--api", arguments->tables, "Read this table of an API, too").no_default();
  line.add("--executor", arguments->executor,
           "What runs nodes of which nothing tells: single or multi:N")
      .no_default();
  line.add("--assume", arguments->assume,
           "Take for granted: ok (rclcpp::ok() is true), exceptions (none is thrown)")
      .no_default();
  line.add_flag("--closed", arguments->is_closed, "Nobody else writes or asks");
  return [arguments](Context& context) { return run_extract(*arguments, context); };
}

}  // namespace maide::cli
