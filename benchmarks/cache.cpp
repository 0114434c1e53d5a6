// The cache, measured: memory an edge, hits a second, and what the file on disk costs.
//
//   bench_cache [--words N] [--length L] [--seed N]
//
// For each shape of words (cache_cost.hpp) how they are asked and asked again. A hit is one input
// that the cache answers: an edge of its tree that is walked. Words have at least --length inputs,
// so that a query's fixed costs are shared by as many hits as in learning; both numbers are
// printed.
#include "maide/learn/cache/cache.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "cache_cost.hpp"
#include "cpu_seconds.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/learn/cache/cache_file.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide::bench {
namespace {

struct Arguments {
  std::size_t words = 1'000'000, length = 20, rounds = 3;
  std::uint64_t seed = 1;
};

void measure_memory(const Arguments& arguments, const Mealy& machine) {
  fmt::print("{:<50} {:>10} {:>7} {:>10} {:>10} {:>10}\n", "words", "edges", "bytes", "fresh/s",
             "hits/s", "words/s");
  for (const WordShape& shape : word_shapes()) {
    const CacheCost cost =
        measure_cache(machine, make_words(shape, arguments.words, arguments.length, arguments.seed),
                      arguments.length, arguments.rounds);
    fmt::print("{:<50} {:>10} {:>7.2f} {:>10.2e} {:>10.2e} {:>10.2e}\n", shape.name, cost.edges,
               cost.bytes_an_edge, cost.fresh_inputs_a_second, cost.known_inputs_a_second,
               cost.known_inputs_a_second / static_cast<double>(arguments.length));
  }
}

void measure_file(const Arguments& arguments, const Mealy& machine) {
  const TempDir folder("bench-cache-");
  const std::filesystem::path path = folder.path() / "words.cache";
  const auto words =
      make_words(word_shapes().front(), arguments.words / 10, arguments.length, arguments.seed);
  MealyOracle system(machine);
  const auto count = static_cast<double>(words.size());
  double seconds = 0;
  {
    CacheFile file(path, machine.inputs(), {});
    Cache cache(system, file);
    seconds = ask_all(cache, words);
  }
  fmt::print("\nOn disk: {} words written with {:.2e} a CPU second, {:.1f} bytes a word\n",
             words.size(), count / seconds,
             static_cast<double>(std::filesystem::file_size(path)) / count);
  const double start = cpu_seconds();
  CacheFile file(path, machine.inputs(), {});
  const Cache cache(system, file);
  fmt::print("read again with {:.2e} a second\n", count / (cpu_seconds() - start));
}

void run(const Arguments& arguments) {
  const Mealy machine = make_cached_machine(arguments.seed);
  measure_memory(arguments, machine);
  measure_file(arguments, machine);
}

}  // namespace
}  // namespace maide::bench

int main(int argc, char** argv) {
  maide::bench::Arguments arguments;
  CLI::App app("Memory and speed of the cache");
  app.add_option("--words", arguments.words, "Words of each shape")->capture_default_str();
  app.add_option("--length", arguments.length, "Inputs of a word")
      ->check(CLI::Range(6, 1000))
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the words")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    maide::bench::run(arguments);
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_cache: {}\n", error.what());
    return static_cast<int>(error.status());
  }
  return 0;
}
