#include "killed_services.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/random.hpp"
#include "processes.hpp"

namespace maide::test {
namespace {

// Kills when a wrapper has had so much time on a CPU, not by the clock: so it has answered some
// words on a busy machine too.
class Killer {
 public:
  Killer(std::string wrapper, std::uint64_t seed, std::size_t most)
      : wrapper_(std::move(wrapper)), random_(seed), most_(most), thread_([this] { run(); }) {}
  ~Killer() { stop(); }

  void stop() {
    stopped_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::size_t kills() const { return kills_; }

 private:
  void run() {
    std::uint64_t due = next_due();
    while (!stopped_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      for (const pid_t wrapper : children_of(::getpid(), wrapper_)) {
        const std::vector<pid_t> services = children_of(wrapper);
        const auto state = look_at(wrapper);
        if (!state || state->ticks < due || services.empty() || kills_ == most_) continue;
        if (!killed_.insert(wrapper).second) continue;  // it is about to end
        ::kill(kills_ % 2 == 0 ? services.front() : wrapper, SIGKILL);
        ++kills_;
        due = next_due();
      }
    }
  }
  std::uint64_t next_due() { return 10 + random_.below(30); }

  const std::string wrapper_;  // as /proc has it
  Random random_;
  const std::size_t most_;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::size_t> kills_ = 0;
  std::set<pid_t> killed_;
  std::thread thread_;
};

}  // namespace

void expect_same_model_when_killed(const std::string& name, const SystemOptions& options,
                                   const Mealy& model, std::size_t kills) {
  if (const char* wanted = std::getenv("MAIDE_TEST_KILLS"))
    kills = std::strtoul(wanted, nullptr, 10);
  constexpr std::size_t longest_name = 15;  // that the kernel keeps
  const ProcessMark mark;
  const LearnedSystem undisturbed = learn_system(name, options);
  Killer killer(("maide-wrap-" + name).substr(0, longest_name), 7, kills);
  int runs = 0;
  do {
    const LearnedSystem learned = learn_system(name, options);
    ASSERT_FALSE(find_difference(model, learned.machine).has_value()) << "run " << runs;
    ASSERT_EQ(learned.experiments, undisturbed.experiments) << "run " << runs;
    ++runs;
  } while (killer.kills() < kills);
  killer.stop();
  // The kernel ends a service when its wrapper dies: soon, but not before our wait returns.
  while (!mark.find().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  testing::Test::RecordProperty("kills", static_cast<int>(killer.kills()));
  testing::Test::RecordProperty("runs", runs);
}

}  // namespace maide::test
