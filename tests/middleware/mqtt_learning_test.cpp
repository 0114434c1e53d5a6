// MQTT learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// also when broker and wrapper are killed meanwhile.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>
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

// What /proc says of a process; nothing once it has ended.
struct ProcessState {
  std::string command;
  pid_t parent = 0;
  std::uint64_t ticks = 0;  // of the clock, on a CPU

  static std::optional<ProcessState> of(pid_t process) {
    std::string text;
    try {
      text = read_file("/proc/" + std::to_string(process) + "/stat");
    } catch (const std::exception&) {
      return std::nullopt;
    }
    const std::size_t open = text.find('('), close = text.rfind(')');
    if (open == std::string::npos || close == std::string::npos) return std::nullopt;
    ProcessState state;
    state.command = text.substr(open + 1, close - open - 1);
    std::istringstream fields(text.substr(close + 1));
    std::string letter, skipped;
    fields >> letter >> state.parent;
    if (letter == "Z") return std::nullopt;  // its parent will clear it away
    for (int field = 2; field < 11; ++field) fields >> skipped;
    std::uint64_t system = 0;
    fields >> state.ticks >> system;
    state.ticks += system;
    return state;
  }
};

std::vector<pid_t> children_of(pid_t parent, const std::string& command) {
  std::vector<pid_t> found;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const pid_t process = std::atoi(entry.path().filename().c_str());
    const auto state = process > 0 ? ProcessState::of(process) : std::nullopt;
    if (state && state->parent == parent && state->command == command) found.push_back(process);
  }
  return found;
}

// Kills brokers and wrappers of this process, in turn, at random moments of their work: by the time
// that a wrapper has had on a CPU, so that it has answered some words on a busy machine too.
class Killer {
 public:
  Killer(std::uint64_t seed, std::size_t most)
      : random_(seed), most_(most), thread_([this] { run(); }) {}
  ~Killer() { stop(); }

  void stop() {
    stopped_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::size_t kills() const { return kills_; }
  // Every wrapper and broker that was seen, once stopped.
  const std::set<pid_t>& processes() const { return processes_; }

 private:
  void run() {
    std::uint64_t due = next_due();
    while (!stopped_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      for (const pid_t wrapper : children_of(::getpid(), "maide-wrap-mqtt")) {
        const std::vector<pid_t> brokers = children_of(wrapper, "mosquitto");
        processes_.insert(wrapper);
        processes_.insert(brokers.begin(), brokers.end());
        const auto state = ProcessState::of(wrapper);
        if (!state || state->ticks < due || brokers.empty() || kills_ == most_) continue;
        if (!killed_.insert(wrapper).second) continue;  // it is about to end
        ::kill(kills_ % 2 == 0 ? brokers.front() : wrapper, SIGKILL);
        ++kills_;
        due = next_due();
      }
    }
  }
  std::uint64_t next_due() { return 10 + random_.below(30); }

  Random random_;
  const std::size_t most_;
  std::atomic<bool> stopped_ = false;
  std::atomic<std::size_t> kills_ = 0;
  std::set<pid_t> processes_, killed_;
  std::thread thread_;
};

TEST(MqttLearning, SurvivesKilledBrokersAndWrappersAndLeavesNoProcess) {
  const test::MqttCase tested = test::mqtt_single_client();
  const char* wanted = std::getenv("MAIDE_TEST_KILLS");
  const std::size_t least = wanted == nullptr ? 6 : std::strtoul(wanted, nullptr, 10);
  Killer killer(7, least);
  int runs = 0;
  do {
    const Mealy learned = test::learn_system("mqtt", tested.options).machine;
    ASSERT_FALSE(find_difference(tested.model, learned).has_value()) << "run " << runs;
    ++runs;
  } while (killer.kills() < least);
  killer.stop();
  for (const pid_t process : killer.processes()) {
    for (int i = 0; i < 1000 && ProcessState::of(process); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_FALSE(ProcessState::of(process)) << process;
  }
  RecordProperty("kills", static_cast<int>(killer.kills()));
  RecordProperty("runs", runs);
}

}  // namespace
}  // namespace maide
