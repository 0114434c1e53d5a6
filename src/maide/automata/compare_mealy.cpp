// Hopcroft & Karp, breadth first. Invariant: two states in one class of the union-find structure
// are equivalent unless some pair already in the queue, with a word that is no longer (and no
// greater among words as long), tells them apart; so skipping a pair within a class loses neither
// the shortest nor the least word.
#include <numeric>
#include <utility>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"

namespace maide {

namespace {

class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t element) {
    while (parent_[element] != element) {
      parent_[element] = parent_[parent_[element]];
      element = parent_[element];
    }
    return element;
  }
  // False if they were in one class already.
  bool unite(std::uint32_t left, std::uint32_t right) {
    left = find(left);
    right = find(right);
    if (left == right) return false;
    // Linking by a scrambled index is as good as by rank (Goel, Khanna, Larkin, Tarjan, SODA 2014).
    if (left * 2654435769U < right * 2654435769U) std::swap(left, right);
    parent_[right] = left;
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

constexpr Symbol unknown = ~Symbol{0};

// For each symbol of `from` the one of the same name in `to`, or `unknown`.
std::vector<Symbol> symbol_map(const Alphabet& from, const Alphabet& to) {
  std::vector<Symbol> map;
  map.reserve(from.size());
  for (const std::string& name : from.names()) map.push_back(to.find(name).value_or(unknown));
  return map;
}

class MealyComparison {
 public:
  MealyComparison(const Mealy& left, const Mealy& right)
      : left_(left),
        right_(right),
        inputs_(symbol_map(left.inputs(), right.inputs())),
        outputs_(symbol_map(right.outputs(), left.outputs())),
        classes_(left.size() + right.size()) {}

  // The shortest and least word over the inputs that both have.
  std::optional<Word> find_word() {
    visit(left_.initial(), right_.initial(), 0, 0);
    for (std::size_t next = 0; next < queue_.size(); ++next) {
      for (Symbol input = 0; input < inputs_.size(); ++input) {
        const auto [left, right, parent, last] = queue_[next];
        const Symbol other = inputs_[input];
        if (other == unknown) continue;
        if (left_.output(left, input) != outputs_[right_.output(right, other)]) {
          return word_to(next, input);
        }
        visit(left_.target(left, input), right_.target(right, other), next, input);
      }
    }
    return std::nullopt;
  }

  // The first input that only one machine has, in left's order and then right's.
  std::optional<std::string> input_of_one() const {
    for (Symbol input = 0; input < inputs_.size(); ++input) {
      if (inputs_[input] == unknown) return left_.inputs().name(input);
    }
    for (const std::string& name : right_.inputs().names()) {
      if (!left_.inputs().find(name)) return name;
    }
    return std::nullopt;
  }

 private:
  struct Pair {
    StateId left, right;
    std::size_t parent;  // place in the queue of the pair before it
    Symbol last;         // the input that led here from there
  };

  void visit(StateId left, StateId right, std::size_t parent, Symbol last) {
    if (classes_.unite(left, static_cast<std::uint32_t>(left_.size()) + right)) {
      queue_.push_back({left, right, parent, last});
    }
  }

  Word word_to(std::size_t pair, Symbol last) const {
    Word word{last};
    for (; pair != 0; pair = queue_[pair].parent) word.push_back(queue_[pair].last);
    return {word.rbegin(), word.rend()};
  }

  const Mealy& left_;
  const Mealy& right_;
  std::vector<Symbol> inputs_;   // left's -> right's
  std::vector<Symbol> outputs_;  // right's -> left's
  UnionFind classes_;
  std::vector<Pair> queue_;
};

}  // namespace

std::optional<MealyDifference> find_difference(const Mealy& left, const Mealy& right) {
  MealyComparison comparison(left, right);
  const auto word = comparison.find_word();
  const auto lonely = comparison.input_of_one();
  // A word of one input that both have goes before an input of one, if it is the lesser symbol.
  const bool word_first =
      word && word->size() == 1 &&
      (!lonely || word->front() < left.inputs().find(*lonely).value_or(unknown));
  if (lonely && !word_first) {
    MealyDifference difference{{*lonely}, std::nullopt, std::nullopt};
    if (const auto input = left.inputs().find(*lonely)) {
      difference.left = left.outputs().name(left.output(left.initial(), *input));
    }
    if (const auto input = right.inputs().find(*lonely)) {
      difference.right = right.outputs().name(right.output(right.initial(), *input));
    }
    return difference;
  }
  if (!word) return std::nullopt;
  MealyDifference difference;
  Word right_word;
  for (const Symbol input : *word) {
    difference.word.push_back(left.inputs().name(input));
    right_word.push_back(*right.inputs().find(difference.word.back()));
  }
  difference.left = left.outputs().name(left.output_word(*word).back());
  difference.right = right.outputs().name(right.output_word(right_word).back());
  return difference;
}

std::optional<Word> find_distinguishing_word(const Mealy& left, const Mealy& right) {
  MealyComparison comparison(left, right);
  if (const auto lonely = comparison.input_of_one()) {
    throw UsageError("only one of two machines has the input '" + *lonely + "'");
  }
  return comparison.find_word();
}

}  // namespace maide
