#include "maide/workflow/recheck_cache.hpp"

#include <fmt/format.h>

#include <span>
#include <utility>
#include <variant>

#include "maide/base/random.hpp"
#include "maide/formats/dot.hpp"
#include "maide/learn/sul_oracle.hpp"
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
    Sample word{Word(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(outputs.size())),
                outputs};
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
  Fingerprint fingerprint = identify(translator);
  if (!purpose.empty()) fingerprint["purpose"] = purpose;
  const std::string differences = describe_differences(cache, translator.inputs(), fingerprint);
  if (!differences.empty()) {
    throw UsageError(
        fmt::format("the cache was recorded for another system: {} ({})", differences, file));
  }

  const std::vector<Sample> sample = draw(cache, options);
  SulOracle system(translator);
  RecheckResult result;
  constexpr std::size_t batch_size = 64;
  for (std::size_t start = 0; start < sample.size(); start += batch_size) {
    const auto part = std::span(sample).subspan(start, std::min(batch_size, sample.size() - start));
    std::vector<Query> batch;
    for (const Sample& word : part) batch.emplace_back(word.inputs);
    const std::vector<MealyAnswer> answers = system.ask(batch, control);
    for (std::size_t i = 0; i < part.size(); ++i) {
      // What the cache knows first, then what the system says now: the first difference counts.
      TraceCollection both(cache.inputs());
      both.add(part[i].inputs, part[i].outputs, cache.outputs());
      both.add(answers[i].inputs, answers[i].outputs, system.outputs());
      if (both.conflict()) result.conflicts.push_back(*both.conflict());
    }
    result.words += part.size();
    Progress progress;
    progress.phase = "asking again";
    progress.done = result.words;
    progress.total = sample.size();
    control.report(progress);
  }
  return result;
}

}  // namespace maide
