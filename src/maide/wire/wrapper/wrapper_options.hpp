// Options of a wrapper: a table with one row an option (key, default, what is allowed, help), and
// the values that a user gave for them, checked. In keys `-` and `_` are the same. Rows that
// several wrappers share are made here, so that they mean the same everywhere.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace maide {

// One row of a wrapper's table of options.
struct OptionSpec {
  enum class Kind : std::uint8_t {
    // One of `allowed`; a whole number between least and most too, if most >= least. An entry
    // "values:V,..." allows "values:" and a list.
    choice,
    list,     // some of `allowed`, separated by commas, none twice; may be empty if least is 0
    integer,  // a whole number between least and most, or one of `allowed`
    text,     // anything on one line
  };
  std::string key;
  Kind kind = Kind::text;
  std::string default_value;
  std::vector<std::string> allowed;
  std::int64_t least = 0, most = -1;
  std::string help;  // one line, no full stop
  // The value by which the system keeps more messages or loses fewer, or "+" for a number to raise.
  // "" if this option cannot do that. `maide check --suggest` tries these.
  std::string keeps_more{};

  static OptionSpec choice(std::string key, std::string default_value,
                           std::vector<std::string> allowed, std::string help);
  static OptionSpec list(std::string key, std::string default_value,
                         std::vector<std::string> allowed, std::string help);
  static OptionSpec integer(std::string key, std::int64_t default_value, std::int64_t least,
                            std::int64_t most, std::string help,
                            std::vector<std::string> allowed = {});
  static OptionSpec text(std::string key, std::string default_value, std::string help);

  // The same row with `keeps_more` set.
  OptionSpec keeping_more_with(std::string value) const;

  // "port|buffered|strict", "1..1000", "write,read,tryread", "text".
  std::string describe_allowed() const;
};

// The options that wrappers share. A wrapper puts those it supports into its table; the SDK acts on
// them (all but what they say of the system itself). `quiescence_rows` are in every table.
namespace common_options {
OptionSpec inputs(std::vector<std::string> allowed, std::string default_value = "write,read");
OptionSpec observe(std::vector<std::string> allowed, std::string default_value = "message");
OptionSpec payload();            // payload=none|gap|values:...
std::vector<OptionSpec> ends();  // writers=N, readers=N
// The rows, which are of both ends, and for each of them `pub-KEY` and `sub-KEY`, of one end alone.
std::vector<OptionSpec> with_each_end(std::vector<OptionSpec> rows);
OptionSpec size(std::int64_t default_value, std::int64_t most);  // size=N messages in flight
OptionSpec at_bound();                                           // at-bound=refuse|absorb
std::vector<OptionSpec> quiescence_rows(std::int64_t floor_ms);  // quiescence, floor, step-limit
}  // namespace common_options

// Two spellings of a key are the same option.
bool same_key(std::string_view left, std::string_view right);

// The effective values of a table: what was given, and defaults for the rest.
class OptionValues {
 public:
  OptionValues() = default;
  // Throws UsageError, one line: an unknown key (naming the known ones), a value that is not
  // allowed (naming what is).
  OptionValues(const std::vector<OptionSpec>& table,
               const std::map<std::string, std::string>& given);

  bool has(std::string_view key) const;  // the table has this option
  // The value of an option that the table has (std::logic_error otherwise: a wrapper's mistake).
  const std::string& text(std::string_view key) const;
  std::int64_t number(std::string_view key) const;
  std::vector<std::string> list(std::string_view key) const;
  bool is(std::string_view key, std::string_view value) const { return text(key) == value; }
  // Of an option in with_each_end(), the value of one end; `prefix` is "pub-" or "sub-".
  const std::string& of_end(const std::string& prefix, const std::string& key) const;
  // What stands behind "PREFIX:" in such a value of a choice, separated by commas; else nothing.
  std::vector<std::string> list_behind(std::string_view key, std::string_view prefix) const;

  // By the table's own spelling of the keys.
  const std::map<std::string, std::string>& all() const { return values_; }

 private:
  std::map<std::string, std::string> values_;
};

// What `--list-options` prints: one option a line, with its default, what is allowed and its help.
std::string to_string(const std::vector<OptionSpec>& table);

}  // namespace maide
