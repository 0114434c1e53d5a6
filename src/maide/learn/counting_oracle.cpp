#include "maide/learn/counting_oracle.hpp"

namespace maide {

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
