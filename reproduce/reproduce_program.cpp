// The program that `maide reproduce` starts: the paper's results, theirs beside ours, learned anew
// from the systems that are there. Equal sizes are expected; equal counts are not (other hardware,
// other equivalence tests).
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/base/error.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/tool_commands.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"
#include "published_results.hpp"

namespace maide::cli {
namespace {

// Throws what ended the run early.
LearnedModel learn_for_reproduction(const std::string& system,
                                    const std::map<std::string, std::string>& options,
                                    const ReproduceArguments& arguments, const RunControl& control);

// The systems to learn from: those asked for, else all of `known` that are on this machine. Throws
// UsageError if one is unknown, or there is none.
std::vector<std::string> chosen_systems(const std::vector<std::string>& known,
                                        const ReproduceArguments& arguments, Context& context);

// Table 2: the two case studies, checked on models learned anew.
ExitStatus reproduce_table2(const ReproduceArguments& arguments, Context& context);

// Figure 3: what becomes of a write that waits when its port is interrupted.
ExitStatus reproduce_interrupt(const ReproduceArguments& arguments, Context& context);

// `maide reproduce interrupt`: the paper's Figure 3. For each system: the model that is learned,
// the one that one would expect, and the shortest word that tells them apart; and whether that is
// what the paper found.

// A shortest word to each state, "" for the first.
std::vector<std::string> access_words(const Mealy& machine) {
  std::vector<std::string> words(machine.size());
  std::vector<bool> seen(machine.size());
  std::vector<StateId> queue{machine.initial()};
  seen[machine.initial()] = true;
  for (std::size_t next = 0; next < queue.size(); ++next) {
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const StateId target = machine.target(queue[next], input);
      if (seen[target]) continue;
      seen[target] = true;
      const std::string& before = words[queue[next]];
      words[target] = before + (before.empty() ? "" : " ") + machine.inputs().name(input);
      queue.push_back(target);
    }
  }
  return words;
}

void end_line(std::string& text) {
  while (text.back() == ' ') text.pop_back();
  text += '\n';
}

// One line a state; "-" where the call before has not returned.
std::string describe_table(const Mealy& machine) {
  std::string text = fmt::format("  {:<6}{:<24}", "state", "reached by");
  for (const std::string& input : machine.inputs().names()) text += fmt::format("{:<28}", input);
  end_line(text);
  const std::vector<std::string> words = access_words(machine);
  for (StateId state = 0; state < machine.size(); ++state) {
    text += fmt::format("  {:<6}{:<24}", state, words[state]);
    for (Symbol input = 0; input < machine.inputs().size(); ++input) {
      const std::string& output = machine.outputs().name(machine.output(state, input));
      text += fmt::format("{:<28}",
                          output == "refused"
                              ? std::string("-")
                              : fmt::format("{} -> {}", output, machine.target(state, input)));
    }
    end_line(text);
  }
  return text;
}

template <typename Automaton>
std::string dot_of(const Automaton& automaton) {
  std::ostringstream text;
  write_dot(text, automaton);
  return text.str();
}

Json describe_model(const Mealy& machine) {
  const InterfaceAutomaton automaton =
      to_interface_automaton(machine, Translation::eager, machine.actors);
  return {{"states", automaton.size()},
          {"transitions", automaton.transition_count()},
          {"mealy_states", machine.size()},
          {"dot", dot_of(machine)}};
}

// Whether the system does what is known of it: YARP what the paper found, any other what one would
// expect.
struct Finding {
  Mealy learned;
  std::optional<MealyDifference> from_expected, from_paper;
  bool agrees(const std::string& system) const {
    return system == "yarp" ? !from_paper : !from_expected;
  }
};

std::string describe_difference(const MealyDifference& difference, const char* other) {
  return fmt::format("  {:<12}{}\n  {:<12}{}\n",
                     "here:", difference.left.value_or("(no such input)"), std::string(other) + ":",
                     difference.right.value_or("(no such input)"));
}

std::string describe(const Finding& finding, const std::string& system) {
  std::string text;
  if (finding.from_expected) {
    text += fmt::format("The shortest word that tells it from what one would expect: {}\n",
                        fmt::join(finding.from_expected->word, " "));
    text += describe_difference(*finding.from_expected, "expected");
  } else {
    text +=
        "That is what one would expect: interrupt returns at once, and a waiting write fails.\n";
  }
  if (!finding.from_paper) {
    text += "The same as the paper's Figure 3: interrupt waits for the write itself.\n";
  } else if (system == "yarp") {
    text += fmt::format("The paper's Figure 3 is another one; the shortest word: {}\n",
                        fmt::join(finding.from_paper->word, " "));
    text += describe_difference(*finding.from_paper, "paper");
  }
  return text;
}

Json describe(const std::optional<MealyDifference>& difference, const char* other) {
  if (!difference) return nullptr;
  return {{"word", difference->word},
          {"here", difference->left.value_or("")},
          {other, difference->right.value_or("")}};
}

Finding find(const LearnedModel& model) {
  Finding finding;
  finding.learned = minimize(model.experiment.model);
  finding.from_expected = find_difference(finding.learned, expected_interrupt_model());
  finding.from_paper = find_difference(finding.learned, paper_interrupt_model());
  return finding;
}

ExitStatus reproduce_interrupt(const ReproduceArguments& arguments, Context& context) {
  Json systems = Json::array();
  bool all_agree = true;
  const Json expected = describe_model(expected_interrupt_model());
  const Json paper = describe_model(paper_interrupt_model());
  context.print(fmt::format("What one would expect ({} states):\n{}",
                            expected_interrupt_model().size(),
                            describe_table(expected_interrupt_model())));
  for (const std::string& system : chosen_systems(interrupt_systems(), arguments, context)) {
    const LearnedModel model =
        learn_for_reproduction(system, interrupt_options(), arguments, context.control());
    const Finding finding = find(model);
    all_agree = all_agree && finding.agrees(system);
    context.print(fmt::format(
        "\nFigure 3, learned from {} ({} states; as an interface automaton {} "
        "states, {} transitions) in {:.2f} s:\n{}{}",
        system, finding.learned.size(), model.states(), model.transitions(),
        model.experiment.seconds, describe_table(finding.learned), describe(finding, system)));
    systems.push_back({{"system", system},
                       {"options", interrupt_options()},
                       {"states", model.states()},
                       {"transitions", model.transitions()},
                       {"mealy_states", finding.learned.size()},
                       {"dot", dot_of(finding.learned)},
                       {"experiments", model.experiment.experiments},
                       {"seconds", model.experiment.seconds},
                       {"from_expected", describe(finding.from_expected, "expected")},
                       {"from_paper", describe(finding.from_paper, "paper")},
                       {"agrees", finding.agrees(system)}});
  }
  context.set_result({{"figure", "interrupt"},
                      {"expected", expected},
                      {"paper", paper},
                      {"agree", all_agree},
                      {"systems", systems}});
  return all_agree ? ExitStatus::ok : ExitStatus::violated;
}

// `maide reproduce table2`: the paper's two case studies, decided by our own engine and by SPIN on
// models learned anew, beside what the paper reports. Equal conclusions are expected; equal numbers
// of states are not: here a step is a rendezvous, and the bookkeeping of loops costs none.

using Models = std::map<std::string, InterfaceAutomaton>;

constexpr const char* table2_format = "{:<28} | {:>8} {:>6} {:>6} {:<8} | {:>8} {:>6} {:>6} {:<8}";

std::string conclusion(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds: return "OK";
    case Verdict::violated: return "deadlock";
    case Verdict::inconclusive: return "?";
  }
  return "";
}

std::string table_head(bool has_spin) {
  std::string text = fmt::format(table2_format, "", "native", "", "", "", "paper", "", "", "");
  if (has_spin) text += " | SPIN here";
  text +=
      "\n" + fmt::format(table2_format, "system", "states", "MB", "s", "", "states", "MB", "s", "");
  if (has_spin) text += fmt::format(" | {:>8} {:>6} {:>6}", "states", "MB", "s");
  return text + "\n";
}

std::string megabytes(const PropertyResult& result) {
  return fmt::format("{:.1f}", static_cast<double>(result.peak_bytes) / 1e6);
}

std::string table_line(const CheckedRow& row, const PropertyResult& native,
                       const std::optional<PropertyResult>& spin, bool agrees) {
  const auto paper = [&](auto value) { return row.paper ? value(*row.paper) : std::string("-"); };
  std::string text = fmt::format(
      table2_format, row.name + (agrees ? "" : "  (!)"), native.states, megabytes(native),
      fmt::format("{:.2f}", native.seconds), conclusion(native.verdict),
      paper([](const PaperCheckingRow& of) { return of.states; }),
      paper([](const PaperCheckingRow& of) { return std::to_string(of.megabytes); }),
      paper([](const PaperCheckingRow& of) { return fmt::format("{:.2f}", of.seconds); }),
      row.paper ? conclusion(row.expected) : "-");
  if (spin) {
    text += fmt::format(" | {:>8} {:>6} {:>6.2f} {}", spin->states, megabytes(*spin), spin->seconds,
                        conclusion(spin->verdict));
  }
  return text + "\n";
}

Json describe(const PropertyResult& result) {
  return {{"verdict", to_string(result.verdict)},
          {"states", result.states},
          {"transitions", result.transitions},
          {"seconds", result.seconds},
          {"peak_bytes", result.peak_bytes}};
}

Json row_json(const CheckedRow& row, const PropertyResult& native,
              const std::optional<PropertyResult>& spin, bool agrees) {
  Json json{{"system", row.name},
            {"agrees", agrees},
            {"native", describe(native)},
            {"spin", spin ? describe(*spin) : Json()},
            {"paper", nullptr}};
  if (row.paper) {
    json["paper"] = {{"verdict", to_string(row.expected)},
                     {"states", row.paper->states},
                     {"seconds", row.paper->seconds},
                     {"megabytes", row.paper->megabytes}};
  }
  return json;
}

PropertyResult check_deadlock(const System& system, const std::string& engine, Context& context) {
  CheckRequest request;
  request.properties = {"deadlock"};
  request.options.control = context.control();
  PropertyResult result = check_system(system, *make_engine(engine), request).properties.front();
  if (context.control().should_stop()) throw Interrupted("interrupted");
  return result;
}

Models learn_models(const std::string& system, const ReproduceArguments& arguments,
                    Context& context) {
  Models models;
  for (const auto& [name, options] : table2_models(system)) {
    const LearnedModel learned =
        learn_for_reproduction(system, options, arguments, context.control());
    models.emplace(name, std::get<InterfaceAutomaton>(learned.model.value()));
    context.print(fmt::format("learned {} from {}: {} states, {} transitions, {:.1f} s\n", name,
                              system, learned.states(), learned.transitions(),
                              learned.experiment.seconds));
  }
  return models;
}

ExitStatus reproduce_table2(const ReproduceArguments& arguments, Context& context) {
  const bool has_spin = find_on_path("spin").has_value();
  if (!has_spin) context.complain("spin is not installed: its columns are left out");
  Json rows = Json::array();
  bool all_agree = true;
  ReproduceArguments chosen = arguments;
  if (chosen.systems.empty()) chosen.systems = {"port"};  // what is checked is the same on each
  for (const std::string& system : chosen_systems(table2_systems(), chosen, context)) {
    const Models models = learn_models(system, arguments, context);
    const ModelSource source = [&](const ModelRequest& request) {
      return models.at(request.learn);
    };
    context.print("\nTable 2, on models learned from " + system + "\n" + table_head(has_spin));
    for (const CheckedRow& row : table2_rows()) {
      const System checked = parse_system(row.system, row.name, source);
      const PropertyResult native = check_deadlock(checked, "native", context);
      std::optional<PropertyResult> spin;
      if (has_spin) spin = check_deadlock(checked, "spin", context);
      const bool agrees =
          native.verdict == row.expected && (!spin || spin->verdict == row.expected);
      all_agree = all_agree && agrees;
      context.print(table_line(row, native, spin, agrees));
      rows.push_back(row_json(row, native, spin, agrees));
      rows.back()["learned_from"] = system;
    }
  }
  context.print(
      "\n* with a non-blocking read of the first queue. A write to that queue when it is full is "
      "accepted and\n  dropped, as in the paper's model; where it waits instead there is a "
      "deadlock, in the row that the paper\n  has not: the first producer waits for ever once "
      "the consumer has ended.\nstates: visited until a deadlock was found, else all that are "
      "reachable. (!): another conclusion.\n");
  context.set_result({{"table", "table2"}, {"agree", all_agree}, {"rows", rows}});
  return all_agree ? ExitStatus::ok : ExitStatus::violated;
}

constexpr const char* table1_format =
    "{:<28} {:>4} {:>4} {:>6} {:>4} {:>6} {:>8}  | {:>4} {:>4} {:>6} {:>4} {:>6} {:>8}\n";

std::string table_head(const std::string& system) {
  return fmt::format("\nTable 1, learned from {}\n{:<28} {:^37}  | {}\n", system, "", "here",
                     "the paper (YARP, 2014)") +
         fmt::format(table1_format, "model", "|Q|", "|T|", "#MM", "#EQ", "#exp", "s", "|Q|", "|T|",
                     "#MM", "#EQ", "#exp", "s");
}

std::string table_line(const PaperLearningRow& paper, const LearnedModel& learned) {
  const ExperimentResult& run = learned.experiment;
  const bool same_size =
      learned.states() == paper.states && learned.transitions() == paper.transitions;
  return fmt::format(table1_format, paper.configuration + (same_size ? "" : "  (!)"),
                     learned.states(), learned.transitions(), run.output_queries,
                     run.equivalence_queries, run.experiments, fmt::format("{:.2f}", run.seconds),
                     paper.states, paper.transitions, paper.output_queries,
                     paper.equivalence_queries, paper.experiments,
                     fmt::format("{:.0f}", paper.thousand_seconds * 1000));
}

Json row_json(const std::string& system, const ReproducedRow& row, const LearnedModel& learned) {
  const ExperimentResult& run = learned.experiment;
  const PaperLearningRow& paper = row.paper;
  return {{"system", system},
          {"options", row.options},
          {"model", paper.configuration},
          {"states", learned.states()},
          {"transitions", learned.transitions()},
          {"output_queries", run.output_queries},
          {"equivalence_queries", run.equivalence_queries},
          {"experiments", run.experiments},
          {"seconds", run.seconds},
          {"paper",
           {{"states", paper.states},
            {"transitions", paper.transitions},
            {"output_queries", paper.output_queries},
            {"equivalence_queries", paper.equivalence_queries},
            {"experiments", paper.experiments},
            {"seconds", paper.thousand_seconds * 1000}}}};
}

ExitStatus reproduce_table1(const ReproduceArguments& arguments, Context& context) {
  Json rows = Json::array();
  bool all_equal = true;
  for (const std::string& system : chosen_systems(table1_systems(), arguments, context)) {
    const std::vector<ReproducedRow> table = table1_rows(system);
    context.print(table_head(system));
    for (const ReproducedRow& row : table) {
      const LearnedModel learned =
          learn_for_reproduction(system, row.options, arguments, context.control());
      context.print(table_line(row.paper, learned));
      rows.push_back(row_json(system, row, learned));
      all_equal = all_equal && learned.states() == row.paper.states &&
                  learned.transitions() == row.paper.transitions;
    }
  }
  context.print(
      "\n|Q| states, |T| transitions, #MM output queries, #EQ equivalence queries, #exp words run "
      "on the system.\n* with a non-blocking read; writes beyond the bound drawn as self-loops. "
      "(!): another size than the paper's.\n");
  context.set_result({{"table", "table1"}, {"sizes_equal", all_equal}, {"rows", rows}});
  return all_equal ? ExitStatus::ok : ExitStatus::violated;
}

LearnedModel learn_for_reproduction(const std::string& system,
                                    const std::map<std::string, std::string>& options,
                                    const ReproduceArguments& arguments,
                                    const RunControl& control) {
  SystemSpec spec = parse_system_spec(system, {});
  spec.options = options;
  SystemAccess access;
  access.jobs = arguments.jobs;
  const OpenedSystem opened = open_system(spec, access, control);
  ExperimentOptions experiment;
  experiment.algorithm = arguments.algorithm;
  experiment.test_method = arguments.test_method;
  experiment.testing.seed = arguments.seed;
  LearnedModel learned = learn_model(*opened.sul, Translation::eager, experiment, control);
  if (!learned.experiment.is_complete()) std::rethrow_exception(learned.experiment.error);
  return learned;
}

std::vector<std::string> chosen_systems(const std::vector<std::string>& known,
                                        const ReproduceArguments& arguments, Context& context) {
  for (const std::string& asked : arguments.systems) {
    if (std::find(known.begin(), known.end(), asked) != known.end()) continue;
    throw UsageError(fmt::format("there is nothing to reproduce on '{}'; there is on {}{}", asked,
                                 fmt::join(known, ", "), did_you_mean(asked, known)));
  }
  if (!arguments.systems.empty()) return arguments.systems;
  std::vector<std::string> systems;
  for (const std::string& system : known) {
    if (find_wrapper(system)) {
      systems.emplace_back(system);
    } else if (!context.quiet()) {
      context.complain(fmt::format("{} is left out: its wrapper is not built here", system));
    }
  }
  if (systems.empty()) throw UsageError("no wrapper was found; " + describe_wrapper_search());
  return systems;
}

RunFunction set_up(CommandLine& line) {
  auto arguments = std::make_shared<ReproduceArguments>();
  declare_reproduce(line, *arguments);
  return [arguments](Context& context) {
    if (arguments->what == "table1") return reproduce_table1(*arguments, context);
    if (arguments->what == "table2") return reproduce_table2(*arguments, context);
    return reproduce_interrupt(*arguments, context);
  };
}

}  // namespace
}  // namespace maide::cli

int main(int argc, char** argv) {
  maide::cli::prepare_process();
  return maide::cli::run_tool("reproduce", maide::cli::set_up, argc, argv);
}
