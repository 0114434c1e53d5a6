#include "maide/learn/oracle/output_oracle.hpp"

#include <fmt/format.h>

#include <utility>
#include <variant>

#include "maide/base/error.hpp"

namespace maide {

Word OutputOracle::ask(const Word& word, const RunControl& control) {
  const Query query = word;
  MealyAnswer answer = std::move(ask(std::span<const Query>(&query, 1), control).front());
  complete_outputs(answer, word);
  return std::move(answer.outputs);
}

const Word& complete_outputs(const MealyAnswer& answer, const Word& word) {
  if (answer.outputs.size() != word.size()) {
    throw Error(ExitStatus::system_failed,
                fmt::format("the system answered {} of the {} inputs of a word",
                            answer.outputs.size(), word.size()));
  }
  return answer.outputs;
}

const Word& complete_outputs(const MealyAnswer& answer, const Query& query) {
  if (const Word* word = std::get_if<Word>(&query)) return complete_outputs(answer, *word);
  MealyAnswer played;
  const bool is_complete = play_query(query, played, [&](Symbol) -> std::optional<Symbol> {
    const std::size_t place = played.outputs.size();
    if (place == answer.outputs.size()) return std::nullopt;
    return answer.outputs[place];
  });
  if (!is_complete || played.inputs != answer.inputs) {
    throw Error(ExitStatus::system_failed, "the system did not answer a query to its end");
  }
  return answer.outputs;
}

}  // namespace maide
