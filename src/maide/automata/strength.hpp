// What tests establish about a learned model, in four numbers. Only `extra_states` is a theorem (M.
// P. Vasilevskii 1973; T. S. Chow 1978). The others say what was covered. A model that falls short
// of its `StrengthDemand` in one number is weak: it may lack behaviour that hides behind a few rare
// inputs or behind a count.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "maide/automata/mealy.hpp"

namespace maide {

struct Strength {
  bool exact = false;  // compared with the system's own machine: nothing is missing
  // No machine with at most so many states more than the model behaves differently; nothing: not
  // even all with as many as the model.
  std::optional<std::size_t> extra_states = {};
  // In every state every word of so many inputs that loop there was played.
  std::size_t chained = 0;
  // In every state every looping input was repeated so often, followed by every other input.
  std::size_t pumped = 0;
  std::uint64_t random = 0;  // random tests

  friend bool operator==(const Strength&, const Strength&) = default;
};

// What a model must reach not to be weak.
struct StrengthDemand {
  std::size_t extra_states = 1;
  std::size_t chained = 3;
  std::size_t pumped = 64;
  std::uint64_t random = 2000;
};

// Enough extra states to stand in for random tests.
inline constexpr std::size_t extra_states_without_random = 3;
// How often an input is repeated where the system names no size.
inline constexpr std::size_t default_pumped = 64;

// The demand on a model of `states` states and `inputs` inputs: one extra state, chains of three
// inputs, 2000 + 20 n k random tests, and pumps of twice `largest_size`. That is the largest size
// that the system's options name. If they name none (0), pumps have 64 inputs. O(1).
StrengthDemand default_demand(std::size_t states, std::size_t inputs, std::size_t largest_size);

// Where it falls short, as what is demanded there: "extra-states=1,pumped=64"; empty where nowhere,
// so for a model that is not weak.
std::string describe_shortfall(const Strength& strength, const StrengthDemand& demand);

// "extra-states=1,chained=3,pumped=64,random=4000", or "exact"; without extra-states where it is
// nothing. And back; throws UsageError that names what is wrong. Dimensions that the text leaves
// out are none.
std::string to_string(const Strength& strength);
Strength parse_strength(std::string_view text);

// The key of the strength in a model's origin. The value is to_string(strength), behind "weak: " if
// the model fell short of what is demanded. A reader cannot work that out, because the file does
// not hold the sizes.
inline constexpr std::string_view strength_key = "strength";
struct StatedStrength {
  Strength strength;
  bool is_weak = false;
  // "chained, pumped": what a text without the mark leaves out. Nobody knows whether the model is
  // weak there.
  std::string unstated = {};

  bool is_known() const { return is_weak || unstated.empty(); }
};
std::string to_string(const StatedStrength& stated);
StatedStrength parse_stated_strength(std::string_view text);  // throws as parse_strength
// Nothing where the origin does not say: the strength is unknown.
std::optional<StatedStrength> find_strength(const Origin& origin);

// "extra-states=2,pumped=64": the dimensions that `text` names, in place of those of `standard`.
// Throws likewise, and where more is demanded than anybody could pay for.
StrengthDemand parse_demand(std::string_view text, StrengthDemand standard);

// What `model` must reach: default_demand() for the largest of the sizes that its system's options
// name, and in place of it what `text` names; empty: nothing. Throws as parse_demand(). O(sizes).
StrengthDemand demand_of(const Mealy& model, std::span<const std::size_t> sizes,
                         std::string_view text = {});

}  // namespace maide
