// `maide check SYSTEM.yaml`: do these programs, with these models, deadlock, or violate what the
// system file says?
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/constant_settings.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/cli/chart_style.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/mpi.hpp"
#include "maide/cli/source_arguments.hpp"
#include "maide/extract/extract.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/join/check_every.hpp"
#include "maide/join/check_system_file.hpp"
#include "maide/join/learned_models.hpp"
#include "maide/join/refine_system.hpp"
#include "maide/join/suggest_change.hpp"
#include "maide/report/check_suite.hpp"
#include "maide/report/every_table.hpp"
#include "maide/report/explanation.hpp"
#include "maide/report/html_report.hpp"
#include "maide/report/junit.hpp"
#include "maide/report/picture.hpp"
#include "maide/report/sarif.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/report/trace_text.hpp"

namespace maide::cli {

namespace {

struct CheckArguments {
  std::vector<std::string> files;  // a system file, or sources
  std::string system;              // the first of them
  SourceArguments sources;
  std::string engine = "native";
  std::string reduction = "none";
  std::vector<std::string> properties;
  std::string trace;
  std::string report;
  std::string junit, sarif;
  std::vector<std::string> settings;
  std::string every;
  std::string trace_format = "chart";
  bool suggest = false;
  std::size_t jobs = 0;  // for models that are learned
  bool refine = false;
  std::size_t refinements = 100;
  std::uint64_t memory_mib = 0;
  unsigned threads = 0;
  std::string checkpoints;
  double checkpoint_seconds = 60;
  double seconds = 0;
};

// "" for a search that is too small for it to matter.
std::string describe_memory(const PropertyResult& result) {
  if (result.states < 10'000 || result.peak_bytes == 0) return "";
  std::string text = fmt::format(", {:.1f} bytes a state", result.bytes_per_state());
  if (result.sent_bytes > 0) {
    text += fmt::format(", {:.1f} sent a state", static_cast<double>(result.sent_bytes) /
                                                     static_cast<double>(result.states));
  }
  return text;
}

// How a trace is written to standard output.
struct TraceStyle {
  TraceFormat format = TraceFormat::chart;
  ChartTextStyle chart;
};

TraceStyle trace_style(const std::string& format) {
  return {format == "steps" ? TraceFormat::steps : TraceFormat::chart, chart_style()};
}

std::string describe(const System& system, const CheckReport& report, const PropertyResult& result,
                     std::size_t width, const TraceStyle& style) {
  std::ostringstream text;
  const bool has_counts = result.states > 0 || result.reason.empty();
  text << fmt::format(
      "{:<{}}  {}  ({}{:.2f} s{})\n", result.name, width, describe_verdict(result),
      has_counts ? fmt::format("{} states, {} transitions, ", result.states, result.transitions)
                 : "",
      result.seconds, describe_memory(result));
  if (!result.reason.empty()) text << "  " << result.reason << "\n";
  if (result.trace) {
    const Shown shown = shown_part(system, result);
    const System& part = shown.part.system();
    if (const PropertyResult* same = find_same_run(report, result)) {
      const std::string again = explain_again(part, shown.property, shown.trace, *same);
      text << wrap(again + ".", style.chart.width, 2);
      return text.str();
    }
    text << wrap(explain(part, shown.property, shown.trace) + ".", style.chart.width, 2);
    write_shown_text(text, shown, style.format, style.chart);
  }
  return text.str();
}

Tone tone_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds: return Tone::good;
    case Verdict::violated: return Tone::bad;
    case Verdict::inconclusive: return Tone::doubtful;
  }
  return Tone::plain;
}

// "verdict: violated (deadlock, stuck)": which properties it is the verdict on, if it is not that
// on all.
std::string first_line(const CheckReport& report) {
  std::vector<std::string> names;
  bool has_impossible = false;
  for (const PropertyResult& result : report.properties) {
    if (result.verdict != report.verdict) continue;
    const bool is_impossible = result.is_possibility && result.verdict == Verdict::violated;
    has_impossible = has_impossible || is_impossible;
    names.push_back(result.name + (is_impossible ? ": not possible" : ""));
  }
  const bool is_of_all = names.size() == report.properties.size() && !has_impossible;
  return "verdict: " + std::string(to_string(report.verdict)) +
         (is_of_all || names.empty() ? "" : " (" + join(names) + ")") + "\n";
}

std::string describe(const System& system, const CheckReport& report, const TraceStyle& style,
                     bool in_full) {
  std::size_t width = 0;
  for (const PropertyResult& result : report.properties) {
    width = std::max(width, result.name.size());
  }
  std::string text;
  for (const PropertyResult& result : report.properties) {
    text += describe(system, report, result, width, style);
  }
  if (report.races) {
    const std::vector<std::string> races = describe_races(*report.races);
    if (!races.empty()) text += "races (what is sent later may come first):\n";
    for (const std::string& race : races) text += "  - " + race + "\n";
  }
  bool is_short = false;
  std::string grounds;
  for (const std::string& assumption : report.assumptions) {
    const auto brief = report.brief.find(assumption);
    const bool is_doubt = std::ranges::find(report.doubts, assumption) != report.doubts.end();
    if (is_doubt && !in_full) continue;  // was said first
    const bool cut = brief != report.brief.end() && !in_full;
    is_short = is_short || cut;
    grounds += "  - " + (cut ? brief->second : assumption) + "\n";
  }
  if (!grounds.empty()) text += is_short ? "this rests on (-v says more):\n" : "this rests on:\n";
  return text + grounds;
}

// Says the result to people: on standard output, or on standard error where something else is
// written to that.
class Speaker {
 public:
  Speaker(Context& context, bool is_beside) : context_(context), is_beside_(is_beside) {}

  void say(const std::string& text, Tone tone = Tone::plain) {
    if (!is_beside_) {
      context_.print(text, tone);
    } else {
      fmt::print(stderr, "{}", paint(printable(text), tone, STDERR_FILENO));
    }
  }
  // The verdict, then what makes it doubtful, then each property.
  void say(const System& system, const CheckReport& report, const TraceStyle& style) {
    say(first_line(report), tone_of(report.verdict));
    for (const std::string& doubt : report.doubts) {
      say("beware: " + doubt + "\n", Tone::doubtful);
    }
    say(describe(system, report, style, context_.verbose()));
  }

 private:
  Context& context_;
  bool is_beside_;
};

std::string describe(const Suggestions& suggestions, bool is_cut_short) {
  if (suggestions.changes.empty()) {
    std::string text =
        is_cut_short
            ? fmt::format("ended early: none of the {} changes that were checked removes it\n",
                          suggestions.tried)
            : fmt::format("no single change removes it, of {} that were checked\n",
                          suggestions.tried);
    if (!suggestions.in_part.empty()) text += "what removes one violation, and not all:\n";
    for (const auto& [property, change] : suggestions.in_part) {
      text += fmt::format("  - {}: {}\n", property, change);
    }
    if (!suggestions.of_one_cause.empty()) text += "what removes this cause, and not all:\n";
    for (const auto& [property, change] : suggestions.of_one_cause) {
      text += fmt::format("  - {}: {}\n", property, change);
    }
    return text;
  }
  std::string text = "what removes it, everything else as it is:\n";
  for (const std::string& change : suggestions.changes) text += "  - " + change + "\n";
  return text;
}

// The first property that is violated by a run; if none is, the first of which a run shows that it
// is possible. Null if there is no run.
const PropertyResult* find_first_run(const CheckReport& report) {
  const PropertyResult* possible = nullptr;
  for (const PropertyResult& result : report.properties) {
    if (!result.trace) continue;
    if (!result.is_possibility) return &result;
    if (possible == nullptr) possible = &result;
  }
  return possible;
}

void write_trace_file(const std::string& path, const System& system, const CheckReport& report) {
  const PropertyResult* const result = find_first_run(report);
  if (result == nullptr) {
    log_note("no run shows anything, so there is no trace to write to " + path);
    return;
  }
  const Json trace = trace_file_to_json(system, result->name, *result->trace);
  write_file_atomically(path, to_json_line(trace) + "\n");
}

// The picture of a model as an <svg> element, drawn by Graphviz; "" where that is not installed.
std::string draw(const InterfaceAutomaton& automaton, const RunControl& control) {
  std::ostringstream dot;
  write_dot(dot, automaton);
  return draw_svg(dot.str(), control);
}

// A page, or, if the name ends in .svg, the chart of the first counterexample alone.
void write_report_file(const std::string& path, const System& system, const CheckReport& report,
                       const RunControl& control) {
  std::ostringstream text;
  if (!path.ends_with(".svg")) {
    write_html_report(text, system, report, [&](const InterfaceAutomaton& automaton) {
      return draw(automaton, control);
    });
    write_file_atomically(path, text.str());
    return;
  }
  const PropertyResult* const result = find_first_run(report);
  if (result == nullptr) {
    log_note("no run shows anything, so there is no chart to write to " + path);
    return;
  }
  const Shown shown = shown_part(system, *result);
  write_sequence_chart_svg(text, make_trace_chart(shown.part.system(), shown.trace,
                                                  result->name + " of " + system.title()));
  write_file_atomically(path, text.str());
}

// A file beside the verdict: if it cannot be written, that is one line, and the verdict stands.
template <typename Write>
void write_beside(const std::string& path, Write&& write) {
  if (path.empty()) return;
  try {
    write();
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    write_error_line(error.what());
  }
}

// The next step of a pipeline reads these, and must not take earlier ones for them. So the error is
// returned where one cannot be written, and the status is not the verdict's.
std::optional<std::string> write_for_pipeline(const CheckArguments& arguments, const System& system,
                                              const CheckReport& report,
                                              const std::vector<SarifNote>& notes) {
  try {
    if (!arguments.junit.empty()) {
      std::ostringstream text;
      write_junit(text, make_check_suite(system, report));
      if (arguments.junit == "-") {
        write_data(text.str());
      } else {
        write_file_atomically(arguments.junit, text.str());
      }
    }
    if (!arguments.sarif.empty()) {
      write_file_atomically(
          arguments.sarif,
          to_json_line(make_sarif(system, report, arguments.system, notes)) + "\n");
    }
  } catch (const Error& error) {
    return error.what();
  }
  return std::nullopt;
}

LearnedModelsOptions learning_options(const CheckArguments& arguments, const RunControl& control) {
  return {{}, [](const std::string& line) { log_note(line); }, control, arguments.jobs};
}

// Once, or until the verdict is confirmed on the real system.
RefinedCheck check(const CheckArguments& arguments, Engine& engine, const CheckRequest& request) {
  const LearnedModelsOptions models = learning_options(arguments, request.options.control);
  if (!arguments.refine) {
    return {check_system_file(arguments.system, engine, request, models,
                              parse_settings(arguments.settings)),
            {}};
  }
  RefinementOptions options;
  options.settings = parse_settings(arguments.settings);
  options.models = models;
  options.most_rounds = arguments.refinements;
  options.on_round = [](const RefinementRound& round) { log_note(to_string(round)); };
  return check_and_refine(arguments.system, engine, request, options);
}

Json refinements_to_json(const std::vector<RefinementRound>& rounds) {
  Json json = Json::array();
  for (const RefinementRound& round : rounds) {
    json.push_back({{"model", round.instance},
                    {"cause", round.cause},
                    {"word", round.word},
                    {"expected", round.expected},
                    {"seen", round.seen},
                    {"states_before", round.states_before},
                    {"states_after", round.states_after}});
  }
  return json;
}

// What shows one check, or makes another system.
void refuse_beside_every(const CheckArguments& arguments) {
  const char* const other = !arguments.trace.empty()    ? "--trace"
                            : !arguments.report.empty() ? "--report"
                            : !arguments.junit.empty()  ? "--junit"
                            : !arguments.sarif.empty()  ? "--sarif"
                            : arguments.suggest         ? "--suggest"
                            : arguments.refine          ? "--refine"
                                                        : nullptr;
  if (other == nullptr) return;
  throw UsageError(std::string("--every and ") + other + " exclude each other");
}

ExitStatus run_every(const CheckArguments& arguments, Engine& engine, const CheckRequest& request,
                     Context& context) {
  const CheckedValues checked = check_every(
      arguments.system, parse_every(arguments.every), engine, request,
      learning_options(arguments, request.options.control), parse_settings(arguments.settings));
  const Verdict verdict = verdict_of(checked);
  context.print(fmt::format("verdict: {}\n", to_string(verdict)), tone_of(verdict));
  std::set<std::string> doubts;
  for (const CheckedValue& value : checked.values) {
    doubts.insert(value.report.doubts.begin(), value.report.doubts.end());
  }
  for (const std::string& doubt : doubts) {
    context.print("beware: " + doubt + "\n", Tone::doubtful);
  }
  context.print_data(describe_every(checked));
  context.set_result(every_to_json(checked));
  return exit_status_of(checked);
}

// ---- C++ sources ----

// What needs a system file that stays.
void refuse_beside_sources(const CheckArguments& arguments) {
  const char* const other = !arguments.trace.empty()   ? "--trace"
                            : !arguments.every.empty() ? "--every"
                            : arguments.suggest        ? "--suggest"
                            : arguments.refine         ? "--refine"
                                                       : nullptr;
  if (other == nullptr) return;
  throw UsageError(std::string(other) + " needs a system file: `maide extract` writes it");
}

// Where nothing tells how many threads run the nodes, the numbers of them that are tried.
std::vector<std::vector<std::string>> settings_to_try(const extract::Extracted& found,
                                                      const CheckArguments& arguments) {
  const bool has_threads = std::ranges::find(found.constants, "threads") != found.constants.end();
  const bool has_cores = std::ranges::find(found.constants, "cores") != found.constants.end();
  if (!arguments.settings.empty() || (!has_threads && !has_cores)) return {arguments.settings};
  std::vector<std::vector<std::string>> all;
  for (const char* number : {"1", "2", "4"}) {
    std::vector<std::string> settings;
    if (has_threads) settings.push_back(std::string("threads=") + number);
    // rclcpp takes the machine's processors, and two of them at least.
    if (has_cores) settings.push_back(std::string("cores=") + (*number == '1' ? "2" : number));
    if (all.empty() || all.back() != settings) all.push_back(settings);
  }
  return all;
}

std::string describe_sources(const extract::Extracted& found) {
  std::string text = fmt::format("read: {} from {}, {}\n", counted(found.nodes, "node"),
                                 counted(found.files, "file"), counted(found.holes.size(), "hole"));
  return text + describe_holes(found) + describe_assumptions(found);
}

int badness(Verdict verdict) {
  return verdict == Verdict::violated ? 2 : verdict == Verdict::inconclusive ? 1 : 0;
}

ExitStatus run_check_of_sources(const CheckArguments& arguments, Engine& engine,
                                const CheckRequest& request, Context& context) {
  refuse_beside_sources(arguments);
  const extract::Extracted found = extract_sources(arguments.files, arguments.sources, context);
  Speaker speaker(context, arguments.junit == "-");
  speaker.say(describe_sources(found));
  const ModelSource models = make_learning_source(learning_options(arguments, context.control()));
  const std::string name = arguments.system + " (what was extracted)";
  std::optional<CheckedSystem> worst;
  Json tried = Json::array();
  for (const std::vector<std::string>& settings : settings_to_try(found, arguments)) {
    if (!settings.empty()) speaker.say(fmt::format("with {}:\n", join(settings)));
    CheckedSystem checked =
        check_system_text(found.system, name, engine, request, models, parse_settings(settings));
    for (const std::string& remark : all_remarks(checked.system, checked.report)) {
      log_note(remark);
    }
    speaker.say(checked.system, checked.report, trace_style(arguments.trace_format));
    tried.push_back({{"settings", settings}, {"verdict", to_string(checked.report.verdict)}});
    const bool is_worse =
        !worst || badness(checked.report.verdict) > badness(worst->report.verdict);
    if (is_worse) worst = std::move(checked);
  }
  Json json = report_to_json(worst->system, worst->report);
  json["extracted"] = {{"system", found.system},
                       {"nodes", found.nodes},
                       {"files", found.files},
                       {"holes", holes_to_json(found)},
                       {"assumptions", found.assumptions},
                       {"tried", tried}};
  context.set_result(json);
  write_beside(arguments.report, [&] {
    write_report_file(arguments.report, worst->system, worst->report, request.options.control);
  });
  std::vector<SarifNote> notes;
  for (const extract::Hole& hole : found.holes) {
    notes.push_back({hole.text, {hole.place.file, hole.place.line, 0}});
  }
  if (const auto failure = write_for_pipeline(arguments, worst->system, worst->report, notes)) {
    return context.fail(*failure, ExitStatus::usage);
  }
  const ExitStatus status = exit_status_of(worst->report);
  return status == ExitStatus::ok && !found.is_whole() ? ExitStatus::inconclusive : status;
}

ExitStatus run_check(const CheckArguments& arguments, Context& context) {
  const std::unique_ptr<Ranks> ranks = open_ranks();
  if (ranks != nullptr && ranks->rank() > 0) {
    context.leave_result_to_another();
    serve_searches(*ranks);
    return ExitStatus::ok;
  }
  const FirstRank first(ranks.get());
  if (!arguments.every.empty()) refuse_beside_every(arguments);
  if (!arguments.report.empty() && !arguments.report.ends_with(".html") &&
      !arguments.report.ends_with(".svg")) {
    throw UsageError("a report's name ends in .html or .svg (" + arguments.report + ")");
  }
  if (context.json() && arguments.junit == "-") {
    throw UsageError("--junit - and --json both write to standard output");
  }
  if (arguments.junit != "-") {
    check_output("--junit", arguments.junit, {arguments.system, arguments.trace, arguments.report});
  }
  check_output("--sarif", arguments.sarif,
               {arguments.system, arguments.trace, arguments.report, arguments.junit});
  const std::unique_ptr<Engine> engine = make_engine(arguments.engine);
  CheckRequest request;
  request.properties = arguments.properties;
  request.options.ranks = ranks.get();
  if (ranks != nullptr) {
    log_note(fmt::format("{} ranks search together", ranks->size()));
    if (leaves_out_orders(reduction_of(arguments.reduction))) {
      log_note(
          "with --reduction order and full the first rank alone searches for `stuck` and "
          "formulas other than `always`");
    }
  }
  request.options.reduction = reduction_of(arguments.reduction);
  request.options.control = context.control();
  request.options.threads = arguments.threads;
  request.options.checkpoints = arguments.checkpoints;
  request.options.checkpoint_seconds = arguments.checkpoint_seconds;
  if (arguments.memory_mib > 0) request.options.memory_mib = arguments.memory_mib;
  if (arguments.seconds > 0) request.options.control.deadline = deadline_in(arguments.seconds);
  if (std::ranges::all_of(arguments.files, names_sources)) {
    request.finds_races = true;
    return run_check_of_sources(arguments, *engine, request, context);
  }
  if (arguments.files.size() > 1) {
    throw UsageError("unexpected argument '" + arguments.files[1] +
                     "': one system file, or C++ sources alone");
  }
  if (!arguments.every.empty()) return run_every(arguments, *engine, request, context);
  request.finds_races = true;
  RefinedCheck checked = check(arguments, *engine, request);
  const System& system = checked.system;
  CheckReport& report = checked.report;
  for (const std::string& remark : all_remarks(system, report)) log_note(remark);
  Speaker speaker(context, arguments.junit == "-");
  speaker.say(system, report, trace_style(arguments.trace_format));
  Json json = report_to_json(system, report);
  if (arguments.refine) json["refinements"] = refinements_to_json(checked.rounds);
  if (arguments.suggest && report.verdict == Verdict::violated) {
    SuggestOptions options;
    options.models = make_learning_source(learning_options(arguments, request.options.control));
    options.note = [](const std::string& line) { log_note(line); };
    options.explain = [](const System& changed, const PropertyResult& result) {
      const Shown shown = shown_part(changed, result);
      return explain(shown.part.system(), shown.property, shown.trace);
    };
    options.control = request.options.control;
    const Suggestions suggestions = suggest_changes(system, report, options);
    speaker.say(describe(suggestions, options.control.should_stop()));
    json["suggestions"] = suggestions.changes;
  }
  context.set_result(json);
  write_beside(arguments.trace, [&] { write_trace_file(arguments.trace, system, report); });
  write_beside(arguments.report, [&] {
    write_report_file(arguments.report, system, report, request.options.control);
  });
  if (const auto failure = write_for_pipeline(arguments, system, report, {})) {
    return context.fail(*failure, ExitStatus::usage);
  }
  return exit_status_of(report);
}

}  // namespace

RunFunction set_up_check(CommandLine& line) {
  auto arguments = std::make_shared<CheckArguments>();
  line.add("SYSTEM", arguments->files,
           "A system file (YAML); or C++ sources of ROS 2 nodes, or folders of them")
      .required();
  line.add(
          "--engine", arguments->engine,
          "Which engine decides: native, spin or ltsmin. Native is Maide's own. Spin is a "
          "reference that knows no `stuck`, no X, no strong fairness and no `fair`, and needs spin "
          "and a C compiler. Ltsmin knows `deadlock`, `error` and `always` alone, and needs LTSmin "
          "and a C++ compiler")
      .offer({"native", "spin", "ltsmin"})
      .value_name("NAME");
  line.add("--reduction", arguments->reduction,
           "What native leaves out: none, calls, order or full. It does so where the property "
           "allows it. Calls: states between an input and the output that answers it; order: all "
           "but one order of steps that do not disturb one another; full: both, and states with "
           "a single step")
      .offer({"none", "calls", "order", "full"})
      .value_name("NAME");
  line.add("--property", arguments->properties,
           "Check this property alone; once or more. Default: deadlock, stuck and all "
           "properties of the file")
      .no_default()
      .one_each()
      .value_name("NAME");
  line.add("--trace", arguments->trace,
           "Write the first counterexample to this file (JSON), or the run that shows what is "
           "possible")
      .value_name("FILE");
  line.add("--trace-format", arguments->trace_format,
           "How a counterexample is shown: chart or steps. A chart is a message sequence chart, if "
           "it "
           "fits the terminal; steps are a line each")
      .one_of({"chart", "steps"})
      .value_name("FORMAT");
  line.add("--report", arguments->report,
           "Write a page (.html), or the first chart (.svg). The page has verdicts, charts and "
           "pictures of the models; the chart is that of the first counterexample")
      .value_name("FILE");
  line.add("--junit", arguments->junit,
           "Write a JUnit XML file, a case a property. - is standard output")
      .value_name("FILE");
  line.add("--sarif", arguments->sarif,
           "Write a SARIF file, for editors and code reviews: violations at their lines, with runs")
      .value_name("FILE");
  add_set_option(line, arguments->settings);
  line.add("--every", arguments->every,
           "Check with every value: n=1..8 of a constant, via.depth=1..8 of a queue. via.depth "
           "alone takes 1, 2, 3, ... up to one that is never filled: a larger one changes nothing")
      .value_name("WHAT");
  line.add_flag("--suggest", arguments->suggest,
                "Look for the smallest change that removes a violation. It may be other models, "
                "other settings (learned where possible), other values of constants, other numbers "
                "of repetitions. Each change is checked");
  line.add("--memory", arguments->memory_mib,
           "Most memory of a search. Default: three quarters of the machine's")
      .between(1, std::uint64_t{1} << 30)
      .no_default()
      .value_name("MIB");
  line.add("--threads", arguments->threads,
           "How many threads of native or ltsmin search. Verdicts do not depend on it, nor what is "
           "counted where a property holds without reduction. Default: one a processor")
      .between(1, 1024)
      .no_default()
      .value_name("NUMBER");
  line.add("--time", arguments->seconds,
           "Most seconds in all. What is not decided by then is inconclusive")
      .check(check_seconds)
      .no_default();
  line.add("--checkpoint", arguments->checkpoints,
           "Write how far native's searches have come to this folder, and begin where one that was "
           "stopped had come to, even by kill -9. With any number of threads and ranks. Not for "
           "`stuck` and formulas other than `always`")
      .value_name("FOLDER");
  line.add("--checkpoint-interval", arguments->checkpoint_seconds,
           "Least seconds between two checkpoints, and at least twenty times what the last took; "
           "0: at "
           "the end of each level")
      .number_between(0, 1e6)
      .value_name("SECONDS");
  add_jobs_option(line, arguments->jobs);
  line.add_flag("--refine", arguments->refine,
                "Believe no verdict before the real system was asked. A counterexample is replayed "
                "on it; if there is none, the models are tested again. Models under `learn:` are "
                "learned on where the system differs");
  line.add("--refinements", arguments->refinements,
           "Most refinements of --refine. Then the verdict is inconclusive")
      .between(1, 1'000'000);
  add_source_options(line, arguments->sources);
  return [arguments](Context& context) {
    arguments->system = arguments->files.front();
    return run_check(*arguments, context);
  };
}

}  // namespace maide::cli
