// `maide reproduce interrupt`: the paper's Figure 3. For each system: the model that is learned,
// the one that one would expect, and the shortest word that tells them apart; and whether that is
// what the paper found.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/cli/reproduce.hpp"
#include "maide/formats/dot.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/workflow/paper_interrupt.hpp"

namespace maide::cli {
namespace {

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
          {"model", dot_of(machine)}};
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

}  // namespace

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
                       {"model", dot_of(finding.learned)},
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

}  // namespace maide::cli
