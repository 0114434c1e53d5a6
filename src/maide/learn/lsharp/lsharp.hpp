// L# (Vaandrager, Garhewal, Rot & Wissmann, "A New Approach for Active Automata Learning Based on
// Apartness", TACAS 2022). Everything that was asked is kept in an observation tree, and the tree
// tells states apart, so nothing is asked twice. The rules, in this order:
//
//   promote   a frontier node that is apart from all of the basis is a new state
//   extend    an input that was not asked in a state of the basis is asked there
//   separate  a frontier node with several candidates is asked a word that two of them differ on
//   conclude  every frontier node has one candidate: that is the hypothesis
//
// Example: `a` is answered 0 at the start, and 1 behind `b`. So the node behind `b` is promoted. If
// it is answered 0 behind `b`, too, the start is a candidate there, and no state is new.
//
// A hypothesis that contradicts the tree is refined by that word, without an equivalence query. A
// counterexample is shortened by binary search until it leaves a frontier node without a candidate.
//
// `lsharp` extends and separates by adaptive distinguishing sequences. Those of the likely states
// come first (TargetEstimate), and the newest states, because they show more new ones.
// `lsharp-sepseq` extends by the input alone and separates by a shortest word. Both ask in small
// batches. While the basis is small, what is likely is counted for each transition by itself, which
// asks least. From a larger basis on, transitions with the same candidates share a plan, and those
// not asked yet share another one; otherwise planning would take by far the most time.
//
// Adaptive learning starts from a model of an earlier version (Kruger, Junges & Rot, "State
// Matching and Multiple References in Adaptive Active Automata Learning", FM 2024). Each state of
// the basis is matched with one of the old model (old_model.hpp), which says what to ask:
//
//   rebuild   an input that leads, says the old model, to a state that the basis lacks is asked
//             before others, followed by what identifies that state there
//   doubt     a frontier node whose candidate is not what the old model says is asked, as the
//             candidate is, the word that tells the two old states apart
//
// States where the old model sees them are likely. Words that show all states and transitions of
// the old model, such as the tests that will follow, may be asked first: if the model is right,
// they are the whole observation tree, and the first hypothesis is the machine. Rebuilding replaces
// queries that L# asks anyhow. Doubts that find nothing are given up after some, so a model that
// fits nowhere costs no more than a few queries.
//
// Invariant: the basis is pairwise apart and prefix-closed, so it has at most n states; every
// separating query removes a candidate, every counterexample adds a state. For n states, k inputs
// and counterexamples of length m at most k n^2 + (n - 1) (3 + log2(m + n)) output queries.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "maide/learn/learner.hpp"
#include "maide/learn/lsharp/adaptive_experiment.hpp"
#include "maide/learn/lsharp/apartness.hpp"
#include "maide/learn/lsharp/frontier_hypothesis.hpp"
#include "maide/learn/lsharp/old_model.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

// Guesses where a transition leads, before it is known. Most inputs of a protocol lead back to
// where they were given, or to the same few states, and an output often tells which. L# asks for
// what is probable first (adaptive_experiment.hpp). A wrong guess costs symbols, never the result.
class TargetEstimate {
 public:
  // Counts the transitions whose targets are known. Keeps nothing of `apartness`. O(transitions).
  explicit TargetEstimate(const Apartness& apartness);

  // Some known transition has this input and output.
  bool has_seen(Symbol input, Symbol output) const;

  // For each of `states` states, among which may be some that were found since, a weight,
  // proportional to the probability that `input`, answered by `output`, leads there from `source`.
  // O(states).
  std::vector<double> weights(std::size_t states, StateId source, Symbol input,
                              Symbol output) const;
  // The same for a transition of which nothing is known. O(1).
  double weight(StateId state) const {
    return 1 + (state < states_ ? same_nothing * visits_[state] : 0);
  }

 private:
  // How much a known transition tells about another: much if it has the same input and output,
  // little if only one of them is the same. Set once, by the sum over the models of bench_learn.
  static constexpr double same_both = 5;
  static constexpr double same_output = 0.5;
  static constexpr double same_input = 1.5;
  static constexpr double same_nothing = 0.15;
  static constexpr double loop = 2;  // times as much if it leads back

  struct Seen {
    Symbol output;
    StateId target;
    bool is_loop;
  };
  struct Counts {
    std::vector<double> targets;  // by state: transitions that lead there from another one
    double loops = 0;             // transitions that lead back
  };

  std::size_t states_;
  std::vector<std::vector<Seen>> by_input_;
  std::map<Symbol, Counts> by_output_;
  std::vector<double> visits_;  // by state: transitions that lead there
};

// How L# tells states apart.
enum class Separation : std::uint8_t { adaptive, separating_words };

class LSharp : public Learner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit LSharp(OutputOracle& oracle, Separation separation = Separation::adaptive);
  // The same, starting from a model of an earlier version; its inputs go by name. `first_words` are
  // asked before anything else, for as long as the old model is right about them. It must have all
  // of their inputs, and none may be a prefix of another.
  LSharp(OutputOracle& oracle, const Mealy& old_model, Separation separation,
         const RunControl& control, std::span<const Word> first_words = {});

  void start(const RunControl& control = {}) override;
  void refine(const Word& counterexample, const RunControl& control = {}) override;
  const Mealy& hypothesis() const override { return hypothesis_.machine(); }
  std::uint64_t output_queries() const override { return output_queries_; }
  void check_invariants() const override;
  // What was found out: basis, frontier and observation tree.
  const Apartness& knowledge() const { return apartness_; }

 private:
  using Node = ObservationTree::Node;
  using Transition = Apartness::Transition;

  // Queries asked at once. More would help more systems at a time; each is chosen without the
  // answers to the others, which costs some.
  static constexpr std::size_t batch_size = 4;
  // Where very many are open, a part of them at once: plans do not get better by each answer.
  static constexpr std::size_t largest_batch = 1024;

  // States up to which every transition has a plan of its own.
  static constexpr std::size_t most_planned_apart = 64;
  // Inputs of a plan that is shared, if they tell some apart: every query carries it.
  static constexpr std::size_t largest_plan = 256;
  static constexpr std::size_t most_plans = 1 << 14;  // kept

  void complete(const RunControl& control);
  bool extend(const RunControl& control);
  bool separate(const RunControl& control);
  Query extension(Transition transition);
  Query separation(Transition transition);
  DecisionTree identify(Transition transition, Symbol output,
                        const std::vector<StateId>& candidates);
  const DecisionTree& common_plan();
  const DecisionTree& shared_plan(const std::vector<StateId>& candidates);
  bool is_large() const { return apartness_.size() > most_planned_apart; }
  DecisionTree path_to(Transition transition) const;
  const TargetEstimate& estimate();

  // With an old model.
  void verify(const RunControl& control);
  bool is_old_output(const Word& word) const;
  bool rebuild(const RunControl& control);
  bool doubt(const RunControl& control);
  void weigh_expected(Transition transition, Symbol output, std::vector<double>& weights) const;

  void ask(const std::vector<Query>& batch, const RunControl& control);
  Symbol last_output(const Word& word, const RunControl& control);

  void analyse(Word counterexample, const RunControl& control);

  OutputOracle& oracle_;
  Separation separation_;
  Apartness apartness_;
  FrontierHypothesis hypothesis_;
  std::vector<StateId> unasked_;  // states that may lack inputs, the newest last
  StateId extended_ = 0;          // states from here on were not put there yet
  std::optional<TargetEstimate> estimate_;
  std::uint64_t estimate_expires_ = 0;  // at this number of output queries
  std::optional<DecisionTree> common_plan_;
  std::unordered_map<std::vector<StateId>, DecisionTree, WordHash> plans_;  // by candidates
  KnownWitnesses witnesses_;
  std::uint64_t output_queries_ = 0;

  std::optional<StateMatching> matching_;  // if there is an old model
  std::vector<Word> first_words_;          // those that verify() has yet to ask, the next one last
  std::size_t rebuilt_ = 0;                // states of the basis when rebuild() had nothing to do
  std::int64_t doubts_left_ = 8;           // as many more may find nothing
};

}  // namespace maide
