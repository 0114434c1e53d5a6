// The exported Promela through spin and pan: as many states and transitions as the model, and the
// same words.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "maide/automata/random_automata.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

struct PanResult {
  long errors = -1, states = -1, transitions = -1;
};

long number_before(const std::string& text, const std::string& what) {
  std::smatch match;
  return std::regex_search(text, match, std::regex("(\\d+) " + what)) ? std::stol(match[1]) : -1;
}

// Depth-first, without partial-order reduction, so that the counts are the model's.
PanResult run_pan(const std::string& promela) {
  const TempDir folder;
  SubprocessOptions options;
  options.folder = folder.path();
  write_file_atomically(folder.path() / "m.pml", promela);
  const SubprocessResult generated = run_program({"spin", "-a", "m.pml"}, options);
  EXPECT_TRUE(generated.succeeded()) << generated.out << generated.err << promela;
  EXPECT_EQ(generated.out.find("rror"), std::string::npos) << generated.out;
  const SubprocessResult compiled =
      run_program({"cc", "-w", "-DNOREDUCE", "-DSAFETY", "-o", "pan", "pan.c"}, options);
  EXPECT_TRUE(compiled.succeeded()) << compiled.err;
  const SubprocessResult result = run_program({"./pan", "-m100000", "-w18"}, options);
  PanResult counts;
  counts.states = number_before(result.out, "states, stored");
  counts.transitions = number_before(result.out, "transitions");
  std::smatch match;
  if (std::regex_search(result.out, match, std::regex("errors: (\\d+)"))) {
    counts.errors = std::stol(match[1]);
  }
  return counts;
}

std::string promela_of(const Model& model) {
  std::ostringstream out;
  write_promela(out, model);
  return out.str();
}

// What pan should see: reachable states and transitions, the state end_unexplored, the state before
// init's first step; the two `run` steps.
PanResult expected_counts(const InterfaceAutomaton& automaton) {
  std::vector<StateId> queue{automaton.initial()};
  std::set<StateId> seen{automaton.initial()};
  PanResult counts{0, 1, 2};
  bool stops = false;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    ++counts.states;
    std::set<Symbol> untried(automaton.unexplored(queue[next]).begin(),
                             automaton.unexplored(queue[next]).end());
    for (const auto& transition : automaton.transitions(queue[next])) {
      if (transition.absorbed) {
        untried.insert(transition.action.symbol);
        continue;
      }
      ++counts.transitions;
      if (seen.insert(transition.target).second) queue.push_back(transition.target);
    }
    counts.transitions += static_cast<long>(untried.size());
    stops |= !untried.empty();
  }
  counts.states += stops ? 1 : 0;
  return counts;
}

void expect_counts_agree(const InterfaceAutomaton& automaton) {
  const PanResult counts = run_pan(promela_of(automaton));
  const PanResult expected = expected_counts(automaton);
  EXPECT_EQ(counts.errors, 0);
  EXPECT_EQ(counts.states, expected.states);
  EXPECT_EQ(counts.transitions, expected.transitions);
}

TEST(PromelaExport, PanCountsTheReferenceModels) {
  for (const char* name : {"port", "strict-3", "strict-3-tryread-absorb", "buffered-tryread"}) {
    SCOPED_TRACE(name);
    expect_counts_agree(
        read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/" + std::string(name) + ".dot"));
  }
}

TEST(PromelaExport, PanCountsRandomAutomata) {
  Random random(41);
  for (int round = 0; round < 4; ++round) {
    InterfaceAutomaton automaton = random_interface_automaton(
        {5 + random.below(40), 3, 3, 0.4, 0.2, 0.1, round % 2 == 0}, random);
    automaton.set_initial(static_cast<StateId>(random.below(automaton.size())));
    expect_counts_agree(automaton);
  }
}

// Each transition of a Mealy machine is two steps, and has a state of its own between them.
TEST(PromelaExport, PanCountsMealyMachines) {
  Random random(42);
  const Mealy machine = random_mealy({20, 3, 3}, random);
  const PanResult counts = run_pan(promela_of(machine));
  EXPECT_EQ(counts.errors, 0);
  EXPECT_EQ(counts.states, 20 + 60 + 1);
  EXPECT_EQ(counts.transitions, 120 + 2);
}

TEST(PromelaExport, LargeAlphabetsAndStrangeNames) {
  InterfaceAutomaton large({}, {}, 2);
  for (int number = 0; number < 300; ++number) {
    large.add_transition(0, {Action::Kind::output, large.intern_output(std::to_string(number))},
                         number % 2);
  }
  expect_counts_agree(large);
  InterfaceAutomaton strange({"do", "in put", "in-put", "*/ a", "unix", "end_s0"},
                             {"do", "\"", "never"}, 1);
  for (Symbol symbol = 0; symbol < 6; ++symbol) {
    strange.add_transition(0, {Action::Kind::input, symbol}, 0);
  }
  for (Symbol symbol = 0; symbol < 3; ++symbol) {
    strange.add_transition(0, {Action::Kind::output, symbol}, 0);
  }
  expect_counts_agree(strange);
}

// A system around the process type of strict-2: one program that plays `steps`. pan finds an error,
// an invalid end state, if the program cannot reach its end.
long errors_of(const std::string& steps, PromelaUnexplored unexplored) {
  std::ostringstream out;
  out << "mtype = { write, read, message };\n";
  PromelaProctypeOptions options;
  options.inputs = {"write", "read"};
  options.outputs = {"message"};
  options.unexplored = unexplored;
  write_promela_proctype(
      out, read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/strict-2.dot"), "Via", options);
  out << R"(
chan in_ = [0] of { mtype };
chan out_ = [0] of { mtype };
active proctype Program() {
  run Via(in_, out_);
  )" << steps
      << "\n}\n";
  return run_pan(out.str()).errors;
}

TEST(PromelaExport, TheProcessTypeTakesTheModelsWords) {
  const auto wait = PromelaUnexplored::wait;
  EXPECT_EQ(errors_of("in_!write; in_!write; in_!read; out_?message", wait), 0);
  EXPECT_EQ(errors_of("in_!write; in_!read; out_?message; out_?message", wait), 1);
  EXPECT_EQ(errors_of("in_!read; in_!read", wait), 1);
}

TEST(PromelaExport, UnexploredInputsDoAsAsked) {
  const std::string writes = "in_!write; in_!write; in_!write";
  EXPECT_EQ(errors_of(writes, PromelaUnexplored::wait), 1);
  EXPECT_EQ(errors_of(writes, PromelaUnexplored::drop), 0);
  EXPECT_EQ(errors_of(writes, PromelaUnexplored::stop), 0);
  EXPECT_EQ(errors_of(writes + "; in_!read", PromelaUnexplored::drop), 0);
  EXPECT_EQ(errors_of(writes + "; in_!read", PromelaUnexplored::stop), 1);
}

}  // namespace
}  // namespace maide
