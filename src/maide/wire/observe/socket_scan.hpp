// What is on its way in the sockets of the system's processes. A thread that waits for a socket is
// woken when bytes arrive. So threads asleep say nothing about bytes that have not arrived yet. If
// both ends of a TCP connection are in sight, bytes are on their way when one end has sent more
// than the other has received. If only one end is, they are on their way when they are not
// acknowledged, which TCP delays by some 40 ms. Bytes that arrived and that nobody waits for are at
// rest.
//
// The kind of socket that a number stands for is remembered from look to look. A number may be
// closed and given to another socket between two looks, so the memory is trusted only where an
// answer shows that the socket is the same. docs/design/quiescence.md says what is remembered, and
// why that is sound.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace maide {

// This descriptor belongs to the SDK and not to the system, until this object dies (before the
// descriptor is closed): socket scans leave it out.
class SdkDescriptor {
 public:
  explicit SdkDescriptor(int number);  // -1: none
  ~SdkDescriptor();
  SdkDescriptor(const SdkDescriptor&) = delete;
  SdkDescriptor& operator=(const SdkDescriptor&) = delete;

 private:
  int number_;
};

// One picture of the sockets; two that are equal show that nothing moved in between.
struct SocketPicture {
  struct Socket {
    pid_t process = 0;  // 0: this one
    int descriptor = 0;
    // Bytes: of TCP all that were ever received; of others those that are not read yet (of
    // datagrams what they take in memory).
    std::uint64_t arrived = 0;
    std::uint64_t acked = 0;  // of TCP: bytes ever acknowledged
    std::uint64_t unacked =
        0;  // grows with what was written and is not acknowledged (others: read)
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

  // Looks at the sockets of that process, too. False if the kernel does not allow it: Linux 5.6 and
  // the right to trace the process are needed. That right is given for a child as a rule.
  bool watch_process(pid_t process);

  // Cost in system calls: one for a descriptor that is none of the SDK's own. That is all for TCP.
  // One more for another socket, two for a local one, two more for one in another process. Two for
  // each end of a connection whose bytes are not acknowledged.
  void take(SocketPicture& picture);

  // The same sockets again, if no thread of the system has run since take(): nobody else can open
  // or close them. One call a socket, two for a local one.
  void take_again(SocketPicture& picture);

  // Nothing is on its way: `picture` has no bytes in flight, or they have not moved for so long
  // (longer than TCP delays an acknowledgement) that they wait for a reader.
  bool is_at_rest(const SocketPicture& picture);
  static constexpr std::chrono::milliseconds patience{60};

 private:
  struct Process;
  struct Known;
  struct Addresses;
  bool is_left_out(const Process& process, int number) const;
  void list(Process& process) const;
  void draw(SocketPicture& picture);
  bool is_in_flight(const Process& process, Known& end);
  const Known* find_other_end(const Addresses& end);

  std::vector<std::unique_ptr<Process>> processes_;  // this one first
  std::vector<int> ignored_;
  SocketPicture stalled_;  // the last picture with bytes in flight, and since when it is the same
  std::chrono::steady_clock::time_point stalled_since_;
};

}  // namespace maide
