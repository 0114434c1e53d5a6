#include "maide/learn/oracle/sul_oracle.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace maide {

const Alphabet& SulOracle::inputs() const {
  return translator_ != nullptr ? translator_->inputs() : machine_.inputs;
}

const Alphabet& SulOracle::outputs() const {
  return translator_ != nullptr ? translator_->outputs() : machine_.outputs;
}

Symbol SulOracle::intern_output(std::string_view name) {
  return translator_ != nullptr ? translator_->intern_output(name) : machine_.outputs.intern(name);
}

std::vector<MealyAnswer> SulOracle::ask(std::span<const Query> batch, const RunControl& control,
                                        const PartialSink& on_early_end) {
  if (translator_ != nullptr) return translator_->run(batch, control, on_early_end);
  std::vector<MealyAnswer> answers;
  answers.reserve(batch.size());
  try {
    for (const Query& query : batch) {
      control.check("running words on the system");
      MealyAnswer answer;
      play_on_machine(query, answer);
      answers.push_back(std::move(answer));
    }
  } catch (...) {
    if (on_early_end) {
      for (std::size_t i = 0; i < answers.size(); ++i) on_early_end(i, answers[i]);
    }
    throw;
  }
  return answers;
}

void SulOracle::play_on_machine(const Query& query, MealyAnswer& answer) {
  using Clock = std::chrono::steady_clock;
  using std::chrono::duration_cast;
  using std::chrono::microseconds;
  const auto start = Clock::now();
  machine_.reset();
  const auto ready = Clock::now();
  play_query(query, answer, [&](Symbol input) -> std::optional<Symbol> {
    return machine_.outputs.intern(machine_.step(machine_.inputs.name(input)));
  });
  answer.reset_duration = answer.reset_wait = duration_cast<microseconds>(ready - start);
  answer.system_duration = duration_cast<microseconds>(Clock::now() - ready);
}

}  // namespace maide
