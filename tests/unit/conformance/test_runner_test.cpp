// The runner stops at the first difference in test order, whatever the batch; and what is built on
// it: chains, and the table of methods.
#include "maide/conformance/method/test_runner.hpp"

#include <gtest/gtest.h>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"

namespace maide {
namespace {

// Given words, in their order.
class ListSuite : public TestSuite {
 public:
  explicit ListSuite(std::vector<Word> words) : words_(std::move(words)) {}
  bool next(Word& word) override {
    if (at_ == words_.size()) return false;
    word = words_[at_++];
    return true;
  }
  std::optional<std::uint64_t> size() const override { return words_.size(); }

 private:
  std::vector<Word> words_;
  std::size_t at_ = 0;
};

// Answers "x" to the first `good` inputs of a word, "y" afterwards.
Mealy fading(std::size_t good, Alphabet outputs = {"x", "y"}) {
  Mealy machine({"a", "b"}, std::move(outputs), good + 1);
  for (StateId state = 0; state <= good; ++state) {
    for (Symbol input = 0; input < 2; ++input) {
      machine.set_transition(state, input, machine.outputs().at(state == good ? "y" : "x"),
                             std::min<StateId>(state + 1, static_cast<StateId>(good)));
    }
  }
  return machine;
}

TEST(TestRunner, StopsAtTheFirstDifferenceInTestOrderWhateverTheBatch) {
  const Mealy hypothesis = fading(5), system = fading(3);
  const std::vector<Word> words{{0}, {1, 1, 1}, {0, 1, 0, 1, 0}, {1, 1, 1, 1}, {0, 0, 0, 0}};
  for (std::size_t batch = 1; batch < 7; ++batch) {
    MealyOracle oracle(system);
    CountingOracle counter(oracle);
    TestRunner runner(counter, {.batch_size = batch});
    ListSuite suite(words);
    EXPECT_EQ(runner.run(suite, hypothesis, {}), (Word{0, 1, 0, 1}));
    EXPECT_EQ(runner.last_tests(), 3U);
    EXPECT_FALSE(runner.last_was_complete());
    EXPECT_LT(counter.statistics().total().queries, 3 + batch);
  }
}

// Answers nothing from the n-th input of a word on, as a system that dies there.
class DyingOracle : public MealyOracle {
 public:
  using MealyOracle::ask;
  DyingOracle(const Mealy& machine, std::size_t inputs) : MealyOracle(machine), inputs_(inputs) {}
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    std::vector<MealyAnswer> answers = MealyOracle::ask(batch, control, sink);
    for (MealyAnswer& answer : answers) {
      if (answer.outputs.size() > inputs_) answer.outputs.resize(inputs_);
    }
    return answers;
  }

 private:
  std::size_t inputs_;
};

TEST(TestRunner, AnAnswerThatEndsEarlyDiffersWhereItEnds) {
  const Mealy machine = fading(5);
  for (std::size_t inputs = 0; inputs < 4; ++inputs) {
    DyingOracle oracle(machine, inputs);
    TestRunner runner(oracle, {});
    ListSuite suite({{0, 1, 0, 1}});
    EXPECT_EQ(runner.run(suite, machine, {}), head(Word{0, 1, 0, 1}, inputs + 1));
  }
}

TEST(TestRunner, KeepsToTheMaximum) {
  const Mealy system = fading(3);
  MealyOracle oracle(system);
  for (std::uint64_t limit = 1; limit <= 4; ++limit) {
    CountingOracle counter(oracle);
    TestRunner runner(counter, {.max_tests = limit, .batch_size = 2});
    ListSuite suite(std::vector<Word>{{0}, {1}, {0, 0}});
    EXPECT_EQ(runner.run(suite, system, {}), std::nullopt);
    EXPECT_EQ(runner.last_tests(), std::min<std::uint64_t>(limit, 3));
    EXPECT_EQ(counter.statistics().total().queries, runner.last_tests());
    EXPECT_EQ(runner.last_was_complete(), limit >= 3);
  }
}

TEST(TestRunner, MatchesOutputsByName) {
  const Mealy system = fading(3), same = fading(3, {"y", "x"}), other = fading(3, {"z", "y", "x"});
  MealyOracle oracle(system);
  TestRunner runner(oracle, {});
  ListSuite first({Word(5, 0)}), second({Word(5, 0)}), third({Word{0, 1}});
  EXPECT_EQ(runner.run(first, same, {}), std::nullopt);
  EXPECT_EQ(runner.run(second, other, {}), std::nullopt);
  Mealy strange({"a", "b"}, {"never seen"}, 1);
  strange.set_transition(0, 0, 0, 0);
  strange.set_transition(0, 1, 0, 0);
  EXPECT_EQ(runner.run(third, strange, {}), Word{0});
}

// The same as through an output oracle: the word, and what is counted.
TEST(MachineRunner, FindsWhatATestRunnerFinds) {
  const Mealy system = fading(5);
  const std::vector<Word> words{{0}, {1, 1, 1}, {0, 1, 0, 1, 0, 1, 1}, {0, 0, 0, 0}};
  for (const std::size_t good : {1U, 2U, 3U, 5U}) {
    for (const Mealy& hypothesis :
         {fading(good), fading(good, {"y", "x"}), fading(good, {"z", "y", "x"})}) {
      MealyOracle oracle(system);
      TestRunner slow(oracle, {});
      MachineRunner fast(system);
      ListSuite first(words), second(words);
      const auto word = slow.run(first, hypothesis, {});
      EXPECT_EQ(fast.run(second, hypothesis, 1000), word);
      EXPECT_EQ(word.has_value(), good != 5);
      EXPECT_EQ(fast.tests(), slow.last_tests());
      if (!word) {
        EXPECT_EQ(fast.symbols(), 1U + 3 + 7 + 4);
      }
    }
  }
  MachineRunner limited(system);
  ListSuite suite(words);
  EXPECT_EQ(limited.run(suite, fading(3), 2), std::nullopt);
  EXPECT_EQ(limited.symbols(), 4U);
  EXPECT_THROW(limited.run(suite, Mealy({"b", "a"}, {"x"}, 1), 5), UsageError);
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  EXPECT_THROW(MachineRunner(system).run(suite, system, 5, control), Interrupted);
}

TEST(TestRunner, RefusesOtherInputsAndStopsWhenAsked) {
  const Mealy system = fading(3);
  MealyOracle oracle(system);
  TestRunner runner(oracle, {});
  ListSuite suite({Word{0}});
  EXPECT_THROW(runner.run(suite, Mealy({"b", "a"}, {"x"}, 1), {}), UsageError);
  std::stop_source source;
  source.request_stop();
  RunControl control;
  control.stop = source.get_token();
  EXPECT_THROW(runner.run(suite, system, control), Interrupted);
}

class FixedOracle : public EquivalenceOracle {
 public:
  FixedOracle(std::optional<Word> word, std::string text)
      : word_(std::move(word)), text_(std::move(text)) {}
  std::optional<Word> find_counterexample(const Mealy&, const RunControl&) override {
    ++asked;
    return word_;
  }
  std::string guarantee() const override { return text_; }
  int asked = 0;

 private:
  std::optional<Word> word_;
  std::string text_;
};

TEST(ChainOracle, AsksInOrderUntilOneFindsSomething) {
  auto first = std::make_unique<FixedOracle>(std::nullopt, "one");
  auto second = std::make_unique<FixedOracle>(Word{1}, "two");
  auto third = std::make_unique<FixedOracle>(Word{2}, "three");
  const FixedOracle &looked = *first, &found = *second, &unused = *third;
  std::vector<std::unique_ptr<EquivalenceOracle>> links;
  links.push_back(std::move(first));
  links.push_back(std::move(second));
  links.push_back(std::move(third));
  ChainOracle chain(std::move(links));
  EXPECT_EQ(chain.find_counterexample(fading(1)), Word{1});
  EXPECT_EQ(looked.asked, 1);
  EXPECT_EQ(found.asked, 1);
  EXPECT_EQ(unused.asked, 0);
  EXPECT_EQ(chain.guarantee(), "one; two; three");
}

TEST(TestMethods, AreFoundByNameAndSayWhatTheyNeed) {
  EXPECT_EQ(&find_test_method("standard"), &test_methods().front());
  EXPECT_THROW(find_test_method("magic"), UsageError);
  const Mealy system = fading(3);
  MealyOracle oracle(system);
  EXPECT_THROW(find_test_method("perfect").make({oracle, nullptr, nullptr}, {}), UsageError);
  TestMethodOptions options;
  options.restart_probability = 1.5;
  EXPECT_THROW(find_test_method("random-walk").make({oracle, nullptr, nullptr}, options),
               UsageError);
  options.min_length = 5;
  options.max_length = 4;
  EXPECT_THROW(find_test_method("random-words").make({oracle, nullptr, nullptr}, options),
               UsageError);
}

// Every option that a method names must reach it.
TEST(TestMethods, OptionsReachTheMethods) {
  const Mealy system = fading(3);
  MealyOracle oracle(system);
  TestMethodOptions options;
  options.max_tests = 7;
  options.min_length = 4;
  options.max_length = 4;
  options.extra_states = 1;
  options.infix_min = 3;
  options.infix_mean = 0;
  options.ways = 2;
  options.walk_length = 5;
  for (const TestMethodEntry& method : test_methods()) {
    if (method.name == "perfect") continue;
    CountingOracle counter(oracle);
    const auto teacher = method.make({counter, nullptr, nullptr}, options);
    EXPECT_EQ(teacher->find_counterexample(system), std::nullopt);
    const QueryCounts counts = counter.statistics().total();
    EXPECT_EQ(counts.queries, 7U) << method.name;
    if (method.name == "random-words") {
      EXPECT_EQ(counts.symbols, 28U);
    } else if (method.name == "random-walk") {
      EXPECT_LE(counts.symbols, 28U);
    } else if (method.name == "state-cover" || method.name == "k-way") {
      EXPECT_GE(counts.symbols, 7 * 5U);
      EXPECT_LE(counts.symbols, 7 * (4 + 4 + 5U));
    } else if (method.name.starts_with("random-")) {
      EXPECT_GE(counts.symbols, 7 * 3U);
      EXPECT_LE(counts.symbols, 7 * (3 + 3 + 4U));
    }
  }
}

TEST(TestMethods, TheEndsOfRandomTestsReachThem) {
  const Mealy system = fading(3);
  MealyOracle oracle(system);
  const auto count_symbols = [&](PrefixStates prefix, SuffixWords suffix) {
    TestMethodOptions options;
    options.max_tests = 300;
    options.infix_min = 0;
    options.infix_mean = 0;
    options.prefix_states = prefix;
    options.suffix_words = suffix;
    CountingOracle counter(oracle);
    const auto teacher = find_test_method("random-hads").make({counter, nullptr, nullptr}, options);
    EXPECT_EQ(teacher->find_counterexample(system), std::nullopt);
    EXPECT_EQ(teacher->guarantee().find("at their ends") != std::string::npos,
              suffix == SuffixWords::none);
    return counter.statistics().total().symbols;
  };
  const std::uint64_t least = count_symbols(PrefixStates::uniform, SuffixWords::none);
  EXPECT_NEAR(static_cast<double>(count_symbols(PrefixStates::transitions, SuffixWords::none)),
              static_cast<double>(least) + 300, 60);
  EXPECT_GT(count_symbols(PrefixStates::deep, SuffixWords::none), least);
  EXPECT_GT(count_symbols(PrefixStates::uniform, SuffixWords::own), least + 300);
}

}  // namespace
}  // namespace maide
