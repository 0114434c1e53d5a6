// Between fork and exec only calls that are safe there: Maide has threads. posix_spawn cannot ask
// for a signal at the parent's death, so it is fork. That signal comes when the *thread* dies that
// forked, so all children are forked by one thread that lives as long as the process.
#include "maide/wire/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <functional>
#include <future>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>

#include "maide/base/printable.hpp"
#include "maide/wire/line_io.hpp"

namespace maide {
namespace {

[[noreturn]] void fail(const std::string& what, int error) {
  throw std::runtime_error(what + ": " + std::generic_category().message(error));
}

// The thread that forks. Never ends: it is the parent that children do not outlive.
class Spawner {
 public:
  static Spawner& instance() {
    static auto* spawner = new Spawner;
    return *spawner;
  }
  pid_t run(const std::function<pid_t()>& fork) {
    const std::scoped_lock one_at_a_time(callers_);
    std::unique_lock lock(mutex_);
    job_ = &fork;
    changed_.notify_all();
    changed_.wait(lock, [this] { return job_ == nullptr; });
    return result_;
  }

 private:
  Spawner() {
    std::thread([this] { serve(); }).detach();
  }
  void serve() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return job_ != nullptr; });
      result_ = (*job_)();
      job_ = nullptr;
      changed_.notify_all();
    }
  }

  std::mutex callers_, mutex_;
  std::condition_variable changed_;
  const std::function<pid_t()>* job_ = nullptr;
  pid_t result_ = -1;
};

// In the child: everything from fork to exec. Reports why it failed through `report`.
[[noreturn]] void become(char* const* argv, char* const* environment,
                         const std::array<int, 3>& standard, int report, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() == parent) {
    ::setpgid(0, 0);
    sigset_t none;
    ::sigemptyset(&none);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGCHLD, SIGHUP}) {
      ::signal(signal, SIG_DFL);
    }
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    // First out of the way of one another, then into place.
    std::array<int, 3> moved{};
    for (std::size_t i = 0; i < 3; ++i) moved[i] = ::fcntl(standard[i], F_DUPFD_CLOEXEC, 3);
    for (int i = 0; i < 3; ++i) ::dup2(moved[static_cast<std::size_t>(i)], i);
    // Whatever a library opened without asking for it.
    ::syscall(SYS_close_range, 3U, ~0U, CLOSE_RANGE_CLOEXEC);
    ::execvpe(argv[0], argv, environment);
    const int error = errno;
    static_cast<void>(!::write(report, &error, sizeof error));
  }
  ::_exit(127);
}

// This process's variables, those of `changes` set: NAME=value.
std::vector<std::string> merge_environment(const std::map<std::string, std::string>& changes) {
  std::vector<std::string> settings;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view setting = *variable;
    if (!changes.contains(std::string(setting.substr(0, setting.find('='))))) {
      settings.emplace_back(setting);
    }
  }
  for (const auto& [name, value] : changes) settings.push_back(name + "=" + value);
  return settings;
}

void set_nonblocking(const Descriptor& descriptor) {
  ::fcntl(descriptor.get(), F_SETFL, ::fcntl(descriptor.get(), F_GETFL) | O_NONBLOCK);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& argv,
                           const std::map<std::string, std::string>& environment) {
  if (argv.empty()) throw std::runtime_error("no program to start");
  Pipe to_child, from_child, child_errors, report;
  std::vector<char*> words;
  for (const std::string& word : argv) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  std::vector<std::string> settings = merge_environment(environment);
  std::vector<char*> variables;
  for (std::string& setting : settings) variables.push_back(setting.data());
  variables.push_back(nullptr);
  const pid_t self = ::getpid();
  id_ = Spawner::instance().run([&] {
    const pid_t child = ::fork();
    if (child == 0) {
      become(words.data(), variables.data(),
             {to_child.read_end.get(), from_child.write_end.get(), child_errors.write_end.get()},
             report.write_end.get(), self);
    }
    return child < 0 ? -errno : child;
  });
  if (id_ < 0) fail("cannot start a process", -id_);
  report.write_end.reset();
  int error = 0;
  ssize_t count = 0;
  do {
    count = ::read(report.read_end.get(), &error, sizeof error);
  } while (count < 0 && errno == EINTR);
  if (count > 0) {
    kill();
    fail(fmt::format("cannot start '{}'", argv[0]), error);
  }
  input = std::move(to_child.write_end);
  output = std::move(from_child.read_end);
  errors = std::move(child_errors.read_end);
  for (const Descriptor* end : {&input, &output, &errors}) set_nonblocking(*end);
}

ChildProcess::~ChildProcess() { kill(); }

void ChildProcess::collect_errors() {
  constexpr std::size_t most_kept = 4096;
  std::string bytes;
  while (errors.is_open()) {
    const ReadResult result = read_some(errors.get(), bytes);
    if (result == ReadResult::nothing_yet) return;
    if (result == ReadResult::ended) errors.reset();
    if (result == ReadResult::some) error_text_ += bytes;
    if (error_text_.size() > most_kept) error_text_.erase(0, error_text_.size() - most_kept);
  }
}

std::string ChildProcess::last_error_line() const {
  const std::size_t last = error_text_.find_last_not_of(" \t\r\n");
  if (last == std::string::npos) return "";
  const std::size_t before = error_text_.find_last_of('\n', last);
  const std::size_t first = before == std::string::npos ? 0 : before + 1;
  return one_line(std::string_view(error_text_).substr(first, last + 1 - first));
}

bool ChildProcess::wait(std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!ended_) {
    siginfo_t info{};
    // Not taken away yet: as long as it is a zombie, its number means its group and no other.
    const int result = ::waitid(P_PID, static_cast<id_t>(id_), &info, WEXITED | WNOHANG | WNOWAIT);
    if (result == 0 && info.si_pid == 0) {
      if (std::chrono::steady_clock::now() >= deadline) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } else if (result == 0 || errno != EINTR) {
      kill();
    }
  }
  return ended_;
}

std::string ChildProcess::describe_end() const {
  if (WIFSIGNALED(status_)) {
    return fmt::format("was killed by signal {} ({})", WTERMSIG(status_),
                       ::strsignal(WTERMSIG(status_)));
  }
  return fmt::format("exited with status {}", WEXITSTATUS(status_));
}

void ChildProcess::kill() {
  if (id_ < 0 || ended_) return;
  ::kill(id_, SIGKILL);
  ::kill(-id_, SIGKILL);
  while (!ended_) {
    const pid_t result = ::waitpid(id_, &status_, 0);
    ended_ = result >= 0 || errno != EINTR;
  }
}

}  // namespace maide
