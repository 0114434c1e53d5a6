// Asks a system again for a sample of the words in a cache, to see whether it still answers as it
// did.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/cache/cache_survey.hpp"
#include "maide/workflow/open_system.hpp"

namespace maide {

struct RecheckOptions {
  std::uint64_t words = 100;  // the size of the sample; all of the cache if it has no more
  std::uint64_t seed = 1;     // of the sample
  SystemAccess access;        // the translation is the cache's
};

// A word that the system answers otherwise now, up to the first output that is another one.
struct ChangedAnswer {
  CacheConflict conflict;   // `known`: of the cache; `other`: of the system, the first time
  std::uint64_t words = 0;  // of the sample, that begin with it
};

// A part of the system of which the cache was recorded with another version; "" for none.
struct OtherVersion {
  std::string part, cached, running;
};

struct RecheckResult {
  std::vector<OtherVersion> versions;
  std::uint64_t words = 0;             // asked
  std::uint64_t different = 0;         // of them, answered otherwise
  std::vector<ChangedAnswer> changed;  // shortest first, each word once
};

// Opens the system, which must be the cache's, in whatever version. Every word is asked once, so a
// single wrong answer of a noisy system is a conflict, too. Throws UsageError if it is another
// system, and what open_system() and the system throw.
RecheckResult recheck_cache(CacheFile& cache, const SystemSpec& spec, const RecheckOptions& options,
                            const RunControl& control = {});

}  // namespace maide
