// What the tests of crashing systems share: the fragile lamp, its model, processes left behind.
#pragma once

#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/wire/wrapper_proxy.hpp"
#include "maide/workflow/learn_model.hpp"

namespace maide::test {

using Options = std::map<std::string, std::string>;

// `end` is what a hit does to the lamp that is on.
inline InterfaceAutomaton make_lamp(const std::string& end) {
  InterfaceAutomaton lamp(Alphabet({"press", "hit"}), Alphabet({"on", "off", "dull", end}), 7);
  const auto input = [](Symbol symbol) { return Action{Action::Kind::input, symbol}; };
  const auto output = [](Symbol symbol) { return Action{Action::Kind::output, symbol}; };
  lamp.add_transition(0, input(0), 2);   // off, press
  lamp.add_transition(2, output(0), 1);  // on
  lamp.add_transition(1, input(0), 3);   // on, press
  lamp.add_transition(3, output(1), 0);
  lamp.add_transition(0, input(1), 4);  // off, hit
  lamp.add_transition(4, output(2), 0);
  lamp.add_transition(1, input(1), 5);  // on, hit
  lamp.add_transition(5, output(3), 6);
  return lamp;
}

inline LearnedModel learn_lamp(const Options& options, Translation translation,
                               const ExperimentOptions& experiment = {}) {
  const auto sul = spawn_wrapper({MAIDE_BINARY_DIR "/bin/fragile_wrapper"}, options);
  LearnedModel learned = learn_model(*sul, translation, experiment);
  if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
  return learned;
}

inline bool is_running(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(file, text);
  const std::size_t end = text.rfind(')');
  return end != std::string::npos && text.substr(end + 2, 1) != "Z";
}

// Marks every process that is started from now on, by whomever; so that those that are left behind
// can be found, whoever their parent is then.
class ProcessMark {
 public:
  ProcessMark() : mark_("MAIDE_TEST_MARK=" + std::to_string(::getpid())) {
    ::setenv("MAIDE_TEST_MARK", std::to_string(::getpid()).c_str(), 1);
  }
  ~ProcessMark() { ::unsetenv("MAIDE_TEST_MARK"); }
  ProcessMark(const ProcessMark&) = delete;
  ProcessMark& operator=(const ProcessMark&) = delete;

  std::vector<pid_t> find() const {
    std::vector<pid_t> processes;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const std::string name = entry.path().filename();
      if (name.find_first_not_of("0123456789") != std::string::npos) continue;
      const pid_t process = std::stoi(name);
      std::ifstream file(entry.path() / "environ");
      const std::string text((std::istreambuf_iterator<char>(file)), {});
      if (process != ::getpid() && text.find(mark_ + '\0') != std::string::npos &&
          is_running(process)) {
        processes.push_back(process);
      }
    }
    return processes;
  }

 private:
  std::string mark_;
};

// The children of this process: the wrappers that it has started.
inline std::vector<pid_t> find_children() {
  std::vector<pid_t> children;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "children");
    for (pid_t child = 0; file >> child;) children.push_back(child);
  }
  return children;
}

}  // namespace maide::test
