// Tests of a nondeterministic hypothesis. Some words are run until everything that they may lead to
// was seen (trace_samples.hpp); random words are run once. Two things refute the hypothesis: an
// output that it does not allow, and an output that it allows and that was not seen where the
// samples are complete.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "maide/automata/nondeterministic_mealy.hpp"
#include "maide/base/random.hpp"
#include "maide/learn/passive/trace_samples.hpp"
#include "maide/learn/table/nstar.hpp"

namespace maide {

struct NondeterministicTestOptions {
  std::size_t extra_states = 1;   // all words of one input more follow each transition
  std::uint64_t max_tests = 500;  // words run to the end; a sample, if there are more
  std::uint64_t random_words = 500;
  std::uint64_t seed = 0;
};

class NondeterministicTests {
 public:
  // Keeps both references.
  NondeterministicTests(const NStar& learner, TraceSamples& samples,
                        const NondeterministicTestOptions& options)
      : learner_(learner), samples_(samples), options_(options), random_(options.seed) {}

  // True if the learner's hypothesis is refuted by the samples, after the tests. Throws what the
  // system throws.
  bool is_refuted(const RunControl& control = {});

  // What the last test that refuted nothing establishes.
  std::string guarantee() const { return guarantee_; }

 private:
  std::vector<Word> covering_words();
  std::vector<Word> random_words();

  const NStar& learner_;
  TraceSamples& samples_;
  NondeterministicTestOptions options_;
  Random random_;
  std::string guarantee_ = "not tested";
};

}  // namespace maide
