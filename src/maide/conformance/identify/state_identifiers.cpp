#include "maide/conformance/identify/state_identifiers.hpp"

#include <algorithm>
#include <optional>
#include <unordered_map>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/automata/partition.hpp"
#include "maide/base/invariant.hpp"
#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/identify/splitting_tree.hpp"

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
    std::stable_sort(answers.begin(), answers.end(),
                     [](const auto& left, const auto& right) { return left.first < right.first; });
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
        const auto stay = static_cast<std::size_t>(std::count_if(left.begin(), left.end(), stays));
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
      if (std::find(own.begin(), own.end(), word) == own.end()) rest_.back().push_back(word);
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
    const auto other = std::find_if(group.begin(), group.end(), [&](StateId state) {
      return separating.are_separable(group.front(), state);
    });
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

}  // namespace maide
