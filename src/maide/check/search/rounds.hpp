// Rounds of a breadth-first search (breadth_first_search.hpp): states of a level are expanded, and
// what they led to is entered into the table of visited states and into the next level.
//
// A round has a few thousand states. First they are expanded: each thread has a piece of the round.
// Then what they led to is entered: each thread has segments of the table of its own. What lies
// there it takes in the order in which the states were expanded. So no two threads write to one
// place, and nothing is locked. What is stored, found and counted, and the order of the next level,
// are the same with any number of threads.
//
// With other processes (ranks.hpp) a state is entered by the rank that owns it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "maide/base/numbers.hpp"
#include "maide/base/thread_team.hpp"
#include "maide/check/packed/chunks.hpp"
#include "maide/check/packed/packed_system.hpp"
#include "maide/check/packed/state_table.hpp"
#include "maide/check/reduce/step_order.hpp"
#include "maide/check/reduce/stubborn_sets.hpp"
#include "maide/check/search/checkpoint.hpp"
#include "maide/check/search/ranks.hpp"
#include "maide/check/search/search.hpp"

namespace maide {

// How a search saves itself work.
struct BreadthFirstOptions {
  explicit BreadthFirstOptions(const SearchLimits& limits)
      : threads(limits.threads),
        states_a_thread(limits.states_a_thread),
        ranks(limits.ranks),
        control(limits.control) {}

  const StubbornSets* sets = nullptr;  // not owned; null: every state is visited
  bool puts_nothing_off = false;       // no step is left out for ever; with `sets`
  unsigned chain = 1;                  // most steps from one stored state to the next
  // Not owned; null, as with `sets`: every transition is taken. Else the goal must not depend on
  // the step by which a state was reached.
  const StepOrder* order = nullptr;
  unsigned threads;  // at least 1
  // At least, for it to be worth a thread; a round has sixteen times as many.
  std::size_t states_a_thread;
  Ranks* ranks;                      // not owned; null: this process searches alone
  Checkpoint* checkpoint = nullptr;  // not owned; null: there are none
  RunControl control;                // stops a round of states with `sets`, which take their time
};

// Bits of payload of a search with chains of that length.
constexpr unsigned chain_bits(unsigned chain, unsigned code_bits) {
  return chain <= 1 ? code_bits : chain * code_bits + bits_for(chain + 1);
}

// What is looked for is left to the class that takes the steps of the states (goal_rounds.hpp).
template <std::size_t words>
class SearchRounds {
 public:
  using State = PackedState<words>;
  using Table = StateTable<words>;

  // The codes of the steps from one stored state to the next: the last step in the lowest bits.
  struct Chain {
    std::uint64_t codes = 0;
    unsigned length = 0;
  };
  // A state on its way into the table.
  struct Arrival {
    State state;
    typename Table::Address address;
    std::uint32_t payload = 0;
    // With an order of steps, the place of the last one. Else, of what a reduced state leads to,
    // that state's piece and its number there (tag_bits); or 0.
    std::uint32_t tag = 0;
  };
  // A state on its way to another rank, with the payload and tag of an Arrival.
  struct Parcel {
    State state;
    std::uint32_t payload = 0, tag = 0;
  };
  // What came from one thread, or from one rank, in its order.
  struct Batch {
    std::vector<Arrival> arrivals;
    std::vector<std::vector<std::uint32_t>> mine;  // by thread: arrivals in its segments
    std::vector<std::uint8_t> is_new;              // by arrival
    std::size_t collected_at = 0;  // the place of its first new state in the next level
    bool is_own = true;            // it came from this rank
  };
  // A state whose other steps may have to be taken after all.
  struct Reduced {
    State state;
    std::uint64_t programs = 0;
    bool leads_on = false;  // one of its steps led to a new state
  };
  // What was looked for: `chain` leads to it, or it is a stored state (length 0).
  struct Find {
    State state;
    Chain chain;
  };
  // A thread's states of a round, and what they led to.
  struct Piece {
    std::optional<StubbornSets> sets;
    Batch batch;
    std::vector<std::vector<Parcel>> away;  // by rank
    std::vector<Reduced> reduced;
    std::uint32_t first_tag = 0;  // of its reduced states, less one
    std::uint32_t tag = 0;        // of the state that is expanded now
    std::uint64_t transitions = 0;
    bool has_cut = false;
    bool is_cut_off = false;  // the control said stop: states are left
    std::optional<Find> find;
  };
  // Bits of a tag: which piece, and which of its states.
  static constexpr unsigned tag_bits = 27;

  // Keeps a reference.
  SearchRounds(const PackedSystem& system, const BreadthFirstOptions& options)
      : system_(system),
        options_(options),
        table_(system.address_bits(), chain_bits(options.chain, system.code_bits()),
               std::min(words, system.words())),
        team_(std::min<unsigned>(options.threads, Table::segment_count)),
        pieces_(team_.size()) {}
  SearchRounds(const SearchRounds&) = delete;
  SearchRounds& operator=(const SearchRounds&) = delete;
  virtual ~SearchRounds() = default;

  const PackedSystem& system() const { return system_; }
  const BreadthFirstOptions& options() const { return options_; }
  const Table& table() const { return table_; }
  std::vector<Piece>& pieces() { return pieces_; }  // by thread
  unsigned threads() const { return threads_; }     // of the round
  std::uint64_t transitions() const { return transitions_; }
  bool has_cut() const { return has_cut_; }

  // The next level is this state, which no other led to, if this rank owns it.
  void begin_at(const State& state) {
    const auto address = table_.address_of(state);
    if (!is_own(address)) return;
    table_.insert(state, address, 0);
    next_level_.resize(1);
    next_level_[0] = state;
    if (options_.order == nullptr) return;
    next_lasts_.resize(1);
    next_lasts_[0] = StepOrder::first_state;
  }

  // ---- Checkpoints, at the end of a level ----

  // This rank's states, and the next level.
  void save(Checkpoint::Writer& writer) {
    writer.put(table_.size());
    writer.put(next_level_.size());
    table_.for_each([&](const State& state, std::uint64_t payload) {
      for (const std::uint64_t word : state) writer.put(word);
      writer.put(payload);
    });
    for (std::size_t i = 0; i < next_level_.size(); ++i) {
      for (const std::uint64_t word : next_level_[i]) writer.put(word);
      writer.put(options_.order != nullptr ? next_lasts_[i] : 0);
    }
  }
  // Loads what this rank owns, from what any rank saved.
  void load(Checkpoint::Reader& reader) {
    const std::uint64_t states = reader.get(), next = reader.get();
    const auto get_own = [&](auto&& keep) {
      State state;
      for (std::uint64_t& word : state) word = reader.get();
      const std::uint64_t more = reader.get();
      const auto address = table_.address_of(state);
      if (is_own(address)) keep(state, address, more);
    };
    for (std::uint64_t i = 0; i < states; ++i) {
      get_own([&](const State& state, const auto& address, std::uint64_t payload) {
        table_.insert(state, address, payload);
      });
    }
    for (std::uint64_t i = 0; i < next; ++i) {
      get_own([&](const State& state, const auto&, std::uint64_t last) {
        const std::size_t at = next_level_.size();
        next_level_.resize(at + 1);
        next_level_[at] = state;
        if (options_.order == nullptr) return;
        next_lasts_.resize(at + 1);
        next_lasts_[at] = static_cast<std::uint32_t>(last);
      });
    }
  }
  // What was counted before.
  void count_on(std::uint64_t transitions, bool has_cut) {
    transitions_ = transitions;
    has_cut_ = has_cut;
  }

  // The next level becomes the level.
  void begin_level() {
    std::swap(level_, next_level_);
    next_level_.resize(0);
    std::swap(lasts_, next_lasts_);
    next_lasts_.resize(0);
  }
  std::size_t level_size() const { return level_.size(); }
  std::size_t next_size() const { return next_level_.size(); }
  // The last expand() left states out, for the control says stop.
  bool is_cut_off() const { return is_cut_off_; }
  bool has_postponed() const { return !postponed_.empty(); }

  std::uint64_t bytes() const {
    std::uint64_t sum = table_.peak_bytes() + level_.bytes() + next_level_.bytes() +
                        lasts_.bytes() + next_lasts_.bytes();
    for (const Piece& piece : pieces_) {
      sum += piece.batch.arrivals.capacity() * (sizeof(Arrival) + sizeof(std::uint32_t) + 1);
    }
    return sum;
  }

  // What the table may need on top, where several threads grow a segment each.
  std::uint64_t growth_bytes() const { return threads_ * table_.growth_bytes(); }

  // Expands the states first..end-1 of the level, and those that were postponed. The number of
  // pieces that count: up to the first find.
  std::size_t expand(std::size_t first, std::size_t end) {
    const std::vector<Reduced> postponed = std::exchange(postponed_, {});
    const std::size_t states = postponed.size() + end - first;
    threads_ = states < 2 * options_.states_a_thread ? 1 : team_.start();
    on_all([&](unsigned thread) {
      const std::size_t begin = states * thread / threads_;
      Piece& piece = pieces_[thread];
      if (options_.sets != nullptr && !piece.sets) piece.sets.emplace(*options_.sets);
      piece.first_tag = thread << tag_bits;
      if (options_.ranks != nullptr) piece.away.resize(options_.ranks->size());
      clear(piece.batch);
      expand_some(piece, postponed, first, begin, states * (thread + 1) / threads_);
    });
    std::size_t used = 0;
    while (used < threads_ && !pieces_[used++].find) {
    }
    is_cut_off_ = std::ranges::any_of(pieces_, &Piece::is_cut_off);
    for (std::size_t i = 0; i < used; ++i) {
      transitions_ += std::exchange(pieces_[i].transitions, 0);
      has_cut_ = has_cut_ || pieces_[i].has_cut;
    }
    return used;
  }

  // Puts the batches into the table, and what is new into the next level. `threads`: of the round
  // in which they were expanded.
  void enter(const std::vector<Batch*>& batches, unsigned threads) {
    threads_ = threads;
    std::size_t arrivals = 0;
    for (Batch* batch : batches) {
      arrivals += batch->arrivals.size();
      batch->is_new.resize(batch->arrivals.size());
    }
    const bool grows = threads_ > 1 && table_.is_due(arrivals / Table::segment_count);
    on_all([&](unsigned thread) { enter_all(thread, batches, grows); });
    std::size_t size = next_level_.size();
    for (Batch* batch : batches) {
      batch->collected_at = size;
      size += static_cast<std::size_t>(std::ranges::count(batch->is_new, 1));
    }
    next_level_.resize(size);
    if (options_.order != nullptr) next_lasts_.resize(size);
    on_all([&](unsigned thread) {
      for (std::size_t i = thread; i < batches.size(); i += threads_) collect(*batches[i]);
    });
  }

  // Reduced states that led to nothing new are expanded whole in the next round.
  void postpone() {
    for (Piece& piece : pieces_) {
      for (const Reduced& reduced : piece.reduced) {
        if (!reduced.leads_on) postponed_.push_back(reduced);
      }
      piece.reduced.clear();
    }
  }

  // What came from another rank, for a round with that number of threads.
  Batch unpack(const std::vector<Parcel>& parcels, unsigned threads) const {
    Batch batch;
    batch.is_own = false;
    clear(batch);
    for (const Parcel& parcel : parcels) {
      add(batch, threads,
          {parcel.state, table_.address_of(parcel.state), parcel.payload, parcel.tag});
    }
    return batch;
  }

  // The reduced state of that tag led to a new one.
  void lead_on(std::uint32_t tag) {
    pieces_[tag >> tag_bits].reduced[(tag & low_bits(tag_bits)) - 1].leads_on = true;
  }

  // The rank that owns the state, of several.
  unsigned owner_of(const typename Table::Address& address) const {
    return maide::owner_of(address.scrambled, options_.ranks->size());
  }

  // How a search came to a state of that payload.
  Chain chain_of(std::uint64_t payload) const {
    if (options_.chain <= 1) return {payload, 1};
    const unsigned bits = options_.chain * system_.code_bits();
    return {payload & low_bits(bits), static_cast<unsigned>(payload >> bits)};
  }

 protected:
  // Takes the steps of the round's states number begin..end-1, and pushes what they lead to. The
  // round has the states that were postponed, and then those of the level from `first` on. Stops
  // where the goal is met.
  virtual void expand_some(Piece& piece, const std::vector<Reduced>& postponed, std::size_t first,
                           std::size_t begin, std::size_t end) = 0;

  // A state of the level, and with an order of steps what the last one into it leaves out.
  const State& state_at(std::size_t place) { return level_[place]; }
  const StepOrder::Last& last_at(std::size_t place) { return (*options_.order)[lasts_[place]]; }

  // Puts the state on its way, to the table or to the rank that owns it.
  [[gnu::always_inline]] void push(Piece& piece, const State& state, std::uint64_t payload,
                                   std::uint32_t tag) {
    const typename Table::Address address = table_.address_of(state);
    const auto bits = static_cast<std::uint32_t>(payload);
    if (is_own(address)) {
      add(piece.batch, threads_, {state, address, bits, tag});
    } else {
      piece.away[owner_of(address)].push_back({state, bits, tag});
    }
  }

 private:
  // Between a state's prefetch and its lookup: long enough for memory to answer.
  static constexpr std::size_t pipeline = 16;

  [[gnu::always_inline]] bool is_own(const typename Table::Address& address) const {
    return options_.ranks == nullptr || owner_of(address) == options_.ranks->rank();
  }

  // Calls `work` with the number of each thread of the round.
  template <typename Work>
  void on_all(Work&& work) {
    if (threads_ == 1) {
      work(0U);
    } else {
      team_.run(work);
    }
  }

  void clear(Batch& batch) const {
    batch.arrivals.clear();
    batch.mine.resize(team_.size());
    for (auto& arrivals : batch.mine) arrivals.clear();
  }

  [[gnu::always_inline]] void add(Batch& batch, unsigned threads, const Arrival& arrival) const {
    if (threads > 1) {
      batch.mine[table_.segment_of(arrival.address) % threads].push_back(
          static_cast<std::uint32_t>(batch.arrivals.size()));
    }
    batch.arrivals.push_back(arrival);
  }

  // ---- entering ----

  // What the batches have for the thread's segments.
  void enter_all(unsigned thread, const std::vector<Batch*>& batches, bool grows) {
    for (std::size_t i = thread; grows && i < Table::segment_count; i += threads_) {
      table_.grow_if_near(i);
    }
    for (Batch* batch : batches) {
      if (threads_ == 1) {
        enter_some(*batch, batch->arrivals.size(), [](std::size_t place) { return place; });
      } else {
        const std::vector<std::uint32_t>& mine = batch->mine[thread];
        enter_some(*batch, mine.size(), [&](std::size_t place) { return mine[place]; });
      }
    }
  }

  // Each lookup comes some time after its prefetch.
  template <typename PlaceOf>
  void enter_some(Batch& batch, std::size_t count, PlaceOf&& place_of) {
    for (std::size_t i = 0; i < count + pipeline; ++i) {
      if (i < count) table_.prefetch(batch.arrivals[place_of(i)].address);
      if (i < pipeline) continue;
      const std::size_t place = place_of(i - pipeline);
      const Arrival& arrival = batch.arrivals[place];
      batch.is_new[place] =
          table_.insert(arrival.state, arrival.address, arrival.payload).is_new ? 1 : 0;
    }
  }

  // Puts the batch's new states into the next level.
  void collect(const Batch& batch) {
    std::size_t at = batch.collected_at;
    for (std::size_t i = 0; i < batch.arrivals.size(); ++i) {
      if (batch.is_new[i] == 0) continue;
      const Arrival& arrival = batch.arrivals[i];
      next_level_[at] = arrival.state;
      if (options_.order != nullptr) {
        next_lasts_[at] = arrival.tag;
      } else if (arrival.tag != 0 && batch.is_own) {
        lead_on(arrival.tag);
      }
      ++at;
    }
  }

  const PackedSystem& system_;
  BreadthFirstOptions options_;
  Table table_;
  ThreadTeam team_;
  std::vector<Piece> pieces_;
  unsigned threads_ = 1;
  ChunkedList<State> level_, next_level_;
  ChunkedList<std::uint32_t> lasts_, next_lasts_;  // by state of a level, with an order of steps
  std::vector<Reduced> postponed_;
  std::uint64_t transitions_ = 0;
  bool has_cut_ = false;
  bool is_cut_off_ = false;
};

}  // namespace maide
