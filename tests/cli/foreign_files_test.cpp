// Files of other tools with the real program: what each command makes of them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ForeignFile : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& text) const {
    std::string path = (folder_.path() / name).string();
    write_file_atomically(path, text);
    return path;
  }
  // a answers x, b answers it otherwise, c not at all.
  std::string partial() const {
    return file("p.dot", "digraph { a -> b [label=\"x/y\"]; b -> c [label=\"x/z\"]; start -> a; }");
  }

 private:
  TempDir folder_{"maide-test-"};
};

TEST_F(ForeignFile, APartialMachineIsLearnedWithRefusals) {
  const std::string source = partial();
  const SubprocessResult learned = run_maide({"learn", "sim:" + source});
  EXPECT_EQ(learned.exit_status, 0) << learned.err;
  EXPECT_THAT(learned.err, HasSubstr("is a partial Mealy machine: to an input without an answer it "
                                     "says 'refused'"));
  const Json from_b = json_of(run_maide({"learn", "sim:" + source, "initial=b", "--json"}));
  EXPECT_EQ(from_b.at("states"), 2);
  expect_error(run_maide({"learn", "sim:" + source, "initial=d"}), 2, "no state 'd' to begin in");
  expect_error(run_maide({"learn", "sim:" + source, "depth=2"}), 2, "has 'initial' alone");
}

TEST_F(ForeignFile, APartialMachineIsComparedAndViewed) {
  const std::string source = partial();
  EXPECT_EQ(run_maide({"compare", source, source}).exit_status, 0);
  const std::string whole =
      file("w.dot", "digraph { a -> b [label=\"x/y\"]; b -> b [label=\"x/z\"]; }");
  const SubprocessResult differ = run_maide({"compare", source, whole});
  EXPECT_EQ(differ.exit_status, 1);
  EXPECT_THAT(differ.out, HasSubstr("p.dot has no answer there\n"));
  const std::string page = source + ".html";
  EXPECT_EQ(run_maide({"view", source, "-o", page}).exit_status, 0);
  EXPECT_THAT(read_file(page), HasSubstr("partial Mealy machine"));
  // What needs all answers says so.
  expect_error(run_maide({"test", source, "sim:" + whole}), 2,
               "a partial Mealy machine where a complete one is needed");
}

TEST_F(ForeignFile, LabelsOfOtherKindsAreComparedByTheirTraces) {
  const std::string late = file("late.aut", "des (0,3,3)\n(0,a(1),1)\n(1,b,2)\n(1,c,2)\n");
  const std::string early =
      file("early.aut", "des (0,5,6)\n(0,tau,1)\n(1,a(1),2)\n(1,a(1),3)\n(2,b,4)\n(3,c,5)\n");
  const std::string less =
      file("less.dot", "digraph { s -> t [label=\"a(1)\"]; t -> u [label=b]; }");
  const SubprocessResult same = run_maide({"compare", late, early});
  EXPECT_EQ(same.exit_status, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("tau is taken for a step that nobody sees"));
  const SubprocessResult differ = run_maide({"compare", late, less, "--json"});
  EXPECT_EQ(differ.exit_status, 1);
  EXPECT_THAT(json_of(differ).at("hard").at("word"), ElementsAre("?a(1)", "?c"));
  EXPECT_EQ(run_maide({"view", early, "-o", early + ".html"}).exit_status, 0);
  expect_error(run_maide({"export", early, "--to", "dot"}), 2, "early.aut:2:4)");
  expect_error(run_maide({"compare", late, "sim:" + late}), 2, "late.aut:2:");
}

TEST_F(ForeignFile, TheInitialStateMayBeNamed) {
  const std::string source = partial();
  const std::string other = file("o.dot", "digraph { b; c; b -> c [label=\"x/z\"]; }");
  EXPECT_EQ(run_maide({"compare", source, other}).exit_status, 1);
  EXPECT_EQ(run_maide({"compare", source, other, "--initial", "b"}).exit_status, 0);
  const SubprocessResult moved = run_maide({"export", source, "--to", "aut", "--initial", "b"});
  EXPECT_THAT(moved.out, HasSubstr("des (1, 2, 3)"));
  expect_error(run_maide({"view", source, "--initial", "d"}), 2, "there is no state 'd'");
}

}  // namespace
}  // namespace maide::test
