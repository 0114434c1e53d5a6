#include "learner_cost.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <type_traits>

#include "cpu_seconds.hpp"
#include "maide/automata/compare.hpp"
#include "maide/automata/minimize.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/conformance/method/perfect_oracle.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide::bench {

LearnerCost measure_learner(const LearnerEntry& algorithm, const Mealy& model, bool use_cache) {
  LearnerCost cost;
  const double start = cpu_seconds();
  MealyOracle system(model);
  CountingOracle counter(system);
  Cache cache(counter);
  PerfectOracle teacher(model);
  const auto learner = algorithm.make(use_cache ? static_cast<OutputOracle&>(cache) : counter);
  const LearnResult result = run_learner(*learner, teacher);
  cost.cpu_seconds = cpu_seconds() - start;
  cost.counts = counter.statistics().total();
  cost.equivalence_queries = result.equivalence_queries;
  cost.is_right =
      !find_difference(result.model, model) && result.model.size() == minimize(model).size();
  return cost;
}

LearnerCost measure_learner_apart(const LearnerEntry& algorithm, const Mealy& model,
                                  bool use_cache) {
  static_assert(std::is_trivially_copyable_v<LearnerCost>);
  int ends[2];
  if (pipe(ends) != 0) throw Error(ExitStatus::inconclusive, "no pipe");
  std::fflush(stdout);
  const pid_t child = fork();
  if (child < 0) throw Error(ExitStatus::inconclusive, "no process could be started");
  if (child == 0) {
    const LearnerCost cost = measure_learner(algorithm, model, use_cache);
    _exit(write(ends[1], &cost, sizeof cost) == sizeof cost ? 0 : 1);
  }
  close(ends[1]);
  LearnerCost cost;
  const bool was_read = read(ends[0], &cost, sizeof cost) == sizeof cost;
  close(ends[0]);
  rusage usage{};
  int status = 0;
  if (wait4(child, &status, 0, &usage) != child || status != 0 || !was_read) {
    throw Error(ExitStatus::inconclusive, fmt::format("{} states with {} could not be learned",
                                                      model.size(), algorithm.name));
  }
  cost.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  return cost;
}

Mealy make_random_machine(std::size_t states) {
  Random random(states);
  return random_mealy({.states = states, .inputs = 10, .outputs = 10}, random);
}

}  // namespace maide::bench
