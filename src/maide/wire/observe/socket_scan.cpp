#include "maide/wire/observe/socket_scan.hpp"

#include <dirent.h>
#include <linux/sock_diag.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "maide/base/file.hpp"

namespace maide {
namespace {

// The numbers of the SDK's own descriptors, in this process.
struct OwnDescriptors {
  std::mutex mutex;
  std::vector<bool> is_own;  // by number
};

// Lives until the process ends: scans may outlast static destructors.
OwnDescriptors& own_descriptors() {
  static auto* set = new OwnDescriptors;
  return *set;
}

void set_own(int number, bool is_own) {
  if (number < 0) return;
  OwnDescriptors& set = own_descriptors();
  const auto place = static_cast<std::size_t>(number);
  const std::scoped_lock lock(set.mutex);
  if (place >= set.is_own.size()) set.is_own.resize(place + 1);
  set.is_own[place] = is_own;
}

bool is_own(int number) {
  OwnDescriptors& set = own_descriptors();
  const auto place = static_cast<std::size_t>(number);
  const std::scoped_lock lock(set.mutex);
  return place < set.is_own.size() && set.is_own[place];
}

// How many bytes of the value the kernel gave; 0 if it is no socket, or none with this option.
template <typename Value>
std::size_t read_option(int descriptor, int level, int option, Value& value) {
  socklen_t size = sizeof value;
  return ::getsockopt(descriptor, level, option, &value, &size) == 0 ? size : 0;
}

// Pseudo-sockets and listening ones have no bytes and report none.
std::uint64_t read_count(int descriptor, unsigned long request) {
  int value = 0;
  return ::ioctl(descriptor, request, &value) == 0 ? static_cast<std::uint64_t>(value) : 0;
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

// What one call tells of a TCP socket, while the kernel keeps it locked: whoever waits for the
// bytes counted here has been woken.
struct TcpState {
  bool is_connected = false;
  bool counts_bytes = false;   // the kernel told all of it (Linux 4.19)
  bool is_all_sent = false;    // nothing waits to be sent
  std::uint64_t sent = 0;      // bytes, those sent again not counted; the end counts as one
  std::uint64_t received = 0;  // the same, in their order
  std::uint64_t acked = 0;     // bytes ever acknowledged
  std::uint64_t unacked = 0;   // bytes that wait to be sent, and packets that were

  // Nothing if it is no TCP socket: so the answer tells the kind too.
  static std::optional<TcpState> read(int descriptor) {
    tcp_info info{};
    const std::size_t size = read_option(descriptor, IPPROTO_TCP, TCP_INFO, info);
    if (size == 0) return std::nullopt;
    TcpState state;
    state.is_connected =
        info.tcpi_state != closed && info.tcpi_state != listening && info.tcpi_state != connecting;
    state.counts_bytes = size >= offsetof(tcp_info, tcpi_bytes_retrans) + sizeof(std::uint64_t);
    state.is_all_sent = info.tcpi_notsent_bytes == 0;
    if (!state.counts_bytes) {
      state.received = read_count(descriptor, SIOCINQ);
      state.unacked = read_count(descriptor, SIOCOUTQ);
      return state;
    }
    // The kernel counts the end of a stream where it is received, not where it is sent.
    const bool is_end_unacked =
        info.tcpi_state == fin_wait_1 || info.tcpi_state == closing || info.tcpi_state == last_ack;
    state.sent = info.tcpi_bytes_sent - info.tcpi_bytes_retrans + (is_end_unacked ? 1 : 0);
    state.received = info.tcpi_bytes_received;
    state.acked = info.tcpi_bytes_acked;
    // Of a listening socket: connections that nobody has accepted.
    state.unacked = info.tcpi_unacked + std::uint64_t{info.tcpi_notsent_bytes};
    return state;
  }

 private:
  // Of the kernel's tcp_states.h, which it does not export.
  static constexpr std::uint8_t connecting = 2, fin_wait_1 = 4, closed = 7, last_ack = 9,
                                listening = 10, closing = 11;
};

// The kind of thing that a number stands for.
enum class Kind : std::uint8_t {
  unknown,  // or no socket
  tcp,
  local,  // AF_UNIX
  other,  // datagrams, as a rule
};

}  // namespace

SdkDescriptor::SdkDescriptor(int number) : number_(number) { set_own(number_, true); }

SdkDescriptor::~SdkDescriptor() { set_own(number_, false); }

struct SocketScan::Addresses {
  TcpAddress local, remote;

  // Nothing for a socket that has no connection.
  static std::optional<Addresses> read(int descriptor) {
    const auto peer = read_address(descriptor, ::getpeername);
    const auto own = peer ? read_address(descriptor, ::getsockname) : std::nullopt;
    if (!own) return std::nullopt;
    return Addresses{*own, *peer};
  }
};

// A number that the process's folder listed, and what is known of it.
struct SocketScan::Known {
  explicit Known(int descriptor) : number(descriptor) {}
  int number;
  Kind kind = Kind::unknown;
  ino_t inode = 0;  // of a socket: no other has it, before or after
  TcpState tcp;
  std::uint64_t arrived = 0, unacked = 0;  // of a socket that is not TCP's
  std::optional<Addresses> addresses;      // of a TCP connection, as last read
  bool are_addresses_new = false;          // read since this take() began
};

// The folder that lists its descriptors, and what to borrow them by.
struct SocketScan::Process {
  Process(pid_t number, const std::string& folder, Descriptor process)
      : id(number),
        directory(::opendir(folder.c_str())),
        handle(std::move(process)),
        own_handle(handle.get()) {
    if (directory != nullptr) own_directory.emplace(::dirfd(directory));
  }
  ~Process() {
    own_directory.reset();
    if (directory != nullptr) ::closedir(directory);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  // Calls `use` with a descriptor of ours for what has this number there: for an instant, a second
  // one of another process's. False where there is none.
  template <typename Use>
  bool use_descriptor(int number, Use use) const {
    if (id == 0) return use(number);
    const Descriptor borrowed = borrow(number);
    return borrowed.is_open() && use(borrowed.get());
  }
  Descriptor borrow(int number) const {
    return Descriptor(static_cast<int>(::syscall(SYS_pidfd_getfd, handle.get(), number, 0U)));
  }

  ino_t find_inode(int number) const;
  bool read_bytes(Known& socket) const;
  void recognise(Known& known) const;
  bool refresh_addresses(Known& end) const;

  pid_t id;  // 0: this one
  DIR* directory;
  Descriptor handle;
  SdkDescriptor own_handle;
  std::optional<SdkDescriptor> own_directory;
  std::vector<Known> numbers;  // in the folder's order
};

// 0: no socket, or closed. Of another process the link's name tells it, "socket:[12345]".
ino_t SocketScan::Process::find_inode(int number) const {
  if (id == 0) {
    // By the system call itself: the thread sanitizer takes fstat for a use of the descriptor,
    // which another thread may close meanwhile. That is expected here.
    struct stat status {};
    return ::syscall(SYS_fstat, number, &status) == 0 && S_ISSOCK(status.st_mode) ? status.st_ino
                                                                                  : 0;
  }
  constexpr std::string_view prefix = "socket:[";
  std::array<char, 40> target{};
  const ssize_t size = ::readlinkat(::dirfd(directory), std::to_string(number).c_str(),
                                    target.data(), target.size());
  const std::string_view text(target.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  ino_t inode = 0;
  if (!text.starts_with(prefix)) return 0;
  std::from_chars(text.data() + prefix.size(), text.data() + text.size(), inode);
  return inode;
}

// Of a socket of a known kind; false if it is not of that kind. Only of a TCP socket that is told.
bool SocketScan::Process::read_bytes(Known& socket) const {
  return use_descriptor(socket.number, [&socket](int descriptor) {
    if (socket.kind == Kind::tcp) {
      const std::optional<TcpState> state = TcpState::read(descriptor);
      if (state) socket.tcp = *state;
      return state.has_value();
    }
    std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
    if (socket.kind == Kind::other &&
        read_option(descriptor, SOL_SOCKET, SO_MEMINFO, memory) == sizeof memory) {
      socket.arrived = std::uint64_t{memory[SK_MEMINFO_RMEM_ALLOC]} + memory[SK_MEMINFO_BACKLOG] +
                       memory[SK_MEMINFO_DROPS];
      socket.unacked = memory[SK_MEMINFO_WMEM_ALLOC];
    } else {
      socket.arrived = read_count(descriptor, SIOCINQ);
      socket.unacked = read_count(descriptor, SIOCOUTQ);
    }
    return true;
  });
}

// What it was at the last look counts only where something shows that it still is: for TCP the
// answer itself, for others the inode.
void SocketScan::Process::recognise(Known& known) const {
  if (known.kind == Kind::tcp && read_bytes(known)) return;
  const ino_t inode = find_inode(known.number);
  const bool is_same =
      inode == known.inode && (known.kind == Kind::local || known.kind == Kind::other);
  if (inode == 0) {
    known = Known(known.number);
  } else if (!is_same) {
    known = Known(known.number);
    known.kind = Kind::tcp;
    known.inode = inode;
    if (read_bytes(known)) return;
    int domain = AF_UNSPEC;
    const bool is_there = use_descriptor(known.number, [&domain](int descriptor) {
      return read_option(descriptor, SOL_SOCKET, SO_DOMAIN, domain) != 0;
    });
    known.kind = !is_there ? Kind::unknown : domain == AF_UNIX ? Kind::local : Kind::other;
  }
  if (known.kind != Kind::unknown && !read_bytes(known)) known.kind = Kind::unknown;
}

bool SocketScan::Process::refresh_addresses(Known& end) const {
  if (end.are_addresses_new) return end.addresses.has_value();
  end.are_addresses_new = true;
  return use_descriptor(end.number, [&end](int descriptor) {
    end.addresses = Addresses::read(descriptor);
    return end.addresses.has_value();
  });
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

bool SocketScan::is_left_out(const Process& process, int number) const {
  return process.id == 0 &&
         (is_own(number) || std::ranges::find(ignored_, number) != ignored_.end());
}

// Its numbers, with what the last look knew of them.
void SocketScan::list(Process& process) const {
  const std::vector<Known> before = std::exchange(process.numbers, {});
  if (process.directory == nullptr) return;
  const auto has_less = [](const Known& known, int number) { return known.number < number; };
  ::rewinddir(process.directory);
  while (const dirent* entry = ::readdir(process.directory)) {
    if (entry->d_name[0] == '.') continue;
    const int number = std::atoi(entry->d_name);
    if (is_left_out(process, number)) continue;
    // The kernel lists in order; what is not found for that is new.
    const auto found = std::lower_bound(before.begin(), before.end(), number, has_less);
    const bool is_known = found != before.end() && found->number == number;
    process.numbers.push_back(is_known ? *found : Known(number));
    process.numbers.back().are_addresses_new = false;
  }
}

void SocketScan::take(SocketPicture& picture) {
  for (const auto& process : processes_) {
    list(*process);
    for (Known& known : process->numbers) process->recognise(known);
  }
  draw(picture);
}

void SocketScan::take_again(SocketPicture& picture) {
  for (const auto& process : processes_) {
    for (Known& known : process->numbers) {
      if (known.kind != Kind::unknown && !process->read_bytes(known)) known.kind = Kind::unknown;
    }
  }
  draw(picture);
}

// What was read of all sockets.
void SocketScan::draw(SocketPicture& picture) {
  picture.sockets.clear();
  picture.in_flight = false;
  for (const auto& process : processes_) {
    for (Known& known : process->numbers) {
      if (known.kind == Kind::unknown) continue;
      SocketPicture::Socket socket{process->id, known.number, known.arrived, 0, known.unacked};
      if (known.kind == Kind::tcp) {
        socket.arrived = known.tcp.received;
        socket.acked = known.tcp.acked;
        socket.unacked = known.tcp.unacked;
        picture.in_flight = picture.in_flight || is_in_flight(*process, known);
      }
      picture.sockets.push_back(socket);
    }
  }
}

bool SocketScan::is_in_flight(const Process& process, Known& end) {
  const TcpState& state = end.tcp;
  if (!state.is_connected || state.unacked == 0) return false;
  if (!state.counts_bytes || !state.is_all_sent || !process.refresh_addresses(end)) return true;
  const Known* other = find_other_end(*end.addresses);
  return other == nullptr || !other->tcp.counts_bytes || other->tcp.received < state.sent;
}

// An address that is remembered says only where to ask first: a socket may be connected anew.
const SocketScan::Known* SocketScan::find_other_end(const Addresses& end) {
  const auto is_other = [&end](const Known& seen) {
    return seen.addresses && seen.addresses->local == end.remote &&
           seen.addresses->remote == end.local;
  };
  for (const bool is_guess : {true, false}) {
    for (const auto& process : processes_) {
      for (Known& seen : process->numbers) {
        if (seen.kind != Kind::tcp || !seen.tcp.is_connected) continue;
        if (is_guess && !is_other(seen)) continue;
        if (process->refresh_addresses(seen) && is_other(seen)) return &seen;
      }
    }
  }
  return nullptr;
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
