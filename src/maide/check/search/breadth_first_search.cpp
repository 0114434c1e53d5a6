#include "maide/check/search/breadth_first_search.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <deque>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/log.hpp"
#include "maide/base/numbers.hpp"
#include "maide/check/packed/packed_steps.hpp"
#include "maide/check/search/checkpoint.hpp"
#include "maide/check/search/goal_rounds.hpp"
#include "maide/check/search/ranks.hpp"

namespace maide {
namespace {

// All that can be reached is looked for.
struct NoGoal {
  template <typename State>
  bool on_step(const State&, const State&, std::size_t, std::uint32_t, bool) const {
    return false;
  }
  template <typename State>
  bool on_end(const State&) const {
    return false;
  }
};

}  // namespace

template <std::size_t words>
class BreadthFirstSearch<words>::Search {
 public:
  Search(std::unique_ptr<SearchRounds<words>> rounds, const SearchLimits& limits)
      : own_rounds_(std::move(rounds)),
        rounds_(*own_rounds_),
        system_(rounds_.system()),
        limits_(limits),
        options_(rounds_.options()),
        steps_(system_),
        initial_(steps_.initial()) {
    if (options_.ranks == nullptr) return;
    batches_.emplace(*options_.ranks);
    replies_.emplace(*options_.ranks);
  }

  // With ranks: on all of them, which have the same result.
  SearchResult run() {
    if (batches_) {
      search_on_ranks();
    } else {
      try {
        search();
      } catch (const std::bad_alloc&) {
        result_.end = End::out_of_memory;
      }
      result_.states = rounds_.table().size();
      result_.transitions = rounds_.transitions();
      result_.has_cut = rounds_.has_cut();
      result_.bytes = std::max(result_.bytes, rounds_.bytes());
    }
    if (saved_.is_done) return saved_result();
    if (options_.checkpoint != nullptr && result_.end == End::complete) save_end();
    return std::move(result_);
  }

  const SearchRounds<words>& rounds() const { return rounds_; }
  // The run by which the search came to a state of the table.
  Trace run_to(const State& state) const { return trace_to(system_.unpack(state)); }

 private:
  using Rounds = SearchRounds<words>;
  using Batch = typename Rounds::Batch;
  using Chain = typename Rounds::Chain;
  using Find = typename Rounds::Find;
  using Parcel = typename Rounds::Parcel;
  using Piece = typename Rounds::Piece;
  using End = SearchResult::End;

  void search() {
    begin();
    check_what_was_loaded(rounds_.table().size(), rounds_.next_size());
    std::uint64_t visited = 0;
    while (rounds_.next_size() > 0 && result_.depth <= limits_.depth) {
      if (is_due()) save(rounds_.table().size(), rounds_.next_size());
      rounds_.begin_level();
      ++result_.depth;
      const std::size_t size = rounds_.level_size();
      for (std::size_t first = 0; first < size || rounds_.has_postponed();) {
        const std::size_t end = std::min(size, first + 16 * options_.states_a_thread);
        if (run_round(first, end)) return;
        visited += end - first;
        if (visited >= limit_interval) {
          visited = 0;
          if (!look_at_limits(rounds_.table().size())) return;
        }
        first = end;
      }
    }
  }

  // True if the search is over: the goal is met, or the control says stop.
  bool run_round(std::size_t first, std::size_t end) {
    const std::size_t used = rounds_.expand(first, end);
    if (rounds_.is_cut_off()) {
      look_at_limits(rounds_.table().size());
      return true;
    }
    std::vector<Batch*> batches;
    for (std::size_t i = 0; i < used; ++i) batches.push_back(&rounds_.pieces()[i].batch);
    rounds_.enter(batches, rounds_.threads());
    rounds_.postpone();
    const std::optional<Find>& find = rounds_.pieces()[used - 1].find;
    if (find) show(*find);
    return find.has_value();
  }

  // At the initial state, or where a search that was stopped had come to.
  void begin() {
    std::optional<SearchProgress> saved;
    if (options_.checkpoint != nullptr) {
      Ranks::Bytes bytes;
      if (is_first()) {
        const auto last = options_.checkpoint->find();
        options_.checkpoint->remove_leftovers(last);
        bytes = encode(last);
      }
      if (batches_) batches_->ranks().broadcast(bytes, 0);
      saved = decode_progress(bytes);
    }
    if (!saved) {
      rounds_.begin_at(initial_);
      return;
    }
    saved_ = *saved;
    result_.depth = saved->depth;
    if (saved->is_done) return;
    if (is_first()) rounds_.count_on(saved->transitions, saved->has_cut);
    for (unsigned part = 0; part < saved->parts; ++part) {
      options_.checkpoint->read_part(saved->number, part,
                                     [&](Checkpoint::Reader& reader) { rounds_.load(reader); });
    }
  }
  // `states` and `next` are those of all parts together. Called before the first level.
  void check_what_was_loaded(std::uint64_t states, std::uint64_t next) const {
    if (saved_.number == 0 || saved_.is_done || result_.depth != saved_.depth) return;
    options_.checkpoint->check_total(saved_, states, next);
  }
  bool is_first() const { return !batches_ || batches_->ranks().rank() == 0; }
  bool is_due() const {
    return options_.checkpoint != nullptr && is_first() && options_.checkpoint->is_due();
  }

  // All ranks write how far the search has come. Where one cannot, the checkpoint before stays.
  void save(std::uint64_t states, std::uint64_t next) {
    Checkpoint& checkpoint = *options_.checkpoint;
    const unsigned rank = batches_ ? batches_->ranks().rank() : 0;
    SearchProgress now;
    now.number = saved_.number + 1;
    now.parts = batches_ ? batches_->ranks().size() : 1;
    now.depth = result_.depth;
    now.states = states;
    now.next = next;
    RankReport own = report();
    own.has_failed = !can_write([&] {
      checkpoint.write_part(now.number, rank,
                            [&](Checkpoint::Writer& writer) { rounds_.save(writer); });
    });
    RankReport sum = together(own);
    now.transitions = sum.transitions;
    now.has_cut = sum.has_cut;
    // The parts of one that failed go; else those of the one before.
    own.has_failed =
        sum.has_failed || (is_first() && !can_write([&] { checkpoint.write_manifest(now); }));
    sum = together(own);
    remove_parts(sum.has_failed ? now : std::exchange(saved_, now));
    checkpoint.start_interval();
  }
  // The search has come to its end: what it found stays.
  void save_end() {
    SearchProgress now;
    now.number = saved_.number + 1;
    now.depth = result_.depth;
    now.states = result_.states;
    now.transitions = result_.transitions;
    now.has_cut = result_.has_cut;
    now.is_done = true;
    const bool is_written =
        !is_first() || can_write([&] { options_.checkpoint->write_manifest(now); });
    RankReport own;
    own.has_failed = !is_written;
    if (!together(own).has_failed) remove_parts(saved_);
  }
  void remove_parts(const SearchProgress& outdated) {
    const unsigned ranks = batches_ ? batches_->ranks().size() : 1;
    for (unsigned part = batches_ ? batches_->ranks().rank() : 0; part < outdated.parts;
         part += ranks) {
      options_.checkpoint->remove_part(outdated.number, part);
    }
  }
  // The result of a search that had come to its end.
  SearchResult saved_result() {
    result_.states = saved_.states;
    result_.transitions = saved_.transitions;
    result_.has_cut = saved_.has_cut;
    return std::move(result_);
  }
  template <typename Write>
  static bool can_write(Write&& write) {
    try {
      write();
      return true;
    } catch (const Error& error) {
      log_warning(std::string("no checkpoint was written: ") + error.what());
      return false;
    }
  }
  // What all ranks tell now.
  RankReport together(const RankReport& own) {
    return batches_ ? sum_of(batches_->exchange(own)) : own;
  }

  bool look_at_limits(std::uint64_t states) {
    return may_go_on(limits_, states, rounds_.bytes(), rounds_.growth_bytes(), result_);
  }

  // ---- with other ranks ----

  // A round that was expanded, while its batches are on their way.
  struct Round {
    std::vector<Batch> batches;
    unsigned threads = 1;
  };

  RankReport report() const {
    RankReport own;
    own.states = rounds_.table().size();
    own.transitions = rounds_.transitions();
    own.bytes = rounds_.bytes();
    if (batches_) own.sent_bytes = batches_->sent_bytes() + replies_->sent_bytes();
    own.next = rounds_.next_size();
    own.has_cut = rounds_.has_cut();
    own.stop = static_cast<std::uint8_t>(stop_);
    return own;
  }

  void search_on_ranks() {
    try {
      begin();
    } catch (const std::bad_alloc&) {
      stop_ = End::out_of_memory;
    }
    std::uint64_t most_bytes = 0;
    RankReport sum;
    while (!saved_.is_done) {
      RankReport own = report();
      own.is_due = is_due();
      sum = together(own);
      most_bytes = std::max(most_bytes, sum.bytes);
      all_states_ = sum.states;
      end_ = static_cast<End>(sum.stop);
      if (end_ != End::complete) break;
      check_what_was_loaded(sum.states, sum.next);
      if (sum.next == 0 || result_.depth > limits_.depth) break;
      if (sum.is_due) save(sum.states, sum.next);
      rounds_.begin_level();
      ++result_.depth;
      run_level_on_ranks();
      if (end_ != End::complete) {
        sum = together(report());
        all_states_ = sum.states;
        break;
      }
    }
    result_.end = end_;
    if (end_ == End::found) show_on_ranks();
    result_.states = sum.states;
    result_.transitions = sum.transitions;
    result_.has_cut = sum.has_cut;
    result_.sent_bytes = sum.sent_bytes;
    result_.bytes = std::max(most_bytes, sum.bytes);
  }

  // A round with the pieces of so many ranks leaves enough for each batch.
  static constexpr unsigned most_ranks_in_round = 16;

  // A rank may be one round ahead of those whose batches it has.
  void run_level_on_ranks() {
    expanded_ = 0;
    begin_round();
    while (true) {
      if (has_left() && batches_->pending() == 1 && !waits_for_replies()) begin_round();
      end_round();
      if (end_ != End::complete) {
        // Others may have begun the next round before they knew.
        if (is_any_left_ && batches_->pending() == 0) begin_round();
        while (batches_->pending() > 0) end_round();
        return;
      }
      if (batches_->pending() > 0) continue;
      if (!is_any_left_) return;
      begin_round();
    }
  }

  bool has_left() const { return expanded_ < rounds_.level_size(); }
  // Steps are not put off for ever, so a rank must know which of its states led to new ones.
  bool waits_for_replies() const { return options_.sets != nullptr && options_.puts_nothing_off; }

  void begin_round() {
    if (is_going_on()) look();
    Round round;
    std::vector<std::vector<std::vector<Parcel>>> away;  // by piece, by rank
    const std::size_t used = is_going_on() ? expand() : 0;
    std::vector<Piece>& pieces = rounds_.pieces();
    for (std::size_t i = 0; i < used; ++i) {
      away.push_back(std::exchange(pieces[i].away, {}));
      round.batches.push_back(std::exchange(pieces[i].batch, {}));
    }
    if (used > 0) find_ = pieces[used - 1].find;
    // Behind a find, or the end, nothing more is expanded.
    if (used == 0 || find_) expanded_ = rounds_.level_size();
    RankReport own = report();
    own.is_found = find_.has_value();
    own.is_left = has_left();
    for (Piece& piece : pieces) {
      own.is_left = own.is_left || !piece.reduced.empty();
      piece.away.clear();
    }
    round.threads = rounds_.threads();
    batches_->send(own, away);
    begun_.push_back(std::move(round));
  }

  bool is_going_on() const { return stop_ == End::complete && end_ == End::complete; }

  // The next states of the level: the number of pieces that count.
  std::size_t expand() {
    const std::size_t ranks = std::min(batches_->ranks().size(), most_ranks_in_round);
    const std::size_t first = expanded_;
    expanded_ = std::min(rounds_.level_size(), first + ranks * 16 * options_.states_a_thread);
    try {
      const std::size_t used = rounds_.expand(first, expanded_);
      if (rounds_.is_cut_off()) look();
      return used;
    } catch (const std::bad_alloc&) {
      stop_ = End::out_of_memory;
      return 0;
    }
  }

  // The control, which rank 0 alone may have, and this rank's memory.
  void look() {
    if (!look_at_limits(std::max(all_states_, rounds_.table().size()))) stop_ = result_.end;
  }

  void end_round() {
    const auto received = batches_->receive();
    Round round = std::move(begun_.front());
    begun_.pop_front();
    if (end_ != End::complete) return;
    const RankReport sum = sum_of(received);
    is_any_left_ = sum.is_left;
    all_states_ = sum.states;
    if (sum.is_found || sum.stop != 0) {
      end_ = sum.is_found ? End::found : static_cast<End>(sum.stop);
      while (sum.is_found && !received[finder_].report.is_found) ++finder_;
      return;
    }
    try {
      for (unsigned rank = 0; rank < received.size(); ++rank) {
        if (rank == batches_->ranks().rank()) continue;
        round.batches.push_back(rounds_.unpack(received[rank].items, round.threads));
      }
      std::vector<Batch*> all;
      for (Batch& batch : round.batches) all.push_back(&batch);
      rounds_.enter(all, round.threads);
    } catch (const std::bad_alloc&) {
      stop_ = End::out_of_memory;
    }
    if (waits_for_replies()) reply(round);
  }

  // Tells each rank which of its reduced states led to new ones here.
  void reply(const Round& round) {
    std::vector<std::vector<std::vector<std::uint32_t>>> tags(1);
    tags[0].resize(batches_->ranks().size());
    unsigned rank = 0;
    for (const Batch& batch : round.batches) {
      if (batch.is_own) continue;
      if (rank == batches_->ranks().rank()) ++rank;
      for (std::size_t place = 0; place < batch.is_new.size(); ++place) {
        const std::uint32_t tag = batch.arrivals[place].tag;
        if (batch.is_new[place] != 0 && tag != 0) tags[0][rank].push_back(tag);
      }
      ++rank;
    }
    replies_->send(report(), tags);
    for (const auto& batch : replies_->receive()) {
      for (const std::uint32_t tag : batch.items) rounds_.lead_on(tag);
    }
    rounds_.postpone();
  }

  void show_on_ranks() {
    Ranks& ranks = batches_->ranks();
    Ranks::Bytes bytes(sizeof(Find));
    if (ranks.rank() == finder_) std::memcpy(bytes.data(), &*find_, sizeof(Find));
    ranks.broadcast(bytes, finder_);
    Find find;
    MAIDE_CHECK_ALWAYS(bytes.size() == sizeof find);
    std::memcpy(&find, bytes.data(), sizeof find);
    show(find);
  }

  // The payload of a visited state, from the rank that owns it.
  bool look_up(const State& state, std::uint64_t& payload) const {
    const auto& table = rounds_.table();
    if (!batches_) return table.find(state, payload);
    const unsigned owner = rounds_.owner_of(table.address_of(state));
    Ranks& ranks = batches_->ranks();
    Ranks::Bytes bytes;
    if (ranks.rank() == owner && table.find(state, payload)) {
      bytes.resize(sizeof payload);
      std::memcpy(bytes.data(), &payload, sizeof payload);
    }
    ranks.broadcast(bytes, owner);
    if (bytes.size() != sizeof payload) return false;
    std::memcpy(&payload, bytes.data(), sizeof payload);
    return true;
  }

  // ---- the run that was found ----

  // Puts the steps of the chain into `trace`, the last one first; the state before them.
  GlobalState undo(GlobalState state, Chain chain, Trace& trace) const {
    for (; chain.length > 0; --chain.length) {
      StepBefore origin = steps_.undo(system_.template pack<words>(state),
                                      chain.codes & low_bits(system_.code_bits()));
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
    result_.end = End::found;
  }

  // The run by which the search came to a visited state.
  Trace trace_to(GlobalState state) const {
    Trace trace;
    const GlobalState first = system_.unpack(initial_);
    while (!(state == first)) {
      std::uint64_t payload = 0;
      if (!look_up(system_.template pack<words>(state), payload)) {
        throw std::logic_error("the search lost a state");
      }
      state = undo(std::move(state), rounds_.chain_of(payload), trace);
      // No way goes in circles.
      MAIDE_CHECK(trace.steps.size() <=
                  std::max(all_states_, rounds_.table().size()) * options_.chain);
    }
    std::ranges::reverse(trace.steps);
    return trace;
  }

  std::unique_ptr<Rounds> own_rounds_;
  Rounds& rounds_;
  const PackedSystem& system_;
  const SearchLimits& limits_;
  const BreadthFirstOptions& options_;
  PackedSteps<words> steps_;
  State initial_;
  SearchProgress saved_;  // by the last checkpoint
  // With ranks.
  std::optional<RankBatches<Parcel>> batches_;
  std::optional<RankBatches<std::uint32_t>> replies_;  // tags of reduced states that led on
  std::deque<Round> begun_;                            // and not ended
  std::size_t expanded_ = 0;                           // states of the level
  bool is_any_left_ = false;      // on some rank, behind the round that ended last
  std::uint64_t all_states_ = 0;  // stored on all ranks, as far as it is known
  End stop_ = End::complete;      // why this rank has to end
  End end_ = End::complete;       // why all do
  unsigned finder_ = 0;           // the rank whose find is shown
  std::optional<Find> find_;
  SearchResult result_;
};

template <std::size_t words>
BreadthFirstSearch<words>::BreadthFirstSearch(std::unique_ptr<SearchRounds<words>> rounds,
                                              const SearchLimits& limits)
    : search_(std::make_unique<Search>(std::move(rounds), limits)) {}

template <std::size_t words>
BreadthFirstSearch<words>::BreadthFirstSearch(const PackedSystem& system,
                                              const SearchLimits& limits,
                                              const BreadthFirstOptions& options)
    : BreadthFirstSearch(std::make_unique<GoalRounds<words, NoGoal>>(system, NoGoal(), options),
                         limits) {}

template <std::size_t words>
BreadthFirstSearch<words>::~BreadthFirstSearch() = default;

template <std::size_t words>
SearchResult BreadthFirstSearch<words>::run() {
  return search_->run();
}

template <std::size_t words>
const StateTable<words>& BreadthFirstSearch<words>::table() const {
  return search_->rounds().table();
}

template <std::size_t words>
std::uint64_t BreadthFirstSearch<words>::bytes() const {
  return search_->rounds().bytes();
}

template <std::size_t words>
Trace BreadthFirstSearch<words>::run_to(const State& state) const {
  return search_->run_to(state);
}

template class BreadthFirstSearch<1>;
template class BreadthFirstSearch<2>;
template class BreadthFirstSearch<4>;
template class BreadthFirstSearch<most_own_words>;
template class BreadthFirstSearch<PackedSystem::most_words>;

}  // namespace maide
