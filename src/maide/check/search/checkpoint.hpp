// What a search has stored, as files, so that one that was killed can go on: at the end of a level
// each rank writes a part, and then rank 0 a manifest that names them. Until the manifest is there
// the one before counts, with its parts. A search goes on with any number of ranks and threads.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <utility>

#include "maide/check/search/ranks.hpp"

namespace maide {

// What a manifest says of all parts together.
struct SearchProgress {
  std::uint64_t number = 0;  // of the checkpoint, from 1
  unsigned parts = 0;
  std::uint64_t depth = 0;  // levels that were expanded
  std::uint64_t states = 0, next = 0, transitions = 0;
  bool has_cut = false;
  bool is_done = false;  // the search came to its end; there are no parts
};

class Checkpoint {
 public:
  // In `folder`, which is made; for the search that `key` names, a number that depends on all that
  // the search does. `interval`: least seconds between two. Throws UsageError if there can be no
  // such folder.
  Checkpoint(std::filesystem::path folder, std::uint64_t key, double interval);

  // The last one; none: there is none. Throws UsageError for one that is damaged, or of another
  // version of Maide.
  std::optional<SearchProgress> find() const;
  // Removes what a search left behind that was killed while it wrote: all files of this search but
  // those of `last`. Nobody else writes to the folder meanwhile.
  void remove_leftovers(const std::optional<SearchProgress>& last) const;
  // Throws UsageError unless all parts of `last` together had so many states.
  void check_total(const SearchProgress& last, std::uint64_t states, std::uint64_t next) const;

  // Numbers of eight bytes, in the order in which they were written.
  class Writer {
   public:
    explicit Writer(std::ostream& out) : out_(out) {}
    void put(std::uint64_t value);
    std::uint64_t sum() const { return sum_; }

   private:
    std::ostream& out_;
    std::uint64_t sum_ = 0;
  };
  class Reader {
   public:
    Reader(std::istream& in, std::string file) : in_(in), file_(std::move(file)) {}
    std::uint64_t get();  // throws UsageError at the end
    std::uint64_t sum() const { return sum_; }

   private:
    std::istream& in_;
    std::string file_;
    std::uint64_t sum_ = 0;
  };

  // It is time for one, by the clock: the interval has passed, and twenty times what the last took.
  // With an interval of 0 it always is.
  bool is_due() const;
  // Writes part `part` of checkpoint `number`, then, once all have, the manifest; then removes the
  // part of the one before. Throws Error if it cannot: a full disk.
  void write_part(std::uint64_t number, unsigned part,
                  const std::function<void(Writer& writer)>& write);
  void write_manifest(const SearchProgress& progress) const;
  void remove_part(std::uint64_t number, unsigned part) const;
  // Throws UsageError for a part that is damaged.
  void read_part(std::uint64_t number, unsigned part,
                 const std::function<void(Reader& reader)>& read) const;

  // A checkpoint was written, or could not be: the next is due after the interval.
  void start_interval();

 private:
  using Clock = std::chrono::steady_clock;
  std::filesystem::path manifest() const;
  std::filesystem::path part_file(std::uint64_t number, unsigned part) const;

  std::filesystem::path folder_;
  std::uint64_t key_;
  double interval_;
  Clock::time_point last_ = Clock::now(), began_{};
  double took_ = 0;  // seconds, the last one
};

// Both ways, for the other ranks.
Ranks::Bytes encode(const std::optional<SearchProgress>& progress);
std::optional<SearchProgress> decode_progress(const Ranks::Bytes& bytes);

}  // namespace maide
