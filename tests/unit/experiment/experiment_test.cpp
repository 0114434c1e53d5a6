// Whole runs: the reference models of the paper's ports are learned exactly, in both translations;
// interrupted and failing runs give back what they have; resumed runs ask nothing twice.
#include "maide/experiment/experiment.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <memory>

#include "maide/automata/compare.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"
#include "maide/sul/simulated_sul.hpp"

namespace maide {
namespace {

InterfaceAutomaton read_reference(const std::filesystem::path& path) {
  return std::get<InterfaceAutomaton>(read_model(path));
}

TEST(Experiment, LearnsEveryReferenceModelExactlyInBothTranslations) {
  int learned = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MAIDE_SOURCE_DIR "/tests/models")) {
    if (entry.path().extension() != ".dot") continue;
    const InterfaceAutomaton reference = read_reference(entry.path());
    for (const Translation translation : {Translation::eager, Translation::av}) {
      for (const LearnerEntry& algorithm : deterministic_learners()) {
        SimulatedSul sul(reference, "sim");
        IaTranslator translator(sul, translation);
        ExperimentOptions options;
        options.algorithm = algorithm.name;
        const ExperimentResult result = run_experiment(translator, options);
        ASSERT_TRUE(result.is_complete());
        const InterfaceAutomaton model = translator.to_interface_automaton(result.model);
        EXPECT_TRUE(compare(model, reference).same()) << entry.path();
        EXPECT_EQ(model.size(), reference.size()) << entry.path();
        EXPECT_EQ(result.resets, result.experiments);
        EXPECT_GT(result.symbols, result.experiments);
        EXPECT_EQ(result.experiments, result.statistics.total().queries);
        EXPECT_NE(result.guarantee.find("behaves differently"), std::string::npos)
            << result.guarantee;
        ++learned;
      }
    }
  }
  EXPECT_GE(learned, 4 * 13);
}

Mealy example_machine(std::uint64_t seed) {
  Random random(seed);
  return random_mealy({.states = 30, .inputs = 3, .outputs = 3}, random);
}

// What a log or an old model gives is part of the run, and of its time.
TEST(Experiment, IsInterruptedWhileItUsesWhatIsKnown) {
  const Mealy machine = example_machine(2);
  const TraceLog log{machine.inputs(), machine.outputs(), {{{0}, machine.output_word(Word{0})}}};
  RunControl control;
  control.deadline = std::chrono::steady_clock::now();
  for (const bool from_log : {true, false}) {
    for (const char* algorithm : {"lsharp", "rs"}) {
      MealyOracle system(machine);
      ExperimentOptions options;
      options.algorithm = algorithm;
      if (from_log) options.traces = &log;
      if (!from_log) options.old_model = machine;
      const ExperimentResult result = run_experiment(system, options, control);
      EXPECT_EQ(result.model.size(), 0U);
      EXPECT_EQ(result.experiments, 0U);
      ASSERT_FALSE(result.is_complete());
      EXPECT_THROW(std::rethrow_exception(result.error), Interrupted);
    }
  }
}

// A cache that answers everything may be another system's by now.
TEST(Experiment, ASampleIsAskedAgainWhereACacheAnswersEverything) {
  const TempDir folder;
  const Mealy machine = example_machine(5), other = example_machine(6);
  ExperimentOptions options;
  options.cache_file = folder.path() / "cache";
  options.sample = 5;
  MealyOracle system(machine);
  ASSERT_TRUE(run_experiment(system, options).is_complete());
  const ExperimentResult again = run_experiment(system, options);
  EXPECT_TRUE(again.is_complete());
  EXPECT_EQ(again.experiments, 5U);
  MealyOracle exchanged(other);
  const ExperimentResult mistaken = run_experiment(exchanged, options);
  ASSERT_FALSE(mistaken.is_complete());
  try {
    std::rethrow_exception(mistaken.error);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::inconclusive);
    EXPECT_THAT(error.what(), testing::HasSubstr("the cache is another system's"));
  }
}

// The model may have been weak, and the words be new ones.
TEST(Experiment, WordsOfTheSampleRefuteAWeakModel) {
  const TempDir folder;
  const Mealy machine = example_machine(5);
  ExperimentOptions options;
  options.cache_file = folder.path() / "cache";
  options.sample = 40;
  options.test_method = "random-w";
  options.testing.max_tests = 1;
  MealyOracle system(machine);
  const ExperimentResult first = run_experiment(system, options);
  ASSERT_TRUE(first.is_complete());
  ASSERT_LT(first.model.size(), machine.size()) << "too well tested for what comes now";
  const ExperimentResult again = run_experiment(system, options);
  EXPECT_TRUE(again.is_complete());
  EXPECT_GT(again.model.size(), first.model.size());
}

// A protocol of some states in which most inputs end the session.
Mealy protocol(std::size_t states, std::size_t inputs) {
  Random random(7);
  Alphabet names;
  for (std::size_t i = 0; i < inputs; ++i) names.intern("i" + std::to_string(i));
  Mealy machine(names, Alphabet({"ok", "alert & closed", "closed", "hello"}), states + 1);
  const auto end = static_cast<StateId>(states);
  for (StateId state = 0; state <= end; ++state) {
    for (Symbol input = 0; input < inputs; ++input) {
      machine.set_transition(state, input, state == end || random.chance(0.1) ? 2 : 1, end);
    }
    if (state == end) continue;
    const auto draw = [&] { return static_cast<Symbol>(random.below(inputs)); };
    machine.set_transition(state, draw(), 3, static_cast<StateId>(random.below(state + 1)));
    if (state + 1 < end) machine.set_transition(state, draw(), 0, state + 1);
  }
  return machine;
}

TEST(Experiment, EveryLearnerAndMethodSavesWhatComesBehindTheEndOfASession) {
  const Mealy machine = protocol(9, 8);
  for (const LearnerEntry& algorithm : deterministic_learners()) {
    for (const char* method : {"standard", "wp:extra-states=1", "random-hads"}) {
      ExperimentOptions options;
      options.algorithm = algorithm.name;
      options.test_method = method;
      MealyOracle plain(machine), aware(machine);
      const ExperimentResult whole = run_experiment(plain, options);
      options.error_outputs = {"*closed"};
      const ExperimentResult result = run_experiment(aware, options);
      ASSERT_TRUE(result.is_complete()) << algorithm.name << " " << method;
      EXPECT_FALSE(find_distinguishing_word(result.model, machine)) << algorithm.name;
      EXPECT_LT(result.experiments, whole.experiments) << algorithm.name << " " << method;
      EXPECT_LT(result.symbols, whole.symbols) << algorithm.name << " " << method;
      EXPECT_EQ(result.is_weak(), whole.is_weak());
      EXPECT_EQ(result.model.origin.at("error_outputs"), "*closed");
      EXPECT_NE(result.guarantee.find("behind the outputs that end a session"), std::string::npos);
    }
  }
}

// Behind the end one of six inputs opens the session again.
TEST(Experiment, AnOutputThatDoesNotEndTheSessionIsFoundOut) {
  Mealy machine = protocol(5, 6);
  const auto end = static_cast<StateId>(machine.size() - 1);
  machine.set_transition(end, 3, 2, 0);
  for (const std::uint64_t seed : {1, 2, 3}) {
    ExperimentOptions options;
    options.testing.seed = seed;
    options.error_outputs = {"*closed"};
    MealyOracle system(machine);
    const ExperimentResult result = run_experiment(system, options);
    ASSERT_FALSE(result.is_complete());
    EXPECT_THROW(std::rethrow_exception(result.error), UsageError);
  }
}

TEST(Experiment, PerfectOracleSendsNothing) {
  const Mealy reference = example_machine(1);
  MealyOracle system(reference);
  ExperimentOptions options;
  options.test_method = "perfect";
  options.reference = &reference;
  const ExperimentResult result = run_experiment(system, options);
  EXPECT_TRUE(result.is_complete());
  EXPECT_FALSE(find_difference(result.model, reference).has_value());
  EXPECT_EQ(result.statistics.at(LearnPhase::testing), QueryCounts());
  EXPECT_GT(result.statistics.at(LearnPhase::refinement).queries, 0U);
  options.reference = nullptr;
  EXPECT_THROW(run_experiment(system, options), UsageError);
}

TEST(Experiment, SaysHowStrongItsModelIs) {
  const Mealy reference = example_machine(1);
  MealyOracle system(reference);
  ExperimentOptions options;
  options.test_method = "hads:extra-states=1";
  options.testing.sizes = {4, 10, 7};
  const ExperimentResult result = run_experiment(system, options);
  ASSERT_TRUE(result.strength);
  EXPECT_EQ(result.strength->strength, Strength{.extra_states = 1});
  EXPECT_TRUE(result.is_weak());
  EXPECT_EQ(result.strength->demand.pumped, 20U);
  const std::string random = std::to_string(2000 + 20 * 30 * 3);
  EXPECT_EQ(result.strength->shortfall(), "chained=3,pumped=20,random=" + random);
  EXPECT_EQ(result.model.origin.at("strength"), "weak: extra-states=1,chained=0,pumped=0,random=0");

  // What is demanded does not change what is weak.
  options.testing.strength = "chained=0,pumped=0,random=0";
  const ExperimentResult demanded = run_experiment(system, options);
  EXPECT_EQ(demanded.strength->shortfall(), "");
  EXPECT_TRUE(demanded.is_weak());
  options.testing.strength = "strong";
  EXPECT_THROW(run_experiment(system, options), UsageError);

  options.testing.strength = "";
  options.test_method = "perfect";
  options.reference = &reference;
  const ExperimentResult exact = run_experiment(system, options);
  EXPECT_FALSE(exact.is_weak());
  EXPECT_EQ(exact.model.origin.at("strength"), "exact");
}

// Its strength is what the suites of its last query reached, be that nothing; never that of a query
// about another hypothesis.
TEST(Experiment, ARunThatEndsEarlyKeepsWhatItsLastTestsEstablished) {
  const Mealy reference = example_machine(2);
  MealyOracle whole(reference);
  const ExperimentResult full = run_experiment(whole, {});
  const auto end_at = [&](std::uint64_t limit) {
    MealyOracle system(reference);
    ExperimentOptions options;
    options.max_experiments = limit;
    const ExperimentResult result = run_experiment(system, options);
    EXPECT_FALSE(result.is_complete());
    return result;
  };
  const ExperimentResult early = end_at(200);
  EXPECT_EQ(early.strength->strength, Strength());
  EXPECT_TRUE(early.is_weak());
  EXPECT_EQ(early.model.origin.at("strength"), "weak: chained=0,pumped=0,random=0");
  const ExperimentResult late = end_at(full.experiments - 1);
  EXPECT_EQ(late.strength->strength, full.strength->strength);
  EXPECT_FALSE(late.is_weak());
}

TEST(Experiment, SizesAreTheLengthsAmongTheOptions) {
  const auto sizes = [](std::map<std::string, std::string> options, const std::string& bound = "") {
    SulInfo info;
    info.options = std::move(options);
    info.bound = bound;
    return find_sizes(info);
  };
  using Sizes = std::vector<std::size_t>;
  EXPECT_EQ(sizes({{"depth", "10"}, {"max-blocking-time", "5"}, {"port", "7400"}}), Sizes{10});
  EXPECT_EQ(sizes({{"queue_size", "4"}, {"sub_queue_size", "same"}, {"step-limit", "99"}}),
            Sizes{4});
  EXPECT_EQ(sizes({{"max-samples", "0"}, {"history", "keep_last"}}), Sizes{});
  EXPECT_EQ(sizes({{"rcvhwm", "1000"}, {"sndhwm", "2"}, {"size", "3"}}), (Sizes{3, 2}))
      << "no more than three messages are in flight";
  EXPECT_EQ(sizes({{"rcvhwm", "1000"}, {"size", "0"}}), Sizes{1000});
  EXPECT_EQ(sizes({}, "at most 1 interrupt of the reader, at most 6 messages in flight"),
            (Sizes{1, 6}));
  EXPECT_GT(test_budget(true).symbols, test_budget(false).symbols);
}

TEST(Experiment, UnknownNamesAreUsageErrors) {
  const Mealy reference = example_machine(1);
  MealyOracle system(reference);
  ExperimentOptions options;
  options.algorithm = "magic";
  EXPECT_THROW(run_experiment(system, options), UsageError);
  options.algorithm = "";
  options.test_method = "magic";
  EXPECT_THROW(run_experiment(system, options), UsageError);
}

TEST(Experiment, ALimitIsKeptExactlyAndTheLastHypothesisIsGivenBack) {
  const Mealy reference = example_machine(2);
  for (const std::uint64_t limit : {1U, 10U, 200U, 1000U}) {
    MealyOracle system(reference);
    ExperimentOptions options;
    options.max_experiments = limit;
    const ExperimentResult result = run_experiment(system, options);
    ASSERT_FALSE(result.is_complete());
    EXPECT_THROW(std::rethrow_exception(result.error), Interrupted);
    EXPECT_EQ(result.experiments, limit);
    EXPECT_EQ(result.model.size() == 0, limit < reference.inputs().size());
    EXPECT_TRUE(result.model.is_complete());
  }
}

// A system that stops the run, fails, or kills the process after a number of words.
class FailingOracle : public MealyOracle {
 public:
  FailingOracle(const Mealy& machine, std::uint64_t words, std::function<void()> end)
      : MealyOracle(machine), words_(words), end_(std::move(end)) {}
  using MealyOracle::ask;
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    std::vector<MealyAnswer> answers;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (asked_++ == words_) {
        try {
          end_();
        } catch (...) {
          for (std::size_t j = 0; j < i; ++j) sink(j, answers[j]);
          throw;
        }
      }
      answers.push_back(MealyOracle::ask(batch.subspan(i, 1), control, {}).front());
    }
    return answers;
  }
  std::uint64_t asked() const { return asked_; }

 private:
  std::uint64_t words_, asked_ = 0;
  std::function<void()> end_;
};

TEST(Experiment, AFailureIsInTheResult) {
  const Mealy reference = example_machine(3);
  FailingOracle system(reference, 300, [] { throw WrapperError("it died", "test"); });
  const ExperimentResult result = run_experiment(system, {});
  ASSERT_FALSE(result.is_complete());
  EXPECT_THROW(std::rethrow_exception(result.error), WrapperError);
  EXPECT_EQ(result.experiments, 300U);
  EXPECT_GT(result.model.size(), 0U);
}

TEST(Experiment, AStopTokenEndsTheRun) {
  const Mealy reference = example_machine(4);
  std::stop_source source;
  FailingOracle system(reference, 100, [&] { source.request_stop(); });
  RunControl control;
  control.stop = source.get_token();
  const ExperimentResult result = run_experiment(system, {}, control);
  ASSERT_FALSE(result.is_complete());
  EXPECT_THROW(std::rethrow_exception(result.error), Interrupted);
}

class Resume : public testing::TestWithParam<std::string> {
 protected:
  ExperimentOptions options() const {
    ExperimentOptions result;
    result.algorithm = GetParam();
    result.cache_file = directory.path() / "cache";
    result.fingerprint = {{"depth", "3"}};
    return result;
  }
  TempDir directory;
};

INSTANTIATE_TEST_SUITE_P(All, Resume, testing::Values("rs", "lmplus", "lsharp"),
                         [](const auto& entry) { return entry.param; });

// Words that reach the system in an uninterrupted run, and its model.
ExperimentResult run_uninterrupted(const Mealy& reference, const std::string& algorithm) {
  MealyOracle system(reference);
  ExperimentOptions options;
  options.algorithm = algorithm;
  return run_experiment(system, options);
}

void expect_same_model(const Mealy& left, const Mealy& right) {
  EXPECT_EQ(left.outputs(), right.outputs());  // the numbering, too
  EXPECT_EQ(left.size(), right.size());
  EXPECT_FALSE(find_difference(left, right).has_value());
}

// Outputs become known to it only as they are seen, as those of a real system.
class ForgetfulOracle : public OutputOracle {
 public:
  explicit ForgetfulOracle(OutputOracle& system) : system_(system) {}
  using OutputOracle::ask;
  const Alphabet& inputs() const override { return system_.inputs(); }
  const Alphabet& outputs() const override { return outputs_; }
  Symbol intern_output(std::string_view name) override { return outputs_.intern(name); }
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control,
                               const PartialSink& sink) override {
    const auto rename = [this](MealyAnswer answer) {
      for (Symbol& output : answer.outputs) {
        output = outputs_.intern(system_.outputs().name(output));
      }
      return answer;
    };
    std::vector<Query> asked(batch.begin(), batch.end());
    for (Query& query : asked) {
      if (auto* tree = std::get_if<DecisionTree>(&query)) rename_branches(*tree);
    }
    auto answers = system_.ask(asked, control, [&](std::size_t index, const MealyAnswer& answer) {
      if (sink) sink(index, rename(answer));
    });
    for (MealyAnswer& answer : answers) answer = rename(std::move(answer));
    return answers;
  }

 private:
  void rename_branches(DecisionTree& tree) const {
    for (DecisionTree::Node& node : tree.nodes) {
      for (auto& [output, child] : node.branches) {
        output = system_.outputs().at(outputs_.name(output));
      }
    }
  }

  OutputOracle& system_;
  Alphabet outputs_;
};

TEST_P(Resume, AskNothingTwiceAndReachTheSameModel) {
  const Mealy reference = example_machine(5);
  MealyOracle whole_machine(reference);
  ForgetfulOracle whole(whole_machine);
  ExperimentOptions uncached = options();
  uncached.cache_file.clear();
  const ExperimentResult expected = run_experiment(whole, uncached);
  ASSERT_TRUE(expected.is_complete());

  std::uint64_t experiments = 0;
  int runs = 0;
  while (true) {
    ++runs;
    FailingOracle machine(reference, 333, [] { throw WrapperError("it died", "test"); });
    ForgetfulOracle system(machine);
    const ExperimentResult result = run_experiment(system, options());
    experiments += result.experiments;
    if (!result.is_complete()) continue;
    expect_same_model(result.model, expected.model);
    break;
  }
  EXPECT_GT(runs, 5);
  EXPECT_EQ(experiments, expected.experiments);

  FailingOracle unused(reference, 0, [] { throw WrapperError("asked again", "test"); });
  ForgetfulOracle system(unused);
  const ExperimentResult again = run_experiment(system, options());
  EXPECT_TRUE(again.is_complete());
  EXPECT_EQ(again.experiments, 0U);
  expect_same_model(again.model, expected.model);
}

TEST_P(Resume, AKillLosesAtMostTheBatchInFlight) {
  const Mealy reference = example_machine(6);
  const ExperimentResult expected = run_uninterrupted(reference, GetParam());
  std::uint64_t experiments = 0;
  for (const std::uint64_t words : {100U, 700U, 701U, 1500U}) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      FailingOracle system(reference, words, [] { kill(getpid(), SIGKILL); });
      run_experiment(system, options());
      _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << "not killed after " << words;
    experiments += words;
  }
  MealyOracle system(reference);
  const ExperimentResult result = run_experiment(system, options());
  ASSERT_TRUE(result.is_complete());
  expect_same_model(result.model, expected.model);
  experiments += result.experiments;
  EXPECT_GE(experiments, expected.experiments);
  EXPECT_LT(experiments, expected.experiments + 4 * 64);
}

TEST_P(Resume, AnotherSystemIsRefused) {
  const Mealy reference = example_machine(7);
  MealyOracle system(reference);
  ExperimentOptions first = options();
  first.max_experiments = 100;
  run_experiment(system, first);
  ExperimentOptions second = options();
  second.fingerprint["depth"] = "4";
  try {
    run_experiment(system, second);
    FAIL() << "not refused";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("depth is '3' there, '4' here"), std::string::npos)
        << error.what();
  }
}

// Keeps the reports.
class Observer : public ProgressObserver {
 public:
  void on_progress(const Progress& progress) override {
    EXPECT_GE(progress.words, words);
    EXPECT_FALSE(progress.phase.empty());
    words = progress.words;
    ++reports;
  }
  std::uint64_t words = 0;
  int reports = 0;
};

TEST(Experiment, ProgressCountsWhatReachedTheSystem) {
  const Mealy reference = example_machine(8);
  MealyOracle system(reference);
  Observer observer;
  RunControl control;
  control.progress = &observer;
  const ExperimentResult result = run_experiment(system, {}, control);
  EXPECT_EQ(observer.words, result.experiments);
  EXPECT_GT(observer.reports, 10);
}

// A cache answers all of a run whose model nobody has confirmed: that is done now, and once.
TEST(Confirmation, IsKeptWithTheCache) {
  const Mealy reference = example_machine(8);
  MealyOracle system(reference);
  const TempDir folder;
  ExperimentOptions options;
  options.cache_file = folder.path() / "cache";
  const ExperimentResult unconfirmed = run_experiment(system, options);
  EXPECT_EQ(unconfirmed.statistics.at(LearnPhase::confirmation).queries, 0U);

  int opened = 0;
  SlowerSystem slower{[&] {
                        ++opened;
                        return std::make_unique<MealyOracle>(reference);
                      },
                      "floor=10"};
  options.slower = slower;
  const ExperimentResult confirmed = run_experiment(system, options);
  EXPECT_EQ(opened, 1);
  EXPECT_GT(confirmed.experiments, 0U);
  EXPECT_EQ(confirmed.experiments, confirmed.statistics.at(LearnPhase::confirmation).queries);
  const ExperimentResult again = run_experiment(system, options);
  EXPECT_EQ(opened, 1);
  EXPECT_EQ(again.experiments, 0U);
  EXPECT_NE(again.guarantee.find("confirmed with longer waits (floor=10) by a run before"),
            std::string::npos)
      << again.guarantee;
  options.slower->waits = "floor=20";
  run_experiment(system, options);
  EXPECT_EQ(opened, 2);
}

// What does not agree with longer waits is no more confirmed by a second look.
TEST(Confirmation, ThatFailedIsNotKept) {
  const Mealy reference = example_machine(8);
  Mealy slower = reference;
  for (StateId state = 0; state < slower.size(); ++state) {
    slower.set_transition(state, 0, (reference.output(state, 0) + 1) % 3,
                          reference.target(state, 0));
  }
  MealyOracle system(reference);
  const TempDir folder;
  ExperimentOptions options;
  options.cache_file = folder.path() / "cache";
  options.slower = SlowerSystem{[&] { return std::make_unique<MealyOracle>(slower); }, "floor=10"};
  for (int run = 0; run < 2; ++run) {
    const ExperimentResult result = run_experiment(system, options);
    ASSERT_FALSE(result.is_complete());
    EXPECT_THROW(std::rethrow_exception(result.error), Error);
  }
}

}  // namespace
}  // namespace maide
