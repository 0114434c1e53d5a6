#include "maide/wire/socket_scan.hpp"

#include <dirent.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
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
  picture.in_flight = false;
  const auto look = [&picture](pid_t process, int number, int descriptor) {
    int domain = 0;
    int type = 0;
    if (!read_option(descriptor, SO_DOMAIN, domain) || !read_option(descriptor, SO_TYPE, type)) {
      return;
    }
    const SocketPicture::Socket socket{process, number, read_count(descriptor, SIOCINQ),
                                       read_count(descriptor, SIOCOUTQ)};
    const bool is_tcp = (domain == AF_INET || domain == AF_INET6) && type == SOCK_STREAM;
    picture.in_flight = picture.in_flight || (is_tcp && socket.unacked > 0);
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
