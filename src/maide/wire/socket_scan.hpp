// What is on its way in the sockets of the system's processes. A thread that waits for a socket is
// woken when bytes arrive, so threads asleep say nothing about bytes that have not arrived yet.
// Where both ends of a TCP connection are in sight, bytes are on their way when the one has sent
// more than the other has received; elsewhere when they are not acknowledged, which TCP delays by
// some 40 ms. Bytes that arrived and that nobody waits for are at rest.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <memory>
#include <vector>

namespace maide {

// One picture of the sockets; two that are equal show that nothing moved in between.
struct SocketPicture {
  struct Socket {
    pid_t process = 0;  // 0: this one
    int descriptor = 0;
    int unread = 0;   // bytes received and not read (of a datagram socket: the next datagram's)
    int unacked = 0;  // bytes written and not acknowledged (local sockets: not read)
    bool operator==(const Socket&) const = default;
  };
  std::vector<Socket> sockets;  // this process's first, by descriptor
  bool in_flight = false;       // some TCP connection has bytes on their way
  bool operator==(const SocketPicture&) const = default;
};

class SocketScan {
 public:
  SocketScan();
  ~SocketScan();
  SocketScan(const SocketScan&) = delete;
  SocketScan& operator=(const SocketScan&) = delete;

  // Leaves a socket of the SDK's own out.
  void ignore(int descriptor) { ignored_.push_back(descriptor); }

  // The sockets of that process too, where the kernel lets us look (Linux 5.6, and the right to
  // trace it: a child's is given as a rule); false where it does not.
  bool watch_process(pid_t process);

  // One system call a descriptor, three more a socket, three more a TCP connection; two more for a
  // socket of another process.
  void take(SocketPicture& picture);

  // Nothing is on its way: `picture` has no bytes in flight, or they have not moved for so long
  // (longer than TCP delays an acknowledgement) that they wait for a reader.
  bool is_at_rest(const SocketPicture& picture);
  static constexpr std::chrono::milliseconds patience{60};

 private:
  struct Process;
  struct TcpEnd;
  bool is_in_flight(const TcpEnd& end) const;

  std::vector<std::unique_ptr<Process>> processes_;  // this one first
  std::vector<int> ignored_;
  std::vector<TcpEnd> ends_;  // those in sight, of the picture that is taken
  SocketPicture stalled_;  // the last picture with bytes in flight, and since when it is the same
  std::chrono::steady_clock::time_point stalled_since_;
};

}  // namespace maide
