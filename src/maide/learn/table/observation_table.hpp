// The observation table (S, E, T) of L* for Mealy machines (Angluin 1987; Shahbaz & Groz,
// "Inferring Mealy Machines", FM 2009). Short rows S: access words, prefix-closed. Long rows: their
// extensions by one input, each with the output of that input. Columns E: distinguishing suffixes.
// A cell T holds the outputs along its suffix.
//
// Invariants: every short row has all its extensions; no two short rows are equal, unless
// Invariants: every short row has all its extensions. No two short rows are equal, unless
// add_short_rows made them. Closed: every long row equals a short one. Consistent: extensions of
// equal short rows are equal. Query cost: one output query a cell, (|S| k + 1) |E| in all. Without
// columns, one query for each row. Each filling round is one batch.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

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

}  // namespace maide
