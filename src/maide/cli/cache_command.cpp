// `maide cache show|merge|check FILE...`: the files of `maide learn --cache`.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/learn/cache/cache_survey.hpp"
#include "maide/workflow/recheck_cache.hpp"

namespace maide::cli {
namespace {

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
  return {{"word", conflict->word}, {"known", conflict->known}, {"other", conflict->other}};
}

// What the words are of, in the order in which people ask.
std::string describe_system(const CacheFile& cache) {
  std::vector<std::string> options;
  std::string text, versions;
  for (const auto& [name, value] : cache.fingerprint()) {
    constexpr std::string_view version_of = "the version of ";
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
  only("check", line.add("--token-file", arguments->recheck.access.token_file,
                         "check: a file with a listening wrapper's token. Or set "
                         "MAIDE_TOKEN"));
  only("check", add_jobs_option(line, arguments->recheck.access.jobs));
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
