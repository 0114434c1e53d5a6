// A walk through a query along the answers: which input is due next. The one place that knows how a
// decision tree branches; for a word the answers do not matter.
#pragma once

#include <cstddef>
#include <optional>

#include "maide/sul/query.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

class QueryCursor {
 public:
  // Keeps a reference to `query`.
  explicit QueryCursor(const SulQuery& query) : query_(query) {}

  // The input to be given now; nothing at the end of the query.
  std::optional<Symbol> input() const;
  // That input was answered by `step`. Not after the end.
  void advance(const SulStep& step);

 private:
  const SulQuery& query_;
  std::size_t place_ = 0;  // in the word, or the tree's node
};

}  // namespace maide
