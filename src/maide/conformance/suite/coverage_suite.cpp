#include "maide/conformance/suite/coverage_suite.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"

namespace maide {
namespace {

constexpr std::uint64_t no_transition = std::numeric_limits<std::uint64_t>::max();
constexpr std::size_t most_tree_bytes = 64'000'000;

void check(const CoverageOptions& options) {
  if (options.ways == 0 || options.ways > CoverageOptions::most_ways) {
    throw UsageError(fmt::format("a test that passes {} states or transitions cannot be: 1 to {}",
                                 options.ways, CoverageOptions::most_ways));
  }
  if (options.walks == 0) throw UsageError("no walk behind a state makes no test");
  if (options.walk_length > CoverageOptions::longest_walk) {
    throw UsageError(
        fmt::format("a walk of more than {} inputs is too long", CoverageOptions::longest_walk));
  }
}

// (left + right) modulo `modulus`, both less than that.
std::uint64_t add_modulo(std::uint64_t left, std::uint64_t right, std::uint64_t modulus) {
  return left >= modulus - right ? left - (modulus - right) : left + right;
}

}  // namespace

CoverageSuite::CoverageSuite(const Mealy& hypothesis, CoverageOptions options, Random random)
    : hypothesis_(hypothesis), options_(options), random_(random), trees_(hypothesis.size()) {
  check(options);
  targets_ = options.covered == Covered::states
                 ? hypothesis.size()
                 : std::uint64_t{hypothesis.size()} * hypothesis.inputs().size();
  size_ = options.walks;
  for (std::size_t way = 0; way < options.ways; ++way) size_ = saturating_product(size_, targets_);
  number_ = random_.below(size_);
  do {
    step_ = random_.below(size_);
  } while (std::gcd(step_, size_) != 1);  // gcd(0, 1) is 1
}

bool CoverageSuite::next(Word& word) {
  if (made_ == size_) return false;
  ++made_;
  word.clear();
  StateId state = hypothesis_.initial();
  std::uint64_t rest = number_ / options_.walks;
  number_ = add_modulo(number_, step_, size_);
  const std::size_t inputs = hypothesis_.inputs().size();
  for (std::size_t way = 0; way < options_.ways; ++way) {
    // Numbers that cannot be counted are drawn.
    const std::uint64_t target = size_ == saturated ? random_.below(targets_) : rest % targets_;
    rest /= targets_;
    const bool is_state = options_.covered == Covered::states;
    const auto goal = static_cast<StateId>(is_state ? target : target / inputs);
    if (!append_path(state, goal, word)) break;
    state = goal;
    if (is_state) continue;
    word.push_back(static_cast<Symbol>(target % inputs));
    state = hypothesis_.target(state, word.back());
  }
  for (std::size_t i = 0; i < options_.walk_length; ++i) {
    word.push_back(static_cast<Symbol>(random_.below(inputs)));
  }
  return true;
}

bool CoverageSuite::append_path(StateId from, StateId to, Word& word) {
  if (from == to) return true;
  const Tree& tree = paths_from(from);
  if (tree[to] == no_transition) return false;
  const std::size_t inputs = hypothesis_.inputs().size(), length = word.size();
  for (StateId state = to; state != from; state = static_cast<StateId>(tree[state] / inputs)) {
    word.push_back(static_cast<Symbol>(tree[state] % inputs));
  }
  std::reverse(word.begin() + static_cast<std::ptrdiff_t>(length), word.end());
  return true;
}

// Breadth first.
const CoverageSuite::Tree& CoverageSuite::paths_from(StateId state) {
  if (!trees_[state].empty()) return trees_[state];
  const std::size_t states = hypothesis_.size(), inputs = hypothesis_.inputs().size();
  if ((tree_count_ + 1) * states * sizeof(std::uint64_t) > most_tree_bytes) {
    for (Tree& tree : trees_) Tree().swap(tree);
    tree_count_ = 0;
  }
  ++tree_count_;
  Tree tree(states, no_transition);
  std::vector<StateId> queue{state};
  for (std::size_t place = 0; place < queue.size(); ++place) {
    for (Symbol input = 0; input < inputs; ++input) {
      const StateId target = hypothesis_.target(queue[place], input);
      if (target == state || tree[target] != no_transition) continue;
      tree[target] = std::uint64_t{queue[place]} * inputs + input;
      queue.push_back(target);
    }
  }
  return trees_[state] = std::move(tree);
}

CoverageMethod::CoverageMethod(OutputOracle& oracle, CoverageOptions options,
                               TestRunnerOptions runner, std::uint64_t seed)
    : SuiteMethod(oracle, runner), options_(options), random_(seed) {
  check(options);
}

std::optional<Word> CoverageMethod::find_counterexample(const Mealy& hypothesis,
                                                        const RunControl& control) {
  CoverageSuite suite(hypothesis, options_, random_.split());
  const char* const covered = options_.covered == Covered::states ? "state" : "transition";
  const std::string passed = options_.ways == 1
                                 ? fmt::format("each {}", covered)
                                 : fmt::format("each {} {}s in each order", options_.ways, covered);
  const std::uint64_t size = *suite.size();
  return run(suite, hypothesis, control, "a test of those for " + passed,
             [&](std::uint64_t tests) -> Passed {
               if (tests == size)
                 return {fmt::format("not refuted by {} tests for {}", size, passed)};
               const std::string all = size == saturated ? "more than 2^64" : std::to_string(size);
               return {fmt::format("not refuted by {} of {} tests for {}", tests, all, passed)};
             });
}

}  // namespace maide
