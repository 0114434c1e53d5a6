// The exported C++ class, compiled with all warnings as errors, answers random words as the model
// does.
#include <gtest/gtest.h>

#include <sstream>

#include "maide/automata/random_automata.hpp"
#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

// Compiles the class with `driver` and returns what it prints when it reads `input`.
std::string run_export(const Model& model, const std::string& driver, const std::string& input) {
  const TempDir folder;
  std::ostringstream header;
  write_cpp(header, model, "Machine");
  write_file_atomically(folder.path() / "machine.hpp", header.str());
  write_file_atomically(folder.path() / "main.cpp", driver);
  SubprocessOptions options;
  options.folder = folder.path();
  const SubprocessResult compiled =
      run_program({MAIDE_CXX_COMPILER, "-std=c++20", "-Wall", "-Wextra", "-Wpedantic", "-Werror",
                   "-o", "main", "main.cpp"},
                  options);
  EXPECT_TRUE(compiled.succeeded()) << compiled.err << header.str();
  options.input = input;
  const SubprocessResult result = run_program({"./main"}, options);
  EXPECT_TRUE(result.succeeded()) << result.err;
  return result.out;
}

// A line for each step: the output's name. "-" resets.
const char* const mealy_driver = R"(#include "machine.hpp"
#include <iostream>
#include <string>
int main() {
  Machine machine;
  for (std::string word; std::cin >> word;) {
    if (word == "-") {
      machine.reset();
    } else {
      const auto output = machine.step(static_cast<Machine::Input>(std::stoul(word)));
      std::cout << Machine::output_names[static_cast<std::size_t>(output)] << "\n";
    }
  }
}
)";

void expect_mealy_export_agrees(const Mealy& machine, Random& random) {
  std::string input, expected;
  StateId state = machine.initial();
  for (int step = 0; step < 2000; ++step) {
    if (random.chance(0.05)) {
      input += "- ";
      state = machine.initial();
      continue;
    }
    const auto symbol = static_cast<Symbol>(random.below(machine.inputs().size()));
    input += std::to_string(symbol) + " ";
    expected += machine.outputs().name(machine.output(state, symbol)) + "\n";
    state = machine.target(state, symbol);
  }
  EXPECT_EQ(run_export(machine, mealy_driver, input), expected);
}

TEST(CppExport, MealyMachinesAnswerAsTheModel) {
  Random random(31);
  Mealy machine = random_mealy({40, 4, 5}, random);
  machine.set_initial(7);
  expect_mealy_export_agrees(machine, random);
}

TEST(CppExport, NamesOfAnyKindCompile) {
  Random random(32);
  const Alphabet names{"class", "in put", "in-put", "\"", "?\?=", "\\", "zwölf", "1", "_A", "EOF"};
  Mealy machine(names, names, 3);
  for (StateId state = 0; state < 3; ++state) {
    for (Symbol input = 0; input < names.size(); ++input) {
      machine.set_transition(state, input, static_cast<Symbol>(random.below(names.size())),
                             static_cast<StateId>(random.below(3)));
    }
  }
  machine.origin = {{"a\\", "b\nc\\"}};
  expect_mealy_export_agrees(machine, random);
}

// A line for each request: i N gives an input, o N takes an output, q asks for quiescence.
const char* const automaton_driver = R"(#include "machine.hpp"
#include <iostream>
#include <string>
int main() {
  Machine machine;
  std::string what;
  unsigned long number = 0;
  while (std::cin >> what >> number) {
    if (what == "i") {
      const auto input = static_cast<Machine::Input>(number);
      const auto answer = machine.try_input(input);
      const bool can = machine.can(input);
      std::cout << static_cast<int>(answer) << can << machine.input(input) << "\n";
    } else if (what == "o") {
      const auto output = static_cast<Machine::Output>(number);
      const bool due = machine.is_due(output);
      std::cout << due << machine.take(output) << "\n";
    } else if (what == "q") {
      std::cout << machine.is_quiescent() << "\n";
    } else {
      machine.reset();
    }
  }
}
)";

// 0 accepted, 1 refused, 2 never tried, as the class counts.
int answer_of(const InterfaceAutomaton& automaton, StateId state, Symbol input) {
  for (const auto& transition : automaton.transitions(state)) {
    if (transition.action == Action{Action::Kind::input, input}) return transition.absorbed ? 2 : 0;
  }
  return automaton.is_unexplored(state, input) ? 2 : 1;
}

void expect_automaton_export_agrees(const InterfaceAutomaton& automaton, Random& random) {
  std::ostringstream input, expected;
  StateId state = automaton.initial();
  for (int step = 0; step < 3000; ++step) {
    const std::uint64_t kind = random.below(20);
    if (kind == 0) {
      input << "r 0 ";
      state = automaton.initial();
    } else if (kind == 1) {
      input << "q 0 ";
      expected << automaton.is_quiescent(state) << "\n";
    } else if (kind < 12 && !automaton.inputs().empty()) {
      const auto symbol = static_cast<Symbol>(random.below(automaton.inputs().size()));
      input << "i " << symbol << " ";
      const int answer = answer_of(automaton, state, symbol);
      expected << answer << (answer == 0) << (answer == 0) << "\n";
      if (answer == 0) state = automaton.successor(state, {Action::Kind::input, symbol});
    } else if (!automaton.outputs().empty()) {
      const auto symbol = static_cast<Symbol>(random.below(automaton.outputs().size()));
      input << "o " << symbol << " ";
      const StateId next = automaton.successor(state, {Action::Kind::output, symbol});
      expected << (next != Mealy::no_state) << (next != Mealy::no_state) << "\n";
      if (next != Mealy::no_state) state = next;
    }
  }
  EXPECT_EQ(run_export(automaton, automaton_driver, input.str()), expected.str());
}

TEST(CppExport, InterfaceAutomataAnswerAsTheModel) {
  Random random(33);
  expect_automaton_export_agrees(
      read_interface_automaton(MAIDE_SOURCE_DIR "/tests/models/strict-3-tryread-absorb.dot"),
      random);
  expect_automaton_export_agrees(
      random_interface_automaton({30, 4, 4, 0.4, 0.3, 0.2, true}, random), random);
}

TEST(CppExport, AlphabetsMayBeEmpty) {
  Random random(34);
  InterfaceAutomaton automaton({"a"}, {}, 2);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  expect_automaton_export_agrees(automaton, random);
}

TEST(CppExport, NondeterminismIsRefused) {
  InterfaceAutomaton automaton({"a"}, {}, 2);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  automaton.add_transition(0, {Action::Kind::input, 0}, 0);
  std::ostringstream out;
  EXPECT_THROW(write_cpp(out, automaton, "Machine"), UsageError);
}

}  // namespace
}  // namespace maide
