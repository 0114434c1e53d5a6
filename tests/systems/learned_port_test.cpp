// The reference port learned for real, over its wrapper's pipes: the models written by hand, in
// both translations, with the sizes of the paper's Table 1.
#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <string>

#include "maide/automata/compare.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"

namespace maide {
namespace {

struct Row {
  std::string model;  // of tests/models
  std::map<std::string, std::string> options;
  std::size_t states, transitions;
  std::size_t unexplored;  // states that are marked so
};

void PrintTo(const Row& row, std::ostream* out) { *out << row.model; }

std::map<std::string, std::string> strict(const std::string& size, bool tryread = false,
                                          bool absorb = false) {
  return {{"kind", "strict"},
          {"size", size},
          {"inputs", tryread ? "write,read,tryread" : "write,read"},
          {"at-bound", absorb ? "absorb" : "refuse"}};
}

InterfaceAutomaton learn(const std::map<std::string, std::string>& options,
                         Translation translation) {
  const auto sul = spawn_wrapper({MAIDE_BINARY_DIR "/bin/maide-wrap-port"}, options);
  IaTranslator translator(*sul, translation);
  const ExperimentResult result = run_experiment(translator, ExperimentOptions{});
  if (result.error) std::rethrow_exception(result.error);
  return translator.to_interface_automaton(result.model);
}

class LearnedPort : public testing::TestWithParam<std::tuple<Row, Translation>> {};

TEST_P(LearnedPort, IsTheModelWrittenByHand) {
  const auto& [row, translation] = GetParam();
  const InterfaceAutomaton learned = learn(row.options, translation);
  const auto reference = std::get<InterfaceAutomaton>(
      read_model(MAIDE_SOURCE_DIR "/tests/models/" + row.model + ".dot"));
  EXPECT_TRUE(compare(learned, reference).same());
  EXPECT_EQ(learned.size(), row.states);
  EXPECT_EQ(learned.transition_count(), row.transitions);
  std::size_t unexplored = 0;
  for (StateId state = 0; state < learned.size(); ++state) {
    if (!learned.unexplored(state).empty()) ++unexplored;
  }
  EXPECT_EQ(unexplored, row.unexplored);
}

// A strict buffer for one message at most and a rendezvous: only what was never tried tells them
// apart.
TEST(LearnedPorts, StrictOneAndPortDifferInAMarkAlone) {
  const InterfaceAutomaton buffer = learn(strict("1"), Translation::eager);
  const InterfaceAutomaton rendezvous = learn({{"kind", "port"}}, Translation::eager);
  const IaComparison comparison = compare(buffer, rendezvous);
  EXPECT_TRUE(comparison.differ_in_marks_alone());
  EXPECT_EQ(comparison.soft.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(
    Table1, LearnedPort,
    testing::Combine(testing::Values(Row{"port", {{"kind", "port"}}, 4, 5, 0},
                                     Row{"buffered", {{"kind", "buffered"}}, 4, 6, 0},
                                     Row{"buffered-tryread",
                                         {{"kind", "buffered"}, {"inputs", "write,read,tryread"}},
                                         4,
                                         8,
                                         0},
                                     Row{"strict-1", strict("1"), 4, 5, 1},
                                     Row{"strict-2", strict("2"), 6, 8, 1},
                                     Row{"strict-3", strict("3"), 8, 11, 1},
                                     Row{"strict-4", strict("4"), 10, 14, 1},
                                     Row{"strict-5", strict("5"), 12, 17, 1},
                                     Row{"strict-6", strict("6"), 14, 20, 1},
                                     Row{"strict-3-tryread", strict("3", true), 8, 15, 1},
                                     Row{"strict-3-tryread-absorb", strict("3", true, true), 8, 16,
                                         0}),
                     testing::Values(Translation::eager, Translation::av)),
    [](const auto& row) {
      std::string name = std::get<Row>(row.param).model;
      std::replace(name.begin(), name.end(), '-', '_');
      return name + (std::get<Translation>(row.param) == Translation::av ? "_av" : "_eager");
    });

}  // namespace
}  // namespace maide
