// Load beside a test or a measurement: what is timed by guess breaks.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "maide/wire/client/child_process.hpp"

namespace maide::test {

// Processes that compute as long as this lives.
class BusyMachine {
 public:
  explicit BusyMachine(std::size_t processes) {
    for (std::size_t i = 0; i < processes; ++i) {
      processes_.push_back(std::make_unique<ChildProcess>(
          std::vector<std::string>{"sh", "-c", "while :; do :; done"}));
    }
  }

 private:
  std::vector<std::unique_ptr<ChildProcess>> processes_;
};

}  // namespace maide::test
