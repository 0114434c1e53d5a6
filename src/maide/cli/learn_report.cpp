#include "maide/cli/learn_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <variant>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/cli/strength_report.hpp"
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
  const bool leaks = std::any_of(sorted.begin(), sorted.end(), [](const Contradiction& one) {
    return one.word.find(' ') == std::string::npos;
  });
  return text + (leaks
                     ? "    the first input of a word is among them: the reset leaves something "
                       "behind, or a step ends too early\n"
                     : "    a reset that leaves something behind, and a step that ends too early, "
                       "give such answers\n");
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
  const std::string known =
      fmt::format("{} known model{}", found.known, found.known == 1 ? "" : "s");
  const std::string words =
      fmt::format("{} word{} told them apart", found.words, found.words == 1 ? "" : "s");
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
    text +=
        fmt::format("  replaced             the wrapper, {} time{}: {}{}\n",
                    learned.incidents.count, learned.incidents.count == 1 ? "" : "s", first.reason,
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

}  // namespace maide::cli
