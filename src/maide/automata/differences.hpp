// All independent differences of two models, and which states of the two belong together, so that
// both can be drawn as one machine.
//
// Both models are read as behaviours (automata/behaviour.hpp), whose states answer questions. Two
// states, one of each model, meet if some word leads to both. Behind a question that is answered
// differently both go on, each with its own answer, if that is one.
//
// Partners are pairs of states, one of each model, no state in two pairs:
//   1. states that no word tells apart;
//   2. the two initial states, if neither has a partner yet;
//   3. of the pairs that meet, the most alike first. An answer in common counts, and more if it
//      leads to states that are alike: the fixed point of Walkinshaw & Bogdanov's score ("Automated
//      comparison of state-based software models in terms of their language and structure", TOSEM
//      2013). Of pairs that are as much alike, the first on the shortest words comes first.
//
// A difference is a pair of states that meet, and a question that they answer differently.
// Independent are these:
//   - all differences of partners;
//   - where partners answer alike and go to two states that are no partners: the nearest difference
//     from there, on a way that meets no partners. Others behind it follow from the same change.
// A question that only one model knows is one difference, at the first place.
//
// What this does not say: that each difference is one change of somebody's program. The models
// differ exactly if there is a difference, and the first one has a shortest word of all.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "maide/automata/behaviour.hpp"
#include "maide/base/run_control.hpp"

namespace maide {

// One step of both machines, or of one of them while nothing comes out of the other.
struct JointStep {
  std::size_t question = 0;
  std::string left, right;                  // labels; "": this machine does nothing
  StateId left_state = 0, right_state = 0;  // behind the step
  bool agrees = true;
};

struct Difference {
  std::vector<JointStep> way;  // from the start to the two states
  StateId left_state = 0, right_state = 0;
  std::size_t question = 0;
  std::string left, right;  // texts of the two answers
  bool is_bound = false;    // one model knows what the other never tried: no contradiction

  // How many steps of the way differ themselves: other differences that it passes.
  std::size_t passed() const;
};

struct Differences {
  // By state: the partner, or Mealy::no_state.
  std::vector<StateId> left_partners, right_partners;
  // Contradictions first, then bounds; of each kind those that pass the fewest differences, and of
  // these the shortest first.
  std::vector<Difference> list;
  std::size_t pairs = 0;  // of states that meet, as far as they were looked at
  // False: so many pairs of states meet that not all were looked at.
  bool is_complete = true;

  std::size_t count_bounds() const;
};

// How many pairs of states are looked at, at most. Machines that have the most part in common have
// hardly more pairs than states. Those that fell out of step may have one for each two states, and
// what is told of these does not help. A million pairs are some 200 MB for ten inputs.
std::size_t most_pairs(const BehaviourPair& pair);

// The way by name: inputs of machines; "?a" and "!x" of automata, and "(!x / nothing)" where each
// of the two went on with an answer of its own.
std::vector<std::string> describe_way(const BehaviourPair& pair, const Difference& difference);

// O(pairs that meet x questions x ways), some 20 times. Throws Interrupted.
Differences find_differences(const BehaviourPair& pair, const RunControl& control = {});

}  // namespace maide
