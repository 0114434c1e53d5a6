#include "maide/learn/oracle/error_outputs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "maide/base/error.hpp"
#include "maide/base/invariant.hpp"

namespace maide {
namespace {

// Whether the text is what the pattern says, in which '*' stands for any characters, or none. Where
// characters differ, the last '*' takes one more. O(text x pattern).
bool matches(std::string_view text, std::string_view pattern) {
  std::size_t place = 0, at = 0;
  std::optional<std::pair<std::size_t, std::size_t>> star;  // behind it, and where it ends in text
  while (place < text.size()) {
    if (at < pattern.size() && pattern[at] == '*') {
      star = {++at, place};
    } else if (at < pattern.size() && pattern[at] == text[place]) {
      ++at;
      ++place;
    } else if (star) {
      at = star->first;
      place = ++star->second;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', at) == std::string_view::npos;
}

}  // namespace

bool ErrorOutputs::contains(std::string_view output) const {
  return std::ranges::any_of(patterns_,
                             [&](const std::string& pattern) { return matches(output, pattern); });
}

bool ErrorOutputCheck::is_error(Symbol output) {
  while (is_error_.size() <= output) {
    const auto next = static_cast<Symbol>(is_error_.size());
    is_error_.push_back(errors_.contains(outputs().name(next)));
  }
  return is_error_[output];
}

std::optional<Symbol> ErrorOutputCheck::rest(Symbol error) const {
  const auto found = rests_.find(error);
  if (found == rests_.end()) return std::nullopt;
  return found->second;
}

void ErrorOutputCheck::check(const MealyAnswer& answer) {
  const auto error =
      std::ranges::find_if(answer.outputs, [&](Symbol output) { return is_error(output); });
  if (error == answer.outputs.end() || error + 1 == answer.outputs.end()) return;
  const Symbol expected = rests_.try_emplace(*error, error[1]).first->second;
  const auto wrong = std::find_if(error + 1, answer.outputs.end(),
                                  [&](Symbol output) { return output != expected; });
  if (wrong == answer.outputs.end()) {
    ++confirmations_;
    return;
  }
  const auto length = static_cast<std::size_t>(wrong - answer.outputs.begin()) + 1;
  throw UsageError(fmt::format(
      "output '{}' does not end the session: \"{}\" was answered \"{}\", but behind '{}' every "
      "input would be answered '{}'",
      outputs().name(*error), to_string(std::span(answer.inputs).first(length), inputs()),
      to_string(std::span(answer.outputs).first(length), outputs()), outputs().name(*error),
      outputs().name(expected)));
}

std::vector<MealyAnswer> ErrorOutputCheck::ask(std::span<const Query> batch,
                                               const RunControl& control,
                                               const PartialSink& on_early_end) {
  std::vector<MealyAnswer> answers = system_.ask(batch, control, on_early_end);
  for (const MealyAnswer& answer : answers) check(answer);
  return answers;
}

// Goes on with `answer` behind the outputs of `known`, as long as the query does: an end of the
// session answers all of it. False if something else is missing.
bool ErrorAwareOracle::play(const Query& query, const MealyAnswer& known, MealyAnswer& answer) {
  std::optional<Symbol> rest;
  bool is_over = false;
  std::size_t place = 0;
  return play_query(query, answer, [&](Symbol) -> std::optional<Symbol> {
    if (is_over) return rest;
    if (place == known.outputs.size()) return std::nullopt;
    const Symbol output = known.outputs[place++];
    is_over = check_.is_error(output);
    if (is_over) rest = check_.rest(output);
    return output;
  });
}

bool ErrorAwareOracle::look_up(const Query& query, MealyAnswer& answer) {
  ObservationTree::Node node = ObservationTree::root;
  std::optional<Symbol> rest;
  bool is_over = false;
  return play_query(query, answer, [&](Symbol input) -> std::optional<Symbol> {
    if (is_over) return rest;
    node = tree_.child(node, input);
    if (node == ObservationTree::none) return std::nullopt;
    const Symbol output = tree_.output(node);
    is_over = check_.is_error(output);
    if (is_over) rest = check_.rest(output);
    return output;
  });
}

void ErrorAwareOracle::keep(const MealyAnswer& answer) {
  for (std::size_t i = 0; i < answer.outputs.size(); ++i) {
    if (!check_.is_error(answer.outputs[i])) continue;
    const ObservationTree::Inserted inserted =
        tree_.insert(std::span(answer.inputs).first(i + 1), std::span(answer.outputs).first(i + 1));
    MAIDE_CHECK(!inserted.conflict);  // a cache below sees to that
    return;
  }
}

// What comes behind error outputs that are new: one input more.
void ErrorAwareOracle::find_rests(std::span<const MealyAnswer> answers, const RunControl& control) {
  for (const MealyAnswer& answer : answers) {
    const auto error = std::ranges::find_if(answer.outputs,
                                            [&](Symbol output) { return check_.is_error(output); });
    if (error == answer.outputs.end() || check_.rest(*error)) continue;
    Word word(answer.inputs.begin(), answer.inputs.begin() + (error - answer.outputs.begin()) + 1);
    word.push_back(0);
    check_.ask(word, control);
    MAIDE_CHECK(check_.rest(*error).has_value());
  }
}

// Without branches of error outputs, and what only these lead to.
Query ErrorAwareOracle::without_ends(const Query& query) {
  const auto* tree = std::get_if<DecisionTree>(&query);
  if (tree == nullptr) return query;
  DecisionTree result;
  std::vector<std::uint32_t> sources{0};  // of each node of `result`, in order
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const DecisionTree::Node& source = tree->nodes[sources[i]];
    DecisionTree::Node node{source.input, {}};
    for (const auto& [output, child] : source.branches) {
      if (check_.is_error(output)) continue;
      node.branches.emplace_back(output, static_cast<std::uint32_t>(sources.size()));
      sources.push_back(child);
    }
    result.nodes.push_back(std::move(node));
  }
  return result;
}

std::vector<MealyAnswer> ErrorAwareOracle::ask(std::span<const Query> batch,
                                               const RunControl& control,
                                               const PartialSink& on_early_end) {
  std::vector<MealyAnswer> answers(batch.size());
  std::vector<std::size_t> places;
  std::vector<Query> unknown;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (look_up(batch[i], answers[i])) continue;
    places.push_back(i);
    unknown.push_back(without_ends(batch[i]));
  }
  if (unknown.empty()) return answers;
  const auto pass_part = [&](std::size_t i, const MealyAnswer& part) {
    MealyAnswer answer;
    if (on_early_end && play(batch[places[i]], part, answer)) on_early_end(places[i], answer);
  };
  std::vector<MealyAnswer> fresh = check_.ask(unknown, control, pass_part);
  for (const MealyAnswer& answer : fresh) keep(answer);
  find_rests(fresh, control);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    MealyAnswer answer;
    const bool is_whole = play(batch[places[i]], fresh[i], answer);
    MAIDE_CHECK(is_whole || fresh[i].outputs.size() < fresh[i].inputs.size());
    fresh[i].inputs = std::move(answer.inputs);
    fresh[i].outputs = std::move(answer.outputs);
    answers[places[i]] = std::move(fresh[i]);
  }
  return answers;
}

std::vector<bool> find_error_outputs(const Mealy& hypothesis, const OutputOracle& oracle) {
  const auto* aware = dynamic_cast<const ErrorAwareOracle*>(&oracle);
  std::vector<bool> is_error;
  if (aware == nullptr) return is_error;
  for (const std::string& name : hypothesis.outputs().names()) {
    const auto output = oracle.outputs().find(name);
    is_error.push_back(output && aware->is_error(*output));
  }
  const bool is_any = std::ranges::find(is_error, true) != is_error.end();
  return is_any ? is_error : std::vector<bool>{};
}

}  // namespace maide
