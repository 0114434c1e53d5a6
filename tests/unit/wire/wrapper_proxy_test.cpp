// The real wrapper of the reference port in a process of its own, through the proxy.
#include "maide/wire/client/wrapper_proxy.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>

#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "port_model.hpp"
#include "processes.hpp"

namespace maide {
namespace {

using Options = std::map<std::string, std::string>;

const std::vector<std::string> port_program = {MAIDE_BINARY_DIR "/bin/maide-wrap-port"};

std::vector<SulQuery> random_words(std::size_t inputs, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<SulQuery> words(count);
  for (SulQuery& query : words) {
    Word word(1 + random.below(12));
    for (Symbol& symbol : word) symbol = static_cast<Symbol>(random.below(inputs));
    query.inputs = std::move(word);
  }
  return words;
}

std::vector<SulStep> expected_steps(const SulInfo& info, const Word& word) {
  test::PortModel model(info);
  std::vector<SulStep> steps;
  for (const Symbol input : word) steps.push_back(model.step(input));
  return steps;
}

class PortOverPipes : public testing::TestWithParam<Options> {};

TEST_P(PortOverPipes, AnswersRandomWordsAsTheModelSays) {
  const auto sul = spawn_wrapper(port_program, GetParam());
  const std::vector<SulQuery> batch = random_words(sul->info().inputs.size(), 200, 2);
  std::vector<bool> answered(batch.size());
  sul->run(batch,
           [&](std::size_t index, const SulAnswer& answer) {
             const Word& word = std::get<Word>(batch[index].inputs);
             ASSERT_EQ(answer.end, WordEnd::complete);
             EXPECT_EQ(answer.attempts, 1u);
             EXPECT_EQ(test::to_line(answer.steps, word, sul->info()),
                       test::to_line(expected_steps(sul->info(), word), word, sul->info()));
             EXPECT_FALSE(answered[index]);
             answered[index] = true;
           },
           {});
  EXPECT_EQ(std::count(answered.begin(), answered.end(), true),
            static_cast<std::ptrdiff_t>(batch.size()));
}

INSTANTIATE_TEST_SUITE_P(Kinds, PortOverPipes,
                         testing::Values(Options{{"kind", "port"}, {"observe", "message,written"}},
                                         Options{{"kind", "buffered"}, {"payload", "gap"}},
                                         Options{{"kind", "strict"},
                                                 {"size", "2"},
                                                 {"inputs", "read,tryread,write"},
                                                 {"observe", "null,message"}}));

TEST(WrapperProxy, SaysWhatTheWrapperSays) {
  const auto sul = spawn_wrapper(port_program, {{"kind", "strict"}, {"at_bound", "absorb"}});
  EXPECT_EQ(sul->info().name, "port");
  EXPECT_EQ(sul->info().versions.at("port"), "1");
  EXPECT_EQ(sul->info().bound, "at most 3 messages in flight");
  EXPECT_EQ(sul->info().options.at("at-bound"), "absorb");
  EXPECT_EQ(sul->info().inputs[0].returns, std::vector<std::string>{"written"});
  EXPECT_TRUE(sul->info().speaks_trees && sul->info().speaks_purposes && sul->info().speaks_av);
  const protocol::Hello hello = ask_hello(WrapperEndpoint::program(port_program));
  EXPECT_EQ(hello.options.front().key, "kind");
}

SulAnswer ask(Sul& sul, SulQuery query) {
  SulAnswer only;
  sul.run(std::vector<SulQuery>{std::move(query)},
          [&](std::size_t, SulAnswer answer) { only = std::move(answer); }, {});
  return only;
}

std::string outputs(const SulAnswer& answer, Translation translation) {
  std::string text;
  for (const SulStep& step : answer.steps) text += mealy_output(step, translation) + ' ';
  return text;
}

TEST(WrapperProxy, PlaysDecisionTrees) {
  const auto sul = spawn_wrapper(
      port_program,
      {{"inputs", "write,tryread"}, {"observe", "message,null"}, {"kind", "buffered"}});
  BasicDecisionTree<std::string> tree;
  tree.nodes = {{1, {{"message", 2}, {"null", 1}}}, {0, {{"quiet", 2}}}, {1, {}}};
  const SulAnswer answer = ask(*sul, {tree, Translation::eager});
  EXPECT_EQ(answer.inputs, (Word{1, 0, 1}));
  EXPECT_EQ(outputs(answer, Translation::eager), "null quiet message ");
}

TEST(WrapperProxy, SpeaksAv) {
  const auto sul = spawn_wrapper(port_program, {{"kind", "buffered"}});
  const Symbol delta = 2;
  const SulAnswer answer = ask(*sul, {Word{0, 1, 0, delta, delta, 0}, Translation::av});
  EXPECT_EQ(outputs(answer, Translation::av), "+ + refused message delta + ");
}

TEST(WrapperProxy, TakesALearningPurpose) {
  const auto sul = spawn_wrapper(port_program, {{"kind", "buffered"}});
  const std::vector<std::string> sends = {"write"};
  const std::vector<std::string> receives = {"message"};
  sul->add_purpose(LearningPurpose::in_flight(2, 0, sends, receives, AtBound::refuse));
  const SulAnswer answer = ask(*sul, {Word{0, 0, 0, 1, 0}, Translation::eager});
  EXPECT_EQ(outputs(answer, Translation::eager), "quiet quiet unexplored message quiet ");
}

TEST(WrapperProxy, RejectedOptionsAreTheUsersMistake) {
  try {
    spawn_wrapper(port_program, {{"knd", "port"}});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown option 'knd'; did you mean 'kind'?");
  }
}

TEST(WrapperProxy, StopsWhenToldAndWorksOn) {
  const auto sul = spawn_wrapper(port_program);
  std::stop_source stop;
  const std::vector<SulQuery> batch = random_words(2, 500, 3);
  std::size_t answered = 0;
  RunControl control;
  control.stop = stop.get_token();
  EXPECT_THROW(sul->run(
                   batch,
                   [&](std::size_t, const SulAnswer&) {
                     if (++answered == 20) stop.request_stop();
                   },
                   control),
               Interrupted);
  EXPECT_EQ(answered, 20u);
  EXPECT_EQ(outputs(ask(*sul, {Word{0, 1}, Translation::eager}), Translation::eager),
            "quiet message ");
}

TEST(WrapperProxy, AKilledWrapperIsStartedOnceMore) {
  const auto sul = spawn_wrapper(port_program, {{"kind", "strict"}, {"size", "2"}});
  const std::vector<SulQuery> batch = random_words(2, 200, 4);
  std::size_t answered = 0;
  std::size_t repeated = 0;
  sul->run(batch,
           [&](std::size_t index, const SulAnswer& answer) {
             const Word& word = std::get<Word>(batch[index].inputs);
             EXPECT_EQ(test::to_line(answer.steps, word, sul->info()),
                       test::to_line(expected_steps(sul->info(), word), word, sul->info()));
             repeated += answer.attempts - 1;
             if (++answered == 50) {
               const std::vector<pid_t> children = test::own_children();
               ASSERT_EQ(children.size(), 1u);
               ::kill(children.front(), SIGKILL);
             }
           },
           {});
  EXPECT_EQ(answered, batch.size());
  EXPECT_EQ(repeated, 1u);
}

TEST(WrapperProxy, LeavesNothingBehind) {
  const auto count_descriptors = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
  };
  spawn_wrapper(port_program);  // whatever is there for good is there after it
  const auto before = count_descriptors();
  for (int i = 0; i < 3; ++i) {
    const auto sul = spawn_wrapper(port_program);
    ask(*sul, {Word{1}, Translation::eager});
  }
  EXPECT_EQ(count_descriptors(), before);
  EXPECT_TRUE(test::own_children().empty());
}

}  // namespace
}  // namespace maide
