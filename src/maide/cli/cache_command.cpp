// `maide cache show|merge|check FILE...`: the files of `maide learn --cache`.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/random.hpp"
#include "maide/base/run_control.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/cache/cache_survey.hpp"
#include "maide/learn/oracle/sul_oracle.hpp"
#include "maide/sul/learning_purpose.hpp"

namespace maide::cli {
namespace {

// ---- Asking again ----
//
// Asks a system again for a sample of the words in a cache, to see whether it still answers as it
// did.

struct RecheckOptions {
  std::uint64_t words = 100;  // the size of the sample; all of the cache if it has no more
  std::uint64_t seed = 1;     // of the sample
  SystemAccess access;        // the translation is the cache's
};

// A word that the system answers otherwise now, up to the first output that is another one.
struct ChangedAnswer {
  CacheConflict conflict;   // `known`: of the cache; `other`: of the system, the first time
  std::uint64_t words = 0;  // of the sample, that begin with it
};

// A part of the system of which the cache was recorded with another version; "" for none.
struct OtherVersion {
  std::string part, cached, running;
};

struct RecheckResult {
  std::vector<OtherVersion> versions;
  std::uint64_t words = 0;             // asked
  std::uint64_t different = 0;         // of them, answered otherwise
  std::vector<ChangedAnswer> changed;  // shortest first, each word once
};

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

// Opens the system, which must be the cache's, in whatever version. Every word is asked once, so a
// single wrong answer of a noisy system is a conflict, too. Throws UsageError if it is another
// system, and what open_system() and the system throw.
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

// ---- The command ----

struct CacheArguments {
  std::string what;
  std::vector<std::string> files;
  std::string output;
  std::string system;
  RecheckOptions recheck;
  struct VerbOption {
    std::string_view verb;  // that looks at it
    Argument option;
  };
  std::vector<VerbOption> options;
};

void refuse_options_of_other_verbs(const CacheArguments& arguments) {
  for (const auto& [verb, option] : arguments.options) {
    if (!option.is_given() || verb == arguments.what) continue;
    throw UsageError(fmt::format("{} is an option of 'maide cache {}', not of 'maide cache {}'",
                                 option.name(), verb, arguments.what));
  }
}

// Those of the second asking say nothing without a system that is asked.
void refuse_options_without_system(const CacheArguments& arguments) {
  if (arguments.what != "check" || !arguments.system.empty()) return;
  for (const auto& [verb, option] : arguments.options) {
    if (verb != "check" || !option.is_given()) continue;
    throw UsageError(option.name() + " needs a system that is asked again: --system SYSTEM");
  }
}

Json conflict_json(const std::optional<CacheConflict>& conflict) {
  if (!conflict) return nullptr;
  return {
      {"word", split(conflict->word, ' ')}, {"known", conflict->known}, {"other", conflict->other}};
}

// What the words are of, in the order in which people ask.
std::string describe_system(const CacheFile& cache) {
  std::vector<std::string> options;
  std::string text, versions;
  for (const auto& [name, value] : cache.fingerprint()) {
    if (name.starts_with(version_of)) {
      versions += (versions.empty() ? "" : ", ") + name.substr(version_of.size()) + " " + value;
    } else if (name == "purpose") {
      options.emplace_back("with a purpose of its own");
    } else if (!name.starts_with("the ")) {
      options.push_back(name + "=" + value);
    }
  }
  for (const auto& [name, value] : cache.fingerprint()) {
    if (!name.starts_with("the ") || name.starts_with("the version")) continue;
    text += fmt::format("  {:<12}  {}\n", name.substr(4), value);
  }
  if (!options.empty()) text += fmt::format("  {:<12}  {}\n", "options", join(options, " "));
  if (!versions.empty()) text += fmt::format("  {:<12}  {}\n", "versions", versions);
  text += fmt::format("  {:<12}  {}: {}\n", "inputs", cache.inputs().size(),
                      join(cache.inputs().names()));
  return text + fmt::format("  {:<12}  {}\n", "outputs", cache.outputs().size());
}

std::string describe_conflict(const CacheConflict& conflict) {
  return fmt::format("\"{}\" is answered \"{}\" and \"{}\"", conflict.word, conflict.known,
                     conflict.other);
}

ExitStatus show(const CacheArguments& arguments, Context& context) {
  Json list = Json::array();
  for (const std::string& path : arguments.files) {
    CacheFile cache(path);
    const CacheSurvey found = survey(cache, context.control());
    const std::uint64_t bytes = std::filesystem::file_size(path);
    const double edges = static_cast<double>(std::max<std::uint64_t>(found.edges, 1));
    std::string text = path + "\n" + describe_system(cache);
    text += fmt::format("  {:<12}  {}, of {} symbols in all; the longest has {}\n", "words",
                        found.words, found.symbols, found.longest);
    text += fmt::format("  {:<12}  {}\n", "observations", found.edges);
    text += fmt::format("  {:<12}  {} on disk, {:.1f} an observation\n", "bytes", bytes,
                        static_cast<double>(bytes) / edges);
    if (found.conflict) {
      text += fmt::format("  {:<12}  {} words contradict others; the first: {}\n", "contradiction",
                          found.conflicts, describe_conflict(*found.conflict));
    }
    context.print(text);
    Json entry{{"file", path},
               {"fingerprint", cache.fingerprint()},
               {"inputs", cache.inputs().names()},
               {"outputs", cache.outputs().names()},
               {"words", found.words},
               {"symbols", found.symbols},
               {"longest", found.longest},
               {"observations", found.edges},
               {"bytes", bytes},
               {"bytes_in_memory", found.memory_bytes},
               {"conflicts", found.conflicts},
               {"conflict", conflict_json(found.conflict)}};
    list.push_back(std::move(entry));
  }
  context.set_result({{"caches", list}});
  return ExitStatus::ok;
}

ExitStatus merge(const CacheArguments& arguments, Context& context) {
  if (arguments.output.empty()) throw UsageError("merge needs a file to write: -o FILE");
  const std::vector<std::filesystem::path> files(arguments.files.begin(), arguments.files.end());
  const MergedCaches merged = merge_caches(files, arguments.output, context.control());
  context.set_result({{"words", merged.conflict ? Json() : Json(merged.words)},
                      {"conflict", conflict_json(merged.conflict)},
                      {"conflict_in", merged.conflict ? Json(merged.other.string()) : Json()},
                      {"cache", merged.conflict ? Json() : Json(arguments.output)}});
  if (!merged.conflict) {
    context.print(fmt::format("{} words of {} {} ({})\n", merged.words, files.size(),
                              files.size() == 1 ? "cache" : "caches", arguments.output));
    return ExitStatus::ok;
  }
  context.print(fmt::format("Not merged, they contradict each other: {} by {}\n",
                            describe_conflict(*merged.conflict), merged.other.string()));
  return ExitStatus::violated;
}

constexpr std::size_t most_shown = 10;  // changed answers

struct Checked {
  ExitStatus status = ExitStatus::ok;
  std::string text;  // a line or more
  Json json;
};

Checked check_file(const std::string& path, const CacheArguments& arguments, Context& context) {
  CacheFile cache(path);
  const std::string damage = cache.find_damage();
  if (!damage.empty()) throw UsageError(fmt::format("the cache is damaged: {} ({})", damage, path));
  const CacheSurvey found = survey(cache, context.control());
  Checked checked;
  checked.json = {{"file", path},
                  {"words", found.words},
                  {"conflicts", found.conflicts},
                  {"conflict", conflict_json(found.conflict)}};
  if (found.conflict) {
    checked.status = ExitStatus::violated;
    checked.text = fmt::format("{}: {} of {} words contradict others; the first: {}\n", path,
                               found.conflicts, found.words, describe_conflict(*found.conflict));
    return checked;
  }
  checked.text = fmt::format("{}: sound, {} words\n", path, found.words);
  if (arguments.system.empty()) return checked;

  std::vector<std::string> words = split_shell_words(arguments.system);
  if (words.empty()) throw UsageError("--system names no system");
  const SystemSpec spec = parse_system_spec(words.front(), std::span(words).subspan(1));
  const RecheckResult again = recheck_cache(cache, spec, arguments.recheck, context.control());
  if (again.different > 0) checked.status = ExitStatus::violated;
  checked.json["other_versions"] = Json::array();
  const auto or_none = [](const std::string& version) {
    return version.empty() ? "none" : version;
  };
  for (const OtherVersion& version : again.versions) {
    checked.text += fmt::format("  another version: {} {} is asked, {} was\n", version.part,
                                or_none(version.running), or_none(version.cached));
    checked.json["other_versions"].push_back(
        {{"part", version.part}, {"cached", version.cached}, {"running", version.running}});
  }
  checked.json["asked_again"] = again.words;
  checked.json["different"] = again.different;
  checked.json["answered_otherwise"] = Json::array();
  checked.text +=
      fmt::format("  {} of them asked again: {}\n", again.words,
                  again.different == 0 ? "all are answered as they were"
                                       : fmt::format("{} answered otherwise", again.different));
  for (const ChangedAnswer& changed : again.changed) {
    Json entry = conflict_json(changed.conflict);
    entry["words"] = changed.words;
    checked.json["answered_otherwise"].push_back(std::move(entry));
  }
  const std::size_t shown = std::min(again.changed.size(), most_shown);
  for (const ChangedAnswer& changed : std::span(again.changed).first(shown)) {
    checked.text +=
        fmt::format("  {}{}\n", describe_conflict(changed.conflict),
                    changed.words == 1 ? "" : fmt::format(", in {} words", changed.words));
  }
  if (shown < again.changed.size()) {
    checked.text += fmt::format("  and {} more (--json has all)\n", again.changed.size() - shown);
  }
  return checked;
}

// What cannot be read counts more than what is wrong; every file is looked at.
ExitStatus check(const CacheArguments& arguments, Context& context) {
  ExitStatus status = ExitStatus::ok;
  Json list = Json::array();
  for (const std::string& path : arguments.files) {
    try {
      const Checked checked = check_file(path, arguments, context);
      context.print(checked.text);
      list.push_back(checked.json);
      status = std::max(status, checked.status);
    } catch (const UsageError& error) {
      context.complain(error.what());
      list.push_back({{"file", path}, {"error", error.what()}});
      status = ExitStatus::usage;
    }
  }
  context.set_result({{"caches", list}});
  return status;
}

}  // namespace

RunFunction set_up_cache(CommandLine& line) {
  auto arguments = std::make_shared<CacheArguments>();
  line.add(
          "WHAT", arguments->what,
          "show, merge or check. Show tells what is in the files; merge makes one of several files "
          "of the same system; check tells whether the files are sound, and whether the system "
          "still answers as they say")
      .required()
      .check([](const std::string& what) {
        return check_one_of(what, {"show", "merge", "check"});
      });
  line.add("FILE", arguments->files, "Files that maide learn --cache has written").required();
  const auto only = [&](std::string_view verb, const Argument& option) {
    arguments->options.push_back({verb, option});
  };
  only("merge", line.add("-o,--output", arguments->output, "merge: the new file"));
  only(
      "check",
      line.add("--system", arguments->system,
               "check: ask this system again. It is written as in maide learn: 'port kind=strict'; "
               "another version of it is no error"));
  only("check", line.add("--words", arguments->recheck.words,
                         "check: how many words are asked again, from 1")
                    .check([](const std::string& text) {
                      if (parse_number<std::uint64_t>(text).value_or(0) >= 1) return std::string();
                      return "'" + text + "' is not a whole number from 1";
                    }));
  for (const Argument& option : add_access_options(line, arguments->recheck.access)) {
    only("check", option);
  }
  only("check", add_seed_option(line, arguments->recheck.seed));
  return [arguments](Context& context) {
    refuse_options_of_other_verbs(*arguments);
    refuse_options_without_system(*arguments);
    if (arguments->what == "show") return show(*arguments, context);
    if (arguments->what == "merge") return merge(*arguments, context);
    return check(*arguments, context);
  };
}

}  // namespace maide::cli
