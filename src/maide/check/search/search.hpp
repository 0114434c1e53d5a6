// What all searches of Maide's own engine share: their limits, their result, and the look at the
// limits that each takes from time to time.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "maide/base/run_control.hpp"
#include "maide/check/reduce/reduction_kind.hpp"
#include "maide/check/search/ranks.hpp"
#include "maide/check/system/trace.hpp"

namespace maide {

struct SearchLimits {
  std::uint64_t bytes = ~std::uint64_t{0};
  std::uint64_t states = ~std::uint64_t{0};  // stored
  std::uint64_t depth = ~std::uint64_t{0};   // levels; what lies deeper is not looked at
  unsigned threads = 1;                      // of searches that can use several
  std::size_t states_a_thread = 256;         // EngineOptions
  Ranks* ranks = nullptr;                    // of searches that can use them
  bool shortens = true;                      // EngineOptions
  std::string checkpoints;                   // EngineOptions
  double checkpoint_seconds = 0;
  RunControl control;
};

struct SearchResult {
  enum class End : std::uint8_t {
    complete,  // everything was visited
    found,
    out_of_memory,  // the limit, or the machine's
    stopped,        // by the control, or another limit
  };
  End end = End::complete;
  std::uint64_t states = 0;       // stored
  std::uint64_t transitions = 0;  // seen, or taken in a search for cycles
  std::uint64_t depth = 0;        // of the last level that was begun; of the longest path
  bool has_cut = false;           // one of them leaves what was learned
  bool has_violation = false;     // of a search for cycles, though perhaps not shown
  std::uint64_t bytes = 0;        // the most that the search had
  std::uint64_t sent_bytes = 0;   // between ranks
  std::optional<Trace> trace;     // of what was found
  // In a search for cycles by ranks: where the trace ends, from where a violation comes, and the
  // monitor's state there.
  std::optional<std::pair<GlobalState, std::uint32_t>> near;
  std::optional<Trace> remarkable;        // of a run that is almost what was looked for
  Reduction reduction = Reduction::none;  // what was used
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

// States between two looks at the limits.
inline constexpr std::size_t limit_interval = 1 << 14;

// One look at the limits: tells how far the search has come, and false if it has to end; why is in
// `result`. `bytes`: held now; `growth`: what may be needed on top before the next look.
inline bool may_go_on(const SearchLimits& limits, std::uint64_t states, std::uint64_t bytes,
                      std::uint64_t growth, SearchResult& result) {
  result.bytes = std::max(result.bytes, bytes);
  if (limits.control.progress != nullptr) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - result.start;
    const std::string phase =
        fmt::format("checking, depth {}, {:.1f} million states/s, {} MiB", result.depth,
                    static_cast<double>(states) / elapsed.count() / 1e6, bytes >> 20);
    limits.control.report({phase, states, 0, 0, 0, 0});
  }
  if (limits.control.should_stop() || states > limits.states) {
    result.end = SearchResult::End::stopped;
    return false;
  }
  if (bytes + growth > limits.bytes) {
    result.end = SearchResult::End::out_of_memory;
    return false;
  }
  return true;
}

}  // namespace maide
