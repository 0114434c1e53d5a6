#include "maide/learn/cache/cache_consistency.hpp"

#include <cstddef>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"

namespace maide {

// Depth first with the best length so far as the bound: memory is only that of one path, and the
// first word of the least length is the alphabet-least.
std::optional<Word> CacheConsistencyTest::find_counterexample(const Mealy& hypothesis,
                                                              const RunControl& control) {
  constexpr Symbol none = ~Symbol{0};
  if (!(hypothesis.inputs() == known_.inputs())) {
    throw UsageError("the hypothesis has other inputs than the cache");
  }
  std::vector<Symbol> expected;  // the tree's outputs in the hypothesis' numbering
  for (const std::string& name : known_.outputs().names()) {
    expected.push_back(hypothesis.outputs().find(name).value_or(none));
  }
  struct Frame {
    std::vector<TraceTree::Node> children;
    std::size_t next = 0;
    StateId state;
  };
  std::vector<Frame> path(1);
  path[0].state = hypothesis.initial();
  known_.tree().children(TraceTree::root, path[0].children);
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
    if (!known_.tree().is_marked(node)) continue;
    if (++compared_ % 65536 == 0) control.check("testing against the cache");
    const Symbol input = known_.tree().input(node);
    word.push_back(input);
    if (hypothesis.output(frame.state, input) != expected[known_.tree().output(node)]) {
      best = word;
      bound = word.size();
      word.pop_back();
      continue;
    }
    const StateId state = hypothesis.target(frame.state, input);
    if (path.size() == depth) path.emplace_back();
    path[depth].state = state;
    path[depth].next = 0;
    known_.tree().children(node, path[depth].children);
    ++depth;
  }
  return best;
}

std::string CacheConsistencyTest::guarantee() const {
  return "consistent with all " + std::to_string(compared_) + " observations made";
}

}  // namespace maide
