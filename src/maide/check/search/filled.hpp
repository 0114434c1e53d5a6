// Whether some run fills a queue: with what is in it and what is on its way to it.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/check/search/search.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

struct FillableQueue {
  struct Part {
    std::uint32_t model = 0;
    std::vector<std::uint32_t> held;  // messages, by state of the model
  };
  std::vector<Part> parts;  // the queue, and the wires to it
  std::uint32_t room = 0;   // it is full when they hold so many
};

// SearchResult::End::found: some run fills one of the queues; complete: none does. O(states).
SearchResult find_filled(const System& system, const std::vector<FillableQueue>& queues,
                         const SearchLimits& limits);

}  // namespace maide
