#include "maide/extract/api_table.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/check/text/yaml_node.hpp"
#include "maide/extract/type_names.hpp"

namespace maide::extract {

ApiRow ApiTable::make_row(const std::string& text, const std::string& known) const {
  const std::size_t blank = text.find(' ');
  ApiRow row;
  row.means = text.substr(0, blank);
  if (blank != std::string::npos) row.returns = text.substr(blank + 1);
  row.known = known;
  return row;
}

void ApiTable::read(const std::filesystem::path& file) {
  const YamlDocument document = read_yaml(read_file(file), file.string(), "a table of an API");
  const YamlNode* known = document.root.find("known");
  if (known == nullptr || !known->is_scalar()) {
    throw ParseError("a table says how it is known ('known:')", document.position(document.root));
  }
  const auto rows = [&](const YamlNode& map, auto&& add) {
    for (const YamlEntry& entry : map.entries) {
      if (!entry.value.is_scalar()) {
        throw ParseError("a row is a word and a class", document.position(entry.value));
      }
      add(entry.key.value, make_row(entry.value.value, known->value));
    }
  };
  if (const YamlNode* functions = document.root.find("functions")) {
    rows(*functions, [&](const std::string& name, const ApiRow& row) {
      functions_[name] = row;
      if (row.means != "inert") active_names_.insert(last_part(name));
    });
  }
  if (const YamlNode* macros = document.root.find("macros")) {
    for (const YamlEntry& entry : macros->entries) {
      macro_definitions_ += "#define " + entry.key.value + " " + entry.value.value + "\n";
      macro_names_.insert(entry.key.value.substr(0, entry.key.value.find('(')));
    }
  }
  const YamlNode* classes = document.root.find("classes");
  if (classes == nullptr) return;
  for (const YamlEntry& entry : classes->entries) {
    auto& methods = classes_[entry.key.value];
    rows(entry.value, [&](const std::string& name, const ApiRow& row) {
      if (name == "is") {
        bases_[entry.key.value] = row.means;
        return;
      }
      methods[name] = row;
      if (row.means != "inert") active_names_.insert(name);
    });
  }
}

const ApiRow* ApiTable::find_function(const std::string& full_name) const {
  const auto found = functions_.find(full_name);
  return found == functions_.end() ? nullptr : &found->second;
}

const ApiRow* ApiTable::find_method(const std::string& of_class, const std::string& name) const {
  const auto found = classes_.find(of_class);
  if (found != classes_.end()) {
    const auto row = found->second.find(name);
    if (row != found->second.end()) return &row->second;
  }
  const auto base = bases_.find(of_class);
  return base == bases_.end() ? nullptr : find_method(base->second, name);
}

std::vector<std::filesystem::path> own_api_tables() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  for (fs::path folder = program.parent_path(); folder.has_relative_path();
       folder = folder.parent_path()) {
    const fs::path tables = folder / "share" / "maide" / "api";
    if (!fs::is_directory(tables, error)) continue;
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(tables)) {
      if (entry.path().extension() == ".yaml") files.push_back(entry.path());
    }
    std::ranges::sort(files);
    return files;
  }
  throw UsageError("the tables of APIs are not there (share/maide/api beside bin/maide)");
}

}  // namespace maide::extract
