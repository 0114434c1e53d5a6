// `maide simulate` with the real program: by chance, by choice through a pipe, and on a terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Both programs may end; if b comes first, it waits for ever.
const std::string two = R"(constants: {n: 2}
models:
  order: {use: queue, with: {size: 2}}
  lock: {use: mutex}
variables: "var done: bool;"
programs:
  a: |
    var k: 0..5;
    while (k < n) { order.write(k); k = k + 1; }
    lock.lock; done = true;
  b: |
    lock.lock;
    order.read -> message(1);
    lock.unlock; done = false;
)";

class Simulate : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    write_file_atomically(path(name), text);
    return path(name);
  }
  // What is shown when these lines are the input.
  std::string choose(const std::string& system, const std::string& lines) const {
    const SubprocessResult result =
        run_with_maide("printf '" + lines + "' | \"$maide\" simulate " + system + " --interactive");
    EXPECT_EQ(result.exit_status, 0) << result.err;
    return result.out + result.err;
  }

 private:
  TempDir folder_;
};

TEST_F(Simulate, RefusesWhatItCannotUse) {
  const std::string system = write("two.yaml", two);
  expect_error(run_maide({"simulate"}), 2, "SYSTEM");
  expect_error(run_maide({"simulate", "nowhere.yaml"}), 2, "nowhere.yaml");
  expect_error(run_maide({"simulate", system, "--steps", "0"}), 2, "--steps: '0' is not a whole");
  expect_error(run_maide({"simulate", system, "--seed", "x"}), 2, "--seed");
  expect_error(run_maide({"simulate", system, "--interactive", "--seed", "1"}), 2,
               "--interactive and --seed exclude each other");
  expect_error(run_maide({"simulate", system, "--interactive", "--steps", "1"}), 2,
               "--interactive and --steps exclude each other");
  expect_error(run_maide({"simulate", system, "--set", "m=1"}), 2, "m");
  expect_error(run_maide({"simulate", system, "--trace", system}), 2, "write over a file");
  EXPECT_EQ(run_maide({"simulate", system, "--interactive", "--json"}).exit_status, 2);
}

TEST_F(Simulate, ByChanceIsTheSameWithTheSameSeed) {
  const std::string system = write("two.yaml", two);
  std::set<std::string> ends;
  for (int seed = 1; seed <= 20; ++seed) {
    const std::vector<std::string> command{"simulate", system, "--json", "--seed",
                                           std::to_string(seed)};
    const SubprocessResult first = run_maide(command);
    EXPECT_EQ(first.exit_status, 0) << first.err;
    EXPECT_EQ(first.out, run_maide(command).out);
    ends.insert(json_of(first)["end"].get<std::string>());
  }
  EXPECT_EQ(ends, std::set<std::string>{"deadlock"});
  const Json short_run = json_of(run_maide({"simulate", system, "--steps", "2", "--json"}));
  EXPECT_EQ(short_run["trace"].size(), 2U);
  EXPECT_TRUE(short_run["end"].is_null());
}

TEST_F(Simulate, ByChanceIsPrintedAndSaved) {
  const std::string system = write("two.yaml", two);
  const std::string trace = path("run.json");
  const SubprocessResult run =
      run_maide({"simulate", system, "--set", "n=1", "--seed", "4", "--trace", trace});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(testing::StartsWith("seed 4: "), HasSubstr(", then a deadlock: "),
                             HasSubstr("b waits for what never comes"),
                             HasSubstr("nothing can happen any more:")));
  const Json saved = parse_json(read_file(trace), trace);
  EXPECT_EQ(saved["property"], "");
  EXPECT_EQ(saved["set"]["n"], "1");
  EXPECT_EQ(run_maide({"view", trace, "-o", path("run.svg")}).exit_status, 0);
  EXPECT_THAT(run_maide({"replay", system, trace}).err, HasSubstr("there is nothing real"));
}

TEST_F(Simulate, ByChoiceGoesForwardAndBack) {
  const std::string system = write("two.yaml", two);
  const std::string shown = choose(system, R"(1\n2\nb\nu\nu\n2\n1\n1\n1\n?\nq\n1\n)");
  EXPECT_THAT(shown, AllOf(HasSubstr("   1  a  line 9   order.write(0)  while (k < n)"),
                           HasSubstr("   2  b  line 12  lock.lock"),
                           HasSubstr("step 1: a order.write(0) (line 9)\n"),
                           HasSubstr("back behind step 0\n"), HasSubstr("this is the start\n"),
                           HasSubstr("step 1: b lock.lock (line 12)\n")));
  EXPECT_THAT(shown, HasSubstr("  a waits at line 10 to give lock.lock; lock is held: b locked it "
                               "at step 1; only b would give lock.unlock (k = 2)\n"));
  EXPECT_THAT(shown,
              HasSubstr("  order holds 2 messages: message(0), message(1), has message(0) due\n"));
  EXPECT_THAT(shown, AllOf(HasSubstr("  lock is held\n"), HasSubstr("  done = false\n")));
}

TEST_F(Simulate, ByChoiceTellsADeadlockAndSaves) {
  const std::string system = write("two.yaml", two);
  const std::string trace = path("run.json");
  const std::string shown =
      choose(system, R"(2\n1\n1\n\n3\nx\ns\ns )" + system + R"(\ns )" + trace + R"(\n)");
  EXPECT_THAT(shown,
              AllOf(HasSubstr("a deadlock: "), HasSubstr("nothing can come next"),
                    HasSubstr("'x' is none of: a number"), HasSubstr("s needs the name of a file"),
                    HasSubstr("write over a file"), HasSubstr(trace + ": 4 steps")));
  EXPECT_EQ(read_file(system), two);
  EXPECT_EQ(parse_json(read_file(trace), trace)["steps"].size(), 4U);
}

TEST_F(Simulate, StepsOfNobodyAndEnds) {
  const std::string late = write("late.yaml", R"(topics:
  map: {writers: w, readers: r, use: queue, with: {depth: 1}, delivery: late, loses: true}
programs:
  w: map.write;
  r: "idle map.read -> message;"
)");
  const std::string shown = choose(late, R"(1\n?\n3\n1\n)");
  EXPECT_THAT(shown,
              AllOf(HasSubstr("nobody  line 2  map!arrives"), HasSubstr("nobody  line 2  map!lost"),
                    HasSubstr("is lost)"), HasSubstr("map[r]<-w holds a message"),
                    HasSubstr("who has not ended may rest")));
  const std::string wrong =
      write("wrong.yaml", "programs: {a: \"var n: 0..1; n = any 0..1; n = n + 1; skip;\"}\n");
  EXPECT_THAT(choose(wrong, R"(2\n?\n)"),
              AllOf(HasSubstr("an error: a comes to an error at step 1"),
                    HasSubstr("a is at an error: n = 2")));
  EXPECT_THAT(choose(wrong, R"(1\n)"), HasSubstr("all programs have ended"));
}

TEST_F(Simulate, OnATerminal) {
  const std::string system = write("two.yaml", two);
  const SubprocessResult typed = run_on_terminal({"simulate", system}, "2\n1\nb\n?\n");
  EXPECT_EQ(typed.exit_status, 0) << typed.out;
  EXPECT_THAT(typed.out, AllOf(HasSubstr("> 2\n"), HasSubstr("step 2: a order.write(0)"),
                               HasSubstr("back behind step 1"), HasSubstr("lock is held")));
  const SubprocessResult stopped = run_on_terminal({"simulate", system}, "1\n\x03");
  EXPECT_EQ(stopped.exit_status, 0) << stopped.out;
  EXPECT_THAT(stopped.out, HasSubstr("step 1: "));
  // Chance needs no terminal, and no questions.
  EXPECT_THAT(run_on_terminal({"simulate", system, "--seed", "1"}, "").out, HasSubstr("seed 1: "));
}

TEST_F(Simulate, CallbacksStartInAnyOrder) {
  const std::string nodes = write("nodes.yaml", R"(topics:
  image: {writers: w, readers: n, use: queue, with: {size: 1}}
nodes:
  n: {callbacks: {on_image: {takes: image.read, do: "skip;"}}}
programs:
  w: image.write;
)");
  EXPECT_THAT(run_maide({"simulate", nodes}).err, HasSubstr("callbacks start in any order"));
  const std::string system = write("two.yaml", two);
  EXPECT_THAT(run_maide({"simulate", system}).err, Not(HasSubstr("callbacks")));
}

}  // namespace
}  // namespace maide::test
