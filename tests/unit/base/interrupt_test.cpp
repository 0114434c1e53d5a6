// Signals become stop requests; the second one ends the process.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <thread>

#include "maide/base/run_control.hpp"

namespace maide {
namespace {

// Returns when the token stops (the test's own time limit ends it otherwise).
void wait_for_stop(const std::stop_token& token) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  stopped.wait(lock, token, [] { return false; });
}

TEST(Interrupt, StopsOnSigintAndSigterm) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Interrupt interrupt;
    EXPECT_FALSE(interrupt.token().stop_requested());
    std::raise(signal);
    wait_for_stop(interrupt.token());
    EXPECT_TRUE(interrupt.token().stop_requested());
  }
}

TEST(Interrupt, RestoresTheEarlierHandlers) {
  struct sigaction before {};
  struct sigaction after {};
  ::sigaction(SIGINT, nullptr, &before);
  { const Interrupt interrupt; }
  ::sigaction(SIGINT, nullptr, &after);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

TEST(Interrupt, ExistsOnce) {
  const Interrupt interrupt;
  EXPECT_THROW(Interrupt(), std::logic_error);
}

TEST(InterruptDeathTest, TheSecondSignalEndsTheProcess) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(
      {
        const Interrupt interrupt;
        while (true) {
          std::raise(SIGINT);
          std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
      },
      testing::ExitedWithCode(3), "");
}

// As timeout(1) does: once for the process, once for its group.
TEST(InterruptDeathTest, TwoSignalsAtOnceAreOneRequest) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(
      {
        const Interrupt interrupt;
        std::raise(SIGINT);
        std::raise(SIGINT);
        wait_for_stop(interrupt.token());
        ::_exit(0);
      },
      testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace maide
