// A system file checked with each value of a number in it: of a constant, or of the depth of a
// queue. Depths are tried from 1 on until one is never filled: then no larger one changes anything,
// for what a queue does depends on its depth only where it is full.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/check/system/system.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/join/learned_models.hpp"

namespace maide {

// What is varied.
struct Every {
  std::string name;    // of the constant, the model or the topic
  std::string option;  // "depth" or "size"; "": it is a constant
  // First and last value; none: of a depth, as far as it matters.
  std::optional<std::pair<std::int64_t, std::int64_t>> range;
  // "n", "via.depth".
  std::string text() const { return option.empty() ? name : name + "." + option; }
};
inline constexpr std::int64_t most_values = 10'000;
inline constexpr std::int64_t most_depths = 64;  // of one without a range

// "n=1..8", "via.depth", "via.depth=1..8". Throws UsageError.
Every parse_every(const std::string& text);

struct CheckedValue {
  std::int64_t value = 0;
  CheckReport report;
  std::uint64_t states = 0;  // of the property that has most
  double seconds = 0;
  std::optional<bool> is_filled;  // of a depth: some run fills a queue; none: it is not known
};

struct CheckedValues {
  enum class End : std::uint8_t {
    range,         // all values were checked
    never_filled,  // the last one is never filled
    limit,         // more depths than are tried
    stopped,       // by the control
  };
  Every every;
  std::vector<CheckedValue> values;
  End end = End::range;
};

// `settings`: other values of other constants. Throws what checking throws, with the value; and
// UsageError if there is no such number in the file. Of the time until the deadline each value of a
// range has its share.
CheckedValues check_every(const std::string& path, const Every& every, Engine& engine,
                          const CheckRequest& request, const LearnedModelsOptions& models,
                          const std::vector<ConstantSetting>& settings);

}  // namespace maide
