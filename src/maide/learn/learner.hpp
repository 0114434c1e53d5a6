// Learners: their interface, the learning loop that drives one against a teacher (`learn()`), and
// the table of all learning algorithms. A learner builds a hypothesis from output queries and
// refines it by counterexamples.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/automata/mealy.hpp"
#include "maide/base/run_control.hpp"
#include "maide/learn/oracle/equivalence_oracle.hpp"
#include "maide/learn/oracle/output_oracle.hpp"

namespace maide {

class Learner {
 public:
  virtual ~Learner() = default;

  // Makes the first hypothesis. Must be called once, before anything else.
  virtual void start(const RunControl& control = {}) = 0;

  // Refines the hypothesis with a word on which it differs from the system, until it agrees with
  // the system on that word. A word that is no counterexample throws std::invalid_argument.
  virtual void refine(const Word& counterexample, const RunControl& control = {}) = 0;

  // The present hypothesis: complete, every state reachable, state 0 initial. A learner that lets a
  // state keep its number from one hypothesis to the next spares the perfect oracle work.
  virtual const Mealy& hypothesis() const = 0;

  // Output queries asked so far, answered by a cache or not.
  virtual std::uint64_t output_queries() const = 0;

  // Throws std::logic_error unless what the learner keeps is as its algorithm says it is between
  // two equivalence queries, that is after start() and refine(). For tests: it looks at all of it.
  virtual void check_invariants() const {}
};

// Called with each hypothesis before it goes to the teacher (to keep it, to draw it).
using HypothesisObserver = std::function<void(const Mealy& hypothesis, std::uint64_t round)>;

struct LearnResult {
  Mealy model;  // the last hypothesis, states numbered in breadth-first order
  std::uint64_t equivalence_queries = 0;  // the last one, which found nothing, included
};

// Runs the learner against the teacher until the teacher finds no counterexample. Throws
// Interrupted when `control` says stop; the learner then still holds its last hypothesis.
LearnResult run_learner(Learner& learner, EquivalenceOracle& teacher,
                        const RunControl& control = {}, const HypothesisObserver& observer = {});

// The same for short programs: the learned model.
Mealy learn(Learner& learner, EquivalenceOracle& teacher);

// ---- The algorithms ----
//
// The learning algorithms by name: the one place that the command line, its help and the benchmarks
// read.
struct LearnerEntry {
  std::string_view name;                                   // as in `--algorithm NAME`
  std::string_view description;                            // one line, for help
  std::unique_ptr<Learner> (*make)(OutputOracle& oracle);  // null: see is_nondeterministic()
  // The same, starting from a model of an earlier version of the system; null: the algorithm has no
  // use for one, see make_learner() and first_words().
  std::unique_ptr<Learner> (*make_from)(OutputOracle& oracle, const Mealy& old_model,
                                        const RunControl& control,
                                        std::span<const Word> first_words) = nullptr;
  // The algorithm to take where the system answers words alone; empty: this one asks no decision
  // trees.
  std::string_view by_words{};
  // The options of the tests that it has of its own, as TestMethodEntry::options; empty: it is
  // tested by the methods of `--eq`.
  std::string_view test_options{};

  // It learns systems that answer the same word in several ways, by sampling: no Learner.
  constexpr bool is_nondeterministic() const { return make == nullptr; }
};

// All of them, the default first; and those that are Learners.
std::span<const LearnerEntry> learners();
std::span<const LearnerEntry> deterministic_learners();

// The algorithm of this name, the default for ""; throws UsageError that lists the known ones.
const LearnerEntry& find_learner(std::string_view name);
const LearnerEntry& find_deterministic_learner(std::string_view name);

// A learner of the algorithm. It starts from `old_model`, a model of an earlier version of the
// system, if that is not null and the algorithm can do so. Then it asks `first_words` before all
// else (see LSharp).
std::unique_ptr<Learner> make_learner(const LearnerEntry& algorithm, OutputOracle& oracle,
                                      const Mealy* old_model, const RunControl& control = {},
                                      std::span<const Word> first_words = {});
// If it cannot: words to test the first hypothesis with, which show whatever states of `old_model`
// are still there in a system with these inputs. Else none.
std::vector<Word> first_words(const LearnerEntry& algorithm, const Mealy* old_model,
                              const Alphabet& inputs, const RunControl& control = {});

}  // namespace maide
