#include "maide/learn/statistics.hpp"

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

QueryCounts Statistics::total() const {
  QueryCounts sum;
  for (const QueryCounts& counts : phases_) sum += counts;
  return sum;
}

}  // namespace maide
