// What a command takes: declared once in its set_up function, and asked later for what was given.
// The one place that knows CLI11, which is large to compile: everything else of the command line
// includes this header.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace maide::cli {

// "" for a text that will do, else what is wrong with it.
using ArgumentCheck = std::function<std::string(const std::string& text)>;

// An option or argument that was declared; valid as long as its CommandLine are.
class Argument {
 public:
  explicit Argument(CLI::Option* option) : option_(option) {}

  Argument& required();
  Argument& check(const ArgumentCheck& check);
  // One of these; a name that is near is suggested for any other.
  Argument& one_of(std::vector<std::string> names);
  // A shell offers these; what else is typed is checked elsewhere.
  Argument& offer(const std::vector<std::string>& names);
  // A whole number in this range, ends included.
  Argument& between(std::uint64_t least, std::uint64_t most);
  // A number in this range, ends included.
  Argument& number_between(double least, double most);
  // The help names no default: the help text says it, or there is none.
  Argument& no_default();
  // In the help, instead of the value's type: "MIB".
  Argument& value_name(const std::string& name);
  // Of several values each stands behind the name of its own: `--property a --property b`.
  Argument& one_each();
  // `maide help TOPIC` tells of it in place of the command's help, which names it.
  Argument& topic(const std::string& topic);

  std::string name() const;                                          // "--output", "SUL"
  std::vector<std::string> long_names() const, short_names() const;  // without dashes
  std::string help() const;
  std::string topic() const;     // "" for none
  std::string synopsis() const;  // as in the help: "-o, --output FILE", "KEY=VALUE..."
  bool is_positional() const;    // has no dashes
  bool is_required() const;
  bool takes_value() const;  // is no flag
  bool is_given() const;
  std::vector<std::string> values() const;   // as typed
  std::vector<std::string> choices() const;  // of one_of() or offer()
  std::string value_name() const;            // "MIB"; "" of a flag

 private:
  CLI::Option* option_;
};

class CommandLine {
 public:
  // `command`: as typed, "maide learn".
  CommandLine(const std::string& command, const std::string& summary);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // Declares an option, "-o,--output", or an argument, "FILE". `value` holds the default; it must
  // live until parse(). Numbers are checked: "-1", and what does not fit, are refused.
  Argument add(const std::string& names, std::string& value, const std::string& help);
  Argument add(const std::string& names, std::vector<std::string>& value, const std::string& help);
  Argument add(const std::string& names, std::uint32_t& value, const std::string& help);
  Argument add(const std::string& names, std::uint64_t& value, const std::string& help);
  Argument add(const std::string& names, std::optional<std::uint64_t>& value,
               const std::string& help);
  Argument add(const std::string& names, double& value, const std::string& help);
  Argument add(const std::string& names, std::optional<double>& value, const std::string& help);
  // An option without a value.
  Argument add_flag(const std::string& names, bool& value, const std::string& help);

  // All that were declared, in order.
  std::vector<Argument> all() const;

  // The topic of options that the footer tells of.
  static constexpr const char* shown_in_footer = "all commands";
  // Behind the options in the help.
  void set_footer(const std::string& text);
  // For a person, in at most `most_help_lines` lines: if they do not take all that the options'
  // helps say, the first sentence of each. `full`: all, in as many lines as it takes.
  static constexpr std::size_t most_help_lines = 50;
  std::string help(std::size_t width, bool full) const;

  // Parses the words behind the command. False: help was asked for. Throws UsageError, with `hint`
  // at its end, for an unknown option (naming the nearest), and for what the checks refuse. An
  // empty value is refused, too: a variable of a script that is not set.
  bool parse(const std::vector<std::string>& typed, const std::string& hint);
  // What was parsed.
  const std::vector<std::string>& typed() const { return typed_; }

 private:
  void check_names(const std::vector<std::string>& typed, const std::string& hint) const;
  void check_values(const std::string& hint) const;

  std::unique_ptr<CLI::App> app_;
  std::string footer_;
  std::vector<std::string> typed_;
};

// The names of a table's rows.
template <typename Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& row : table) names.emplace_back(row.name);
  return names;
}

// The first sentence of a help text: up to the first full stop that another sentence follows.
std::string first_sentence(const std::string& text);

// Checks that several commands need.
// "'x' is none of a, b; did you mean 'a'?", or "" if it is one of them.
std::string check_one_of(const std::string& text, const std::vector<std::string>& names);
std::string check_jobs(const std::string& text);     // from 1 to most_jobs
std::string check_seconds(const std::string& text);  // from 0.001 to 1e8 (three years)

}  // namespace maide::cli
