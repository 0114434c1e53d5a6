// What the cache costs: words of several shapes are asked of a random machine through it, then all
// again, which are hits.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide::bench {

struct WordShape {
  std::string_view name;
  std::function<Word(Random&, std::size_t length)> make;
};

// Each is what some method asks: random words; random walks of two inputs, whose tree branches
// everywhere; an access sequence and what distinguishes; a tree that branches sparsely.
std::vector<WordShape> word_shapes();

// A random one that these words are asked of.
Mealy make_cached_machine(std::uint64_t seed);

std::vector<Query> make_words(const WordShape& shape, std::size_t count, std::size_t length,
                              std::uint64_t seed);

// The processor's seconds for all words, asked in batches as learners do.
double ask_all(OutputOracle& oracle, const std::vector<Query>& words);

struct CacheCost {
  std::uint64_t edges = 0;
  double bytes_an_edge = 0;
  double fresh_inputs_a_second = 0, known_inputs_a_second = 0;
};

// Of words of one length. Hits: the best of `rounds`.
CacheCost measure_cache(const Mealy& machine, const std::vector<Query>& words, std::size_t length,
                        std::size_t rounds);

}  // namespace maide::bench
