// Laws of learning nondeterministic machines: random ones are learned exactly, deterministic ones
// as any other learner learns them, and simulated automata down to an automaton with the same
// traces.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "maide/automata/compare.hpp"
#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/nondeterministic_run.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/simulated_sul.hpp"

namespace maide {
namespace {

// A random machine in which some inputs may be answered in a second way.
NondeterministicMealy random_machine(std::size_t states, Random& random) {
  const RandomMealyOptions options{.states = states, .inputs = 2, .outputs = 3};
  NondeterministicMealy machine(random_mealy(options, random));
  for (StateId state = 0; state < states; ++state) {
    for (Symbol input = 0; input < 2; ++input) {
      const auto output = static_cast<Symbol>(random.below(3));
      const auto target = static_cast<StateId>(random.below(states));
      if (!random.chance(0.4)) continue;
      if (machine.successor(state, input, output) != Mealy::no_state) continue;
      machine.add_choice(state, input, output, target);
    }
  }
  return machine;
}

// Plays a machine; chance decides between its answers.
class ChanceOracle : public OutputOracle {
 public:
  using OutputOracle::ask;
  ChanceOracle(const NondeterministicMealy& machine, std::uint64_t seed)
      : machine_(machine), outputs_(machine.outputs()), random_(seed) {}
  const Alphabet& inputs() const override { return machine_.inputs(); }
  const Alphabet& outputs() const override { return outputs_; }
  Symbol intern_output(std::string_view name) override { return outputs_.intern(name); }
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl&,
                               const PartialSink&) override {
    std::vector<MealyAnswer> answers(batch.size());
    for (std::size_t i = 0; i < batch.size(); ++i) {
      StateId state = machine_.initial();
      play_query(batch[i], answers[i], [&](Symbol input) -> std::optional<Symbol> {
        const auto choices = machine_.choices(state, input);
        const auto& choice = choices[random_.below(choices.size())];
        state = choice.target;
        return choice.output;
      });
    }
    return answers;
  }

 private:
  const NondeterministicMealy& machine_;
  Alphabet outputs_;
  Random random_;
};

TEST(NondeterministicLaws, RandomMachinesAreLearnedExactly) {
  Random random(11);
  int nondeterministic = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const NondeterministicMealy machine = random_machine(random.between(1, 5), random);
    nondeterministic += machine.is_deterministic() ? 0 : 1;
    ChanceOracle oracle(machine, seed);
    ExperimentOptions options;
    options.testing.extra_states = 2;
    options.testing.seed = seed;
    const NondeterministicResult result = run_nondeterministic_experiment(oracle, options);
    ASSERT_TRUE(result.experiment.is_complete()) << "seed " << seed;
    EXPECT_FALSE(find_difference(result.model, machine).has_value()) << "seed " << seed;
    EXPECT_EQ(result.model.size(), minimize(machine).size()) << "seed " << seed;
  }
  EXPECT_GT(nondeterministic, 25);
}

TEST(NondeterministicLaws, TheSameSeedIsTheSameRun) {
  Random random(12);
  const NondeterministicMealy machine = random_machine(4, random);
  std::uint64_t symbols[2] = {};
  for (std::uint64_t& sent : symbols) {
    ChanceOracle oracle(machine, 3);
    sent = run_nondeterministic_experiment(oracle, {}).experiment.symbols;
  }
  EXPECT_EQ(symbols[0], symbols[1]);
}

TEST(NondeterministicLaws, DeterministicSystemsAreLearnedAsByAnyOtherLearner) {
  int learned = 0;
  for (const auto& entry : std::filesystem::directory_iterator(MAIDE_SOURCE_DIR "/tests/models")) {
    if (entry.path().extension() != ".dot") continue;
    const InterfaceAutomaton reference = read_interface_automaton(entry.path());
    if (reference.size() > 12) continue;
    SimulatedSul sul(reference, "sim");
    ExperimentOptions options;
    options.algorithm = "nstar";
    const LearnedModel model = learn_model(sul, Translation::eager, options);
    ASSERT_TRUE(model.experiment.is_complete()) << entry.path();
    ASSERT_TRUE(std::holds_alternative<InterfaceAutomaton>(*model.model));
    options.algorithm = "rs";
    const LearnedModel other = learn_model(sul, Translation::eager, options);
    const auto& automaton = std::get<InterfaceAutomaton>(*model.model);
    const auto& expected = std::get<InterfaceAutomaton>(*other.model);
    EXPECT_TRUE(compare(automaton, expected).same()) << entry.path();
    EXPECT_EQ(automaton.size(), expected.size()) << entry.path();
    EXPECT_EQ(automaton.hidden_returns, expected.hidden_returns) << entry.path();
    ++learned;
  }
  EXPECT_GE(learned, 5);
}

InterfaceAutomaton lossy_buffer() {
  return read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/nondeterministic/lossy.dot");
}

TEST(NondeterministicLaws, ALossyBufferIsNoMealyMachineAndIsLearnedAsWhatItIs) {
  SimulatedSul sul(lossy_buffer(), "sim");
  EXPECT_FALSE(sul.is_deterministic());
  const LearnedModel rejected = learn_model(sul, Translation::eager, {});
  ASSERT_FALSE(rejected.experiment.is_complete());
  EXPECT_THROW(std::rethrow_exception(rejected.experiment.error), NondeterminismError);

  ExperimentOptions options;
  options.algorithm = "nstar";
  const LearnedModel learned = learn_model(sul, Translation::eager, options);
  ASSERT_TRUE(learned.experiment.is_complete());
  const auto& automaton = std::get<InterfaceAutomaton>(*learned.model);
  EXPECT_FALSE(automaton.is_deterministic());
  EXPECT_TRUE(compare(automaton, lossy_buffer()).same());
  EXPECT_THROW(learn_model(sul, Translation::av, options), UsageError);
}

TEST(NondeterministicLaws, ACacheOfOneAnswerAWordIsRefused) {
  Random random(14);
  const NondeterministicMealy machine = random_machine(2, random);
  ChanceOracle oracle(machine, 0);
  ExperimentOptions options;
  options.cache_file = "cache";
  EXPECT_THROW(run_nondeterministic_experiment(oracle, options), UsageError);
}

TEST(NondeterministicLaws, ALimitIsKept) {
  Random random(13);
  const NondeterministicMealy machine = random_machine(4, random);
  ChanceOracle oracle(machine, 0);
  ExperimentOptions options;
  options.max_experiments = 100;
  const NondeterministicResult result = run_nondeterministic_experiment(oracle, options);
  ASSERT_FALSE(result.experiment.is_complete());
  EXPECT_THROW(std::rethrow_exception(result.experiment.error), Interrupted);
  EXPECT_EQ(result.experiment.experiments, 100U);
}

}  // namespace
}  // namespace maide
