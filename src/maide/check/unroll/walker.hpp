// Places in a program, and how control goes from one to the next. A place is a stack of frames
// (block, index in it, rounds left), hash-consed, as in a continuation, with the values of the
// variables of the blocks around it. `settle` walks a place forward through everything that costs
// no step until it rests before a statement that steps, and collects the labels it passes. Control
// states are the resting places with their labels and values, so a label on a loop holds on the
// first round only.
// Invariant: settling ends. A loop whose body never steps is refused before; one that goes round
// without a step comes to the same place with the same values again, which is an error of the
// program, or passes max_rounds.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "maide/base/hash.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/unroll/evaluator.hpp"

namespace maide::program_syntax {

using FrameId = std::uint32_t;
constexpr FrameId no_frame = 0;  // nothing is left to do: the program ends

struct Frame {
  const Block* block = nullptr;
  std::uint32_t index = 0;   // of the next statement
  std::uint32_t rounds = 1;  // of the block, this one included
  std::uint32_t count = 1;   // of the rounds in all
  FrameId parent = no_frame;
  bool operator==(const Frame&) const = default;
};

struct FrameHash {
  std::size_t operator()(const Frame& frame) const {
    std::size_t hash = std::hash<const void*>{}(frame.block);
    for (const std::uint32_t part : {frame.index, frame.rounds, frame.count, frame.parent}) {
      hash = hash_mix(hash, part);
    }
    return hash;
  }
};

struct ValuesHash {
  std::size_t operator()(const Values& values) const {
    std::size_t hash = 0;
    for (const auto& value : values) {
      hash = hash_mix(hash, value ? static_cast<std::uint64_t>(*value) * 2 + 1 : 0);
    }
    return hash;
  }
};

class Walker : public Evaluator {
 public:
  // Keeps references.
  Walker(const Tree& tree, const Unrolled& program, ModelActions& actions, const Names& names,
         const RunControl& control);

 protected:
  enum class Phase : std::uint8_t {
    before,  // the statement
    awaits,  // its input was given
    writes,  // its value is known, and is written next
    calls,   // its input was given, and the call has not returned
    dies,    // it has ended its own process
    dead,    // its process has died, and may begin anew
    error,
  };
  // A resting place.
  struct Place {
    FrameId frame = no_frame;
    Phase phase = Phase::before;
    std::uint32_t label_set = 0;
    std::uint32_t valuation = 0;
    std::uint32_t error = 0;  // of Phase::error
    Value pending = 0;        // of Phase::writes
    auto operator<=>(const Place&) const = default;
  };
  struct PlaceHash {
    std::size_t operator()(const Place& place) const {
      std::size_t hash = hash_mix(0, std::size_t{place.frame} * 8 + static_cast<int>(place.phase));
      hash = hash_mix(hash_mix(hash, place.label_set), place.valuation);
      return hash_mix(hash_mix(hash, place.error), static_cast<std::uint64_t>(place.pending));
    }
  };
  using Loops = std::unordered_map<const Block*, const Statement*>;  // by body

  SourcePosition at(int line, int column) const { return {program_.position.file, line, column}; }
  // Comes to where the program begins. Throws ParseError: a loop would never step.
  void begin();
  // And notes which blocks are bodies of loops.
  void check_loops(const Block& block);

  // ---- frames -----------------------------------------------------------------------------------

  // `before`: the frame of the same block and round that it follows; none: it is the first.
  FrameId intern(const Frame& frame, FrameId before = no_frame);
  FrameId enter(const Block& block, FrameId parent) { return intern({&block, 0, 1, 1, parent}); }
  // The round of the innermost loop that a block's first frame is in.
  std::uint32_t make_round(const Frame& first);
  // The frame behind the statement of `id`; and the one that is there for the one behind.
  FrameId behind(FrameId id);
  FrameId before(FrameId id) const;
  const Statement& statement_at(FrameId id) const;
  void end_variables(const Block& block, Values& values) const;

  // ---- walking ----------------------------------------------------------------------------------

  std::uint32_t intern_values(const Values& values);
  // The control state in which a program rests that goes on at `id`; new ones are queued.
  ControlState settle(FrameId id, Values values);
  ControlState walk(FrameId id, Values& values);
  ParseError too_many_rounds(const Statement& statement) const;
  // The value that a `for` has come to; none of another block.
  std::optional<Value> counted_value(Loops::const_iterator loop, const Values& values) const;
  // Where control goes at the end of a loop's body. `counted`: what a `for` has come to.
  FrameId next_round(const Frame& frame, const Statement& loop, std::optional<Value> counted,
                     Values& values);
  // Where control goes from a statement that is no step; what it does to the variables.
  FrameId pass(FrameId id, const Statement& statement, Values& values);
  // The frame around it; its block's variables end.
  FrameId leave(FrameId id, Values& values) const;
  void assign(const Statement& statement, Value value, Values& values) const;
  FrameId enter_repeat(FrameId id, const Statement& statement, const Values& values);
  FrameId enter_for(FrameId id, const Statement& statement, Values& values);
  // Indices, arguments and what else is evaluated when control arrives. Throws EvaluationError.
  void check_arrival(const Statement& statement, const Values& values) const;
  void check_arm(const SelectArm& arm, const Values& values) const;
  std::uint32_t intern_labels(std::vector<std::uint32_t> labels);
  ControlState control_state(const Place& place);
  ControlState error_state(const std::string& text, int line, int column);
  // Where the value of an assignment is known: before its writing to a shared variable, or behind
  // that to one of the program's own.
  ControlState with_value(const Place& place, const Statement& statement, Value value,
                          Values values);
  // What an `any` chooses from; none: more than max_outcomes.
  std::optional<std::vector<Value>> choices_of(const Statement& statement,
                                               const Values& values) const;
  Error too_large(const Place& place) const;
  // Heeds the control, each time that so many steps were walked: less is no time.
  void look_sometimes() {
    constexpr std::size_t look_interval = 1 << 14;
    if (++walked_ % look_interval != 0) return;
    control_.check("the walk through program " + program_.name + ", which met " +
                   std::to_string(places_.size()) + " control states,");
  }
  // Where control goes from a condition of that value.
  ControlState behind_condition(const Place& place, const Statement& statement, Value value,
                                const Values& values);
  // Where control goes when the statement's input was given: it may await an output.
  ControlState behind_input(const Place& place, const Statement& statement, const Values& values);
  // Where control goes when the arm's output was taken.
  ControlState take(const Event& pattern, const Block& body, FrameId next,
                    const std::string& output, const Values& values);

  const Tree& tree_;
  const RunControl& control_;
  Program program_;
  std::vector<Frame> frames_;                // [no_frame] is not used
  std::vector<std::uint32_t> frame_rounds_;  // by frame: index into the program's rounds
  std::unordered_map<Frame, FrameId, FrameHash> frame_ids_;
  Loops loops_;
  std::map<std::vector<std::uint32_t>, std::uint32_t> label_set_ids_;
  std::map<std::tuple<int, int, std::string>, std::uint32_t> error_ids_;
  std::unordered_map<Values, std::uint32_t, ValuesHash> value_ids_;
  std::unordered_map<Place, ControlState, PlaceHash> control_states_;
  std::vector<Place> places_;  // by control state
  std::size_t walked_ = 0;
};

}  // namespace maide::program_syntax
