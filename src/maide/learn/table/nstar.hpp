// Learns observable nondeterministic Mealy machines, in the way of L* for them. A trace stands for
// a state. A cell of the table is the set of all answers to a suffix behind the trace. (El-Fakih,
// Groz, Irfan, Shahbaz, ICTSS 2010; Pacharoen, Aoki, Bhateja, Surarerks, "Active learning of
// nondeterministic finite state machines", Mathematical Problems in Engineering 2013. The problem
// is that of Khalili & Tacchella's N*, "Learning nondeterministic Mealy machines", ICGI 2014; the
// details are not theirs.)
//
// Answers are sampled (trace_samples.hpp), so a set may lack some. Two traces are therefore apart
// only by evidence: along a suffix of the table, one shows an answer that the other did not show
// though it was asked often enough.
//
// Example: behind one trace `a` was answered 0 and 1, behind another one 0 alone. They are apart if
// `a` was asked 44 times behind the second (at 0.99), and not if it was asked once.
//
// Invariants: the traces of the basis are pairwise apart, hold the empty one, and lie in one piece.
// When new answers undo an evidence, the basis is built again from what is known. Suffixes are
// added one at a time, the shortest of a counterexample first, so the set of suffixes is
// suffix-closed (Irfan, Oriat & Groz, "Angluin style finite state machine inference with
// non-optimal counterexamples", MIIT 2010).
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/learn/passive/trace_samples.hpp"

namespace maide {

class NStar {
 public:
  // Keeps a reference to `samples`. Throws UsageError if there are no inputs.
  explicit NStar(TraceSamples& samples);

  // Makes the first hypothesis. Once, before anything else.
  void start(const RunControl& control = {});
  // Makes a hypothesis of what is known, and asks nothing: for a run that ends before the first. It
  // lacks what was never tried, and takes states for one that were not told apart yet.
  void make_draft();
  // Refines the hypothesis until it agrees with all samples. Throws Error (inconclusive) where a
  // trace is too rare to be told from others.
  void refine(const RunControl& control = {});

  // States in breadth-first order.
  const NondeterministicMealy& hypothesis() const { return hypothesis_; }
  // For each state and each of its transitions, the inputs of a trace that leads through it.
  std::vector<Word> transition_cover() const;

  // A shortest word along which the samples show what the hypothesis does not allow, or lack what
  // it does allow where they are complete. O(samples).
  std::optional<Word> find_mismatch() const;

 private:
  using Node = TraceSamples::Node;
  struct Mismatch {
    Node node;     // behind this trace ...
    Symbol input;  // ... this input
  };
  std::optional<Mismatch> locate_mismatch() const;
  bool are_apart(Node left, Node right, std::span<const Symbol> suffix) const;
  bool are_apart(Node left, Node right) const;
  // The first trace of the basis that is not apart from `node`, or none.
  std::size_t find_equal(Node node) const;
  std::vector<Node> frontier() const;
  void sample_table(const RunControl& control);
  bool extend_basis();
  bool is_basis_apart() const;
  void close(const RunControl& control);
  void make_hypothesis();
  bool add_next_suffix(const Mismatch& mismatch);

  TraceSamples& samples_;
  std::vector<Node> basis_{TraceSamples::root};
  std::vector<Word> suffixes_;
  std::set<Word> suffix_set_;
  NondeterministicMealy hypothesis_;
};

}  // namespace maide
