// The consistency test of the cache: the equivalence oracle that sends nothing.
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/learn/cache.hpp"

namespace maide {

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
