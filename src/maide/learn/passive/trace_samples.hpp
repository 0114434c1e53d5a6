// What a nondeterministic system was seen to do: a tree of traces, with how often each input was
// given behind each trace. Learning assumes that every possible answer is seen if one asks often
// enough ("complete testing", "all-weather conditions"). Here "often enough" is a number. An answer
// that comes at least once in ten times is then missed with probability at most 1 - confidence. For
// a confidence of 0.99 an input is asked 44 times behind a trace.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

struct SamplingOptions {
  double confidence = 0.99;        // in (0, 1): of seeing an answer at one place ...
  double rarest = 0.1;             // ... that comes with at least this probability
  std::uint32_t most_rounds = 30;  // a word is run at most this many times what one place needs
};

class TraceSamples {
 public:
  using Node = std::uint32_t;  // a trace
  static constexpr Node root = 0;
  static constexpr Node none = ~Node{0};
  struct Branch {
    Symbol output;
    Node node;
  };

  // Keeps a reference to `oracle`. Throws UsageError for numbers that are no probabilities.
  TraceSamples(OutputOracle& oracle, const SamplingOptions& options);

  const Alphabet& inputs() const { return oracle_.inputs(); }
  const Alphabet& outputs() const { return oracle_.outputs(); }

  // Runs each word once. Throws what the oracle throws; what was answered before is kept.
  void run(std::span<const Word> words, const RunControl& control);
  // Runs the words until every place that they reach, by traces that were seen, is complete; or
  // most_rounds are over, because a trace is rare. A word that is a prefix of another costs
  // nothing.
  void sample(std::vector<Word> words, const RunControl& control);
  // Allows twice as many rounds.
  void double_rounds() { most_rounds_ *= 2; }
  std::uint32_t most_rounds() const { return most_rounds_; }

  // How often an input must be given at a place for it to be complete.
  std::uint32_t needed() const { return needed_; }
  bool is_complete(Node node, Symbol input) const { return count(node, input) >= needed_; }
  std::uint32_t count(Node node, Symbol input) const;
  // The answers seen, in the order in which they were first seen.
  std::span<const Branch> branches(Node node, Symbol input) const;
  Node child(Node node, Symbol input, Symbol output) const;
  Node parent(Node node) const { return records_[node].parent; }

  Word inputs_of(Node node) const;                      // O(length)
  std::size_t size() const { return records_.size(); }  // traces seen, the empty one included

 private:
  struct Cell {
    std::uint32_t count = 0;
    std::vector<Branch> branches;
  };
  struct Record {
    Node parent = none;
    Symbol input = 0;         // the last one
    std::vector<Cell> cells;  // by input; empty: none was given
  };
  void record(const MealyAnswer& answer);
  std::uint32_t missing(Node node, std::span<const Symbol> word) const;

  OutputOracle& oracle_;
  std::uint32_t needed_, most_rounds_;
  std::vector<Record> records_{1};
  std::map<Word, std::uint64_t> runs_;  // of words that were sampled
};

}  // namespace maide
