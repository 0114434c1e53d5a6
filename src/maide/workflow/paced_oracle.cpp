#include "maide/workflow/paced_oracle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "maide/base/error.hpp"

namespace maide {

std::vector<MealyAnswer> PacedOracle::ask(std::span<const Query> batch, const RunControl& control,
                                          const PartialSink& on_early_end) {
  std::vector<MealyAnswer> answers;
  answers.reserve(batch.size());
  try {
    while (answers.size() < batch.size()) {
      const std::uint64_t left = options_.max_queries - answered_;
      if (left == 0) {
        throw Interrupted(
            fmt::format("stopped at the limit of {} experiments", options_.max_queries));
      }
      const std::size_t start = answers.size();
      const std::size_t size = std::min<std::uint64_t>(
          {std::uint64_t{batch.size() - start}, std::uint64_t{options_.portion}, left});
      std::vector<MealyAnswer> portion = system_.ask(
          batch.subspan(start, size), control, [&](std::size_t index, const MealyAnswer& answer) {
            if (on_early_end) on_early_end(start + index, answer);
          });
      answered_ += portion.size();
      std::move(portion.begin(), portion.end(), std::back_inserter(answers));
      if (options_.after_portion) options_.after_portion();
    }
  } catch (...) {
    for (std::size_t i = 0; on_early_end && i < answers.size(); ++i) on_early_end(i, answers[i]);
    throw;
  }
  return answers;
}

}  // namespace maide
