// A model is confirmed by looking again with longer waits: what a wait too short did not see, or
// took for the end of a step, shows as a difference. The system is opened a second time for that.
#pragma once

#include <cstdint>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/learn/cache.hpp"
#include "maide/learn/statistics.hpp"
#include "maide/workflow/patient_system.hpp"

namespace maide {

struct ConfirmationSettings {
  VoteOptions vote;
  std::uint64_t seed = 0;
  std::uint64_t most_symbols = 20;  // given to the patient system, votes not included
};

// Plays a sample of words on the patient system, and returns how many agree with the model. One
// that differs is asked again, fresh, on the system that the model was learned from: if that
// answers otherwise now, the cache corrects itself (throws CacheCorrected). If it stands by its
// answer, and the patient system by its own, waits are too short: throws Error (inconclusive) that
// says so. What the patient system is asked is added to `counts`. Throws what the systems throw.
std::uint64_t confirm_model(const Mealy& model, const PatientSystem& patient, Cache& cache,
                            const ConfirmationSettings& settings, QueryCounts& counts,
                            const RunControl& control);

}  // namespace maide
