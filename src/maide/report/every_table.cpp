#include "maide/report/every_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "maide/base/text.hpp"

namespace maide {
namespace {

const PropertyResult* find_result(const CheckedValue& checked, const std::string& property) {
  const auto& results = checked.report.properties;
  const auto found = std::ranges::find(results, property, &PropertyResult::name);
  return found == results.end() ? nullptr : &*found;
}

// "-": there is no such property with that value.
std::string verdict_on(const CheckedValue& checked, const std::string& property) {
  const PropertyResult* const result = find_result(checked, property);
  return result == nullptr ? "-" : describe_verdict(*result);
}

// Of all values, in the order in which they come.
std::vector<std::string> property_names(const CheckedValues& checked) {
  std::vector<std::string> names;
  for (const CheckedValue& value : checked.values) {
    for (const PropertyResult& result : value.report.properties) {
      if (std::ranges::find(names, result.name) == names.end()) names.push_back(result.name);
    }
  }
  return names;
}

// "violated up to 11, holds from 12 on".
std::string summarize(const CheckedValues& checked, const std::string& property) {
  struct Stretch {
    std::string verdict;
    std::int64_t first = 0, last = 0;
  };
  std::vector<Stretch> stretches;
  for (const CheckedValue& value : checked.values) {
    const std::string verdict = verdict_on(value, property);
    if (stretches.empty() || stretches.back().verdict != verdict) {
      stretches.push_back({verdict, value.value, value.value});
    }
    stretches.back().last = value.value;
  }
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < stretches.size(); ++at) {
    const auto& [verdict, first, last] = stretches[at];
    const std::string what = verdict == "-" ? "is not there" : verdict;
    const bool is_last = at + 1 == stretches.size();
    parts.push_back(stretches.size() == 1 ? what + " everywhere"
                    : at == 0             ? fmt::format("{} up to {}", what, last)
                    : is_last             ? fmt::format("{} from {} on", what, first)
                    : first == last       ? fmt::format("{} at {}", what, first)
                                          : fmt::format("{} from {} to {}", what, first, last));
  }
  return join(parts);
}

// What is said of values that were not checked.
std::string describe_end(const CheckedValues& checked) {
  const std::string name = checked.every.text();
  const std::int64_t last = checked.values.back().value;
  switch (checked.end) {
    case CheckedValues::End::range: return "";
    case CheckedValues::End::never_filled:
      return fmt::format("{} = {} is never filled, so a larger one changes nothing", name, last);
    case CheckedValues::End::limit:
      return std::ranges::all_of(checked.values,
                                 [](const auto& value) { return value.is_filled == true; })
                 ? fmt::format("each {} up to {} can be filled: larger ones may differ", name, last)
                 : fmt::format(
                       "of some {} up to {} it is not known whether they can be filled: "
                       "larger ones may differ",
                       name, last);
    case CheckedValues::End::stopped:
      return fmt::format("it ended early: values behind {} were not checked", last);
  }
  return "";
}

std::string_view to_string(CheckedValues::End end) {
  switch (end) {
    case CheckedValues::End::range: return "range";
    case CheckedValues::End::never_filled: return "never filled";
    case CheckedValues::End::limit: return "limit";
    case CheckedValues::End::stopped: return "stopped";
  }
  return "";
}

// Columns as wide as they must be; numbers stand at the right.
std::string lay_out(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t column = 0; column < row.size(); ++column) {
      widths[column] = std::max(widths[column], row[column].size());
    }
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t column = 0; column < row.size(); ++column) {
      const bool is_number = column < 3;
      line += "  " + (is_number ? fmt::format("{:>{}}", row[column], widths[column])
                                : fmt::format("{:<{}}", row[column], widths[column]));
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace

std::string describe_every(const CheckedValues& checked) {
  const std::vector<std::string> names = property_names(checked);
  std::vector<std::vector<std::string>> rows{{checked.every.text(), "states", "seconds"}};
  const bool has_depths = !checked.every.option.empty();
  if (has_depths) rows.front().emplace_back("filled");
  rows.front().insert(rows.front().end(), names.begin(), names.end());
  for (const CheckedValue& value : checked.values) {
    auto& row = rows.emplace_back(std::vector<std::string>{std::to_string(value.value),
                                                           std::to_string(value.states),
                                                           fmt::format("{:.2f}", value.seconds)});
    if (has_depths) row.emplace_back(!value.is_filled ? "?" : *value.is_filled ? "yes" : "no");
    for (const std::string& name : names) row.push_back(verdict_on(value, name));
  }
  std::string text = lay_out(rows);
  for (const std::string& name : names) text += name + ": " + summarize(checked, name) + "\n";
  const std::string end = describe_end(checked);
  return end.empty() ? text : text + end + "\n";
}

Json every_to_json(const CheckedValues& checked) {
  Json json{{"verdict", maide::to_string(verdict_of(checked))},
            {"every", checked.every.text()},
            {"end", to_string(checked.end)},
            {"values", Json::array()},
            {"summary", Json::object()}};
  for (const CheckedValue& value : checked.values) {
    Json entry{{"value", value.value},
               {"verdict", maide::to_string(value.report.verdict)},
               {"states", value.states},
               {"seconds", value.seconds},
               {"properties", Json::array()}};
    if (value.is_filled) entry["filled"] = *value.is_filled;
    for (const PropertyResult& result : value.report.properties) {
      Json property{{"name", result.name}, {"verdict", maide::to_string(result.verdict)}};
      if (!result.reason.empty()) property["reason"] = result.reason;
      entry["properties"].push_back(std::move(property));
    }
    json["values"].push_back(std::move(entry));
  }
  for (const std::string& name : property_names(checked)) {
    json["summary"][name] = summarize(checked, name);
  }
  return json;
}

Verdict verdict_of(const CheckedValues& checked) {
  Verdict worst =
      checked.end == CheckedValues::End::stopped ? Verdict::inconclusive : Verdict::holds;
  for (const CheckedValue& value : checked.values) {
    if (value.report.verdict == Verdict::violated) return Verdict::violated;
    if (value.report.verdict == Verdict::inconclusive) worst = Verdict::inconclusive;
  }
  return worst;
}

ExitStatus exit_status_of(const CheckedValues& checked) {
  const Verdict verdict = verdict_of(checked);
  if (verdict == Verdict::violated) return ExitStatus::violated;
  for (const CheckedValue& value : checked.values) {
    if (exit_status_of(value.report) == ExitStatus::internal) return ExitStatus::internal;
  }
  return verdict == Verdict::holds ? ExitStatus::ok : ExitStatus::inconclusive;
}

}  // namespace maide
