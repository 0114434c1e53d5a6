// Between fork and exec only calls that are safe there: Maide has threads. posix_spawn cannot ask
// for a signal at the parent's death, so it is fork. That signal comes when the *thread* dies that
// forked, so all children are forked by one thread that lives as long as the process.
//
// The input of run_program() is a file in memory, so nothing has to be fed; one poll loop collects
// both outputs and looks every 50 ms at the stop token and the time limit.
#include "maide/base/subprocess.hpp"

#include <fcntl.h>
#include <linux/close_range.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <functional>
#include <mutex>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"

namespace maide {

namespace {

using Clock = std::chrono::steady_clock;

// A file in memory with this content, to be read from its beginning.
void open_input(Descriptor& file, std::string_view content) {
  file = Descriptor(::memfd_create("maide-input", MFD_CLOEXEC));
  while (!content.empty()) {
    const ssize_t count = ::write(file.get(), content.data(), content.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) break;
    content.remove_prefix(static_cast<std::size_t>(count));
  }
  if (!content.empty() || ::lseek(file.get(), 0, SEEK_SET) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot keep a program's input");
  }
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
[[noreturn]] void become(char* const* argv, char* const* environment, const char* folder,
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
    if (*folder == '\0' || ::chdir(folder) == 0) ::execvpe(argv[0], argv, environment);
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

class Subprocess {
 public:
  Subprocess(const std::vector<std::string>& command, const SubprocessOptions& options)
      : options_(options) {
    Descriptor input;
    open_input(input, options.input);
    try {
      pid_ = start_program(
          {command, {input.get(), out_.write_end.get(), err_.write_end.get()}, options.folder, {}});
    } catch (const std::system_error& error) {
      throw UsageError("cannot run '" + command.front() + "': " + error.code().message());
    }
    out_.write_end.reset();
    err_.write_end.reset();
    for (const int fd : {out_.read_end.get(), err_.read_end.get()}) {
      ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
    }
  }

  ~Subprocess() {
    if (pid_ < 0) return;
    kill_group();
    while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Subprocess(const Subprocess&) = delete;
  Subprocess& operator=(const Subprocess&) = delete;

  SubprocessResult run(const RunControl& control) {
    const auto start = Clock::now();
    SubprocessResult result;
    while (!has_ended(result)) {
      control.check("the program");
      if (options_.time_limit && !result.timed_out &&
          Clock::now() - start >= *options_.time_limit) {
        result.timed_out = true;
        kill_group();
      }
      transfer(result);
    }
    // What is still in the pipes; something that the program left behind may hold them open.
    collect(out_.read_end, result.out);
    collect(err_.read_end, result.err);
    return result;
  }

 private:
  void kill_group() const { ::kill(-pid_, SIGKILL); }

  bool has_ended(SubprocessResult& result) {
    int status = 0;
    pid_t ended = 0;
    do {
      ended = ::waitpid(pid_, &status, WNOHANG);
    } while (ended < 0 && errno == EINTR);
    if (ended == 0) return false;
    kill_group();
    pid_ = -1;
    result.exit_status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    return true;
  }

  // Waits for something to do, at most 50 ms, and does it. Pipes at their end are closed, and poll
  // leaves them out.
  void transfer(SubprocessResult& result) {
    std::array<pollfd, 2> waiting{pollfd{out_.read_end.get(), POLLIN, 0},
                                  pollfd{err_.read_end.get(), POLLIN, 0}};
    const bool all_closed =
        std::ranges::all_of(waiting, [](const pollfd& entry) { return entry.fd < 0; });
    // A program that has closed its outputs is about to end.
    ::poll(waiting.data(), waiting.size(), all_closed ? 2 : 50);
    if (waiting[0].revents != 0) collect(out_.read_end, result.out);
    if (waiting[1].revents != 0) collect(err_.read_end, result.err);
  }

  void collect(Descriptor& from, std::string& into) {
    std::array<char, 65536> buffer{};
    while (from.get() >= 0) {
      const ssize_t count = ::read(from.get(), buffer.data(), buffer.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0 && errno == EAGAIN) return;
      if (count <= 0) {
        from.reset();
        return;
      }
      const std::size_t room = options_.output_limit - std::min(into.size(), options_.output_limit);
      into.append(buffer.data(), std::min(room, static_cast<std::size_t>(count)));
    }
  }

  const SubprocessOptions& options_;
  Pipe out_, err_;
  pid_t pid_ = -1;
};

}  // namespace

pid_t start_program(const ProgramStart& start) {
  std::vector<char*> words;
  for (const std::string& word : start.command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  std::vector<std::string> settings = merge_environment(start.environment);
  std::vector<char*> variables;
  for (std::string& setting : settings) variables.push_back(setting.data());
  variables.push_back(nullptr);
  Pipe report;
  const pid_t self = ::getpid();
  const pid_t id = Spawner::instance().run([&] {
    const pid_t child = ::fork();
    if (child == 0) {
      become(words.data(), variables.data(), start.folder.c_str(), start.standard,
             report.write_end.get(), self);
    }
    return child < 0 ? -errno : child;
  });
  if (id < 0) throw std::system_error(-id, std::generic_category());
  report.write_end.reset();
  int error = 0;
  ssize_t count = 0;
  do {
    count = ::read(report.read_end.get(), &error, sizeof error);
  } while (count < 0 && errno == EINTR);
  if (count <= 0) return id;
  while (::waitpid(id, nullptr, 0) < 0 && errno == EINTR) {
  }
  throw std::system_error(error, std::generic_category());
}

SubprocessResult run_program(const std::vector<std::string>& command,
                             const SubprocessOptions& options, const RunControl& control) {
  if (command.empty()) throw UsageError("no program to run");
  return Subprocess(command, options).run(control);
}

}  // namespace maide
