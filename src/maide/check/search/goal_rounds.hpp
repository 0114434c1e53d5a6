// Rounds of a breadth-first search for one kind of goal (rounds.hpp): how the steps of states are
// taken. This is the innermost loop, compiled for each goal and each size of states; all else of
// the search is compiled for each size alone.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "maide/base/invariant.hpp"
#include "maide/base/numbers.hpp"
#include "maide/check/packed/packed_steps.hpp"
#include "maide/check/packed/packed_system.hpp"
#include "maide/check/reduce/step_order.hpp"
#include "maide/check/reduce/stubborn_sets.hpp"
#include "maide/check/search/rounds.hpp"

namespace maide {

// A goal says what to look for, in the middle of the innermost loop, on all threads:
//   bool on_step(const PackedState& from, const PackedState& next, std::size_t program,
//                std::uint32_t edge, bool is_cut)      a step; true: the run up to it is wanted
//   bool on_end(const PackedState& state)              nothing can happen but deaths, and it is no
//                                                      error; true: the run is wanted
template <std::size_t words, typename Goal>
class GoalRounds final : public SearchRounds<words> {
 public:
  // Keeps a reference to `system`.
  GoalRounds(const PackedSystem& system, Goal goal, const BreadthFirstOptions& options)
      : Rounds(system, options),
        system_(system),
        steps_(system),
        goal_(std::move(goal)),
        options_(Rounds::options()) {}

 private:
  using Rounds = SearchRounds<words>;
  using State = typename Rounds::State;
  using Chain = typename Rounds::Chain;
  using Find = typename Rounds::Find;
  using Piece = typename Rounds::Piece;
  using Reduced = typename Rounds::Reduced;

  static constexpr std::size_t states_between_looks = 16;
  static constexpr std::uint64_t every_program = ~std::uint64_t{0};

  void expand_some(Piece& piece, const std::vector<Reduced>& postponed, std::size_t first,
                   std::size_t begin, std::size_t end) override {
    for (std::size_t i = begin; i < end; ++i) {
      if (options_.sets != nullptr && i % states_between_looks == 0 &&
          options_.control.should_stop()) {
        piece.is_cut_off = true;
        return;
      }
      if (i < postponed.size()) {
        // What was taken had a step that is progress.
        if (take_steps(piece, postponed[i].state, ~postponed[i].programs, false)) return;
        continue;
      }
      const std::size_t place = first + i - postponed.size();
      const State state = this->state_at(place);
      if (system_.is_error(state)) continue;
      if (options_.order != nullptr ? expand_in_order(piece, state, this->last_at(place))
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
      MAIDE_CHECK(piece.reduced.size() <= low_bits(Rounds::tag_bits));
      piece.tag = piece.first_tag + static_cast<std::uint32_t>(piece.reduced.size());
    }
    const bool is_found = take_steps(piece, state, programs);
    piece.tag = 0;
    return is_found;
  }

  // All steps, of which those that `last` leaves out are only counted. True if the goal is met.
  bool expand_in_order(Piece& piece, const State& state, const StepOrder::Last& last) {
    const StepOrder& order = *options_.order;
    bool is_end = true;
    for (std::size_t program = 0; program < steps_.actors(); ++program) {
      const auto is_left_out = [&](std::uint32_t edge) {
        return program < last.program && order.leaves_out(last, program, edge);
      };
      if (take_steps(piece, state, program, is_left_out, is_end)) return true;
    }
    return is_end && ends_at(piece, state);
  }

  // The steps of those actors. `is_end`: nothing else can happen. True if the goal is met.
  bool take_steps(Piece& piece, const State& state, std::uint64_t programs, bool is_end = true) {
    const auto is_left_out = [](std::uint32_t) { return false; };
    for (std::size_t program = 0; program < steps_.actors(); ++program) {
      if (program < most_actors_in_a_word && (programs >> program & 1) == 0) continue;
      if (take_steps(piece, state, program, is_left_out, is_end)) return true;
    }
    return is_end && ends_at(piece, state);
  }

  // The steps of an actor, but those of edges that are left out. True if the goal is met; where
  // there is a step that is progress, left out or not, is no end.
  template <typename IsLeftOut>
  bool take_steps(Piece& piece, const State& state, std::size_t program, IsLeftOut&& is_left_out,
                  bool& is_end) {
    bool is_found = false;
    steps_.for_each_of(state, program,
                       [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
                         is_end = is_end && !system_.is_progress(program, edge);
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
                           this->push(piece, next, code,
                                      options_.order->behind(system_, state, program, edge));
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

  // Passes by states that have one step alone, which is progress. True if the goal is met.
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
      steps_.for_each_of(
          state, program,
          [&](const State& next, std::uint32_t edge, bool is_cut, std::uint64_t code) {
            ++count;
            after = next;
            taken = edge;
            step_code = code;
            cuts = is_cut;
          });
      if (count != 1 || cuts || !system_.is_progress(program, taken)) break;
      MAIDE_CHECK(step_code <= low_bits(system_.code_bits()));
      ++piece.transitions;
      chain = {(chain.codes << system_.code_bits()) | step_code, chain.length + 1};
      if (goal_.on_step(state, after, program, taken, false)) {
        piece.find = Find{after, chain};
        return true;
      }
      state = after;
    }
    this->push(piece, state, payload_of(chain), piece.tag);
    return false;
  }

  std::uint64_t payload_of(const Chain& chain) const {
    if (options_.chain <= 1) return chain.codes;
    MAIDE_CHECK(chain.length <= options_.chain);
    MAIDE_CHECK(chain.codes <= low_bits(options_.chain * system_.code_bits()));
    return chain.codes | (std::uint64_t{chain.length} << (options_.chain * system_.code_bits()));
  }

  const PackedSystem& system_;
  PackedSteps<words> steps_;
  const Goal goal_;
  const BreadthFirstOptions& options_;
};

}  // namespace maide
