#include "maide/workflow/recheck_cache.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <span>
#include <utility>
#include <variant>

#include "maide/automata/alphabet.hpp"
#include "maide/base/random.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/oracle/sul_oracle.hpp"
#include "maide/sul/learning_purpose.hpp"
#include "maide/workflow/experiment.hpp"

namespace maide {
namespace {

struct Sample {
  Word inputs, outputs;
};

// Every word with the same chance (Vitter, "Random sampling with a reservoir", TOMS 1985).
std::vector<Sample> draw(CacheFile& cache, const RecheckOptions& options) {
  std::vector<Sample> sample;
  Random random(options.seed);
  std::uint64_t seen = 0;
  cache.for_each([&](const Word& inputs, const Word& outputs) {
    if (outputs.empty()) return;
    // Behind the last output the word was aborted.
    Sample word{head(inputs, outputs.size()), outputs};
    ++seen;
    if (sample.size() < options.words) {
      sample.push_back(std::move(word));
    } else if (const std::uint64_t place = random.below(seen); place < sample.size()) {
      sample[place] = std::move(word);
    }
  });
  return sample;
}

std::string value_of(const Fingerprint& fingerprint, const std::string& name) {
  const auto found = fingerprint.find(name);
  return found == fingerprint.end() ? "" : found->second;
}

constexpr std::string_view version_of = "the version of ";  // names in a Fingerprint

struct ShorterFirst {
  bool operator()(const Word& left, const Word& right) const {
    return left.size() != right.size() ? left.size() < right.size() : left < right;
  }
};

// How many inputs lead to the first output that is another one now; 0 if there is none.
std::size_t first_difference(const Sample& word, const Alphabet& known, const MealyAnswer& answer,
                             const Alphabet& names) {
  const std::size_t length = std::min(word.outputs.size(), answer.outputs.size());
  for (std::size_t i = 0; i < length; ++i) {
    if (known.name(word.outputs[i]) != names.name(answer.outputs[i])) return i + 1;
  }
  return 0;
}

LearningPurpose read_purpose(const std::string& text, const std::string& file) {
  const Model model = read_dot(text, file);
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton == nullptr) throw UsageError("the cache's purpose is damaged (" + file + ")");
  return LearningPurpose(*automaton);
}

}  // namespace

RecheckResult recheck_cache(CacheFile& cache, const SystemSpec& spec, const RecheckOptions& options,
                            const RunControl& control) {
  const std::string file = cache.path().string();
  const bool is_av = value_of(cache.fingerprint(), "the translation") == "av";
  SystemAccess access = options.access;
  if (is_av) access.translation = Translation::av;
  const OpenedSystem opened = open_system(spec, access, control);
  const std::string purpose = value_of(cache.fingerprint(), "purpose");
  if (!purpose.empty()) opened.sul->add_purpose(read_purpose(purpose, file));
  IaTranslator translator(*opened.sul, is_av ? Translation::av : Translation::eager);
  const Fingerprint now = identify(translator);
  Fingerprint fingerprint = now;
  if (!purpose.empty()) fingerprint["purpose"] = purpose;
  RecheckResult result;
  // Another version is what one asks about.
  for (auto entry = fingerprint.begin(); entry != fingerprint.end();) {
    const std::string there = value_of(cache.fingerprint(), entry->first);
    const bool is_version = entry->first.starts_with(version_of);
    if (is_version && there != entry->second) {
      result.versions.push_back({entry->first.substr(version_of.size()), there, entry->second});
    }
    entry = is_version ? fingerprint.erase(entry) : std::next(entry);
  }
  for (const auto& [name, value] : cache.fingerprint()) {
    if (!name.starts_with(version_of)) continue;
    const std::string part = name.substr(version_of.size());
    if (!now.contains(name)) result.versions.push_back({part, value, ""});
    fingerprint[name] = value;
  }
  const std::string differences = describe_differences(cache, translator.inputs(), fingerprint);
  if (!differences.empty()) {
    throw UsageError(
        fmt::format("the cache was recorded for another system: {} ({})", differences, file));
  }

  const std::vector<Sample> sample = draw(cache, options);
  SulOracle system(translator);
  std::map<Word, ChangedAnswer, ShorterFirst> changed;
  constexpr std::size_t batch_size = 64;
  for (std::size_t start = 0; start < sample.size(); start += batch_size) {
    const auto part = std::span(sample).subspan(start, std::min(batch_size, sample.size() - start));
    std::vector<Query> batch;
    for (const Sample& word : part) batch.emplace_back(word.inputs);
    const std::vector<MealyAnswer> answers = system.ask(batch, control);
    for (std::size_t i = 0; i < part.size(); ++i) {
      const std::size_t length =
          first_difference(part[i], cache.outputs(), answers[i], system.outputs());
      if (length == 0) continue;
      ++result.different;
      const auto beginning = [length](const Word& word) { return std::span(word).first(length); };
      const auto inputs = beginning(part[i].inputs);
      ChangedAnswer& entry = changed[Word(inputs.begin(), inputs.end())];
      if (entry.words++ > 0) continue;
      entry.conflict = {to_string(inputs, cache.inputs()),
                        to_string(beginning(part[i].outputs), cache.outputs()),
                        to_string(beginning(answers[i].outputs), system.outputs())};
    }
    result.words += part.size();
    Progress progress;
    progress.phase = "asking again";
    progress.done = result.words;
    progress.total = sample.size();
    control.report(progress);
  }
  for (auto& [word, entry] : changed) result.changed.push_back(std::move(entry));
  return result;
}

}  // namespace maide
