#include "maide/conformance/identify/state_identifiers.hpp"

#include <algorithm>
#include <deque>
#include <numeric>
#include <optional>
#include <queue>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/partition.hpp"
#include "maide/base/invariant.hpp"
#include "maide/conformance/identify/separating_words.hpp"

namespace maide {
namespace {

// Sends groups of states through the splitting tree.
class AdaptiveWords {
 public:
  AdaptiveWords(const Mealy& machine, const SplittingTree& tree)
      : machine_(machine), tree_(tree), words_(machine.size()) {}

  std::vector<std::vector<Word>> compute() {
    std::vector<StateId> all(machine_.size());
    for (StateId state = 0; state < machine_.size(); ++state) all[state] = state;
    merged_.push_back(std::move(all));
    while (!merged_.empty()) {
      const std::vector<StateId> group = std::move(merged_.back());
      merged_.pop_back();
      identify(group);
    }
    return std::move(words_);
  }

 private:
  // A state and where it is by now.
  struct Track {
    StateId state, current;
  };
  using Tracks = std::vector<Track>;

  // One more word for each state of the group, unless they are all equivalent.
  void identify(const std::vector<StateId>& group) {
    Tracks start;
    for (const StateId state : group) start.push_back({state, state});
    if (!node_for(start)) return;
    for (const StateId state : group) words_[state].emplace_back();
    std::vector<Tracks> open;
    open.push_back(std::move(start));
    while (!open.empty()) {
      Tracks tracks = std::move(open.back());
      open.pop_back();
      if (const auto node = node_for(tracks)) {
        advance(tracks, *node, open);
      } else if (tracks.size() > 1) {
        std::vector<StateId> merged;
        for (const Track& track : tracks) merged.push_back(track.state);
        merged_.push_back(std::move(merged));
      }
    }
  }

  // The node whose word tells some of the current states apart; nothing if none does.
  std::optional<SplittingTree::NodeId> node_for(const Tracks& tracks) const {
    const SplittingTree::NodeId first = tree_.leaf_of(tracks.front().current);
    SplittingTree::NodeId node = first;
    for (const Track& track : tracks) {
      node = tree_.common_ancestor(node, tree_.leaf_of(track.current));
    }
    if (node == first) return std::nullopt;
    return node;
  }

  // Plays the node's word and parts the tracks by the answers, which differ in the last output.
  void advance(Tracks& tracks, SplittingTree::NodeId node, std::vector<Tracks>& open) {
    std::vector<std::pair<Symbol, Track>> answers;
    for (const Track& track : tracks) answers.emplace_back(0, track);
    for (; node != SplittingTree::none; node = tree_.next(node)) {
      const Symbol input = tree_.input(node);
      for (auto& [output, track] : answers) {
        words_[track.state].back().push_back(input);
        output = machine_.output(track.current, input);
        track.current = machine_.target(track.current, input);
      }
    }
    std::ranges::stable_sort(
        answers, [](const auto& left, const auto& right) { return left.first < right.first; });
    MAIDE_CHECK(answers.front().first != answers.back().first);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      if (i == 0 || answers[i].first != answers[i - 1].first) open.emplace_back();
      open.back().push_back(answers[i].second);
    }
  }

  const Mealy& machine_;
  const SplittingTree& tree_;
  std::vector<std::vector<Word>> words_;
  std::vector<std::vector<StateId>> merged_;  // groups that are to be told apart by another word
};

// States that answer alike to a word have the same number.
std::vector<std::uint32_t> number_answers(const Mealy& machine, const Word& word) {
  std::unordered_map<Word, std::uint32_t, WordHash> numbers;
  std::vector<std::uint32_t> result;
  for (StateId state = 0; state < machine.size(); ++state) {
    const auto number = static_cast<std::uint32_t>(numbers.size());
    result.push_back(numbers.try_emplace(machine.output_word(state, word), number).first->second);
  }
  return result;
}

// For one state after the other, words out of a set: always the one by which most of the states
// that are left are told from it.
class OwnWords {
 public:
  OwnWords(const Mealy& machine, const SeparatingWords& separating, const std::vector<Word>& words)
      : separating_(separating), words_(words) {
    for (const Word& word : words) {
      answers_.push_back(number_answers(machine, word));
      alike_.emplace_back();
      for (StateId state = 0; state < machine.size(); ++state) {
        alike_.back().resize(
            std::max<std::size_t>(alike_.back().size(), answers_.back()[state] + 1));
        alike_.back()[answers_.back()[state]].push_back(state);
      }
    }
  }

  std::vector<Word> choose(StateId state) const {
    std::vector<Word> chosen;
    if (words_.empty()) return chosen;
    const auto size_after = [&](std::size_t word) {
      return alike_[word][answers_[word][state]].size();
    };
    std::size_t best = 0;
    for (std::size_t word = 1; word < words_.size(); ++word) {
      if (size_after(word) < size_after(best)) best = word;
    }
    chosen.push_back(words_[best]);
    std::vector<StateId> left = alike_[best][answers_[best][state]];
    std::erase_if(left, [&](StateId other) { return !separating_.are_separable(state, other); });
    while (!left.empty()) {
      std::size_t fewest = left.size();
      for (std::size_t word = 0; word < words_.size(); ++word) {
        const auto stays = [&](StateId other) {
          return answers_[word][other] == answers_[word][state];
        };
        const auto stay = static_cast<std::size_t>(std::ranges::count_if(left, stays));
        if (stay < fewest) {
          fewest = stay;
          best = word;
        }
      }
      MAIDE_CHECK(fewest < left.size());  // each word chosen tells some more apart
      chosen.push_back(words_[best]);
      std::erase_if(left,
                    [&](StateId other) { return answers_[best][other] != answers_[best][state]; });
    }
    return chosen;
  }

 private:
  const SeparatingWords& separating_;
  const std::vector<Word>& words_;
  std::vector<std::vector<std::uint32_t>> answers_;  // of each word, the number of each state's
  std::vector<std::vector<std::vector<StateId>>> alike_;  // of each word and answer, the states
};

}  // namespace

StateIdentifiers::StateIdentifiers(std::vector<std::vector<Word>> words) : own_(std::move(words)) {
  for (std::vector<Word>& own : own_) {
    own = without_prefixes(std::move(own));
    if (own.empty()) own.emplace_back();
  }
}

StateIdentifiers::StateIdentifiers(std::vector<Word> words)
    : StateIdentifiers(std::vector<std::vector<Word>>{std::move(words)}) {}

StateIdentifiers::StateIdentifiers(std::vector<std::vector<Word>> words,
                                   const std::vector<Word>& for_all)
    : StateIdentifiers(std::move(words)) {
  for (const std::vector<Word>& own : own_) {
    rest_.emplace_back();
    for (const Word& word : for_all) {
      if (std::ranges::find(own, word) == own.end()) rest_.back().push_back(word);
    }
  }
}

StateIdentifiers compute_no_words(const Mealy& /*machine*/, Random /*random*/) {
  return StateIdentifiers(std::vector<Word>());
}

StateIdentifiers compute_characterising_words(const Mealy& machine, Random /*random*/) {
  return StateIdentifiers(compute_characterising_set(machine, SeparatingWords(machine)));
}

StateIdentifiers compute_partial_words(const Mealy& machine, Random /*random*/) {
  const SeparatingWords separating(machine);
  const std::vector<Word> for_all = compute_characterising_set(machine, separating);
  const OwnWords own(machine, separating, for_all);
  std::vector<std::vector<Word>> words;
  for (StateId state = 0; state < machine.size(); ++state) words.push_back(own.choose(state));
  return {std::move(words), for_all};
}

StateIdentifiers compute_harmonised_words(const Mealy& machine, Random /*random*/) {
  const SeparatingWords separating(machine);
  std::vector<std::vector<Word>> words(machine.size());
  Partition groups(machine.size());
  std::vector<Partition::Block> open;
  if (machine.size() > 0) open.push_back(0);
  while (!open.empty()) {
    const Partition::Block block = open.back();
    const auto group = groups.elements(block);  // ascending
    const auto other = std::ranges::find_if(
        group, [&](StateId state) { return separating.are_separable(group.front(), state); });
    if (other == group.end()) {
      open.pop_back();
      continue;
    }
    const Word word = *separating.find(group.front(), *other);
    for (const StateId state : group) words[state].push_back(word);
    Partition::Block part =
        groups.split_by(block, [&](StateId state) { return machine.output_word(state, word); });
    MAIDE_CHECK(part < groups.blocks());
    for (; part < groups.blocks(); ++part) open.push_back(part);
  }
  return StateIdentifiers(std::move(words));
}

StateIdentifiers compute_adaptive_words(const Mealy& machine, Random random) {
  return StateIdentifiers(AdaptiveWords(machine, SplittingTree(machine, random)).compute());
}

// Each block of the partition is a leaf of the tree.
class AdaptiveSplitter {
 public:
  AdaptiveSplitter(const Mealy& machine, Random random, SplittingTree& tree)
      : machine_(machine),
        tree_(tree),
        inputs_(machine.inputs().size()),
        partition_(machine.size()) {
    std::iota(inputs_.begin(), inputs_.end(), Symbol{0});
    random.shuffle(inputs_);
  }

  void build() {
    if (machine_.size() == 0) return;
    tree_.leaf_.assign(machine_.size(), 0);
    seen_.assign(machine_.size(), 0);
    tree_.nodes_.emplace_back();
    add_leaf(0);
    examine(0);
    while (true) {
      if (!ready_.empty()) {
        const Task task = ready_.front();
        ready_.pop_front();
        if (!is_leaf(task.leaf)) continue;
        MAIDE_CHECK(count_lost(task.leaf, task.input) == 0);  // it counts in scratch memory
        split(task.leaf, task.input);
      } else if (const auto task = choose_lossy()) {
        ++tree_.invalid_count_;
        split(task->leaf, task->input);
      } else {
        break;
      }
    }
    tree_.class_count_ = partition_.blocks();
  }

 private:
  using NodeId = SplittingTree::NodeId;
  struct Task {
    NodeId leaf;
    Symbol input;
  };
  // A split that loses pairs; the queue gives the largest leaf first, then the fewest pairs.
  struct Lossy {
    std::size_t size;
    std::uint64_t lost;
    NodeId leaf;
    Symbol input;
    std::uint64_t number;  // in the order of discovery
    bool operator<(const Lossy& other) const {
      return std::tuple(size, other.lost, other.number) < std::tuple(other.size, lost, number);
    }
  };

  bool is_leaf(NodeId node) const { return !is_inner_[node]; }
  std::span<const StateId> states(NodeId leaf) const {
    MAIDE_CHECK(is_leaf(leaf));
    return partition_.elements(block_[leaf]);
  }

  // Pairs of the leaf's states that an input makes one without a difference in the answers.
  std::uint64_t count_lost(NodeId leaf, Symbol input) {
    keys_.clear();
    bool all_new = true;
    ++stamp_;
    for (const StateId state : states(leaf)) {
      const StateId target = machine_.target(state, input);
      all_new = all_new && seen_[target] != stamp_;
      seen_[target] = stamp_;
    }
    if (all_new) return 0;
    for (const StateId state : states(leaf)) {
      keys_.push_back(std::uint64_t{machine_.output(state, input)} << 32 |
                      machine_.target(state, input));
    }
    std::ranges::sort(keys_);
    std::uint64_t lost = 0, run = 0;
    for (std::size_t i = 1; i < keys_.size(); ++i) {
      run = keys_[i] == keys_[i - 1] ? run + 1 : 0;
      lost += run;
    }
    return lost;
  }

  bool splits_by_output(NodeId leaf, Symbol input) const {
    const Symbol output = machine_.output(states(leaf).front(), input);
    return std::ranges::any_of(
        states(leaf), [&](StateId state) { return machine_.output(state, input) != output; });
  }

  // The leaf into which all states of this one go, if it is the same.
  std::optional<NodeId> common_target(NodeId leaf, Symbol input) const {
    const NodeId first = tree_.leaf_[machine_.target(states(leaf).front(), input)];
    for (const StateId state : states(leaf)) {
      if (tree_.leaf_[machine_.target(state, input)] != first) return std::nullopt;
    }
    return first;
  }

  // A new leaf: takes a valid split by output if there is one, the one with most parts; keeps the
  // other inputs for later.
  void examine(NodeId leaf) {
    if (states(leaf).size() < 2) return;
    std::size_t most_parts = 0;
    Symbol best = 0;
    for (const Symbol input : inputs_) {
      if (splits_by_output(leaf, input)) {
        const std::uint64_t lost = count_lost(leaf, input);
        if (lost > 0) {
          offer_lossy(leaf, input, lost);
        } else if (const std::size_t parts = count_outputs(leaf, input); parts > most_parts) {
          most_parts = parts;
          best = input;
        }
      } else {
        follow(leaf, input);
      }
    }
    if (most_parts > 0) ready_.push_front({leaf, best});
  }

  std::size_t count_outputs(NodeId leaf, Symbol input) {
    keys_.clear();
    for (const StateId state : states(leaf)) keys_.push_back(machine_.output(state, input));
    std::ranges::sort(keys_);
    return static_cast<std::size_t>(std::unique(keys_.begin(), keys_.end()) - keys_.begin());
  }

  // An input to which all states of the leaf answer alike: it splits if they go to several leaves,
  // and waits if not.
  void follow(NodeId leaf, Symbol input) {
    if (const auto target = common_target(leaf, input)) {
      if (*target != leaf && states(*target).size() > 1) waiting_[*target].push_back({leaf, input});
    } else if (const std::uint64_t lost = count_lost(leaf, input); lost > 0) {
      offer_lossy(leaf, input, lost);
    } else {
      ready_.push_back({leaf, input});
    }
  }

  void offer_lossy(NodeId leaf, Symbol input, std::uint64_t lost) {
    MAIDE_CHECK(lost > 0 && is_leaf(leaf));
    lossy_.push({states(leaf).size(), lost, leaf, input, ++offers_});
  }

  std::optional<Lossy> choose_lossy() {
    while (!lossy_.empty()) {
      const Lossy best = lossy_.top();
      lossy_.pop();
      if (is_leaf(best.leaf)) return best;
    }
    return std::nullopt;
  }

  // The node whose word tells the targets apart, or none where the outputs do.
  NodeId find_next(NodeId leaf, Symbol input) const {
    if (splits_by_output(leaf, input)) return SplittingTree::none;
    NodeId node = tree_.leaf_[machine_.target(states(leaf).front(), input)];
    for (const StateId state : states(leaf)) {
      node = tree_.common_ancestor(node, tree_.leaf_[machine_.target(state, input)]);
    }
    return node;
  }

  // The part that a state goes to: its output, or the child of `next` that its target is below.
  std::uint32_t part_of(StateId state, Symbol input, NodeId next) const {
    if (next == SplittingTree::none) return machine_.output(state, input);
    NodeId node = tree_.leaf_[machine_.target(state, input)];
    while (tree_.nodes_[node].parent != next) {
      node = tree_.nodes_[node].parent;
      MAIDE_CHECK(node != SplittingTree::none && tree_.nodes_[node].depth > 0);
    }
    return node;
  }

  // What belongs to the node that was added last, and is the leaf of a block.
  void add_leaf(Partition::Block block) {
    block_.push_back(block);
    is_inner_.push_back(false);
    waiting_.emplace_back();
    const auto leaf = static_cast<NodeId>(tree_.nodes_.size() - 1);
    for (const StateId state : partition_.elements(block)) tree_.leaf_[state] = leaf;
  }

  void split(NodeId leaf, Symbol input) {
    const NodeId next = find_next(leaf, input);
    MAIDE_CHECK(states(leaf).size() > 1 && (next == SplittingTree::none || is_inner_[next]));
    const Partition::Block block = block_[leaf];
    Partition::Block fresh =
        partition_.split_by(block, [&](StateId state) { return part_of(state, input, next); });
    MAIDE_CHECK(fresh < partition_.blocks());
    tree_.nodes_[leaf].input = input;
    tree_.nodes_[leaf].next = next;
    is_inner_[leaf] = true;
    const auto first_child = static_cast<NodeId>(tree_.nodes_.size());
    const auto add_child = [&](Partition::Block part) {
      tree_.nodes_.push_back({leaf, tree_.nodes_[leaf].depth + 1, 0, SplittingTree::none});
      add_leaf(part);
    };
    add_child(block);
    for (; fresh < partition_.blocks(); ++fresh) add_child(fresh);
    const auto end_child = static_cast<NodeId>(tree_.nodes_.size());
    for (NodeId child = first_child; child < end_child; ++child) examine(child);
    for (const Task& task : std::exchange(waiting_[leaf], {})) {
      if (is_leaf(task.leaf)) follow(task.leaf, task.input);
    }
  }

  const Mealy& machine_;
  SplittingTree& tree_;
  std::vector<Symbol> inputs_;  // in the order of trial
  Partition partition_;
  std::vector<Partition::Block> block_;  // of each leaf
  std::vector<bool> is_inner_;
  std::vector<std::vector<Task>> waiting_;  // for a leaf to be split
  std::deque<Task> ready_;                  // valid splits; those by output come first
  std::priority_queue<Lossy> lossy_;
  std::uint64_t offers_ = 0;
  // Scratch memory.
  std::vector<std::uint64_t> seen_;
  std::uint64_t stamp_ = 0;
  std::vector<std::uint64_t> keys_;
};

SplittingTree::SplittingTree(const Mealy& machine, Random random) {
  AdaptiveSplitter(machine, random, *this).build();
}

SplittingTree::NodeId SplittingTree::common_ancestor(NodeId left, NodeId right) const {
  while (left != right) {
    if (nodes_[left].depth < nodes_[right].depth) std::swap(left, right);
    left = nodes_[left].parent;
  }
  return left;
}

}  // namespace maide
