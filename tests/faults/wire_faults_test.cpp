// The proxy against wrappers that misbehave: each fault ends in one clear error that names the
// endpoint, or is survived; none hangs, none leaves anything behind.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <thread>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "processes.hpp"

namespace maide {
namespace {

WrapperEndpoint fake(const std::string& fault, const std::string& file = "") {
  std::vector<std::string> argv = {MAIDE_PYTHON, MAIDE_SOURCE_DIR "/tests/faults/fake_wrapper.py",
                                   fault};
  if (!file.empty()) argv.push_back(file);
  return WrapperEndpoint::program(argv, "exec:" + fault);
}

std::vector<SulQuery> words(std::size_t count, std::size_t length) {
  return std::vector<SulQuery>(count, SulQuery{Word(length, 0), Translation::eager});
}

// Runs some words; what comes of it as one line.
std::string outcome(const std::string& fault, const std::string& file = "") {
  ProxySettings settings;
  settings.hello_limit = std::chrono::seconds(fault == "no_hello" ? 1 : 60);
  settings.configure_limit = std::chrono::seconds(fault == "no_answer_to_options" ? 5 : 60);
  try {
    WrapperProxy sul(fake(fault, file), {}, settings);
    std::size_t answered = 0;
    std::size_t repeated = 0;
    const std::vector<SulQuery> batch = words(6, 3);
    sul.run(batch,
            [&](std::size_t, const SulAnswer& answer) {
              EXPECT_EQ(answer.steps.size(), 3u);
              ++answered;
              repeated += answer.attempts - 1;
            },
            {});
    return std::to_string(answered) + " answers, " + std::to_string(repeated) + " repeated";
  } catch (const WrapperError& error) {
    EXPECT_EQ(error.endpoint(), "exec:" + fault);
    EXPECT_EQ(error.status(), ExitStatus::system_failed);
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    const std::string place = " (exec:" + fault + ")";
    EXPECT_TRUE(text.ends_with(place)) << text;
    return text.substr(0, text.size() - place.size());
  } catch (const UsageError& error) {
    return std::string("usage: ") + error.what();
  }
}

struct Fault {
  const char* name;
  const char* outcome;
};

class WrapperFault : public testing::TestWithParam<Fault> {};

TEST_P(WrapperFault, IsOneClearError) { EXPECT_EQ(outcome(GetParam().name), GetParam().outcome); }

INSTANTIATE_TEST_SUITE_P(
    BeforeTheFirstWord, WrapperFault,
    testing::Values(
        Fault{"no_hello",
              "no hello within 1 s; mostly the hello is not flushed, or the command is no wrapper"},
        Fault{"garbage_hello",
              "a line is not JSON: Segmentation fault? Not me!; mostly the wrapper prints to "
              "standard output before its hello (say that on standard error), or the command is no "
              "wrapper"},
        Fault{"wrong_version", "the wrapper speaks version 7 of the protocol, Maide version 1"},
        Fault{"info_first", "the wrapper's first line is not a hello"},
        Fault{"endless_line", "a line is longer than 4194304 bytes"},
        Fault{"dies_at_start",
              "no hello: the wrapper exited with status 3: cannot find the middleware's daemon; it "
              "was started 4 times"},
        Fault{"cut_hello",
              "no hello: the wrapper exited with status 0 in the middle of a line; it was started "
              "4 times"},
        Fault{"no_answer_to_options", "no answer to the options within 5 s"},
        Fault{"rejects_options", "usage: option color: no such color"},
        Fault{"cannot_configure", "no licence for the lamp"},
        Fault{"no_inputs", "the system has no inputs"},
        Fault{"input_of_nobody", "unknown actor 'ghost'"},
        Fault{"declares_quiet", "output 'quiet' has a name with a meaning of its own"},
        Fault{"declares_delta", "input 'Delta' has a name with a meaning of its own"},
        Fault{"inputs_of_a_wrong_type", "'inputs' is not a list"}),
    [](const auto& fault) { return fault.param.name; });

INSTANTIATE_TEST_SUITE_P(
    InAWord, WrapperFault,
    testing::Values(
        Fault{"garbage_answer", "a line is not JSON: 42 is not an object? ["},
        Fault{"number_answer", "a line is not a JSON object: 42"},
        Fault{"binary_answer", "a line is not JSON: ???"},
        Fault{
            "deep_answer",
            "a line is not JSON: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[..."},
        Fault{"cut_answer",
              "the wrapper exited with status 0 in the middle of a line; it did so 3 times in the "
              "reset before the word \"press press press\""},
        Fault{"wrong_id", "an answer to query 99, which was not asked"},
        Fault{"negative_id", "'id' is not a whole number from 0 to 18446744073709551615"},
        Fault{"unknown_event", "unknown event 'boom'"},
        Fault{"unknown_actor", "unknown actor 'ghost'"},
        Fault{"too_many_steps", "the answer to query 1 has 4 steps, more than the query"},
        Fault{"too_few_steps", "the answer to query 1 has 2 steps, fewer than the query"},
        Fault{"unknown_status", "unknown status 'bored'"},
        Fault{"unknown_type", "unknown type 'question' of line"},
        Fault{"second_hello", "the wrapper sent a line of a type that nobody asked for"},
        Fault{"system_error", "the bulb is gone, in the word \"press press press\""},
        Fault{"hangs",
              "the wrapper hangs: no answer within 0.25 s; it did so 3 times in the reset before "
              "the word \"press press press\""},
        Fault{"dies_in_word",
              "the wrapper exited with status 3: bulb burst; it did so 3 times in the reset before "
              "the word \"press "
              "press press\""},
        Fault{"is_killed_in_word",
              "the wrapper was killed by signal 9 (Killed); it did so 3 times in the reset before "
              "the word \"press "
              "press press\""},
        Fault{"closes_output",
              "the wrapper closed its output; it did so 3 times in the reset before the word "
              "\"press press press\""},
        Fault{"reserved_output", "event 'refused' has a name with a meaning of its own"},
        Fault{"too_many_events", "a step has 1001 events, more than 1000"},
        Fault{"leaves_for_ever", "'leaving' came twice"},
        Fault{"dies_before_its_child",
              "the wrapper exited with status 3: orphans!; it did so 3 times in the reset before "
              "the word \"press "
              "press press\""},
        Fault{"leaves_at_once",
              "tired; it did so 3 times in the reset before the word \"press press press\""}),
    [](const auto& fault) { return fault.param.name; });

INSTANTIATE_TEST_SUITE_P(Survived, WrapperFault,
                         testing::Values(Fault{"leaves_after_each_word", "6 answers, 0 repeated"},
                                         Fault{"out_of_order", "6 answers, 0 repeated"},
                                         Fault{"flood_of_errors", "6 answers, 0 repeated"},
                                         Fault{"endless_limit", "6 answers, 0 repeated"},
                                         Fault{"slow_bytes", "6 answers, 0 repeated"},
                                         Fault{"new_outputs", "6 answers, 0 repeated"}),
                         [](const auto& fault) { return fault.param.name; });

TEST(WireFaults, AWrapperThatDiesOnceIsAskedAgain) {
  const TempDir folder;
  EXPECT_EQ(outcome("dies_once", (folder.path() / "died").string()), "6 answers, 1 repeated");
}

// Three times, and no more.
TEST(WireFaults, AWrapperThatDiesAsItStartsIsStartedAgain) {
  const TempDir folder;
  const std::string file = (folder.path() / "deaths").string();
  for (const int deaths : {1, 3}) {
    std::ofstream(file) << std::string(static_cast<std::size_t>(deaths), '.');
    WrapperProxy sul(fake("dies_at_starts", file), {});
    EXPECT_EQ(sul.incidents().count, static_cast<std::uint64_t>(deaths));
    EXPECT_EQ(sul.incidents().first.at(0).reason,
              "no hello: the wrapper was killed by signal 9 (Killed)");
    std::size_t answered = 0;
    sul.run(words(2, 2), [&](std::size_t, const SulAnswer&) { ++answered; }, {});
    EXPECT_EQ(answered, 2U);
  }
  std::ofstream(file) << "....";
  EXPECT_EQ(outcome("dies_at_starts", file),
            "no hello: the wrapper was killed by signal 9 (Killed); it was started 4 times");
  std::ofstream(file) << "...";
  EXPECT_EQ(ask_hello(fake("dies_at_starts", file)).name, "lamp");
}

TEST(WireFaults, AProgramThatIsNotThere) {
  try {
    spawn_wrapper({"/nowhere/maide-wrap-nothing"});
    FAIL();
  } catch (const WrapperError& error) {
    EXPECT_STREQ(error.what(),
                 "cannot start '/nowhere/maide-wrap-nothing': No such file or directory "
                 "(/nowhere/maide-wrap-nothing)");
  }
}

TEST(WireFaults, TreesAreNotForThoseWhoDoNotSpeakThem) {
  WrapperProxy sul(fake("slow_bytes"), {});
  BasicDecisionTree<std::string> tree;
  tree.nodes = {{0, {}}};
  const std::vector<SulQuery> batch = {{tree, Translation::eager}};
  EXPECT_THROW(sul.run(batch, [](std::size_t, SulAnswer) {}, {}), UsageError);
  const std::vector<std::string> none;
  EXPECT_THROW(sul.add_purpose(LearningPurpose::in_flight(1, 0, none, none, AtBound::refuse)),
               UsageError);
}

// A stop while the wrapper hangs in a word.
TEST(WireFaults, AHangingWrapperCanBeStopped) {
  WrapperProxy sul(fake("hangs"), {});
  RunControl control;
  control.deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  EXPECT_THROW(sul.run(
                   words(3, 100000), [](std::size_t, SulAnswer) {}, control),
               Interrupted);
}

TEST(WireFaults, AStopBeforeTheHello) {
  RunControl control;
  std::stop_source stop;
  stop.request_stop();
  control.stop = stop.get_token();
  EXPECT_THROW(WrapperProxy(fake("no_hello"), {}, {}, control), Interrupted);
}

// A caller's own exception passes, and the answers of its batch do not end up in the next one.
TEST(WireFaults, AnExceptionOfTheSinkPasses) {
  WrapperProxy sul(fake("slow_bytes"), {});
  EXPECT_THROW(
      sul.run(words(20, 5), [](std::size_t, SulAnswer) { throw std::range_error("mine"); }, {}),
      std::range_error);
  std::size_t answered = 0;
  sul.run(words(3, 2),
          [&](std::size_t, const SulAnswer& answer) {
            EXPECT_EQ(answer.steps.size(), 2u);
            ++answered;
          },
          {});
  EXPECT_EQ(answered, 3u);
}

TEST(WireFaults, NothingIsLeftBehind) {
  const TempDir folder;
  const std::string file = (folder.path() / "processes").string();
  { const WrapperProxy sul(fake("never_ends", file), {}); }
  int wrapper = 0;
  int its_child = 0;
  std::ifstream(file) >> wrapper >> its_child;
  ASSERT_GT(its_child, 0);
  EXPECT_FALSE(test::is_running(wrapper));
  // Killed with its group; it may take the kernel a moment to carry that out.
  while (test::is_running(its_child)) std::this_thread::yield();
}

// Maide killed in the hardest way takes its wrappers with it.
TEST(WireFaults, AChildDoesNotOutliveItsParent) {
  ChildProcess parent({MAIDE_BINARY_DIR "/bin/parent_of_sleep"});
  std::string text, bytes;
  while (text.find('\n') == std::string::npos) {
    const ReadResult result = read_some(parent.output.get(), bytes);
    ASSERT_NE(result, ReadResult::ended);
    if (result == ReadResult::some) text += bytes;
    std::this_thread::yield();
  }
  const int child = std::stoi(text);
  EXPECT_TRUE(test::is_running(child));
  ::kill(parent.id(), SIGKILL);  // the parent alone, not its group
  while (test::is_running(child)) std::this_thread::yield();
}

}  // namespace
}  // namespace maide
