#include "maide/cli/learn_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "maide/base/numbers.hpp"
#include "maide/base/text.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/learn/oracle/statistics.hpp"
#include "maide/report/line_plot.hpp"

namespace maide::cli {

Json contradictions_as_json(const std::vector<Contradiction>& contradictions) {
  Json list = Json::array();
  for (const Contradiction& contradiction : contradictions) {
    Json answers = Json::array();
    for (const auto& [answer, count] : contradiction.answers) {
      answers.push_back({{"answer", answer}, {"count", count}});
    }
    list.push_back({{"word", split(contradiction.word, ' ')}, {"answers", std::move(answers)}});
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
  std::ranges::stable_sort(sorted, [&](const auto& left, const auto& right) {
    return minority(left) > minority(right);
  });
  for (std::size_t i = 0; i < std::min(shown, sorted.size()); ++i) {
    text += fmt::format("    {}\n", to_string(sorted[i]));
  }
  if (sorted.size() > shown) text += fmt::format("    and {} more\n", sorted.size() - shown);
  const bool leaks = std::ranges::any_of(
      sorted, [](const Contradiction& one) { return one.word.find(' ') == std::string::npos; });
  return text + (leaks
                     ? "    the first input of a word is among them: the reset leaves something "
                       "behind, or a step ends too early\n"
                     : "    a reset that leaves something behind, and a step that ends too early, "
                       "give such answers\n");
}

Json contradictions_as_json(const std::vector<LogContradiction>& contradictions) {
  Json list = Json::array();
  for (const LogContradiction& wrong : contradictions) {
    list.push_back(
        {{"word", split(wrong.word, ' ')}, {"logged", wrong.logged}, {"answered", wrong.answered}});
  }
  return list;
}

std::string describe_contradictions(const std::vector<LogContradiction>& contradictions) {
  if (contradictions.empty()) return "";
  const LogContradiction& first = contradictions.front();
  return fmt::format(
      "  the log is wrong     about {}: \"{}\" ends in '{}', there in '{}'{}\n",
      counted(contradictions.size(), "word"), first.word, first.answered, first.logged,
      contradictions.size() < LoggedTraces::most_contradictions ? "" : "; it was given up");
}

namespace {

constexpr std::array phases{LearnPhase::learning, LearnPhase::refinement, LearnPhase::testing,
                            LearnPhase::confirmation};

// Hypotheses at the beginning and at the end of a long list.
constexpr std::size_t shown = 10;

Json counts_json(const QueryCounts& counts) {
  return {{"words", counts.queries}, {"symbols", counts.symbols}, {"resets", counts.resets}};
}

}  // namespace

std::string describe_statistics(const ExperimentResult& run) {
  std::string text =
      fmt::format("  by phase             {:>10} {:>12} {:>10}\n", "words", "symbols", "resets");
  for (const LearnPhase phase : phases) {
    const QueryCounts& counts = run.statistics.at(phase);
    text += fmt::format("    {:<18} {:>10} {:>12} {:>10}\n", to_string(phase), counts.queries,
                        counts.symbols, counts.resets);
  }
  text +=
      fmt::format("  by hypothesis        {:>10} {:>23} {:>23}\n", "", "to make it", "to test it");
  text += fmt::format("    {:<18} {:>10} {:>10} {:>12} {:>10} {:>12}\n", "", "states", "words",
                      "symbols", "words", "symbols");
  const std::vector<HypothesisShare> shares = divide(run.hypotheses, run.statistics);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (shares.size() > 2 * shown && i == shown) {
      text += fmt::format("    ... {} more ...\n", shares.size() - 2 * shown);
      i = shares.size() - shown;
    }
    const HypothesisShare& share = shares[i];
    text += fmt::format("    {:<18} {:>10} {:>10} {:>12} {:>10} {:>12}\n", i + 1, share.states,
                        share.to_make.queries, share.to_make.symbols, share.to_test.queries,
                        share.to_test.symbols);
  }
  return text;
}

void add_statistics(Json& json, const ExperimentResult& run) {
  for (const LearnPhase phase : phases) {
    json["phases"][std::string(to_string(phase))] = counts_json(run.statistics.at(phase));
  }
  json["hypotheses"] = Json::array();
  for (const HypothesisShare& share : divide(run.hypotheses, run.statistics)) {
    json["hypotheses"].push_back({{"states", share.states},
                                  {"to_make", counts_json(share.to_make)},
                                  {"to_test", counts_json(share.to_test)}});
  }
}

std::string draw_hypotheses(const ExperimentResult& run, const std::string& title) {
  PlotLine line{run.algorithm + ", " + run.test_method, {}, true};
  // Nothing may have reached the system, whose answers are all in a cache.
  const auto add = [&line](std::uint64_t symbols, std::size_t states) {
    line.points.emplace_back(static_cast<double>(std::max<std::uint64_t>(symbols, 1)),
                             static_cast<double>(states));
  };
  for (const HypothesisCost& hypothesis : run.hypotheses) {
    add(hypothesis.before.total().symbols, hypothesis.states);
  }
  if (!run.hypotheses.empty()) add(run.symbols, run.hypotheses.back().states);
  return draw_plot({{"states of the hypothesis: " + title, {line}}},
                   {"symbols given to the system", PlotScale::powers_of_ten, PlotScale::linear});
}

namespace {

// What an interface automaton's marks mean for whoever uses it, a line each.
std::string remarks(const InterfaceAutomaton& automaton) {
  std::string text;
  std::size_t untried = 0;
  for (StateId state = 0; state < automaton.size(); ++state) {
    untried += automaton.unexplored(state).size();
    for (const auto& transition : automaton.transitions(state)) {
      untried += transition.absorbed ? 1 : 0;
    }
  }
  if (const auto bound = automaton.origin.find("bound");
      untried > 0 && bound != automaton.origin.end()) {
    text += fmt::format("  bound                {}: beyond it nothing was tried\n", bound->second);
  }
  for (const std::string& input : automaton.hidden_returns) {
    text += fmt::format(
        "  hidden return        {0} was seen to block, and its return is not observed: see "
        "observe=\n",
        input);
  }
  return text;
}

std::string describe_identification(const Identification& found, bool is_complete) {
  const std::string known = counted(found.known, "known model");
  const std::string words = counted(found.words, "word") + " told them apart";
  if (!is_complete) return fmt::format("  identified           not yet ({}; {})\n", known, words);
  if (found.name.empty()) {
    return fmt::format("  identified           as none of {} ({})\n", known, words);
  }
  return fmt::format("  identified           {}, one of {} ({})\n", found.name, known, words);
}

}  // namespace

Json learned_as_json(const LearnedModel& learned, std::size_t jobs, const std::string& path) {
  const ExperimentResult& run = learned.experiment;
  Json json{{"algorithm", run.algorithm},
            {"equivalence_method", run.test_method},
            {"translation", learned.is_plain ? "none" : to_string(learned.translation)},
            {"complete", run.is_complete()},
            {"states", learned.states()},
            {"transitions", learned.transitions()},
            {"mealy_states", learned.mealy_states},
            {"output_queries", run.output_queries},
            {"equivalence_queries", run.equivalence_queries},
            {"experiments", run.experiments},
            {"symbols", run.symbols},
            {"resets", run.resets},
            {"jobs", jobs},
            {"seconds", run.seconds},
            {"seconds_in_system", run.seconds_in_system},
            {"seconds_in_calls", run.seconds_in_system - run.seconds_in_settling},
            {"seconds_in_quiescence", run.seconds_in_settling},
            {"seconds_in_reset", run.seconds_in_reset},
            {"seconds_waiting_for_reset", run.seconds_in_reset_wait},
            {"seconds_in_learner", run.seconds_in_learner},
            {"guarantee", run.guarantee},
            {"confirmation_experiments", run.statistics.at(LearnPhase::confirmation).queries},
            {"confirmation_symbols", run.statistics.at(LearnPhase::confirmation).symbols},
            {"contradictions", contradictions_as_json(run.contradictions)},
            {"restarts", run.restarts},
            {"model", path.empty() ? Json() : Json(path)}};
  add_strength(json, learned);
  add_statistics(json, run);
  json["ends"] = Json::array();
  for (const SystemEnd& end : learned.ends) {
    json["ends"].push_back({{"output", end.output},
                            {"word", end.word},
                            {"states", end.states},
                            {"reason", end.reason.empty() ? Json() : Json(end.reason)}});
  }
  json["identified"] = Json();
  if (run.identified) {
    const Identification& found = *run.identified;
    json["identified"] = {{"model", found.name.empty() ? Json() : Json(found.name)},
                          {"known", found.known},
                          {"words", found.words}};
  }
  json["replacements"] = {{"count", learned.incidents.count}, {"first", Json::array()}};
  for (const SulIncidents::Death& death : learned.incidents.first) {
    json["replacements"]["first"].push_back(
        {{"reason", death.reason}, {"after", death.after}, {"asked_again", death.word}});
  }
  json["model_kind"] = Json();
  if (learned.model) {
    const bool is_automaton = std::holds_alternative<InterfaceAutomaton>(*learned.model);
    json["model_kind"] = is_automaton ? "ia" : "mealy";
    if (const auto* automaton = std::get_if<InterfaceAutomaton>(&*learned.model)) {
      json["hidden_returns"] = automaton->hidden_returns;
      const auto bound = automaton->origin.find("bound");
      json["bound"] = bound == automaton->origin.end() ? Json() : Json(bound->second);
    }
  }
  return json;
}

std::string describe_learned(const LearnedModel& learned, const SystemSpec& spec,
                             const VoteOptions& vote, std::size_t jobs, const std::string& path) {
  const ExperimentResult& run = learned.experiment;
  std::string text = spec.text;
  for (const auto& [key, value] : spec.options) text += " " + key + "=" + value;
  text += run.is_complete() ? "\n" : "  (not finished)\n";
  if (learned.model && std::holds_alternative<InterfaceAutomaton>(*learned.model)) {
    text += fmt::format("  interface automaton  {} states, {} transitions\n", learned.states(),
                        learned.transitions());
  }
  text += fmt::format("  Mealy machine        {} states{}\n", learned.mealy_states,
                      learned.is_plain ? "" : fmt::format(" ({})", to_string(learned.translation)));
  text +=
      fmt::format("  queries              {} output queries ({}), {} equivalence queries ({})\n",
                  run.output_queries, run.algorithm, run.equivalence_queries, run.test_method);
  text += fmt::format("  experiments          {} words run on the system: {} resets, {} symbols\n",
                      run.experiments, run.resets, run.symbols);
  text += fmt::format("  time                 {:.2f} s: {:.2f} learner and tests, {:.2f} asking\n",
                      run.seconds, run.seconds_in_learner, run.seconds - run.seconds_in_learner);
  text += fmt::format(
      "  in the system        {:.2f} s calls, {:.2f} waiting for quiescence, {:.2f} resets ({:.2f} "
      "waited for){}\n",
      run.seconds_in_system - run.seconds_in_settling, run.seconds_in_settling,
      run.seconds_in_reset, run.seconds_in_reset_wait,
      jobs > 1 ? fmt::format("; sums over {} at once", jobs) : "");
  if (const QueryCounts& again = run.statistics.at(LearnPhase::confirmation); again.queries > 0) {
    text +=
        fmt::format("  confirmation         {} of these words to confirm answers\n", again.queries);
  }
  text += describe_contradictions(run.contradictions, vote);
  text += describe_contradictions(run.log_contradictions);
  text += fmt::format("  result               {}\n", run.guarantee);
  text += describe_strength(learned);
  if (run.identified) text += describe_identification(*run.identified, run.is_complete());
  if (learned.model) {
    if (const auto* automaton = std::get_if<InterfaceAutomaton>(&*learned.model)) {
      text += remarks(*automaton);
    }
  }
  for (const SystemEnd& end : learned.ends) {
    text += fmt::format("  {:<19}  {}: {}{}\n", end.output, join(end.word, " "),
                        end.reason.empty() ? "known from the cache" : end.reason,
                        end.states == 1 ? "" : fmt::format("; so in {} states", end.states));
  }
  if (learned.incidents.count > 0) {
    const SulIncidents::Death& first = learned.incidents.first.front();
    text += fmt::format("  replaced             the wrapper, {}: {}{}\n",
                        counted(learned.incidents.count, "time"), first.reason,
                        first.after.empty() ? "" : fmt::format(", after \"{}\"", first.after));
  }
  if (!path.empty()) text += fmt::format("  model                {}\n", path);
  return text;
}

std::string describe_briefly(const LearnedModel& learned, const std::string& path) {
  const ExperimentResult& run = learned.experiment;
  return fmt::format("{}: {} states, {} transitions{}{}\n", path, learned.states(),
                     learned.transitions(), run.is_complete() ? "" : " (not finished)",
                     run.is_weak() ? " (weak)" : "");
}

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
  return std::ranges::find(names, option) != names.end();
}

// Options that choose the tests, or limit them; not those that say how far they are to go.
bool is_of_tests(const std::string& option) {
  if (option == "--eq") return true;
  const std::span<const TestOption> all = test_options();
  return option != "--strength" && option != "--effort" && option != "--seed" &&
         std::ranges::any_of(all, [&option](const TestOption& known) {
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
