// kill -9 of wrappers that need nothing installed, at random moments of a learning run.
#include "assassin.hpp"

namespace maide {
namespace {

using test::expect_same_model;

TEST(KilledWrapper, OfTheReferencePortLosesNoWord) {
  expect_same_model("maide-wrap-port", {{"kind", "strict"}, {"size", "2"}}, Translation::eager);
}

TEST(KilledWrapper, OfAFragileSystemIsNoCrashOfIts) {
  expect_same_model("fragile_wrapper", {}, Translation::av, 10);
}

// kill -9 within the first 50 ms of a wrapper's life, up to three times in a row.
TEST(KilledWrapper, AsItStartsCostsNoModel) {
  const std::vector<std::string> program = {MAIDE_BINARY_DIR "/bin/maide-wrap-port"};
  const test::Options options = {{"kind", "strict"}, {"size", "2"}};
  const test::ProcessMark mark;
  ExperimentOptions experiment;
  experiment.test_method = "random-words";
  experiment.testing.max_tests = 50;
  const auto undisturbed =
      learn_model(*spawn_wrapper(program, options), Translation::eager, experiment);
  std::size_t kills = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    std::atomic<bool> ending = false;
    std::thread killer([&] {
      Random random(seed);
      pid_t last = 0;
      for (std::uint64_t left = 1 + random.below(3); left > 0 && !ending;) {
        for (const pid_t child : test::own_children()) {
          if (child <= last || !test::is_running(child)) continue;
          last = child;
          std::this_thread::sleep_for(std::chrono::microseconds(
              random.chance(0.5) ? random.below(2000) : random.below(50'000)));
          ::kill(child, SIGKILL);
          ++kills;
          --left;
          break;
        }
      }
    });
    const auto sul = spawn_wrapper(program, options);
    const auto learned = learn_model(*sul, Translation::eager, experiment);
    ending = true;
    killer.join();
    if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
    EXPECT_TRUE(compare(std::get<InterfaceAutomaton>(*undisturbed.model),
                        std::get<InterfaceAutomaton>(*learned.model))
                    .same());
  }
  EXPECT_GT(kills, 30U);
  while (!mark.find().empty()) std::this_thread::yield();
}

TEST(KilledWrapper, WithABrokerLosesNoWord) {
  expect_same_model("fragile_wrapper", {{"death", "broker"}}, Translation::eager, 10);
}

}  // namespace
}  // namespace maide
