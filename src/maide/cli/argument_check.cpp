// CLI11 reports an unknown option only after everything else has parsed; here names come first.
#include "maide/cli/argument_check.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdint>

#include "maide/base/error.hpp"
#include "maide/base/parse_number.hpp"
#include "maide/base/suggest.hpp"
#include "maide/workflow/open_system.hpp"

namespace maide::cli {

namespace {

bool is_known(const CLI::App& app, const std::string& name) {
  return app.get_option_no_throw(name) != nullptr;
}

bool is_number(const std::string& argument) {
  return argument.size() > 1 &&
         (std::isdigit(static_cast<unsigned char>(argument[1])) != 0 || argument[1] == '.');
}

// For commands that take options of a system: how the unknown option `arguments[i]` is written if
// it is meant to be one, as "--depth 3" or "--depth=3" are.
std::string system_option_hint(const CLI::App& app, const std::vector<std::string>& arguments,
                               std::size_t i) {
  if (app.get_option_no_throw("KEY=VALUE") == nullptr) return "";
  std::string option = arguments[i].substr(2);
  if (option.find('=') == std::string::npos) {
    const bool has_value = i + 1 < arguments.size() && !arguments[i + 1].starts_with("-");
    option += "=" + (has_value ? arguments[i + 1] : std::string("VALUE"));
  }
  return "; an option of the system is written " + option;
}

}  // namespace

void check_option_names(const CLI::App& app, const std::vector<std::string>& arguments,
                        const std::string& hint) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "--") return;
    if (argument.size() < 2 || argument[0] != '-') continue;
    const bool is_long = argument[1] == '-';
    if (!is_long && is_number(argument)) continue;
    // "--name=value"; "-ovalue" and "-qv" begin with a short option.
    const std::string name =
        is_long ? argument.substr(0, argument.find('=')) : argument.substr(0, 2);
    if (is_known(app, name)) continue;
    throw UsageError("unknown option '" + (is_long ? name : argument) + "'" +
                     did_you_mean(is_long ? name : "-" + argument, names) +
                     (is_long ? system_option_hint(app, arguments, i) : "") + hint);
  }
}

void check_values(const CLI::App& app, const std::string& hint) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) continue;
    const std::vector<std::string>& values = option->results();
    if (std::find(values.begin(), values.end(), "") == values.end()) continue;
    throw UsageError("the value of " + option->get_name() + " is empty" + hint);
  }
}

std::string check_count(const std::string& text) {
  if (parse_number<std::uint64_t>(text)) return "";
  return "'" + text + "' is not a whole number from 0 to 18446744073709551615";
}

std::string check_jobs(const std::string& text) {
  const auto number = parse_number<std::size_t>(text);
  if (number && *number >= 1 && *number <= most_jobs) return "";
  return "'" + text + "' is not a whole number from 1 to " + std::to_string(most_jobs);
}

std::string check_seconds(const std::string& text) {
  const auto seconds = parse_number<double>(text);
  if (seconds && *seconds >= 0.001 && *seconds <= 1e8) return "";
  return "'" + text + "' is not a number of seconds from 0.001 to 1e8";
}

std::string readable_message(const CLI::ParseError& error) {
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  // "--seed: 1 required N missing" and "Could not convert: --seed = x" are the awkward ones.
  constexpr std::string_view conversion = "Could not convert: ";
  if (message.starts_with(conversion)) {
    message = "unusable value: " + message.substr(conversion.size());
  }
  constexpr std::string_view extras = "The following argument was not expected: ";
  if (message.starts_with(extras)) {
    message = "unexpected argument '" + message.substr(extras.size()) + "'";
  }
  return message;
}

}  // namespace maide::cli
