#include "measured_run.hpp"

#include <fcntl.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"

namespace maide::bench {
namespace {

// In the child, between fork and exec: system calls alone. Returns if something fails.
void become(char* const* arguments, const char* folder, const char* output, unsigned seconds) {
  const int file = ::open(output, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || ::dup2(file, STDOUT_FILENO) < 0 || ::dup2(file, STDERR_FILENO) < 0) return;
  if (::chdir(folder) != 0) return;
  cpu_set_t core;
  CPU_ZERO(&core);
  CPU_SET(static_cast<unsigned>(::sched_getcpu()), &core);
  if (::sched_setaffinity(0, sizeof core, &core) != 0) return;
  const rlimit limit{seconds, seconds + 1};
  if (::setrlimit(RLIMIT_CPU, &limit) != 0) return;
  ::execv(arguments[0], arguments);
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

}  // namespace

MeasuredRun run_measured(const std::vector<std::string>& command,
                         const std::filesystem::path& folder, unsigned seconds) {
  const TempDir temporary("maide-bench-");
  const std::string output = temporary.path() / "output";
  std::vector<char*> arguments;
  for (const std::string& argument : command)
    arguments.push_back(const_cast<char*>(argument.data()));
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child < 0) throw UsageError("no process can be started (" + command.front() + ")");
  if (child == 0) {
    become(arguments.data(), folder.c_str(), output.c_str(), seconds);
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  while (::wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  MeasuredRun run;
  run.exit_status = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  run.seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  run.peak_bytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  run.output = read_file(output);
  if (run.exit_status == 127) throw UsageError("it cannot be run (" + command.front() + ")");
  return run;
}

}  // namespace maide::bench
