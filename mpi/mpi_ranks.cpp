// Ranks over MPI (Message Passing Interface 3.1, 2015): what carries a search's batches between
// processes. Messages of a pair of ranks come in the order in which they were sent. Broadcasts have
// a tag of their own.
#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <climits>
#include <cstdio>
#include <deque>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "maide/check/search/ranks.hpp"

namespace {

class MpiRanks : public maide::Ranks {
 public:
  MpiRanks() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_dup(MPI_COMM_WORLD, &world_);
    MPI_Comm_rank(world_, &rank_);
    MPI_Comm_size(world_, &size_);
    MPI_Comm neighbours = MPI_COMM_NULL;
    MPI_Comm_split_type(world_, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &neighbours);
    MPI_Comm_size(neighbours, &on_this_machine_);
    MPI_Comm_free(&neighbours);
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;
  ~MpiRanks() override {
    for (Letter& letter : sent_) MPI_Wait(&letter.request, MPI_STATUS_IGNORE);
    MPI_Comm_free(&world_);
    MPI_Finalize();
  }

  unsigned rank() const override { return static_cast<unsigned>(rank_); }
  unsigned size() const override { return static_cast<unsigned>(size_); }
  unsigned on_this_machine() const override { return static_cast<unsigned>(on_this_machine_); }

  void broadcast(Bytes& data, unsigned root) override {
    if (rank() != root) {
      data = take(static_cast<int>(root), broadcast_tag);
      return;
    }
    for (int to = 0; to < size_; ++to) {
      if (to != rank_) post(to, broadcast_tag, data);
    }
    forget_sent();
  }

  void send(std::vector<Bytes> batches) override {
    for (int to = 0; to < size_; ++to) {
      if (to != rank_) post(to, batch_tag, std::move(batches[static_cast<std::size_t>(to)]));
    }
  }

  std::vector<Bytes> receive() override {
    std::vector<Bytes> batches(size());
    std::vector<int> missing;
    for (int from = 0; from < size_; ++from) {
      if (from != rank_) missing.push_back(from);
    }
    wait_until([&] {
      std::erase_if(missing, [&](int from) {
        return is_there(from, batch_tag, batches[static_cast<std::size_t>(from)]);
      });
      return missing.empty();
    });
    forget_sent();
    return batches;
  }

  void abort(int status) override {
    std::fflush(nullptr);
    MPI_Abort(world_, status);
    std::terminate();
  }

 private:
  static constexpr int batch_tag = 1, broadcast_tag = 2;

  struct Letter {
    MPI_Request request = MPI_REQUEST_NULL;
    Bytes bytes;
  };

  void post(int to, int tag, Bytes bytes) {
    if (bytes.size() > INT_MAX) {
      std::fprintf(stderr, "maide: rank %d: a message of more than 2 GiB\n", rank_);
      abort(3);
    }
    Letter& letter = sent_.emplace_back();
    letter.bytes = std::move(bytes);
    MPI_Isend(letter.bytes.data(), static_cast<int>(letter.bytes.size()), MPI_BYTE, to, tag, world_,
              &letter.request);
  }

  // Takes the next message from there, if it has come.
  bool is_there(int from, int tag, Bytes& bytes) const {
    int is_there = 0;
    MPI_Message message = MPI_MESSAGE_NULL;
    MPI_Status status;
    MPI_Improbe(from, tag, world_, &is_there, &message, &status);
    if (is_there == 0) return false;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    bytes.resize(static_cast<std::size_t>(size));
    MPI_Mrecv(bytes.data(), size, MPI_BYTE, &message, MPI_STATUS_IGNORE);
    return true;
  }

  Bytes take(int from, int tag) const {
    Bytes bytes;
    wait_until([&] { return is_there(from, tag, bytes); });
    return bytes;
  }

  // First awake, since most waits are short, and then with sleeps of up to a millisecond: there may
  // be more ranks than processors, and rank 0 may have work of its own for hours.
  template <typename Condition>
  static void wait_until(Condition&& is_true) {
    constexpr int looks = 2000;
    std::chrono::microseconds pause(20);
    for (int look = 0; !is_true(); ++look) {
      if (look < looks) {
        ::sched_yield();
        continue;
      }
      std::this_thread::sleep_for(pause);
      pause = std::min<std::chrono::microseconds>(2 * pause, std::chrono::milliseconds(1));
    }
  }

  void forget_sent() {
    std::erase_if(sent_, [](Letter& letter) {
      int is_done = 0;
      MPI_Test(&letter.request, &is_done, MPI_STATUS_IGNORE);
      return is_done != 0;
    });
  }

  MPI_Comm world_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1, on_this_machine_ = 1;
  std::deque<Letter> sent_;  // perhaps still on their way
};

}  // namespace

// What maide looks for (cli/mpi.cpp). The number is that of the interface Ranks.
extern "C" [[gnu::visibility("default")]] maide::Ranks* maide_mpi_ranks_1() {
  return new MpiRanks();
}
