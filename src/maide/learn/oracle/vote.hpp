// Decides between several answers to one input after the same word, when noise got into some of
// them. The word is asked again until a majority decides. The test is Wald's sequential probability
// ratio test ("Sequential tests of statistical hypotheses", Annals of Mathematical Statistics 16,
// 1945) of "an answer comes with probability 1 - e" against "with probability 1/2", for e = 0.2.
//
// Guarantee: a wrong answer is ever chosen with probability at most 1 - confidence, however often
// one looks. It holds as long as runs are independent and noise spoils less than half of them.
// (Ville's inequality: the likelihood ratio is a supermartingale if the answer's probability is at
// most 1/2, and that is true of all wrong answers together.) An answer that comes half of the time
// is no noise, and not chosen.
//
// Cost: e sets the speed alone. At a confidence of 0.99, 10 runs decide without further noise, and
// 24 on average if a fifth of them is spoilt.
//
// Example, at 0.99: ten like answers decide. Nine like ones and another one do not.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/alphabet.hpp"

namespace maide {

struct VoteOptions {
  double confidence = 0.99;          // in (0, 1)
  std::uint32_t most_attempts = 60;  // asked this often without a decision: nondeterministic
};

class Ballot {
 public:
  // Throws UsageError unless the confidence lies between 0 and 1 and can be had in most_attempts.
  explicit Ballot(const VoteOptions& options);

  void add(Symbol output);
  // The output that is decided on, if one is. Later ones may undo it. O(different outputs).
  std::optional<Symbol> winner() const;
  // How many more outputs decide it if all are the same; 0: decided.
  std::uint32_t missing() const;
  // Asked as often as is allowed, and undecided.
  bool is_nondeterministic() const { return total_ >= options_.most_attempts && missing() > 0; }

  std::uint32_t total() const { return total_; }
  // The outputs and how often they came.
  const std::map<Symbol, std::uint32_t>& counts() const { return counts_; }

 private:
  VoteOptions options_;
  double threshold_;
  std::map<Symbol, std::uint32_t> counts_;
  std::uint32_t total_ = 0;
};

// A word that was answered in several ways in a run, for reports.
struct Contradiction {
  std::string word;  // inputs by name, separated by spaces
  // Its answers from the first contradiction on and how often each came, the most frequent first;
  // at least two.
  std::vector<std::pair<std::string, std::uint64_t>> answers;
};

// "write read: 9 times \"quiet message\", 1 time \"quiet quiet\"".
std::string to_string(const Contradiction& contradiction);

}  // namespace maide
