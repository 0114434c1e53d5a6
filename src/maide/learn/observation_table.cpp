#include "maide/learn/observation_table.hpp"

#include <utility>

#include "maide/base/error.hpp"

namespace maide {

ObservationTable::ObservationTable(OutputOracle& oracle) : oracle_(oracle) {
  if (oracle.inputs().empty()) throw UsageError("the system has no inputs to learn from");
  for (Symbol input = 0; input < oracle.inputs().size(); ++input) add_suffix({input});
  rows_.emplace_back();
  make_short(0);
}

bool ObservationTable::add_suffix(const Word& suffix) {
  if (!suffixes_.insert(suffix).second) return false;
  columns_.push_back({suffix, {}, {}});
  short_by_cells_.clear();  // rows are compared by one cell more from now on
  return true;
}

void ObservationTable::make_short(RowId row) {
  short_rows_.push_back(row);
  const RowId first = static_cast<RowId>(rows_.size());
  rows_[row].extensions = first;
  for (Symbol input = 0; input < oracle_.inputs().size(); ++input) {
    Word prefix = rows_[row].prefix;
    prefix.push_back(input);
    rows_.push_back({std::move(prefix), {}, no_row});
  }
}

// Asks for every missing cell in one batch.
void ObservationTable::fill(const RunControl& control) {
  std::vector<Query> batch;
  for (const Row& row : rows_) {
    for (std::size_t column = row.cells.size(); column < columns_.size(); ++column) {
      Word word = row.prefix;
      const Word& suffix = columns_[column].suffix;
      word.insert(word.end(), suffix.begin(), suffix.end());
      batch.emplace_back(std::move(word));
    }
  }
  if (batch.empty()) return;
  const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
  output_queries_ += answers.size();
  auto answer = answers.begin();
  auto query = batch.begin();
  for (Row& row : rows_) {
    for (std::size_t i = row.cells.size(); i < columns_.size(); ++i, ++answer, ++query) {
      const Word& outputs = complete_outputs(*answer, std::get<Word>(*query));
      Column& column = columns_[i];
      const Word value(outputs.end() - static_cast<std::ptrdiff_t>(column.suffix.size()),
                       outputs.end());
      const auto [entry, is_new] =
          column.index.try_emplace(value, static_cast<std::uint32_t>(column.values.size()));
      if (is_new) column.values.push_back(value);
      row.cells.push_back(entry->second);
    }
  }
}

// Makes a short row of each long row from `first` on that equals no short one. All that are
// different move at once, so their extensions are filled in one batch.
bool ObservationTable::promote_new_rows(RowId first) {
  bool promoted = false;
  const RowId end = static_cast<RowId>(rows_.size());
  for (RowId row = first; row < end; ++row) {
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
      for (const RowId row : short_rows_) short_by_cells_.emplace(rows_[row].cells, row);
      unseen = 0;
    }
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
  Hypothesis result{Mealy(oracle_.inputs(), oracle_.outputs(), short_rows_.size()), {}};
  std::vector<RowId> order{0};  // the short row of each state
  std::unordered_map<RowId, StateId> state_of{{0, 0}};
  for (StateId state = 0; state < order.size(); ++state) {
    const RowId row = order[state];
    result.access.push_back(rows_[row].prefix);
    for (Symbol input = 0; input < inputs; ++input) {
      const RowId target = short_by_cells_.at(rows_[extension(row, input)].cells);
      const auto [entry, is_new] = state_of.try_emplace(target, static_cast<StateId>(order.size()));
      if (is_new) order.push_back(target);
      const Symbol output = columns_[input].values[rows_[row].cells[input]].front();
      result.machine.set_transition(state, input, output, entry->second);
    }
  }
  return result;
}

std::size_t ObservationTable::longest_row_prefix(std::span<const Symbol> word) const {
  RowId row = 0;
  std::size_t length = 0;
  while (length < word.size() && rows_[row].extensions != no_row) {
    row = extension(row, word[length++]);
  }
  return length;
}

}  // namespace maide
