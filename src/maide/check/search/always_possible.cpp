#include "maide/check/search/always_possible.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "maide/base/hash.hpp"
#include "maide/base/invariant.hpp"
#include "maide/check/packed/packed_steps.hpp"
#include "maide/check/search/monitors.hpp"

namespace maide {
namespace {

constexpr std::uint32_t no_step = ~std::uint32_t{0};

template <std::size_t words>
struct StateHash {
  std::size_t operator()(const PackedState<words>& state) const {
    std::uint64_t sum = state[0];
    for (std::size_t i = 1; i < words; ++i) sum = hash_mix(sum, state[i]);
    return static_cast<std::size_t>(hash_mix(sum, words));
  }
};

// What is known of the runs from a state.
enum class Reach : std::uint8_t {
  never,  // no_step comes to the expression
  open,   // one comes to the bounds
  comes,  // one comes to the expression
};

template <std::size_t words>
class PossibleSearch {
 public:
  using State = PackedState<words>;

  PossibleSearch(const PackedSystem& packed, const Condition& condition, const SearchLimits& limits)
      : steps_(packed), condition_(condition), limits_(limits) {}

  AlwaysPossible run() {
    AlwaysPossible result;
    SearchResult& search = result.search;
    const State initial = steps_.initial();
    starts_well_ = condition_.is_true(steps_.packed(), initial, 0, PackedAtom::no_edge);
    number_of(initial, no_step, 0);
    for (std::uint32_t at = 0; at < states_.size(); ++at) {
      if (at % limit_interval == 0 && !may_go_on(limits_, states_.size(), bytes(), 0, search)) {
        search.states = states_.size();
        return result;
      }
      expand(at, search);
    }
    search.states = states_.size();
    search.bytes = std::max(search.bytes, bytes());
    go_back(Reach::comes);
    go_back(Reach::open);
    decide(result);
    return result;
  }

 private:
  struct Edge {
    std::uint32_t from = 0, to = 0;
    bool is_good = false;  // the expression holds behind it
  };

  std::uint64_t bytes() const {
    constexpr std::uint64_t of_table = 48;  // a place in the table, and the state's in the list
    return states_.size() * (2 * sizeof(State) + of_table) + edges_.size() * sizeof(Edge);
  }

  std::uint32_t number_of(const State& state, std::uint32_t before, std::uint64_t code) {
    const auto [place, is_new] =
        numbers_.try_emplace(state, static_cast<std::uint32_t>(states_.size()));
    if (is_new) {
      states_.push_back(state);
      ways_.push_back({before, code});
      reach_.push_back(steps_.packed().is_error(state) ? Reach::open : Reach::never);
    }
    return place->second;
  }

  void expand(std::uint32_t at, SearchResult& search) {
    const State state = states_[at];
    steps_.for_each(state, [&](const State& next, std::size_t actor, std::uint32_t action,
                               bool is_cut, std::uint64_t code) {
      ++search.transitions;
      if (is_cut) {
        search.has_cut = true;
        if (reach_[at] == Reach::never) reach_[at] = Reach::open;
        return;
      }
      const bool is_good = !steps_.packed().is_error(next) &&
                           condition_.is_true(steps_.packed(), next, actor, action);
      if (is_good) reach_[at] = Reach::comes;
      edges_.push_back({at, number_of(next, at, code), is_good});
    });
  }

  // From the states that come there backward.
  void go_back(Reach reach) {
    if (first_.empty()) sort_edges();
    std::vector<std::uint32_t> open;
    for (std::uint32_t at = 0; at < states_.size(); ++at) {
      if (reach_[at] >= reach) open.push_back(at);
    }
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      for (std::uint32_t i = first_[at]; i < first_[at + 1]; ++i) {
        const std::uint32_t before = edges_[i].from;
        if (reach_[before] >= reach) continue;
        reach_[before] = reach;
        open.push_back(before);
      }
    }
  }

  // By where they lead.
  void sort_edges() {
    std::ranges::sort(edges_, {}, &Edge::to);
    first_.assign(states_.size() + 1, 0);
    for (const Edge& edge : edges_) ++first_[edge.to + 1];
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  }

  // The first state that is no position at which the expression holds, and from which it is out of
  // reach; of those the nearest.
  void decide(AlwaysPossible& result) {
    std::uint32_t worst = no_step, doubtful = no_step;
    std::uint32_t before = no_step;
    const auto look = [&](std::uint32_t at, bool is_good, std::uint32_t from) {
      if (is_good || reach_[at] == Reach::comes) return;
      std::uint32_t& nearest = reach_[at] == Reach::never ? worst : doubtful;
      if (at >= nearest) return;
      nearest = at;
      if (reach_[at] == Reach::never) before = from;
    };
    look(0, starts_well_, no_step);
    for (const Edge& edge : edges_) look(edge.to, edge.is_good, edge.from);
    result.depends_on_bounds = doubtful != no_step;
    if (worst == no_step) return;
    result.search.end = SearchResult::End::found;
    result.search.trace.emplace();
    auto& steps = result.search.trace->steps;
    // The step by which it was met first may be one behind which the expression holds.
    if (worst != 0 && before != ways_[worst].before) {
      steps.push_back(bad_step(before, worst));
      worst = before;
    }
    for (; ways_[worst].before != no_step; worst = ways_[worst].before) {
      steps.push_back(steps_.undo(states_[worst], ways_[worst].code).step);
    }
    std::ranges::reverse(steps);
  }

  Step bad_step(std::uint32_t from, std::uint32_t to) const {
    std::optional<Step> found;
    steps_.for_each(states_[from], [&](const State& next, std::size_t actor, std::uint32_t action,
                                       bool is_cut, std::uint64_t code) {
      if (found || is_cut || next != states_[to]) return;
      if (condition_.is_true(steps_.packed(), next, actor, action)) return;
      found = steps_.undo(next, code).step;
    });
    MAIDE_CHECK(found.has_value());
    return *found;
  }

  struct Way {
    std::uint32_t before = no_step;
    std::uint64_t code = 0;
  };

  PackedSteps<words> steps_;
  const Condition& condition_;
  const SearchLimits& limits_;
  bool starts_well_ = false;
  std::unordered_map<State, std::uint32_t, StateHash<words>> numbers_;
  std::vector<State> states_;
  std::vector<Way> ways_;     // by state: how it was met first
  std::vector<Reach> reach_;  // by state
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> first_;  // by state: its first edge, by where they lead
};

}  // namespace

AlwaysPossible search_always_possible(const System& system, const Property& property,
                                      const SearchLimits& limits) {
  const PackedSystem packed(system);
  const Condition condition(property.formula, system);
  return with_words(packed.words(), [&](auto words) {
    return PossibleSearch<words.value>(packed, condition, limits).run();
  });
}

}  // namespace maide
