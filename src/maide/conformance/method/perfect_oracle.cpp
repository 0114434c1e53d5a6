#include "maide/conformance/method/perfect_oracle.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <span>
#include <type_traits>

#include "maide/automata/compare.hpp"
#include "maide/base/invariant.hpp"

namespace maide {
namespace {

constexpr Symbol unknown = ~Symbol{0};
constexpr std::uint32_t none = ~std::uint32_t{0};

}  // namespace

std::size_t IncrementalComparison::Bits::next(std::size_t bit, std::size_t end) const {
  if (bit >= end) return end;
  std::size_t word = bit / 64;
  std::uint64_t rest = words_[word] & (~std::uint64_t{0} << (bit % 64));
  while (rest == 0) {
    if (++word * 64 >= end) return end;
    rest = words_[word];
  }
  return std::min(end, word * 64 + static_cast<std::size_t>(std::countr_zero(rest)));
}

std::optional<Word> IncrementalComparison::find_difference(const Mealy& hypothesis) {
  const std::size_t known_states = inputs_ == 0 ? 0 : cells_.size() / inputs_;
  const bool is_first = inputs_ == 0 || !(hypothesis.inputs() == input_names_);
  if (is_first) {
    const auto known = [&](const std::string& name) {
      return reference_.inputs().find(name).has_value();
    };
    if (hypothesis.inputs().empty() || hypothesis.inputs().size() != reference_.inputs().size() ||
        !std::ranges::all_of(hypothesis.inputs().names(), known)) {
      return find_distinguishing_word(hypothesis, reference_);  // which names the input
    }
    read_reference(hypothesis.inputs());
  }
  const bool is_renumbered = !read_outputs(hypothesis.outputs());
  if (is_first || is_renumbered || hypothesis.size() < known_states) {
    compare_anew(hypothesis);
  } else {
    update(hypothesis);
  }
  std::optional<Word> found = search();
  MAIDE_CHECK(!found || is_first_difference(*found));
  return found;
}

// For a check: the hypothesis and the reference differ in the last output of the word, and only
// there. O(length).
bool IncrementalComparison::is_first_difference(const Word& word) const {
  StateId state = twin_[0];
  Spot spot = 0;
  for (std::size_t i = 0; i < word.size(); ++i) {
    const Mealy::Cell& cell = cells_[state * inputs_ + word[i]];
    const Edge edge = spot * inputs_ + word[i];
    if (output_map_[cell.output] != output_[edge]) return i + 1 == word.size();
    state = cell.target;
    spot = next_[edge];
  }
  return false;
}

// Breadth first: the order of the spots is that of their least words.
void IncrementalComparison::read_reference(const Alphabet& inputs) {
  input_names_ = inputs;
  inputs_ = inputs.size();
  std::vector<Symbol> input_map;
  for (const std::string& name : inputs.names()) input_map.push_back(reference_.inputs().at(name));
  std::vector<Spot> spot_of(reference_.size(), none);
  std::vector<StateId> states{reference_.initial()};
  spot_of[reference_.initial()] = 0;
  entry_.assign(1, 0);
  next_.clear();
  output_.clear();
  first_below_.clear();
  for (Spot spot = 0; spot < states.size(); ++spot) {
    first_below_.push_back(static_cast<Spot>(states.size()));
    for (const Symbol input : input_map) {
      const StateId target = reference_.target(states[spot], input);
      if (spot_of[target] == none) {
        spot_of[target] = static_cast<Spot>(states.size());
        states.push_back(target);
        entry_.push_back(next_.size());
      }
      next_.push_back(spot_of[target]);
      output_.push_back(reference_.output(states[spot], input));
    }
  }
  first_below_.push_back(static_cast<Spot>(states.size()));
  incoming_.assign(states.size() + 1, 0);
  for (Edge edge = 0; edge < next_.size(); ++edge) {
    if (!is_tree_edge(edge)) ++incoming_[next_[edge] + 1];
  }
  std::partial_sum(incoming_.begin(), incoming_.end(), incoming_.begin());
  incoming_edges_.resize(incoming_.back());
  std::vector<std::size_t> end(incoming_);
  for (Edge edge = 0; edge < next_.size(); ++edge) {
    if (!is_tree_edge(edge)) incoming_edges_[end[next_[edge]]++] = edge;
  }
}

// False if an output has another number than before; new ones may come.
bool IncrementalComparison::read_outputs(const Alphabet& outputs) {
  const std::vector<std::string>& names = outputs.names();
  const bool is_same = names.size() >= output_names_.size() &&
                       std::equal(output_names_.begin(), output_names_.end(), names.begin());
  if (!is_same) output_map_.clear();
  output_names_.resize(output_map_.size());
  for (std::size_t i = output_map_.size(); i < outputs.size(); ++i) {
    const std::string& name = outputs.name(static_cast<Symbol>(i));
    output_names_.push_back(name);
    output_map_.push_back(reference_.outputs().find(name).value_or(unknown));
  }
  return is_same;
}

void IncrementalComparison::compare_anew(const Mealy& hypothesis) {
  const std::size_t spots = entry_.size();
  cells_.clear();
  revisions_.clear();
  add_rows(hypothesis);
  first_.assign(hypothesis.size(), none);
  after_.assign(spots, none);
  before_.assign(spots, none);
  twin_.assign(spots, Mealy::no_state);
  united_.resize(hypothesis.size());
  std::iota(united_.begin(), united_.end(), StateId{0});
  moved_.assign(spots);
  mismatches_.assign(spots);
  conflicts_.assign(next_.size());
  set_twin(0, hypothesis.initial());
  for (Spot spot = 1; spot < spots; ++spot) {
    set_twin(spot, target(twin_[entry_[spot] / inputs_], entry_[spot] % inputs_));
  }
  for (Spot spot = 0; spot < spots; ++spot) look_at(spot);
}

void IncrementalComparison::update(const Mealy& hypothesis) {
  const std::size_t before = cells_.size() / inputs_;
  if (hypothesis.initial() != twin_[0]) return compare_anew(hypothesis);
  MAIDE_CHECK(hypothesis.size() >= before && moved_.next(0, entry_.size()) == entry_.size());
  add_rows(hypothesis);
  for (auto state = static_cast<StateId>(before); state < hypothesis.size(); ++state) {
    first_.push_back(none);
    united_.push_back(state);
  }
  for (StateId state = 0; state < before; ++state) {
    if (hypothesis.revision(state) == revisions_[state]) continue;  // nearly always
    revisions_[state] = hypothesis.revision(state);
    change_row(state, hypothesis.row(state));
  }
  move_twins();
}

// The rows of the states that are new.
void IncrementalComparison::add_rows(const Mealy& hypothesis) {
  for (auto state = static_cast<StateId>(revisions_.size()); state < hypothesis.size(); ++state) {
    const auto row = hypothesis.row(state);
    cells_.insert(cells_.end(), row.begin(), row.end());
    revisions_.push_back(hypothesis.revision(state));
  }
}

void IncrementalComparison::change_row(StateId state, std::span<const Mealy::Cell> row) {
  Mealy::Cell* const old_row = &cells_[state * inputs_];
  static_assert(std::has_unique_object_representations_v<Mealy::Cell>);
  if (std::memcmp(row.data(), old_row, row.size_bytes()) == 0) return;
  bool outputs_changed = false;
  for (std::size_t input = 0; input < inputs_; ++input) {
    if (row[input] == old_row[input]) continue;
    outputs_changed = outputs_changed || row[input].output != old_row[input].output;
    old_row[input] = row[input];
    for (Spot spot = first_[state]; spot != none; spot = after_[spot]) {
      const Edge edge = spot * inputs_ + input;
      if (is_tree_edge(edge)) {
        moved_.set(next_[edge], true);
      } else {
        look_at_edge(edge);
      }
    }
  }
  if (!outputs_changed) return;
  for (Spot spot = first_[state]; spot != none; spot = after_[spot]) {
    mismatches_.set(spot, find_mismatch(state, spot).has_value());
  }
}

// Every spot comes after the one that its entry comes from.
void IncrementalComparison::move_twins() {
  const std::size_t spots = entry_.size();
  for (std::size_t spot = moved_.next(0, spots); spot < spots; spot = moved_.next(spot, spots)) {
    moved_.set(spot, false);
    MAIDE_CHECK(spot > 0 && entry_[spot] / inputs_ < spot);
    const StateId twin = target(twin_[entry_[spot] / inputs_], entry_[spot] % inputs_);
    if (twin == twin_[spot]) continue;
    set_twin(static_cast<Spot>(spot), twin);
    look_at(static_cast<Spot>(spot));
    for (std::size_t i = incoming_[spot]; i < incoming_[spot + 1]; ++i) {
      look_at_edge(incoming_edges_[i]);
    }
    for (Spot below = first_below_[spot]; below < first_below_[spot + 1]; ++below) {
      moved_.set(below, true);
    }
  }
}

void IncrementalComparison::set_twin(Spot spot, StateId twin) {
  MAIDE_CHECK(twin < first_.size());
  if (twin_[spot] != Mealy::no_state) {
    MAIDE_CHECK(before_[spot] == none ? first_[twin_[spot]] == spot
                                      : after_[before_[spot]] == spot);
    (before_[spot] == none ? first_[twin_[spot]] : after_[before_[spot]]) = after_[spot];
    if (after_[spot] != none) before_[after_[spot]] = before_[spot];
  }
  twin_[spot] = twin;
  before_[spot] = none;
  after_[spot] = first_[twin];
  if (after_[spot] != none) before_[after_[spot]] = spot;
  first_[twin] = spot;
}

// Finds out whether it is a mismatch, and its edges conflicts.
void IncrementalComparison::look_at(Spot spot) {
  mismatches_.set(spot, find_mismatch(twin_[spot], spot).has_value());
  for (Edge edge = spot * inputs_; edge < (spot + std::size_t{1}) * inputs_; ++edge) {
    if (!is_tree_edge(edge)) look_at_edge(edge);
  }
}

void IncrementalComparison::look_at_edge(Edge edge) {
  MAIDE_CHECK(!is_tree_edge(edge) && twin_[next_[edge]] != Mealy::no_state);
  const StateId state = target(twin_[edge / inputs_], edge % inputs_);
  conflicts_.set(edge, state != twin_[next_[edge]]);
}

std::optional<Symbol> IncrementalComparison::find_mismatch(StateId state, Spot spot) const {
  const Mealy::Cell* const row = &cells_[state * inputs_];
  const Symbol* const outputs = &output_[spot * inputs_];
  for (std::size_t input = 0; input < inputs_; ++input) {
    if (output_map_[row[input].output] != outputs[input]) return static_cast<Symbol>(input);
  }
  return std::nullopt;
}

// Everything is done in the order of the words: conflicts by the spot that they leave, among them
// the pairs behind them, until the first mismatch is reached.
std::optional<Word> IncrementalComparison::search() {
  MAIDE_CHECK(queue_.empty() && touched_.empty());
  const std::size_t mismatch = mismatches_.next(0, entry_.size());
  const Edge end = mismatch * inputs_;
  std::size_t place = 0;
  std::optional<Word> found;
  const auto expand_before = [&](std::size_t spot) {
    while (!found && place < queue_.size() && queue_[place].position <= spot) {
      found = expand(place++);
    }
  };
  for (Edge edge = conflicts_.next(0, end); edge < end && !found;
       edge = conflicts_.next(edge + 1, end)) {
    const auto spot = static_cast<Spot>(edge / inputs_);
    expand_before(spot);
    if (found) break;
    Spot position = first_below_[spot];
    while (position < first_below_[spot + 1] && entry_[position] < edge) ++position;
    visit(target(twin_[spot], edge % inputs_), next_[edge], position, from_tree, edge);
  }
  expand_before(mismatch);
  if (!found && mismatch < entry_.size()) {
    const auto spot = static_cast<Spot>(mismatch);
    found = word_to(spot);
    found->push_back(*find_mismatch(twin_[spot], spot));
  }
  MAIDE_CHECK(queue_.size() == touched_.size() && queue_.size() < united_.size());
  for (const StateId state : touched_) united_[state] = state;
  touched_.clear();
  queue_.clear();
  return found;
}

// A mismatch of the pair makes a word; else the pairs that it leads to are looked at.
std::optional<Word> IncrementalComparison::expand(std::size_t place) {
  const Pair pair = queue_[place];
  if (const auto input = find_mismatch(pair.state, pair.spot)) {
    Word word = word_to_pair(place);
    word.push_back(*input);
    return word;
  }
  const Spot position = first_below_[pair.position];
  for (std::size_t input = 0; input < inputs_; ++input) {
    const Edge edge = pair.spot * inputs_ + input;
    visit(target(pair.state, input), next_[edge], position, place, edge);
  }
  return std::nullopt;
}

void IncrementalComparison::visit(StateId state, Spot spot, Spot position, std::size_t parent,
                                  Edge last) {
  if (state == twin_[spot]) return;
  MAIDE_CHECK(parent == from_tree || parent < queue_.size());
  MAIDE_CHECK(next_[last] == spot);
  const StateId left = find(state), right = find(twin_[spot]);
  if (left == right) return;
  united_[left] = right;
  touched_.push_back(left);
  queue_.push_back({state, spot, position, parent, last});
}

StateId IncrementalComparison::find(StateId state) {
  while (united_[state] != state) {
    united_[state] = united_[united_[state]];
    state = united_[state];
  }
  return state;
}

Word IncrementalComparison::word_to(Spot spot) const {
  Word word;
  for (; spot != 0; spot = static_cast<Spot>(entry_[spot] / inputs_)) {
    word.push_back(static_cast<Symbol>(entry_[spot] % inputs_));
  }
  MAIDE_CHECK(word.size() < entry_.size());
  return {word.rbegin(), word.rend()};
}

Word IncrementalComparison::word_to_pair(std::size_t place) const {
  Word backwards;
  while (true) {
    const Pair& pair = queue_[place];
    backwards.push_back(static_cast<Symbol>(pair.last % inputs_));
    if (pair.parent == from_tree) {
      Word word = word_to(static_cast<Spot>(pair.last / inputs_));
      word.insert(word.end(), backwards.rbegin(), backwards.rend());
      return word;
    }
    place = pair.parent;
  }
}

std::optional<Word> PerfectOracle::find_counterexample(const Mealy& hypothesis,
                                                       const RunControl& /*control*/) {
  is_equal_ = false;
  std::optional<Word> difference = comparison_.find_difference(hypothesis);
  is_equal_ = !difference;
  return difference;
}

std::string PerfectOracle::guarantee() const { return "equivalent to the reference model"; }

}  // namespace maide
