// Cyclone DDS for real, in this process: the answers to all words up to a length are those of the
// models written by hand, and those models have the sizes that theory gives.
#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "connection_models.hpp"
#include "cyclonedds_wrapper.hpp"
#include "maide/base/error.hpp"
#include "maide/wire/local_sul.hpp"

namespace maide {
namespace {

using Options = std::map<std::string, std::string>;
using test::ConnectionModel;
using test::WhenFull;

std::vector<SulQuery> all_words(std::size_t inputs, std::size_t length) {
  std::vector<SulQuery> words;
  Word word(length, 0);
  while (true) {
    words.push_back({word, Translation::eager});
    std::size_t place = length;
    while (place > 0 && word[place - 1] + 1 == inputs) word[--place] = 0;
    if (place == 0) return words;
    ++word[place - 1];
  }
}

std::vector<std::string> outputs(const SulAnswer& answer) {
  std::vector<std::string> names;
  for (const SulStep& step : answer.steps) names.push_back(mealy_output(step, Translation::eager));
  return names;
}

std::vector<std::string> outputs(const Mealy& machine, const Word& word) {
  std::vector<std::string> names;
  for (const Symbol output : machine.output_word(word)) {
    names.push_back(machine.outputs().name(output));
  }
  return names;
}

struct Case {
  std::string name;
  Options options;
  ConnectionModel model;
  std::size_t states;  // of the minimal machine
};

void PrintTo(const Case& tested, std::ostream* out) { *out << tested.name; }

Options with(Options options, bool gap) {
  options["inputs"] = "write,tryread";
  options["payload"] = gap ? "gap" : "none";
  options.try_emplace("observe", "message,null");
  return options;
}

std::vector<Case> cases() {
  std::vector<Case> all{{"defaults", with({}, false), {1, WhenFull::drop_oldest, false}, 2}};
  const Options limited{{"history", "keep_all"}};
  for (std::size_t n = 1; n <= 4; ++n) {
    const std::string depth = std::to_string(n);
    all.push_back({"keep_last_" + depth,
                   with({{"depth", depth}, {"reliability", "reliable"}}, true),
                   {n, WhenFull::drop_oldest, true},
                   n + 2});
    if (n == 4) break;
    all.push_back({"best_effort_max_samples_" + depth,
                   with({{"history", "keep_all"}, {"max-samples", depth}}, true),
                   {n, WhenFull::drop_newest, true},
                   (std::size_t{1} << (n + 2)) - 2});
    Options reliable{{"history", "keep_all"}, {"max-samples", depth}, {"reliability", "reliable"}};
    all.push_back(
        {"blocking_max_samples_" + depth, with(reliable, true), {n, WhenFull::block, true}, n + 2});
    reliable["max_blocking_time"] = "0";
    reliable["observe"] = "message,null,failed";
    all.push_back(
        {"failing_max_samples_" + depth, with(reliable, true), {n, WhenFull::fail, true}, n + 1});
  }
  return all;
}

class CycloneDds : public testing::TestWithParam<Case> {};

TEST_P(CycloneDds, AnswersAllWordsAsItsModel) {
  const Mealy model = test::make_connection(GetParam().model);
  EXPECT_EQ(model.size(), GetParam().states);
  cyclonedds::CycloneDdsWrapper wrapper;
  LocalSul sul(wrapper, GetParam().options);
  const std::vector<SulQuery> batch = all_words(sul.info().inputs.size(), 9);
  std::size_t answered = 0;
  sul.run(batch,
          [&](std::size_t index, const SulAnswer& answer) {
            const Word& word = std::get<Word>(batch[index].inputs);
            ASSERT_EQ(answer.end, WordEnd::complete);
            ASSERT_EQ(outputs(answer), outputs(model, word)) << to_string(word, model.inputs());
            ++answered;
          },
          {});
  EXPECT_EQ(answered, batch.size());
}

INSTANTIATE_TEST_SUITE_P(Policies, CycloneDds, testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
