// `maide replay` on the reference port: real threads and blocking calls follow a deadlock that is
// there, and show one that is not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;

class ReplayCommand : public testing::Test {
 protected:
  // `via` and `sync` are `models`, the programs those of case study 1 with a burst of two.
  std::string system(const std::string& via, const std::string& name = "s.yaml",
                     const std::string& programs = case_study) {
    return write(name, "models:\n  via: {" + via +
                           "}\n  sync: {learn: port, with: {kind: buffered}}\nprograms:\n" +
                           programs);
  }
  std::string write(const std::string& name, const std::string& text) {
    const std::string path = (folder_.path() / name).string();
    write_file_atomically(path, text);
    return path;
  }
  // Checks the system, which must be in violation, and returns the trace's file.
  std::string find_deadlock(const std::string& system) {
    const std::string trace = (folder_.path() / "trace.json").string();
    const SubprocessResult result = run_maide(
        {"check", system, "--engine", "native", "--property", "deadlock", "--trace", trace, "-q"});
    EXPECT_EQ(result.exit_status, 1) << result.err;
    return trace;
  }

  static inline const std::string case_study =
      "  planner: |\n    loop { repeat 2 { via.write; } sync.read -> message; }\n"
      "  controller: |\n    loop { repeat 2 { via.read -> message; } sync.write; }\n";
  TempDir folder_{"maide-test-"};
};

TEST_F(ReplayCommand, FollowsADeadlockThatIsReal) {
  const std::string file = system("learn: port, with: {kind: buffered}");
  const std::string trace = find_deadlock(file);
  const SubprocessResult result = run_maide({"replay", file, trace, "--rounds", "3"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("via: port kind=buffered, waiting longer: floor=10"));
  EXPECT_THAT(result.out, HasSubstr("planner     line 6    via?write             quiet"));
  EXPECT_THAT(result.out, HasSubstr("3 of 3: followed\nthe deadlock is real"));
  const Json json = json_of(run_maide({"replay", file, trace, "--json"}));
  EXPECT_EQ(json["verdict"], "followed");
  EXPECT_EQ(json["deadlocks"], 1);
  EXPECT_EQ(json["property"], "deadlock");
  EXPECT_EQ(json["steps"][0]["seen"], "quiet");
}

// A strict port of three keeps what the buffered one loses.
TEST_F(ReplayCommand, PlaysOnASystemWithOtherOptions) {
  const std::string file = system("learn: port, with: {kind: buffered}");
  const std::string trace = find_deadlock(file);
  const SubprocessResult result =
      run_maide({"replay", file, trace, "--with", "kind=strict", "--with", "size=3"});
  EXPECT_EQ(result.exit_status, 1) << result.err;
  EXPECT_THAT(result.out, HasSubstr("via: port kind=buffered, with kind=strict size=3, waiting "
                                    "longer: floor=10"));
  EXPECT_THAT(result.out, HasSubstr("expected quiet, seen message"));
  const SubprocessResult short_wait = run_maide({"replay", file, trace, "--with", "floor=3"});
  EXPECT_EQ(short_wait.exit_status, 0) << short_wait.err;
  EXPECT_THAT(short_wait.out, HasSubstr("via: port kind=buffered, with floor=3\n"));
  const SubprocessResult unknown = run_maide({"replay", file, trace, "--with", "rmw=fastrtps"});
  EXPECT_EQ(unknown.exit_status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("rmw"));
  EXPECT_EQ(run_maide({"replay", file, trace, "--with", "kind"}).exit_status, 2);
}

// A model that says of itself that it is a strict port, and is none.
TEST_F(ReplayCommand, ShowsThatAnAlarmIsFalse) {
  std::string text = read_file(std::string(MAIDE_SOURCE_DIR) + "/tests/models/buffered.dot");
  text.insert(text.find("inputs="), "sul=\"port kind=strict size=2\";\n  ");
  write("false.dot", text);
  const std::string file = system("file: false.dot");
  const std::string trace = find_deadlock(file);
  const SubprocessResult result = run_maide({"replay", file, trace, "--json"});
  EXPECT_EQ(result.exit_status, 1);
  const Json json = json_of(result);
  EXPECT_EQ(json["verdict"], "not followed");
  EXPECT_EQ(json["deviation"]["model"], "via");
  EXPECT_EQ(json["deviation"]["expected"], "quiet");
  EXPECT_EQ(json["deviation"]["seen"], "message");
  EXPECT_EQ(json["deviation"]["word"], (Json{"write", "write", "read", "read"}));
  const std::string out = run_maide({"replay", file, trace}).out;
  EXPECT_THAT(out, HasSubstr("via: port as in false.dot, waiting longer: floor=10"));
  EXPECT_THAT(out, HasSubstr("expected quiet, seen message"));
}

// The model shows no return of `write`, so the planner goes on; the real one cannot.
TEST_F(ReplayCommand, SeesACallThatReallyBlocks) {
  const std::string file =
      system("learn: port, with: {kind: port}", "s.yaml",
             "  planner: |\n    via.write;\n    sync.write;\n    sync.read -> message;\n"
             "    sync.read -> message;\n");
  const SubprocessResult result = run_maide({"replay", file, find_deadlock(file)});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.out, HasSubstr("step 2, planner line 7 sync?write: expected via.write has "
                                    "returned, seen via.write still blocks"));
}

TEST_F(ReplayCommand, PlaysRandomRuns) {
  const std::string file = system("learn: port, with: {kind: strict, size: 2}");
  const SubprocessResult result =
      run_maide({"replay", file, "--random", "5", "--steps", "30", "--seed", "3", "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const Json json = json_of(result);
  EXPECT_EQ(json["followed"], 5);
  EXPECT_EQ(json["deadlocks"], 0);
  EXPECT_EQ(json["steps_followed"], 150);
  const std::string lossy = system("learn: port, with: {kind: buffered}");
  const Json lost = json_of(run_maide({"replay", lossy, "--random", "20", "--json"}));
  EXPECT_EQ(lost["followed"], 20);
  EXPECT_GT(lost["deadlocks"], 0);
}

TEST_F(ReplayCommand, DoesNotClaimWhatNobodyCanAsk) {
  const std::string file =
      system("learn: port, with: {kind: strict, size: 2}, when_unexplored: wait", "s.yaml",
             "  planner: repeat 3 { via.write; }\n");
  const SubprocessResult result = run_maide({"replay", file, find_deadlock(file)});
  EXPECT_EQ(result.exit_status, 3) << result.err;
  EXPECT_THAT(result.out, HasSubstr("at its end the system is at rest"));
  EXPECT_THAT(result.out, HasSubstr("via.write at line 5 was never tried there"));
  EXPECT_THAT(result.out, HasSubstr("verdict: followed as far as it can be asked"));
}

// A message that may be lost: whether it was is the system's choice.
TEST_F(ReplayCommand, CountsTheRoundsThatFollowed) {
  write("lossy.dot",
        "digraph g {\n  inputs=\"write,read\";\n  outputs=\"message,null\";\n"
        "  actors=\"writer: ?write; reader: ?read !message !null\";\n"
        "  sul=\"sim:lossy.dot\";\n  __start0 -> a;\n  a -> b [label=\"?write\"];\n"
        "  b -> c [label=\"?read\"];\n  b -> d [label=\"?read\"];\n"
        "  c -> e [label=\"!message\"];\n  d -> e [label=\"!null\"];\n}\n");
  const std::string file =
      write("lossy.yaml",
            "models:\n  via: {file: lossy.dot}\nprograms:\n  p: |\n    via.write;\n"
            "    switch via.read { message { stop; } null { via.read; } }\n");
  const SubprocessResult result =
      run_maide({"replay", file, find_deadlock(file), "--rounds", "40", "--json"});
  EXPECT_EQ(result.exit_status, 3);
  const Json json = json_of(result);
  EXPECT_EQ(json["verdict"], "followed at times");
  ASSERT_EQ(json["outcomes"].size(), 2);
  EXPECT_EQ(json["outcomes"][0]["runs"].get<int>() + json["outcomes"][1]["runs"].get<int>(), 40);
  EXPECT_THAT(json["outcomes"].dump(), HasSubstr("expected null, seen message"));
  // Either is as the model says.
  EXPECT_EQ(run_maide({"replay", file, "--random", "10", "-q"}).exit_status, 0);
}

TEST_F(ReplayCommand, RefusesWhatNoRealSystemIsAskedFor) {
  const std::string file = write(
      "forks.yaml",
      "models:\n  'fork[i in 0..2]': {use: mutex}\nprograms:\n  'p[i in 0..2]': |\n"
      "    loop { fork[i].lock; fork[(i + 1) % 3].lock; fork[i].unlock; fork[(i + 1) % 3].unlock; "
      "}\n");
  const std::string trace = find_deadlock(file);
  const std::string why =
      "there is nothing real to replay this on: fork[0], fork[1], fork[2] are written by hand (a "
      "mutex each), and no real system is asked for that";
  expect_error(run_maide({"replay", file, trace, "-q"}), 2, why);
  expect_error(run_maide({"replay", file, "--random", "2", "-q"}), 2, why);
  const std::string topic =
      write("topic.yaml",
            "topics:\n  t: {writers: w, readers: [r, s], learn: port, with: {kind: buffered}}\n"
            "programs:\n  w: t.write;\n  r: t.read -> message;\n  s: t.read -> message;\n");
  const SubprocessResult played = run_maide({"replay", topic, "--random", "5"});
  EXPECT_EQ(played.exit_status, 0) << played.out << played.err;
  EXPECT_THAT(played.out, HasSubstr("t: port kind=buffered writers=1 readers=2"));
  const std::string own = write(
      "own.yaml",
      "topics:\n  t: {writers: w, readers: [r, s], learn: port, with: {kind: strict, size: 2}, "
      "readers_with: {s: {size: 1}}}\n"
      "programs:\n  w: t.write;\n  r: t.read -> message;\n  s: t.read -> message;\n");
  expect_error(run_maide({"replay", own, "--random", "1", "-q"}), 2,
               "topic t: its readers have options of their own");
}

// Two writers and two readers: the second writer's message is what overwrites the first.
TEST_F(ReplayCommand, PlaysATopicWithAllItsEnds) {
  const std::string file = write(
      "topic.yaml",
      "topics:\n  t: {writers: [a, b], readers: [r, s], learn: port, with: {kind: buffered}}\n"
      "programs:\n  a: t.write;\n  b: t.write;\n  r: loop { idle t.read -> message; }\n"
      "  s: repeat 2 { t.read -> message; }\n");
  const std::string trace = find_deadlock(file);
  const SubprocessResult result = run_maide({"replay", file, trace, "--rounds", "3"});
  EXPECT_EQ(result.exit_status, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("3 of 3: followed\nthe deadlock is real"));
}

TEST_F(ReplayCommand, PlaysValuesThatAQueueWasNotLearnedWith) {
  const std::string file = write(
      "values.yaml",
      "models:\n  via: {learn: port, with: {kind: buffered}}\n"
      "  sync: {learn: port, with: {kind: buffered}}\nprograms:\n"
      "  p: |\n    var n: 0..2;\n    while (n < 2) { via.write(n); n = n + 1; }\n    sync.write;\n"
      "  q: |\n    sync.read -> message;\n    via.read -> message(0);\n");
  const std::string trace = find_deadlock(file);
  const SubprocessResult result = run_maide({"replay", file, trace});
  EXPECT_EQ(result.exit_status, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("via: port kind=buffered payload=values:0,1"));
  EXPECT_THAT(result.out, HasSubstr("message(1)"));
  EXPECT_THAT(run_maide({"check", file}).out,
              HasSubstr("values by the rule that the oldest is lost"));
}

TEST_F(ReplayCommand, SaysWhichModelsAreWrittenByHand) {
  const std::string file = write("mixed.yaml",
                                 "models:\n  via: {learn: port, with: {kind: buffered}}\n"
                                 "  m: {use: mutex}\nprograms:\n"
                                 "  p: m.lock; via.write;\n  q: m.lock; via.read -> message;\n");
  const std::string trace = find_deadlock(file);
  const SubprocessResult result = run_maide({"replay", file, trace});
  EXPECT_EQ(result.exit_status, 0) << result.err;  // Maide holds the mutex
  EXPECT_THAT(result.out, HasSubstr("verdict: followed\n"));
  const std::string queued =
      write("queued.yaml",
            "models:\n  via: {learn: port, with: {kind: buffered}}\n"
            "  m: {use: queue, with: {size: 1}}\nprograms:\n"
            "  p: via.write; m.read -> message;\n  q: via.read -> message;\n");
  const SubprocessResult partly = run_maide({"replay", queued, find_deadlock(queued)});
  EXPECT_EQ(partly.exit_status, 3) << partly.err;
  EXPECT_THAT(partly.out,
              HasSubstr("m is written by hand (a queue of size 1), and no real system"));
  EXPECT_THAT(partly.out, HasSubstr("verdict: followed as far as it can be asked"));
}

TEST_F(ReplayCommand, RefusesWhatItCannotPlay) {
  const std::string file = system("learn: port, with: {kind: buffered}");
  const std::string trace = find_deadlock(file);
  expect_error(run_maide({"replay", file, "-q"}), 2, "give a trace");
  expect_error(run_maide({"replay", file, trace, "--random", "2", "-q"}), 2, "not both");
  expect_error(run_maide({"replay", file, "nowhere.json", "-q"}), 2, "nowhere.json");
  const std::string other = system("learn: port, with: {kind: strict, size: 2}", "other.yaml");
  expect_error(run_maide({"replay", other, trace, "-q"}), 2,
               "the trace does not show that 'deadlock' is violated in");
  const std::string swapped =
      system("learn: port, with: {kind: buffered}", "swapped.yaml",
             "  planner: |\n    sync.write;\n  controller: |\n    via.read -> message;\n");
  expect_error(run_maide({"replay", swapped, trace, "-q"}), 2,
               "step 1: planner line 6 via?write is not possible in");
  const std::string models = std::string(MAIDE_SOURCE_DIR) + "/tests/models/";
  const std::string nameless = system("file: " + models + "buffered.dot", "nameless.yaml");
  expect_error(run_maide({"replay", nameless, trace, "-q"}), 2,
               "model via does not say what it was learned from");
}

}  // namespace
}  // namespace maide::test
