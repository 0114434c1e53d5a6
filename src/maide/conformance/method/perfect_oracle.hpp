// The equivalence oracle that knows the answer: it compares the hypothesis with a reference
// machine, and sends nothing to the system. For simulated systems, tests and benchmarks.
// `IncrementalComparison` is how it compares: from one hypothesis to the next only what changed is
// looked at again.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"

namespace maide {

// Compares hypothesis after hypothesis with one reference machine, and does again only what changed
// from one to the next. The result is that of Hopcroft & Karp's comparison (automata/compare.hpp).
//
// Each reachable state of the reference has a least word (shortest, then alphabet-least); these
// words form a tree. The *twin* of a state is the state that the hypothesis reaches by that word. A
// state is a *mismatch* if its twin gives other outputs. An edge of the reference outside the tree
// is a *conflict* if it does not lead twins to twins. A hypothesis without mismatches and conflicts
// is right. All three are kept up to date: a transition that changes moves the twins below it.
//
// The least counterexample leads to the first mismatch, or leaves the tree by a conflict before
// that. So it is enough to search the pairs behind conflicts, breadth first and in the order of the
// words. Two states of the hypothesis are united where such a pair makes them one. A pair that is
// united already is passed by, because a lesser word shows the same (Hopcroft & Karp).
class IncrementalComparison {
 public:
  // Keeps a reference to `reference`, which must be complete.
  explicit IncrementalComparison(const Mealy& reference) : reference_(reference) {}

  // The shortest word, of these the least in the order of the hypothesis' inputs, on which
  // `hypothesis`, which must be complete, and the reference differ; nothing if they are equivalent.
  // Throws UsageError if the inputs differ. O(k (n + m)) for k inputs and n, m states; where states
  // keep their numbers from one hypothesis to the next, 8 n + k m / 8 bytes are looked at for what
  // changed (Mealy::revision), and the rest is as much as what changed concerns.
  std::optional<Word> find_difference(const Mealy& hypothesis);

 private:
  // A reachable state of the reference: its place in the order of the least words.
  using Spot = std::uint32_t;
  // spot x inputs + input
  using Edge = std::size_t;

  // Bits that are set one by one and found in order.
  class Bits {
   public:
    void assign(std::size_t size) { words_.assign(size / 64 + 1, 0); }
    bool get(std::size_t bit) const { return (words_[bit / 64] >> (bit % 64) & 1U) != 0; }
    void set(std::size_t bit, bool value) {
      const std::uint64_t mask = std::uint64_t{1} << (bit % 64);
      words_[bit / 64] = value ? words_[bit / 64] | mask : words_[bit / 64] & ~mask;
    }
    // The first set bit from `bit` on, or `end`.
    std::size_t next(std::size_t bit, std::size_t end) const;

   private:
    std::vector<std::uint64_t> words_;
  };

  // A pair of states behind a conflict.
  struct Pair {
    StateId state;  // of the hypothesis
    Spot spot;
    Spot position;  // of all spots at the same depth, the words of those from here on are greater
    std::size_t parent;  // place in the queue, or `from_tree`
    Edge last;           // the edge that led here: of the parent's spot
  };
  static constexpr std::size_t from_tree = ~std::size_t{0};

  void read_reference(const Alphabet& inputs);
  bool read_outputs(const Alphabet& outputs);
  void compare_anew(const Mealy& hypothesis);
  void update(const Mealy& hypothesis);
  void add_rows(const Mealy& hypothesis);
  void change_row(StateId state, std::span<const Mealy::Cell> row);
  void move_twins();
  void set_twin(Spot spot, StateId twin);
  void look_at(Spot spot);
  void look_at_edge(Edge edge);
  std::optional<Symbol> find_mismatch(StateId state, Spot spot) const;

  std::optional<Word> search();
  bool is_first_difference(const Word& word) const;
  std::optional<Word> expand(std::size_t place);
  void visit(StateId state, Spot spot, Spot position, std::size_t parent, Edge last);
  Word word_to(Spot spot) const;
  Word word_to_pair(std::size_t place) const;
  StateId find(StateId state);

  bool is_tree_edge(Edge edge) const {
    const Spot target = next_[edge];
    return target != 0 && entry_[target] == edge;
  }
  StateId target(StateId state, std::size_t input) const {
    return cells_[state * inputs_ + input].target;
  }

  const Mealy& reference_;
  // The reference, its inputs in the hypothesis' order.
  std::size_t inputs_ = 0;
  Alphabet input_names_;
  std::vector<Spot> next_;             // by edge
  std::vector<Symbol> output_;         // by edge; reference's symbols
  std::vector<Edge> entry_;            // by spot: the edge of the tree that leads there
  std::vector<Spot> first_below_;      // by spot: the first whose entry comes from there or later
  std::vector<std::size_t> incoming_;  // by spot: where its edges begin in incoming_edges_
  std::vector<Edge> incoming_edges_;   // edges that are not in the tree
  // The hypothesis as it was last.
  std::vector<Mealy::Cell> cells_;
  std::vector<std::uint64_t> revisions_;   // by state
  std::vector<std::string> output_names_;  // the hypothesis'
  std::vector<Symbol> output_map_;         // hypothesis' symbols -> reference's
  // Their relation.
  std::vector<StateId> twin_;                 // by spot
  std::vector<Spot> first_, after_, before_;  // lists of spots by twin; the first by state
  Bits moved_;                                // spots whose twin may have changed
  Bits mismatches_;                           // by spot
  Bits conflicts_;                            // by edge, not in the tree
  // Of one search.
  std::vector<Pair> queue_;
  std::vector<StateId> united_;   // by state: another one of its class, or itself
  std::vector<StateId> touched_;  // states for which that is another one
};

class PerfectOracle : public EquivalenceOracle {
 public:
  // Keeps a reference to `reference`, which must be complete.
  explicit PerfectOracle(const Mealy& reference) : comparison_(reference) {}

  // A shortest counterexample, alphabet-least. Throws UsageError if the inputs differ.
  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override;
  Strength strength() const override { return {.exact = is_equal_}; }

 private:
  IncrementalComparison comparison_;
  bool is_equal_ = false;  // by the last query
};

}  // namespace maide
