// The learners with an observation table: L*M, Rivest & Schapire's, Suffix1by1 and L*M+. They share
// `TableLearner`, and differ in the suffixes that they take from a counterexample.
//
// Example: the words `` and `b` are two states if the suffix `a` is answered 0 behind one and 1
// behind the other. If all suffixes of the table are answered alike behind both, they are one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

// The observation table (S, E, T) of L* for Mealy machines (Angluin 1987; Shahbaz & Groz,
// "Inferring Mealy Machines", FM 2009). Short rows S: access words, prefix-closed. Long rows: their
// extensions by one input, each with the output of that input. Columns E: distinguishing suffixes.
// A cell T holds the outputs along its suffix.
//
// Invariants: every short row has all its extensions. No two short rows are equal, unless
// add_short_rows made them. Closed: every long row equals a short one. Consistent: extensions of
// equal short rows are equal. Query cost: one output query a cell, (|S| k + 1) |E| in all. Without
// columns, one query for each row. Each filling round is one batch.

// The columns that a table begins with.
enum class FirstSuffixes : std::uint8_t {
  none,    // states are told apart by what counterexamples show: fewer output queries
  inputs,  // each single input: fewer equivalence queries
};

class ObservationTable {
 public:
  // The empty word as only short row; nothing is asked yet. Keeps a reference to `oracle`. Throws
  // UsageError if it has no inputs.
  ObservationTable(OutputOracle& oracle, FirstSuffixes first);

  // Adds a non-empty suffix; false if it is there already.
  bool add_suffix(const Word& suffix);

  // Makes short rows of all prefixes of `word`, though they may equal others. Close the table then,
  // and add what find_inconsistency() says.
  void add_short_rows(const Word& word);

  // A suffix, not there yet, that tells two equal short rows apart; nothing if there is none. The
  // table must be closed. O(rows x suffixes).
  std::optional<Word> find_inconsistency() const;

  // Fills the table and moves long rows up until it is closed. Throws what the oracle throws; the
  // table then keeps what was answered in the rounds before and can be closed later.
  void close(const RunControl& control);

  // The machine of a closed table, and each state's access word. States are numbered in the order
  // of a breadth-first search. O(rows x suffixes).
  struct Hypothesis {
    Mealy machine;
    std::vector<Word> access;
  };
  Hypothesis make_hypothesis() const;

  // Different short rows of a closed table.
  std::size_t state_count() const { return short_by_cells_.size(); }
  // Length of the longest prefix of `word` that is a row, short or long.
  std::size_t longest_row_prefix(std::span<const Symbol> word) const;
  std::uint64_t output_queries() const { return output_queries_; }

  // Throws std::logic_error unless the table, which is closed, has the rows, columns and cells that
  // the head of this file says. O(rows x suffixes).
  void check_invariants() const;

 private:
  using RowId = std::uint32_t;
  static constexpr RowId no_row = ~RowId{0};
  static constexpr Symbol unknown_output = ~Symbol{0};
  struct Row {
    Word prefix;
    std::vector<std::uint32_t> cells;  // one value for each suffix; fewer while not filled
    Symbol output = unknown_output;    // of the prefix' last input
    RowId extensions = no_row;         // first of its k extensions; none: this is a long row
  };
  // A suffix, and the different outputs seen along it, numbered; cells hold their numbers.
  struct Column {
    Word suffix;
    std::unordered_map<Word, std::uint32_t, WordHash> values;
  };

  void fill(const RunControl& control);
  void fill_row(Row& row, std::size_t column, const Word& outputs);
  bool promote_new_rows(RowId first);
  void make_short(RowId id);
  // The first extension of each row lies where `extensions` says.
  RowId extension(RowId row, Symbol input) const { return rows_[row].extensions + input; }

  OutputOracle& oracle_;
  std::vector<Row> rows_;  // row 0 is the empty word's
  std::vector<RowId> short_rows_;
  std::vector<Column> columns_;
  std::unordered_set<Word, WordHash> suffixes_;
  // Short rows by their cells (numbers like symbols, so WordHash serves).
  std::unordered_map<Word, RowId, WordHash> short_by_cells_;
  std::uint64_t output_queries_ = 0;
};

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
