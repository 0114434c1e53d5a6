#include "cache_cost.hpp"

#include <algorithm>
#include <span>

#include "cpu_seconds.hpp"
#include "maide/automata/random_automata.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/oracle/mealy_oracle.hpp"

namespace maide::bench {
namespace {

constexpr std::size_t input_count = 16, batch_size = 64;

Word random_word(Random& random, std::size_t length, std::size_t inputs) {
  Word word(length);
  for (Symbol& symbol : word) symbol = static_cast<Symbol>(random.below(inputs));
  return word;
}

}  // namespace

std::vector<WordShape> word_shapes() {
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

std::vector<Query> make_words(const WordShape& shape, std::size_t count, std::size_t length,
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

Mealy make_cached_machine(std::uint64_t seed) {
  Random random(seed);
  return random_mealy({.states = 1000, .inputs = input_count, .outputs = 8}, random);
}

CacheCost measure_cache(const Mealy& machine, const std::vector<Query>& words, std::size_t length,
                        std::size_t rounds) {
  MealyOracle system(machine);
  Cache cache(system);
  const auto inputs = static_cast<double>(words.size() * length);
  CacheCost cost;
  cost.fresh_inputs_a_second = inputs / ask_all(cache, words);
  for (; rounds > 0; --rounds) {
    cost.known_inputs_a_second =
        std::max(cost.known_inputs_a_second, inputs / ask_all(cache, words));
  }
  cost.edges = cache.observation_count();
  cost.bytes_an_edge = static_cast<double>(cache.bytes()) / static_cast<double>(cost.edges);
  return cost;
}

}  // namespace maide::bench
