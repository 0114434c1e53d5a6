#include "maide/sul/sul.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace maide {

std::string_view to_string(Translation translation) {
  return translation == Translation::av ? "av" : "eager";
}

std::string mealy_output(const SulStep& step, Translation translation) {
  std::string joined;
  return std::string(mealy_output(step, translation, joined));
}

std::string_view mealy_output(const SulStep& step, Translation translation, std::string& joined) {
  switch (step.status) {
    case StepStatus::refused: return "refused";
    case StepStatus::unexplored: return "unexplored";
    case StepStatus::absorbed: return "absorbed";
    case StepStatus::delta:
      return step.events.empty() ? "delta" : std::string_view(step.events.front().output);
    case StepStatus::taken: break;
  }
  if (translation == Translation::av) return "+";
  if (step.events.empty()) return "quiet";
  if (step.events.size() == 1) return step.events.front().output;
  joined.clear();
  for (const Event& event : step.events) {
    if (!joined.empty()) joined += ',';
    joined += event.output;
  }
  return joined;
}

bool is_reserved_output(std::string_view name) {
  static constexpr std::array<std::string_view, 6> reserved = {"+",       "quiet",      "delta",
                                                               "refused", "unexplored", "absorbed"};
  return std::ranges::find(reserved, name) != reserved.end();
}

void SulIncidents::add(Death death) {
  ++count;
  if (first.size() < most_kept) first.push_back(std::move(death));
}

void SulIncidents::add(const SulIncidents& others) {
  count += others.count;
  for (const Death& death : others.first) {
    if (first.size() < most_kept) first.push_back(death);
  }
}

}  // namespace maide
