#include "maide/report/chart_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace maide {
namespace {

constexpr std::size_t longest_round = 500;

// Numbers for messages, equal for those that look alike.
std::vector<std::size_t> number_messages(const SequenceChart& chart) {
  using Look = std::tuple<std::size_t, std::size_t, std::string, std::string, std::string>;
  std::map<Look, std::size_t> numbers;
  std::vector<std::size_t> result;
  for (const SequenceChart::Message& message : chart.messages) {
    const Look look{message.from, message.to, message.label, message.place, message.remark};
    result.push_back(numbers.try_emplace(look, numbers.size()).first->second);
  }
  return result;
}

std::string describe_steps(std::size_t begin, std::size_t end) {
  return end - begin == 1 ? fmt::format("step {}", end)
                          : fmt::format("steps {} to {}", begin + 1, end);
}

class Folder {
 public:
  explicit Folder(std::vector<std::size_t> numbers) : numbers_(std::move(numbers)) {}

  void fold(std::size_t begin, std::size_t end, std::vector<ChartRow>& rows) const {
    for (std::size_t at = begin; at < end;) {
      const Repetition best = find_repetition(at, end);
      if (best.rounds < 2) {
        rows.push_back({at++, ""});
        continue;
      }
      fold(at, at + best.period, rows);
      const std::size_t stop = at + best.period * best.rounds;
      rows.push_back(
          {at, fmt::format("{} again, {} times, to step {}", describe_steps(at, at + best.period),
                           best.rounds - 1, stop)});
      at = stop;
    }
  }

 private:
  struct Repetition {
    std::size_t period = 1, rounds = 1;
    // Rows that folding it saves, one being the remark.
    std::size_t saved() const { return rounds < 3 ? 0 : (rounds - 1) * period - 1; }
  };

  // The repetition from `at` on that saves most; the shortest period of those.
  Repetition find_repetition(std::size_t at, std::size_t end) const {
    Repetition best;
    const std::size_t most = std::min((end - at) / 3, longest_round);
    for (std::size_t period = 1; period <= most; ++period) {
      std::size_t same = at + period;
      while (same < end && numbers_[same] == numbers_[same - period]) ++same;
      const Repetition candidate{period, (same - at) / period};
      if (candidate.saved() > std::max<std::size_t>(best.saved(), 1)) best = candidate;
    }
    return best;
  }

  std::vector<std::size_t> numbers_;
};

// Leaves out the middle of too many rows.
void shorten(const SequenceChart& chart, std::size_t most, std::vector<ChartRow>& rows) {
  if (rows.size() <= most) return;
  const std::size_t head = most / 2, tail = most - head - 1;
  const std::size_t first = rows[head].message, last = rows[rows.size() - tail].message;
  const bool has_loop = chart.loop_start && first <= *chart.loop_start && *chart.loop_start < last;
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(head),
             rows.end() - static_cast<std::ptrdiff_t>(tail));
  const std::string remark = fmt::format(
      "{} not shown{}", describe_steps(first, last),
      has_loop ? fmt::format("; the loop begins at step {}", *chart.loop_start + 1) : "");
  rows.insert(rows.begin() + static_cast<std::ptrdiff_t>(head), {first, remark});
}

}  // namespace

std::vector<ChartRow> fold_chart(const SequenceChart& chart, std::size_t most) {
  const Folder folder(number_messages(chart));
  std::vector<ChartRow> rows;
  const std::size_t count = chart.messages.size();
  const std::size_t split = chart.loop_start.value_or(count);
  folder.fold(0, split, rows);
  folder.fold(split, count, rows);
  shorten(chart, std::max<std::size_t>(most, 4), rows);
  return rows;
}

}  // namespace maide
