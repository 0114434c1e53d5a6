#include "maide/conformance/method/test_runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"
#include "maide/base/log.hpp"
#include "maide/learn/oracle/error_outputs.hpp"

namespace maide {
namespace {

// A batch of more inputs is not filled up: of long tests fewer are wasted.
constexpr std::uint64_t batch_symbols = 8192;

constexpr Symbol unknown_output = ~Symbol{0};

// The hypothesis' outputs in the oracle's numbering, matched by name; the oracle's grow.
class OutputMap {
 public:
  OutputMap(const Alphabet& from, const Alphabet& to) : from_(from), to_(to) {}
  void update() {
    if (known_ == to_.size() && !map_.empty()) return;
    known_ = to_.size();
    map_.clear();
    for (const std::string& name : from_.names()) {
      map_.push_back(to_.find(name).value_or(unknown_output));
    }
  }
  Symbol operator[](Symbol output) const { return map_[output]; }

 private:
  const Alphabet& from_;
  const Alphabet& to_;
  std::size_t known_ = 0;
  std::vector<Symbol> map_;
};

// Length of the shortest prefix on which they differ, 0 if none. An answer that ends early differs
// where it ends.
std::size_t find_difference(const Mealy& hypothesis, const Word& word, const MealyAnswer& answer,
                            const OutputMap& map) {
  StateId state = hypothesis.initial();
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (i >= answer.outputs.size()) return i + 1;
    if (map[hypothesis.output(state, word[i])] != answer.outputs[i]) return i + 1;
    state = hypothesis.target(state, word[i]);
  }
  return 0;
}

// Tests end behind an output that ends the session, says the hypothesis: there is nothing to see
// (learn/oracle/error_outputs.hpp). One that ends so as a test before it is none.
class SessionEnds {
 public:
  SessionEnds(const Mealy& hypothesis, const OutputOracle& oracle)
      : hypothesis_(hypothesis), is_error_(find_error_outputs(hypothesis, oracle)) {}

  // False if another test has ended as this one does.
  bool cut(Word& word) {
    if (is_error_.empty()) return true;
    StateId state = hypothesis_.initial();
    for (std::size_t i = 0; i < word.size(); ++i) {
      if (is_error_[hypothesis_.output(state, word[i])]) {
        word.resize(i + 1);
        return seen_.insert(word).second;
      }
      state = hypothesis_.target(state, word[i]);
    }
    return true;
  }

 private:
  const Mealy& hypothesis_;
  std::vector<bool> is_error_;  // by output, or empty
  std::unordered_set<Word, WordHash> seen_;
};

// After so many in a row that are none, an endless suite has no test left.
constexpr std::uint64_t most_left_out = 1'000'000;

// The next test of a suite.
bool next_test(TestSuite& suite, SessionEnds& ends, const RunControl& control, Word& word) {
  for (std::uint64_t left_out = 0; left_out < most_left_out; ++left_out) {
    if (!suite.next(word)) return false;
    if (ends.cut(word)) return true;
    if (left_out % 4096 == 0) control.check("the equivalence test");
  }
  return false;
}

}  // namespace

std::optional<Word> TestRunner::run(TestSuite& suite, const Mealy& hypothesis,
                                    const RunControl& control) {
  if (!(hypothesis.inputs() == oracle_.inputs())) {
    throw UsageError("the model has other inputs than the system");
  }
  last_tests_ = 0;
  last_symbols_ = 0;
  last_was_complete_ = false;
  OutputMap outputs(hypothesis.outputs(), oracle_.outputs());
  SessionEnds ends(hypothesis, oracle_);
  Progress progress;
  progress.phase = options_.phase;
  progress.states = hypothesis.size();
  progress.total = std::min(suite.size().value_or(options_.max_tests), options_.max_tests);
  if (suite.size() && suite.symbols()) {
    const bool is_cut = progress.total < *suite.size();
    log_detail(fmt::format("a suite of {} tests, {} inputs, for {} states{}", *suite.size(),
                           *suite.symbols(), hypothesis.size(),
                           is_cut ? fmt::format("; the first {} are asked", progress.total) : ""));
  }
  std::vector<Query> batch;
  Word word;
  while (last_tests_ < options_.max_tests && last_symbols_ < options_.max_symbols) {
    control.check("the equivalence test");
    batch.clear();
    std::uint64_t symbols = 0;
    while (batch.size() < options_.batch_size && symbols < batch_symbols &&
           last_tests_ + batch.size() < options_.max_tests &&
           last_symbols_ + symbols < options_.max_symbols &&
           next_test(suite, ends, control, word)) {
      symbols += word.size();
      batch.emplace_back(word);
    }
    if (batch.empty()) {
      last_was_complete_ = true;
      return std::nullopt;
    }
    const std::vector<MealyAnswer> answers = oracle_.ask(batch, control);
    MAIDE_CHECK(answers.size() == batch.size());
    outputs.update();
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const Word& test = std::get<Word>(batch[i]);
      ++last_tests_;
      last_symbols_ += test.size();
      if (const std::size_t length = find_difference(hypothesis, test, answers[i], outputs)) {
        MAIDE_CHECK(length <= test.size());
        return options_.whole_words ? test : head(test, length);
      }
    }
    MAIDE_CHECK(last_tests_ <= options_.max_tests);
    progress.done = last_tests_;
    control.report(progress);
  }
  last_was_complete_ = suite.size() == last_tests_;
  return std::nullopt;
}

std::optional<Word> SuiteMethod::run(TestSuite& suite, const Mealy& hypothesis,
                                     const RunControl& control, std::string_view refuter,
                                     const std::function<Passed(std::uint64_t tests)>& passed) {
  guarantee_ = "not tested to the end";
  strength_ = {};
  std::optional<Word> counterexample = runner_.run(suite, hypothesis, control);
  if (counterexample) {
    guarantee_ = fmt::format("refuted by {}", refuter);
  } else {
    Passed result = passed(runner_.last_tests());
    guarantee_ = std::move(result.guarantee);
    strength_ = result.strength;
  }
  return counterexample;
}

std::vector<MachineRunner::Step> MachineRunner::flatten(const Mealy& machine,
                                                        const std::vector<Symbol>& outputs) {
  const auto inputs = static_cast<std::uint32_t>(machine.inputs().size());
  std::vector<Step> steps;
  steps.reserve(machine.size() * inputs);
  for (StateId state = 0; state < machine.size(); ++state) {
    for (Symbol input = 0; input < inputs; ++input) {
      steps.push_back(
          {machine.target(state, input) * inputs, outputs[machine.output(state, input)]});
    }
  }
  return steps;
}

MachineRunner::MachineRunner(const Mealy& system)
    : inputs_(system.inputs()), outputs_(system.outputs()) {
  std::vector<Symbol> same(outputs_.size());
  std::iota(same.begin(), same.end(), Symbol{0});
  system_ = flatten(system, same);
  initial_ = system.initial() * static_cast<std::uint32_t>(inputs_.size());
}

std::optional<Word> MachineRunner::run(TestSuite& suite, const Mealy& hypothesis,
                                       std::uint64_t max_symbols, const RunControl& control) {
  if (!(hypothesis.inputs() == inputs_)) {
    throw UsageError("the model has other inputs than the system");
  }
  std::vector<Symbol> outputs;  // the hypothesis' in the system's numbering; others match none
  for (const std::string& name : hypothesis.outputs().names()) {
    outputs.push_back(outputs_.find(name).value_or(~Symbol{0}));
  }
  const std::vector<Step> expected = flatten(hypothesis, outputs);
  const auto first = hypothesis.initial() * static_cast<std::uint32_t>(inputs_.size());
  Word word;
  for (std::uint64_t played = 0; played < max_symbols && suite.next(word);) {
    if (tests_++ % 4096 == 0) control.check("the equivalence test");
    std::uint32_t here = initial_, there = first;
    for (std::size_t i = 0; i < word.size(); ++i) {
      const Step real = system_[here + word[i]], guess = expected[there + word[i]];
      if (real.output != guess.output) {
        symbols_ += i + 1;
        word.resize(i + 1);
        return word;
      }
      here = real.target;
      there = guess.target;
    }
    played += word.size();
    symbols_ += word.size();
  }
  return std::nullopt;
}

}  // namespace maide
