#include "maide/sul/query_player.hpp"

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "maide/base/invariant.hpp"
#include "maide/sul/fatal_words.hpp"

namespace maide {

std::optional<Symbol> QueryCursor::input() const {
  if (const Word* word = std::get_if<Word>(&query_.inputs)) {
    return place_ < word->size() ? std::optional((*word)[place_]) : std::nullopt;
  }
  const auto& nodes = std::get<BasicDecisionTree<std::string>>(query_.inputs).nodes;
  return place_ < nodes.size() ? std::optional(nodes[place_].input) : std::nullopt;
}

void QueryCursor::advance(const SulStep& step) {
  if (std::holds_alternative<Word>(query_.inputs)) {
    ++place_;
    return;
  }
  const auto& nodes = std::get<BasicDecisionTree<std::string>>(query_.inputs).nodes;
  const std::string output = mealy_output(step, query_.translation);
  MAIDE_CHECK(place_ < nodes.size());
  std::size_t next = nodes.size();
  for (const auto& [branch, target] : nodes[place_].branches) {
    if (branch == output) next = target;
  }
  place_ = next;
}

namespace {

// The state of one word: monitors of the purposes and the av translation's queue.
class Player {
 public:
  Player(SteppedSystem& system, const SulInfo& info, std::span<const LearningPurpose> purposes,
         Translation translation)
      : system_(system), info_(info), purposes_(purposes), translation_(translation) {
    for (const LearningPurpose& purpose : purposes) monitors_.emplace_back(purpose);
  }

  SteppedSystem::Outcome play_step(Symbol input, SulStep& step) {
    if (translation_ == Translation::av && input == info_.inputs.size()) {
      step.status = StepStatus::delta;
      take_due_output(step);
      return SteppedSystem::Outcome::quiescent;
    }
    if (!due_.empty() || system_.is_busy(input)) {
      step.status = StepStatus::refused;
      return SteppedSystem::Outcome::quiescent;
    }
    const std::string& name = info_.inputs[input].name;
    for (std::size_t i = 0; i < monitors_.size(); ++i) {
      if (monitors_[i].allows(name)) continue;
      step.status = purposes_[i].at_bound() == AtBound::absorb ? StepStatus::absorbed
                                                               : StepStatus::unexplored;
      return SteppedSystem::Outcome::quiescent;
    }
    const SteppedSystem::Outcome outcome = system_.take(input, step);
    if (step.status != StepStatus::taken) return outcome;  // a simulated refusal
    if (step.events.size() > 1) std::ranges::stable_sort(step.events, {}, &Event::actor);
    for (LearningPurpose::Monitor& monitor : monitors_) monitor.on_input(name);
    if (translation_ == Translation::av) {
      due_.assign(step.events.begin(), step.events.end());
      step.events.clear();
    } else {
      for (const Event& event : step.events) observe(event);
    }
    return outcome;
  }

 private:
  void take_due_output(SulStep& step) {
    if (due_.empty()) return;
    observe(due_.front());
    MAIDE_CHECK(translation_ == Translation::av && step.events.empty());
    step.events.push_back(std::move(due_.front()));
    due_.pop_front();
  }
  void observe(const Event& event) {
    for (LearningPurpose::Monitor& monitor : monitors_) monitor.on_output(event.output);
  }

  SteppedSystem& system_;
  const SulInfo& info_;
  std::span<const LearningPurpose> purposes_;
  Translation translation_;
  std::vector<LearningPurpose::Monitor> monitors_;
  std::deque<Event> due_;
};

WordEnd word_end(SteppedSystem::Outcome outcome) {
  switch (outcome) {
    case SteppedSystem::Outcome::crash: return WordEnd::crash;
    case SteppedSystem::Outcome::hang: return WordEnd::hang;
    case SteppedSystem::Outcome::aborted: return WordEnd::aborted;
    case SteppedSystem::Outcome::quiescent: break;
  }
  return WordEnd::complete;
}

}  // namespace

SulAnswer play(SteppedSystem& system, const SulQuery& query, const SulInfo& info,
               std::span<const LearningPurpose> purposes, const StepObserver& on_step) {
  SulAnswer answer;
  Player player(system, info, purposes, query.translation);
  QueryCursor cursor(query);
  if (const Word* word = std::get_if<Word>(&query.inputs)) {
    answer.inputs.reserve(word->size());
    answer.steps.reserve(word->size());
  }
  while (const std::optional<Symbol> input = cursor.input()) {
    answer.inputs.push_back(*input);
    SulStep& step = answer.steps.emplace_back();
    answer.end = word_end(player.play_step(*input, step));
    if (answer.end != WordEnd::complete) break;
    if (on_step) on_step(step);
    cursor.advance(step);
  }
  MAIDE_CHECK(answer.inputs.size() == answer.steps.size());
  if (is_fatal(answer.end)) mark_fatal_step(answer, info);
  return answer;
}

}  // namespace maide
