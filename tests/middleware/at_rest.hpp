// What a replay plays of a system whose messages take their time on the way.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <utility>

#include "maide/check/build/system_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/join/at_rest.hpp"

namespace maide::test {

// Reads the file of `system` once more, at rest if something is late in it. The counterexample of
// `result`, if there is one, becomes a run of what is returned.
inline System at_rest(const System& system, const std::filesystem::path& file,
                      const ModelSource& models, PropertyResult& result) {
  if (system.nobodys_actions.empty()) return system;
  System resting = read_system(file, models, {}, {}, Deliveries::at_rest);
  if (!result.trace) return resting;
  auto run = find_run_at_rest(system, result.name, *result.trace, resting, {});
  if (run) {
    result.trace = std::move(run->trace);
  } else {
    ADD_FAILURE() << "the run needs " << describe_late_message(system, *result.trace);
  }
  return resting;
}

}  // namespace maide::test
