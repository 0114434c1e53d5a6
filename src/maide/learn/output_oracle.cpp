#include "maide/learn/output_oracle.hpp"

#include <utility>

namespace maide {

Word OutputOracle::ask(const Word& word, const RunControl& control) {
  const Query query = word;
  return std::move(ask(std::span<const Query>(&query, 1), control).front().outputs);
}

}  // namespace maide
