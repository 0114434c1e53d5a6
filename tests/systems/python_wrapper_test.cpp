// The wrapper of examples/python, which knows the protocol only: learned like any other.
#include <gtest/gtest.h>

#include <utility>

#include "maide/base/error.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"

namespace maide {
namespace {

std::unique_ptr<WrapperProxy> start_queue(const std::string& size) {
  return spawn_wrapper({MAIDE_PYTHON, MAIDE_SOURCE_DIR "/examples/python/queue_wrapper.py"},
                       {{"size", size}});
}

TEST(PythonWrapper, IsAskedWordsWhateverTheAlgorithm) {
  for (const auto& [wanted, taken] : {std::pair("lsharp", "lsharp-sepseq"), {"adt", "ttt"}}) {
    const auto sul = start_queue("2");
    IaTranslator translator(*sul, Translation::eager);
    ExperimentOptions options;
    options.algorithm = wanted;
    const ExperimentResult result = run_experiment(translator, options);
    if (result.error) std::rethrow_exception(result.error);
    EXPECT_EQ(result.algorithm, taken);
    EXPECT_EQ(result.model.size(), 3u);
  }
}

TEST(PythonWrapper, IsLearned) {
  for (const std::size_t size : {1, 3}) {
    const auto sul = start_queue(std::to_string(size));
    IaTranslator translator(*sul, Translation::eager);
    const ExperimentResult result = run_experiment(translator, ExperimentOptions{});
    if (result.error) std::rethrow_exception(result.error);
    EXPECT_EQ(result.algorithm, "lsharp-sepseq");  // it answers no decision trees
    const Mealy& model = result.model;
    ASSERT_EQ(model.size(), size + 1);
    const Symbol put = model.inputs().at("put");
    const Symbol get = model.inputs().at("get");
    Word word(size + 1, put);
    word.insert(word.end(), size + 1, get);
    std::vector<std::string> expected(size, "ok");
    expected.push_back("full");
    expected.insert(expected.end(), size, "item");
    expected.push_back("empty");
    std::vector<std::string> outputs;
    for (const Symbol output : model.output_word(word)) {
      outputs.push_back(model.outputs().name(output));
    }
    EXPECT_EQ(outputs, expected);
  }
}

TEST(PythonWrapper, SaysWhatItIs) {
  const auto sul = start_queue("7");
  EXPECT_EQ(sul->info().name, "queue");
  EXPECT_EQ(sul->info().options.at("size"), "7");
  EXPECT_FALSE(sul->info().speaks_trees);
  EXPECT_EQ(sul->info().actors, std::vector<std::string>{"system"});
}

// The wrapper lists its options in its hello; it need not check them itself.
TEST(PythonWrapper, IsNotGivenOptionsThatItDoesNotHave) {
  EXPECT_THROW(start_queue("many"), UsageError);
  EXPECT_THROW(start_queue("0"), UsageError);
  EXPECT_THROW(spawn_wrapper({MAIDE_PYTHON, MAIDE_SOURCE_DIR "/examples/python/queue_wrapper.py"},
                             {{"sise", "2"}}),
               UsageError);
}

}  // namespace
}  // namespace maide
