#include "maide/cli/contradiction_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace maide::cli {

Json contradictions_as_json(const std::vector<Contradiction>& contradictions) {
  Json list = Json::array();
  for (const Contradiction& contradiction : contradictions) {
    Json answers = Json::array();
    for (const auto& [answer, count] : contradiction.answers) {
      answers.push_back({{"answer", answer}, {"count", count}});
    }
    list.push_back({{"word", contradiction.word}, {"answers", std::move(answers)}});
  }
  return list;
}

std::string describe_contradictions(const std::vector<Contradiction>& contradictions,
                                    const VoteOptions& vote) {
  if (contradictions.empty()) return "";
  constexpr std::size_t shown = 10;
  std::string text = fmt::format(
      "  contradictions       {} words were answered in several ways; the majority of each is "
      "believed\n                       (confidence {})\n",
      contradictions.size(), vote.confidence);
  std::vector<Contradiction> sorted = contradictions;
  const auto minority = [](const Contradiction& contradiction) {
    std::uint64_t total = 0;
    for (const auto& entry : contradiction.answers) total += entry.second;
    return total - contradiction.answers.front().second;
  };
  std::stable_sort(sorted.begin(), sorted.end(), [&](const auto& left, const auto& right) {
    return minority(left) > minority(right);
  });
  for (std::size_t i = 0; i < std::min(shown, sorted.size()); ++i) {
    text += fmt::format("    {}\n", to_string(sorted[i]));
  }
  if (sorted.size() > shown) text += fmt::format("    and {} more\n", sorted.size() - shown);
  return text;
}

Json contradictions_as_json(const std::vector<LogContradiction>& contradictions) {
  Json list = Json::array();
  for (const LogContradiction& wrong : contradictions) {
    list.push_back({{"word", wrong.word}, {"logged", wrong.logged}, {"answered", wrong.answered}});
  }
  return list;
}

std::string describe_contradictions(const std::vector<LogContradiction>& contradictions) {
  if (contradictions.empty()) return "";
  const LogContradiction& first = contradictions.front();
  return fmt::format(
      "  the log is wrong     about {} word{}: \"{}\" ends in '{}', there in '{}'{}\n",
      contradictions.size(), contradictions.size() == 1 ? "" : "s", first.word, first.answered,
      first.logged,
      contradictions.size() < LoggedTraces::most_contradictions ? "" : "; it was given up");
}

}  // namespace maide::cli
