#include "maide/wire/wrapper/wrapper_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

// The value of `pub-KEY` and `sub-KEY` that stands for the value of KEY.
constexpr const char* both_ends = "both";

std::string normalised(std::string_view key) {
  std::string text(key);
  std::replace(text.begin(), text.end(), '_', '-');
  return text;
}

std::vector<std::string> split_list(std::string_view text) {
  if (text.empty()) return {};
  const std::vector<std::string_view> items = split(text, ',');
  return {items.begin(), items.end()};
}

bool is_one_of(std::string_view value, const std::vector<std::string>& allowed) {
  return std::ranges::find(allowed, value) != allowed.end();
}

// "values:a,b", where "values:V,..." is allowed: words of letters, digits, `_` and `-`.
bool is_allowed_list(std::string_view value, const OptionSpec& spec) {
  constexpr std::string_view any = "V,...";
  constexpr std::string_view characters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  for (const std::string& allowed : spec.allowed) {
    if (!allowed.ends_with(any)) continue;
    const std::string_view prefix =
        std::string_view(allowed).substr(0, allowed.size() - any.size());
    if (!value.starts_with(prefix)) continue;
    std::set<std::string> seen;
    for (const std::string& item : split_list(value.substr(prefix.size()))) {
      if (item.empty() || item.find_first_not_of(characters) != std::string::npos) return false;
      if (!seen.insert(item).second) return false;
    }
    return !seen.empty();
  }
  return false;
}

bool is_in_range(std::string_view value, const OptionSpec& spec) {
  if (spec.most < spec.least) return false;
  const auto number = parse_number<std::int64_t>(value);
  return number && *number >= spec.least && *number <= spec.most;
}

// Quality of service by the clock, which no wrapper has.
bool is_of_time(std::string_view key) {
  const bool is_of_end = key.starts_with("pub-") || key.starts_with("sub-");
  return is_one_of(is_of_end ? key.substr(4) : key,
                   {"deadline", "lifespan", "liveliness", "latency-budget", "lease"});
}

[[noreturn]] void reject(const OptionSpec& spec, std::string_view value, std::string_view why) {
  throw UsageError(fmt::format("option {}={}: {}", spec.key, value, why));
}

void check_list(const OptionSpec& spec, std::string_view value) {
  const std::vector<std::string> items = split_list(value);
  if (items.empty() && spec.least > 0) reject(spec, value, "name at least one");
  std::set<std::string> seen;
  for (const std::string& item : items) {
    if (!is_one_of(item, spec.allowed)) {
      reject(spec, value,
             fmt::format("'{}' is not one of {}{}", item, fmt::join(spec.allowed, ","),
                         did_you_mean(item, spec.allowed)));
    }
    if (!seen.insert(item).second) reject(spec, value, fmt::format("'{}' comes twice", item));
  }
}

void check_value(const OptionSpec& spec, std::string_view value) {
  switch (spec.kind) {
    case OptionSpec::Kind::choice:
    case OptionSpec::Kind::integer:
      if (!is_one_of(value, spec.allowed) && !is_in_range(value, spec) &&
          !is_allowed_list(value, spec)) {
        reject(spec, value,
               "allowed is " + spec.describe_allowed() + did_you_mean(value, spec.allowed));
      }
      return;
    case OptionSpec::Kind::list: check_list(spec, value); return;
    case OptionSpec::Kind::text:
      if (value.find_first_of("\r\n") != std::string_view::npos) reject(spec, "...", "one line");
      return;
  }
}

}  // namespace

OptionSpec OptionSpec::choice(std::string key, std::string default_value,
                              std::vector<std::string> allowed, std::string help) {
  return {std::move(key), Kind::choice, std::move(default_value), std::move(allowed), 0, -1,
          std::move(help)};
}

OptionSpec OptionSpec::list(std::string key, std::string default_value,
                            std::vector<std::string> allowed, std::string help) {
  return {std::move(key), Kind::list, std::move(default_value), std::move(allowed), 0, -1,
          std::move(help)};
}

OptionSpec OptionSpec::integer(std::string key, std::int64_t default_value, std::int64_t least,
                               std::int64_t most, std::string help,
                               std::vector<std::string> allowed) {
  return {std::move(key), Kind::integer,  std::to_string(default_value), std::move(allowed), least,
          most,           std::move(help)};
}

OptionSpec OptionSpec::text(std::string key, std::string default_value, std::string help) {
  return {std::move(key), Kind::text, std::move(default_value), {}, 0, -1, std::move(help)};
}

OptionSpec OptionSpec::keeping_more_with(std::string value) const {
  OptionSpec row = *this;
  row.keeps_more = std::move(value);
  return row;
}

std::string OptionSpec::describe_allowed() const {
  switch (kind) {
    case Kind::list: return fmt::format("some of {}", fmt::join(allowed, ","));
    case Kind::text: return "text";
    case Kind::choice:
    case Kind::integer: break;
  }
  std::string text = fmt::format("{}", fmt::join(allowed, "|"));
  if (most >= least) {
    if (!text.empty()) text += '|';
    text += fmt::format("{}..{}", least, most);
  }
  return text;
}

namespace common_options {

OptionSpec inputs(std::vector<std::string> allowed, std::string default_value) {
  OptionSpec spec = OptionSpec::list("inputs", std::move(default_value), std::move(allowed),
                                     "the inputs to learn over");
  spec.least = 1;
  return spec;
}

OptionSpec observe(std::vector<std::string> allowed, std::string default_value) {
  return OptionSpec::list("observe", std::move(default_value), std::move(allowed),
                          "the events that are outputs; others are not seen");
}

OptionSpec payload() {
  return OptionSpec::choice("payload", "none", {"none", "gap", "values:V,..."},
                            "gap: a message says whether one before it was lost (next, gap); "
                            "values: messages carry one of these, as in write(V) and message(V)");
}

std::vector<OptionSpec> ends() {
  return {OptionSpec::integer("writers", 1, 1, 4, "ends that write: write, write2, ..."),
          OptionSpec::integer("readers", 1, 1, 4, "ends that read: read, read2, ...")};
}

std::vector<OptionSpec> with_each_end(std::vector<OptionSpec> rows) {
  const std::vector<OptionSpec> of_both = rows;
  for (const auto& [prefix, end] : {std::pair{"pub-", "writer"}, std::pair{"sub-", "reader"}}) {
    for (OptionSpec row : of_both) {
      row.help = fmt::format("of the {} alone; both: as {} says", end, row.key);
      row.key = prefix + row.key;
      row.default_value = both_ends;
      row.allowed.emplace_back(both_ends);
      row.keeps_more.clear();  // the value of both ends is the one to change
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

OptionSpec size(std::int64_t default_value, std::int64_t most) {
  return OptionSpec::integer("size", default_value, 1, most,
                             "learn for at most this many messages in flight");
}

OptionSpec at_bound() {
  return OptionSpec::choice("at-bound", "refuse", {"refuse", "absorb"},
                            "an input beyond size: left unexplored, or drawn as a self-loop");
}

std::vector<OptionSpec> quiescence_rows(std::int64_t floor_ms) {
  OptionSpec how = OptionSpec::choice(
      "quiescence", "observed", {"observed"},
      "how the end of a step is known: the system's threads are observed, or a fixed delay in ms");
  how.least = 0;
  how.most = 60'000;
  return {std::move(how),
          OptionSpec::integer("floor", floor_ms, 0, 60'000,
                              "ms after the last event before a step may end"),
          OptionSpec::integer("step-limit", 5'000, 1, 600'000,
                              "ms that a step, or a reset, may take before it counts as hung")};
}

}  // namespace common_options

bool same_key(std::string_view left, std::string_view right) {
  return normalised(left) == normalised(right);
}

OptionValues::OptionValues(const std::vector<OptionSpec>& table,
                           const std::map<std::string, std::string>& given) {
  for (const OptionSpec& spec : table) values_[spec.key] = spec.default_value;
  std::set<std::string> seen;
  for (const auto& [key, value] : given) {
    const auto spec = std::ranges::find_if(
        table, [&name = key](const OptionSpec& row) { return same_key(row.key, name); });
    if (spec == table.end()) {
      if (is_of_time(normalised(key))) {
        throw UsageError("option '" + key + "' is refused: time is not modelled");
      }
      std::vector<std::string> known;
      for (const OptionSpec& row : table) known.push_back(row.key);
      throw UsageError("unknown option '" + key + "'" + near_or_known(normalised(key), known));
    }
    if (!seen.insert(spec->key).second) {
      throw UsageError(fmt::format("option '{}' is given twice", spec->key));
    }
    check_value(*spec, value);
    values_[spec->key] = value;
  }
}

bool OptionValues::has(std::string_view key) const {
  return std::ranges::any_of(values_,
                             [&](const auto& entry) { return same_key(entry.first, key); });
}

const std::string& OptionValues::text(std::string_view key) const {
  for (const auto& [known, value] : values_) {
    if (same_key(known, key)) return value;
  }
  throw std::logic_error(fmt::format("the wrapper's table has no option '{}'", key));
}

const std::string& OptionValues::of_end(const std::string& prefix, const std::string& key) const {
  const std::string& own = text(prefix + key);
  return own == both_ends ? text(key) : own;
}

std::int64_t OptionValues::number(std::string_view key) const {
  const auto value = parse_number<std::int64_t>(text(key));
  if (!value) throw std::logic_error(fmt::format("option '{}' is not a number", key));
  return *value;
}

std::vector<std::string> OptionValues::list(std::string_view key) const {
  return split_list(text(key));
}

std::vector<std::string> OptionValues::list_behind(std::string_view key,
                                                   std::string_view prefix) const {
  const std::string& value = text(key);
  if (!value.starts_with(prefix) || value.size() <= prefix.size()) return {};
  if (value[prefix.size()] != ':') return {};
  return split_list(std::string_view(value).substr(prefix.size() + 1));
}

std::string to_string(const std::vector<OptionSpec>& table) {
  std::string text;
  for (const OptionSpec& spec : table) {
    text += fmt::format("{}={}\n    {} ({})\n", spec.key, spec.default_value, spec.help,
                        spec.describe_allowed());
  }
  return text;
}

}  // namespace maide
