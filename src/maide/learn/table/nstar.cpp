#include "maide/learn/table/nstar.hpp"

#include <algorithm>
#include <deque>
#include <span>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"

namespace maide {
namespace {

constexpr std::size_t no_state = ~std::size_t{0};
// Rounds that a word may be run before its trace counts as too rare.
constexpr std::uint32_t round_limit = 2000;

}  // namespace

NStar::NStar(TraceSamples& samples) : samples_(samples) {
  if (samples.inputs().empty()) throw UsageError("the system has no inputs to learn from");
  for (Symbol input = 0; input < samples.inputs().size(); ++input) {
    suffixes_.push_back({input});
    suffix_set_.insert({input});
  }
}

bool NStar::are_apart(Node left, Node right, std::span<const Symbol> suffix) const {
  MAIDE_CHECK(!suffix.empty());
  const Symbol input = suffix.front();
  const auto shows_more = [&](Node more, Node complete) {
    if (!samples_.is_complete(complete, input)) return false;
    const auto branches = samples_.branches(more, input);
    return std::ranges::any_of(branches, [&](const auto& branch) {
      return samples_.child(complete, input, branch.output) == TraceSamples::none;
    });
  };
  if (shows_more(left, right) || shows_more(right, left)) return true;
  if (suffix.size() == 1) return false;
  const auto branches = samples_.branches(left, input);
  return std::ranges::any_of(branches, [&](const auto& branch) {
    const Node other = samples_.child(right, input, branch.output);
    return other != TraceSamples::none && are_apart(branch.node, other, suffix.subspan(1));
  });
}

bool NStar::are_apart(Node left, Node right) const {
  return std::ranges::any_of(suffixes_,
                             [&](const Word& suffix) { return are_apart(left, right, suffix); });
}

std::size_t NStar::find_equal(Node node) const {
  for (std::size_t state = 0; state < basis_.size(); ++state) {
    if (basis_[state] == node || !are_apart(basis_[state], node)) return state;
  }
  return no_state;
}

// The traces one step beyond the basis.
std::vector<NStar::Node> NStar::frontier() const {
  std::vector<Node> result;
  for (const Node node : basis_) {
    for (Symbol input = 0; input < samples_.inputs().size(); ++input) {
      for (const auto& branch : samples_.branches(node, input)) result.push_back(branch.node);
    }
  }
  return result;
}

// Fills every cell. New answers make new traces, so until there are none.
void NStar::sample_table(const RunControl& control) {
  for (std::size_t known = 0; known != samples_.size();) {
    known = samples_.size();
    std::vector<Node> rows = frontier();
    rows.push_back(TraceSamples::root);
    std::vector<Word> words;
    for (const Node row : rows) {
      const Word prefix = samples_.inputs_of(row);
      for (const Word& suffix : suffixes_) {
        words.push_back(prefix);
        words.back().insert(words.back().end(), suffix.begin(), suffix.end());
      }
    }
    samples_.sample(std::move(words), control);
  }
}

// Adds each trace of the frontier that is apart from all of the basis; false if there is none.
bool NStar::extend_basis() {
  bool is_extended = false;
  for (const Node node : frontier()) {
    if (find_equal(node) != no_state) continue;
    basis_.push_back(node);
    is_extended = true;
  }
  return is_extended;
}

bool NStar::is_basis_apart() const {
  for (std::size_t right = 1; right < basis_.size(); ++right) {
    for (std::size_t left = 0; left < right; ++left) {
      if (!are_apart(basis_[left], basis_[right])) return false;
    }
  }
  return true;
}

void NStar::close(const RunControl& control) {
  bool is_changed = true;
  while (is_changed) {
    control.check("learning");
    sample_table(control);
    is_changed = !is_basis_apart();
    if (is_changed) basis_.assign(1, TraceSamples::root);
    is_changed |= extend_basis();
    MAIDE_CHECK(basis_.front() == TraceSamples::root && basis_.size() <= samples_.size());
    Progress progress;
    progress.phase = "learning";
    progress.states = basis_.size();
    control.report(progress);
  }
}

void NStar::make_hypothesis() {
  hypothesis_ = NondeterministicMealy(samples_.inputs(), samples_.outputs(), basis_.size());
  for (std::size_t state = 0; state < basis_.size(); ++state) {
    for (Symbol input = 0; input < samples_.inputs().size(); ++input) {
      for (const auto& branch : samples_.branches(basis_[state], input)) {
        const std::size_t target = find_equal(branch.node);
        MAIDE_CHECK(target != no_state);  // the table is closed
        hypothesis_.add_choice(static_cast<StateId>(state), input, branch.output,
                               static_cast<StateId>(target));
      }
    }
  }
}

void NStar::start(const RunControl& control) {
  close(control);
  make_hypothesis();
}

void NStar::make_draft() {
  basis_.assign(1, TraceSamples::root);
  while (extend_basis()) {
  }
  make_hypothesis();
}

std::optional<NStar::Mismatch> NStar::locate_mismatch() const {
  std::deque<std::pair<Node, StateId>> work{{TraceSamples::root, hypothesis_.initial()}};
  for (; !work.empty(); work.pop_front()) {
    const auto [node, state] = work.front();
    for (Symbol input = 0; input < samples_.inputs().size(); ++input) {
      const auto branches = samples_.branches(node, input);
      if (samples_.is_complete(node, input) &&
          branches.size() < hypothesis_.choices(state, input).size()) {
        return Mismatch{node, input};
      }
      for (const auto& branch : branches) {
        // Outputs that are newer than the hypothesis have no successor, either.
        const StateId next = hypothesis_.successor(state, input, branch.output);
        if (next == Mealy::no_state) return Mismatch{node, input};
        work.emplace_back(branch.node, next);
      }
    }
  }
  return std::nullopt;
}

std::optional<Word> NStar::find_mismatch() const {
  const auto mismatch = locate_mismatch();
  if (!mismatch) return std::nullopt;
  Word word = samples_.inputs_of(mismatch->node);
  word.push_back(mismatch->input);
  return word;
}

// Of the part behind the longest prefix that is a row, the shortest suffix that is no column yet.
bool NStar::add_next_suffix(const Mismatch& mismatch) {
  std::set<Node> rows(basis_.begin(), basis_.end());
  for (const Node node : frontier()) rows.insert(node);
  Word word = samples_.inputs_of(mismatch.node);
  Node node = mismatch.node;
  std::size_t row_length = word.size();
  for (; !rows.contains(node); node = samples_.parent(node)) --row_length;
  MAIDE_CHECK(row_length <= word.size());
  word.push_back(mismatch.input);
  for (std::size_t length = 1; length <= word.size() - row_length; ++length) {
    Word suffix(word.end() - static_cast<std::ptrdiff_t>(length), word.end());
    if (!suffix_set_.insert(suffix).second) continue;
    suffixes_.push_back(std::move(suffix));
    return true;
  }
  return false;
}

void NStar::refine(const RunControl& control) {
  while (const auto mismatch = locate_mismatch()) {
    control.check("learning");
    const std::size_t traces = samples_.size();
    const bool has_new_suffix = add_next_suffix(*mismatch);
    close(control);
    make_hypothesis();
    if (has_new_suffix || samples_.size() != traces) continue;
    // The rows are too rare to have been sampled to the end: give them more runs.
    const auto again = locate_mismatch();
    if (!again || again->node != mismatch->node || again->input != mismatch->input) continue;
    if (samples_.most_rounds() > round_limit) {
      Word word = samples_.inputs_of(mismatch->node);
      word.push_back(mismatch->input);
      throw Error(ExitStatus::inconclusive,
                  "the system does too rarely what it did in the word \"" +
                      to_string(word, samples_.inputs()) + "\" to be learned");
    }
    samples_.double_rounds();
  }
}

std::vector<Word> NStar::transition_cover() const {
  std::vector<Word> words;
  for (const Node node : frontier()) words.push_back(samples_.inputs_of(node));
  return words;
}

}  // namespace maide
