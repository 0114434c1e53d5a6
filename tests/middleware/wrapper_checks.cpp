#include "wrapper_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <exception>
#include <ostream>
#include <sstream>

#include "busy_machine.hpp"
#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/identify/state_identifiers.hpp"
#include "maide/conformance/suite/identifier_suite.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"

namespace maide::test {
namespace {

std::vector<std::string> outputs(const Mealy& machine, const Word& word) {
  std::vector<std::string> names;
  for (const Symbol output : machine.output_word(word)) {
    names.push_back(machine.outputs().name(output));
  }
  return names;
}

std::string text_of(const Mealy& machine) {
  std::ostringstream text;
  write_dot(text, machine);
  return text.str();
}

}  // namespace

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

std::vector<SulQuery> telling_words(const Mealy& model) {
  IdentifierSuite suite(model, compute_adaptive_words(model, Random(1)), 0);
  std::vector<Word> words;
  for (Word word; suite.next(word);) words.push_back(word);
  std::sort(words.begin(), words.end());
  std::vector<SulQuery> longest;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool goes_on = i + 1 < words.size() && words[i].size() <= words[i + 1].size() &&
                         std::equal(words[i].begin(), words[i].end(), words[i + 1].begin());
    if (!goes_on) longest.push_back({words[i], Translation::eager});
  }
  return longest;
}

void expect_answers(Sul& sul, const Mealy& model, std::span<const SulQuery> words) {
  ASSERT_EQ(sul.info().inputs.size(), model.inputs().size());
  std::size_t answered = 0;
  sul.run(words,
          [&](std::size_t index, const SulAnswer& answer) {
            const Word& word = std::get<Word>(words[index].inputs);
            ASSERT_EQ(answer.end, WordEnd::complete);
            ASSERT_EQ(outputs(answer), outputs(model, word)) << to_string(word, model.inputs());
            ++answered;
          },
          {});
  EXPECT_EQ(answered, words.size());
}

void expect_answers(SystemWrapper& wrapper, const SystemOptions& options, const Mealy& model,
                    std::size_t length) {
  LocalSul sul(wrapper, options);
  expect_answers(sul, model, all_words(model.inputs().size(), length));
}

std::string usage_error_of(SystemWrapper& wrapper, const SystemOptions& options) {
  try {
    const LocalSul sul(wrapper, options);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

LearnedSystem learn_system(const std::string& name, const SystemOptions& options,
                           std::string_view algorithm, Translation translation) {
  const auto sul = spawn_wrapper({MAIDE_BINARY_DIR "/bin/maide-wrap-" + name}, options);
  IaTranslator translator(*sul, translation);
  ExperimentOptions experiment;
  experiment.algorithm = algorithm;
  const ExperimentResult result = run_experiment(translator, experiment);
  if (result.error) std::rethrow_exception(result.error);
  return {result.model, translator.to_interface_automaton(result.model), result.experiments};
}

void PrintTo(const PortCase& tested, std::ostream* out) { *out << tested.name; }

void expect_port(const std::string& system, const PortCase& tested, Translation translation) {
  const InterfaceAutomaton expected = read_interface_automaton(
      std::string(MAIDE_SOURCE_DIR "/tests/models/") + tested.reference + ".dot");
  const InterfaceAutomaton learned =
      learn_system(system, tested.options, "", translation).automaton;
  EXPECT_EQ(learned.size(), expected.size());
  EXPECT_EQ(learned.transition_count(), expected.transition_count());
  EXPECT_TRUE(compare(expected, learned).same());
}

void expect_same_twenty_times(const std::string& name, const SystemOptions& options,
                              std::size_t states, std::size_t busy_processes) {
  const BusyMachine load(busy_processes);
  std::string first;
  for (int run = 0; run < 20; ++run) {
    const Mealy learned = learn_system(name, options).machine;
    ASSERT_EQ(learned.size(), states) << "run " << run;
    if (run == 0) first = text_of(learned);
    ASSERT_EQ(text_of(learned), first) << "run " << run;
  }
}

}  // namespace maide::test
