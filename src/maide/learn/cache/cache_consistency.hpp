// The consistency test of the cache: the equivalence oracle that sends nothing. It finds a
// shortest, then alphabet-least, word that is known from this run and that the hypothesis gets
// wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "maide/learn/cache/known_answers.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"

namespace maide {

class CacheConsistencyTest : public EquivalenceOracle {
 public:
  // Keeps a reference.
  explicit CacheConsistencyTest(const KnownAnswers& known) : known_(known) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control) override;
  std::string guarantee() const override;

 private:
  const KnownAnswers& known_;
  std::uint64_t compared_ = 0;
};

}  // namespace maide
