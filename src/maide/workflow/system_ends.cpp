#include "maide/workflow/system_ends.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <tuple>
#include <utility>

#include "maide/base/join.hpp"
#include "maide/sul/fatal_words.hpp"

namespace maide {
namespace {

// The shortest words of inputs to the states, breadth first; outputs on the way count for nothing.
std::vector<std::optional<std::vector<std::string>>> access_words(
    const InterfaceAutomaton& automaton) {
  std::vector<std::optional<std::vector<std::string>>> words(automaton.size());
  std::deque<std::pair<StateId, std::vector<std::string>>> work;
  work.emplace_back(automaton.initial(), std::vector<std::string>());
  while (!work.empty()) {
    const auto [state, word] = std::move(work.front());
    work.pop_front();
    if (words[state]) continue;
    words[state] = word;
    for (const auto& transition : automaton.transitions(state)) {
      if (!transition.action.is_input()) {
        work.emplace_front(transition.target, word);
        continue;
      }
      work.emplace_back(transition.target, word);
      work.back().second.push_back(automaton.inputs().name(transition.action.symbol));
    }
  }
  return words;
}

// The output by which the system ends in `state`, or "".
std::string end_due(const InterfaceAutomaton& automaton, StateId state) {
  for (const auto& transition : automaton.transitions(state)) {
    if (transition.action.is_input()) continue;
    const std::string& output = automaton.outputs().name(transition.action.symbol);
    if (is_end_output(output)) return output;
  }
  return "";
}

std::string reason_of(const SystemEnd& end, const IaTranslator& translator) {
  const FatalWord* best = nullptr;
  for (const FatalWord& known : translator.fatal_words()) {
    if ((known.end == WordEnd::hang) != (end.output == "hang") || known.reason.empty()) continue;
    std::vector<std::string> word;
    for (const Symbol input : known.inputs) {
      if (input < translator.info().inputs.size()) {
        word.push_back(translator.info().inputs[input].name);
      }
    }
    if (word == end.word) return known.reason;
    const bool is_alike = word.back() == end.word.back();
    if (is_alike && (best == nullptr || known.inputs.size() < best->inputs.size())) best = &known;
  }
  return best == nullptr ? "" : best->reason;
}

}  // namespace

std::vector<SystemEnd> find_system_ends(const InterfaceAutomaton& automaton,
                                        const IaTranslator& translator) {
  std::vector<SystemEnd> ends;
  const auto words = access_words(automaton);
  for (StateId state = 0; state < automaton.size(); ++state) {
    for (const auto& transition : automaton.transitions(state)) {
      if (!transition.action.is_input() || !words[state]) continue;
      const std::string output = end_due(automaton, transition.target);
      if (output.empty()) continue;
      std::vector<std::string> word = *words[state];
      word.push_back(automaton.inputs().name(transition.action.symbol));
      const auto known = std::find_if(ends.begin(), ends.end(), [&](const SystemEnd& end) {
        return end.output == output && end.word.back() == word.back();
      });
      if (known == ends.end()) {
        ends.push_back({output, std::move(word), 1, ""});
        continue;
      }
      ++known->states;
      if (std::pair(word.size(), word) < std::pair(known->word.size(), known->word)) {
        known->word = std::move(word);
      }
    }
  }
  std::sort(ends.begin(), ends.end(), [](const SystemEnd& left, const SystemEnd& right) {
    return std::tuple(left.word.size(), left.word, left.output) <
           std::tuple(right.word.size(), right.word, right.output);
  });
  for (SystemEnd& end : ends) end.reason = reason_of(end, translator);
  return ends;
}

std::string to_string(const SystemEnd& end) {
  std::string text = end.output + ": " + join(end.word, " ");
  if (!end.reason.empty()) text += " (" + end.reason + ")";
  return text;
}

std::string to_string(std::span<const SystemEnd> ends) {
  std::string text;
  for (const SystemEnd& end : ends) text += (text.empty() ? "" : "; ") + to_string(end);
  return text;
}

}  // namespace maide
