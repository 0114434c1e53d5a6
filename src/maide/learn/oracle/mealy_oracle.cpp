#include "maide/learn/oracle/mealy_oracle.hpp"

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

namespace {

// Plays words on a machine. Learners ask for words in an order in which many begin as the one
// before: such a word goes on from where they part.
class WordPlayer {
 public:
  explicit WordPlayer(const Mealy& machine) : machine_(machine), states_{machine.initial()} {}

  // Word and answer must stay until the next call.
  void play(const Word& word, MealyAnswer& answer) {
    const std::size_t known = word_ == nullptr ? 0 : count_common(*word_, word);
    answer.inputs = word;
    answer.outputs.reserve(word.size());
    if (known > 0) {
      answer.outputs.assign(outputs_->begin(),
                            outputs_->begin() + static_cast<std::ptrdiff_t>(known));
    }
    states_.resize(known + 1);
    for (std::size_t i = known; i < word.size(); ++i) {
      answer.outputs.push_back(machine_.output(states_.back(), word[i]));
      states_.push_back(machine_.target(states_.back(), word[i]));
    }
    word_ = &word;
    outputs_ = &answer.outputs;
  }

 private:
  const Mealy& machine_;
  const Word* word_ = nullptr;  // the last one
  const Word* outputs_ = nullptr;
  std::vector<StateId> states_;  // along it, one more than it has symbols
};

}  // namespace

std::vector<MealyAnswer> MealyOracle::ask(std::span<const Query> batch, const RunControl& control,
                                          const PartialSink& on_early_end) {
  std::vector<MealyAnswer> answers(batch.size());
  WordPlayer player(machine_);
  for (std::size_t i = 0; i < batch.size(); ++i) {
    if (i % 1024 == 0 && control.should_stop()) {
      if (on_early_end) {
        for (std::size_t done = 0; done < i; ++done) on_early_end(done, answers[done]);
      }
      control.check("answering output queries");
    }
    if (const Word* word = std::get_if<Word>(&batch[i])) {
      player.play(*word, answers[i]);
      continue;
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
