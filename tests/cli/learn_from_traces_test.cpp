// `maide learn --from-traces`: logs of a system, alone and beside it, with the real program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/file.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/formats/trace_log.hpp"
#include "maide/sul/ia_translation.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path models = fs::path(MAIDE_SOURCE_DIR) / "tests" / "models";

std::vector<std::string> learn(std::vector<std::string> more) {
  std::vector<std::string> arguments{"learn"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// Every word of up to `longest` inputs, as the model answers it.
std::string log_of(const std::string& model, std::size_t longest) {
  const Mealy machine = to_mealy(read_interface_automaton(model), Translation::eager);
  TraceLog log{machine.inputs(), machine.outputs(), {}};
  std::vector<Word> words{{}};
  for (std::size_t next = 0; next < words.size(); ++next) {
    for (Symbol input = 0; words[next].size() < longest && input < machine.inputs().size();
         ++input) {
      words.push_back(words[next]);
      words.back().push_back(input);
    }
    log.traces.push_back({words[next], machine.output_word(words[next])});
  }
  std::ostringstream text;
  write_trace_log(text, log);
  return text.str();
}

TEST(LearnFromTraces, LearnsFromALogAlone) {
  const TempDir folder("learn-test");
  const std::string log = (folder.path() / "log.jsonl").string();
  const std::string file = (folder.path() / "model.dot").string();
  const std::string model = (models / "strict-3.dot").string();
  write_file_atomically(log, log_of(model, 9));
  const Json json = json_of(run_maide(learn({"--from-traces", log, "-o", file, "--json"})));
  EXPECT_EQ(json.at("passive"), true);
  EXPECT_EQ(json.at("traces"), 1023);
  EXPECT_EQ(json.at("unseen_transitions"), 0);
  const Mealy learned = read_mealy(file);
  EXPECT_FALSE(
      find_difference(learned, to_mealy(read_interface_automaton(model), Translation::eager)));
  EXPECT_THAT(learned.origin.at("passive"), HasSubstr("1023 traces alone"));
  EXPECT_TRUE(run_maide(learn({"--from-traces", log})).out.starts_with("digraph "));
  expect_error(run_maide(learn({"--from-traces", log, "--plot", file})), 2,
               "--plot needs a system");
  expect_error(run_maide(learn({"--from-traces", log, "-o", log})), 2,
               "--output and --from-traces are the same file");
}

TEST(LearnFromTraces, LearnsFromACacheAlone) {
  const TempDir folder("learn-test");
  const std::string cache = (folder.path() / "cache.sqlite").string();
  const std::string file = (folder.path() / "model.dot").string();
  ASSERT_EQ(run_maide(learn({"port", "kind=strict", "size=3", "--cache", cache})).exit_status, 0);
  ASSERT_EQ(run_maide(learn({"--from-traces", cache, "-o", file})).exit_status, 0);
  EXPECT_FALSE(find_difference(
      read_mealy(file),
      to_mealy(read_interface_automaton(models / "strict-3.dot"), Translation::eager)));
}

TEST(LearnFromTraces, ALogShowsCounterexamplesAndIsNotBelieved) {
  const TempDir folder("learn-test");
  const std::string log = (folder.path() / "log.jsonl").string();
  const std::string file = (folder.path() / "model.dot").string();
  for (const char* logged : {"strict-3", "strict-2"}) {
    write_file_atomically(log, log_of((models / (std::string(logged) + ".dot")).string(), 7));
    for (const char* algorithm : {"rs", "lsharp"}) {
      const SubprocessResult result =
          run_maide(learn({"port", "kind=strict", "size=3", "--from-traces", log, "--algorithm",
                           algorithm, "-o", file, "--json"}));
      const Json json = json_of(result);
      EXPECT_TRUE(
          compare(read_interface_automaton(file), read_interface_automaton(models / "strict-3.dot"))
              .same());
      EXPECT_EQ(json.at("log_contradictions").empty(), std::string(logged) == "strict-3");
      EXPECT_THAT(json.at("guarantee").get<std::string>(), HasSubstr("logged traces"));
    }
  }
  EXPECT_THAT(run_maide(learn({"port", "kind=strict", "size=3", "--from-traces", log})).err,
              HasSubstr("the log is wrong     about "));
}

// A log may come through a pipe that nobody writes to yet, or no more; the first signal ends that.
TEST(LearnFromTraces, StopsWaitingForALogWhenInterrupted) {
  for (const char* writer : {"", "exec 3> \"$log\"; "}) {
    const TempDir folder("learn-test");
    const SubprocessResult result = run_with_maide(
        "log=" + (folder.path() / "log").string() +
        "; mkfifo \"$log\"; \"$maide\" learn --from-traces \"$log\" & run=$!; "
        "until ls -l /proc/$run/fd 2> /dev/null | grep -q \"$log\"; do sleep 0.01; done; " +
        writer + "kill -TERM $run; wait $run");
    expect_error(result, 3, "reading the file was interrupted");
  }
}

TEST(LearnFromTraces, TimeToReadALogIsLimitedToo) {
  const TempDir folder("learn-test");
  const std::string log = (folder.path() / "log").string();
  expect_error(
      run_with_maide("mkfifo " + log + "; $maide learn --from-traces " + log + " --time 0.2"), 3,
      "reading the file ran out of time");
}

TEST(LearnFromTraces, RefusesLogsThatItCannotUse) {
  const TempDir folder("learn-test");
  const std::string log = (folder.path() / "log.jsonl").string();
  write_file_atomically(log, "[[\"write\",\"x\"]]\n[[\"write\",\"y\"]]\n");
  const std::string contradiction = "trace 2 contradicts one before it";
  expect_error(run_maide(learn({"--from-traces", log})), 2, contradiction);
  for (const char* algorithm : {"rs", "lsharp"}) {
    expect_error(run_maide(learn({"port", "--from-traces", log, "--algorithm", algorithm})), 2,
                 "(" + log + ")");
  }
  write_file_atomically(log, "[[\"a\",\"x\"]]\nread\n");
  expect_error(run_maide(learn({"--from-traces", log})), 2, "(" + log + ":2");
  write_file_atomically(log, "");
  expect_error(run_maide(learn({"--from-traces", log})), 2, "no inputs");
  expect_error(run_maide(learn({"--from-traces", "/no/such/log"})), 2, "/no/such/log");
  expect_error(run_maide(learn({})), 2, "SUL is required");
  const std::string model = (models / "port.dot").string();
  expect_error(run_maide(learn({"--from-traces", log, "--start-from", model})), 2, "--start-from");
  expect_error(run_maide(learn({"port", "--from-traces", log, "--algorithm", "nstar"})), 2,
               "nstar");
}

}  // namespace
}  // namespace maide::test
