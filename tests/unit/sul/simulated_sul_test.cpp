#include "maide/sul/simulated_sul.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/sul/ia_translator.hpp"
#include "port_models.hpp"

namespace maide {
namespace {

// All words over `symbols` symbols of length `length`.
std::vector<Query> all_words(Symbol symbols, std::size_t length) {
  std::vector<Query> words;
  Word word(length, 0);
  for (;;) {
    words.emplace_back(word);
    std::size_t i = 0;
    while (i < length && ++word[i] == symbols) word[i++] = 0;
    if (i == length) return words;
  }
}

TEST(SimulatedSul, AnswersAsItsReferenceMachineDoes) {
  for (const InterfaceAutomaton& port :
       {test::blocking_port_with_written(), test::buffered_port(), test::strict_port(2, true)}) {
    for (const Translation translation : {Translation::eager, Translation::av}) {
      SimulatedSul sul(port, "sim");
      IaTranslator translator(sul, translation);
      const Mealy reference = sul.reference(translation);
      const auto symbols = static_cast<Symbol>(translator.inputs().size());
      const std::vector<Query> batch = all_words(symbols, 6);
      const auto answers = translator.run(batch);
      for (std::size_t i = 0; i < batch.size(); ++i) {
        const Word& word = std::get<Word>(batch[i]);
        EXPECT_EQ(to_string(answers[i].outputs, translator.outputs()),
                  to_string(reference.output_word(word), reference.outputs()))
            << to_string(word, translator.inputs());
      }
      const InterfaceAutomaton back = translator.to_interface_automaton(reference);
      EXPECT_EQ(back.size(), port.size());
      EXPECT_EQ(back.transition_count(), port.transition_count());
      EXPECT_EQ(back.hidden_returns, port.hidden_returns);
      EXPECT_EQ(back.actors, port.actors);
    }
  }
}

TEST(SimulatedSul, AnswersPlainMachinesWhole) {
  Mealy machine({"a"}, {}, 2);
  machine.set_transition(0, 0, machine.intern_output("x,y"), 1);
  machine.set_transition(1, 0, machine.intern_output("quiet"), 0);
  SimulatedSul sul(machine, "sim");
  EXPECT_THROW(IaTranslator(sul, Translation::av), UsageError);
  IaTranslator translator(sul, Translation::eager);
  const auto answers = translator.run(std::vector<Query>{Word{0, 0, 0}});
  EXPECT_EQ(to_string(answers[0].outputs, translator.outputs()), "x,y quiet x,y");
}

TEST(SimulatedSul, TakesFurtherPurposes) {
  SimulatedSul sul(test::buffered_port(), "sim");
  const std::vector<std::string> sends{"write"}, receives{"message"};
  sul.add_purpose(LearningPurpose::in_flight(2, 0, sends, receives, AtBound::refuse));
  IaTranslator translator(sul, Translation::eager);
  const auto answers = translator.run(std::vector<Query>{Word{0, 0, 0, 1, 0}});
  EXPECT_EQ(to_string(answers[0].outputs, translator.outputs()),
            "quiet quiet unexplored message quiet");
}

TEST(SimulatedSul, RefusesWhatItCannotPlay) {
  InterfaceAutomaton endless({"a"}, {"tick"}, 2);
  endless.add_transition(0, {Action::Kind::input, 0}, 1);
  endless.add_transition(1, {Action::Kind::output, 0}, 1);
  EXPECT_THROW(SimulatedSul(endless, "sim"), UsageError);
}

TEST(IaTranslator, RefusesNamesWithAMeaningOfTheirOwn) {
  InterfaceAutomaton automaton({"a"}, {"quiet"}, 2);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  automaton.add_transition(1, {Action::Kind::output, 0}, 0);
  SimulatedSul sul(automaton, "sim");
  EXPECT_THROW(IaTranslator(sul, Translation::eager), UsageError);
}

}  // namespace
}  // namespace maide
