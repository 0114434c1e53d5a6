// Words that are known to matter, as tests. `KnownWords` tests counterexamples from elsewhere, such
// as a model checker or a run that was ended, before anything else. `LoggedTraces` finds
// counterexamples in a log, and `ErrorOutputTest` behind the end of a session.
// `choose_confirmation_words()` chooses words that show again what a learned model rests on.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/conformance/method/test_runner.hpp"
#include "maide/formats/trace_log.hpp"
#include "maide/learn/cache/trace_tree.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/error_outputs.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

class KnownWords : public EquivalenceOracle {
 public:
  // Keeps a reference to `oracle`.
  KnownWords(OutputOracle& oracle, std::vector<Word> words)
      : runner_(oracle, {}), words_(std::move(words)) {}

  // One output query a word.
  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override;

 private:
  TestRunner runner_;
  std::vector<Word> words_;
};

// ---- Confirmation ----
//
// A few words that show again, one by one, what a learned model rests on: each state, told from the
// others, and each transition, with a word that identifies where it leads. They are for a second
// look at the system under other conditions, not for finding new states.

// State cover with a characterising set, transition cover with a word of it drawn for each
// transition; no word is a prefix of another. Of these a sample of at most `most_symbols` inputs in
// all, but at least one word. `model` must be complete; the same seed gives the same words.
std::vector<Word> choose_confirmation_words(const Mealy& model, std::uint64_t seed,
                                            std::uint64_t most_symbols);

// ---- Logs ----
//
// A log of what the system did (formats/trace_log.hpp) as a source of counterexamples. The log is
// never believed. Where hypothesis and log differ, the system is asked, once, and what it
// contradicts is wrong. Query cost: one for each mistake of a hypothesis that the log shows, and
// one for each mistake of the log, however long the log is.

// A word that the system answers otherwise than the log says.
struct LogContradiction {
  std::string word;      // up to the last input, the first that is answered otherwise
  std::string logged;    // the output in the log
  std::string answered;  // the system's
};

class LoggedTraces : public EquivalenceOracle {
 public:
  // Contradictions after which the log is given up: it is another system's.
  static constexpr std::size_t most_contradictions = 100;

  // Keeps a reference to `oracle`. Inputs and outputs go by name; a trace is cut at the first input
  // that the system does not have, and the guarantee says of how many. Throws UsageError if the log
  // contradicts itself, or nothing of it is left.
  LoggedTraces(OutputOracle& oracle, const TraceLog& log);

  // Shortest words first. O(the log as a tree).
  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override;

  const std::vector<LogContradiction>& contradictions() const { return contradictions_; }
  std::size_t cut_traces() const { return cut_; }  // with inputs that the system does not have

 private:
  struct Place {
    TraceTree::Node node;
    StateId state;
    std::size_t parent;  // place in the queue of the node above
  };
  void insert(const TraceLog& log, const TraceLog::Trace& trace);
  std::optional<Word> settle(const Mealy& hypothesis, const Word& word, TraceTree::Node node,
                             const RunControl& control);

  OutputOracle& oracle_;
  TraceTree tree_;    // outputs as in outputs_
  Alphabet outputs_;  // the log's
  std::size_t traces_ = 0, cut_ = 0;
  std::vector<LogContradiction> contradictions_;
};

// Equivalence queries where outputs are known to end the session (learn/oracle/error_outputs.hpp).
// Other tests leave out what follows such an output, so two things are left to this one:
//
//   the hypothesis  answers every input behind an error output alike. A word on which it does not
//                   is found without asking
//   the system      does, too. A sample of the words that end the session, drawn by the seed, goes
//                   on with inputs in random order. Where something else comes, the run ends with
//                   the error that says so (ErrorOutputCheck)
class ErrorOutputTest : public EquivalenceOracle {
 public:
  // Words of the sample, and inputs behind the end of the session in each, at most.
  static constexpr std::size_t sampled_words = 50, inputs_behind = 20;

  // Keeps references. `tests` are asked between the two parts, through an ErrorAwareOracle on top
  // of `check`.
  ErrorOutputTest(EquivalenceOracle& tests, ErrorOutputCheck& check, std::uint64_t seed)
      : tests_(tests), check_(check), random_(seed) {}

  std::optional<Word> find_counterexample(const Mealy& hypothesis,
                                          const RunControl& control = {}) override;
  std::string guarantee() const override;
  Strength strength() const override { return tests_.strength(); }
  TestCost cost_of_missing() const override { return tests_.cost_of_missing(); }

 private:
  std::optional<Word> find_unlike(const Mealy& hypothesis);
  std::optional<Word> ask_sample(const Mealy& hypothesis, const RunControl& control);

  EquivalenceOracle& tests_;
  ErrorOutputCheck& check_;
  Random random_;
  std::size_t asked_ = 0;  // words of the last sample
};

}  // namespace maide
