#include "maide/wire/socket_scan.hpp"

#include <dirent.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "maide/base/descriptor.hpp"

namespace maide {
namespace {

// False: not a socket. Pseudo-sockets and listening ones have no bytes and report none.
bool read_option(int descriptor, int option, int& value) {
  socklen_t size = sizeof value;
  return ::getsockopt(descriptor, SOL_SOCKET, option, &value, &size) == 0;
}

int read_count(int descriptor, unsigned long request) {
  int value = 0;
  return ::ioctl(descriptor, request, &value) == 0 ? value : 0;
}

// The address of an end, in IPv6's form for both families.
struct TcpAddress {
  std::array<std::uint8_t, 16> host{};
  std::uint16_t port = 0;
  bool operator==(const TcpAddress&) const = default;
};

template <typename Call>
std::optional<TcpAddress> read_address(int descriptor, Call call) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (call(descriptor, reinterpret_cast<sockaddr*>(&storage), &size) != 0) return std::nullopt;
  TcpAddress address;
  if (storage.ss_family == AF_INET) {
    sockaddr_in four{};
    std::memcpy(&four, &storage, sizeof four);
    address.host[10] = address.host[11] = 0xff;
    std::memcpy(&address.host[12], &four.sin_addr, 4);
    address.port = four.sin_port;
  } else {
    sockaddr_in6 six{};
    std::memcpy(&six, &storage, sizeof six);
    std::memcpy(address.host.data(), &six.sin6_addr, address.host.size());
    address.port = six.sin6_port;
  }
  return address;
}

}  // namespace

// The folder that lists its descriptors, and what to borrow them by.
struct SocketScan::Process {
  Process(pid_t number, const std::string& folder, Descriptor process)
      : id(number), directory(::opendir(folder.c_str())), handle(std::move(process)) {}
  ~Process() {
    if (directory != nullptr) ::closedir(directory);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  bool is_socket(const char* name) const {
    std::array<char, 8> target{};
    return ::readlinkat(::dirfd(directory), name, target.data(), target.size()) > 0 &&
           std::string_view(target.data(), 7) == "socket:";
  }
  // A second descriptor of ours for the same socket, for an instant.
  Descriptor borrow(int descriptor) const {
    return Descriptor(static_cast<int>(::syscall(SYS_pidfd_getfd, handle.get(), descriptor, 0U)));
  }

  pid_t id;  // 0: this one
  DIR* directory;
  Descriptor handle;
};

// One end of a TCP connection.
struct SocketScan::TcpEnd {
  TcpAddress local, remote;
  bool is_unacked = false;
  bool counts_bytes = false;   // the kernel told the rest (Linux 4.19)
  bool is_all_sent = false;    // nothing waits to be sent
  std::uint64_t sent = 0;      // bytes, those sent again not counted; the end counts as one
  std::uint64_t received = 0;  // the same, in their order

  // Nothing for a socket that has no connection.
  static std::optional<TcpEnd> read(int descriptor, bool is_unacked) {
    const auto remote = read_address(descriptor, ::getpeername);
    const auto local = remote ? read_address(descriptor, ::getsockname) : std::nullopt;
    if (!local) return std::nullopt;
    TcpEnd end{*local, *remote, is_unacked};
    tcp_info info{};
    socklen_t size = sizeof info;
    end.counts_bytes = ::getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
                       size >= offsetof(tcp_info, tcpi_bytes_retrans) + sizeof(std::uint64_t);
    end.is_all_sent = info.tcpi_notsent_bytes == 0;
    // The kernel counts the end of a stream where it is received, not where it is sent.
    const bool is_end_unacked =
        info.tcpi_state == fin_wait_1 || info.tcpi_state == closing || info.tcpi_state == last_ack;
    end.sent = info.tcpi_bytes_sent - info.tcpi_bytes_retrans + (is_end_unacked ? 1 : 0);
    end.received = info.tcpi_bytes_received;
    return end;
  }

 private:
  // Of the kernel's tcp_states.h, which it does not export.
  static constexpr std::uint8_t fin_wait_1 = 4, last_ack = 9, closing = 11;
};

bool SocketScan::is_in_flight(const TcpEnd& end) const {
  if (!end.is_unacked) return false;
  const auto other = std::find_if(ends_.begin(), ends_.end(), [&](const TcpEnd& seen) {
    return seen.local == end.remote && seen.remote == end.local;
  });
  if (other == ends_.end() || !end.counts_bytes || !other->counts_bytes) return true;
  return !end.is_all_sent || other->received < end.sent;
}

SocketScan::SocketScan() {
  processes_.push_back(std::make_unique<Process>(0, "/proc/self/fd", Descriptor()));
}

SocketScan::~SocketScan() = default;

bool SocketScan::watch_process(pid_t process) {
  Descriptor handle(static_cast<int>(::syscall(SYS_pidfd_open, process, 0U)));
  if (!handle.is_open()) return false;
  auto watched = std::make_unique<Process>(process, "/proc/" + std::to_string(process) + "/fd",
                                           std::move(handle));
  if (watched->directory == nullptr) return false;
  // Asking for a descriptor that there is not tells whether one may ask.
  constexpr int none = 1 << 30;
  if (!watched->borrow(none).is_open() && errno != EBADF) return false;
  processes_.push_back(std::move(watched));
  return true;
}

void SocketScan::take(SocketPicture& picture) {
  picture.sockets.clear();
  ends_.clear();
  const auto look = [&picture, this](pid_t process, int number, int descriptor) {
    int domain = 0;
    int type = 0;
    if (!read_option(descriptor, SO_DOMAIN, domain) || !read_option(descriptor, SO_TYPE, type)) {
      return;
    }
    const SocketPicture::Socket socket{process, number, read_count(descriptor, SIOCINQ),
                                       read_count(descriptor, SIOCOUTQ)};
    const bool is_tcp = (domain == AF_INET || domain == AF_INET6) && type == SOCK_STREAM;
    if (is_tcp) {
      if (const auto end = TcpEnd::read(descriptor, socket.unacked > 0)) ends_.push_back(*end);
    }
    picture.sockets.push_back(socket);
  };
  for (const auto& process : processes_) {
    if (process->directory == nullptr) continue;
    ::rewinddir(process->directory);
    while (const dirent* entry = ::readdir(process->directory)) {
      if (entry->d_name[0] == '.') continue;
      const int number = std::atoi(entry->d_name);
      if (process->id == 0) {
        const bool is_ignored =
            std::find(ignored_.begin(), ignored_.end(), number) != ignored_.end();
        if (!is_ignored) look(0, number, number);
      } else if (process->is_socket(entry->d_name)) {
        const Descriptor borrowed = process->borrow(number);
        if (borrowed.is_open()) look(process->id, number, borrowed.get());
      }
    }
  }
  picture.in_flight = std::any_of(ends_.begin(), ends_.end(),
                                  [this](const TcpEnd& end) { return is_in_flight(end); });
}

bool SocketScan::is_at_rest(const SocketPicture& picture) {
  if (!picture.in_flight) return true;
  const auto now = std::chrono::steady_clock::now();
  if (!(picture == stalled_)) {
    stalled_ = picture;
    stalled_since_ = now;
  }
  return now - stalled_since_ >= patience;
}

}  // namespace maide
