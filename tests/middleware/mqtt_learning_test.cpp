// MQTT learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// every time the same, on a busy machine too, and when broker and wrapper are killed meanwhile.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/file.hpp"
#include "maide/base/random.hpp"
#include "maide/formats/model_file.hpp"
#include "mqtt_cases.hpp"
#include "wrapper_checks.hpp"

namespace maide {
namespace {

TEST(MqttLearning, FindsTheModelsOfSessions) {
  for (const test::MqttCase& tested : test::mqtt_cases()) {
    if (tested.name != "clean_session" && tested.name != "persistent_session") continue;
    const Mealy learned = test::learn_system("mqtt", tested.options).machine;
    EXPECT_EQ(learned.size(), tested.states) << tested.name;
    EXPECT_FALSE(find_difference(tested.model, learned).has_value()) << tested.name;
  }
}

// QoS 0, and any QoS below what the broker keeps, is the paper's strict port.
TEST(MqttLearning, FindsTheStrictPort) {
  const std::string folder = MAIDE_SOURCE_DIR "/tests/models/";
  for (const char* qos : {"0", "1", "2"}) {
    const InterfaceAutomaton learned = test::learn_system("mqtt", {{"qos", qos}}).automaton;
    EXPECT_TRUE(compare(read_interface_automaton(folder + "strict-3.dot"), learned).same()) << qos;
  }
}

TEST(MqttLearning, FindsTheModelOfARawClient) {
  const test::MqttCase tested = test::mqtt_single_client();
  const Mealy learned = test::learn_system("mqtt", tested.options).machine;
  EXPECT_EQ(tested.model.size(), tested.states);
  EXPECT_EQ(learned.size(), tested.states);
  EXPECT_FALSE(find_difference(tested.model, learned).has_value());
}

class MqttRepeatedly : public testing::TestWithParam<std::size_t> {};

TEST_P(MqttRepeatedly, GivesTheSameModelTwentyTimes) {
  test::SystemOptions options = test::mqtt_options(1, 1, 1);
  options["payload"] = "gap";
  test::expect_same_twenty_times("mqtt", options, 14, GetParam());
}

INSTANTIATE_TEST_SUITE_P(BusyProcesses, MqttRepeatedly, testing::Values(0, 2));

// The processes that `parent` started, by their commands' names.
std::vector<pid_t> children_of(pid_t parent, const std::string& command) {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const pid_t process = std::atoi(entry.path().filename().c_str());
    if (process <= 0) continue;
    std::string stat;
    try {
      stat = read_file(entry.path() / "stat");
    } catch (const std::exception&) {
      continue;  // it has ended
    }
    const std::size_t end = stat.rfind(')');
    if (end == std::string::npos || stat.size() < end + 4) continue;
    const bool is_alive = stat[end + 2] != 'Z';
    if (is_alive && stat.find("(" + command) != std::string::npos &&
        std::atoi(stat.c_str() + end + 4) == parent) {
      found.push_back(process);
    }
  }
  return found;
}

// Kills brokers and wrappers of this process, in turn, at random moments, until it is destroyed.
class Killer {
 public:
  explicit Killer(std::uint64_t seed) : random_(seed), thread_([this] { run(); }) {}
  ~Killer() { stop(); }

  void stop() {
    {
      const std::scoped_lock lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }
  std::size_t kills() const { return kills_; }
  // Every wrapper and broker that was seen.
  const std::set<pid_t>& processes() const { return processes_; }

 private:
  void run() {
    for (bool broker = true;; broker = !broker) {
      std::unique_lock lock(mutex_);
      const std::chrono::milliseconds pause(300 + random_.below(400));
      if (changed_.wait_for(lock, pause, [this] { return stopped_; })) return;
      for (const pid_t wrapper : children_of(::getpid(), "maide-wrap-mqtt")) {
        processes_.insert(wrapper);
        const std::vector<pid_t> brokers = children_of(wrapper, "mosquitto");
        processes_.insert(brokers.begin(), brokers.end());
        if (broker && brokers.empty()) continue;
        ::kill(broker ? brokers.front() : wrapper, SIGKILL);
        ++kills_;
      }
    }
  }

  Random random_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;
  std::atomic<std::size_t> kills_ = 0;
  std::set<pid_t> processes_;
  std::thread thread_;
};

// Gone, or a zombie that its parent will clear away.
bool has_ended(pid_t process) {
  try {
    const std::string stat = read_file("/proc/" + std::to_string(process) + "/stat");
    const std::size_t end = stat.rfind(')');
    return end == std::string::npos || stat.size() <= end + 2 || stat[end + 2] == 'Z';
  } catch (const std::exception&) {
    return true;
  }
}

TEST(MqttLearning, SurvivesKilledBrokersAndWrappersAndLeavesNoProcess) {
  const test::MqttCase tested = test::mqtt_single_client();
  const char* wanted = std::getenv("MAIDE_TEST_KILLS");
  const std::size_t least = wanted == nullptr ? 6 : std::strtoul(wanted, nullptr, 10);
  Killer killer(7);
  int runs = 0;
  do {
    const Mealy learned = test::learn_system("mqtt", tested.options).machine;
    ASSERT_FALSE(find_difference(tested.model, learned).has_value()) << "run " << runs;
    ++runs;
  } while (killer.kills() < least);
  killer.stop();
  for (const pid_t process : killer.processes()) {
    for (int i = 0; i < 1000 && !has_ended(process); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(has_ended(process)) << process;
  }
  RecordProperty("kills", static_cast<int>(killer.kills()));
  RecordProperty("runs", runs);
}

}  // namespace
}  // namespace maide
