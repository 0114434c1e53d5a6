#include "maide/sul/fatal_words.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "maide/sul/query_player.hpp"

namespace maide {
namespace {

constexpr const char* crash_output = "crash";
constexpr const char* hang_output = "hang";

// A step that has this output in a Mealy machine.
SulStep step_of(const std::string& output) {
  SulStep step;
  if (output == "refused") {
    step.status = StepStatus::refused;
  } else if (output == "unexplored") {
    step.status = StepStatus::unexplored;
  } else if (output == "absorbed") {
    step.status = StepStatus::absorbed;
  } else if (output != "quiet" && output != "+") {
    step.events = {{0, output}};
  }
  return step;
}

// Where the word that these outputs answer ends the system; the length of the word if nowhere.
// Under av the output comes behind the input, when Delta takes it from the queue.
std::size_t find_fatal_step(const Word& inputs, const std::vector<std::string>& outputs,
                            Symbol delta, Translation translation) {
  const auto end = std::ranges::find_if(outputs, is_end_output);
  auto place = static_cast<std::size_t>(end - outputs.begin());
  if (end == outputs.end() || translation == Translation::eager) return place;
  while (place > 0 && (inputs[place] == delta || outputs[place] == "refused")) --place;
  return place;
}

}  // namespace

bool is_end_output(std::string_view name) { return name == crash_output || name == hang_output; }

bool is_fatal(WordEnd end) { return end == WordEnd::crash || end == WordEnd::hang; }

void mark_fatal_step(SulAnswer& answer, const SulInfo& info) {
  SulStep& step = answer.steps.back();
  step.status = StepStatus::taken;
  step.busy.clear();
  const Symbol input = answer.inputs.back();
  const std::uint32_t actor = input < info.inputs.size() ? info.inputs[input].actor : 0;
  step.events = {{actor, answer.end == WordEnd::hang ? hang_output : crash_output}};
}

void answer_rest(SulAnswer& answer, const SulQuery& query, const SulInfo& info) {
  if (!is_fatal(answer.end) || answer.steps.empty()) return;
  std::vector<Event> due;
  if (query.translation == Translation::av) due = std::exchange(answer.steps.back().events, {});
  QueryCursor cursor(query);
  for (const SulStep& step : answer.steps) cursor.advance(step);
  while (const std::optional<Symbol> input = cursor.input()) {
    SulStep step;
    step.status = StepStatus::refused;
    if (query.translation == Translation::av && *input == info.inputs.size()) {
      step.status = StepStatus::delta;
      step.events = std::exchange(due, {});
    }
    cursor.advance(step);
    answer.inputs.push_back(*input);
    answer.steps.push_back(std::move(step));
  }
}

void FatalWords::add(const SulAnswer& answer, Translation translation) {
  if (!is_fatal(answer.end) || answer.steps.empty()) return;
  const auto which = static_cast<std::size_t>(translation);
  auto& tree = trees_[which];
  if (tree.empty()) tree.emplace_back();
  std::uint32_t node = 0;
  for (std::size_t i = 0; i < answer.steps.size(); ++i) {
    const auto next = static_cast<std::uint32_t>(tree.size());
    const auto [child, is_new] = tree[node].children.emplace(answer.inputs[i], next);
    node = child->second;
    if (is_new) tree.emplace_back().step = answer.steps[i];
  }
  if (tree[node].listed) return;
  tree[node].listed = static_cast<std::uint32_t>(lists_[which].size());
  Word word(answer.inputs.begin(),
            answer.inputs.begin() + static_cast<std::ptrdiff_t>(answer.steps.size()));
  lists_[which].push_back({std::move(word), answer.end, answer.reason});
}

void FatalWords::add(const Word& inputs, const std::vector<std::string>& outputs,
                     const SulInfo& info, Translation translation) {
  const auto delta = static_cast<Symbol>(info.inputs.size());
  const std::size_t fatal = find_fatal_step(inputs, outputs, delta, translation);
  if (fatal >= outputs.size()) return;
  SulAnswer answer;
  const bool hangs = std::ranges::find(outputs, hang_output) != outputs.end();
  answer.end = hangs ? WordEnd::hang : WordEnd::crash;
  for (std::size_t i = 0; i <= fatal; ++i) {
    answer.inputs.push_back(inputs[i]);
    SulStep& step = answer.steps.emplace_back(step_of(outputs[i]));
    if (inputs[i] != delta) continue;
    step.status = StepStatus::delta;
    if (outputs[i] == "delta") step.events.clear();
  }
  mark_fatal_step(answer, info);
  add(answer, translation);
}

void FatalWords::mark_asked(const SulQuery& query) {
  const Word* word = std::get_if<Word>(&query.inputs);
  if (word != nullptr) asked_[static_cast<std::size_t>(query.translation)].insert(*word);
}

std::optional<SulAnswer> FatalWords::find(const SulQuery& query) {
  const auto which = static_cast<std::size_t>(query.translation);
  const auto& tree = trees_[which];
  if (tree.empty()) return std::nullopt;
  const Word* word = std::get_if<Word>(&query.inputs);
  if (word != nullptr && asked_[which].contains(*word)) return std::nullopt;
  SulAnswer answer;
  answer.attempts = 0;
  QueryCursor cursor(query);
  std::uint32_t node = 0;
  while (const std::optional<Symbol> input = cursor.input()) {
    const auto child = tree[node].children.find(*input);
    if (child == tree[node].children.end()) return std::nullopt;
    node = child->second;
    cursor.advance(tree[node].step);
    answer.inputs.push_back(*input);
    answer.steps.push_back(tree[node].step);
    answer.steps.back().duration = answer.steps.back().settling = {};
    if (!tree[node].listed) continue;
    const FatalWord& known = lists_[which][*tree[node].listed];
    answer.end = known.end;
    answer.reason = known.reason;
    mark_asked(query);
    return answer;
  }
  return std::nullopt;
}

}  // namespace maide
