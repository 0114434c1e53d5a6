#include "maide/conformance/identify/separating_words.hpp"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "maide/automata/minimize.hpp"
#include "maide/base/invariant.hpp"

namespace maide {

// Each block of the partition is a leaf of the splitting tree. All parts into which a block is
// split in one step are children of one node.
SeparatingWords::SeparatingWords(const Mealy& machine) : machine_(machine), nodes_(1) {
  const std::size_t inputs = machine.inputs().size();
  std::vector<std::uint32_t> leaves{0};                    // by block
  std::size_t last_step = ~std::size_t{0}, first_new = 0;  // the first node of that step
  const auto add_leaf = [&](std::uint32_t parent) {
    nodes_.push_back({parent, nodes_[parent].depth + 1, 0});
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  };
  const Partition classes = compute_state_classes(machine, [&](auto block, auto, auto step) {
    if (std::exchange(last_step, step) != step) first_new = nodes_.size();
    if (leaves[block] < first_new) {
      nodes_[leaves[block]].input = static_cast<Symbol>(step % inputs);
      leaves[block] = add_leaf(leaves[block]);
    }
    leaves.push_back(add_leaf(nodes_[leaves[block]].parent));
  });
  for (StateId state = 0; state < machine.size(); ++state) {
    leaf_.push_back(leaves[classes.block_of(state)]);
  }
  class_count_ = classes.blocks();
}

// The input at the lowest common ancestor of two different leaves.
Symbol SeparatingWords::splitting_input(StateId left, StateId right) const {
  std::uint32_t a = leaf_[left], b = leaf_[right];
  while (a != b) {
    if (nodes_[a].depth < nodes_[b].depth) std::swap(a, b);
    a = nodes_[a].parent;
  }
  return nodes_[a].input;
}

// After each step the states are told apart by a node of an earlier level, so the word is finite
// and shortest.
std::optional<Word> SeparatingWords::find(StateId left, StateId right) const {
  if (!are_separable(left, right)) return std::nullopt;
  Word word;
  while (true) {
    const Symbol input = splitting_input(left, right);
    word.push_back(input);
    MAIDE_CHECK(left != right && word.size() < machine_.size());
    if (machine_.output(left, input) != machine_.output(right, input)) return word;
    left = machine_.target(left, input);
    right = machine_.target(right, input);
  }
}

namespace {

bool is_shorter(const Word& left, const Word& right) {
  return left.size() != right.size() ? left.size() < right.size() : left < right;
}

// The number of each state's class.
struct Classes {
  std::vector<std::uint32_t> classes;
  std::size_t count = 1;
};

// By the answers to a word.
Classes answers_to(const Word& word, const Mealy& machine) {
  std::unordered_map<Word, std::uint32_t, WordHash> numbers;
  Classes result;
  for (StateId state = 0; state < machine.size(); ++state) {
    const auto number = static_cast<std::uint32_t>(numbers.size());
    result.classes.push_back(
        numbers.try_emplace(machine.output_word(state, word), number).first->second);
  }
  result.count = numbers.size();
  return result;
}

// The coarsest that is finer than both.
Classes intersect(const Classes& left, const Classes& right) {
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  Classes result;
  for (std::size_t state = 0; state < left.classes.size(); ++state) {
    const auto number = static_cast<std::uint32_t>(numbers.size());
    const std::uint64_t pair = std::uint64_t{left.classes[state]} << 32 | right.classes[state];
    result.classes.push_back(numbers.try_emplace(pair, number).first->second);
  }
  result.count = numbers.size();
  return result;
}

// Leaves out words as long as the others still tell as many classes apart; long ones are tried
// first, for they cost most. O(|W| n l).
void drop_needless_words(const Mealy& machine, std::size_t class_count, std::vector<Word>& words) {
  std::ranges::sort(words, is_shorter);
  std::vector<Classes> by_word, by_shorter{{std::vector<std::uint32_t>(machine.size(), 0)}};
  for (const Word& word : words) {
    by_word.push_back(answers_to(word, machine));
    by_shorter.push_back(intersect(by_shorter.back(), by_word.back()));
  }
  MAIDE_CHECK(by_shorter.back().count == class_count);
  Classes by_kept = by_shorter.front();  // by the longer words that stay
  for (std::size_t i = words.size(); i-- > 0;) {
    if (intersect(by_shorter[i], by_kept).count == class_count) {
      words.erase(words.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      by_kept = intersect(by_kept, by_word[i]);
    }
  }
  MAIDE_CHECK(by_kept.count == class_count || words.empty());
}

}  // namespace

std::vector<Word> compute_characterising_set(const Mealy& machine,
                                             const SeparatingWords& separating) {
  std::vector<Word> words;
  Partition partition(machine.size());       // by the answers to `words`
  std::vector<Partition::Block> open, next;  // those whose states a word may tell apart
  if (machine.size() > 0) open.push_back(0);
  while (true) {
    std::optional<Word> word;
    std::size_t place = 0;
    for (; place < open.size(); ++place) {
      const auto states = partition.elements(open[place]);
      for (std::size_t i = 1; i < states.size() && !word; ++i) {
        word = separating.find(states[0], states[i]);
      }
      if (word) break;
    }
    if (!word) break;
    std::erase_if(words, [&](const Word& shorter) {
      return shorter.size() < word->size() &&
             std::equal(shorter.begin(), shorter.end(), word->begin());
    });
    next.clear();
    const auto keep_open = [&](Partition::Block block) {
      if (partition.size(block) > 1) next.push_back(block);
    };
    for (; place < open.size(); ++place) {  // no word splits those before
      Partition::Block fresh = partition.split_by(
          open[place], [&](StateId state) { return machine.output_word(state, *word); });
      keep_open(open[place]);
      for (; fresh < partition.blocks(); ++fresh) keep_open(fresh);
    }
    open.swap(next);
    words.push_back(*std::move(word));
  }
  drop_needless_words(machine, separating.class_count(), words);
  std::ranges::sort(words, is_shorter);
  return words;
}

std::vector<Word> compute_state_cover(const Mealy& machine) {
  std::vector<Word> cover{Word()};
  std::vector<StateId> reached{machine.initial()};
  std::vector<bool> seen(machine.size(), false);
  seen[machine.initial()] = true;
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const StateId target = machine.target(reached[i], input);
      if (seen[target]) continue;
      seen[target] = true;
      reached.push_back(target);
      Word word = cover[i];
      word.push_back(input);
      cover.push_back(std::move(word));
    }
  }
  MAIDE_CHECK(cover.size() == reached.size() && cover.size() <= machine.size());
  return cover;
}

}  // namespace maide
