// Systems that do not always do the same: for tests of votes and of nondeterministic learning. All
// chance is seeded.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "maide/base/random.hpp"
#include "maide/sul/sul.hpp"

namespace maide::test {

struct NoiseOptions {
  double lost = 0;     // probability that a step's events are not seen
  double flipped = 0;  // probability that a step's events are those of another output
  std::uint64_t seed = 0;
};

// A system whose answers are sometimes observed wrongly; what it does is not disturbed. It answers
// words alone: what is below would branch in a decision tree by what really happened.
class NoisySul : public Sul {
 public:
  // Keeps a reference to `sul`.
  NoisySul(Sul& sul, NoiseOptions options)
      : sul_(sul), options_(options), random_(options.seed), info_(sul.info()) {
    info_.speaks_trees = false;
  }

  const SulInfo& info() const override { return info_; }
  void add_purpose(const LearningPurpose& purpose) override { sul_.add_purpose(purpose); }
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override {
    sul_.run(
        batch,
        [&](std::size_t index, SulAnswer answer) {
          for (SulStep& step : answer.steps) disturb(step);
          sink(index, std::move(answer));
        },
        control);
  }
  std::uint64_t disturbed() const { return disturbed_; }

 private:
  void disturb(SulStep& step) {
    if (step.status != StepStatus::taken) return;
    if (random_.chance(options_.lost) && !step.events.empty()) {
      step.events.clear();
      ++disturbed_;
    } else if (random_.chance(options_.flipped)) {
      const auto& outputs = info().outputs;
      const SulOutput& other = outputs[random_.below(outputs.size())];
      const std::vector<Event> events{{other.actor, other.name}};
      if (step.events != events) ++disturbed_;
      step.events = events;
    }
  }

  Sul& sul_;
  NoiseOptions options_;
  Random random_;
  SulInfo info_;
  std::uint64_t disturbed_ = 0;
};

}  // namespace maide::test
