#include "maide/learn/oracle/vote.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

constexpr double noise = 0.2;  // e of the head comment

// Logarithm of the likelihood ratio of an output that came `count` times of `total`.
double evidence(std::uint32_t count, std::uint32_t total) {
  return count * std::log(2 * (1 - noise)) + (total - count) * std::log(2 * noise);
}

}  // namespace

Ballot::Ballot(const VoteOptions& options)
    : options_(options), threshold_(-std::log1p(-options.confidence)) {
  if (!(options.confidence > 0 && options.confidence < 1)) {
    throw UsageError(fmt::format("a confidence of {} is not between 0 and 1", options.confidence));
  }
  if (missing() > options.most_attempts) {
    throw UsageError(fmt::format("a confidence of {} needs at least {} attempts at a word",
                                 options.confidence, missing()));
  }
}

void Ballot::add(Symbol output) {
  ++counts_[output];
  ++total_;
}

std::optional<Symbol> Ballot::winner() const {
  for (const auto& [output, count] : counts_) {
    if (evidence(count, total_) >= threshold_) return output;
  }
  return std::nullopt;
}

std::uint32_t Ballot::missing() const {
  std::uint32_t most = 0;
  for (const auto& [output, count] : counts_) most = std::max(most, count);
  const double left = threshold_ - evidence(most, total_);
  return left <= 0 ? 0 : static_cast<std::uint32_t>(std::ceil(left / evidence(1, 1)));
}

std::string to_string(const Contradiction& contradiction) {
  std::string text = contradiction.word + ":";
  for (const auto& [answer, count] : contradiction.answers) {
    text +=
        fmt::format("{} {} \"{}\"", text.back() == ':' ? "" : ",", counted(count, "time"), answer);
  }
  return text;
}

}  // namespace maide
