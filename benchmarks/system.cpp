// How often a verdict of quiescence is wrong on a real system, and what a word costs there:
//
//   bench_system [--words N] [--busy K] [--fixed 1,5,20] SYSTEM [KEY=VALUE ...]
//
// learns the system (or reads --model FILE), then plays the same N random words on it under
// observed quiescence and under each fixed delay (with no floor), beside K processes that take all
// the time they get. A word counts as wrong if its outputs are not the model's.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "busy_machine.hpp"
#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"

namespace maide {
namespace {

using Milliseconds = std::chrono::duration<double, std::milli>;

struct Arguments {
  std::string system;
  std::vector<std::string> options;
  std::string model_file;
  std::vector<int> fixed{1, 5, 20};
  std::size_t words = 10000, busy = 0, length = 8;
  std::uint64_t seed = 1;
  double seconds = 0;  // for each way to wait; 0: no limit
};

// What was seen under one way to wait.
struct Tally {
  std::size_t words = 0, wrong = 0;
  std::vector<double> resets, steps;  // milliseconds
  std::string first_wrong, failure;
};

Mealy learn(const SystemSpec& spec) {
  const OpenedSystem opened = open_system(spec);
  LearnedModel learned = learn_model(*opened.sul, Translation::eager, {});
  if (!learned.experiment.is_complete()) std::rethrow_exception(learned.experiment.error);
  return std::move(learned.experiment.model);
}

Mealy read(const std::string& file) {
  SystemAccess access;
  access.translation = Translation::eager;
  return open_system(parse_system_spec("sim:" + file, {}), access).reference.value();
}

// Words over the inputs of `info`, whatever their order in the model.
std::vector<SulQuery> random_words(const SulInfo& info, const Arguments& arguments) {
  Random random(arguments.seed);
  std::vector<SulQuery> words(arguments.words, {Word(arguments.length), Translation::eager});
  for (SulQuery& query : words) {
    for (Symbol& input : std::get<Word>(query.inputs)) {
      input = static_cast<Symbol>(random.below(info.inputs.size()));
    }
  }
  return words;
}

// "write -> quiet, read -> gap (not message)" up to the first wrong output; "" if all are right.
std::string find_wrong(const SulAnswer& answer, const SulInfo& info, const Mealy& model) {
  std::string text;
  StateId state = model.initial();
  for (std::size_t i = 0; i < answer.steps.size(); ++i) {
    const std::string& name = info.inputs[answer.inputs[i]].name;
    const Symbol input = model.inputs().at(name);
    const std::string output = mealy_output(answer.steps[i], Translation::eager);
    const std::string& expected = model.outputs().name(model.output(state, input));
    text += fmt::format("{}{} -> {}", i == 0 ? "" : ", ", name, output);
    if (output != expected) return text + " (not " + expected + ")";
    state = model.target(state, input);
  }
  return answer.end == WordEnd::complete ? "" : text + ", and there it ended";
}

Tally play(SystemSpec spec, const std::string& quiescence, const Mealy& model,
           const Arguments& arguments) {
  spec.options["quiescence"] = quiescence;
  if (quiescence != "observed") spec.options["floor"] = "0";
  SystemAccess access;
  access.jobs = 1;  // times are of a system that has the machine to itself
  const OpenedSystem opened = open_system(spec, access);
  Sul& sul = *opened.sul;
  const std::vector<SulQuery> words = random_words(sul.info(), arguments);
  Tally tally;
  RunControl control;
  if (arguments.seconds > 0) {
    control.deadline = std::chrono::steady_clock::now() +
                       std::chrono::milliseconds(static_cast<long>(arguments.seconds * 1000));
  }
  const test::BusyMachine load(arguments.busy);
  const auto count = [&](std::size_t, const SulAnswer& answer) {
    ++tally.words;
    const std::string wrong = find_wrong(answer, sul.info(), model);
    tally.wrong += !wrong.empty();
    if (tally.first_wrong.empty()) tally.first_wrong = wrong;
    tally.resets.push_back(Milliseconds(answer.reset_duration).count());
    for (const SulStep& step : answer.steps) {
      tally.steps.push_back(Milliseconds(step.duration).count());
    }
  };
  try {
    sul.run(words, count, control);
  } catch (const Interrupted&) {  // the time is over
  } catch (const Error& error) {
    tally.failure = error.what();
  }
  return tally;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void run(const Arguments& arguments) {
  const SystemSpec spec = parse_system_spec(arguments.system, arguments.options);
  const Mealy model = arguments.model_file.empty() ? learn(spec) : read(arguments.model_file);
  fmt::print("{}: {} states over {} inputs; words of {} steps beside {} busy processes\n",
             spec.text, model.size(), model.inputs().size(), arguments.length, arguments.busy);
  fmt::print("{:>10} {:>8} {:>8} {:>10} {:>10}\n", "quiescence", "words", "wrong", "reset (ms)",
             "step (ms)");
  std::vector<std::string> ways{"observed"};
  for (const int delay : arguments.fixed) ways.push_back(std::to_string(delay));
  for (const std::string& way : ways) {
    Tally tally = play(spec, way, model, arguments);
    fmt::print("{:>10} {:>8} {:>8} {:>10.3f} {:>10.3f}\n", way, tally.words, tally.wrong,
               median(tally.resets), median(tally.steps));
    if (!tally.first_wrong.empty()) fmt::print("{:>12}{}\n", "", tally.first_wrong);
    if (!tally.failure.empty()) fmt::print("{:>12}{}\n", "", tally.failure);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  maide::Arguments arguments;
  CLI::App app("Counts wrong words on a real system under each way to wait for quiescence");
  app.add_option("--words", arguments.words, "Random words to play each way")
      ->capture_default_str();
  app.add_option("--length", arguments.length, "Inputs in a word")->capture_default_str();
  app.add_option("--busy", arguments.busy, "Busy processes beside")->capture_default_str();
  app.add_option("--fixed", arguments.fixed, "Fixed delays, in ms")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--seconds", arguments.seconds, "At most so long each way (default: no limit)");
  app.add_option("--model", arguments.model_file, "The model (default: learned first)");
  app.add_option("--seed", arguments.seed, "Of the words")->capture_default_str();
  app.add_option("SYSTEM", arguments.system, "As in maide learn")->required();
  app.add_option("KEY=VALUE", arguments.options, "Options of the system");
  CLI11_PARSE(app, argc, argv);
  try {
    maide::run(arguments);
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_system: {}\n", error.what());
    return static_cast<int>(error.status());
  }
}
