#include "maide/wire/socket_scan.hpp"

#include <dirent.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdlib>

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

SocketScan::SocketScan() : directory_(::opendir("/proc/self/fd")) {}

SocketScan::~SocketScan() {
  if (directory_ != nullptr) ::closedir(static_cast<DIR*>(directory_));
}

void SocketScan::take(SocketPicture& picture) {
  picture.sockets.clear();
  picture.in_flight = false;
  if (directory_ == nullptr) return;
  ::rewinddir(static_cast<DIR*>(directory_));
  while (const dirent* entry = ::readdir(static_cast<DIR*>(directory_))) {
    if (entry->d_name[0] == '.') continue;
    const int descriptor = std::atoi(entry->d_name);
    int domain = 0;
    int type = 0;
    if (!read_option(descriptor, SO_DOMAIN, domain) || !read_option(descriptor, SO_TYPE, type) ||
        std::find(ignored_.begin(), ignored_.end(), descriptor) != ignored_.end()) {
      continue;
    }
    const SocketPicture::Socket socket{descriptor, read_count(descriptor, SIOCINQ),
                                       read_count(descriptor, SIOCOUTQ)};
    const bool is_tcp = (domain == AF_INET || domain == AF_INET6) && type == SOCK_STREAM;
    picture.in_flight = picture.in_flight || (is_tcp && socket.unacked > 0);
    picture.sockets.push_back(socket);
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
