// Learning a model of a system, by asking it.
//
// The short way. A running system is named as on the command line of `maide learn`:
//
//   const maide::Learned learned = maide::learn_system("cyclonedds history=keep_last depth=1");
//   if (learned.is_complete() && !learned.is_weak) maide::write_dot(std::cout, *learned.model);
//
// An object of the program's own says what it takes, starts again, and answers an input:
//
//   class Switch {
//    public:
//     maide::Alphabet inputs() const { return {"press"}; }
//     void reset() { is_on_ = false; }
//     std::string step(const std::string&) { return (is_on_ = !is_on_) ? "on" : "off"; }
//    private:
//     bool is_on_ = false;
//   };
//   Switch machine;
//   const maide::Learned learned = maide::learn_machine(machine);
//
// The long way. A learner asks output queries and makes hypotheses. An equivalence oracle looks for
// a word on which the hypothesis and the system differ. Decorators stand between them and the
// system, and keep references. So a stack is written from the system upwards and destroyed from the
// top:
//
//   maide::SulOracle system{machine};   // plays words on the machine
//   maide::Cache oracle{system};        // never plays the same word twice
//   maide::LmPlus learner{oracle};
//   maide::WMethod teacher{oracle, {.extra_states = 2}};
//   const maide::Mealy model = learn(learner, teacher);
//
// A run has three states. Before start() a learner has no hypothesis. Then it always has one. After
// an exception it still has the last one. The system must answer the same word in the same way,
// unless the algorithm is nstar.
//
// "No counterexample" does not prove a model right. EquivalenceOracle::guarantee() says in words
// what it means, and strength() in numbers. A model is weak if less was tried than every model
// should withstand (maide/automata/strength.hpp).
//
// Errors: UsageError for names and values that do not exist, before anything is asked. WrapperError
// and NondeterminismError if the system fails. learn_system() and learn_machine() keep what was
// learned until then, see Learned::problem.
//
// Cost: L# asks at most k n^2 + (n - 1) (3 + log2(m + n)) words for n states, k inputs and
// counterexamples of m inputs, and far fewer as a rule. The tests are most of the work
// (docs/testing.md). Memory is that of the cache, some 10 bytes an input that was asked.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/error.hpp"
#include "maide/base/run_control.hpp"
#include "maide/conformance/method/complete_method.hpp"
#include "maide/conformance/method/test_chain.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/learn/cache/cache.hpp"
#include "maide/learn/learner.hpp"
#include "maide/learn/oracle/sul_oracle.hpp"
#include "maide/learn/table/table_learners.hpp"

namespace maide {

struct LearnOptions {
  std::string algorithm;                            // of learners(); "": the default, L#
  std::string tests;                                // as `--eq`; "": the default
  std::map<std::string, std::string> test_options;  // of test_options(): {{"extra-states", "2"}}
  std::uint64_t seed = 1;                           // of everything random
  std::string cache_file;           // keeps every answer; "": the answers live as long as the call
  std::uint64_t max_words = 0;      // most words that the system is asked; 0: no limit
  std::size_t jobs = 0;             // systems asked at once; 0: one for each processor
  std::optional<Mealy> start_from;  // of an earlier version of the system; need not be right
  std::string as;                   // "mealy" or "ia", as `--as`; "": as the system is
  RunControl control;               // to stop early, and to be told of progress
};

struct Learned {
  // An interface automaton where the system has actors and LearnOptions::as does not say otherwise,
  // else a Mealy machine (nondeterministic with nstar). Nothing if the run ended before the first
  // hypothesis.
  std::optional<Model> model;
  std::string problem;    // why the run ended early, one line; "": it did not
  bool is_weak = true;    // parts of the system may be missing from the model
  std::string strength;   // what was tried, as model files have it; "": nothing
  std::string guarantee;  // what that means, in words
  std::uint64_t words = 0, symbols = 0, equivalence_queries = 0;

  bool is_complete() const { return problem.empty(); }
};

// Learns the system that `system` names: "port kind=strict size=3", "sim:model.dot",
// "tcp://robot:5000", "exec:./my-wrapper". Counterexamples are believed when they were seen twice.
// Throws UsageError and WrapperError for a system that cannot be opened.
Learned learn_system(const std::string& system, const LearnOptions& options = {});

// Learns what answers `oracle`. Keeps the reference during the call. The answers count as those of
// a machine in memory: they are not asked twice.
Learned learn_oracle(OutputOracle& oracle, const LearnOptions& options = {});

// Learns an object of the program's own, see above. What it throws passes through.
template <SteppableMachine Machine>
Learned learn_machine(Machine& machine, const LearnOptions& options = {}) {
  SulOracle oracle{machine};
  return learn_oracle(oracle, options);
}

}  // namespace maide
