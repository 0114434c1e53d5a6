// Cyclone DDS for real, in this process: the answers to all words up to a length are those of the
// models written by hand, and those models have the sizes that theory gives.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cyclonedds_cases.hpp"
#include "cyclonedds_wrapper.hpp"
#include "maide/wire/local_sul.hpp"

namespace maide {
namespace {

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

class CycloneDds : public testing::TestWithParam<test::CycloneDdsCase> {};

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

INSTANTIATE_TEST_SUITE_P(Policies, CycloneDds, testing::ValuesIn(test::cyclonedds_cases()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
