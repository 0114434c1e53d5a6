// L# (Vaandrager, Garhewal, Rot & Wissmann, "A New Approach for Active Automata Learning Based on
// Apartness", TACAS 2022): everything that was asked is kept in an observation tree, and states are
// told apart by what the tree shows, so nothing is asked twice. Its rules, in this order:
//
//   promote   a frontier node that is apart from all of the basis is a new state
//   extend    an input that was not asked in a state of the basis is asked there
//   separate  a frontier node with several candidates is asked a word that two of them differ on
//   conclude  every frontier node has one candidate: that is the hypothesis
//
// A hypothesis that contradicts the tree is refined by that word without an equivalence query. A
// counterexample is shortened by binary search until it leaves a frontier node without a candidate.
//
// `lsharp` extends and separates by adaptive distinguishing sequences, those of the states that are
// likely first (target_prior.hpp), and the newest states first, because they show more new ones;
// `lsharp-sepseq` extends by the input alone and separates by a shortest word. Both ask in small
// batches.
//
// Invariant: the basis is pairwise apart and prefix-closed, so it has at most n states; every
// separating query removes a candidate, every counterexample adds a state. For n states, k inputs
// and counterexamples of length m at most k n^2 + (n - 1) (3 + log2(m + n)) output queries.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "maide/learn/apartness.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/output_oracle.hpp"
#include "maide/learn/target_prior.hpp"

namespace maide {

// How L# tells states apart.
enum class Separation : std::uint8_t { adaptive, separating_words };

class LSharp : public Learner {
 public:
  // Keeps a reference to `oracle`. Throws UsageError if it has no inputs.
  explicit LSharp(OutputOracle& oracle, Separation separation = Separation::adaptive);

  void start(const RunControl& control = {}) override { complete(control); }
  void refine(const Word& counterexample, const RunControl& control = {}) override;
  const Mealy& hypothesis() const override { return hypothesis_; }
  std::uint64_t output_queries() const override { return output_queries_; }

 private:
  using Node = ObservationTree::Node;
  using Transition = Apartness::Transition;

  void complete(const RunControl& control);
  bool extend(const RunControl& control);
  bool separate(const RunControl& control);
  Query extension(Transition transition);
  Query separation(Transition transition);
  DecisionTree identify(Transition transition, Symbol output,
                        const std::vector<StateId>& candidates);
  DecisionTree path_to(Transition transition) const;
  const TargetPrior& prior();

  void ask(const std::vector<Query>& batch, const RunControl& control);
  Symbol last_output(const Word& word, const RunControl& control);

  void make_hypothesis();
  std::optional<Word> find_conflict() const;
  void analyse(Word counterexample, const RunControl& control);
  std::vector<StateId> states_along(const Word& word) const;

  OutputOracle& oracle_;
  Separation separation_;
  Apartness apartness_;
  Mealy hypothesis_;
  std::vector<StateId> basis_state_;  // of each state of the hypothesis
  std::vector<StateId> unasked_;      // states that may lack inputs, the newest last
  StateId extended_ = 0;              // states from here on were not put there yet
  std::optional<TargetPrior> prior_;
  std::uint64_t prior_expires_ = 0;  // at this number of output queries
  std::uint64_t output_queries_ = 0;
};

}  // namespace maide
