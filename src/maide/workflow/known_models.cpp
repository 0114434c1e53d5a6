#include "maide/workflow/known_models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/words.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/identifier_suite.hpp"
#include "maide/learn/old_model.hpp"
#include "maide/workflow/read_machine.hpp"

namespace maide {
namespace {

bool has_all(const Mealy& machine, const Alphabet& inputs) {
  return std::all_of(inputs.names().begin(), inputs.names().end(), [&](const std::string& name) {
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
  std::sort(files.begin(), files.end());
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
        note(fmt::format("it has not all of the system's inputs: left out ({})", file.string()));
        continue;
      }
      Mealy known = prepare(machine, inputs);
      const auto same = std::find_if(models.begin(), models.end(), [&](const KnownModel& model) {
        return !find_distinguishing_word(model.machine, known);
      });
      if (same != models.end()) {
        note(fmt::format("it behaves as {} does: left out ({})", same->name, file.string()));
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
