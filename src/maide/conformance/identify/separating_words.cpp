#include "maide/conformance/identify/separating_words.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <unordered_map>
#include <utility>

#include "maide/base/invariant.hpp"

namespace maide {

// A refinable partition: `order_` holds the states, a block is a range of it. Each block is a leaf
// of the splitting tree.
class SplittingTreeBuilder {
 public:
  SplittingTreeBuilder(const Mealy& machine, SeparatingWords& result)
      : machine_(machine), result_(result) {}

  void build() {
    const auto states = static_cast<std::uint32_t>(machine_.size());
    for (StateId state = 0; state < states; ++state) {
      order_.push_back(state);
      position_.push_back(state);
    }
    block_of_.assign(states, 0);
    result_.nodes_.emplace_back();
    blocks_.push_back({0, states, 0, 0});
    index_predecessors();
    split_by_outputs();
    while (!split_blocks_.empty()) split_by_targets();
    result_.leaf_.resize(states);
    for (StateId state = 0; state < states; ++state) {
      result_.leaf_[state] = blocks_[block_of_[state]].node;
    }
    MAIDE_CHECK(blocks_.size() <= std::max<std::size_t>(states, 1));
    result_.class_count_ = states == 0 ? 0 : blocks_.size();
  }

 private:
  struct Block {
    std::uint32_t begin, end;  // range of order_
    std::uint32_t node;        // its leaf in the splitting tree
    std::uint32_t origin;      // the block that it was part of at the end of the level before
    std::uint32_t size() const { return end - begin; }
  };
  // A state of a block and the group that it goes to.
  struct Mark {
    std::uint32_t block, group;
    StateId state;
    auto operator<=>(const Mark&) const = default;
  };

  void index_predecessors() {
    const std::size_t inputs = machine_.inputs().size();
    first_.assign(machine_.size() * inputs + 1, 0);
    const auto slot = [&](StateId state, Symbol input) { return state * inputs + input; };
    for (StateId state = 0; state < machine_.size(); ++state) {
      for (Symbol input = 0; input < inputs; ++input) {
        ++first_[slot(machine_.target(state, input), input) + 1];
      }
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    MAIDE_CHECK(first_.back() == machine_.size() * inputs);  // every transition has one target
    predecessors_.resize(machine_.size() * inputs);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (StateId state = 0; state < machine_.size(); ++state) {
      for (Symbol input = 0; input < inputs; ++input) {
        predecessors_[next[slot(machine_.target(state, input), input)]++] = state;
      }
    }
  }

  void split_by_outputs() {
    std::vector<Mark> marks;
    for (Symbol input = 0; input < machine_.inputs().size(); ++input) {
      marks.clear();
      for (StateId state = 0; state < machine_.size(); ++state) {
        marks.push_back({block_of_[state], machine_.output(state, input), state});
      }
      split(marks, input);
    }
    finish_level();
  }

  // At the end of a level states of one block answer alike for that many steps, so by each input
  // they go into parts of one block of the level before. Those parts, all but the largest, mark
  // their predecessors; what is not marked goes to the largest.
  void split_by_targets() {
    const std::size_t inputs = machine_.inputs().size();
    struct Part {
      std::uint32_t origin, group;
      std::vector<StateId> states;
    };
    std::vector<Part> parts;
    for (const auto& [origin, members] : split_blocks_) {
      const auto largest = std::max_element(members.begin(), members.end(), [&](auto a, auto b) {
        return blocks_[a].size() < blocks_[b].size();
      });
      for (auto member = members.begin(); member != members.end(); ++member) {
        if (member == largest) continue;
        const Block& block = blocks_[*member];
        parts.push_back(
            {origin, *member, {order_.begin() + block.begin, order_.begin() + block.end}});
      }
    }
    std::vector<Mark> marks;
    for (Symbol input = 0; input < inputs; ++input) {
      for (std::size_t i = 0; i < parts.size();) {
        marks.clear();
        const std::uint32_t origin = parts[i].origin;
        for (; i < parts.size() && parts[i].origin == origin; ++i) {
          for (const StateId state : parts[i].states) {
            const std::size_t slot = state * inputs + input;
            for (std::uint32_t at = first_[slot]; at < first_[slot + 1]; ++at) {
              marks.push_back({block_of_[predecessors_[at]], parts[i].group, predecessors_[at]});
            }
          }
        }
        split(marks, input);
      }
    }
    finish_level();
  }

  // Splits each marked block into its groups, and those of its states that have no mark.
  void split(std::vector<Mark>& marks, Symbol input) {
    std::sort(marks.begin(), marks.end());
    for (std::size_t begin = 0; begin < marks.size();) {
      std::size_t end = begin;
      while (end < marks.size() && marks[end].block == marks[begin].block) ++end;
      split_block(std::span(marks).subspan(begin, end - begin), input);
      begin = end;
    }
  }

  void split_block(std::span<const Mark> marks, Symbol input) {
    const std::uint32_t block = marks.front().block;
    MAIDE_CHECK(marks.size() <= blocks_[block].size());  // no state is marked twice
    const bool all_marked = marks.size() == blocks_[block].size();
    if (all_marked && marks.front().group == marks.back().group) return;
    const std::uint32_t inner = blocks_[block].node;
    result_.nodes_[inner].input = input;
    blocks_[block].node = add_leaf(inner);
    // If all are marked, the first group keeps the block.
    std::size_t i = 0;
    const std::uint32_t kept = marks.front().group;
    while (all_marked && marks[i].group == kept) ++i;
    while (i < marks.size()) {
      const std::uint32_t group = marks[i].group;
      const auto fresh = static_cast<std::uint32_t>(blocks_.size());
      const std::uint32_t end = blocks_[block].end;
      blocks_.push_back({end, end, add_leaf(inner), blocks_[block].origin});
      for (; i < marks.size() && marks[i].group == group; ++i) {
        MAIDE_CHECK(block_of_[marks[i].state] == block && blocks_[block].size() > 1);
        move_to_end(marks[i].state, --blocks_[block].end);
        block_of_[marks[i].state] = fresh;
        --blocks_[fresh].begin;
      }
      MAIDE_CHECK(blocks_[fresh].begin == blocks_[block].end && blocks_[fresh].end == end);
    }
  }

  std::uint32_t add_leaf(std::uint32_t parent) {
    result_.nodes_.push_back({parent, result_.nodes_[parent].depth + 1, 0});
    return static_cast<std::uint32_t>(result_.nodes_.size() - 1);
  }

  void move_to_end(StateId state, std::uint32_t place) {
    const StateId other = order_[place];
    std::swap(order_[position_[state]], order_[place]);
    std::swap(position_[state], position_[other]);
    MAIDE_CHECK(order_[place] == state && position_[state] == place);
    MAIDE_CHECK(order_[position_[other]] == other);
  }

  // Collects the blocks that were split in this level, with their parts.
  void finish_level() {
    split_blocks_.clear();
    for (std::uint32_t block = known_blocks_; block < blocks_.size(); ++block) {
      std::vector<std::uint32_t>& parts = split_blocks_[blocks_[block].origin];
      if (parts.empty()) parts.push_back(blocks_[block].origin);
      parts.push_back(block);
    }
    for (; known_blocks_ < blocks_.size(); ++known_blocks_) {
      blocks_[known_blocks_].origin = known_blocks_;
    }
  }

  const Mealy& machine_;
  SeparatingWords& result_;
  std::vector<StateId> order_;
  std::vector<std::uint32_t> position_, block_of_;  // of each state
  std::vector<Block> blocks_;
  std::uint32_t known_blocks_ = 1;  // blocks at the end of the level before
  std::map<std::uint32_t, std::vector<std::uint32_t>> split_blocks_;  // in the last level
  std::vector<std::uint32_t> first_;  // predecessors of (state, input): a range of predecessors_
  std::vector<StateId> predecessors_;
};

SeparatingWords::SeparatingWords(const Mealy& machine) : machine_(machine) {
  SplittingTreeBuilder(machine, *this).build();
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

// A partition of the states: the number of each state's class.
struct Partition {
  std::vector<std::uint32_t> classes;
  std::size_t count = 1;
};

// By the answers to a word.
Partition answers_to(const Word& word, const Mealy& machine) {
  std::unordered_map<Word, std::uint32_t, WordHash> numbers;
  Partition result;
  for (StateId state = 0; state < machine.size(); ++state) {
    const auto number = static_cast<std::uint32_t>(numbers.size());
    result.classes.push_back(
        numbers.try_emplace(machine.output_word(state, word), number).first->second);
  }
  result.count = numbers.size();
  return result;
}

// The coarsest that is finer than both.
Partition intersect(const Partition& left, const Partition& right) {
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  Partition result;
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
  std::sort(words.begin(), words.end(), is_shorter);
  std::vector<Partition> by_word, by_shorter{{std::vector<std::uint32_t>(machine.size(), 0)}};
  for (const Word& word : words) {
    by_word.push_back(answers_to(word, machine));
    by_shorter.push_back(intersect(by_shorter.back(), by_word.back()));
  }
  MAIDE_CHECK(by_shorter.back().count == class_count);
  Partition by_kept = by_shorter.front();  // by the longer words that stay
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
  std::vector<std::vector<StateId>> blocks(1), next;  // states that `words` do not tell apart
  for (StateId state = 0; state < machine.size(); ++state) blocks[0].push_back(state);
  while (true) {
    std::optional<Word> word;
    for (std::size_t i = 0; i < blocks.size() && !word; ++i) {
      for (std::size_t j = 1; j < blocks[i].size() && !word; ++j) {
        word = separating.find(blocks[i][0], blocks[i][j]);
      }
      if (!word) blocks[i].clear();  // all equivalent: no word splits it
    }
    if (!word) break;
    std::erase_if(words, [&](const Word& shorter) {
      return shorter.size() < word->size() &&
             std::equal(shorter.begin(), shorter.end(), word->begin());
    });
    next.clear();
    for (const std::vector<StateId>& block : blocks) {
      std::map<Word, std::vector<StateId>> groups;
      for (const StateId state : block) groups[machine.output_word(state, *word)].push_back(state);
      for (auto& [outputs, group] : groups) {
        if (group.size() > 1) next.push_back(std::move(group));
      }
    }
    blocks.swap(next);
    words.push_back(*std::move(word));
  }
  drop_needless_words(machine, separating.class_count(), words);
  std::sort(words.begin(), words.end(), is_shorter);
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
