#include "maide/check/build/constant_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/check/text/tokens.hpp"
#include "maide/check/text/yaml_node.hpp"
#include "maide/check/tree/edit.hpp"

namespace maide {
namespace {

bool is_boolean(const std::string& value) { return value == "true" || value == "false"; }

// The section that has an entry of that name, of arrays without their indices; null: none.
const YamlEntry* find_section(const YamlNode& root, const std::string& name) {
  const auto has_it = [&](const YamlEntry& section) {
    return std::ranges::any_of(section.value.entries, [&](const YamlEntry& entry) {
      return entry.key.value.substr(0, entry.key.value.find_first_of("[(")) == name;
    });
  };
  const auto found = std::ranges::find_if(root.entries, has_it);
  return found == root.entries.end() ? nullptr : &*found;
}

[[noreturn]] void fail_unknown(const YamlDocument& document, const std::string& name) {
  std::vector<std::string> known;
  if (const YamlNode* const constants = document.root.find("constants")) {
    for (const YamlEntry& entry : constants->entries) known.push_back(entry.key.value);
  }
  const YamlEntry* const section = find_section(document.root, name);
  throw UsageError(
      fmt::format("'{}' is no constant{}; the constants are: {} ({})", name,
                  section == nullptr ? "" : ", it stands under '" + section->key.value + ":'",
                  known_instead(name, known), document.file));
}

void check_value(const ConstantSetting& setting, const YamlNode& before, const std::string& file) {
  const auto& [name, value] = setting;
  if (!is_boolean(value) && !parse_number<std::int64_t>(value)) {
    const std::size_t digits = value.starts_with('-') ? 1 : 0;
    const bool is_number =
        value.size() > digits && value.find_first_not_of("0123456789", digits) == std::string::npos;
    throw UsageError(
        fmt::format("the value of the constant '{}' is {}, not '{}'", name,
                    is_number ? "a number of 64 bits" : "a whole number, true or false", value));
  }
  const bool was_number = parse_number<std::int64_t>(before.value).has_value();
  if (is_boolean(value) ? was_number : is_boolean(before.value)) {
    throw UsageError(fmt::format("the constant '{}' is {}, and '{}' is {} ({})", name,
                                 was_number ? "a number" : "true or false", value,
                                 was_number ? "none" : "neither", file));
  }
}

}  // namespace

std::vector<ConstantSetting> parse_settings(const std::vector<std::string>& texts) {
  std::vector<ConstantSetting> settings;
  for (const std::string& text : texts) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0) {
      throw UsageError("a constant is set as in n=5, not '" + text + "'");
    }
    ConstantSetting setting{text.substr(0, sign), text.substr(sign + 1)};
    const bool is_known = std::ranges::any_of(
        settings, [&](const ConstantSetting& other) { return other.name == setting.name; });
    if (is_known) throw UsageError("the constant '" + setting.name + "' is set twice");
    settings.push_back(std::move(setting));
  }
  return settings;
}

std::string with_settings(const std::string& text, const std::string& file,
                          const std::vector<ConstantSetting>& settings) {
  std::string changed = text;
  for (const ConstantSetting& setting : settings) {
    const YamlDocument document = read_yaml(changed, file, "a system file");
    const YamlNode* const constants = document.root.find("constants");
    const YamlNode* const value = constants == nullptr ? nullptr : constants->find(setting.name);
    if (value == nullptr) fail_unknown(document, setting.name);
    check_value(setting, *value, file);
    changed = with_value(document, *value, setting.value);
  }
  return changed;
}

}  // namespace maide
