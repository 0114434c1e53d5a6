// What the cache knows of a batch of queries. In a large tree each step waits for memory, so steps
// are saved or made to wait together: whichever the batch allows.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/learn/cache/cache.hpp"

namespace maide {

Cache::Lookup Cache::look_up(const Query& query) {
  Lookup result;
  result.is_whole = play_query(query, result.answer, [&](Symbol input) -> std::optional<Symbol> {
    const TraceTree::Node edge = tree_.child(result.node, input);
    if (edge == TraceTree::none) return std::nullopt;
    result.node = behind(result.node, edge);
    tree_.mark(edge);
    return tree_.output(edge);
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
  if (has_refusals_ || 2 * as_before >= symbols) {
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
    MAIDE_CHECK(results[i].answer.outputs.size() <= words[i].size());
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
      const TraceTree::Node edge = tree_.child(node, input);
      if (edge == TraceTree::none) break;
      node = behind(node, edge);
      tree_.mark(edge);
      path.push_back(node);
      outputs.push_back(tree_.output(edge));
    }
    MAIDE_CHECK(path.size() == outputs.size() && outputs.size() <= words[i].size());
    results[i].node = node;
  }
}

// The consistency test of the cache: the equivalence oracle that sends nothing.

// Depth first with the best length so far as the bound: memory is only that of one path, and the
// first word of the least length is the alphabet-least.
class Cache::ConsistencyTest : public EquivalenceOracle {
 public:
  explicit ConsistencyTest(const Cache& cache) : cache_(cache) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control) override {
    if (!(hypothesis.inputs() == cache_.inputs())) {
      throw UsageError("the hypothesis has other inputs than the cache");
    }
    std::vector<Symbol> expected;  // the tree's outputs in the hypothesis' numbering
    for (const std::string& name : cache_.stored_outputs_.names()) {
      expected.push_back(hypothesis.outputs().find(name).value_or(no_symbol));
    }
    struct Frame {
      std::vector<TraceTree::Node> children;
      std::size_t next = 0;
      StateId state;
    };
    std::vector<Frame> path(1);
    path[0].state = hypothesis.initial();
    cache_.tree_.children(TraceTree::root, path[0].children);
    std::size_t depth = 1, bound = ~std::size_t{0};  // frames in use; only shorter words than this
    std::optional<Word> best;
    Word word;
    compared_ = 0;
    while (depth > 0) {
      MAIDE_CHECK(word.size() + 1 == depth);
      Frame& frame = path[depth - 1];
      if (depth >= bound || frame.next == frame.children.size()) {
        --depth;
        if (depth > 0) word.pop_back();
        continue;
      }
      const TraceTree::Node node = frame.children[frame.next++];
      if (!cache_.tree_.is_marked(node)) continue;
      if (++compared_ % 65536 == 0) control.check("testing against the cache");
      const Symbol input = cache_.tree_.input(node);
      word.push_back(input);
      if (hypothesis.output(frame.state, input) != expected[cache_.tree_.output(node)]) {
        best = word;
        bound = word.size();
        word.pop_back();
        continue;
      }
      const StateId state = hypothesis.target(frame.state, input);
      if (path.size() == depth) path.emplace_back();
      path[depth].state = state;
      path[depth].next = 0;
      cache_.tree_.children(node, path[depth].children);
      ++depth;
    }
    return best;
  }

  std::string guarantee() const override {
    return "consistent with all " + std::to_string(compared_) + " observations made";
  }

 private:
  const Cache& cache_;
  std::uint64_t compared_ = 0;
};

std::unique_ptr<EquivalenceOracle> Cache::make_consistency_test() {
  return std::make_unique<ConsistencyTest>(*this);
}

}  // namespace maide
