// Between the cache and the system: cuts large batches into portions. So a limit on the number of
// words is kept exactly, and the progress line sees the counts grow.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/run_control.hpp"
#include "maide/learn/oracle/output_oracle.hpp"
#include "maide/sul/sul.hpp"

namespace maide {

struct PaceOptions {
  std::size_t portion = 64;  // words given to the system at once
  std::uint64_t max_queries = std::numeric_limits<std::uint64_t>::max();
  std::function<void()> after_portion;  // called when a portion is answered
};

class PortioningOracle : public OracleDecorator {
 public:
  // Keeps a reference to `system`.
  PortioningOracle(OutputOracle& system, PaceOptions options)
      : OracleDecorator(system), options_(std::move(options)) {}

  using OutputOracle::ask;
  // Throws Interrupted when max_queries were answered and another is asked.
  std::vector<MealyAnswer> ask(std::span<const Query> batch, const RunControl& control = {},
                               const PartialSink& on_early_end = {}) override;

 private:
  PaceOptions options_;
  std::uint64_t answered_ = 0;
};

// The system under learning, opened a second time with longer waits: what confirms a model.
struct SystemAccess;
struct SystemSpec;

struct SlowerSystem {
  std::function<std::unique_ptr<OutputOracle>()> open;
  std::string waits;  // how it is opened, for messages: "floor=10"
};

// The options with which a system waits longer: a floor of 10 ms more where quiescence is observed,
// four times a fixed delay and 10 ms more. Nothing for a system without such options.
std::map<std::string, std::string> longer_waits(const std::map<std::string, std::string>& options);

// The wrapper of `spec`, which is open as `sul`, with longer waits, and with the learning purpose
// of a file unless that is empty. Nothing for a simulation, for a system without waits, and for a
// system that runs by itself (tcp, exec, wrappers that dial in), because nobody knows whether a
// second one can run beside it.
std::optional<SlowerSystem> make_slower_system(const SystemSpec& spec, const SystemAccess& access,
                                               const Sul& sul, const std::filesystem::path& purpose,
                                               const RunControl& control);

}  // namespace maide
