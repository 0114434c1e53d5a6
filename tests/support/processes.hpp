// The processes that a test starts, seen from outside through /proc: what is killed, and what must
// not be left behind, whoever its parent is by then.
#pragma once

#include <stdlib.h>
#include <sys/types.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace maide::test {

// A file of /proc, or what can be read of it: its process may end meanwhile, and then a stream's
// buffer throws.
inline std::string read_process_file(pid_t process, const std::string& name) {
  const std::ifstream file("/proc/" + std::to_string(process) + "/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// What /proc/PID/stat says of a process.
struct ProcessState {
  std::string command;
  pid_t parent = 0;
  std::uint64_t ticks = 0;  // of the clock, on a CPU
};

// Nothing once it has ended, also while its parent has not taken note of that.
inline std::optional<ProcessState> look_at(pid_t process) {
  const std::string text = read_process_file(process, "stat");
  const std::size_t open = text.find('('), close = text.rfind(')');
  if (open == std::string::npos || close == std::string::npos) return std::nullopt;
  ProcessState state;
  state.command = text.substr(open + 1, close - open - 1);
  std::istringstream fields(text.substr(close + 1));
  std::string letter, skipped;
  fields >> letter >> state.parent;
  if (letter == "Z" || letter == "X") return std::nullopt;
  for (int field = 2; field < 11; ++field) fields >> skipped;
  std::uint64_t user = 0, system = 0;
  fields >> user >> system;
  state.ticks = user + system;
  return state;
}

inline bool is_running(pid_t process) { return look_at(process).has_value(); }

inline std::vector<pid_t> all_processes() {
  std::vector<pid_t> processes;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    processes.push_back(std::stoi(name));
  }
  return processes;
}

// The running children of `parent`; of that name alone, if one is given.
inline std::vector<pid_t> children_of(pid_t parent, std::string_view command = "") {
  std::vector<pid_t> children;
  for (const pid_t process : all_processes()) {
    const std::optional<ProcessState> state = look_at(process);
    if (!state || state->parent != parent) continue;
    if (command.empty() || state->command == command) children.push_back(process);
  }
  return children;
}

// The children of this process, those included that have ended and were not waited for. Quicker
// than to look at all processes.
inline std::vector<pid_t> own_children() {
  std::vector<pid_t> children;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(task.path() / "children");
    for (pid_t child = 0; file >> child;) children.push_back(child);
  }
  return children;
}

inline std::size_t count_descriptors(pid_t process) {
  const std::filesystem::directory_iterator all("/proc/" + std::to_string(process) + "/fd");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
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
    for (const pid_t process : all_processes()) {
      const std::string text = read_process_file(process, "environ");
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

}  // namespace maide::test
