#include "maide/experiment/known_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/method/known_words.hpp"
#include "maide/conformance/suite/identifier_suite.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/lsharp/old_model.hpp"
#include "maide/learn/oracle/observing_oracle.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide {

Mealy read_machine(const std::filesystem::path& path, Translation translation) {
  Model model = read_model(path);
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton == nullptr) return take_mealy(std::move(model), path);
  try {
    return to_mealy(*automaton, translation);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("{} ({})", error.what(), path.string()));
  }
}

bool shares_inputs(const Mealy& machine, const Alphabet& inputs) {
  const auto is_known = [&](const std::string& name) { return inputs.find(name).has_value(); };
  return std::ranges::any_of(machine.inputs().names(), is_known);
}

Alphabet input_alphabet(const SulInfo& system) {
  Alphabet inputs;
  for (const SulInput& input : system.inputs) inputs.intern(input.name);
  return inputs;
}

Mealy read_old_machine(const std::filesystem::path& path, Translation translation,
                       const Alphabet& inputs) {
  Mealy machine = read_machine(path, translation);
  if (shares_inputs(machine, inputs)) return machine;
  throw UsageError(
      fmt::format("a run cannot start from a model with none of the system's inputs, "
                  "which are {} ({})",
                  join(inputs.names()), path.string()));
}

namespace {

TraceLog read_cache(const std::filesystem::path& path, const RunControl& control) {
  CacheFile file(path);
  TraceLog log{file.inputs(), file.outputs(), {}, path.string()};
  file.for_each([&](const Word& inputs, const Word& outputs) {
    if (log.traces.size() % 4096 == 0) control.check("reading the cache");
    // A word that did not complete has fewer outputs.
    log.traces.push_back({head(inputs, outputs.size()), outputs});
  });
  return log;
}

// By its first bytes. What is no regular file can be read once only, and is no database.
bool is_sqlite(const std::filesystem::path& path) {
  constexpr std::string_view magic = "SQLite format 3";
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::string start(magic.size(), '\0');
  std::ifstream(path, std::ios::binary).read(start.data(), std::ssize(start));
  return start == magic;
}

}  // namespace

TraceLog read_traces(const std::filesystem::path& path, const RunControl& control) {
  if (is_sqlite(path)) return read_cache(path, control);
  return read_trace_log(read_file(path, control), path.string(), control);
}

namespace {

// How many inputs of the word the slower system answers as the model does.
std::size_t agreeing(const Mealy& model, const Word& word, const Word& answer,
                     const Alphabet& outputs) {
  StateId state = model.initial();
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (model.outputs().name(model.output(state, word[i])) != outputs.name(answer[i])) return i;
    state = model.target(state, word[i]);
  }
  return word.size();
}

// What the slower system stands by as its answer to the last input of `word`, if it is not the
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
                            OutputOracle& system, const SlowerSystem& slower, Cache& cache,
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
                            slower.waits, to_string(word, model.inputs()), *answered,
                            model.outputs().name(model.output_word(word).back())));
  }
  return confirmed;
}

}  // namespace

std::uint64_t confirm_model(const Mealy& model, const SlowerSystem& slower, Cache& cache,
                            const ConfirmationSettings& settings, QueryCounts& counts,
                            const RunControl& control) {
  const std::vector<Word> words =
      choose_confirmation_words(model, settings.seed, settings.most_symbols);
  const auto opened = slower.open();
  if (!(opened->inputs() == model.inputs())) {
    throw Error(ExitStatus::system_failed, "the system has other inputs when it is opened again");
  }
  CountingOracle system(*opened);
  try {
    const std::uint64_t confirmed =
        compare_words(model, words, system, slower, cache, settings, control);
    counts += system.statistics().total();
    return confirmed;
  } catch (...) {
    counts += system.statistics().total();
    throw;
  }
}

namespace {

bool has_all(const Mealy& machine, const Alphabet& inputs) {
  return std::ranges::all_of(inputs.names(), [&](const std::string& name) {
    return machine.inputs().find(name).has_value();
  });
}

Mealy prepare(const Mealy& machine, const Alphabet& inputs) {
  return breadth_first(minimize(restrict_inputs(machine, inputs)));
}

std::vector<std::string> answer_of(const Mealy& machine, const Word& word) {
  std::vector<std::string> names;
  for (const Symbol output : machine.output_word(machine.initial(), word)) {
    names.push_back(machine.outputs().name(output));
  }
  return names;
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_regular_file(error)) files.push_back(entry->path());
  }
  if (error)
    throw UsageError("cannot read the folder: " + error.message() + " (" + folder.string() + ")");
  std::ranges::sort(files);
  return files;
}

// The word that leaves fewest models in its worst case; the shortest of those.
Word choose_word(const std::vector<KnownModel>& models, const std::vector<std::size_t>& left) {
  constexpr std::size_t most_looked_at = 64;
  Word best;
  std::size_t best_worst = left.size();
  for (std::size_t i = 1; i < left.size() && i <= most_looked_at; ++i) {
    const auto word = find_distinguishing_word(models[left[0]].machine, models[left[i]].machine);
    if (!word) continue;
    std::map<std::vector<std::string>, std::size_t> parts;
    std::size_t worst = 0;
    for (const std::size_t model : left) {
      worst = std::max(worst, ++parts[answer_of(models[model].machine, *word)]);
    }
    if (std::pair(worst, word->size()) < std::pair(best_worst, best.size()) || best.empty()) {
      best_worst = worst;
      best = *word;
    }
  }
  return best;
}

}  // namespace

std::vector<KnownModel> read_known_models(const std::filesystem::path& folder,
                                          Translation translation, const Alphabet& inputs,
                                          const std::function<void(const std::string&)>& note,
                                          const RunControl& control) {
  std::vector<KnownModel> models;
  for (const std::filesystem::path& file : files_in(folder)) {
    control.check("reading known models");
    try {
      const Mealy machine = read_machine(file, translation);
      if (!has_all(machine, inputs)) {
        note(fmt::format("left out: it has not all of the system's inputs ({})", file.string()));
        continue;
      }
      Mealy known = prepare(machine, inputs);
      const auto same = std::ranges::find_if(models, [&](const KnownModel& model) {
        return !find_distinguishing_word(model.machine, known);
      });
      if (same != models.end()) {
        note(fmt::format("left out: it behaves as {} does ({})", same->name, file.string()));
        continue;
      }
      models.push_back({file.filename().string(), std::move(known)});
    } catch (const Interrupted&) {
      throw;
    } catch (const Error& error) {
      note(fmt::format("left out: {}", error.what()));
    }
  }
  return models;
}

SingledOut single_out(const std::vector<KnownModel>& models, OutputOracle& oracle,
                      const RunControl& control) {
  SingledOut result;
  std::vector<std::size_t> left;
  for (std::size_t model = 0; model < models.size(); ++model) left.push_back(model);
  while (left.size() > 1) {
    control.check("telling known models apart");
    const Word word = choose_word(models, left);
    std::vector<std::string> answer;
    for (const Symbol output : oracle.ask(word, control)) {
      answer.push_back(oracle.outputs().name(output));
    }
    ++result.words;
    const std::size_t last = left.front();
    std::erase_if(
        left, [&](std::size_t model) { return answer_of(models[model].machine, word) != answer; });
    if (left.empty()) {
      result.model = last;
      result.is_possible = false;
      return result;
    }
  }
  result.model = left.front();
  return result;
}

std::vector<Word> verifying_words(const Mealy& old_model, const Alphabet& inputs,
                                  std::uint64_t seed) {
  if (!has_all(old_model, inputs)) return {};
  const Mealy machine = prepare(old_model, inputs);
  if (machine.size() < 2) return {};
  IdentifierSuite suite(machine, compute_adaptive_words(machine, Random(seed)), 0);
  std::vector<Word> words;
  for (Word word; suite.next(word);) words.push_back(word);
  // In this order a word that others begin with comes right before one of them.
  std::set<Word> sorted(words.begin(), words.end());
  std::erase_if(words, [&](const Word& word) {
    const auto next = std::next(sorted.find(word));
    return next != sorted.end() && is_prefix(word, *next);
  });
  std::set<Word> seen;
  std::erase_if(words, [&](const Word& word) { return word.empty() || !seen.insert(word).second; });
  return words;
}

}  // namespace maide
