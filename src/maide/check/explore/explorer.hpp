// Breadth-first search of a system's states for a step or a state that somebody looks for. It shows
// a shortest run to it, if nothing is left out. Levels are plain lists of packed states. Visited
// states lie in a StateTable, each with the code of the step that led to it (packed_system.hpp). So
// the run is read off backwards, and costs a few bits a state.
//
// A level is searched in rounds of a few thousand states. First the states are expanded: each
// thread has a piece of the round. Then what they led to is entered into the table: each thread has
// segments of its own. What lies there it takes in the order in which the states were expanded. So
// no two threads write to one place, and nothing is locked. What is stored, found and counted, and
// the order of the next level, are the same with any number of threads.
//
// The search saves work in three ways:
//
//   order   all states are visited, but not every transition is followed (step_order.hpp)
//   sets    only the steps of stubborn sets are taken (stubborn_sets.hpp). Where no step may be put
//           off for ever, a state whose steps lead to no new state is expanded whole, in the next
//           round. Each state then has a way to a later one at which the steps left out are still
//           possible
//   chains  a state with a single step is passed by and not stored, a few in a row at most; the
//           codes of all their steps are kept with the state at the end
//
// Sources for expanding whole: Evangelista & Pajault, "Solving the ignoring problem for partial
// order reduction", STTT 2010; Bosnacki & Holzmann, "Improving Spin's partial-order reduction for
// breadth-first search", SPIN 2005.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/thread_team.hpp"
#include "maide/check/explore/packed_system.hpp"
#include "maide/check/explore/search.hpp"
#include "maide/check/explore/step_order.hpp"
#include "maide/check/explore/stubborn_sets.hpp"

namespace maide {

// How a search saves itself work.
struct BreadthFirstOptions {
  const StubbornSets* sets = nullptr;  // not owned; null: every state is visited
  bool puts_nothing_off = false;       // no step is left out for ever; with `sets`
  unsigned chain = 1;                  // most steps from one stored state to the next
  // Not owned; null, as with `sets`: every transition is taken. Else the goal must not depend on
  // the step by which a state was reached.
  const StepOrder* order = nullptr;
  unsigned threads = 1;  // at least 1
  // At least, for it to be worth a thread; a round has sixteen times as many.
  std::size_t states_a_thread = 256;
};

// Bits of payload of a search with chains of that length.
constexpr unsigned chain_bits(unsigned chain, unsigned code_bits) {
  return chain <= 1 ? code_bits : chain * code_bits + bits_for(chain + 1);
}

// A goal says what to look for, in the middle of the innermost loop, on all threads:
//   bool on_step(const PackedState& from, const PackedState& next, std::size_t program,
//                std::uint32_t edge, bool is_cut)      a step; true: the run up to it is wanted
//   bool on_end(const PackedState& state)              nothing can happen but deaths, and it is no
//                                                      error; true: the run is wanted
template <std::size_t words, typename Goal>
class BreadthFirstSearch {
 public:
  using State = PackedState<words>;

  // `system` was made with chain_bits(chain) of payload.
  BreadthFirstSearch(const PackedSystem& system, const Goal& goal, const SearchLimits& limits,
                     const BreadthFirstOptions& options = {})
      : system_(system),
        goal_(goal),
        limits_(limits),
        options_(options),
        initial_(system.pack<words>(initial_state(system.system()))),
        table_(system.address_bits(), chain_bits(options.chain, system.code_bits())),
        team_(std::min<unsigned>(options.threads, Table::segment_count)),
        pieces_(team_.size()) {}

  SearchResult run() {
    try {
      search();
    } catch (const std::bad_alloc&) {
      result_.end = SearchResult::End::out_of_memory;
    }
    result_.states = table_.size();
    result_.bytes = std::max(result_.bytes, bytes());
    return std::move(result_);
  }

 private:
  using Table = StateTable<words>;
  // Between a state's prefetch and its lookup: long enough for memory to answer.
  static constexpr std::size_t pipeline = 16;
  static constexpr std::uint64_t every_program = ~std::uint64_t{0};

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
    // that state's number in Piece::reduced, from 1 on; or 0.
    std::uint32_t tag = 0;
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
    std::vector<Arrival> arrivals;                 // in the order of expanding
    std::vector<std::vector<std::uint32_t>> mine;  // by thread: arrivals in its segments
    std::vector<std::uint8_t> is_new;              // by arrival
    std::vector<Reduced> reduced;
    std::size_t collected_at = 0;  // the place of its first new state in the next level
    std::uint32_t tag = 0;         // of the state that is expanded now
    std::uint64_t transitions = 0;
    bool has_cut = false;
    std::optional<Find> find;
  };
  // A list that grows without moving. New elements are not initialised.
  template <typename T>
  class List {
   public:
    std::size_t size() const { return size_; }
    T& operator[](std::size_t i) { return blocks_[i / block][i % block]; }
    void resize(std::size_t size) {
      while (blocks_.size() * block < size) {
        blocks_.push_back(std::make_unique_for_overwrite<T[]>(block));
      }
      size_ = size;
    }
    std::uint64_t bytes() const { return blocks_.size() * block * sizeof(T); }

   private:
    static constexpr std::size_t block = 4096;
    std::vector<std::unique_ptr<T[]>> blocks_;
    std::size_t size_ = 0;
  };

  std::uint64_t bytes() const {
    std::uint64_t sum = table_.peak_bytes() + level_.bytes() + next_level_.bytes() +
                        lasts_.bytes() + next_lasts_.bytes();
    for (const Piece& piece : pieces_) {
      sum += piece.arrivals.capacity() * (sizeof(Arrival) + sizeof(std::uint32_t) + 1);
    }
    return sum;
  }

  void search() {
    table_.insert(initial_, 0);
    next_level_.resize(1);
    next_level_[0] = initial_;
    if (options_.order != nullptr) {
      next_lasts_.resize(1);
      next_lasts_[0] = StepOrder::first_state;
    }
    std::uint64_t visited = 0;
    while (next_level_.size() > 0 && result_.depth <= limits_.depth) {
      std::swap(level_, next_level_);
      next_level_.resize(0);
      std::swap(lasts_, next_lasts_);
      next_lasts_.resize(0);
      ++result_.depth;
      for (std::size_t first = 0; first < level_.size() || !postponed_.empty();) {
        const std::size_t end = std::min(level_.size(), first + 16 * options_.states_a_thread);
        if (run_round(first, end)) return;
        visited += end - first;
        if (visited >= limit_interval) {
          visited = 0;
          if (!look_at_limits()) return;
        }
        first = end;
      }
      MAIDE_CHECK(next_lasts_.size() == (options_.order != nullptr ? next_level_.size() : 0));
    }
  }

  // Expands the states first..end-1 of the level, and those that were postponed. True if the goal
  // is met.
  bool run_round(std::size_t first, std::size_t end) {
    const std::vector<Reduced> postponed = std::exchange(postponed_, {});
    const std::size_t states = postponed.size() + end - first;
    threads_ = states < 2 * options_.states_a_thread ? 1 : team_.start();
    on_all([&](unsigned thread) {
      const std::size_t begin = states * thread / threads_;
      expand_some(pieces_[thread], postponed, first, begin, states * (thread + 1) / threads_);
    });
    for (Piece& piece : pieces_) piece.is_new.resize(piece.arrivals.size());
    // What comes behind the first find does not count.
    std::size_t used = 0;
    while (used < threads_ && !pieces_[used++].find) {
    }
    const bool grows = threads_ > 1 && table_.is_due(count_arrivals() / Table::segment_count);
    on_all([&](unsigned thread) { enter_all(thread, used, grows); });
    std::size_t size = next_level_.size();
    for (std::size_t i = 0; i < used; ++i) {
      Piece& piece = pieces_[i];
      piece.collected_at = size;
      size += static_cast<std::size_t>(std::count(piece.is_new.begin(), piece.is_new.end(), 1));
      result_.transitions += std::exchange(piece.transitions, 0);
      result_.has_cut = result_.has_cut || piece.has_cut;
    }
    next_level_.resize(size);
    if (options_.order != nullptr) next_lasts_.resize(size);
    on_all([&](unsigned thread) {
      if (thread < used) collect(pieces_[thread]);
    });
    for (std::size_t i = 0; i < used; ++i) {
      for (const Reduced& reduced : pieces_[i].reduced) {
        if (!reduced.leads_on) postponed_.push_back(reduced);
      }
      pieces_[i].reduced.clear();
    }
    if (!pieces_[used - 1].find) return false;
    show(*pieces_[used - 1].find);
    return true;
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

  bool look_at_limits() {
    // Threads may grow a segment each.
    const std::uint64_t growth = threads_ * table_.growth_bytes();
    return may_go_on(limits_, table_.size(), bytes(), growth, result_);
  }

  // ---- expanding ----

  // Of the round's states, which are those that were postponed and then those of the level from
  // `first` on, the numbers begin..end-1; up to a find.
  void expand_some(Piece& piece, const std::vector<Reduced>& postponed, std::size_t first,
                   std::size_t begin, std::size_t end) {
    if (options_.sets != nullptr && !piece.sets) piece.sets.emplace(*options_.sets);
    piece.arrivals.clear();
    piece.mine.resize(team_.size());
    for (auto& arrivals : piece.mine) arrivals.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (i < postponed.size()) {
        if (take_steps(piece, postponed[i].state, ~postponed[i].programs)) return;
        continue;
      }
      const std::size_t place = first + i - postponed.size();
      const State state = level_[place];
      if (system_.is_error(state)) continue;
      if (options_.order != nullptr
              ? expand_in_order(piece, state, (*options_.order)[lasts_[place]])
              : expand(piece, state)) {
        return;
      }
    }
  }

  // True if the goal is met.
  bool expand(Piece& piece, const State& state) {
    if (!piece.sets) return take_steps(piece, state, every_program);
    const std::uint64_t programs = piece.sets->select(state);
    if (options_.puts_nothing_off && piece.sets->is_reduced()) {
      piece.reduced.push_back({state, programs, false});
      piece.tag = static_cast<std::uint32_t>(piece.reduced.size());
    }
    const bool is_found = take_steps(piece, state, programs);
    piece.tag = 0;
    return is_found;
  }

  // All steps, of which those that `last` leaves out are only counted. True if the goal is met.
  bool expand_in_order(Piece& piece, const State& state, const StepOrder::Last& last) {
    const StepOrder& order = *options_.order;
    bool is_end = true;
    for (std::size_t program = 0; program < system_.program_count(); ++program) {
      const auto is_left_out = [&](std::uint32_t edge) {
        return program < last.program && order.leaves_out(last, program, edge);
      };
      if (take_steps(piece, state, program, is_left_out, is_end)) return true;
    }
    return is_end && ends_at(piece, state);
  }

  // The steps of those programs. True if the goal is met.
  bool take_steps(Piece& piece, const State& state, std::uint64_t programs) {
    bool is_end = true;
    const auto is_left_out = [](std::uint32_t) { return false; };
    for (std::size_t program = 0; program < system_.program_count(); ++program) {
      if (program < most_reduced_programs && (programs >> program & 1) == 0) continue;
      if (take_steps(piece, state, program, is_left_out, is_end)) return true;
    }
    return is_end && ends_at(piece, state);
  }

  // The steps of a program, but those of edges that are left out. True if the goal is met; where
  // there is a step other than a death, left out or not, is no end.
  template <typename IsLeftOut>
  bool take_steps(Piece& piece, const State& state, std::size_t program, IsLeftOut&& is_left_out,
                  bool& is_end) {
    bool is_found = false;
    system_.for_each_step(
        state, program,
        [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
          is_end = is_end && system_.is_death(program, edge);
          if (is_found) return;
          ++piece.transitions;
          piece.has_cut = piece.has_cut || is_cut;
          if (is_left_out(edge)) return;
          if (goal_.on_step(state, next, program, edge, is_cut)) {
            is_found = true;
            piece.find = Find{next, {code, 1}};
          } else if (is_cut) {
            return;
          } else if (options_.order != nullptr) {
            push(piece, next, code, options_.order->behind(system_, state, program, edge));
          } else {
            is_found = follow(piece, next, {code, 1});
          }
        });
    return is_found;
  }

  // At a state in which nothing can happen. True if the goal is met.
  bool ends_at(Piece& piece, const State& state) {
    if (!goal_.on_end(state)) return false;
    piece.find = Find{state, {}};
    return true;
  }

  // Passes by states that have one step alone. True if the goal is met.
  bool follow(Piece& piece, State state, Chain chain) {
    while (chain.length < options_.chain && !system_.is_error(state)) {
      const std::uint64_t programs = piece.sets->select(state);
      if (programs == 0 || (programs & (programs - 1)) != 0) break;
      const auto program = static_cast<std::size_t>(std::countr_zero(programs));
      std::size_t count = 0;
      State after{};
      std::uint32_t taken = 0;
      std::uint64_t step_code = 0;
      bool cuts = false;
      system_.for_each_step(
          state, program,
          [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
            ++count;
            after = next;
            taken = edge;
            step_code = code;
            cuts = is_cut;
          });
      if (count != 1 || cuts) break;
      MAIDE_CHECK(step_code <= low_bits(system_.code_bits()));
      ++piece.transitions;
      chain = {(chain.codes << system_.code_bits()) | step_code, chain.length + 1};
      if (goal_.on_step(state, after, program, taken, false)) {
        piece.find = Find{after, chain};
        return true;
      }
      state = after;
    }
    push(piece, state, payload_of(chain), piece.tag);
    return false;
  }

  void push(Piece& piece, const State& state, std::uint64_t payload, std::uint32_t tag) {
    const typename Table::Address address = table_.address_of(state);
    if (threads_ > 1) {
      piece.mine[table_.segment_of(address) % threads_].push_back(
          static_cast<std::uint32_t>(piece.arrivals.size()));
    }
    piece.arrivals.push_back({state, address, static_cast<std::uint32_t>(payload), tag});
  }

  // ---- entering ----

  std::size_t count_arrivals() const {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < threads_; ++i) sum += pieces_[i].arrivals.size();
    return sum;
  }

  // What pieces below `used` have for the thread's segments.
  void enter_all(unsigned thread, std::size_t used, bool grows) {
    for (std::size_t i = thread; grows && i < Table::segment_count; i += threads_) {
      table_.grow_if_near(i);
    }
    for (std::size_t i = 0; i < used; ++i) {
      Piece& piece = pieces_[i];
      if (threads_ == 1) {
        enter_some(piece, piece.arrivals.size(), [](std::size_t place) { return place; });
      } else {
        const std::vector<std::uint32_t>& mine = piece.mine[thread];
        enter_some(piece, mine.size(), [&](std::size_t place) { return mine[place]; });
      }
    }
  }

  // Each lookup comes some time after its prefetch.
  template <typename PlaceOf>
  void enter_some(Piece& piece, std::size_t count, PlaceOf&& place_of) {
    for (std::size_t i = 0; i < count + pipeline; ++i) {
      if (i < count) table_.prefetch(piece.arrivals[place_of(i)].address);
      if (i < pipeline) continue;
      const std::size_t place = place_of(i - pipeline);
      const Arrival& arrival = piece.arrivals[place];
      piece.is_new[place] =
          table_.insert(arrival.state, arrival.address, arrival.payload).is_new ? 1 : 0;
    }
  }

  // Puts the piece's new states into the next level.
  void collect(Piece& piece) {
    std::size_t at = piece.collected_at;
    for (std::size_t i = 0; i < piece.arrivals.size(); ++i) {
      if (piece.is_new[i] == 0) continue;
      const Arrival& arrival = piece.arrivals[i];
      next_level_[at] = arrival.state;
      if (options_.order != nullptr) {
        next_lasts_[at] = arrival.tag;
      } else if (arrival.tag != 0) {
        piece.reduced[arrival.tag - 1].leads_on = true;
      }
      ++at;
    }
  }

  // ---- the run that was found ----

  std::uint64_t payload_of(const Chain& chain) const {
    if (options_.chain <= 1) return chain.codes;
    MAIDE_CHECK(chain.length <= options_.chain);
    MAIDE_CHECK(chain.codes <= low_bits(options_.chain * system_.code_bits()));
    return chain.codes | (std::uint64_t{chain.length} << (options_.chain * system_.code_bits()));
  }
  Chain chain_of(std::uint64_t payload) const {
    if (options_.chain <= 1) return {payload, 1};
    const unsigned bits = options_.chain * system_.code_bits();
    return {payload & low_bits(bits), static_cast<unsigned>(payload >> bits)};
  }

  // Puts the steps of the chain into `trace`, the last one first; the state before them.
  GlobalState undo(GlobalState state, Chain chain, Trace& trace) const {
    for (; chain.length > 0; --chain.length) {
      PackedSystem::Origin origin =
          system_.undo(state, chain.codes & low_bits(system_.code_bits()));
      chain.codes >>= system_.code_bits();
      trace.steps.push_back(origin.step);
      state = std::move(origin.before);
    }
    return state;
  }

  void show(const Find& find) {
    Trace last;
    result_.trace = trace_to(undo(system_.unpack(find.state), find.chain, last));
    result_.trace->steps.insert(result_.trace->steps.end(), last.steps.rbegin(), last.steps.rend());
    result_.end = SearchResult::End::found;
  }

  // The run by which the search came to a visited state.
  Trace trace_to(GlobalState state) const {
    Trace trace;
    const GlobalState first = system_.unpack(initial_);
    while (!(state == first)) {
      std::uint64_t payload = 0;
      if (!table_.find(system_.pack<words>(state), payload)) {
        throw std::logic_error("the search lost a state");
      }
      state = undo(std::move(state), chain_of(payload), trace);
      MAIDE_CHECK(trace.steps.size() <= table_.size() * options_.chain);  // no way goes in circles
    }
    std::reverse(trace.steps.begin(), trace.steps.end());
    return trace;
  }

  const PackedSystem& system_;
  const Goal& goal_;
  const SearchLimits& limits_;
  BreadthFirstOptions options_;
  State initial_;
  Table table_;
  ThreadTeam team_;
  std::vector<Piece> pieces_;  // by thread
  unsigned threads_ = 1;       // of the round
  List<State> level_, next_level_;
  List<std::uint32_t> lasts_, next_lasts_;  // by state of a level, with an order of steps
  std::vector<Reduced> postponed_;
  SearchResult result_;
};

}  // namespace maide
