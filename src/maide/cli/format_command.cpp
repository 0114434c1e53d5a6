// `maide format SYSTEM.yaml`: lays out system files in one style, in place.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/tree/print.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"

namespace maide::cli {

namespace {

struct FormatArguments {
  std::vector<std::string> files;
  bool only_check = false;
};

// Whether the file is laid out in another way; it is written then, unless only that was asked.
bool format_file(const std::string& path, bool only_check) {
  const std::string before = read_regular_file(path);
  const std::string after = format_system(before, path);
  if (after == before) return false;
  if (!only_check) write_file_atomically(path, after);
  return true;
}

ExitStatus run_format(const FormatArguments& arguments, Context& context) {
  bool has_changes = false;
  std::optional<ExitStatus> failure;  // of the first file that failed; it stops no other
  Json list = Json::array();
  const auto fail = [&](const std::string& path, const Error& error, const std::string& excerpt) {
    const ExitStatus status = context.fail(error.what(), error.status(), excerpt);
    if (!failure) failure = status;
    list.push_back({{"file", path}, {"changed", false}, {"error", error.what()}});
  };
  for (const std::string& path : arguments.files) {
    bool is_changed = false;
    try {
      is_changed = format_file(path, arguments.only_check);
    } catch (const ParseError& error) {
      fail(path, error, source_excerpt(error.position()));
      continue;
    } catch (const Error& error) {
      fail(path, error, "");
      continue;
    }
    has_changes = has_changes || is_changed;
    list.push_back({{"file", path}, {"changed", is_changed}});
    if (!is_changed) continue;
    context.print(
        fmt::format("{} {}\n", path, arguments.only_check ? "would be laid out anew" : "laid out"));
  }
  context.set_result({{"files", list}});
  if (failure) return *failure;
  return arguments.only_check && has_changes ? ExitStatus::violated : ExitStatus::ok;
}

}  // namespace

RunFunction set_up_format(CommandLine& line) {
  auto arguments = std::make_shared<FormatArguments>();
  line.add("SYSTEM", arguments->files, "System files (YAML), rewritten in place").required();
  line.add_flag("--check", arguments->only_check,
                "Write nothing; exit with 1 if a file would change");
  return [arguments](Context& context) { return run_format(*arguments, context); };
}

}  // namespace maide::cli
