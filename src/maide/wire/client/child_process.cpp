#include "maide/wire/client/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <future>
#include <mutex>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <thread>
#include <utility>

#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/base/text.hpp"
#include "maide/wire/observe/thread_scan.hpp"
#include "maide/wire/protocol/line_io.hpp"

namespace maide {
namespace {

void set_nonblocking(const Descriptor& descriptor) {
  ::fcntl(descriptor.get(), F_SETFL, ::fcntl(descriptor.get(), F_GETFL) | O_NONBLOCK);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& argv,
                           const std::map<std::string, std::string>& environment) {
  if (argv.empty()) throw std::runtime_error("no program to start");
  Pipe to_child, from_child, child_errors;
  try {
    id_ = start_program(
        {argv,
         {to_child.read_end.get(), from_child.write_end.get(), child_errors.write_end.get()},
         {},
         environment});
  } catch (const std::system_error& error) {
    throw std::runtime_error(fmt::format("cannot start '{}': {}", argv[0], error.code().message()));
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

namespace {

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

Descriptor tcp_socket() {
  Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) throw std::system_error(errno, std::generic_category(), "socket");
  return socket;
}

bool takes_connections(std::uint16_t port) {
  const Descriptor socket = tcp_socket();
  const sockaddr_in address = loopback(port);
  return ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

// The process, and the thread that reads what it prints: nobody else would, and it would block.
class ServiceProcess::Output {
 public:
  Output(const std::vector<std::string>& argv,
         const std::map<std::string, std::string>& environment)
      : process_(argv, environment), reader_([this] { read(); }) {}
  ~Output() {
    stop_.write_end.reset();
    reader_.join();
  }
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  pid_t id() const { return process_.id(); }

  // Asks without taking it away, so that its number stays its own.
  bool has_ended() {
    const std::scoped_lock lock(mutex_);
    return process_.wait(std::chrono::milliseconds(0));
  }

  std::string describe() {
    const std::scoped_lock lock(mutex_);
    const std::string end =
        process_.wait(std::chrono::milliseconds(0)) ? process_.describe_end() : "";
    const std::string line = process_.last_error_line();
    return end.empty() || line.empty() ? end + line : end + ": " + line;
  }

  std::string last_error_line() const {
    const std::scoped_lock lock(mutex_);
    return process_.last_error_line();
  }

 private:
  void read() {
    const SdkThread own;
    std::string forgotten;
    std::array<pollfd, 3> waiting{};
    waiting[0] = {stop_.read_end.get(), POLLIN, 0};
    waiting[1] = {process_.output.get(), POLLIN, 0};
    waiting[2] = {process_.errors.get(), POLLIN, 0};
    while (true) {
      if (::poll(waiting.data(), waiting.size(), -1) < 0 && errno != EINTR) return;
      if (waiting[0].revents != 0) return;
      if (waiting[1].revents != 0 &&
          read_some(process_.output.get(), forgotten) == ReadResult::ended) {
        waiting[1].fd = -1;
      }
      if (waiting[2].revents != 0) {
        const std::scoped_lock lock(mutex_);
        process_.collect_errors();
        if (!process_.errors.is_open()) waiting[2].fd = -1;
      }
    }
  }

  Pipe stop_;
  mutable std::mutex mutex_;
  ChildProcess process_;
  std::thread reader_;
};

ServiceProcess::ServiceProcess(const std::vector<std::string>& argv,
                               const std::map<std::string, std::string>& environment)
    : name_(argv.empty() ? "" : argv.front()),
      output_(std::make_unique<Output>(argv, environment)) {}

ServiceProcess::~ServiceProcess() = default;

pid_t ServiceProcess::id() const { return output_->id(); }

bool ServiceProcess::has_ended() { return output_->has_ended(); }

std::string ServiceProcess::last_error_line() const { return output_->last_error_line(); }

void ServiceProcess::wait_for_tcp(std::uint16_t port, std::chrono::milliseconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!takes_connections(port)) {
    if (has_ended()) {
      throw std::runtime_error(fmt::format("{} {}", name_, output_->describe()));
    }
    if (std::chrono::steady_clock::now() >= deadline) {
      throw std::runtime_error(
          fmt::format("{} takes no connections at port {} within {} s{}{}", name_, port,
                      std::chrono::duration<double>(limit).count(),
                      last_error_line().empty() ? "" : ": ", last_error_line()));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

std::uint16_t free_loopback_port() {
  const Descriptor socket = tcp_socket();
  sockaddr_in address = loopback(0);
  socklen_t size = sizeof address;
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), size) != 0 ||
      ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    throw std::system_error(errno, std::generic_category(), "no free port on the loopback");
  }
  return ntohs(address.sin_port);
}

}  // namespace maide
