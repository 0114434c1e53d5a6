#include "maide/automata/strength.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

constexpr std::string_view weak_mark = "weak: ";
constexpr std::uint64_t random_floor = 2000, random_per_transition = 20;

// More is a slip of the pen; nobody could pay for it.
constexpr std::pair<std::string_view, std::uint64_t> most_demanded[]{
    {"extra-states", 1000}, {"chained", 32}, {"pumped", 1'000'000}, {"random", 1'000'000'000'000}};

// Calls `take(dimension, number)`, which says whether there is such a dimension, for each part.
template <typename Take>
void read_dimensions(std::string_view text, Take&& take) {
  for (const std::string_view part : split(text, ',')) {
    const std::size_t equals = part.find('=');
    const auto number =
        equals == part.npos ? std::nullopt : parse_number<std::uint64_t>(part.substr(equals + 1));
    if (!number || !take(part.substr(0, equals), *number)) {
      std::vector<std::string> names;
      for (const auto& [name, most] : most_demanded) names.emplace_back(name);
      const std::string_view name = part.substr(0, equals);
      const bool is_known = std::ranges::find(names, name) != names.end();
      const std::string near = is_known ? "" : did_you_mean(name, names);
      throw UsageError(fmt::format(
          "'{}' is no strength{}", part,
          near.empty() ? ": extra-states, chained, pumped or random, '=' and a number" : near));
    }
  }
}

// The dimensions that strength and demand have alike; false for another one.
template <typename Dimensions>
bool set_dimension(Dimensions& dimensions, std::string_view name, std::uint64_t number) {
  if (name == "chained") {
    dimensions.chained = number;
  } else if (name == "pumped") {
    dimensions.pumped = number;
  } else if (name == "random") {
    dimensions.random = number;
  } else {
    return false;
  }
  return true;
}

}  // namespace

StrengthDemand default_demand(std::size_t states, std::size_t inputs, std::size_t largest_size) {
  return {.pumped = largest_size == 0 ? default_pumped : 2 * largest_size,
          .random = random_floor + random_per_transition * states * inputs};
}

std::string describe_shortfall(const Strength& strength, const StrengthDemand& demand) {
  if (strength.exact) return "";
  std::string text;
  const auto add = [&](std::string_view dimension, std::uint64_t wanted) {
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", dimension, wanted);
  };
  // Nothing is less than 0.
  if (strength.extra_states < demand.extra_states) add("extra-states", demand.extra_states);
  if (strength.chained < demand.chained) add("chained", demand.chained);
  if (strength.pumped < demand.pumped) add("pumped", demand.pumped);
  const bool is_deep = strength.extra_states >= extra_states_without_random;
  if (strength.random < demand.random && !is_deep) add("random", demand.random);
  return text;
}

std::string to_string(const Strength& strength) {
  if (strength.exact) return "exact";
  return fmt::format(
      "{}chained={},pumped={},random={}",
      strength.extra_states ? fmt::format("extra-states={},", *strength.extra_states) : "",
      strength.chained, strength.pumped, strength.random);
}

Strength parse_strength(std::string_view text) {
  if (text == "exact") return {.exact = true};
  Strength strength;
  read_dimensions(text, [&](std::string_view dimension, std::uint64_t number) {
    if (dimension != "extra-states") return set_dimension(strength, dimension, number);
    strength.extra_states = number;
    return true;
  });
  return strength;
}

std::string to_string(const StatedStrength& stated) {
  return fmt::format("{}{}", stated.is_weak ? weak_mark : "", to_string(stated.strength));
}

StatedStrength parse_stated_strength(std::string_view text) {
  const bool is_weak = text.starts_with(weak_mark);
  if (is_weak) text.remove_prefix(weak_mark.size());
  StatedStrength stated{parse_strength(text), is_weak};
  if (is_weak || stated.strength.exact) return stated;
  const std::vector<std::string_view> parts = split(text, ',');
  std::vector<std::string> unstated;
  for (const auto& [dimension, most] : most_demanded) {
    const bool is_stated = std::ranges::any_of(parts, [&, name = dimension](std::string_view part) {
      return part.substr(0, part.find('=')) == name;
    });
    const bool is_deep = stated.strength.extra_states >= extra_states_without_random;
    if (!is_stated && !(dimension == "random" && is_deep)) unstated.emplace_back(dimension);
  }
  stated.unstated = join(unstated);
  return stated;
}

std::optional<StatedStrength> find_strength(const Origin& origin) {
  const auto text = origin.find(std::string(strength_key));
  if (text == origin.end()) return std::nullopt;
  return parse_stated_strength(text->second);
}

StrengthDemand parse_demand(std::string_view text, StrengthDemand standard) {
  read_dimensions(text, [&](std::string_view dimension, std::uint64_t number) {
    for (const auto& [limited, most] : most_demanded) {
      if (dimension == limited && number > most) {
        throw UsageError(fmt::format("{}={} is too much: at most {}", dimension, number, most));
      }
    }
    if (dimension != "extra-states") return set_dimension(standard, dimension, number);
    standard.extra_states = number;
    return true;
  });
  return standard;
}

StrengthDemand demand_of(const Mealy& model, std::span<const std::size_t> sizes,
                         std::string_view text) {
  const auto largest = std::ranges::max_element(sizes);
  const StrengthDemand standard =
      default_demand(model.size(), model.inputs().size(), largest == sizes.end() ? 0 : *largest);
  return text.empty() ? standard : parse_demand(text, standard);
}

}  // namespace maide
