// Surveys files of the cache: how much lies in them, and whether it agrees with itself. Merges
// several files of one system into one: every word of the first, then those of the next that add
// something. A contradiction is told with its shortest word, since a run that met it would have
// voted on it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "maide/automata/alphabet.hpp"
#include "maide/base/run_control.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/cache/trace_tree.hpp"

namespace maide {

// Two answers to the same word that differ at its last input, with the symbols' names.
struct CacheConflict {
  std::string word, known, other;
};

// The words of caches as one tree.
class TraceCollection {
 public:
  explicit TraceCollection(const Alphabet& inputs) : inputs_(inputs) {}

  enum class Added { nothing, something, conflict };
  // Adds a word; `names` names its outputs. Nothing is added where it contradicts the tree: see
  // conflict(). O(length).
  Added add(const Word& inputs, const Word& outputs, const Alphabet& names);
  // The first contradiction.
  const std::optional<CacheConflict>& conflict() const { return conflict_; }
  const TraceTree& tree() const { return tree_; }

 private:
  void keep_conflict(std::span<const Symbol> inputs, std::span<const Symbol> outputs,
                     const Alphabet& names);

  Alphabet inputs_, outputs_;
  TraceTree tree_;
  std::optional<CacheConflict> conflict_;
};

struct CacheSurvey {
  std::uint64_t words = 0;                // in the file
  std::uint64_t symbols = 0;              // their inputs
  std::uint64_t longest = 0;              // inputs of the longest word
  std::uint64_t edges = 0;                // of the tree that they make
  std::uint64_t memory_bytes = 0;         // of that tree
  std::uint64_t conflicts = 0;            // words that contradict earlier ones
  std::optional<CacheConflict> conflict;  // the first
};

// Reads all of the file. Throws UsageError if it is damaged, Interrupted.
CacheSurvey survey(CacheFile& cache, const RunControl& control = {});

struct MergedCaches {
  std::uint64_t words = 0;                // written
  std::optional<CacheConflict> conflict;  // then nothing was written
  std::filesystem::path other;            // the file whose answer is the conflict's `other`
};

// Writes the words of all files to a new file `output`. Throws UsageError if one cannot be read, is
// of another system than the first, or `output` is there already; Interrupted. After an error or a
// contradiction there is no output.
MergedCaches merge_caches(std::span<const std::filesystem::path> files,
                          const std::filesystem::path& output, const RunControl& control = {});

}  // namespace maide
