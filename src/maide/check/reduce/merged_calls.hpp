// A reduction: an input and the output that answers it are one step, a call. A robot's program
// reads a message in two steps: it gives `read`, and takes `message`. What others do between the
// two mostly makes no difference, and then the states between need not be visited.
//
// Where nobody else can do anything with the model while the answer is due, giving and taking are
// as good as one step. Where the answer is not there at once, giving may be put off until it is, if
// that closes a diamond with all that others may do with the model in the meantime. Both are worked
// out from the model's automaton, for each kind of call of a program. Such steps are left and right
// movers (Lipton, "Reduction: a method of proving properties of parallel programs", CACM 1975);
// docs/design/reductions.md has the proof, and what fairness asks for besides.
// Calls of models that actions of nobody use stay two steps.
//
// Example: where one program alone reads a queue, its `q.read -> message` is one step. With a
// second reader it stays two: the other may give `read` while the message is due.
//
// The reduced system is a system again, which all searches and reductions take. Its traces are
// expanded to traces of the system itself.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "maide/check/reduce/reduction.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

class MergedCalls {
 public:
  // Keeps a reference. O(states x actions of others) for each kind of call.
  MergedCalls(const System& system, const CallRules& rules);

  // Some program gives an input and then only waits for its answer. O(edges).
  static bool has_calls(const System& system);
  // No call could be merged.
  bool is_empty() const { return groups_.empty(); }
  // With the same programs, models and control states; with other edges, and more actions of
  // models.
  const System& system() const { return merged_; }
  // A run of the system itself that shows what that run of the reduced system shows.
  Trace expand(const Trace& trace) const;

 private:
  static constexpr std::uint32_t none = ~std::uint32_t{0};

  // A kind of call: a program's input, and what may answer it.
  struct Group {
    ModelUse give;
    std::vector<ModelUse> answers;     // outputs, or that nothing is due
    std::vector<std::uint32_t> calls;  // by answer: the model's action of both; none: never at once
    std::uint32_t rest = none;         // the model's action of giving alone, where it is left
    std::vector<bool> is_due;          // by state: the answer is there, and only the caller can act
    bool is_put_off = false;           // the input waits until its answer is there
  };
  // What an edge of the reduced system stands for.
  struct Origin {
    std::uint32_t edge = 0;
    std::uint32_t taken = none;  // the edge by which the answer is taken
  };
  // What a program's steps do with a model.
  struct Use {
    std::vector<ModelUse> actions;
    bool is_alone = true;  // where one step uses the model, all steps use it, and no other model
  };

  void merge_calls_of(std::uint32_t program, const CallRules& rules);
  std::uint32_t find_group(std::uint32_t program, const ModelUse& give,
                           std::vector<ModelUse> answers, bool may_put_off, bool is_fair);
  std::uint32_t add_call(const ModelUse& give, const ModelUse& answer,
                         const std::vector<bool>& is_due);
  std::uint32_t add_rest(const Group& group);
  void find_uses(std::uint32_t program);
  std::vector<ModelUse> uses_of(std::uint32_t program, std::uint32_t edge) const;
  void rebuild(std::uint32_t program);
  void add_merged(std::uint32_t program, std::uint32_t edge, Program& merged);

  void expand(const Step& step, GlobalState& state, Trace& trace) const;
  void give_what_was_put_off(const std::vector<bool>& steps, GlobalState& state, Trace& trace,
                             std::vector<ModelUse>& given) const;

  const System& plain_;
  System merged_;
  std::vector<Group> groups_;
  std::vector<std::vector<std::uint32_t>> group_of_;  // by program, by its own edge
  std::vector<std::vector<Origin>> origins_;          // by program, by edge of the reduced system
  std::vector<std::map<std::uint32_t, Use>> uses_;    // by program, by model
  std::set<std::uint32_t> nobodys_models_;            // no call of these is merged
};

}  // namespace maide
