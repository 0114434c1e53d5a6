// Quiescence at length: each middleware that is built answers thousands of random words beside two
// busy processes, and each answer is compared with the model of its port. All middlewares together
// observe 100,000 words; MAIDE_OBSERVED_WORDS=<words of each> asks for fewer or more.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "busy_machine.hpp"
#include "maide/automata/compare.hpp"
#include "maide/base/random.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

// A system that these options make the paper's port in `reference`.
struct Observed {
  std::string name;  // of the test
  std::string middleware;
  test::SystemOptions options;
  std::string reference;
};

void PrintTo(const Observed& tested, std::ostream* out) { *out << tested.name; }

std::string program_of(const Observed& tested) {
  return MAIDE_BINARY_DIR "/bin/maide-wrap-" + tested.middleware;
}

std::size_t words_of_each() {
  const char* words = std::getenv("MAIDE_OBSERVED_WORDS");
  return words == nullptr ? 17'000 : std::strtoul(words, nullptr, 10);
}

class ObservedWords : public testing::TestWithParam<Observed> {};

TEST_P(ObservedWords, AHundredThousandAreAllRight) {
  if (!std::filesystem::exists(program_of(GetParam()))) {
    GTEST_SKIP() << "skipped: " << program_of(GetParam()) << " is not built";
  }
  // First what the right answers are: a model learned in peace, if it is the port's.
  const test::LearnedSystem learned = test::learn_system(GetParam().middleware, GetParam().options);
  ASSERT_TRUE(compare(read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/" +
                                               GetParam().reference + ".dot"),
                      learned.automaton)
                  .same());
  const Mealy& model = learned.machine;

  const auto sul = spawn_wrapper({program_of(GetParam())}, GetParam().options);
  ASSERT_EQ(sul->info().inputs.size(), model.inputs().size());
  const test::BusyMachine load(2);
  Random random(1);
  std::size_t asked = 0, wrong = 0;
  while (asked < words_of_each()) {
    std::vector<SulQuery> batch;
    for (int i = 0; i < 200; ++i) {
      Word word(1 + random.below(12));
      for (Symbol& input : word) input = static_cast<Symbol>(random.below(model.inputs().size()));
      batch.push_back({word, Translation::eager});
    }
    std::size_t answered = 0;
    sul->run(batch,
             [&](std::size_t index, const SulAnswer& answer) {
               const Word& word = std::get<Word>(batch[index].inputs);
               std::vector<std::string> expected;
               for (const Symbol output : model.output_word(word)) {
                 expected.push_back(model.outputs().name(output));
               }
               ++answered;
               if (answer.end == WordEnd::complete && test::outputs(answer) == expected) return;
               ++wrong;
               ADD_FAILURE() << to_string(word, model.inputs());
             },
             {});
    ASSERT_EQ(answered, batch.size());
    asked += answered;
  }
  EXPECT_EQ(wrong, 0u) << "of " << asked;
  RecordProperty("words", std::to_string(asked));
}

INSTANTIATE_TEST_SUITE_P(
    Middleware, ObservedWords,
    testing::Values(
        Observed{"zeromq", "zeromq", {}, "strict-3"},
        Observed{"zeromq_tcp", "zeromq", {{"transport", "tcp"}}, "strict-3"},
        Observed{"mqtt", "mqtt", {}, "strict-3"},
        Observed{"ros1", "ros1", {{"queue_size", "0"}, {"size", "3"}}, "strict-3"},
        Observed{"cyclonedds", "cyclonedds", {{"history", "keep_all"}, {"size", "3"}}, "strict-3"},
        Observed{"fastdds", "fastdds", {{"history", "keep_all"}, {"size", "3"}}, "strict-3"},
        Observed{"ros2", "ros2", {{"history", "keep_all"}, {"size", "3"}}, "strict-3"},
        Observed{"yarp", "yarp", {{"kind", "strict"}, {"size", "3"}}, "strict-3"}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace maide
