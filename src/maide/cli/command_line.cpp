// CLI11 reports an unknown option only after everything else has parsed; here names come first. By
// itself it takes "-1" for the greatest number there is, and what does not fit for what is nearest:
// every number has a check of ours.
#include "maide/cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <map>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/terminal.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide::cli {
namespace {

constexpr const char* name_of_choices = "choices";

bool is_number(const std::string& argument) {
  return argument.size() > 1 &&
         (std::isdigit(static_cast<unsigned char>(argument[1])) != 0 || argument[1] == '.');
}

// For commands that take options of a system: how the unknown option `typed[i]` is written if it is
// meant to be one, as "--depth 3" or "--depth=3" are.
std::string system_option_hint(const CLI::App& app, const std::vector<std::string>& typed,
                               std::size_t i) {
  if (app.get_option_no_throw("KEY=VALUE") == nullptr) return "";
  std::string option = typed[i].substr(2);
  if (option.find('=') == std::string::npos) {
    const bool has_value = i + 1 < typed.size() && !typed[i + 1].starts_with("-");
    option += "=" + (has_value ? typed[i + 1] : std::string("VALUE"));
  }
  return "; an option of the system is written " + option;
}

// CLI11's, without its class names and line breaks.
std::string readable_message(const CLI::ParseError& error) {
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  // "--seed: 1 required N missing" and "Could not convert: --seed = x" are the awkward ones.
  constexpr std::string_view conversion = "Could not convert: ";
  if (message.starts_with(conversion)) {
    message = "unusable value: " + message.substr(conversion.size());
  }
  // "--junit: 1 required FILE missing".
  const std::size_t missing = message.find(": 1 required ");
  if (missing != message.npos && message.ends_with(" missing")) {
    message = message.substr(0, missing) + " needs a value";
  }
  constexpr std::string_view extras = "The following argument was not expected: ";
  if (message.starts_with(extras)) {
    message = "unexpected argument '" + message.substr(extras.size()) + "'";
  }
  return message;
}

std::string check_whole_number(const std::string& text, std::uint64_t least, std::uint64_t most) {
  const auto number = parse_number<std::uint64_t>(text);
  if (number && *number >= least && *number <= most) return "";
  return "'" + text + "' is not a whole number from " + std::to_string(least) + " to " +
         std::to_string(most);
}

std::string check_count(const std::string& text) {
  return check_whole_number(text, 0, ~std::uint64_t{0});
}

}  // namespace

Argument& Argument::required() {
  option_->required();
  return *this;
}

Argument& Argument::check(const ArgumentCheck& check) {
  // In front of those that are there already: what it says fits better.
  option_->transform(CLI::Validator([check](std::string& text) { return check(text); }, ""));
  return *this;
}

Argument& Argument::one_of(std::vector<std::string> names) {
  // Not check(): it would stand in front of one that says it better.
  offer(names);
  option_->check(CLI::Validator(
      [names = std::move(names)](std::string& text) { return check_one_of(text, names); }, ""));
  return *this;
}

// They are kept as the description of a check that refuses nothing.
Argument& Argument::offer(const std::vector<std::string>& names) {
  option_->check(CLI::Validator([](std::string&) { return std::string(); }, join(names, " "),
                                name_of_choices));
  return *this;
}

std::vector<std::string> Argument::choices() const {
  try {
    return split_shell_words(option_->get_validator(name_of_choices)->get_description());
  } catch (const CLI::OptionNotFound&) {
    return {};
  }
}

Argument& Argument::between(std::uint64_t least, std::uint64_t most) {
  return check(
      [least, most](const std::string& text) { return check_whole_number(text, least, most); });
}

Argument& Argument::number_between(double least, double most) {
  return check([least, most](const std::string& text) {
    const auto number = parse_number<double>(text);
    if (number && *number >= least && *number <= most) return std::string();
    return fmt::format("'{}' is not a number from {} to {}", text, least, most);
  });
}

Argument& Argument::no_default() {
  option_->default_str("");
  return *this;
}

Argument& Argument::value_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Argument& Argument::one_each() {
  option_->allow_extra_args(false);
  return *this;
}

Argument& Argument::topic(const std::string& topic) {
  option_->group(topic);
  return *this;
}

std::string Argument::topic() const {
  return option_->get_group() == "Options" || is_positional() ? "" : option_->get_group();
}

std::string Argument::synopsis() const {
  if (is_positional()) return name() + (option_->get_expected_max() > 1 ? "..." : "");
  std::string text;
  for (const std::string& name : short_names()) text += (text.empty() ? "-" : ", -") + name;
  for (const std::string& name : long_names()) text += (text.empty() ? "--" : ", --") + name;
  if (!takes_value()) return text;
  text += " " + value_name();
  const std::string initial = option_->get_default_str();
  return text + (initial.empty() || initial == "[]" ? "" : "=" + initial);
}

std::string Argument::value_name() const {
  if (!takes_value()) return "";
  const std::string type = option_->get_type_name();
  const std::string kind = type.substr(0, type.find(':'));
  return kind == "UINT" ? "N" : kind == "FLOAT" ? "X" : kind;
}

std::string Argument::name() const { return option_->get_name(); }
std::vector<std::string> Argument::long_names() const { return option_->get_lnames(); }
std::vector<std::string> Argument::short_names() const { return option_->get_snames(); }
std::string Argument::help() const { return option_->get_description(); }
bool Argument::is_positional() const { return option_->get_positional(); }
bool Argument::is_required() const { return option_->get_required(); }
bool Argument::takes_value() const { return option_->get_expected_max() != 0; }
bool Argument::is_given() const { return option_->count() > 0; }
std::vector<std::string> Argument::values() const { return option_->results(); }

CommandLine::CommandLine(const std::string& command, const std::string& summary)
    : app_(std::make_unique<CLI::App>(summary, command)) {
  app_->option_defaults()->always_capture_default();
  app_->set_help_flag("-h,--help", "Print this help and exit");
}

CommandLine::~CommandLine() = default;

Argument CommandLine::add(const std::string& names, std::string& value, const std::string& help) {
  return Argument(app_->add_option(names, value, help));
}

Argument CommandLine::add(const std::string& names, std::vector<std::string>& value,
                          const std::string& help) {
  return Argument(app_->add_option(names, value, help));
}

Argument CommandLine::add(const std::string& names, std::uint32_t& value, const std::string& help) {
  return Argument(app_->add_option(names, value, help)).between(0, ~std::uint32_t{0});
}

Argument CommandLine::add(const std::string& names, std::uint64_t& value, const std::string& help) {
  return Argument(app_->add_option(names, value, help)->check(check_count));
}

Argument CommandLine::add(const std::string& names, std::optional<std::uint64_t>& value,
                          const std::string& help) {
  return Argument(app_->add_option(names, value, help)->check(check_count));
}

Argument CommandLine::add(const std::string& names, double& value, const std::string& help) {
  return Argument(app_->add_option(names, value, help));
}

Argument CommandLine::add(const std::string& names, std::optional<double>& value,
                          const std::string& help) {
  return Argument(app_->add_option(names, value, help));
}

Argument CommandLine::add_flag(const std::string& names, bool& value, const std::string& help) {
  return Argument(app_->add_flag(names, value, help));
}

std::vector<Argument> CommandLine::all() const {
  std::vector<Argument> list;
  for (CLI::Option* option : app_->get_options({})) list.emplace_back(option);
  return list;
}

void CommandLine::set_footer(const std::string& text) { footer_ = text; }

namespace {

std::string usage(const std::string& command, const std::vector<Argument>& arguments) {
  std::string text = "Usage: " + command + " [OPTIONS]";
  for (const Argument& argument : arguments) {
    if (!argument.is_positional()) continue;
    text += argument.is_required() ? " " + argument.synopsis() : " [" + argument.synopsis() + "]";
  }
  return text + "\n";
}

// A paragraph for each topic: the options that it tells of.
std::string name_topics(const std::vector<Argument>& arguments, std::size_t width) {
  std::map<std::string, std::string> options;
  for (const Argument& argument : arguments) {
    if (argument.topic().empty() || argument.topic() == CommandLine::shown_in_footer) continue;
    std::string& list = options[argument.topic()];
    list += (list.empty() ? "" : ", ") + argument.name();
  }
  std::string text;
  for (const auto& [topic, list] : options) {
    text += wrap("Options of " + topic + " ('maide help " + topic + "'): " + list, width, 2);
  }
  return text;
}

constexpr std::size_t widest_synopsis = 26;

}  // namespace

std::string CommandLine::help(std::size_t width, bool full) const {
  if (!full) {
    std::string text = help(width, true);
    const bool fits = static_cast<std::size_t>(std::ranges::count(text, '\n')) <= most_help_lines;
    if (fits) return text;
  }
  std::vector<TextRow> rows;
  const std::vector<Argument> arguments = all();
  for (const bool is_positional : {true, false}) {
    for (const Argument& argument : arguments) {
      if (argument.is_positional() != is_positional || !argument.topic().empty()) continue;
      rows.emplace_back(argument.synopsis(),
                        full ? argument.help() : first_sentence(argument.help()));
    }
  }
  return wrap(app_->get_description(), width, 0) + usage(app_->get_name(), arguments) + "\n" +
         two_columns(rows, width, widest_synopsis) + name_topics(arguments, width) + footer_;
}

bool CommandLine::parse(const std::vector<std::string>& typed, const std::string& hint) {
  typed_ = typed;
  check_names(typed, hint);
  try {
    app_->parse(std::vector<std::string>(typed.rbegin(), typed.rend()));
  } catch (const CLI::CallForHelp&) {
    return false;
  } catch (const CLI::ParseError& error) {
    throw UsageError(readable_message(error) + hint);
  }
  check_values(hint);
  return true;
}

void CommandLine::check_names(const std::vector<std::string>& typed,
                              const std::string& hint) const {
  std::vector<std::string> names;
  for (const CLI::Option* option : std::as_const(*app_).get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  for (std::size_t i = 0; i < typed.size(); ++i) {
    const std::string& argument = typed[i];
    if (argument == "--") return;
    if (argument.size() < 2 || argument[0] != '-') continue;
    const bool is_long = argument[1] == '-';
    if (!is_long && is_number(argument)) continue;
    // "--name=value"; "-ovalue" and "-qv" begin with a short option.
    const std::string name =
        is_long ? argument.substr(0, argument.find('=')) : argument.substr(0, 2);
    if (app_->get_option_no_throw(name) != nullptr) continue;
    const std::string near = did_you_mean(is_long ? name : "-" + argument, names);
    throw UsageError("unknown option '" + (is_long ? name : argument) + "'" + near +
                     (is_long && near.empty() ? system_option_hint(*app_, typed, i) : "") + hint);
  }
}

void CommandLine::check_values(const std::string& hint) const {
  for (const Argument& argument : all()) {
    if (argument.is_positional()) continue;
    const std::vector<std::string> values = argument.values();
    if (std::ranges::find(values, "") == values.end()) continue;
    throw UsageError("the value of " + argument.name() + " is empty" + hint);
  }
}

std::string first_sentence(const std::string& text) {
  for (std::size_t at = text.find(". "); at != std::string::npos; at = text.find(". ", at + 1)) {
    if (at + 2 < text.size() && std::islower(static_cast<unsigned char>(text[at + 2])) == 0) {
      return text.substr(0, at);
    }
  }
  return text;
}

std::string check_one_of(const std::string& text, const std::vector<std::string>& names) {
  if (text.empty()) return "";  // check_values() says so
  if (std::ranges::find(names, text) != names.end()) return "";
  constexpr std::size_t short_list = 40;
  const std::string near = did_you_mean(text, names), list = join(names);
  return near.empty() || list.size() <= short_list ? "'" + text + "' is none of " + list + near
                                                   : "unknown name '" + text + "'" + near;
}

std::string check_jobs(const std::string& text) { return check_whole_number(text, 1, most_jobs); }

std::string check_seconds(const std::string& text) {
  const auto seconds = parse_number<double>(text);
  if (seconds && *seconds >= 0.001 && *seconds <= 1e8) return "";
  return "'" + text + "' is not a number of seconds from 0.001 to 1e8";
}

}  // namespace maide::cli
