#include "maide/cli/source_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"

namespace maide::cli {

namespace {

extract::ExtractOptions extract_options(const SourceArguments& arguments) {
  extract::ExtractOptions options;
  options.front_end.include_folders = arguments.includes;
  options.tables = arguments.tables;
  options.is_closed = arguments.is_closed;
  options.executor = arguments.executor;
  options.most_holes = arguments.most_holes;
  for (const std::string_view word : split(arguments.assume, ',')) {
    if (word == "ok") {
      options.assumes_ok = true;
    } else if (word == "exceptions") {
      options.assumes_exceptions = true;
    } else if (word == "read") {
      options.assumes_read = true;
    } else if (!word.empty()) {
      throw UsageError("--assume takes ok, exceptions and read, not '" + std::string(word) + "'");
    }
  }
  const bool is_multi = options.executor.starts_with("multi:") && options.executor.size() == 7 &&
                        options.executor[6] >= '1' && options.executor[6] <= '8';
  if (!options.executor.empty() && options.executor != "single" && !is_multi) {
    throw UsageError("--executor is single or multi:N, N from 1 to 8");
  }
  return options;
}

}  // namespace

void add_source_options(CommandLine& line, SourceArguments& arguments) {
  line.add("--executor", arguments.executor, "Of sources: what runs nodes: single or multi:N")
      .no_default();
  line.add("--assume", arguments.assume, "Of sources: ok, exceptions (none), read (all)")
      .no_default();
  line.add_flag("--closed", arguments.is_closed, "Of sources: nobody else writes or asks");
}

void add_reading_options(CommandLine& line, SourceArguments& arguments) {
  line.add("-I,--include", arguments.includes, "Look for headers in this folder, too").no_default();
  line.add("--api", arguments.tables, "Read this table of an API, too").no_default();
}

extract::Extracted extract_sources(const std::vector<std::string>& sources,
                                   const SourceArguments& arguments, Context& context) {
  extract::ExtractOptions options = extract_options(arguments);
  constexpr std::size_t many = 20;
  options.front_end.progress = [](std::size_t done, std::size_t of, const std::string& file) {
    if (of >= many && done % many == 0) log_note(fmt::format("{} of {}: {}", done, of, file));
  };
  return extract::extract_system(sources, options, context.control());
}

bool names_sources(const std::string& argument) {
  static constexpr std::string_view endings[] = {".cpp", ".cc", ".cxx", ".C"};
  if (std::filesystem::is_directory(argument)) return true;
  const std::string ending = std::filesystem::path(argument).extension().string();
  return std::ranges::find(endings, ending) != std::end(endings);
}

std::string describe_holes(const extract::Extracted& found) {
  std::map<std::string, std::vector<const extract::Hole*>> kinds;
  for (const extract::Hole& hole : found.holes) kinds[hole.text].push_back(&hole);
  std::vector<std::pair<std::string, std::vector<const extract::Hole*>>> sorted(kinds.begin(),
                                                                                kinds.end());
  std::ranges::stable_sort(
      sorted, [](const auto& a, const auto& b) { return a.second.size() > b.second.size(); });
  std::string text;
  for (const auto& [kind, holes] : sorted) {
    const std::string others =
        holes.size() == 1 ? "" : fmt::format(", and {} more", holes.size() - 1);
    const bool has_name = kind.starts_with("a call of ") || kind.starts_with("an object of ");
    text += fmt::format("  {}: {}{}{}\n", to_string(holes.front()->place), kind, others,
                        has_name ? " (a row of a table closes it)" : "");
  }
  return text;
}

std::string describe_assumptions(const extract::Extracted& found) {
  std::string text;
  for (const std::string& assumption : found.assumptions) {
    text += "  taken for granted: " + assumption + " (--assume)\n";
  }
  for (const std::string& note : found.notes) text += "  taken for granted: " + note + "\n";
  return text;
}

Json holes_to_json(const extract::Extracted& found) {
  Json list = Json::array();
  for (const extract::Hole& hole : found.holes) {
    list.push_back({{"text", hole.text},
                    {"file", hole.place.file},
                    {"line", hole.place.line},
                    {"placed", hole.is_placed}});
  }
  return list;
}

}  // namespace maide::cli
