#include "maide/cli/learn_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <variant>

#include "maide/base/join.hpp"
#include "maide/cli/contradiction_report.hpp"
#include "maide/cli/learn_statistics.hpp"
#include "maide/cli/strength_report.hpp"

namespace maide::cli {
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
  if (learned.model) {
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
