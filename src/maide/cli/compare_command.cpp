// `maide compare A B`: whether two models are the same, of two versions, configurations or vendors.
// If not, it tells the shortest word that tells them apart, and all other differences. What one
// model knows and the other never tried is no contradiction, and is told apart from one. A system
// in the place of B is learned.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/behaviour.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/differences.hpp"
#include "maide/automata/mealy.hpp"
#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/experiment/known_models.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/report/difference_page.hpp"
#include "maide/report/picture.hpp"
#include "maide/report/state_names.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide::cli {

namespace {

struct CompareArguments {
  std::string a, b;
  std::vector<std::string> key_values;  // of a system in the place of b
  std::string token_file;
  std::uint64_t seed = 1;
  std::size_t jobs = 0;
  bool strict = false;
  std::string html;
  std::string initial;
};

// What is found out, and how the models are read for the list of all differences.
struct Outcome {
  bool same = false;
  std::string text;  // "The same: ...", or the first difference
  Json json;
  std::vector<std::string> notes;
  Model left, right;  // as they were compared
  BehaviourPair pair;
  Differences differences;

  // One model knows what the other never tried, and that is all.
  bool is_bound_alone() const {
    return !same && !differences.list.empty() &&
           differences.count_bounds() == differences.list.size() && !is_initial();
  }
  // The empty word tells them apart: outputs before the first input.
  bool is_initial() const { return json.contains("word") && json["word"].empty(); }
};

// The names under which the report speaks of the models.
struct Names {
  std::string left, right;
};

// Moore machines and DFAs have an output before the first input, too.
std::optional<Outcome> compare_initial_outputs(const Mealy& left, const Mealy& right,
                                               const Names& names) {
  const auto left_output = find_initial_output(left), right_output = find_initial_output(right);
  if (!left_output || !right_output || *left_output == *right_output) return std::nullopt;
  Outcome outcome;
  outcome.text = fmt::format(
      "They differ: the empty word tells them apart\n  {} answers {}\n  {} answers {}\n",
      names.left, *left_output, names.right, *right_output);
  outcome.json = {{"same", false},
                  {"kind", "mealy"},
                  {"word", Json::array()},
                  {"left", *left_output},
                  {"right", *right_output}};
  return outcome;
}

Outcome compare_mealy(const Mealy& left, const Mealy& right, const Names& names) {
  if (auto outcome = compare_initial_outputs(left, right, names)) return *std::move(outcome);
  const auto difference = find_difference(left, right);
  Outcome outcome;
  outcome.same = !difference;
  outcome.json = {{"same", !difference}, {"kind", "mealy"}};
  if (!difference) {
    outcome.text =
        fmt::format("The same: {} ({}) and {} ({}) answer every word alike.\n", names.left,
                    counted(left.size(), "state"), names.right, counted(right.size(), "state"));
    return outcome;
  }
  const auto answer = [](const std::optional<std::string>& output, const std::string& input) {
    return output ? "answers " + *output : "has no input " + input;
  };
  const std::string& last = difference->word.back();
  outcome.json["word"] = difference->word;
  outcome.json["left"] = difference->left ? Json(*difference->left) : Json(nullptr);
  outcome.json["right"] = difference->right ? Json(*difference->right) : Json(nullptr);
  outcome.text = fmt::format(
      "They differ: a shortest word of {} tells them apart\n  {}\n  {} {}\n  {} {}\n",
      counted(difference->word.size(), "input"), fmt::join(difference->word, " "), names.left,
      answer(difference->left, last), names.right, answer(difference->right, last));
  return outcome;
}

std::string alternatives(const NondeterministicMealy& machine,
                         const std::vector<std::string>& outputs, const std::string& input) {
  if (!outputs.empty()) return fmt::format("may answer {}", fmt::join(outputs, " or "));
  return machine.inputs().find(input) ? "has no answer there" : "has no input " + input;
}

Outcome compare_nondeterministic(const NondeterministicMealy& left,
                                 const NondeterministicMealy& right, const Names& names) {
  const auto difference = find_difference(left, right);
  Outcome outcome;
  outcome.same = !difference;
  outcome.json = {{"same", !difference}, {"kind", "nondeterministic mealy"}};
  if (!difference) {
    outcome.text =
        fmt::format("The same: {} ({}) and {} ({}) have the same traces.\n", names.left,
                    counted(left.size(), "state"), names.right, counted(right.size(), "state"));
    return outcome;
  }
  std::vector<std::string> trace;
  for (const auto& [input, output] : difference->trace) trace.push_back(input + " / " + output);
  outcome.json["trace"] = trace;
  outcome.json["input"] = difference->input;
  outcome.json["left"] = difference->left;
  outcome.json["right"] = difference->right;
  outcome.text = fmt::format(
      "They differ: after a shortest trace of {}, one may answer {} as the other never does\n  "
      "{}\n  {} {}\n  {} {}\n",
      counted(trace.size(), "step"), difference->input,
      trace.empty() ? "(at the start)" : fmt::format("{}", fmt::join(trace, ", ")), names.left,
      alternatives(left, difference->left, difference->input), names.right,
      alternatives(right, difference->right, difference->input));
  return outcome;
}

std::string after(const std::vector<std::string>& word) {
  return word.empty() ? "at the start" : fmt::format("after {}", fmt::join(word, " "));
}

std::string offers(const std::vector<std::string>& actions) {
  return actions.empty() ? "nothing" : fmt::format("{}", fmt::join(actions, ", "));
}

std::string describe(const HardDifference& difference, const Names& names) {
  const std::vector<std::string> before(difference.word.begin(), difference.word.end() - 1);
  return fmt::format(
      "They differ: a shortest word of {} tells them apart\n  {}\n{}, {} is\n  {} in {}, which "
      "offers {}\n  {} in {}, which offers {}\n",
      counted(difference.word.size(), "action"), fmt::join(difference.word, " "), after(before),
      difference.word.back(), to_string(difference.left), names.left,
      offers(difference.left_offers), to_string(difference.right), names.right,
      offers(difference.right_offers));
}

Json to_json(const HardDifference& difference) {
  return {{"word", difference.word},
          {"left", to_string(difference.left)},
          {"right", to_string(difference.right)},
          {"left_offers", difference.left_offers},
          {"right_offers", difference.right_offers}};
}

Json to_json(const SoftDifference& difference) {
  Json inputs = Json::array();
  for (const auto& input : difference.inputs) {
    inputs.push_back({{"input", input.name},
                      {"left", to_string(input.left)},
                      {"right", to_string(input.right)}});
  }
  return {{"word", difference.word}, {"inputs", inputs}};
}

Outcome compare_automata(const InterfaceAutomaton& left, const InterfaceAutomaton& right,
                         const Names& names, const RunControl& control) {
  const IaComparison result = compare(left, right, control);
  Outcome outcome;
  outcome.same = result.same();
  outcome.notes = result.notes;
  if (result.same()) {
    outcome.text = fmt::format(
        "The same: {} ({}, {}) and {} ({}, {}) take and emit the same actions.\n", names.left,
        counted(left.size(), "state"), counted(left.transition_count(), "transition"), names.right,
        counted(right.size(), "state"), counted(right.transition_count(), "transition"));
  } else if (result.hard) {
    outcome.text = describe(*result.hard, names);
  }
  outcome.json = {{"same", outcome.same},
                  {"kind", "ia"},
                  {"hard", result.hard ? to_json(*result.hard) : Json(nullptr)},
                  {"soft", Json::array()}};
  for (const SoftDifference& difference : result.soft) {
    outcome.json["soft"].push_back(to_json(difference));
  }
  return outcome;
}

// ---- All differences ----

constexpr std::size_t most_lines = 20;  // of differences, besides the first

// "after write twice, read: write gives message in old.dot, nothing in new.dot".
std::string describe(const BehaviourPair& pair, const Difference& difference, const Names& names) {
  return fmt::format("{}: {} {} {} in {}, {} in {}", describe_word(describe_way(pair, difference)),
                     pair.questions[difference.question], pair.has_outputs ? "is" : "gives",
                     difference.left, names.left, difference.right, names.right);
}

// All but the first contradiction, which is told already: a line each, and then a count.
std::string list_differences(const Outcome& outcome, const Names& names) {
  const std::vector<Difference>& list = outcome.differences.list;
  const std::size_t bounds = outcome.differences.count_bounds();
  const std::size_t contradictions = list.size() - bounds;
  std::size_t lines = 0;
  std::string text;
  const auto add = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && lines < most_lines; ++i, ++lines) {
      text += fmt::format("  {}\n", describe(outcome.pair, list[i], names));
    }
  };
  const std::size_t told = outcome.is_initial() ? 0 : 1;
  if (contradictions > told) {
    text += fmt::format("Besides, {}:\n", counted(contradictions - told, "difference"));
    add(told, contradictions);
  }
  if (bounds > 0) {
    text += contradictions == 0 && told > 0
                ? "They do not contradict each other; one knows what the other never tried:\n"
                : "Besides, one knows what the other never tried:\n";
    add(contradictions, list.size());
  }
  const std::size_t all = list.size() - std::min(told, contradictions);
  if (all > lines) {
    text += fmt::format("  and {} more; --json lists all, --html shows them\n", all - lines);
  }
  if (!outcome.differences.is_complete) {
    text +=
        fmt::format("Note: more than {} pairs of states meet, and the rest was not looked at.\n",
                    outcome.differences.pairs);
  }
  return text;
}

Json to_json(const BehaviourPair& pair, const Difference& difference) {
  return {{"word", describe_way(pair, difference)},
          {"question", pair.questions[difference.question]},
          {"left", difference.left},
          {"right", difference.right},
          {"bound", difference.is_bound},
          {"passed", difference.passed()}};
}

// The interface automaton that a Mealy machine stands for, to compare it with one.
InterfaceAutomaton as_automaton(const NondeterministicMealy& machine,
                                const InterfaceAutomaton& other, const std::string& file,
                                std::vector<std::string>& notes) {
  const Translation translation =
      machine.inputs().find(delta_input) ? Translation::av : Translation::eager;
  notes.push_back(fmt::format(
      "{} is a Mealy machine and is compared as the interface automaton that it stands for "
      "({} translation)",
      file, to_string(translation)));
  const auto& actors = machine.actors.empty() ? other.actors : machine.actors;
  try {
    const auto deterministic = machine.to_mealy();
    return deterministic ? to_interface_automaton(*deterministic, translation, actors)
                         : to_interface_automaton(machine, actors);
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("a Mealy machine that stands for no interface automaton: {} ({})",
                                 error.what(), file));
  }
}

// A Mealy machine of either kind; nothing for an interface automaton.
std::optional<NondeterministicMealy> as_mealy(const Model& model) {
  if (const auto* machine = std::get_if<Mealy>(&model)) return NondeterministicMealy(*machine);
  if (const auto* machine = std::get_if<NondeterministicMealy>(&model)) return *machine;
  return std::nullopt;
}

Outcome compare_models(const Model& left, const Model& right, const Names& names, bool has_page,
                       const RunControl& control) {
  const auto* left_machine = std::get_if<Mealy>(&left);
  const auto* right_machine = std::get_if<Mealy>(&right);
  const auto left_mealy = as_mealy(left), right_mealy = as_mealy(right);
  Outcome outcome;
  if (left_mealy && right_mealy) {
    outcome = left_machine != nullptr && right_machine != nullptr
                  ? compare_mealy(*left_machine, *right_machine, names)
                  : compare_nondeterministic(*left_mealy, *right_mealy, names);
    outcome.left = *left_mealy;
    outcome.right = *right_mealy;
  } else {
    std::vector<std::string> notes;
    const InterfaceAutomaton left_automaton =
        !left_mealy
            ? std::get<InterfaceAutomaton>(left)
            : as_automaton(*left_mealy, std::get<InterfaceAutomaton>(right), names.left, notes);
    const InterfaceAutomaton right_automaton =
        !right_mealy
            ? std::get<InterfaceAutomaton>(right)
            : as_automaton(*right_mealy, std::get<InterfaceAutomaton>(left), names.right, notes);
    outcome = compare_automata(left_automaton, right_automaton, names, control);
    outcome.notes.insert(outcome.notes.begin(), notes.begin(), notes.end());
    outcome.left = left_automaton;
    outcome.right = right_automaton;
  }
  if (outcome.same && !has_page) return outcome;
  outcome.pair = left_mealy && right_mealy
                     ? read_behaviours(*left_mealy, *right_mealy, control)
                     : read_behaviours(std::get<InterfaceAutomaton>(outcome.left),
                                       std::get<InterfaceAutomaton>(outcome.right), control);
  outcome.differences = find_differences(outcome.pair, control);
  return outcome;
}

// ---- A system in the place of the second model ----

bool is_model_file(const std::string& name) {
  std::error_code ignored;
  const std::string extension = std::filesystem::path(name).extension().string();
  const bool is_named_so = extension == ".dot" || extension == ".gv" || extension == ".aut";
  const bool has_scheme = name.starts_with("sim:") || name.starts_with("exec:");
  return !has_scheme && (is_named_so || std::filesystem::is_regular_file(name, ignored));
}

struct LearnedSecond {
  Model model;
  std::string text;      // name and options
  std::string versions;  // "" if the system does not say
  std::string note;      // what its tests left open; "" for nothing
};

// The model as `maide learn` makes it by default, started from the first one.
LearnedSecond learn_second(const CompareArguments& arguments, const Model& first,
                           const RunControl& control) {
  const SystemSpec spec = parse_system_spec(arguments.b, arguments.key_values);
  const auto machine = as_mealy(first);
  const bool is_av = machine && machine->inputs().find(delta_input);
  const Translation translation = is_av ? Translation::av : Translation::eager;
  SystemAccess access;
  access.token_file = arguments.token_file;
  access.translation = translation;
  access.jobs = arguments.jobs;
  const OpenedSystem system = open_system(spec, access, control);
  ExperimentOptions options;
  options.testing.seed = arguments.seed;
  options.testing.budget = test_budget(system.reference.has_value());
  options.confirm = !system.reference;
  if (options.confirm) {
    options.slower = make_slower_system(spec, access, *system.sul, {}, control);
  }
  Mealy old = read_machine(arguments.a, translation);
  if (shares_inputs(old, input_alphabet(system.sul->info()))) options.old_model = std::move(old);
  LearnedModel learned = learn_model(*system.sul, translation, options, control,
                                     machine ? ModelKind::machine : ModelKind::automaton);
  if (!learned.experiment.is_complete()) std::rethrow_exception(learned.experiment.error);
  const Origin origin = describe_origin(system.sul->info());
  const auto versions = origin.find("versions");
  return {*std::move(learned.model), origin_of(spec, spec.options),
          versions == origin.end() ? "" : versions->second,
          learned.experiment.is_weak() ? "the model of the system is weak, so a difference may "
                                         "have been missed"
                                       : ""};
}

std::vector<std::string> name_model_states(const Model& model) {
  if (const auto* automaton = std::get_if<InterfaceAutomaton>(&model)) {
    return name_states(*automaton);
  }
  return name_states(*as_mealy(model));
}

// Both models as one picture, with every difference as a word to step through.
void write_page(const CompareArguments& arguments, const Outcome& outcome, const Names& names,
                const RunControl& control) {
  DifferencePage page =
      make_comparison_page(outcome.pair, outcome.differences, name_model_states(outcome.left),
                           name_model_states(outcome.right));
  page.title = fmt::format("{} and {}", names.left, names.right);
  page.left_name = names.left;
  page.right_name = names.right;
  const std::size_t count = outcome.differences.list.size();
  page.verdict =
      outcome.same ? "They are the same."
      : outcome.is_bound_alone()
          ? fmt::format(
                "They do not contradict each other; one knows what the other never tried, "
                "in {}.",
                counted(count, "place"))
          : fmt::format("They differ: {}.", counted(count, "independent difference"));
  if (outcome.is_initial()) page.notes.emplace_back("The empty word tells them apart, too.");
  for (const std::string& note : outcome.notes) page.notes.push_back(note + ".");
  if (count > most_walks) {
    page.notes.push_back(
        fmt::format("The first {} of {} differences are here.", most_walks, count));
  }
  std::ostringstream text;
  write_difference_page(text, page, [&](const std::string& dot) { return draw_svg(dot, control); });
  if (!can_draw()) {
    log_note("no picture: Graphviz's program dot is not on PATH (Debian: apt install graphviz)");
  }
  write_file_atomically(arguments.html, text.str());
}

// What others call a step that nobody sees: mCRL2, CADP and LOTOS, process algebra.
constexpr auto silent_labels = std::to_array<std::string_view>({"tau", "i", "\u03c4"});

// The traces of a model with opaque labels, without silent steps.
InterfaceAutomaton traces_of(const Model& model, std::vector<std::string>& notes,
                             const RunControl& control) {
  const auto& automaton = std::get<InterfaceAutomaton>(model);
  std::vector<Symbol> silent;
  for (const std::string_view label : silent_labels) {
    if (const auto symbol = automaton.inputs().find(label)) silent.push_back(*symbol);
  }
  for (const Symbol label : silent) {
    const std::string note =
        fmt::format("{} is taken for a step that nobody sees", automaton.inputs().name(label));
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
  }
  return automaton_of_traces(automaton, silent, control);
}

ExitStatus run_compare(const CompareArguments& arguments, Context& context) {
  check_output("--html", arguments.html, {arguments.a, arguments.b});
  const bool is_system = !is_model_file(arguments.b);
  if (!is_system && !arguments.key_values.empty()) {
    throw UsageError(fmt::format("'{}' is an option of a system, and {} is a model",
                                 arguments.key_values.front(), arguments.b));
  }
  ModelReading reading{arguments.initial, ModelReading::Labels::any_where_needed};
  if (is_system) reading.labels = ModelReading::Labels::known;
  Model left = read_model(arguments.a, reading);
  std::optional<LearnedSecond> second;
  if (is_system) second = learn_second(arguments, left, context.control());
  Names names{std::filesystem::path(arguments.a).filename().string(),
              second ? second->text : std::filesystem::path(arguments.b).filename().string()};
  if (names.left == names.right) names = {arguments.a, arguments.b};
  Model right = second ? second->model : read_model(arguments.b, reading);
  std::vector<std::string> notes;
  if (has_opaque_labels(left) || has_opaque_labels(right)) {
    reading.labels = ModelReading::Labels::any;
    notes.emplace_back(
        "labels of other kinds: the traces are compared, and each label stands as an input");
    left = traces_of(read_model(arguments.a, reading), notes, context.control());
    right = traces_of(read_model(arguments.b, reading), notes, context.control());
  }
  Outcome outcome = compare_models(left, right, names, !arguments.html.empty(), context.control());
  outcome.notes.insert(outcome.notes.begin(), notes.begin(), notes.end());
  outcome.json["models"] = {arguments.a, arguments.b};
  outcome.json["differ_in_marks_alone"] = outcome.is_bound_alone();
  Json differences = Json::array();
  for (const Difference& difference : outcome.differences.list) {
    differences.push_back(to_json(outcome.pair, difference));
  }
  outcome.json["differences"] = std::move(differences);
  outcome.json["differences_complete"] = outcome.differences.is_complete;
  outcome.json["notes"] = outcome.notes;
  const bool is_violated = !outcome.same && (arguments.strict || !outcome.is_bound_alone());
  const std::string text = (outcome.is_bound_alone() ? "" : outcome.text) +
                           (outcome.same ? "" : list_differences(outcome, names));
  const std::size_t line = text.find('\n') + 1;
  context.print(text.substr(0, line), outcome.same  ? Tone::good
                                      : is_violated ? Tone::bad
                                                    : Tone::doubtful);
  context.print(text.substr(line));
  for (const std::string& note : outcome.notes) context.print("Note: " + note + ".\n");
  if (second) {
    if (!second->note.empty()) context.print("Beware: " + second->note + ".\n", Tone::doubtful);
    if (!second->versions.empty()) {
      context.print(fmt::format("Note: {} was learned ({}).\n", names.right, second->versions));
    }
    outcome.json["learned"] = {
        {"system", second->text},
        {"versions", second->versions.empty() ? Json() : Json(second->versions)},
        {"weak", !second->note.empty()}};
  }
  if (!arguments.html.empty()) {
    write_page(arguments, outcome, names, context.control());
    outcome.json["html"] = arguments.html;
  }
  context.set_result(outcome.json);
  return is_violated ? ExitStatus::violated : ExitStatus::ok;
}

}  // namespace

RunFunction set_up_compare(CommandLine& line) {
  auto arguments = std::make_shared<CompareArguments>();
  line.add("A", arguments->a, "A model file (.dot, .gv or .aut)").required();
  line.add("B", arguments->b,
           "Another model file, or a system, which is learned ('maide help systems')")
      .required();
  line.add("KEY=VALUE", arguments->key_values, "Options of the system").no_default();
  line.add("--initial", arguments->initial, initial_help).value_name("STATE");
  line.add("--html", arguments->html,
           "Write a page: both models in one picture, and every difference stepped through on both")
      .value_name("FILE");
  line.add_flag(
      "--strict", arguments->strict,
      "Exit status 1 also where one model knows what the other never tried, and that is all");
  add_token_option(line, arguments->token_file);
  add_jobs_option(line, arguments->jobs);
  add_seed_option(line, arguments->seed);
  return [arguments](Context& context) { return run_compare(*arguments, context); };
}

}  // namespace maide::cli
