// posix_spawn rather than fork: the parent has threads. The program's input is a file in memory, so
// nothing has to be fed; one poll loop collects both its outputs and looks every 50 ms at the stop
// token and the time limit.
#include "maide/base/subprocess.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>
#include <utility>

#include "maide/base/descriptor.hpp"
#include "maide/base/error.hpp"

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

// The attributes of posix_spawn, freed with their owner.
struct SpawnSettings {
  posix_spawn_file_actions_t actions{};
  posix_spawnattr_t attributes{};
  SpawnSettings() {
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawnattr_init(&attributes);
  }
  ~SpawnSettings() {
    ::posix_spawn_file_actions_destroy(&actions);
    ::posix_spawnattr_destroy(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
};

class Subprocess {
 public:
  Subprocess(const std::vector<std::string>& command, const SubprocessOptions& options)
      : options_(options) {
    Descriptor input;
    open_input(input, options.input);
    SpawnSettings settings;
    ::posix_spawn_file_actions_adddup2(&settings.actions, input.get(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&settings.actions, out_.write_end.get(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&settings.actions, err_.write_end.get(), STDERR_FILENO);
    if (!options.folder.empty()) {
      ::posix_spawn_file_actions_addchdir_np(&settings.actions, options.folder.c_str());
    }
    sigset_t defaults;
    ::sigemptyset(&defaults);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) ::sigaddset(&defaults, signal);
    ::posix_spawnattr_setsigdefault(&settings.attributes, &defaults);
    ::posix_spawnattr_setpgroup(&settings.attributes, 0);
    ::posix_spawnattr_setflags(&settings.attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);

    std::vector<char*> argv;
    argv.reserve(command.size() + 1);
    for (const std::string& word : command) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const int error = ::posix_spawnp(&pid_, argv[0], &settings.actions, &settings.attributes,
                                     argv.data(), environ);
    if (error != 0) {
      pid_ = -1;
      throw UsageError("cannot run '" + command.front() +
                       "': " + std::generic_category().message(error));
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
    const bool all_closed = std::all_of(waiting.begin(), waiting.end(),
                                        [](const pollfd& entry) { return entry.fd < 0; });
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

SubprocessResult run_program(const std::vector<std::string>& command,
                             const SubprocessOptions& options, const RunControl& control) {
  if (command.empty()) throw UsageError("no program to run");
  return Subprocess(command, options).run(control);
}

}  // namespace maide
