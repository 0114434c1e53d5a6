#include "maide/conformance/method/known_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/base/text.hpp"
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
  return fmt::format("right about {} that earlier models gave", counted(words_.size(), "word"));
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
  std::vector<TraceTree::Node> begins;
  tree_.children(TraceTree::root, begins);
  if (cut_ == 0 || !begins.empty()) return;
  throw UsageError(
      located(fmt::format("no logged trace begins with an input of the system, which has: {}",
                          join(oracle.inputs().names())),
              log));
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
  std::string text = fmt::format("agrees with {}{}", counted(traces_, "logged trace"),
                                 contradictions_.empty() ? "" : " as far as the system does");
  if (cut_ > 0) {
    text += fmt::format(", of {} only up to an input that the system does not have", cut_);
  }
  return text;
}

namespace {

std::vector<bool> find_errors(const Mealy& hypothesis, ErrorOutputCheck& check) {
  std::vector<bool> is_error;
  for (const std::string& name : hypothesis.outputs().names()) {
    const auto output = check.outputs().find(name);
    is_error.push_back(output && check.is_error(*output));
  }
  return is_error;
}

// A word to each transition that ends the session, the nearest first.
std::vector<Word> find_ends(const Mealy& hypothesis, const std::vector<bool>& is_error) {
  std::vector<Word> ends;
  std::vector<bool> is_over(hypothesis.size());
  for (const Word& access : compute_state_cover(hypothesis)) {
    const StateId state = hypothesis.run(access);
    if (!access.empty()) {
      const StateId before = hypothesis.run(head(access, access.size() - 1));
      is_over[state] = is_over[before] || is_error[hypothesis.output(before, access.back())];
    }
    for (Symbol input = 0; input < hypothesis.inputs().size() && !is_over[state]; ++input) {
      if (!is_error[hypothesis.output(state, input)]) continue;
      ends.push_back(access);
      ends.back().push_back(input);
    }
  }
  return ends;
}

}  // namespace

// A shortest word behind an end on which the hypothesis answers something else than the system did.
// The states behind the ends of one error output are looked through together.
std::optional<Word> ErrorOutputTest::find_unlike(const Mealy& hypothesis) {
  const std::vector<bool> is_error = find_errors(hypothesis, check_);
  for (const Word& end : find_ends(hypothesis, is_error)) {
    StateId state = hypothesis.run(head(end, end.size() - 1));
    const Symbol error = hypothesis.output(state, end.back());
    const auto known = check_.outputs().find(hypothesis.outputs().name(error));
    const auto rest = known ? check_.rest(*known) : std::nullopt;
    if (!rest) continue;
    const auto expected = hypothesis.outputs().find(check_.outputs().name(*rest));
    state = hypothesis.target(state, end.back());
    std::vector<Word> reached(hypothesis.size());
    std::vector<StateId> queue{state};
    reached[state] = end;
    for (std::size_t next = 0; next < queue.size(); ++next) {
      for (Symbol input = 0; input < hypothesis.inputs().size(); ++input) {
        const auto [target, output] = hypothesis.row(queue[next])[input];
        Word word = reached[queue[next]];
        word.push_back(input);
        if (!expected || output != *expected) return word;
        if (!reached[target].empty()) continue;
        reached[target] = std::move(word);
        queue.push_back(target);
      }
    }
  }
  return std::nullopt;
}

std::optional<Word> ErrorOutputTest::ask_sample(const Mealy& hypothesis,
                                                const RunControl& control) {
  const std::vector<bool> is_error = find_errors(hypothesis, check_);
  std::vector<Word> words = find_ends(hypothesis, is_error);
  random_.shuffle(words);
  if (words.size() > sampled_words) words.resize(sampled_words);
  std::vector<Symbol> behind(hypothesis.inputs().size());
  std::iota(behind.begin(), behind.end(), Symbol{0});
  for (Word& word : words) {
    random_.shuffle(behind);
    const std::size_t count = std::min(behind.size(), inputs_behind);
    word.insert(word.end(), behind.begin(), behind.begin() + static_cast<std::ptrdiff_t>(count));
  }
  asked_ = words.size();
  // Of the check itself, for which no output ends the session: to their last input.
  return KnownWords(check_, std::move(words)).find_counterexample(hypothesis, control);
}

std::optional<Word> ErrorOutputTest::find_counterexample(const Mealy& hypothesis,
                                                         const RunControl& control) {
  asked_ = 0;
  std::optional<Word> word = find_unlike(hypothesis);
  if (!word) word = tests_.find_counterexample(hypothesis, control);
  if (!word) word = ask_sample(hypothesis, control);
  return word;
}

std::string ErrorOutputTest::guarantee() const {
  return fmt::format(
      "{}; nothing was tested behind the outputs that end a session, but for a sample of {} words",
      tests_.guarantee(), asked_);
}

}  // namespace maide
