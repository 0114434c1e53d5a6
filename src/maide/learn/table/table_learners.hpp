// The learners with an observation table: L*M, Rivest & Schapire's, Suffix1by1 and L*M+. They share
// `TableLearner`, and differ in the suffixes that they take from a counterexample.
#pragma once

#include <vector>

#include "maide/learn/learner.hpp"
#include "maide/learn/table/observation_table.hpp"

namespace maide {

// What they share. A counterexample costs one output query, which a cache that saw the equivalence
// test answers. It is handled until the hypothesis agrees with it.
class TableLearner : public Learner {
 public:
  void start(const RunControl& control = {}) override;
  void refine(const Word& counterexample, const RunControl& control = {}) override;
  const Mealy& hypothesis() const override { return hypothesis_.machine; }
  std::uint64_t output_queries() const override;
  void check_invariants() const override;

 protected:
  // Keeps a reference to `oracle`.
  TableLearner(OutputOracle& oracle, FirstSuffixes first)
      : oracle_(oracle), table_(oracle, first) {}

  // Suffixes that make the table unclosed. `counterexample` is cut at its first mismatch;
  // `last_output` is what the system answers to its last input.
  virtual std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                        const RunControl& control) = 0;

  OutputOracle& oracle_;
  ObservationTable table_;
  ObservationTable::Hypothesis hypothesis_;
  std::uint64_t counterexample_queries_ = 0;  // output queries to analyse counterexamples
};

// L*M, Angluin's L* for Mealy machines (Angluin, "Learning regular sets from queries and
// counterexamples", Information and Computation 75, 1987; Niese, PhD thesis, Dortmund 2003). The
// observation table begins with the single inputs as columns. All prefixes of a counterexample
// become short rows. Where two equal rows have different extensions, a suffix tells them apart.
//
// Invariant: E is suffix-closed, so the hypothesis agrees with a closed and consistent table. For n
// states, k inputs and counterexamples of length m: at most ((n + (n - 1) m) k + 1) (k + n - 1) + n
// output queries, at most n - 1 counterexamples.
class LStar : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit LStar(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::inputs) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

// Rivest & Schapire's learner ("Inference of finite automata using homing sequences", Information
// and Computation 103, 1993). Binary search finds the one suffix of the counterexample that splits
// a state, and only that suffix becomes a column. The table begins without columns.
//
// E is not suffix-closed, so a hypothesis may contradict its own table. The same counterexample is
// handled again until the hypothesis agrees with it. For n states, k inputs and counterexamples of
// length m: at most n k + (n k + 1) (n - 1) + (n - 1) (1 + ceil(log2 m)) output queries.
class RivestSchapire : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit RivestSchapire(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::none) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

// Suffix1by1 (Irfan, Oriat & Groz, "Angluin style finite state machine inference with non-optimal
// counterexamples", MIIT 2010). The observation table begins with the single inputs as columns. The
// suffixes of a counterexample become columns one at a time, the shortest first, and only until the
// table shows a new state. So a long counterexample costs no more than it must.
//
// Invariant: E is suffix-closed, so the hypothesis agrees with the table. The bounds are those of
// L*M+.
class SuffixOneByOne : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit SuffixOneByOne(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::inputs) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

// L*M+ (Shahbaz, PhD thesis, Grenoble 2008; Shahbaz & Groz, "Inferring Mealy Machines", FM 2009).
// The observation table begins with the single inputs as columns. A counterexample is cut into u v,
// where u is its longest prefix that is a row. All non-empty suffixes of v become columns.
//
// Invariant: E is suffix-closed, so the hypothesis agrees with the table, and no word is a
// counterexample twice. For n states, k inputs and counterexamples of length m: at most (n k + 1)
// (k + (n - 1) m) + n output queries, at most n - 1 counterexamples.
class LmPlus : public TableLearner {
 public:
  // Keeps a reference to `oracle`.
  explicit LmPlus(OutputOracle& oracle) : TableLearner(oracle, FirstSuffixes::inputs) {}

 private:
  std::vector<Word> suffixes_of(const Word& counterexample, Symbol last_output,
                                const RunControl& control) override;
};

}  // namespace maide
