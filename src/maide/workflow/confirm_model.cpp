#include "maide/workflow/confirm_model.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/conformance/confirmation_words.hpp"
#include "maide/learn/counting_oracle.hpp"

namespace maide {
namespace {

// How many inputs of the word the patient system answers as the model does.
std::size_t agreeing(const Mealy& model, const Word& word, const Word& answer,
                     const Alphabet& outputs) {
  StateId state = model.initial();
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (model.outputs().name(model.output(state, word[i])) != outputs.name(answer[i])) return i;
    state = model.target(state, word[i]);
  }
  return word.size();
}

// What the patient system stands by as its answer to the last input of `word`, if it is not the
// model's. Runs that are spoilt before it count for nothing.
std::optional<std::string> other_answer(const Mealy& model, const Word& word, OutputOracle& system,
                                        const VoteOptions& options, const RunControl& control) {
  Ballot ballot(options);
  for (std::uint32_t runs = 0; ballot.missing() > 0 && runs < options.most_attempts; ++runs) {
    const Word answer = system.ask(word, control);
    if (agreeing(model, word, answer, system.outputs()) + 1 < word.size()) continue;
    ballot.add(answer.back());
  }
  if (!ballot.winner()) return std::nullopt;
  const std::string& answered = system.outputs().name(*ballot.winner());
  if (answered == model.outputs().name(model.output_word(word).back())) return std::nullopt;
  return answered;
}

std::uint64_t compare_words(const Mealy& model, const std::vector<Word>& words,
                            OutputOracle& system, const PatientSystem& patient, Cache& cache,
                            const ConfirmationSettings& settings, const RunControl& control) {
  const std::vector<Query> batch(words.begin(), words.end());
  const std::vector<MealyAnswer> answers = system.ask(batch, control);
  std::uint64_t confirmed = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const Word& outputs = complete_outputs(answers[i], words[i]);
    const std::size_t length = agreeing(model, words[i], outputs, system.outputs());
    if (length == words[i].size()) {
      ++confirmed;
      continue;
    }
    const Word word(words[i].begin(), words[i].begin() + static_cast<std::ptrdiff_t>(length) + 1);
    cache.ask_afresh(word, control);
    const auto answered = other_answer(model, word, system, settings.vote, control);
    if (!answered) continue;
    throw Error(ExitStatus::inconclusive,
                fmt::format("with longer waits ({0}) the system answers the last input of \"{1}\" "
                            "with \"{2}\", not with \"{3}\": waits are too short to learn it; try "
                            "{0}",
                            patient.waits, to_string(word, model.inputs()), *answered,
                            model.outputs().name(model.output_word(word).back())));
  }
  return confirmed;
}

}  // namespace

std::uint64_t confirm_model(const Mealy& model, const PatientSystem& patient, Cache& cache,
                            const ConfirmationSettings& settings, QueryCounts& counts,
                            const RunControl& control) {
  const std::vector<Word> words =
      choose_confirmation_words(model, settings.seed, settings.most_symbols);
  const auto opened = patient.open();
  if (!(opened->inputs() == model.inputs())) {
    throw Error(ExitStatus::system_failed, "the system has other inputs when it is opened again");
  }
  CountingOracle system(*opened);
  try {
    const std::uint64_t confirmed =
        compare_words(model, words, system, patient, cache, settings, control);
    counts += system.statistics().total();
    return confirmed;
  } catch (...) {
    counts += system.statistics().total();
    throw;
  }
}

}  // namespace maide
