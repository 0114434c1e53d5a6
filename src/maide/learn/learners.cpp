#include "maide/learn/learners.hpp"

#include <array>

#include "maide/base/named_table.hpp"
#include "maide/learn/lm_plus.hpp"
#include "maide/learn/rivest_schapire.hpp"

namespace maide {
namespace {

template <typename Algorithm>
std::unique_ptr<Learner> make(OutputOracle& oracle) {
  return std::make_unique<Algorithm>(oracle);
}

constexpr std::array table{
    LearnerEntry{"rs", "observation table, Rivest & Schapire's handling of counterexamples",
                 make<RivestSchapire>},
    LearnerEntry{"lmplus", "L*M+: observation table, Shahbaz's handling of counterexamples",
                 make<LmPlus>},
};

}  // namespace

std::span<const LearnerEntry> learners() { return table; }

const LearnerEntry& find_learner(std::string_view name) {
  return find_row(learners(), "algorithm", name);
}

}  // namespace maide
