// What the cache knows of a batch of queries. In a large tree each step waits for memory, so steps
// are saved or made to wait together: whichever the batch allows.
#include <algorithm>
#include <span>
#include <vector>

#include "maide/automata/words.hpp"
#include "maide/learn/cache.hpp"

namespace maide {

Cache::Lookup Cache::look_up(const Query& query) {
  Lookup result;
  result.is_whole = play_query(query, result.answer, [&](Symbol input) -> std::optional<Symbol> {
    const TraceTree::Node next = tree_.child(result.node, input);
    if (next == TraceTree::none) return std::nullopt;
    result.node = next;
    tree_.mark(next);
    return tree_.output(next);
  });
  return result;
}

std::vector<Cache::Lookup> Cache::look_up_all(std::span<const Query> batch) {
  std::vector<Lookup> results(batch.size());
  std::vector<std::span<const Symbol>> words(batch.size());  // empty for trees
  std::size_t symbols = 0, as_before = 0;  // of all words; those that begin as the word before them
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Word* const word = std::get_if<Word>(&batch[i]);
    if (word == nullptr) continue;
    words[i] = *word;
    results[i].answer.outputs.reserve(word->size());
    symbols += word->size();
    if (i > 0) as_before += count_common(words[i - 1], words[i]);
  }
  if (2 * as_before >= symbols) {
    follow_in_turn(words, results);
  } else {
    tree_.walk_together(words, [&](std::size_t i, TraceTree::Node node) {
      results[i].node = node;
      results[i].answer.outputs.push_back(tree_.output(node));
      tree_.mark(node);
    });
  }
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (std::holds_alternative<DecisionTree>(batch[i])) {
      results[i] = look_up(batch[i]);
      continue;
    }
    results[i].is_whole = results[i].answer.outputs.size() == words[i].size();
    if (results[i].is_whole) results[i].answer.inputs = std::get<Word>(batch[i]);
  }
  return results;
}

// One word after the other, each from where it parts from the one before: what a learner asks of a
// state begins with that state's access word.
void Cache::follow_in_turn(std::span<const std::span<const Symbol>> words,
                           std::vector<Lookup>& results) {
  std::vector<TraceTree::Node> path;  // of the word before, as far as the tree knows it
  for (std::size_t i = 0; i < words.size(); ++i) {
    Word& outputs = results[i].answer.outputs;
    const std::size_t common =
        i > 0 ? std::min(count_common(words[i - 1], words[i]), path.size()) : 0;
    path.resize(common);
    if (common > 0) {
      const Word& before = results[i - 1].answer.outputs;
      outputs.assign(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(common));
    }
    TraceTree::Node node = common > 0 ? path.back() : TraceTree::root;
    for (const Symbol input : words[i].subspan(common)) {
      const TraceTree::Node child = tree_.child(node, input);
      if (child == TraceTree::none) break;
      node = child;
      tree_.mark(node);
      path.push_back(node);
      outputs.push_back(tree_.output(node));
    }
    results[i].node = node;
  }
}

}  // namespace maide
