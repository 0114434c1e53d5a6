#include "maide/cli/strength_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/method/test_methods.hpp"

namespace maide::cli {
namespace {

constexpr std::size_t most_inputs_named = 10;
constexpr std::uint64_t most_effort = 1000;

// A dimension in which a model falls short.
struct Gap {
  std::string name;     // as --strength has it
  std::string untried;  // in words: "2000 random tests"
  std::string reached, wanted;
};

std::vector<Gap> find_gaps(const TestedStrength& tested, const StrengthDemand& demand) {
  const Strength& strength = tested.strength;
  std::vector<Gap> gaps;
  const std::string shortfall = "," + describe_shortfall(strength, demand);
  const auto add = [&](const std::string& name, std::string untried, std::string reached,
                       std::uint64_t wanted) {
    if (shortfall.find("," + name + "=") == shortfall.npos) return;
    gaps.push_back({name, std::move(untried), std::move(reached), std::to_string(wanted)});
  };
  const auto extra_states = strength.extra_states;
  add("extra-states",
      demand.extra_states == 1
          ? "all tests that find one state more"
          : fmt::format("all tests that find {} states more", demand.extra_states),
      extra_states ? std::to_string(*extra_states) : "none", demand.extra_states);
  add("chained",
      fmt::format("in every state, all rows of {} inputs that change nothing there one by one",
                  demand.chained),
      std::to_string(strength.chained), demand.chained);
  add("pumped", fmt::format("in every state, such an input {} times in a row", demand.pumped),
      std::to_string(strength.pumped), demand.pumped);
  add("random", fmt::format("{} random tests", demand.random), std::to_string(strength.random),
      demand.random);
  return gaps;
}

// What a model must reach not to be weak; `demand` may ask for less.
StrengthDemand stricter(const TestedStrength& tested) {
  StrengthDemand both = tested.demand;
  const StrengthDemand& standard = tested.standard;
  both.extra_states = std::max(both.extra_states, standard.extra_states);
  both.chained = std::max(both.chained, standard.chained);
  both.pumped = std::max(both.pumped, standard.pumped);
  both.random = std::max(both.random, standard.random);
  return both;
}

// At the speed of the run, where resets and steps have their shares in the time that it took.
std::optional<double> estimate_seconds(const ExperimentResult& run, const TestCost& cost) {
  if (run.symbols == 0 || run.resets == 0) return std::nullopt;
  const double in_resets = run.seconds_in_reset_wait;
  const double in_steps = run.seconds_in_system;
  const double share = in_resets + in_steps > 0 ? in_resets / (in_resets + in_steps) : 0;
  return run.seconds *
         (share * static_cast<double>(cost.words) / static_cast<double>(run.resets) +
          (1 - share) * static_cast<double>(cost.symbols) / static_cast<double>(run.symbols));
}

std::string describe_seconds(double seconds) {
  if (seconds < 1) return "less than a second";
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2 * 3600.0) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 48 * 3600.0) return fmt::format("{:.0f} h", seconds / 3600);
  return fmt::format("{:.0f} days", seconds / 86400);
}

std::string describe_cost(const ExperimentResult& run) {
  const TestCost& cost = run.strength->cost_of_missing;
  if (cost.words == 0) return "";
  if (cost.words == saturated || cost.symbols == saturated) {
    return ". That would cost more words or symbols than can be counted";
  }
  const std::optional<double> seconds = estimate_seconds(run, cost);
  return fmt::format(
      ". That would cost some {} words, {} symbols{}", cost.words, cost.symbols,
      seconds ? fmt::format(", {} at the speed of this run", describe_seconds(*seconds)) : "");
}

// Beyond the effort of the run, whose budget did not pay for what is missing.
std::uint64_t needed_effort(const ExperimentResult& run, std::uint64_t effort) {
  const TestCost& cost = run.strength->cost_of_missing;
  const TestCost& once = run.strength->budget;
  if (cost.words == 0 || once.words == 0 || once.symbols == 0) {
    return effort == most_effort ? most_effort + 1 : std::min(10 * effort, most_effort);
  }
  const std::uint64_t more =
      1 + std::max(cost.words / (once.words / effort), cost.symbols / (once.symbols / effort));
  return std::max(saturating_sum(effort, more), 2 * effort);
}

bool is_in(std::span<const char* const> names, const std::string& option) {
  return std::find(names.begin(), names.end(), option) != names.end();
}

// Options that choose the tests, or limit them; not those that say how far they are to go.
bool is_of_tests(const std::string& option) {
  if (option == "--eq") return true;
  const std::span<const TestOption> all = test_options();
  return option != "--strength" && option != "--effort" && option != "--seed" &&
         std::any_of(all.begin(), all.end(), [&option](const TestOption& known) {
           return option == "--" + std::string(known.key);
         });
}

// Options that the next command has in another way, or not: those that made the tests of this run
// weak, or ended it.
bool is_replaced(const std::string& option, bool is_complete) {
  constexpr std::array always{"--start-from", "--effort"};
  constexpr std::array limits{"--max-experiments", "--time"};
  return is_in(always, option) || (is_complete ? is_of_tests(option) : is_in(limits, option));
}

Json demand_json(const StrengthDemand& demand) {
  return {{"extra_states", demand.extra_states},
          {"chained", demand.chained},
          {"pumped", demand.pumped},
          {"random", demand.random}};
}

// Delta is the translation's.
std::size_t count_inputs(const LearnedModel& learned) {
  const std::size_t all = learned.experiment.model.inputs().size();
  return learned.is_plain || learned.translation == Translation::eager ? all : all - 1;
}

}  // namespace

void add_strength(Json& json, const LearnedModel& learned) {
  const ExperimentResult& run = learned.experiment;
  json["inputs_without_effect"] = learned.inputs_without_effect;
  json["strength"] = nullptr;
  if (!run.strength) return;
  const TestedStrength& tested = *run.strength;
  const Strength& strength = tested.strength;
  json["strength"] = {
      {"weak", tested.is_weak},
      {"extra_states", strength.extra_states ? Json(*strength.extra_states) : Json()},
      {"chained", strength.chained},
      {"pumped", strength.pumped},
      {"random", strength.random}};
  if (strength.exact) json["strength"]["exact"] = true;
  json["strength_demanded"] = demand_json(tested.demand);
  json["strength_missing"] = tested.shortfall();
  const TestCost& cost = tested.cost_of_missing;
  json["cost_of_missing"] = nullptr;
  if (cost.words == 0) return;
  const auto seconds = estimate_seconds(run, cost);
  json["cost_of_missing"] = {{"words", cost.words},
                             {"symbols", cost.symbols},
                             {"seconds", seconds ? Json(*seconds) : Json()}};
}

std::string describe_strength(const LearnedModel& learned) {
  std::string text;
  if (const auto& tested = learned.experiment.strength) {
    text += fmt::format("  strength             {}\n",
                        to_string(StatedStrength{tested->strength, tested->is_weak}));
  }
  const std::vector<std::string>& idle = learned.inputs_without_effect;
  if (!idle.empty()) {
    const std::size_t named = std::min(idle.size(), most_inputs_named);
    text += fmt::format(
        "  no effect            {} of {} inputs never had an effect: {}{}\n", idle.size(),
        count_inputs(learned), fmt::join(std::span(idle).first(named), ", "),
        named < idle.size() ? fmt::format(" and {} more", idle.size() - named) : "");
  }
  return text;
}

std::string describe_weakness(const ExperimentResult& run) {
  if (!run.is_weak()) return "";
  if (!run.is_complete()) {
    return "WEAK: this model was not tested to the end; parts of the system may be missing from it";
  }
  std::vector<std::string> untried;
  for (const Gap& gap : find_gaps(*run.strength, stricter(*run.strength))) {
    untried.push_back(fmt::format("{} (reached: {})", gap.untried, gap.reached));
  }
  return fmt::format("WEAK{}: parts of the system may be missing from this model. Not tried: {}{}",
                     run.strength->shortfall().empty() ? ", as --strength allows" : "",
                     join(untried, "; "), describe_cost(run));
}

std::string describe_next_command(const CommandLine& line, const ExperimentResult& run,
                                  const NextCommand& next) {
  // Where the options asked for other tests, or for fewer, the default ones come first.
  bool is_default = true;
  for (const Argument& argument : line.all()) {
    is_default = is_default && (!argument.is_given() || !is_of_tests(argument.name()));
  }
  // So do they where --strength asked for less than that, and got it.
  const bool asked_less = run.is_complete() && run.strength && run.strength->shortfall().empty();
  const std::uint64_t effort = run.is_complete() && is_default && !asked_less
                                   ? needed_effort(run, next.effort)
                                   : next.effort;
  if (effort > most_effort) return "";
  std::vector<std::string> words{"maide", "learn"};
  const auto add = [&words](const std::string& word) { words.push_back(quote_shell_word(word)); };
  for (const Argument& argument : line.all()) {
    if (!argument.is_given() || is_replaced(argument.name(), run.is_complete())) continue;
    if (asked_less && argument.name() == "--strength") continue;
    if (!argument.takes_value()) {
      add(argument.name());
      continue;
    }
    for (const std::string& value : argument.values()) {
      if (!argument.is_positional()) add(argument.name());
      add(value);
    }
  }
  if (!next.model.empty()) {
    add("--start-from");
    add(next.model);
  }
  if (effort > 1) {
    add("--effort");
    add(std::to_string(effort));
  }
  return join(words, " ");
}

std::string describe_missing(const TestedStrength& tested) {
  std::vector<std::string> missing;
  for (const Gap& gap : find_gaps(tested, tested.demand)) {
    missing.push_back(fmt::format("{}={} (reached: {})", gap.name, gap.wanted, gap.reached));
  }
  return join(missing);
}

}  // namespace maide::cli
