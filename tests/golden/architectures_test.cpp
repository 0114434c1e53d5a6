// The systems of examples/architectures and examples/ros2 have the verdicts that their first lines
// name.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>

#include "expected_verdicts.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/system_file.hpp"

namespace maide {
namespace {

// Each of a folder's system files, which are counted. Models lie beside it.
std::size_t check_files(const std::string& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    const std::string name = entry.path().filename().string();
    const std::string text = read_file(entry.path());
    EXPECT_LE(split_lines(text).size(), 60u) << name;
    const System system = read_system(entry.path());
    EXPECT_EQ(system.remarks, std::vector<std::string>{}) << name;
    std::map<std::string, std::string> found = test::verdicts(system);
    const auto expected = test::expected_verdicts(text);
    EXPECT_FALSE(expected.empty()) << name;
    for (const auto& [property, verdict] : expected) {
      EXPECT_EQ(found[property], verdict) << name << ": " << property;
    }
  }
  return count;
}

TEST(Architectures, HaveTheVerdictsThatTheyName) {
  EXPECT_GE(check_files(MAIDE_SOURCE_DIR "/examples/architectures"), 31u);
}

TEST(Architectures, OfRos2HaveTheVerdictsThatTheyName) {
  for (const std::string name : {"strangers", "nested", "burst", "snapshot", "late-joiner",
                                 "late-server", "camera", "life"}) {
    EXPECT_GE(check_files(MAIDE_SOURCE_DIR "/examples/ros2/" + name), 2u) << name;
  }
}

}  // namespace
}  // namespace maide
