// The systems of examples/architectures have the verdicts that their first lines name.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/explore/check_system.hpp"
#include "maide/check/explore/engine.hpp"
#include "maide/check/language/system_file.hpp"

namespace maide {
namespace {

// "# deadlock: violated" is what is expected of `deadlock`.
std::map<std::string, std::string> expected_in(const std::string& text) {
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

TEST(Architectures, HaveTheVerdictsThatTheyName) {
  std::size_t count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(MAIDE_SOURCE_DIR "/examples/architectures")) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    const std::string name = entry.path().filename().string();
    const std::string text = read_file(entry.path());
    EXPECT_LE(split_lines(text).size(), 60u) << name;
    const System system = parse_system(text, name);
    EXPECT_EQ(system.remarks, std::vector<std::string>{}) << name;
    std::map<std::string, std::string> found;
    NativeEngine engine;
    for (const PropertyResult& result : check_system(system, engine, {}).properties) {
      found[result.name] = to_string(result.verdict);
    }
    const auto expected = expected_in(text);
    EXPECT_FALSE(expected.empty()) << name;
    for (const auto& [property, verdict] : expected) {
      EXPECT_EQ(found[property], verdict) << name << ": " << property;
    }
  }
  EXPECT_GE(count, 31u);
}

}  // namespace
}  // namespace maide
