#include "maide/wire/death_record.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace maide {
namespace {

constexpr std::size_t most_deaths = 6;

// Durations and who was busy may differ from run to run.
bool is_same_step(const SulStep& left, const SulStep& right) {
  return left.status == right.status && left.events == right.events;
}

bool is_same_place(const Death& left, const Death& right) {
  return left.end == right.end && left.in_reset == right.in_reset && left.before && right.before &&
         std::equal(left.before->begin(), left.before->end(), right.before->begin(),
                    right.before->end(), is_same_step);
}

}  // namespace

DeathRecord::Verdict DeathRecord::add(Death death) {
  deaths_.push_back(std::move(death));
  const auto here = std::count_if(deaths_.begin(), deaths_.end(),
                                  [&](const Death& other) { return is_same_place(other, last()); });
  const std::size_t needed = last().end == WordEnd::hang ? 2 : 3;
  if (here >= 2 && deaths_.size() >= needed) return Verdict::reproducible;
  return deaths_.size() > most_deaths ? Verdict::hopeless : Verdict::ask_again;
}

}  // namespace maide
