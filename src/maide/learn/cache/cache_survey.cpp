#include "maide/learn/cache/cache_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

namespace maide {
namespace {

// Looks at the stop token now and then.
class Paced {
 public:
  explicit Paced(const RunControl& control) : control_(control) {}
  void count() {
    if (++done_ % 4096 != 0) return;
    control_.check("reading the cache");
    Progress progress;
    progress.phase = "reading the cache";
    progress.words = done_;
    control_.report(progress);
  }

 private:
  const RunControl& control_;
  std::uint64_t done_ = 0;
};

// A new file beside `name`, removed unless it was given that name.
class Draft {
 public:
  // Throws UsageError if something of its name is there already, which may be somebody's.
  explicit Draft(std::filesystem::path name) : name_(std::move(name)), path_(name_) {
    path_ += ".part";
    for (const char* ending : endings) {
      const std::string taken = path_.string() + ending;
      std::error_code ignored;
      if (!std::filesystem::exists(std::filesystem::symlink_status(taken, ignored))) continue;
      throw UsageError(fmt::format(
          "the merged cache is drafted in a new file, and this one is there already ({})", taken));
    }
  }
  ~Draft() {
    std::error_code ignored;
    for (const char* ending : endings) std::filesystem::remove(path_.string() + ending, ignored);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  const std::filesystem::path& path() const { return path_; }
  void finish() {
    std::error_code failure;
    std::filesystem::rename(path_, name_, failure);
    if (failure) {
      throw UsageError(
          fmt::format("cannot write the cache: {} ({})", failure.message(), name_.string()));
    }
  }

 private:
  static constexpr std::array endings{"", "-wal", "-shm", "-journal"};  // SQLite's
  std::filesystem::path name_, path_;
};

}  // namespace

TraceCollection::Added TraceCollection::add(const Word& inputs, const Word& outputs,
                                            const Alphabet& names) {
  const std::size_t length = std::min(inputs.size(), outputs.size());
  TraceTree::Node node = TraceTree::root;
  bool is_new = false;
  for (std::size_t i = 0; i < length; ++i) {
    const Symbol output = outputs_.intern(names.name(outputs[i]));
    const TraceTree::Node child = is_new ? TraceTree::none : tree_.child(node, inputs[i]);
    if (child == TraceTree::none) {
      node = tree_.add_child(node, inputs[i], output);
      is_new = true;
      continue;
    }
    if (tree_.output(child) != output) {
      if (!conflict_) {
        keep_conflict(std::span(inputs).first(i + 1), std::span(outputs).first(i + 1), names);
      }
      return Added::conflict;
    }
    node = child;
  }
  return is_new ? Added::something : Added::nothing;
}

void TraceCollection::keep_conflict(std::span<const Symbol> inputs, std::span<const Symbol> outputs,
                                    const Alphabet& names) {
  Word known;
  TraceTree::Node node = TraceTree::root;
  for (const Symbol input : inputs) {
    node = tree_.child(node, input);
    known.push_back(tree_.output(node));
  }
  conflict_ = {to_string(inputs, inputs_), to_string(known, outputs_), to_string(outputs, names)};
}

CacheSurvey survey(CacheFile& cache, const RunControl& control) {
  CacheSurvey result;
  TraceCollection traces(cache.inputs());
  Paced paced(control);
  cache.for_each([&](const Word& inputs, const Word& outputs) {
    paced.count();
    ++result.words;
    result.symbols += inputs.size();
    result.longest = std::max<std::uint64_t>(result.longest, inputs.size());
    if (traces.add(inputs, outputs, cache.outputs()) == TraceCollection::Added::conflict) {
      ++result.conflicts;
    }
  });
  result.edges = traces.tree().edge_count();
  result.memory_bytes = traces.tree().bytes();
  result.conflict = traces.conflict();
  return result;
}

MergedCaches merge_caches(std::span<const std::filesystem::path> files,
                          const std::filesystem::path& output, const RunControl& control) {
  if (files.empty()) throw UsageError("there are no caches to merge");
  if (std::filesystem::exists(output)) {
    throw UsageError(fmt::format("a merged cache is a new file, and this one is there already ({})",
                                 output.string()));
  }
  MergedCaches result;
  Draft draft(output);
  std::optional<CacheFile> merged;
  std::optional<TraceCollection> traces;
  Alphabet names;  // of the outputs in the merged file
  Paced paced(control);
  for (const std::filesystem::path& path : files) {
    CacheFile file(path);
    if (!merged) {
      merged.emplace(draft.path(), file.inputs(), file.fingerprint());
      traces.emplace(file.inputs());
    }
    const std::string differences =
        describe_differences(file, merged->inputs(), merged->fingerprint());
    if (!differences.empty()) {
      throw UsageError(fmt::format("the caches are of different systems: {}, in {} ({})",
                                   differences, files.front().string(), path.string()));
    }
    file.for_each([&](const Word& inputs, const Word& outputs) {
      paced.count();
      const TraceCollection::Added added = traces->add(inputs, outputs, file.outputs());
      if (added == TraceCollection::Added::conflict && result.other.empty()) result.other = path;
      if (added != TraceCollection::Added::something) return;
      Word renumbered;
      for (const Symbol symbol : outputs) {
        renumbered.push_back(names.intern(file.outputs().name(symbol)));
      }
      merged->add(inputs, renumbered, names);
      ++result.words;
    });
    result.conflict = traces->conflict();
    if (result.conflict) return result;
  }
  merged->commit();
  merged.reset();
  draft.finish();
  return result;
}

}  // namespace maide
