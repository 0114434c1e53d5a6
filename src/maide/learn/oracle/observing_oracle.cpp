#include "maide/learn/oracle/observing_oracle.hpp"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace maide {

bool ObservingOracle::look_up(const Query& query, MealyAnswer& answer) const {
  ObservationTree::Node node = ObservationTree::root;
  return play_query(query, answer, [&](Symbol input) -> std::optional<Symbol> {
    node = tree_.child(node, input);
    if (node == ObservationTree::none) return std::nullopt;
    return tree_.output(node);
  });
}

void ObservingOracle::keep(const MealyAnswer& answer) {
  const ObservationTree::Inserted inserted = tree_.insert(answer.inputs, answer.outputs);
  if (inserted.conflict) throw contradiction(tree_, answer, inserted.known, system_);
}

std::vector<MealyAnswer> ObservingOracle::ask(std::span<const Query> batch,
                                              const RunControl& control,
                                              const PartialSink& on_early_end) {
  std::vector<MealyAnswer> answers(batch.size());
  std::vector<std::size_t> places;
  std::vector<Query> unknown;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (look_up(batch[i], answers[i])) continue;
    places.push_back(i);
    unknown.push_back(batch[i]);
  }
  if (unknown.empty()) return answers;
  const auto keep_part = [&](std::size_t i, const MealyAnswer& answer) {
    tree_.insert(answer.inputs, answer.outputs);
    ++output_queries_;
    if (on_early_end) on_early_end(places[i], answer);
  };
  std::vector<MealyAnswer> fresh = system_.ask(unknown, control, keep_part);
  output_queries_ += fresh.size();
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    keep(fresh[i]);
    answers[places[i]] = std::move(fresh[i]);
  }
  return answers;
}

NondeterminismError contradiction(const ObservationTree& tree, const MealyAnswer& answer,
                                  std::size_t place, const OutputOracle& oracle) {
  const auto wrong = std::span(answer.inputs).first(place + 1);
  Word before;
  for (std::size_t length = 1; length <= wrong.size(); ++length) {
    before.push_back(tree.output(tree.find(ObservationTree::root, wrong.first(length))));
  }
  return {to_string(wrong, oracle.inputs()), to_string(before, oracle.outputs()),
          to_string(std::span(answer.outputs).first(wrong.size()), oracle.outputs())};
}

void CountingOracle::count(const MealyAnswer& answer) {
  QueryCounts& counts = statistics_.at(phase_);
  if (answer.attempts > 0) ++counts.queries;  // else known to end in a crash: it was not run
  counts.symbols += answer.inputs.size() * std::uint64_t{answer.attempts};
  counts.resets += answer.attempts;
  counts.in_reset += answer.reset_duration;
  counts.in_reset_wait += answer.reset_wait;
  counts.in_system += answer.system_duration;
  counts.in_settling += answer.settling;
}

namespace {

// Adds the time that it lives.
class Clocked {
 public:
  explicit Clocked(std::chrono::microseconds& total) : total_(total) {}
  ~Clocked() {
    total_ += std::chrono::duration_cast<std::chrono::microseconds>(
        std::chrono::steady_clock::now() - start_);
  }
  Clocked(const Clocked&) = delete;
  Clocked& operator=(const Clocked&) = delete;

 private:
  std::chrono::microseconds& total_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

std::vector<MealyAnswer> CountingOracle::ask(std::span<const Query> batch,
                                             const RunControl& control,
                                             const PartialSink& on_early_end) {
  const Clocked clocked(statistics_.at(phase_).asking);
  std::vector<MealyAnswer> answers =
      system_.ask(batch, control, [&](std::size_t index, const MealyAnswer& answer) {
        count(answer);
        if (on_early_end) on_early_end(index, answer);
      });
  for (const MealyAnswer& answer : answers) count(answer);
  return answers;
}

std::optional<Word> PhasedTeacher::find_counterexample(const Mealy& hypothesis,
                                                       const RunControl& control) {
  counter_.set_phase(LearnPhase::testing);
  std::optional<Word> counterexample = teacher_.find_counterexample(hypothesis, control);
  counter_.set_phase(LearnPhase::refinement);
  return counterexample;
}

}  // namespace maide
