// The folders are computed for each call: PATH may change, and calls are rare.
#include "maide/workflow/wrapper_search.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <string>
#include <system_error>

#include "maide/base/join.hpp"

namespace maide {

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
  std::string_view rest = path != nullptr ? path : "/usr/local/bin:/usr/bin:/bin";
  while (!rest.empty()) {
    const std::size_t colon = std::min(rest.find(':'), rest.size());
    // An empty element means the current folder; programs are not taken from there unasked.
    if (colon > 0) folders.emplace_back(rest.substr(0, colon));
    rest.remove_prefix(std::min(colon + 1, rest.size()));
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

std::vector<fs::path> search_folders() {
  std::vector<fs::path> folders = own_folders();
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
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

}  // namespace

std::optional<fs::path> find_wrapper(std::string_view name) {
  if (!is_wrapper_name(name)) return std::nullopt;
  return find_program(std::string(wrapper_prefix) + std::string(name), search_folders());
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

}  // namespace maide
