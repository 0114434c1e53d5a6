// `maide test MODEL [SUL [KEY=VALUE...]]`: whether a running system does what a model says, as a
// step of continuous integration. The verdict comes first, and a JUnit file has a case for each
// transition of the model.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/base/version.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/test_arguments.hpp"
#include "maide/experiment/conformance_run.hpp"
#include "maide/experiment/experiment.hpp"
#include "maide/experiment/known_models.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/formats/names.hpp"
#include "maide/learn/learner.hpp"
#include "maide/report/difference_page.hpp"
#include "maide/report/junit.hpp"
#include "maide/report/picture.hpp"
#include "maide/report/state_names.hpp"
#include "maide/sul/ia_translation.hpp"

namespace maide::cli {
namespace {

struct TestCommandArguments {
  std::string model;
  std::string sul;
  std::vector<std::string> key_values;
  std::string junit;
  std::string html;
  std::string cache;
  std::string words;
  TestArguments tests;
  std::optional<double> time_limit;
  std::uint64_t seed = 1;
  SystemAccess access;  // the translation is the model's
};

// All that the report speaks of.
struct Report {
  const TestCommandArguments& arguments;
  const ConformanceResult& result;
  std::string system;           // name and options
  std::string shown;            // name and options, without those that are as they are by default
  std::string bound;            // of the system's own learning purpose
  std::string versions;         // of the system
  std::string learned;          // versions that the model was learned from; "" if it does not say
  std::optional<Error> ending;  // why the run ended early
  std::vector<std::string> states;  // names; empty: named by the words that lead there
};

// Behind the state's first step whose name begins so; the state itself if there is none.
StateId follow(const InterfaceAutomaton& automaton, StateId state, const std::string& name) {
  for (const auto& transition : automaton.transitions(state)) {
    const std::string step = automaton.name(transition.action);
    if (name == "!" ? step.starts_with(name) : step == name) return transition.target;
  }
  return state;
}

// The names of an interface automaton's states, for the machine's states: each at rest behind the
// machine's access word. Empty where the file has a machine.
std::vector<std::string> find_state_names(const std::string& file,
                                          const ConformanceResult& result) {
  const Model model = read_model(file);
  const auto* automaton = std::get_if<InterfaceAutomaton>(&model);
  if (automaton == nullptr || result.model.inputs().find(delta_input)) return {};
  const std::vector<std::string> names = name_states(*automaton);
  std::vector<std::string> found;
  for (const Word& word : result.access) {
    StateId state = automaton->initial();
    for (const Symbol input : word) {
      state = follow(*automaton, state, "?" + result.model.inputs().name(input));
      while (!automaton->is_quiescent(state)) state = follow(*automaton, state, "!");
    }
    found.push_back(names[state]);
  }
  return found;
}

std::string find_origin(const Mealy& model, const std::string& key) {
  const auto found = model.origin.find(key);
  return found == model.origin.end() ? "" : found->second;
}

SystemSpec find_system(const TestCommandArguments& arguments, const Mealy& model) {
  if (!arguments.sul.empty()) return parse_system_spec(arguments.sul, arguments.key_values);
  const std::string sul = find_origin(model, "sul");
  if (sul.empty()) {
    throw UsageError(fmt::format(
        "the model does not say what it was learned from (graph attribute 'sul'): name the "
        "system, maide test {} SUL ({})",
        arguments.model, arguments.model));
  }
  std::vector<std::string> words = split_shell_words(sul);
  if (words.empty()) throw UsageError("the name of its system is empty (" + arguments.model + ")");
  const std::string name = std::move(words.front());
  words.erase(words.begin());
  SystemSpec spec = parse_system_spec(name, words);
  if (spec.kind == SystemSpec::Kind::simulated) {
    const auto beside = std::filesystem::path(arguments.model).parent_path() / spec.target;
    if (std::filesystem::exists(beside)) spec.target = beside.string();
  }
  return spec;
}

// A model names all options of its system. What differs from the defaults tells people more.
std::string describe_shortly(const SystemSpec& spec, const SystemAccess& access,
                             const RunControl& control) {
  constexpr std::size_t few = 3;
  if (spec.kind != SystemSpec::Kind::wrapper || spec.options.size() <= few) {
    return origin_of(spec, spec.options);
  }
  std::map<std::string, std::string> options = spec.options;
  for (const OptionSpec& row : list_system_options(spec, access, control)) {
    for (auto option = options.begin(); option != options.end();) {
      const bool is_default =
          same_key(option->first, row.key) && option->second == row.default_value;
      option = is_default ? options.erase(option) : std::next(option);
    }
  }
  return origin_of(spec, options);
}

// Tests that end by themselves have their own size; any others end at a limit.
bool has_size_of_its_own(const std::string& method) {
  return method.starts_with("random-") && method.find(',') == std::string::npos;
}

ConformanceOptions conformance_options(const TestCommandArguments& arguments,
                                       const OpenedSystem& system) {
  ConformanceOptions options;
  options.test_method = arguments.tests.method;
  options.testing = arguments.tests.read();
  options.testing.seed = arguments.seed;
  if (!has_size_of_its_own(arguments.tests.method)) {
    std::swap(options.max_tests, options.testing.max_tests);
  }
  options.testing.budget = test_budget(system.reference.has_value());
  options.reference = system.reference ? &*system.reference : nullptr;
  options.cache_file = arguments.cache;
  options.confirm = !system.reference;
  return options;
}

// ---- Words ----

std::vector<std::string> names_of(const Word& word, const Mealy& model) {
  std::vector<std::string> names;
  for (const Symbol input : word) names.push_back(model.inputs().name(input));
  return names;
}

std::string after(const Word& word, const Mealy& model) {
  return word.empty() ? "at the start" : "after " + join(names_of(word, model));
}

// "message", "nothing", "refuses it": what follows "the model".
std::string in_words(const std::string& output, const Report& report, bool is_model) {
  if (output == "quiet") return "nothing";
  if (output == "refused") return "a refusal";
  if (output == "crash") return "a crash";
  if (output == "hang") return "a hang";
  if (is_never_tried(output) && !is_model) {
    return "is not tried there" + (report.bound.empty() ? "" : " (" + report.bound + ")");
  }
  return output;
}

// "after write, write, read: the model gives message, the system nothing".
std::string describe(const Word& word, const std::string& expected, const std::string& observed,
                     const Report& report) {
  return fmt::format("{}: the model gives {}, the system {}", after(word, report.result.model),
                     in_words(expected, report, true), in_words(observed, report, false));
}

std::string describe(const ConformanceFailure& failure, const Report& report) {
  return describe(failure.word, failure.expected, failure.observed, report);
}

std::string covered(const Coverage& coverage, std::string_view what) {
  return fmt::format("{} of {} {}", coverage.covered, coverage.total, what);
}

std::string verdict(const Report& report) {
  if (!report.result.failures.empty()) return "differs";
  return report.ending ? "not finished" : "conforms";
}

std::string first_line(const Report& report) {
  const ConformanceResult& result = report.result;
  const std::string model = std::filesystem::path(report.arguments.model).filename().string();
  if (!result.failures.empty()) {
    return fmt::format("Differs: {}\n", describe(result.failures.front(), report));
  }
  if (report.ending) {
    return fmt::format("Not finished: no difference so far between {} and {}\n", model,
                       report.shown);
  }
  return fmt::format("Conforms: no test tells {} from {}\n", report.shown, model);
}

// What the tests establish. Transitions that differ are passed by, so it holds of the others.
std::string describe_tests(const ConformanceResult& result) {
  return (result.failures.empty() ? "" : "but for these differences: ") + result.guarantee;
}

std::string describe_rest(const Report& report) {
  const ConformanceResult& result = report.result;
  const std::size_t inputs = result.model.inputs().size();
  std::string text;
  for (std::size_t i = 1; i < result.failures.size(); ++i) {
    text += fmt::format("  also       {}\n", describe(result.failures[i], report));
  }
  for (const UnsteadyWord& word : result.unsteady) {
    text += fmt::format("  waits      {}; with longer waits they agree\n",
                        describe(word.word, word.expected, word.observed, report));
  }
  text += fmt::format("  system     {}{}\n", report.shown,
                      report.versions.empty() ? "" : " (" + report.versions + ")");
  if (!report.learned.empty() && report.learned != report.versions) {
    text += fmt::format("  learned    from other versions ({})\n", report.learned);
  }
  text += fmt::format("  covered    {}, {}, {}\n", covered(result.states, "states"),
                      covered(result.transitions, "transitions"),
                      covered(result.pairs, "pairs of transitions"));
  const std::size_t untried = result.model.size() * inputs - result.transitions.total;
  if (untried > 0) {
    text += fmt::format("  not judged {} of states where the model was never tried\n",
                        counted(untried, "input"));
  }
  if (!result.other_inputs.empty()) {
    text += fmt::format("  not tested inputs that the model does not have: {}\n",
                        join(result.other_inputs));
  }
  text += fmt::format("  asked      {} words, {} inputs, in {:.1f} s\n", result.words,
                      result.symbols, result.seconds);
  text += fmt::format("  tests      {}\n", describe_tests(result));
  if (!result.shortfall.empty()) {
    text += fmt::format("  weak       not reached: {}; --effort pays for more\n", result.shortfall);
  }
  return text;
}

// ---- For programs ----

Json to_json(const Coverage& coverage) {
  return {{"covered", coverage.covered}, {"total", coverage.total}};
}

Json to_json(const Report& report) {
  const ConformanceResult& result = report.result;
  Json failures = Json::array(), unsteady = Json::array();
  for (const ConformanceFailure& failure : result.failures) {
    failures.push_back({{"word", names_of(failure.word, result.model)},
                        {"expected", failure.expected},
                        {"seen", failure.observed},
                        {"text", describe(failure, report)}});
  }
  for (const UnsteadyWord& word : result.unsteady) {
    unsteady.push_back({{"word", names_of(word.word, result.model)},
                        {"expected", word.expected},
                        {"seen", word.observed}});
  }
  const auto or_null = [](const std::string& text) { return text.empty() ? Json() : Json(text); };
  return {{"verdict", verdict(report)},
          {"model", report.arguments.model},
          {"system", report.system},
          {"versions", or_null(report.versions)},
          {"learned_from_versions", or_null(report.learned)},
          {"seed", report.arguments.seed},
          {"failures", failures},
          {"unsteady", unsteady},
          {"covered",
           {{"states", to_json(result.states)},
            {"transitions", to_json(result.transitions)},
            {"pairs", to_json(result.pairs)}}},
          {"not_tested_inputs", result.other_inputs},
          {"words", result.words},
          {"symbols", result.symbols},
          {"seconds", result.seconds},
          {"tests", describe_tests(result)},
          {"not_reached", or_null(result.shortfall)},
          {"junit", or_null(report.arguments.junit)},
          {"html", or_null(report.arguments.html)}};
}

JUnitSuite to_junit(const Report& report) {
  const ConformanceResult& result = report.result;
  const Mealy& model = result.model;
  JUnitSuite suite;
  suite.name = std::filesystem::path(report.arguments.model).stem().string();
  suite.seconds = result.seconds;
  suite.properties = {{"model", report.arguments.model},
                      {"system", report.system},
                      {"versions", report.versions},
                      {"learned from versions", report.learned},
                      {"seed", std::to_string(report.arguments.seed)},
                      {"words", std::to_string(result.words)},
                      {"covered states", covered(result.states, "states")},
                      {"covered transitions", covered(result.transitions, "transitions")},
                      {"covered pairs", covered(result.pairs, "pairs of transitions")},
                      {"tests", describe_tests(result)},
                      {"maide", std::string(version())}};
  if (report.ending) suite.error = report.ending->what();
  for (StateId state = 0; state < model.size(); ++state) {
    for (Symbol input = 0; input < model.inputs().size(); ++input) {
      const std::size_t place = std::size_t{state} * model.inputs().size() + input;
      JUnitCase one;
      one.name = model.inputs().name(input) + ", " +
                 (report.states.empty() ? after(result.access[state], model)
                                        : "state: " + report.states[state]);
      const auto failure =
          std::ranges::find_if(result.failures, [&](const ConformanceFailure& candidate) {
            return candidate.state == state && candidate.input == input;
          });
      if (failure != result.failures.end()) {
        one.failure = describe(*failure, report);
        one.details = "word: " + join(names_of(failure->word, model), " ") +
                      "\nmodel: " + failure->expected + "\nsystem: " + failure->observed + "\n";
      } else if (result.never_tried[place]) {
        one.skipped = "the model was never tried here";
      } else if (!result.covered[place]) {
        one.skipped =
            result.failures.empty() ? "no test came here" : "no test came here that agreed before";
      }
      suite.cases.push_back(std::move(one));
    }
  }
  return suite;
}

// ---- The command ----

std::optional<Error> ending_of(const ConformanceResult& result, bool is_strength_demanded) {
  if (result.error) {
    try {
      std::rethrow_exception(result.error);
    } catch (const Error& error) {
      return error;
    }
  }
  if (!result.unsteady.empty()) {
    return Error(ExitStatus::inconclusive,
                 fmt::format("the system's answers depend on how long it is waited for, in {} "
                             "words",
                             result.unsteady.size()));
  }
  if (is_strength_demanded && !result.shortfall.empty()) {
    return Error(ExitStatus::inconclusive,
                 "the tests did not reach what --strength demands: " + result.shortfall);
  }
  return std::nullopt;
}

std::string to_page(const Report& report) {
  const ConformanceResult& result = report.result;
  std::vector<std::string> states = report.states;
  if (states.empty()) {
    for (const Word& word : result.access)
      states.push_back(describe_word(names_of(word, result.model)));
  }
  std::vector<std::string> titles;
  for (const ConformanceFailure& failure : result.failures) {
    titles.push_back(describe(failure, report));
  }
  DifferencePage page = make_conformance_page(result, states, titles);
  page.title =
      std::filesystem::path(report.arguments.model).filename().string() + " and " + report.shown;
  page.left_name = report.arguments.model;
  page.right_name = report.system;
  const std::string verdict_line = first_line(report);
  page.verdict = trim(verdict_line);
  if (report.ending) page.notes.emplace_back(report.ending->what());
  const std::string rest = describe_rest(report);
  for (const std::string_view line : split_lines(rest)) page.notes.emplace_back(trim(line));
  std::ostringstream text;
  // Also where the run was interrupted.
  write_difference_page(text, page, [](const std::string& dot) { return draw_svg(dot, {}); });
  return std::move(text).str();
}

// Writes what `make` makes. Returns the error where it cannot be written: the verdict is said all
// the same.
template <typename Make>
std::optional<std::string> write_report(const std::string& path, Make&& make) {
  if (path.empty()) return std::nullopt;
  try {
    if (path == "-") {
      write_data(make());
    } else {
      write_file_atomically(path, make());
    }
  } catch (const Error& error) {
    return error.what();
  }
  return std::nullopt;
}

ExitStatus give(const Report& report, Context& context) {
  std::optional<std::string> failure = write_report(report.arguments.junit, [&] {
    std::ostringstream text;
    write_junit(text, to_junit(report));
    return std::move(text).str();
  });
  const auto page_failure = write_report(report.arguments.html, [&] { return to_page(report); });
  if (!failure) failure = page_failure;
  const Tone tone = !report.result.failures.empty() ? Tone::bad
                    : report.ending                 ? Tone::doubtful
                                                    : Tone::good;
  const std::string rest = context.quiet() ? std::string() : describe_rest(report);
  if (report.arguments.junit == "-") {
    fmt::print(stderr, "{}{}", paint(first_line(report), tone, STDERR_FILENO), printable(rest));
  } else {
    context.print(first_line(report), tone);
    context.print(rest);
  }
  context.set_result(to_json(report));
  if (failure) return context.fail(*failure, ExitStatus::usage);
  if (!report.result.failures.empty()) {
    if (report.ending) context.complain(report.ending->what());
    return ExitStatus::violated;
  }
  if (report.ending) return context.fail(report.ending->what(), report.ending->status());
  return ExitStatus::ok;
}

ExitStatus test(const TestCommandArguments& arguments, Context& context) {
  arguments.tests.check(std::string(learners().front().name));
  if (context.json() && arguments.junit == "-") {
    throw UsageError("--junit - and --json both write to standard output");
  }
  if (arguments.junit != "-") {
    check_output("--junit", arguments.junit, {arguments.model, arguments.cache, arguments.words});
  }
  check_output("--html", arguments.html,
               {arguments.model, arguments.cache, arguments.words, arguments.junit});
  RunControl control = context.control();
  const Mealy eager = read_machine(arguments.model, Translation::eager);
  const Translation translation =
      eager.inputs().find(delta_input) ? Translation::av : Translation::eager;
  const SystemSpec spec = find_system(arguments, eager);
  SystemAccess access = arguments.access;
  access.translation = translation;
  const OpenedSystem system = open_system(spec, access, control);
  if (arguments.time_limit) control.deadline = deadline_in(*arguments.time_limit);
  ConformanceOptions options = conformance_options(arguments, system);
  TraceLog words;
  if (!arguments.words.empty()) {
    words = read_traces(arguments.words, control);
    options.words = &words;
  }
  if (options.confirm) {
    options.slower = make_slower_system(spec, access, *system.sul, {}, context.control());
  }
  IaTranslator translator(*system.sul, translation);
  const ConformanceResult result = test_conformance(translator, eager, options, control);
  const SulInfo& info = system.sul->info();
  const Origin now = describe_origin(info);
  const auto versions = now.find("versions");
  const Report report{arguments,
                      result,
                      origin_of(spec, spec.options),
                      describe_shortly(spec, access, context.control()),
                      info.bound,
                      versions == now.end() ? "" : versions->second,
                      find_origin(eager, "versions"),
                      ending_of(result, !options.testing.strength.empty()),
                      find_state_names(arguments.model, result)};
  return give(report, context);
}

}  // namespace

RunFunction set_up_test(CommandLine& line) {
  auto arguments = std::make_shared<TestCommandArguments>();
  line.add("MODEL", arguments->model, "A model file (.dot, .gv or .aut)").required();
  line.add("SUL", arguments->sul,
           "The system ('maide help systems'). Default: the one that the model was learned from, "
           "with its options. Another version of it is no error")
      .no_default();
  line.add("KEY=VALUE", arguments->key_values, "Options of the system").no_default();
  line.add("--junit", arguments->junit,
           "Write a JUnit XML file, a case a transition. - is standard output")
      .value_name("FILE");
  line.add("--html", arguments->html,
           "Write a page: the model with what was tested, and each failing word stepped through")
      .value_name("FILE");
  add_test_options(line, arguments->tests);
  line.add("--time", arguments->time_limit, "Most seconds. Then the exit status is 3")
      .check(check_seconds);
  line.add(
          "--words", arguments->words,
          "Ask these words first: a cache or a log. 'maide learn --cache' keeps the words that the "
          "model was learned with; a log has a line of JSON a trace, as --from-traces reads it")
      .value_name("FILE");
  line.add("--cache", arguments->cache,
           "Keep every answer in this file. A run that was ended resumes there")
      .value_name("FILE");
  add_access_options(line, arguments->access);
  add_seed_option(line, arguments->seed);
  return [arguments](Context& context) { return test(*arguments, context); };
}

}  // namespace maide::cli
