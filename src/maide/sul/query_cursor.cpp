#include "maide/sul/query_cursor.hpp"

#include <string>
#include <variant>

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
  std::size_t next = nodes.size();
  for (const auto& [branch, target] : nodes[place_].branches) {
    if (branch == output) next = target;
  }
  place_ = next;
}

}  // namespace maide
