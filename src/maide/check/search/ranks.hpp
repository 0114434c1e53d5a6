// Processes that search one system together. Each is a rank: it owns the states that a hash gives
// it, and sends every other state that it comes to to its owner, in batches. What carries the
// batches is behind an interface: MPI between processes (mpi/mpi_ranks.cpp), a mailbox between the
// threads of a test.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"

namespace maide {

// The ranks as one of them sees them. All call the same members in the same order, but that sends
// and receives may lie side by side. Not thread-safe. An error of the transport ends the process.
class Ranks {
 public:
  using Bytes = std::vector<unsigned char>;
  virtual ~Ranks() = default;

  virtual unsigned rank() const = 0;  // from 0
  virtual unsigned size() const = 0;  // at least 1
  // Ranks, this one included, that share this machine's memory.
  virtual unsigned on_this_machine() const = 0;

  // Gives all ranks the `data` of rank `root`. One that waits for long sleeps.
  virtual void broadcast(Bytes& data, unsigned root) = 0;
  // Begins to send batches[r] to each other rank r, and returns.
  virtual void send(std::vector<Bytes> batches) = 0;
  // Waits for what all others sent with their first send() that was not received yet; by rank. Each
  // rank has begun that send(), and at most one more.
  virtual std::vector<Bytes> receive() = 0;
  // Ends all ranks at once, with that status of the process. Does not return.
  virtual void abort(int status) = 0;
};

// The rank that owns a state, of `ranks`: by the state's place in a table of all states.
inline unsigned owner_of(std::uint64_t scrambled, unsigned ranks) {
  const std::uint64_t hash = hash_mix(0, scrambled) >> 32;
  return static_cast<unsigned>(hash * ranks >> 32);
}

// What a rank tells of itself with each batch.
struct RankReport {
  std::uint64_t states = 0;       // stored
  std::uint64_t transitions = 0;  // seen
  std::uint64_t bytes = 0;        // held
  std::uint64_t sent_bytes = 0;   // to other ranks, in all
  std::uint64_t next = 0;         // states of the next level, as far as it knows
  bool is_left = false;           // it has something left to expand
  bool has_cut = false;
  bool is_found = false;
  bool is_due = false;      // a checkpoint
  bool has_failed = false;  // to write its part of it
  std::uint8_t stop = 0;    // why it must end: a SearchResult::End; 0: it need not
};

// The batches of a search: lists of `Item`, which is copied as bytes, each with a report.
template <typename Item>
class RankBatches {
 public:
  explicit RankBatches(Ranks& ranks) : ranks_(ranks) {}

  Ranks& ranks() const { return ranks_; }
  unsigned pending() const { return static_cast<unsigned>(own_.size()); }  // sent, not received

  // `lists`: one a rank and thread, lists[thread][rank]; emptied.
  template <typename Lists>
  void send(const RankReport& own, Lists&& lists) {
    std::vector<Ranks::Bytes> batches(ranks_.size());
    for (unsigned rank = 0; rank < ranks_.size(); ++rank) {
      if (rank == ranks_.rank()) continue;
      std::size_t count = 0;
      for (const auto& list : lists) count += list[rank].size();
      Ranks::Bytes& bytes = batches[rank];
      bytes.resize(sizeof own + count * sizeof(Item));
      std::memcpy(bytes.data(), &own, sizeof own);
      std::size_t at = sizeof own;
      for (auto& list : lists) {
        const std::size_t size = list[rank].size() * sizeof(Item);
        if (size > 0) std::memcpy(bytes.data() + at, list[rank].data(), size);
        at += size;
        list[rank].clear();
      }
      sent_bytes_ += bytes.size();
    }
    own_.push_back(own);
    ranks_.send(std::move(batches));
  }
  void send(const RankReport& own) { send(own, std::vector<std::vector<std::vector<Item>>>()); }

  struct Batch {
    RankReport report;
    std::vector<Item> items;  // none of this rank's own
  };
  // By rank.
  std::vector<Batch> receive() {
    MAIDE_CHECK(!own_.empty());
    const std::vector<Ranks::Bytes> bytes = ranks_.receive();
    std::vector<Batch> batches(ranks_.size());
    for (unsigned rank = 0; rank < ranks_.size(); ++rank) {
      Batch& batch = batches[rank];
      if (rank == ranks_.rank()) {
        batch.report = own_.front();
        own_.erase(own_.begin());
        continue;
      }
      const std::size_t size = bytes[rank].size();
      if (size < sizeof batch.report || (size - sizeof batch.report) % sizeof(Item) != 0) {
        throw std::logic_error("a batch of another rank is of another search");
      }
      std::memcpy(&batch.report, bytes[rank].data(), sizeof batch.report);
      batch.items.resize((size - sizeof batch.report) / sizeof(Item));
      if (!batch.items.empty()) {
        std::memcpy(batch.items.data(), bytes[rank].data() + sizeof batch.report,
                    batch.items.size() * sizeof(Item));
      }
    }
    return batches;
  }

  // Tells all ranks a value that each knows of itself; what each said, by rank.
  std::vector<Batch> exchange(const RankReport& own) {
    MAIDE_CHECK(own_.empty());
    send(own);
    return receive();
  }

  std::uint64_t sent_bytes() const { return sent_bytes_; }

 private:
  Ranks& ranks_;
  std::vector<RankReport> own_;  // of what was sent and not received
  std::uint64_t sent_bytes_ = 0;
};

// What all ranks told, as one: sums, and "any of them".
template <typename Batches>
RankReport sum_of(const Batches& batches) {
  RankReport sum;
  for (const auto& batch : batches) {
    const RankReport& one = batch.report;
    sum.states += one.states;
    sum.transitions += one.transitions;
    sum.bytes += one.bytes;
    sum.sent_bytes += one.sent_bytes;
    sum.next += one.next;
    sum.is_left = sum.is_left || one.is_left;
    sum.has_cut = sum.has_cut || one.has_cut;
    sum.is_found = sum.is_found || one.is_found;
    sum.is_due = sum.is_due || one.is_due;
    sum.has_failed = sum.has_failed || one.has_failed;
    sum.stop = std::max(sum.stop, one.stop);
  }
  return sum;
}

// Takes part in the native engine's searches of rank 0, until it calls end_searches().
void serve_searches(Ranks& ranks);
void end_searches(Ranks& ranks);

}  // namespace maide
