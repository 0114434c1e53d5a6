// ZeroMQ for real, in this process: the answers to all words up to a length are those of the models
// written by hand, of the sizes that they should have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "maide/automata/mealy.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "wrapper_checks.hpp"
#include "zeromq_cases.hpp"
#include "zeromq_wrapper.hpp"

namespace maide {
namespace {

class ZeroMq : public testing::TestWithParam<test::ZeroMqCase> {};

TEST_P(ZeroMq, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_connection(GetParam().model);
  EXPECT_EQ(model.size(), GetParam().states);
  zeromq::ZeroMqWrapper wrapper;
  test::expect_answers(wrapper, GetParam().options, model, GetParam().model.reconnects ? 5 : 10);
}

INSTANTIATE_TEST_SUITE_P(Patterns, ZeroMq, testing::ValuesIn(test::zeromq_cases()),
                         [](const auto& tested) { return tested.param.name; });

// In lock step: a call that is out of turn fails.
TEST(ZeroMqRequestReply, AnswersAllWordsAsItsModel) {
  Mealy model({"write", "tryread", "tryaccept", "answer"}, {}, 4);
  const std::string outputs[4][4] = {{"quiet", "failed", "none", "rejected"},
                                     {"failed", "null", "accepted", "rejected"},
                                     {"failed", "null", "rejected", "quiet"},
                                     {"failed", "message", "none", "rejected"}};
  const Symbol turn[4] = {0, 2, 3, 1};  // the input that leads on
  for (StateId state = 0; state < 4; ++state) {
    for (Symbol input = 0; input < 4; ++input) {
      model.set_transition(state, input, model.intern_output(outputs[state][input]),
                           input == turn[state] ? (state + 1) % 4 : state);
    }
  }
  for (const char* transport : {"inproc", "tcp"}) {
    zeromq::ZeroMqWrapper wrapper;
    test::expect_answers(wrapper,
                         {{"pattern", "req-rep"},
                          {"transport", transport},
                          {"inputs", "write,tryread,tryaccept,answer"},
                          {"observe", "message,null,failed,none,accepted,rejected"}},
                         model, 5);
  }
}

std::string error_of(const test::SystemOptions& options) {
  zeromq::ZeroMqWrapper wrapper;
  return test::usage_error_of(wrapper, options);
}

TEST(ZeroMqOptions, ThatMakeNoSenseAreRefused) {
  EXPECT_THAT(error_of({{"size", "0"}, {"transport", "tcp"}}), testing::HasSubstr("say size=N"));
  EXPECT_THAT(error_of({{"size", "0"}, {"sndhwm", "0"}}), testing::HasSubstr("say size=N"));
  EXPECT_EQ(error_of({{"pattern", "pub-sub"}, {"sndtimeo", "0"}}),
            "option sndtimeo: only a write of pattern=push-pull without conflate waits");
  EXPECT_THAT(error_of({{"pattern", "req-rep"}, {"conflate", "yes"}}),
              testing::StartsWith("option conflate:"));
  EXPECT_THAT(error_of({{"send", "plain"}}), testing::HasSubstr("needs floor=3"));
  EXPECT_EQ(error_of({{"send", "plain"}, {"floor", "3"}}), "");
  EXPECT_THAT(error_of({{"inputs", "write,read,disconnect"}}),
              testing::StartsWith("option inputs: disconnect loses messages"));
  EXPECT_THAT(error_of({{"pattern", "req-rep"}, {"inputs", "write,disconnect"}}),
              testing::HasSubstr("there is no input 'disconnect'"));
}

TEST(ZeroMqWrapper, SaysWhatItIs) {
  zeromq::ZeroMqWrapper wrapper;
  const LocalSul sul(wrapper);
  EXPECT_EQ(sul.info().name, "zeromq");
  EXPECT_FALSE(sul.info().versions.at("zeromq").empty());
  EXPECT_EQ(sul.info().actors, (std::vector<std::string>{"writer", "reader"}));
  EXPECT_EQ(sul.info().inputs.at(0).returns, std::vector<std::string>{"written"});
  EXPECT_EQ(sul.info().bound, "at most 3 messages in flight");
}

TEST(ZeroMqWrapper, TriesItself) {
  zeromq::ZeroMqWrapper wrapper;
  EXPECT_THAT(run_self_test(wrapper), testing::EndsWith(": write -> quiet, read -> message"));
}

}  // namespace
}  // namespace maide
