#include "maide/conformance/method/error_output_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "maide/conformance/identify/separating_words.hpp"
#include "maide/conformance/method/known_words.hpp"

namespace maide {
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
