// What calls of libraries mean: tables in YAML (share/maide/api), each row with how it is known.
//
//   known: "read: rclcpp 16.0.11"
//   classes:
//     rclcpp::Publisher: {publish: publish, get_topic_name: inert std::string}
//   functions: {"rclcpp::ok": ok}
//   macros: {"RCLCPP_DISABLE_COPY(...)": ""}
//
// A row says what is done, and the class of what comes back. Rows go by the full name with its
// class: no bare name means anything.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace maide::extract {

struct ApiRow {
  std::string means;    // a word that the reader of calls knows
  std::string returns;  // a class; empty: a plain value
  std::string known;    // of the table
};

class ApiTable {
 public:
  // Throws UsageError and ParseError.
  void read(const std::filesystem::path& file);

  const ApiRow* find_function(const std::string& full_name) const;
  // Also of the classes that the table says it derives from (`is`).
  const ApiRow* find_method(const std::string& of_class, const std::string& name) const;
  // Macros of libraries: their `#define` lines, and their names.
  const std::string& macro_definitions() const { return macro_definitions_; }
  const std::set<std::string>& macro_names() const { return macro_names_; }
  bool has_class(const std::string& name) const { return classes_.contains(name); }
  // Names in whose absence code cannot communicate: of all rows that are not inert.
  const std::set<std::string>& active_names() const { return active_names_; }

 private:
  ApiRow make_row(const std::string& text, const std::string& known) const;
  std::map<std::string, ApiRow> functions_;
  std::map<std::string, std::map<std::string, ApiRow>> classes_;
  std::map<std::string, std::string> bases_;
  std::set<std::string> active_names_;
  std::string macro_definitions_;
  std::set<std::string> macro_names_;
};

// The tables that come with Maide.
std::vector<std::filesystem::path> own_api_tables();

}  // namespace maide::extract
