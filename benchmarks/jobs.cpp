// What it gains to ask several systems at once: words a second for each number of them.
//
//   bench_jobs [--words N] [--rounds R] [--jobs 1,2,4,8] [--batch B] SYSTEM [KEY=VALUE ...]
//
// The words are random, the same each time, and given in batches as large as those of the learner.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/experiment/pacing.hpp"

namespace maide {
namespace {

struct Arguments {
  std::string system;
  std::vector<std::string> options;
  std::vector<std::size_t> jobs{1, 2, 4, 8};
  std::size_t words = 500;
  std::size_t rounds = 9;
  std::size_t batch = PaceOptions{}.portion;
};

std::vector<SulQuery> make_words(std::size_t count, std::size_t inputs) {
  Random random(1);
  std::vector<SulQuery> words(count);
  for (SulQuery& query : words) {
    Word word(random.between(1, 16));
    for (Symbol& symbol : word) symbol = static_cast<Symbol>(random.below(inputs));
    query.inputs = std::move(word);
  }
  return words;
}

// Words a second.
double measure(Sul& sul, const std::vector<SulQuery>& words, std::size_t batch) {
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t from = 0; from < words.size(); from += batch) {
    const std::size_t size = std::min(batch, words.size() - from);
    sul.run(std::span(words).subspan(from, size), [](std::size_t, const SulAnswer&) {}, {});
  }
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  return static_cast<double>(words.size()) / time.count();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The numbers of systems take turns, so that what else goes on on the machine meets all of them.
void run(const Arguments& arguments) {
  const SystemSpec spec = parse_system_spec(arguments.system, arguments.options);
  std::vector<OpenedSystem> systems;
  for (const std::size_t jobs : arguments.jobs) {
    SystemAccess access;
    access.jobs = jobs;
    systems.push_back(open_system(spec, access));
  }
  const auto words = make_words(arguments.words, systems.front().sul->info().inputs.size());
  std::vector<std::vector<double>> speeds(systems.size());
  for (std::size_t round = 0; round <= arguments.rounds; ++round) {
    for (std::size_t i = 0; i < systems.size(); ++i) {
      const double speed = measure(*systems[i].sul, words, arguments.batch);
      if (round > 0) speeds[i].push_back(speed);  // the first warms up
    }
  }
  fmt::print("{:>5} {:>10} {:>8}   (medians of {} rounds of {} words in batches of {})\n", "jobs",
             "words/s", "ratio", arguments.rounds, arguments.words, arguments.batch);
  for (std::size_t i = 0; i < systems.size(); ++i) {
    fmt::print("{:>5} {:>10.0f} {:>8.2f}\n", arguments.jobs[i], median(speeds[i]),
               median(speeds[i]) / median(speeds.front()));
  }
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  maide::Arguments arguments;
  CLI::App app("Words a second on a system, for each number of systems that are asked at once");
  app.add_option("--words", arguments.words, "Random words of 1 to 16 inputs")
      ->capture_default_str();
  app.add_option("--jobs", arguments.jobs, "How many systems at once")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  app.add_option("--rounds", arguments.rounds, "How often all of them are measured")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--batch", arguments.batch, "Words that are given at once")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("SYSTEM", arguments.system, "As in maide learn")->required();
  app.add_option("KEY=VALUE", arguments.options, "Options of the system");
  CLI11_PARSE(app, argc, argv);
  try {
    maide::run(arguments);
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_jobs: {}\n", error.what());
    return static_cast<int>(error.status());
  }
  return 0;
}
