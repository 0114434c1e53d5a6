#include "maide/conformance/method/known_words.hpp"

#include <fmt/format.h>

#include <span>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/suite/test_suite.hpp"
#include "maide/learn/counterexample.hpp"

namespace maide {
namespace {

class ListedSuite : public TestSuite {
 public:
  explicit ListedSuite(const std::vector<Word>& words) : words_(words) {}
  bool next(Word& word) override {
    if (next_ == words_.size()) return false;
    word = words_[next_++];
    return true;
  }
  std::optional<std::uint64_t> size() const override { return words_.size(); }

 private:
  const std::vector<Word>& words_;
  std::size_t next_ = 0;
};

}  // namespace

std::optional<Word> KnownWords::find_counterexample(const Mealy& hypothesis,
                                                    const RunControl& control) {
  ListedSuite suite(words_);
  return runner_.run(suite, hypothesis, control);
}

std::string KnownWords::guarantee() const {
  return fmt::format("right about {} word{} that earlier models gave", words_.size(),
                     words_.size() == 1 ? "" : "s");
}

std::vector<Word> choose_confirmation_words(const Mealy& model, std::uint64_t seed,
                                            std::uint64_t most_symbols) {
  Random random(seed);
  std::vector<Word> suffixes = compute_characterising_set(model, SeparatingWords(model));
  if (suffixes.empty()) suffixes.emplace_back();
  std::vector<Word> words;
  for (const Word& access : compute_state_cover(model)) {
    for (const Word& suffix : suffixes) words.push_back(joined(access, suffix));
    for (Symbol input = 0; input < model.inputs().size(); ++input) {
      words.push_back(joined(joined(access, {input}), suffixes[random.below(suffixes.size())]));
    }
  }
  words = without_prefixes(std::move(words));
  std::erase(words, Word());
  random.shuffle(words);
  std::uint64_t symbols = 0;
  std::size_t taken = 0;
  while (taken < words.size()) {
    symbols += words[taken].size();
    if (taken > 0 && symbols > most_symbols) break;
    ++taken;
  }
  words.resize(taken);
  return words;
}

LoggedTraces::LoggedTraces(OutputOracle& oracle, const TraceLog& log)
    : oracle_(oracle), outputs_(log.outputs), traces_(log.traces.size()) {
  for (const TraceLog::Trace& trace : log.traces) insert(log, trace);
}

void LoggedTraces::insert(const TraceLog& log, const TraceLog::Trace& trace) {
  TraceTree::Node node = TraceTree::root;
  for (std::size_t i = 0; i < trace.inputs.size(); ++i) {
    const auto input = oracle_.inputs().find(log.inputs.name(trace.inputs[i]));
    if (!input) {
      ++cut_;
      return;
    }
    const TraceTree::Node child = tree_.child(node, *input);
    if (child == TraceTree::none) {
      node = tree_.add_child(node, *input, trace.outputs[i]);
    } else if (tree_.output(child) == trace.outputs[i]) {
      node = child;
    } else {
      throw UsageError(
          located(fmt::format("the log contradicts itself: \"{}\" ends in '{}' and in '{}'",
                              to_string(std::span(trace.inputs).first(i + 1), log.inputs),
                              outputs_.name(tree_.output(child)), outputs_.name(trace.outputs[i])),
                  log));
    }
  }
}

// Asks the system about a word whose last output is not the hypothesis': a counterexample, or
// nothing, and the log is corrected at `node`, where the word ends.
std::optional<Word> LoggedTraces::settle(const Mealy& hypothesis, const Word& word,
                                         TraceTree::Node node, const RunControl& control) {
  const Word outputs = oracle_.ask(word, control);
  if (const std::size_t length = first_mismatch(hypothesis, word, outputs); length != 0) {
    return head(word, length);
  }
  const std::string& answered = oracle_.outputs().name(outputs.back());
  contradictions_.push_back(
      {to_string(word, oracle_.inputs()), outputs_.name(tree_.output(node)), answered});
  tree_.correct(node, outputs_.intern(answered));
  if (contradictions_.size() == most_contradictions) tree_ = TraceTree();
  return std::nullopt;
}

std::optional<Word> LoggedTraces::find_counterexample(const Mealy& hypothesis,
                                                      const RunControl& control) {
  std::vector<Symbol> logged;  // the log's number of each output of the hypothesis
  for (const std::string& name : hypothesis.outputs().names()) {
    logged.push_back(outputs_.find(name).value_or(~Symbol{0}));
  }
  std::vector<Place> queue{{TraceTree::root, hypothesis.initial(), 0}};
  std::vector<TraceTree::Node> children;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    if (next % 4096 == 0) control.check("comparing with the log");
    const StateId state = queue[next].state;
    tree_.children(queue[next].node, children);
    for (const TraceTree::Node child : children) {
      const Symbol input = tree_.input(child);
      if (logged[hypothesis.output(state, input)] != tree_.output(child)) {
        Word word{input};
        for (std::size_t at = next; at != 0; at = queue[at].parent) {
          word.push_back(tree_.input(queue[at].node));
        }
        auto found = settle(hypothesis, Word(word.rbegin(), word.rend()), child, control);
        if (found || contradictions_.size() >= most_contradictions) return found;
      }
      queue.push_back({child, hypothesis.target(state, input), next});
    }
  }
  return std::nullopt;
}

std::string LoggedTraces::guarantee() const {
  if (contradictions_.size() >= most_contradictions) return "the log was given up";
  return fmt::format("agrees with {} logged trace{}{}", traces_, traces_ == 1 ? "" : "s",
                     contradictions_.empty() ? "" : " as far as the system does");
}

}  // namespace maide
