// Ranks that are threads of one process and send by mailboxes.
#pragma once

#include <condition_variable>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "maide/check/engines/engine.hpp"
#include "maide/check/search/ranks.hpp"

namespace maide::test {

class Mailboxes {
 public:
  explicit Mailboxes(unsigned ranks) : ranks_(ranks), letters_(2 * ranks * ranks) {}

  unsigned size() const { return ranks_; }
  // What is broadcast comes by a box of its own.
  void put(unsigned from, unsigned to, bool is_broadcast, Ranks::Bytes bytes) {
    const std::scoped_lock lock(mutex_);
    letters_[box(from, to, is_broadcast)].push_back(std::move(bytes));
    came_.notify_all();
  }
  Ranks::Bytes take(unsigned from, unsigned to, bool is_broadcast) {
    std::unique_lock lock(mutex_);
    auto& letters = letters_[box(from, to, is_broadcast)];
    came_.wait(lock, [&] { return !letters.empty(); });
    Ranks::Bytes bytes = std::move(letters.front());
    letters.pop_front();
    return bytes;
  }
  bool are_empty() {
    const std::scoped_lock lock(mutex_);
    for (const auto& letters : letters_) {
      if (!letters.empty()) return false;
    }
    return true;
  }

 private:
  std::size_t box(unsigned from, unsigned to, bool is_broadcast) const {
    return (std::size_t{from} * ranks_ + to) * 2 + (is_broadcast ? 1 : 0);
  }
  unsigned ranks_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<std::deque<Ranks::Bytes>> letters_;
};

class MailboxRanks : public Ranks {
 public:
  MailboxRanks(Mailboxes& boxes, unsigned rank) : boxes_(boxes), rank_(rank) {}
  unsigned rank() const override { return rank_; }
  unsigned size() const override { return boxes_.size(); }
  unsigned on_this_machine() const override { return boxes_.size(); }
  void broadcast(Bytes& data, unsigned root) override {
    if (rank_ != root) {
      data = boxes_.take(root, rank_, true);
      return;
    }
    for (unsigned to = 0; to < size(); ++to) {
      if (to != root) boxes_.put(root, to, true, data);
    }
  }
  void send(std::vector<Bytes> batches) override {
    for (unsigned to = 0; to < size(); ++to) {
      if (to != rank_) boxes_.put(rank_, to, false, std::move(batches[to]));
    }
  }
  std::vector<Bytes> receive() override {
    std::vector<Bytes> batches(size());
    for (unsigned from = 0; from < size(); ++from) {
      if (from != rank_) batches[from] = boxes_.take(from, rank_, false);
    }
    return batches;
  }
  void abort(int /*status*/) override { std::abort(); }

 private:
  Mailboxes& boxes_;
  unsigned rank_;
};

// Ranks 1, 2... on threads of their own, which serve the searches of rank 0.
class RanksOfThreads {
 public:
  explicit RanksOfThreads(unsigned size) : boxes_(size), first_(boxes_, 0) {
    for (unsigned rank = 1; rank < size; ++rank) {
      threads_.emplace_back([this, rank] {
        MailboxRanks ranks(boxes_, rank);
        serve_searches(ranks);
      });
    }
  }
  RanksOfThreads(const RanksOfThreads&) = delete;
  RanksOfThreads& operator=(const RanksOfThreads&) = delete;
  ~RanksOfThreads() {
    end_searches(first_);
    for (std::thread& thread : threads_) thread.join();
    if (!boxes_.are_empty()) std::abort();  // a rank sent what nobody waits for
  }
  Ranks* first() { return &first_; }

 private:
  Mailboxes boxes_;
  MailboxRanks first_;
  std::vector<std::thread> threads_;
};

}  // namespace maide::test
