// The cache, measured: memory an edge, hits a second, and what the file on disk costs.
//
//   bench_cache [--words N] [--seed N] [--file]
//
// Words of several shapes are asked of a random machine through the cache, then all again, which
// are hits. A hit is one input that the cache answers: an edge of its tree that is walked. Words
// have at least --length inputs, so that a query's fixed costs are shared by as many hits as in
// learning; both numbers are printed.
#include "maide/learn/cache.hpp"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/random_automata.hpp"
#include "maide/base/error.hpp"
#include "maide/base/random.hpp"
#include "maide/base/temp_dir.hpp"
#include "maide/learn/cache_file.hpp"
#include "maide/learn/mealy_oracle.hpp"

namespace maide {
namespace {

constexpr std::size_t input_count = 16, batch_size = 64;

struct Shape {
  const char* name;
  std::function<Word(Random&, std::size_t length)> make;
};

Word random_word(Random& random, std::size_t length, std::size_t inputs) {
  Word word(length);
  for (Symbol& symbol : word) symbol = static_cast<Symbol>(random.below(inputs));
  return word;
}

// Each is what some method asks: random words; an access sequence and what distinguishes; random
// walks of two inputs, whose tree branches everywhere and sparsely.
std::vector<Shape> shapes() {
  return {
      {"random words over 16 inputs",
       [](Random& random, std::size_t length) { return random_word(random, length, input_count); }},
      {"random words over 2 inputs",
       [](Random& random, std::size_t length) { return random_word(random, length, 2); }},
      {"one of 1000 prefixes, 2 inputs, a fixed suffix",
       [](Random& random, std::size_t length) {
         Random prefix(random.below(1000));
         Word word = random_word(prefix, length - 5, input_count);
         const Word middle = random_word(random, 2, input_count);
         word.insert(word.end(), middle.begin(), middle.end());
         word.insert(word.end(), {1, 2, 3});
         return word;
       }},
      {"a path that is left by another input now and then",
       [](Random& random, std::size_t length) {
         Word word(length, 0);
         for (Symbol& symbol : word) symbol = random.below(20) == 0 ? 1 : 0;
         return word;
       }},
  };
}

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

std::vector<Query> make_words(const Shape& shape, std::size_t count, std::size_t length,
                              std::uint64_t seed) {
  Random random(seed);
  std::vector<Query> words;
  words.reserve(count);
  for (std::size_t i = 0; i < count; ++i) words.emplace_back(shape.make(random, length));
  return words;
}

double ask_all(OutputOracle& oracle, const std::vector<Query>& words) {
  const double start = cpu_seconds();
  for (std::size_t from = 0; from < words.size(); from += batch_size) {
    const std::size_t size = std::min(batch_size, words.size() - from);
    oracle.ask(std::span(words).subspan(from, size));
  }
  return cpu_seconds() - start;
}

struct Arguments {
  std::size_t words = 1'000'000, length = 20, rounds = 3;
  std::uint64_t seed = 1;
};

void measure_memory(const Arguments& arguments, const Mealy& machine) {
  fmt::print("{:<50} {:>10} {:>7} {:>10} {:>10} {:>10}\n", "words", "edges", "bytes", "fresh/s",
             "hits/s", "words/s");
  for (const Shape& shape : shapes()) {
    const auto words = make_words(shape, arguments.words, arguments.length, arguments.seed);
    MealyOracle system(machine);
    Cache cache(system);
    const double fresh = ask_all(cache, words);
    double known = 1e9;
    for (std::size_t i = 0; i < arguments.rounds; ++i)
      known = std::min(known, ask_all(cache, words));
    const auto edges = static_cast<double>(cache.observation_count());
    const auto count = static_cast<double>(words.size());
    fmt::print("{:<50} {:>10.0f} {:>7.2f} {:>10.2e} {:>10.2e} {:>10.2e}\n", shape.name, edges,
               static_cast<double>(cache.bytes()) / edges,
               count * static_cast<double>(arguments.length) / fresh,
               count * static_cast<double>(arguments.length) / known, count / known);
  }
}

void measure_file(const Arguments& arguments, const Mealy& machine) {
  const TempDir folder("bench-cache-");
  const std::filesystem::path path = folder.path() / "words.cache";
  const auto words =
      make_words(shapes().front(), arguments.words / 10, arguments.length, arguments.seed);
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
  Random random(arguments.seed);
  const Mealy machine = random_mealy({1000, input_count, 8}, random);
  measure_memory(arguments, machine);
  measure_file(arguments, machine);
}

}  // namespace
}  // namespace maide

int main(int argc, char** argv) {
  maide::Arguments arguments;
  CLI::App app("Memory and speed of the cache");
  app.add_option("--words", arguments.words, "Words of each shape")->capture_default_str();
  app.add_option("--length", arguments.length, "Inputs of a word")
      ->check(CLI::Range(6, 1000))
      ->capture_default_str();
  app.add_option("--seed", arguments.seed, "Of the words")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    maide::run(arguments);
  } catch (const maide::Error& error) {
    fmt::print(stderr, "bench_cache: {}\n", error.what());
    return static_cast<int>(error.status());
  }
  return 0;
}
