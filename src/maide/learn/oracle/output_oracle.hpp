// Output queries, the first half of the teacher (Angluin 1987, "minimally adequate teacher").
// Oracles are stacked as decorators that hold references: SulOracle (plays words on a system),
// Cache, counters. All take batches. The answer to query i is element i, whatever runs in parallel
// below. New outputs are numbered in query order. So the same seed gives the same run.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "maide/automata/alphabet.hpp"
#include "maide/base/run_control.hpp"
#include "maide/sul/ia_translator.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

class OutputOracle {
 public:
  virtual ~OutputOracle() = default;

  virtual const Alphabet& inputs() const = 0;
  virtual const Alphabet& outputs() const = 0;  // grows as outputs are seen

  // If the call ends early by an exception, this is told the place and the answer of each query
  // that was answered. So nothing measured is lost.
  using PartialSink = IaTranslator::PartialSink;

  // Answers every query, in their order. Throws Interrupted, WrapperError or NondeterminismError;
  // before it throws, `on_early_end` (unless empty) gets the answers that are there.
  virtual std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                                       const PartialSink& on_early_end = {}) = 0;

  // The symbol of an output that is known from elsewhere (a cache on disk), made known if it is
  // new.
  virtual Symbol intern_output(std::string_view name) = 0;

  // The outputs along `word`; one output query. Throws Error if the word did not complete.
  Word ask(const Word& word, const RunControl& control = {});
};

// The outputs of an answer, one for each input of `word`; throws Error where some are missing
// because the word did not complete.
const Word& complete_outputs(const MealyAnswer& answer, const Word& word);
// The same for any query, which ends where it says so.
const Word& complete_outputs(const MealyAnswer& answer, const Query& query);

// Plays `query` with `step`, a function from an input to its output, or to nothing where it does
// not know. Appends to `answer`; true if the query was played to its end. O(length of the path).
template <typename Step>
bool play_query(const Query& query, MealyAnswer& answer, Step&& step) {
  const auto play_one = [&](Symbol input) {
    const std::optional<Symbol> output = step(input);
    if (output) {
      answer.inputs.push_back(input);
      answer.outputs.push_back(*output);
    }
    return output;
  };
  if (const Word* word = std::get_if<Word>(&query)) {
    answer.inputs.reserve(word->size());
    answer.outputs.reserve(word->size());
    for (const Symbol input : *word) {
      if (!play_one(input)) return false;
    }
    return true;
  }
  const auto& nodes = std::get<DecisionTree>(query).nodes;
  for (std::size_t node = 0; node < nodes.size();) {
    const std::optional<Symbol> output = play_one(nodes[node].input);
    if (!output) return false;
    std::size_t next = nodes.size();
    for (const auto& [branch_output, child] : nodes[node].branches) {
      if (branch_output == *output) next = child;
    }
    node = next;
  }
  return true;
}

// The base of decorators: oracles that stand between another oracle and whoever asks it, and speak
// the same symbols (LearnLib's idea: statistics and limits are decorators). A decorator says what
// it does with a batch.
class OracleDecorator : public OutputOracle {
 public:
  using OutputOracle::ask;
  const Alphabet& inputs() const override { return system_.inputs(); }
  const Alphabet& outputs() const override { return system_.outputs(); }
  Symbol intern_output(std::string_view name) override { return system_.intern_output(name); }

 protected:
  // Keeps a reference to `system`.
  explicit OracleDecorator(OutputOracle& system) : system_(system) {}

  OutputOracle& system_;
};

}  // namespace maide
