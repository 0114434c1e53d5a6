#include "maide/learn/mealy_oracle.hpp"

namespace maide {

std::vector<MealyAnswer> MealyOracle::ask(std::span<const Query> batch, const RunControl& control,
                                          const PartialSink& on_early_end) {
  std::vector<MealyAnswer> answers(batch.size());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (i % 1024 == 0 && control.should_stop()) {
      if (on_early_end) {
        for (std::size_t done = 0; done < i; ++done) on_early_end(done, answers[done]);
      }
      control.check("answering output queries");
    }
    StateId state = machine_.initial();
    play_query(batch[i], answers[i], [&](Symbol input) -> std::optional<Symbol> {
      const Symbol output = machine_.output(state, input);
      state = machine_.target(state, input);
      return output;
    });
  }
  return answers;
}

}  // namespace maide
