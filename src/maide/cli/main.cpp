// The program `maide`. Everything is in run_command_line(); this file prepares the process: broken
// pipes become errors of the write, the three standard streams exist, and what ends a program
// without an exception (a thread that throws) still ends it with one line.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <exception>

#include "maide/cli/command.hpp"

namespace {

// A standard stream that the caller closed would otherwise be the first file that we open, and the
// result would go there. Opened the wrong way round, it fails when it is used.
void hold_standard_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) == -1 && errno == EBADF) {
      ::open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
  }
}

[[noreturn]] void end_after_uncaught_exception() {
  try {
    if (std::current_exception()) std::rethrow_exception(std::current_exception());
    maide::cli::write_error_line(maide::describe_internal_error(""));
  } catch (const std::exception& error) {
    maide::cli::write_error_line(maide::describe_internal_error(error.what()));
  } catch (...) {
    maide::cli::write_error_line(maide::describe_internal_error(""));
  }
  ::_exit(static_cast<int>(maide::ExitStatus::internal));
}

}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);
  std::set_terminate(end_after_uncaught_exception);
  return maide::cli::run_command_line(argc, argv);
}
