// Time-outs that hide a program that waits in vain. Without its time-out such a program would be
// stuck, or in a deadlock. A select that is `idle` may wait in vain.
//
// The reachable states are searched once, by Tarjan's components (Tarjan, "Depth-first search and
// linear graph algorithms", SIAM J. Comput. 1972), path-based. A component knows which arms can be
// taken in it and behind it. Beyond what was learned any arm may come. O(states + steps); nothing
// is searched where no select has a time-out.
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <map>
#include <new>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/check/packed/packed_steps.hpp"
#include "maide/check/packed/state_table.hpp"
#include "maide/check/verdict/assumptions.hpp"

namespace maide {
namespace {

using Role = CombinedStep::Role;

constexpr std::size_t most_selects = 64;  // of one search: bits of a word
constexpr unsigned number_bits = 32;      // of a state, in the table

bool is_arm(const Program& program, const ProgramEdge& edge) {
  return program.role_of(edge) != Role::timeout && program.is_progress(edge);
}

// The selects that are looked at, and where programs stand at them.
struct Selects {
  std::vector<LoneTimeOut> all;
  std::vector<std::vector<std::uint32_t>> at;  // by program, by control state; or `none`
  static constexpr std::uint32_t none = ~std::uint32_t{0};
};

Selects find_selects(const System& system) {
  Selects selects;
  for (std::uint32_t index = 0; index < system.programs.size(); ++index) {
    const Program& program = system.programs[index];
    std::map<std::pair<int, int>, std::uint32_t> known;  // by the place of the time-out
    auto& at = selects.at.emplace_back(program.states.size(), Selects::none);
    for (ControlState state = 0; state < program.states.size(); ++state) {
      const auto edges = program.edges_of(state);
      const auto time_out = std::ranges::find_if(
          edges, [&](const ProgramEdge& edge) { return program.role_of(edge) == Role::timeout; });
      if (time_out == edges.end() || program.may_rest(state)) continue;
      const auto [place, is_new] = known.try_emplace(
          {time_out->line, time_out->column}, static_cast<std::uint32_t>(selects.all.size()));
      if (is_new) selects.all.push_back({index, {}});
      at[state] = place->second;
      std::vector<ProgramEdge> arms;
      std::ranges::copy_if(edges, std::back_inserter(arms),
                           [&](const ProgramEdge& edge) { return is_arm(program, edge); });
      LoneTimeOut& select = selects.all[place->second];
      if (arms.size() > select.arms.size()) select.arms = std::move(arms);
    }
  }
  return selects;
}

// One search, for the selects number `first` to `first` + 63.
template <std::size_t words>
class LoneSearch {
 public:
  LoneSearch(const PackedSystem& system, const Selects& selects, std::size_t first,
             const SearchLimits& limits)
      : system_(system),
        steps_(system),
        selects_(selects),
        first_(first),
        limits_(limits),
        table_(system.address_bits(), number_bits, std::min(words, system.words())) {}

  // The bits of what was found; false if the limits ended it.
  bool run(std::uint64_t& lone) {
    enter(steps_.initial());
    while (!path_.empty()) {
      if (size() % limit_interval == 0 && !may_go_on(limits_, size(), bytes(), bytes(), result_)) {
        return false;
      }
      if (path_.back().open == 0) {
        leave();
        continue;
      }
      const State next = open_.back();
      open_.pop_back();
      --path_.back().open;
      enter(next);
    }
    lone = lone_;
    return true;
  }

 private:
  using State = PackedState<words>;
  using Number = std::uint32_t;
  // A state on the path, and how many of open_, from its end, are its successors.
  struct Frame {
    Number number = 0;
    std::size_t open = 0;
  };
  // A component that is not complete: its states are those of active_ from `first_active` on.
  struct Root {
    Number number = 0;
    std::size_t first_active = 0;
    std::uint64_t arms = 0, time_outs = 0;  // that can be taken: there or behind it; there
  };

  std::size_t size() const { return arms_behind_.size(); }
  std::uint64_t bytes() const {
    return table_.bytes() + arms_behind_.capacity() * sizeof(std::uint64_t) +
           open_.capacity() * sizeof(State) + path_.capacity() * sizeof(Frame) +
           (active_.capacity() + is_complete_.capacity() / 8) * sizeof(Number);
  }

  void enter(const State& state) {
    const auto number = static_cast<Number>(size());
    const auto insertion = table_.insert(state, number);
    if (!insertion.is_new) return meet(static_cast<Number>(insertion.payload));
    arms_behind_.push_back(0);
    is_complete_.push_back(false);
    roots_.push_back({number, active_.size(), 0, 0});
    active_.push_back(number);
    const std::size_t before = open_.size();
    if (!system_.is_error(state)) expand(state);
    path_.push_back({number, open_.size() - before});
  }

  void expand(const State& state) {
    Root& root = roots_.back();
    for (std::size_t part = system_.program_count(); part < system_.actor_count(); ++part) {
      steps_.for_each_of(state, part,
                         [&](const State& next, std::uint32_t, bool is_cut, std::uint64_t) {
                           if (is_cut) root.arms = ~std::uint64_t{0};
                           if (!is_cut) open_.push_back(next);
                         });
    }
    for (std::size_t index = 0; index < system_.program_count(); ++index) {
      const Program& program = system_.system().programs[index];
      const std::uint32_t select = selects_.at[index][system_.control(state, index)];
      const bool is_looked_at = select >= first_ && select - first_ < most_selects;
      const std::uint64_t bit = is_looked_at ? std::uint64_t{1} << (select - first_) : 0;
      steps_.for_each_of(state, index,
                         [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t) {
                           const bool is_other = bit != 0 && is_arm(program, program.edges[edge]);
                           if (is_cut) root.arms = ~std::uint64_t{0};
                           if (bit != 0 && program.is_progress(program.edges[edge])) {
                             (is_other ? root.arms : root.time_outs) |= bit;
                           }
                           if (!is_cut) open_.push_back(next);
                         });
    }
  }

  // A step to a state that is known: it closes a cycle, or leads into a component that is complete.
  void meet(Number known) {
    if (is_complete_[known]) {
      roots_.back().arms |= arms_behind_[known];
      return;
    }
    while (roots_.back().number > known) {
      const Root inner = roots_.back();
      roots_.pop_back();
      roots_.back().arms |= inner.arms;
      roots_.back().time_outs |= inner.time_outs;
    }
  }

  void leave() {
    const Number number = path_.back().number;
    path_.pop_back();
    const Root root = roots_.back();
    MAIDE_CHECK(root.number <= number);
    if (root.number != number) return;
    roots_.pop_back();
    for (std::size_t i = root.first_active; i < active_.size(); ++i) {
      is_complete_[active_[i]] = true;
      arms_behind_[active_[i]] = root.arms;
    }
    active_.resize(root.first_active);
    lone_ |= root.time_outs & ~root.arms;
    if (!roots_.empty()) roots_.back().arms |= root.arms;
  }

  const PackedSystem& system_;
  PackedSteps<words> steps_;
  const Selects& selects_;
  std::size_t first_;
  const SearchLimits& limits_;
  StateTable<words> table_;                 // states' numbers
  std::vector<std::uint64_t> arms_behind_;  // by state of a complete component
  std::vector<bool> is_complete_;           // by state
  std::vector<Frame> path_;
  std::vector<State> open_;
  std::vector<Root> roots_;
  std::vector<Number> active_;
  std::uint64_t lone_ = 0;
  SearchResult result_;
};

}  // namespace

bool has_time_outs(const System& system) {
  return std::ranges::any_of(system.programs, [](const Program& program) {
    return std::ranges::any_of(program.combined, [](const CombinedStep& combined) {
      return combined.role == Role::timeout;
    });
  });
}

std::vector<LoneTimeOut> find_lone_time_outs(const System& system, const SearchLimits& limits) {
  if (!has_time_outs(system)) return {};
  const Selects selects = find_selects(system);
  if (selects.all.empty()) return {};
  const PackedSystem packed(system, number_bits);
  std::vector<LoneTimeOut> found;
  for (std::size_t first = 0; first < selects.all.size(); first += most_selects) {
    std::uint64_t lone = 0;
    const bool is_complete = with_words(packed.words(), [&](auto words) {
      try {
        return LoneSearch<words.value>(packed, selects, first, limits).run(lone);
      } catch (const std::bad_alloc&) {
        return false;
      }
    });
    if (!is_complete) return {};
    for (std::size_t i = 0; i < most_selects; ++i) {
      const bool is_lone = (lone >> i & 1) != 0;
      // A select without other arms is a pause.
      if (is_lone && !selects.all[first + i].arms.empty()) found.push_back(selects.all[first + i]);
    }
  }
  return found;
}

}  // namespace maide
