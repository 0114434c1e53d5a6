// Verdicts that a system file names in comments, and those that it has.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "maide/base/text.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/verdict/check_system.hpp"

namespace maide::test {

// "# deadlock: violated" is what is expected of `deadlock`.
inline std::map<std::string, std::string> expected_verdicts(std::string_view text) {
  std::map<std::string, std::string> expected;
  for (const std::string_view line : split_lines(text)) {
    const std::size_t colon = line.find(": ");
    if (!line.starts_with("# ") || colon == std::string_view::npos) continue;
    const std::string verdict(line.substr(colon + 2));
    if (verdict != "holds" && verdict != "violated") continue;
    expected.emplace(line.substr(2, colon - 2), verdict);
  }
  return expected;
}

// By property.
inline std::map<std::string, std::string> verdicts(const System& system) {
  std::map<std::string, std::string> found;
  NativeEngine engine;
  for (const PropertyResult& result : check_system(system, engine, {}).properties) {
    found[result.name] = to_string(result.verdict);
  }
  return found;
}

}  // namespace maide::test
