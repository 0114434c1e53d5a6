#include "maide/learn/oracle/statistics.hpp"

#include <initializer_list>

namespace maide {

std::string_view to_string(LearnPhase phase) {
  switch (phase) {
    case LearnPhase::learning: return "learning";
    case LearnPhase::refinement: return "refinement";
    case LearnPhase::testing: return "testing";
    case LearnPhase::confirmation: break;
  }
  return "confirmation";
}

QueryCounts& QueryCounts::operator+=(const QueryCounts& other) {
  queries += other.queries;
  symbols += other.symbols;
  resets += other.resets;
  in_reset += other.in_reset;
  in_reset_wait += other.in_reset_wait;
  in_system += other.in_system;
  in_settling += other.in_settling;
  asking += other.asking;
  return *this;
}

QueryCounts& QueryCounts::operator-=(const QueryCounts& other) {
  queries -= other.queries;
  symbols -= other.symbols;
  resets -= other.resets;
  in_reset -= other.in_reset;
  in_reset_wait -= other.in_reset_wait;
  in_system -= other.in_system;
  in_settling -= other.in_settling;
  asking -= other.asking;
  return *this;
}

QueryCounts Statistics::total() const {
  QueryCounts sum;
  for (const QueryCounts& counts : phases_) sum += counts;
  return sum;
}

std::vector<HypothesisShare> divide(std::span<const HypothesisCost> hypotheses,
                                    const Statistics& end) {
  const auto between = [](const Statistics& from, const Statistics& to,
                          std::initializer_list<LearnPhase> phases) {
    QueryCounts counts;
    for (const LearnPhase phase : phases) {
      counts += to.at(phase);
      counts -= from.at(phase);
    }
    return counts;
  };
  std::vector<HypothesisShare> shares;
  Statistics before;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const Statistics& made = hypotheses[i].before;
    const Statistics& over = i + 1 < hypotheses.size() ? hypotheses[i + 1].before : end;
    shares.push_back({hypotheses[i].states,
                      between(before, made, {LearnPhase::learning, LearnPhase::refinement}),
                      between(made, over, {LearnPhase::testing, LearnPhase::confirmation})});
    before = made;
  }
  return shares;
}

}  // namespace maide
