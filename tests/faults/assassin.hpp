// Somebody kills the wrapper, again and again, while a model is learned: kill -9 behind a word that
// chance chooses, now and then its successor, too, as it starts.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fragile_systems.hpp"
#include "maide/automata/compare.hpp"
#include "maide/base/random.hpp"
#include "processes.hpp"

namespace maide::test {

// Passes all on, and kills the wrapper behind words that chance chooses.
class Assassin : public Sul {
 public:
  Assassin(WrapperProxy& victim, std::uint64_t seed)
      : victim_(victim), random_(seed), accomplice_([this] { watch(); }) {}
  ~Assassin() override {
    ending_ = true;
    accomplice_.join();
  }

  const SulInfo& info() const override { return victim_.info(); }
  void add_purpose(const LearningPurpose& purpose) override { victim_.add_purpose(purpose); }
  SulIncidents incidents() const override { return victim_.incidents(); }
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override {
    victim_.run(
        batch,
        [&](std::size_t index, SulAnswer answer) {
          if (words_left_-- == 0) {
            words_left_ = random_.below(6);
            kill_all();
            if (random_.chance(0.25)) kills_successor_ = true;
          }
          sink(index, std::move(answer));
        },
        control);
  }
  std::size_t kills() const { return kills_; }

 private:
  void kill_all() {
    for (const pid_t child : own_children()) {
      if (!is_running(child)) continue;
      ::kill(child, SIGKILL);
      ++kills_;
      killed_ = child;
    }
  }
  void watch() {
    while (!ending_) {
      std::this_thread::yield();
      if (!kills_successor_) continue;
      for (const pid_t child : own_children()) {
        if (child == killed_) continue;
        kills_successor_ = false;
        kill_all();
      }
    }
  }

  WrapperProxy& victim_;
  Random random_;
  std::uint64_t words_left_ = 3;
  std::atomic<std::size_t> kills_ = 0;
  std::atomic<pid_t> killed_ = 0;
  std::atomic<bool> kills_successor_ = false, ending_ = false;
  std::thread accomplice_;
};

// Learns until the wrapper was killed a hundred times: the model is the same, no word is lost, and
// nothing is left behind.
inline void expect_same_model(const std::string& wrapper, const Options& options,
                              Translation translation, std::uint64_t tests = 200) {
  const std::vector<std::string> program = {MAIDE_BINARY_DIR "/bin/" + wrapper};
  const ProcessMark mark;
  ExperimentOptions experiment;
  experiment.test_method = "random-words";
  experiment.testing.max_tests = tests;
  const auto undisturbed = learn_model(*spawn_wrapper(program, options), translation, experiment);
  ASSERT_TRUE(undisturbed.experiment.is_complete());
  std::size_t kills = 0;
  std::uint64_t incidents = 0;  // fewer: a word may have crashed anyway, or been the last
  for (std::uint64_t seed = 1; kills < 100; ++seed) {
    const auto sul = spawn_wrapper(program, options);
    Assassin assassin(*sul, seed);
    const auto learned = learn_model(assassin, translation, experiment);
    if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
    EXPECT_TRUE(compare(std::get<InterfaceAutomaton>(*undisturbed.model),
                        std::get<InterfaceAutomaton>(*learned.model))
                    .same());
    EXPECT_EQ(learned.experiment.experiments, undisturbed.experiment.experiments);
    incidents += assassin.incidents().count;
    kills += assassin.kills();
  }
  EXPECT_GT(incidents, 0U);
  while (!mark.find().empty()) std::this_thread::yield();
}

}  // namespace maide::test
