// `maide learn`: learns a model of a running system and writes it as DOT.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <own_wrappers.hpp>  // made by the build
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/log.hpp"
#include "maide/base/run_control.hpp"
#include "maide/base/text.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/command_line.hpp"
#include "maide/cli/learn_report.hpp"
#include "maide/cli/test_arguments.hpp"
#include "maide/experiment/known_models.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/nondeterministic_run.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/experiment/pacing.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/passive/rpni.hpp"
#include "maide/sul/learning_purpose.hpp"
#include "maide/wire/protocol/json_members.hpp"

namespace maide::cli {

// `maide learn --from-traces LOG` without a system: a model from the log alone.

// `output`: the model's file; empty: standard output.
ExitStatus learn_from_traces(const std::string& log, const std::string& output,
                             const RunControl& control, Context& context);

ExitStatus learn_from_traces(const std::string& log, const std::string& output,
                             const RunControl& control, Context& context) {
  if (!output.empty()) check_can_write(output);
  const TraceLog traces = read_traces(log, control);
  PassiveModel learned = learn_passively(traces, control);
  Mealy& machine = learned.machine;
  machine.origin["algorithm"] = "rpni";
  machine.origin["passive"] =
      fmt::format("learned from {} traces alone: no system was asked", traces.traces.size());
  std::ostringstream dot;
  write_dot(dot, machine);

  std::string summary = fmt::format(
      "{}: {} traces\n"
      "  Mealy machine        {} states, {} inputs (passive: RPNI)\n"
      "  never seen           {} transitions, drawn as loops that answer 'unexplored'\n"
      "  result               agrees with every trace; what it says beyond them is a guess\n",
      log, traces.traces.size(), machine.size(), machine.inputs().size(),
      learned.unseen_transitions);
  Json result{{"algorithm", "rpni"},
              {"passive", true},
              {"traces", traces.traces.size()},
              {"states", machine.size()},
              {"transitions", machine.size() * machine.inputs().size()},
              {"unseen_transitions", learned.unseen_transitions},
              {"model", output.empty() ? Json() : Json(output)}};
  if (output.empty()) {
    if (!context.json() && !context.quiet()) fmt::print(stderr, "{}", printable(summary));
    context.print_data(dot.str());
    result["dot"] = dot.str();
  } else {
    write_file_atomically(output, dot.str());
    if (context.quiet()) summary = fmt::format("{}: {} states (passive)\n", output, machine.size());
    context.print(context.quiet() ? summary
                                  : summary + fmt::format("  model                {}\n", output));
  }
  context.set_result(result);
  return ExitStatus::ok;
}

namespace {

struct LearnArguments {
  std::string sul;
  std::vector<std::string> key_values;
  std::string output;
  std::string algorithm{learners().front().name};
  std::string kind;  // "mealy", "ia"; "": as the system is
  std::string translation;
  std::string cache;
  std::string plot;
  std::string purpose;
  std::string start_from;
  std::string from_traces;
  std::vector<std::string> error_outputs;
  TestArguments tests;
  std::uint64_t max_experiments = 0;
  std::optional<double> time_limit;
  std::uint64_t seed = 1;
  SystemAccess access;  // the translation is of the two above
  VoteOptions vote;
  std::string confirm;
  bool list_options = false;
};

// A simulated Mealy machine is taken for an interface automaton if either is asked for.
std::optional<Translation> wanted_translation(const LearnArguments& arguments) {
  if (arguments.translation.empty() && arguments.kind != "ia") return std::nullopt;
  return arguments.translation == "av" ? Translation::av : Translation::eager;
}

// A deterministic simulation needs no second look.
bool is_to_be_confirmed(const LearnArguments& arguments, const OpenedSystem& system) {
  if (!arguments.confirm.empty()) return arguments.confirm == "yes";
  return !system.reference;
}

ExperimentOptions experiment_options(const LearnArguments& arguments, const Mealy* reference) {
  ExperimentOptions options;
  options.algorithm = arguments.algorithm;
  options.test_method = arguments.tests.method;
  options.testing = arguments.tests.read();
  options.testing.seed = arguments.seed;
  options.reference = reference;
  options.cache_file = arguments.cache;
  options.max_experiments = arguments.max_experiments;
  options.vote = arguments.vote;
  options.error_outputs = arguments.error_outputs;
  return options;
}

// A file that cannot be written after all (a full disk) does not cost the model: it goes to
// standard output.
ExitStatus rescue(const LearnedModel& learned, std::size_t jobs, const std::string& dot,
                  const Error& failure, Context& context) {
  context.print_data(dot);
  Json json = learned_as_json(learned, jobs, "");
  json["dot"] = dot;
  context.set_result(json);
  return context.fail(failure.what(), failure.status());
}

// What was asked for, as typed, and how many systems were asked at once.
struct Request {
  const SystemSpec& spec;
  const CommandLine& line;
  std::size_t jobs;
};

// ". Go on: maide learn ..."; empty where nothing would help.
std::string go_on(const LearnedModel& learned, const LearnArguments& arguments,
                  const CommandLine& line) {
  const std::string command =
      describe_next_command(line, learned.experiment,
                            {arguments.tests.read().effort, learned.model ? arguments.output : ""});
  return command.empty() ? "" : ". Go on: " + command;
}

// The first line for a weak model; empty for any other.
std::string first_line(const LearnedModel& learned, const LearnArguments& arguments,
                       const CommandLine& line) {
  const ExperimentResult& run = learned.experiment;
  if (!run.is_weak() || !learned.model) return "";
  return describe_weakness(run) + go_on(learned, arguments, line) + "\n";
}

// Writes the model where it belongs: to the file, or, for people who gave none, to standard output
// with the summary on standard error.
ExitStatus give_result(const LearnedModel& learned, const LearnArguments& arguments,
                       const Request& request, Context& context) {
  const auto& [spec, line, jobs] = request;
  const std::string& path = arguments.output;
  std::string dot;
  if (learned.model) {
    std::ostringstream text;
    write_dot(text, *learned.model);
    dot = text.str();
  }
  const std::string written = dot.empty() ? "" : path;
  try {
    if (!written.empty()) write_file_atomically(written, dot);
  } catch (const Error& failure) {
    return rescue(learned, jobs, dot, failure, context);
  }
  std::string summary = context.quiet()
                            ? describe_briefly(learned, written)
                            : first_line(learned, arguments, line) +
                                  describe_learned(learned, spec, arguments.vote, jobs, written);
  if (context.verbose()) summary += describe_statistics(learned.experiment);
  if (written.empty()) {
    if (!context.json() && !context.quiet()) fmt::print(stderr, "{}", printable(summary));
    if (context.quiet() && !context.json() && learned.experiment.is_weak()) {
      context.complain("the model is weak");
    }
    context.print_data(dot);
  } else {
    context.print(summary);
  }
  Json result = learned_as_json(learned, jobs, written);
  if (!arguments.from_traces.empty()) {
    result["log_contradictions"] = contradictions_as_json(learned.experiment.log_contradictions);
  }
  result["start_from"] = arguments.start_from.empty() ? Json() : Json(arguments.start_from);
  if (written.empty() && !dot.empty()) result["dot"] = dot;
  context.set_result(result);
  return ExitStatus::ok;
}

// What is learned from a simulated Moore machine or DFA is one.
void keep_kind(LearnedModel& learned, const Mealy& reference) {
  const auto initial_output = find_initial_output(reference);
  if (!initial_output || !learned.model) return;
  if (auto* machine = std::get_if<Mealy>(&*learned.model)) {
    mark_as_moore(*machine, reference.origin.at("type"), *initial_output);
    *machine = split_states(*machine);
  }
}

// As a wrapper's hello has them.
ExitStatus list_options(const SystemSpec& spec, const SystemAccess& access, Context& context) {
  const std::vector<OptionSpec> table = list_system_options(spec, access, context.control());
  context.print(table.empty() ? spec.text + " has no options\n" : to_string(table));
  Json options = Json::array();
  for (const OptionSpec& option : table) options.push_back(protocol::option_json(option));
  context.set_result({{"system", spec.text}, {"options", options}});
  return ExitStatus::ok;
}

// The name that a wrapper gives itself does not lead back to one that was reached by a command or
// an address.
void keep_origin(LearnedModel& learned, const SystemSpec& spec, const SulInfo& info) {
  const bool is_named =
      spec.kind == SystemSpec::Kind::program || spec.kind == SystemSpec::Kind::tcp;
  if (!learned.model || !is_named) return;
  std::visit([&](auto& model) { model.origin["sul"] = origin_of(spec, info.options); },
             *learned.model);
}

// A file that is written must be none of those that are read or written otherwise.
void check_distinct(const LearnArguments& arguments) {
  const std::pair<std::string, std::string> files[]{{"--output", arguments.output},
                                                    {"--plot", arguments.plot},
                                                    {"--cache", arguments.cache},
                                                    {"--from-traces", arguments.from_traces},
                                                    {"--purpose", arguments.purpose}};
  for (auto left = std::begin(files); left != std::end(files); ++left) {
    for (auto right = left + 1; right != std::end(files); ++right) {
      // A cache may be a log of its own run; nothing else may meet.
      if (left->first == "--cache" && right->first == "--from-traces") continue;
      if (left->second.empty() || right->second.empty()) continue;
      if (is_same_file(left->second, right->second)) {
        throw UsageError(fmt::format("{} and {} are the same file ({})", left->first, right->first,
                                     right->second));
      }
    }
  }
}

// The error that ended the run, or a strength that was demanded and not reached.
ExitStatus judge(const LearnedModel& learned, const LearnArguments& arguments,
                 const CommandLine& line, Context& context) {
  const ExperimentResult& run = learned.experiment;
  if (!run.is_complete()) {
    try {
      std::rethrow_exception(run.error);
    } catch (const Error& error) {
      return context.fail(error.what(), error.status());
    }
  }
  if (arguments.tests.read().strength.empty() || !run.strength) return ExitStatus::ok;
  const std::string missing = describe_missing(*run.strength);
  if (missing.empty()) return ExitStatus::ok;
  const bool is_said = run.is_weak() && !context.quiet() && !context.json();  // by first_line()
  return context.fail("the tests did not reach what --strength demands: " + missing +
                          (is_said ? "" : go_on(learned, arguments, line)),
                      ExitStatus::inconclusive);
}

ExitStatus learn(const LearnArguments& arguments, const CommandLine& line, Context& context) {
  check_distinct(arguments);
  if (arguments.sul.empty() && !arguments.from_traces.empty()) {
    RunControl control = context.control();
    if (arguments.time_limit) control.deadline = deadline_in(*arguments.time_limit);
    return learn_from_traces(arguments.from_traces, arguments.output, control, context);
  }
  arguments.tests.check(arguments.algorithm);
  const SystemSpec spec = parse_system_spec(arguments.sul, arguments.key_values);
  SystemAccess access = arguments.access;
  access.translation = wanted_translation(arguments);
  const Translation translation = access.translation.value_or(Translation::eager);
  RunControl control = context.control();
  if (arguments.list_options) return list_options(spec, access, context);
  if (!arguments.output.empty()) check_can_write(arguments.output);
  if (!arguments.plot.empty()) check_can_write(arguments.plot);
  const OpenedSystem system = open_system(spec, access, control);
  std::optional<Mealy> reference = system.reference;
  if (!arguments.purpose.empty()) {
    system.sul->add_purpose(LearningPurpose(read_interface_automaton(arguments.purpose)));
    reference.reset();  // the purpose hides a part of it
  }
  if (arguments.time_limit) control.deadline = deadline_in(*arguments.time_limit);
  ExperimentOptions options = experiment_options(arguments, reference ? &*reference : nullptr);
  TraceLog traces;
  if (!arguments.from_traces.empty()) {
    traces = read_traces(arguments.from_traces, control);
    options.traces = &traces;
  }
  std::error_code unreadable;  // read_old_machine() says what is wrong
  if (std::filesystem::is_directory(arguments.start_from, unreadable)) {
    options.known_models = read_known_models(
        arguments.start_from, translation, input_alphabet(system.sul->info()),
        [](const std::string& note) { log_note(note); }, control);
    if (options.known_models.empty()) {
      log_note("no model of such a system is there: it is learned (" + arguments.start_from + ")");
    }
  } else if (!arguments.start_from.empty()) {
    if (!std::filesystem::exists(arguments.start_from, unreadable)) {
      throw UsageError("there is no such file or folder (--start-from " + arguments.start_from +
                       ")");
    }
    options.old_model =
        read_old_machine(arguments.start_from, translation, input_alphabet(system.sul->info()));
  }
  options.testing.budget = test_budget(system.reference.has_value());
  if (!arguments.purpose.empty()) options.fingerprint["purpose"] = read_file(arguments.purpose);
  options.confirm = is_to_be_confirmed(arguments, system);
  if (options.confirm) {
    options.sample = words_of_a_sample;
    options.slower = make_slower_system(spec, access, *system.sul, arguments.purpose, control);
  }
  LearnedModel learned =
      learn_model(*system.sul, translation, options, control, read_model_kind(arguments.kind));
  if (reference) keep_kind(learned, *reference);
  keep_origin(learned, spec, system.sul->info());
  const ExitStatus given =
      give_result(learned, arguments, {spec, line, count_systems(*system.sul)}, context);
  if (!arguments.plot.empty()) {
    write_file_atomically(arguments.plot, draw_hypotheses(learned.experiment, spec.text));
  }
  const ExitStatus status = judge(learned, arguments, line, context);
  return status == ExitStatus::ok ? given : status;
}

void add_limits(CommandLine& line, LearnArguments& arguments) {
  line.add("--max-experiments", arguments.max_experiments,
           "Most words to run on the system; 0: no limit");
  line.add("--time", arguments.time_limit, "Most seconds; then the last hypothesis is kept")
      .check(check_seconds);
}

void add_confirmation(CommandLine& line, LearnArguments& arguments) {
  line.add("--confirm", arguments.confirm,
           "Whether to ask again what matters: yes or no. That is each counterexample before it is "
           "believed, and the final model's words with longer waits (default: yes; for a simulated "
           "model no)")
      .one_of({"yes", "no"})
      .value_name("WORD");
  line.add("--confidence", arguments.vote.confidence,
           "How sure a majority must be about differing answers. It is wrong with a probability of "
           "at most 1 minus this, as long as noise spoils less than half of the answers")
      .number_between(0.5, 0.999999);
  line.add("--repeat", arguments.vote.most_attempts,
           "Most times that a word is asked. A majority decides then; without one the system "
           "counts as nondeterministic (exit status 3)")
      .between(10, 100000);
}

// A log alone has no use for anything that is about asking.
void check_without_system(const CommandLine& line, const LearnArguments& arguments) {
  if (arguments.from_traces.empty()) throw UsageError("SUL is required");
  const std::vector<std::string> useful{"--from-traces", "--output", "--time",
                                        "--json",        "--quiet",  "--verbose"};
  for (const Argument& argument : line.all()) {
    const std::string name = argument.name();
    if (!argument.is_given() || std::ranges::find(useful, name) != useful.end()) {
      continue;
    }
    throw UsageError(name + " needs a system: --from-traces alone asks none");
  }
}

std::string check_algorithm(const std::string& name) {
  std::vector<std::string> names;
  for (const LearnerEntry& entry : learners()) names.emplace_back(entry.name);
  return check_one_of(name, names);
}

}  // namespace

RunFunction set_up_learn(CommandLine& line) {
  auto arguments = std::make_shared<LearnArguments>();
  const std::vector<std::string> wrappers = names_of(own_wrappers);
  Argument sul = line.add(
      "SUL", arguments->sul,
      "The system: port, sim:FILE ('maide help systems'). All wrappers: " + join(wrappers) +
          " ('maide doctor' tells which are here), sim:FILE (a model, simulated), "
          "tcp://HOST:PORT,... (one that listens, or several), or exec:PROGRAM ARGS. It is "
          "needed unless there is --from-traces");
  sul.offer(wrappers);
  line.add("KEY=VALUE", arguments->key_values, "Options of the system (--list-options)")
      .no_default();
  line.add("-o,--output", arguments->output, "The model's file (DOT); standard output if not given")
      .value_name("FILE");
  line.add("--algorithm", arguments->algorithm, "The learner ('maide help algorithms')")
      .check(check_algorithm)
      .offer(names_of(learners()))
      .value_name("NAME");
  add_test_options(line, arguments->tests);
  line.add("--as", arguments->kind,
           "What the model is: mealy or ia. A Mealy machine, whose outputs are what comes until "
           "the system rests; or an interface automaton, which has each output as a step of its "
           "own and is what system files need (default: mealy where the system names no actors, "
           "else ia)")
      .one_of({"mealy", "ia"})
      .no_default()
      .value_name("KIND");
  line.add("--translation", arguments->translation,
           "Which Mealy machine is learned: eager (the default) or av. With eager an input "
           "and all its outputs are one step; av is the transducer of Aarts and Vaandrager")
      .one_of({"eager", "av"})
      .value_name("NAME");
  line.add("--cache", arguments->cache, "Keep every answer here; an ended run resumes there")
      .value_name("FILE");
  line.add("--plot", arguments->plot,
           "Draw how the hypothesis grew (SVG). That is its states over the symbols given to the "
           "system")
      .value_name("FILE");
  line.add("--purpose", arguments->purpose,
           "A learning purpose: which inputs may be offered when. It is an interface automaton "
           "(DOT); what it does not allow is never tried")
      .value_name("FILE");
  line.add("--error-output", arguments->error_outputs,
           "An output that ends the session; once or more. Every input behind it is taken to be "
           "answered by one and the same output, so only a sample is asked there. '*' stands for "
           "any characters")
      .one_each()
      .no_default()
      .value_name("NAME");
  line.add("--from-traces", arguments->from_traces,
           "A log of what the system did. It has a line of JSON a trace ([[\"input\", \"output\"], "
           "...]), or it is a cache of --cache. Without SUL the model is learned from the log "
           "alone (RPNI); with it the log shows counterexamples, and the system is asked about "
           "each")
      .value_name("FILE");
  line.add("--start-from", arguments->start_from,
           "A model of an earlier version, or a folder of models. What still holds of a model "
           "saves queries with lsharp, and equivalence queries with every algorithm; the result "
           "is the system's in any case. Of a folder, a few words tell which model the system has. "
           "That one is tested; if it is none of them, the system is learned")
      .value_name("FILE");
  add_limits(line, *arguments);
  add_access_options(line, arguments->access);
  add_confirmation(line, *arguments);
  add_seed_option(line, arguments->seed);
  line.add_flag("--list-options", arguments->list_options,
                "List the options of the system, and exit");
  return [arguments, sul, &line](Context& context) {
    if (!sul.is_given()) check_without_system(line, *arguments);
    return learn(*arguments, line, context);
  };
}

}  // namespace maide::cli
