// ROS 1 learned for real, over its wrapper's pipes: what comes out is the model written by hand,
// the paper's ports among them, every time the same: on a busy machine, and when the rosmaster or
// the wrapper is killed on the way.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/random.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/wire/wrapper_proxy.hpp"
#include "maide/workflow/experiment.hpp"
#include "ros1_cases.hpp"

namespace maide {
namespace {

using test::SystemOptions;

InterfaceAutomaton reference(const std::string& name) {
  return read_interface_automaton(std::string(MAIDE_SOURCE_DIR "/tests/models/") + name + ".dot");
}

class Ros1Mealy : public testing::TestWithParam<test::Ros1Case> {};

TEST_P(Ros1Mealy, IsLearned) {
  const Mealy learned = test::learn_system("ros1", GetParam().options()).machine;
  EXPECT_EQ(learned.size(), GetParam().states);
  const Mealy model = test::make_ros1_connection(GetParam().model, GetParam().inputs);
  EXPECT_FALSE(find_difference(model, learned).has_value());
}

// One of each kind: test_ros1 plays the words of all.
std::vector<test::Ros1Case> learned_cases() {
  std::vector<test::Ros1Case> cases = test::ros1_cases();
  std::erase_if(cases, [](const test::Ros1Case& tested) {
    return tested.name != "queue_gap_3" && tested.name != "burst" && tested.name != "latch" &&
           tested.name != "reconnect_intraprocess" && tested.name != "interrupt_1";
  });
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Queues, Ros1Mealy, testing::ValuesIn(learned_cases()),
                         [](const auto& tested) { return tested.param.name; });

// The names of the reference ports whose models ROS 1's connections share.
struct PortCase {
  std::string name;
  SystemOptions options;
  std::string reference;
};

void PrintTo(const PortCase& tested, std::ostream* out) { *out << tested.name; }

class Ros1Automaton : public testing::TestWithParam<PortCase> {};

TEST_P(Ros1Automaton, IsThatOfThePort) {
  const InterfaceAutomaton expected = reference(GetParam().reference);
  for (const Translation translation : {Translation::eager, Translation::av}) {
    const InterfaceAutomaton learned =
        test::learn_system("ros1", GetParam().options, "", translation).automaton;
    EXPECT_EQ(learned.size(), expected.size());
    EXPECT_TRUE(compare(expected, learned).same());
  }
}

INSTANTIATE_TEST_SUITE_P(
    Ports, Ros1Automaton,
    testing::Values(PortCase{"queue_1", {}, "buffered"},
                    PortCase{"unbounded_1", {{"queue_size", "0"}, {"size", "1"}}, "strict-1"},
                    PortCase{"unbounded_3", {{"queue_size", "0"}, {"size", "3"}}, "strict-3"},
                    PortCase{"unbounded_3_tryread_absorb",
                             {{"queue_size", "0"},
                              {"size", "3"},
                              {"at-bound", "absorb"},
                              {"inputs", "write,read,tryread"}},
                             "strict-3-tryread-absorb"}),
    [](const auto& tested) { return tested.param.name; });

// "R", "S", "Z" ... and the parent, from /proc; nothing if there is no such process.
struct ProcessState {
  char state = 0;
  pid_t parent = 0;
};

ProcessState look_at(const std::string& process) {
  std::ifstream file("/proc/" + process + "/stat");
  std::string text;
  std::getline(file, text);
  ProcessState found;
  std::istringstream rest(text.substr(std::min(text.rfind(')') + 1, text.size())));
  rest >> found.state >> found.parent;
  return found;
}

bool is_alive(pid_t process) {
  const char state = look_at(std::to_string(process)).state;
  return state != 0 && state != 'Z';
}

std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (look_at(name).parent == parent) children.push_back(std::stoi(name));
  }
  return children;
}

// Hands everything on to a wrapper in a child process, and every so many answers kills that wrapper
// or its rosmaster, whatever they are doing.
class DeadlySul : public Sul {
 public:
  explicit DeadlySul(Sul& sul) : sul_(sul) {}

  const SulInfo& info() const override { return sul_.info(); }
  void add_purpose(const LearningPurpose& purpose) override { sul_.add_purpose(purpose); }
  void run(std::span<const SulQuery> batch, const SulAnswerSink& sink,
           const RunControl& control) override {
    sul_.run(
        batch,
        [&](std::size_t index, SulAnswer answer) {
          if (++answers_ % 25 == 0) kill_one();
          sink(index, std::move(answer));
        },
        control);
  }

  const std::vector<pid_t>& seen() const { return seen_; }
  int killed() const { return killed_; }

 private:
  void kill_one() {
    std::vector<pid_t> alive;
    for (const pid_t wrapper : children_of(::getpid())) {
      if (!is_alive(wrapper)) continue;
      alive.push_back(wrapper);
      for (const pid_t master : children_of(wrapper)) alive.push_back(master);
    }
    ASSERT_EQ(alive.size(), 2u) << "a wrapper and its rosmaster";
    seen_.insert(seen_.end(), alive.begin(), alive.end());
    std::this_thread::sleep_for(std::chrono::microseconds(random_.below(3000)));
    ::kill(alive[random_.below(2)], SIGKILL);
    ++killed_;
  }

  Sul& sul_;
  Random random_{1};
  std::size_t answers_ = 0;
  int killed_ = 0;
  std::vector<pid_t> seen_;
};

TEST(Ros1Killed, WrapperOrRosmasterTheModelIsTheSame) {
  std::vector<pid_t> seen;
  {
    const auto wrapper =
        spawn_wrapper({MAIDE_BINARY_DIR "/bin/maide-wrap-ros1"}, {{"queue_size", "2"},
                                                                  {"payload", "gap"},
                                                                  {"inputs", "write,tryread"},
                                                                  {"observe", "message,null"}});
    DeadlySul sul(*wrapper);
    IaTranslator translator(sul, Translation::eager);
    const ExperimentResult result = run_experiment(translator, {});
    if (result.error) std::rethrow_exception(result.error);
    const Mealy model = test::make_ros1_connection({2, false, true}, {"write", "tryread"});
    EXPECT_FALSE(find_difference(model, result.model).has_value());
    EXPECT_GE(sul.killed(), 5);
    seen = sul.seen();
  }
  // The kernel kills a rosmaster when its wrapper dies: soon, but not before our wait returns.
  for (const pid_t process : seen) {
    for (int looks = 0; looks < 2000 && is_alive(process); ++looks) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_FALSE(is_alive(process));
  }
}

}  // namespace
}  // namespace maide
