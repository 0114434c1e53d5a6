#include "maide/wire/observe/kernel_support.hpp"

#include <fcntl.h>
#include <linux/sock_diag.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <system_error>

#include "maide/base/file.hpp"

namespace maide {
namespace {

// A process of ours that sleeps in a system call, and ends with this object.
class SleepingChild {
 public:
  SleepingChild() : id_(::fork()) {
    if (id_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    while (true) ::pause();
  }
  ~SleepingChild() {
    if (id_ <= 0) return;
    ::kill(id_, SIGKILL);
    ::waitpid(id_, nullptr, 0);
  }
  SleepingChild(const SleepingChild&) = delete;
  SleepingChild& operator=(const SleepingChild&) = delete;

  pid_t id() const { return id_; }

 private:
  pid_t id_;
};

// The first line of a file of /proc; "" and errno where it cannot be read.
std::string read_line(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 256> buffer{};
  const ssize_t size = file.is_open() ? ::read(file.get(), buffer.data(), buffer.size()) : -1;
  const std::string text(buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  return text.substr(0, text.find('\n'));
}

void use_line(KernelFeature& feature, const std::string& path) {
  errno = 0;
  const std::string line = read_line(path);
  feature.is_usable = !line.empty();
  feature.detail =
      feature.is_usable
          ? line
          : path + ": " + (errno == 0 ? "empty" : std::generic_category().message(errno));
}

KernelFeature examine_run_counts() {
  KernelFeature feature{"schedstat", "tells how often a thread ran",
                        "wrappers refuse; give a fixed delay, quiescence=<ms>"};
  use_line(feature, "/proc/self/task/" + std::to_string(::getpid()) + "/schedstat");
  return feature;
}

KernelFeature examine_own_calls() {
  KernelFeature feature{"syscall", "tells in which call a thread of the wrapper sleeps",
                        "the state's letter is trusted, which tells less"};
  use_line(feature, "/proc/self/task/" + std::to_string(::getpid()) + "/syscall");
  return feature;
}

KernelFeature examine_calls_of_others(const SleepingChild& child) {
  KernelFeature feature{"ptrace", "shows the threads of a broker or name server (their syscall)",
                        "of their threads the state's letter is trusted, which tells less"};
  use_line(feature, "/proc/" + std::to_string(child.id()) + "/syscall");
  return feature;
}

KernelFeature examine_borrowing(const SleepingChild& child) {
  KernelFeature feature{"pidfd", "lends the sockets of a broker or name server",
                        "those sockets are left out of the look"};
  const Descriptor handle(static_cast<int>(::syscall(SYS_pidfd_open, child.id(), 0U)));
  if (!handle.is_open()) {
    feature.detail = "pidfd_open: " + std::generic_category().message(errno);
    return feature;
  }
  // The child has every descriptor that this process has.
  const Descriptor borrowed(static_cast<int>(::syscall(SYS_pidfd_getfd, handle.get(), 0, 0U)));
  feature.is_usable = borrowed.is_open();
  feature.detail = feature.is_usable ? "pidfd_open, pidfd_getfd"
                                     : "pidfd_getfd: " + std::generic_category().message(errno);
  return feature;
}

KernelFeature examine_tcp_counts() {
  KernelFeature feature{"tcp_info", "counts the bytes of a TCP connection",
                        "the bytes that wait at each end are counted instead"};
  const Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  tcp_info info{};
  socklen_t size = sizeof info;
  if (::getsockopt(socket.get(), IPPROTO_TCP, TCP_INFO, &info, &size) != 0) {
    feature.detail = std::generic_category().message(errno);
    return feature;
  }
  feature.is_usable = size >= offsetof(tcp_info, tcpi_bytes_retrans) + sizeof(std::uint64_t);
  feature.detail = std::to_string(size) + " bytes";
  return feature;
}

KernelFeature examine_memory_counts() {
  KernelFeature feature{"meminfo", "counts what a UDP socket holds",
                        "only the next datagram is counted"};
  const Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  feature.is_usable =
      ::getsockopt(socket.get(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 &&
      size == sizeof memory;
  feature.detail =
      feature.is_usable ? std::to_string(size) + " bytes" : std::generic_category().message(errno);
  return feature;
}

}  // namespace

std::vector<KernelFeature> examine_kernel() {
  const SleepingChild child;
  return {examine_run_counts(),     examine_own_calls(),  examine_calls_of_others(child),
          examine_borrowing(child), examine_tcp_counts(), examine_memory_counts()};
}

}  // namespace maide
