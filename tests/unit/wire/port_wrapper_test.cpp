// The reference port through the SDK, in this process: its answers to random words are those of a
// model written by hand.
#include "port_wrapper.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"
#include "port_model.hpp"

namespace maide {
namespace {

using Options = std::map<std::string, std::string>;

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

std::string outputs_of(const SulAnswer& answer) {
  std::string text;
  for (const SulStep& step : answer.steps) {
    text += (text.empty() ? "" : " ") + mealy_output(step, Translation::eager);
  }
  return text;
}

std::string play(const Options& options, const std::vector<std::string>& inputs) {
  port::PortWrapper wrapper;
  LocalSul sul(wrapper, options);
  Word word;
  for (const std::string& name : inputs) {
    for (Symbol symbol = 0; symbol < sul.info().inputs.size(); ++symbol) {
      if (sul.info().inputs[symbol].name == name) word.push_back(symbol);
    }
  }
  EXPECT_EQ(word.size(), inputs.size());
  std::string text;
  const SulQuery query{std::move(word), Translation::eager};
  sul.run({&query, 1}, [&](std::size_t, const SulAnswer& answer) { text = outputs_of(answer); },
          {});
  return text;
}

TEST(PortWrapper, HasSeveralEnds) {
  const Options options{{"kind", "buffered"}, {"writers", "2"}, {"readers", "2"}};
  port::PortWrapper wrapper;
  const LocalSul sul(wrapper, options);
  EXPECT_EQ(sul.info().actors,
            (std::vector<std::string>{"writer", "writer2", "reader", "reader2"}));
  EXPECT_EQ(sul.info().inputs.size(), 4u);
  // The second reader has the message of the second writer, which overwrote the first one's.
  EXPECT_EQ(play(options, {"write", "write2", "read2", "read2", "read"}),
            "quiet quiet message2 quiet message");
}

TEST(PortWrapper, CarriesValues) {
  EXPECT_EQ(play({{"kind", "strict"}, {"payload", "values:go,1-new"}},
                 {"write(1-new)", "write(go)", "write(go)", "read", "read"}),
            "quiet quiet quiet message(1-new) message(go)");
  EXPECT_EQ(play({{"kind", "strict"}, {"payload", "values:a,b"}, {"readers", "2"}, {"size", "1"}},
                 {"write(b)", "write(a)", "read2", "write(a)", "read", "write(a)"}),
            "quiet unexplored message2(b) unexplored message(b) quiet");
  port::PortWrapper wrapper;
  const auto refuse = [&](const Options& options) { const LocalSul sul(wrapper, options); };
  EXPECT_THROW(refuse({{"payload", "values:"}}), UsageError);
  EXPECT_THROW(refuse({{"payload", "values:a,a"}}), UsageError);
  EXPECT_THROW(refuse({{"payload", "values:a b"}}), UsageError);
  EXPECT_THROW(refuse({{"payload", "gap"}, {"writers", "2"}}), UsageError);
}

class PortWrapperAnswers : public testing::TestWithParam<Options> {};

TEST_P(PortWrapperAnswers, RandomWordsAsTheModelSays) {
  port::PortWrapper wrapper;
  LocalSul sul(wrapper, GetParam());
  const std::vector<SulQuery> batch = random_words(sul.info().inputs.size(), 300, 1);
  std::size_t answered = 0;
  sul.run(batch,
          [&](std::size_t index, const SulAnswer& answer) {
            const Word& word = std::get<Word>(batch[index].inputs);
            test::PortModel model(sul.info());
            std::vector<SulStep> expected;
            for (const Symbol input : word) expected.push_back(model.step(input));
            ASSERT_EQ(answer.end, WordEnd::complete);
            ASSERT_EQ(answer.inputs, word);
            EXPECT_EQ(test::to_line(answer.steps, word, sul.info()),
                      test::to_line(expected, word, sul.info()));
            ++answered;
          },
          {});
  EXPECT_EQ(answered, batch.size());
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, PortWrapperAnswers,
    testing::Values(
        Options{}, Options{{"kind", "buffered"}}, Options{{"kind", "strict"}, {"size", "2"}},
        Options{{"kind", "port"}, {"observe", "message,written"}},
        Options{{"kind", "port"}, {"inputs", "write,tryread"}, {"observe", "null,message,written"}},
        Options{{"kind", "buffered"},
                {"inputs", "write,read,tryread"},
                {"observe", "message,null"},
                {"payload", "gap"}},
        Options{{"kind", "strict"}, {"inputs", "write,read,tryread"}, {"at_bound", "absorb"}},
        Options{{"kind", "strict"},
                {"size", "1"},
                {"payload", "gap"},
                {"observe", "written,message,null"},
                {"inputs", "tryread,write,read"}}));

TEST(PortWrapper, SaysWhatItIs) {
  port::PortWrapper wrapper;
  const LocalSul sul(wrapper, {{"kind", "strict"}, {"payload", "gap"}, {"size", "6"}});
  const SulInfo& info = sul.info();
  EXPECT_EQ(info.name, "port");
  EXPECT_EQ(info.actors, (std::vector<std::string>{"writer", "reader"}));
  ASSERT_EQ(info.inputs.size(), 2u);
  EXPECT_EQ(info.inputs[1].returns, (std::vector<std::string>{"next", "gap"}));
  ASSERT_EQ(info.outputs.size(), 2u);
  EXPECT_EQ(info.outputs[0].name, "next");
  EXPECT_EQ(info.outputs[1].actor, 1u);
  EXPECT_EQ(info.bound, "at most 6 messages in flight");
  EXPECT_EQ(info.options.at("at-bound"), "refuse");
  EXPECT_EQ(info.options.at("quiescence"), "observed");
}

TEST(PortWrapper, HasNoBoundWhereItKeepsOneMessageItself) {
  port::PortWrapper wrapper;
  EXPECT_EQ(LocalSul(wrapper, {{"kind", "buffered"}, {"size", "1"}}).info().bound, "");
}

std::string error_of(const Options& options) {
  port::PortWrapper wrapper;
  try {
    const LocalSul sul(wrapper, options);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(PortWrapper, RejectsBadOptionsInOneLine) {
  EXPECT_EQ(error_of({{"depth", "1"}}),
            "unknown option 'depth'; known are: kind, inputs, observe, payload, size, at-bound, "
            "writers, readers, "
            "quiescence, floor, step-limit");
  EXPECT_EQ(error_of({{"kind", "pipe"}}), "option kind=pipe: allowed is port|buffered|strict");
  EXPECT_EQ(error_of({{"size", "0"}}), "option size=0: allowed is 1..1000000");
  EXPECT_EQ(error_of({{"size", "3x"}}), "option size=3x: allowed is 1..1000000");
  EXPECT_EQ(error_of({{"inputs", "write,fly"}}),
            "option inputs=write,fly: 'fly' is not one of write,read,tryread,interrupt,resume");
  EXPECT_EQ(error_of({{"inputs", ""}}), "option inputs=: name at least one");
  EXPECT_EQ(error_of({{"inputs", "write,write"}}),
            "option inputs=write,write: 'write' comes twice");
  EXPECT_EQ(error_of({{"at-bound", "refuse"}, {"at_bound", "absorb"}}),
            "option 'at-bound' is given twice");
  EXPECT_EQ(error_of({{"quiescence", "soon"}}),
            "option quiescence=soon: allowed is observed|0..60000");
  EXPECT_EQ(error_of({{"kind", "strict"}, {"observe", "written"}}),
            "option observe: size=3 counts messages in flight, so 'message' must be observed");
}

// A stop in the middle of a batch: an instance with a blocked call can be taken down.
TEST(PortWrapper, StopsWhenTold) {
  port::PortWrapper wrapper;
  LocalSul sul(wrapper, {{"inputs", "read"}});
  std::stop_source stop;
  const std::vector<SulQuery> batch(3, SulQuery{Word{0}, Translation::eager});
  std::size_t answered = 0;
  EXPECT_THROW(sul.run(
                   batch,
                   [&](std::size_t, const SulAnswer&) {
                     ++answered;
                     stop.request_stop();
                   },
                   RunControl{.stop = stop.get_token(), .deadline = {}, .progress = nullptr}),
               Interrupted);
  EXPECT_EQ(answered, 1u);
}

}  // namespace
}  // namespace maide
