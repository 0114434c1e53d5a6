#include "maide/learn/table/table_learners.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {

ObservationTable::ObservationTable(OutputOracle& oracle, FirstSuffixes first) : oracle_(oracle) {
  if (oracle.inputs().empty()) throw UsageError("the system has no inputs to learn from");
  if (first == FirstSuffixes::inputs) {
    for (Symbol input = 0; input < oracle.inputs().size(); ++input) add_suffix({input});
  }
  rows_.emplace_back();
  make_short(0);
}

bool ObservationTable::add_suffix(const Word& suffix) {
  MAIDE_CHECK(!suffix.empty());
  if (!suffixes_.insert(suffix).second) return false;
  columns_.push_back({suffix, {}});
  short_by_cells_.clear();  // rows are compared by one cell more from now on
  return true;
}

void ObservationTable::add_short_rows(const Word& word) {
  RowId row = 0;
  for (const Symbol input : word) {
    row = extension(row, input);
    if (rows_[row].extensions == no_row) make_short(row);
    MAIDE_CHECK(rows_[row].prefix.back() == input);
  }
  short_by_cells_.clear();
}

std::optional<Word> ObservationTable::find_inconsistency() const {
  for (const RowId row : short_rows_) {
    const RowId equal = short_by_cells_.at(rows_[row].cells);
    MAIDE_CHECK(equal == row || rows_[equal].prefix != rows_[row].prefix);
    for (Symbol input = 0; equal != row && input < oracle_.inputs().size(); ++input) {
      const auto& left = rows_[extension(row, input)].cells;
      const auto& right = rows_[extension(equal, input)].cells;
      MAIDE_CHECK(left.size() == columns_.size() && right.size() == left.size());
      const auto difference = std::mismatch(left.begin(), left.end(), right.begin());
      if (difference.first == left.end()) continue;
      return joined({input}, columns_[difference.first - left.begin()].suffix);
    }
  }
  return std::nullopt;
}

void ObservationTable::make_short(RowId id) {
  MAIDE_CHECK(rows_[id].extensions == no_row);
  short_rows_.push_back(id);
  rows_[id].extensions = static_cast<RowId>(rows_.size());
  for (Symbol input = 0; input < oracle_.inputs().size(); ++input) {
    Row extension;
    extension.prefix = rows_[id].prefix;
    extension.prefix.push_back(input);
    rows_.push_back(std::move(extension));
  }
}

// Asks for every missing cell in one batch; for a row's output alone only if it has no cell to ask.
void ObservationTable::fill(const RunControl& control) {
  struct Cell {
    RowId row;
    std::size_t column;  // past the end: the output alone
  };
  std::vector<Cell> cells;
  std::vector<Query> batch;
  for (RowId id = 0; id < rows_.size(); ++id) {
    const Row& row = rows_[id];
    for (std::size_t column = row.cells.size(); column < columns_.size(); ++column) {
      Word word = row.prefix;
      const Word& suffix = columns_[column].suffix;
      word.insert(word.end(), suffix.begin(), suffix.end());
      batch.emplace_back(std::move(word));
      cells.push_back({id, column});
    }
    if (columns_.empty() && row.output == unknown_output && id != 0) {
      batch.emplace_back(row.prefix);
      cells.push_back({id, columns_.size()});
    }
  }
  if (batch.empty()) return;
  const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
  MAIDE_CHECK(answers.size() == cells.size());
  output_queries_ += answers.size();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Word& outputs = complete_outputs(answers[i], std::get<Word>(batch[i]));
    fill_row(rows_[cells[i].row], cells[i].column, outputs);
  }
}

void ObservationTable::fill_row(Row& row, std::size_t column, const Word& outputs) {
  if (!row.prefix.empty()) row.output = outputs[row.prefix.size() - 1];
  if (column == columns_.size()) return;
  auto& values = columns_[column].values;
  const Word value = tail(outputs, row.prefix.size());
  // Cells are filled in the order of their columns.
  MAIDE_CHECK(row.cells.size() == column && value.size() == columns_[column].suffix.size());
  const auto next = static_cast<std::uint32_t>(values.size());
  row.cells.push_back(values.try_emplace(value, next).first->second);
}

// Makes a short row of each long row from `first` on that equals no short one. All that are
// different move at once, so their extensions are filled in one batch.
bool ObservationTable::promote_new_rows(RowId first) {
  bool promoted = false;
  const RowId end = static_cast<RowId>(rows_.size());
  for (RowId row = first; row < end; ++row) {
    MAIDE_CHECK(rows_[row].cells.size() == columns_.size());
    if (rows_[row].extensions != no_row) continue;
    if (!short_by_cells_.try_emplace(rows_[row].cells, row).second) continue;
    make_short(row);
    promoted = true;
  }
  return promoted;
}

void ObservationTable::close(const RunControl& control) {
  RowId unseen = 0;  // rows before this one were compared with the short rows
  while (true) {
    control.check("learning");
    fill(control);
    if (short_by_cells_.empty()) {
      MAIDE_CHECK(unseen == 0);  // cleared between two calls only
      for (const RowId row : short_rows_) short_by_cells_.emplace(rows_[row].cells, row);
    }
    MAIDE_CHECK(!short_by_cells_.empty() && short_by_cells_.size() <= short_rows_.size());
    const RowId first = std::exchange(unseen, static_cast<RowId>(rows_.size()));
    if (!promote_new_rows(first)) return;
    Progress progress;
    progress.phase = "learning";
    progress.states = short_rows_.size();
    progress.words = output_queries_;
    control.report(progress);
  }
}

ObservationTable::Hypothesis ObservationTable::make_hypothesis() const {
  const std::size_t inputs = oracle_.inputs().size();
  Hypothesis result{Mealy(oracle_.inputs(), oracle_.outputs(), state_count()), {}};
  std::vector<RowId> order{0};  // the short row of each state
  std::unordered_map<RowId, StateId> state_of{{0, 0}};
  for (StateId state = 0; state < order.size(); ++state) {
    const RowId row = order[state];
    result.access.push_back(rows_[row].prefix);
    for (Symbol input = 0; input < inputs; ++input) {
      const Row& next = rows_[extension(row, input)];
      const RowId target = short_by_cells_.at(next.cells);
      const auto [entry, is_new] = state_of.try_emplace(target, static_cast<StateId>(order.size()));
      if (is_new) order.push_back(target);
      MAIDE_CHECK(next.output != unknown_output);
      result.machine.set_transition(state, input, next.output, entry->second);
    }
  }
  MAIDE_CHECK(order.size() == state_count());  // every state is reached
  return result;
}

void ObservationTable::check_invariants() const {
  const std::size_t inputs = oracle_.inputs().size();
  MAIDE_CHECK_ALWAYS(rows_.size() == 1 + short_rows_.size() * inputs);
  MAIDE_CHECK_ALWAYS(rows_[0].prefix.empty() && short_rows_.front() == 0);
  MAIDE_CHECK_ALWAYS(suffixes_.size() == columns_.size());
  for (const Column& column : columns_) MAIDE_CHECK_ALWAYS(suffixes_.contains(column.suffix));
  for (const RowId row : short_rows_) {
    for (Symbol input = 0; input < inputs; ++input) {
      MAIDE_CHECK_ALWAYS(rows_.at(extension(row, input)).prefix ==
                         joined(rows_[row].prefix, {input}));
    }
  }
  std::size_t short_rows = 0;
  for (const Row& row : rows_) {
    short_rows += row.extensions == no_row ? 0 : 1;
    MAIDE_CHECK_ALWAYS(row.cells.size() == columns_.size());
    MAIDE_CHECK_ALWAYS(row.output != unknown_output || row.prefix.empty());
    for (std::size_t column = 0; column < columns_.size(); ++column) {
      MAIDE_CHECK_ALWAYS(row.cells[column] < columns_[column].values.size());
    }
    MAIDE_CHECK_ALWAYS(short_by_cells_.contains(row.cells));  // closed
  }
  MAIDE_CHECK_ALWAYS(short_rows == short_rows_.size());
  for (const auto& [cells, row] : short_by_cells_) {
    MAIDE_CHECK_ALWAYS(rows_[row].cells == cells && rows_[row].extensions != no_row);
  }
}

std::size_t ObservationTable::longest_row_prefix(std::span<const Symbol> word) const {
  RowId row = 0;
  std::size_t length = 0;
  while (length < word.size() && rows_[row].extensions != no_row) {
    row = extension(row, word[length++]);
  }
  return length;
}

void TableLearner::start(const RunControl& control) {
  table_.close(control);
  hypothesis_ = table_.make_hypothesis();
}

void TableLearner::refine(const Word& counterexample, const RunControl& control) {
  ++counterexample_queries_;
  const Word outputs = oracle_.ask(counterexample, control);
  std::size_t length = first_mismatch(hypothesis(), counterexample, outputs);
  if (length == 0) {
    throw std::invalid_argument("the hypothesis agrees with the system on this word");
  }
  while (length != 0) {
    const Word cut(counterexample.begin(),
                   counterexample.begin() + static_cast<std::ptrdiff_t>(length));
    for (const Word& suffix : suffixes_of(cut, outputs[length - 1], control)) {
      table_.add_suffix(suffix);
    }
    table_.close(control);
    // Every counterexample shows a new state, unless the system answers now one way, now another.
    if (table_.state_count() == hypothesis().size()) {
      throw NondeterminismError(to_string(cut, oracle_.inputs()),
                                to_string(hypothesis().output_word(cut), oracle_.outputs()),
                                to_string(std::span(outputs).first(length), oracle_.outputs()));
    }
    MAIDE_CHECK(table_.state_count() > hypothesis().size());
    hypothesis_ = table_.make_hypothesis();
    length = first_mismatch(hypothesis(), counterexample, outputs);
  }
}

void TableLearner::check_invariants() const {
  table_.check_invariants();
  MAIDE_CHECK_ALWAYS(hypothesis().size() == table_.state_count());
  for (StateId state = 0; state < hypothesis().size(); ++state) {
    MAIDE_CHECK_ALWAYS(hypothesis().run(hypothesis_.access.at(state)) == state);
  }
}

std::uint64_t TableLearner::output_queries() const {
  return table_.output_queries() + counterexample_queries_;
}

// Rows do it, not suffixes: those that consistency needs are in the table when this returns.
std::vector<Word> LStar::suffixes_of(const Word& counterexample, Symbol /*last_output*/,
                                     const RunControl& control) {
  table_.add_short_rows(counterexample);
  table_.close(control);
  while (const std::optional<Word> suffix = table_.find_inconsistency()) {
    table_.add_suffix(*suffix);
    table_.close(control);
  }
  return {};
}

std::vector<Word> RivestSchapire::suffixes_of(const Word& counterexample, Symbol last_output,
                                              const RunControl& control) {
  const Decomposition split =
      decompose(hypothesis(), hypothesis_.access, counterexample, last_output, oracle_, control);
  counterexample_queries_ += split.output_queries;
  MAIDE_CHECK(split.position + 1 < counterexample.size() || counterexample.size() == 1);
  return {tail(counterexample, split.position + 1)};
}

// Adds them itself; nothing is left to add when it returns.
std::vector<Word> SuffixOneByOne::suffixes_of(const Word& counterexample, Symbol /*last_output*/,
                                              const RunControl& control) {
  table_.close(control);  // what an interruption left
  for (std::size_t start = counterexample.size(); start-- > 0;) {
    const Word suffix = tail(counterexample, start);
    if (!table_.add_suffix(suffix)) continue;
    table_.close(control);
    if (table_.state_count() != hypothesis().size()) break;
  }
  return {};
}

std::vector<Word> LmPlus::suffixes_of(const Word& counterexample, Symbol /*last_output*/,
                                      const RunControl& /*control*/) {
  std::vector<Word> suffixes;
  const std::size_t row = table_.longest_row_prefix(counterexample);
  for (std::size_t start = counterexample.size(); start > row; --start) {
    suffixes.emplace_back(counterexample.begin() + static_cast<std::ptrdiff_t>(start) - 1,
                          counterexample.end());
  }
  return suffixes;
}

}  // namespace maide
