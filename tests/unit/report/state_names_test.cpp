// Names of states: what they hold, who waits, what is due; else the word that leads there.
#include "maide/report/state_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <variant>
#include <vector>

#include "maide/formats/model_file.hpp"
#include "maide/report/picture.hpp"

namespace maide {
namespace {

using testing::ElementsAre;

std::vector<std::string> names_of(const std::string& name) {
  const std::string file = MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot";
  return name_states(std::get<InterfaceAutomaton>(read_model(file)));
}

TEST(StateNames, SayWhatIsHeldWhoWaitsAndWhatIsDue) {
  // In the order of the file, whose comments say the same.
  EXPECT_THAT(names_of("strict-2"),
              ElementsAre("empty", "empty, reader waits", "holds 1", "holds 2",
                          "holds 1, message due", "holds 2, message due"));
}

// A port's write waits for its read.
TEST(StateNames, NameTheWriterThatWaits) {
  const std::vector<std::string> names = names_of("port");
  EXPECT_THAT(names, testing::Contains(testing::HasSubstr("reader waits")));
}

TEST(StateNames, AreDifferentWithinAModel) {
  for (const char* const model : {"port", "buffered", "buffered-tryread", "strict-1", "strict-6",
                                  "strict-6-tryread", "strict-3-tryread-absorb"}) {
    const std::vector<std::string> names = names_of(model);
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size()) << model;
    for (const std::string& name : names) EXPECT_FALSE(name.empty()) << model;
  }
}

TEST(StateNames, OfAMachineAreTheWordsThatLeadThere) {
  const Model model = read_dot(
      "digraph { a -> b [label=\"x / 0\"]; b -> c [label=\"x / 0\"]; c -> d [label=\"x / 0\"]; "
      "d -> e [label=\"y / 1\"]; a -> a [label=\"y / 0\"]; b -> b [label=\"y / 0\"]; "
      "c -> c [label=\"y / 0\"]; d -> d [label=\"x / 0\"]; e -> a [label=\"x / 0\"]; "
      "e -> e [label=\"y / 0\"] }",
      "words.dot");
  EXPECT_THAT(name_states(NondeterministicMealy(std::get<Mealy>(model))),
              ElementsAre("at the start", "after x", "after x twice", "after x 3 times",
                          "after x 3 times, y"));
}

// A state of two machines that name it apart has a line for each.
TEST(JointPicture, ANameOfTwoLinesHasTwo) {
  JointPicture picture;
  picture.states.push_back({"A: holds 3\nB: holds 2", "both", "never tried: ?write"});
  std::vector<std::size_t> edges;
  const std::string dot = joint_picture(picture, {true}, edges);
  EXPECT_NE(dot.find("A: holds 3\\nB: holds 2\\nnever tried: ?write"), std::string::npos) << dot;
}

}  // namespace
}  // namespace maide
