// The reference connection: one writer's end and one reader's end inside a process, with the three
// disciplines of a YARP connection (yarp::os::Port, and BufferedPort with and without strict
// reading). Plain mutexes and condition variables: what blocks here really blocks.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

namespace maide::port {

using Message = std::uint64_t;

class Connection {
 public:
  virtual ~Connection() = default;
  // Sends a message; how long it blocks is the discipline's. False: interrupted or closed before it
  // was taken.
  virtual bool write(Message message) = 0;
  // Blocks until there is a message; nothing: closed.
  virtual std::optional<Message> read() = 0;
  // A message if one can be had at once.
  virtual std::optional<Message> try_read() = 0;
  // Of the writer's end: a write that waits, and all to come, give up until the resume.
  virtual void interrupt() = 0;
  virtual void resume() = 0;
  // Wakes everybody, for good.
  virtual void close() = 0;
};

// Rendezvous: a write blocks until a read has taken its message.
class Port : public Connection {
 public:
  bool write(Message message) override;
  std::optional<Message> read() override;
  std::optional<Message> try_read() override;
  void interrupt() override;
  void resume() override;
  void close() override;

 private:
  // What a writer that waits has to give; lies on its stack.
  struct Offer {
    Message message;
    bool taken = false;
  };
  std::optional<Message> take();  // with the mutex held

  std::mutex mutex_;
  std::condition_variable offered_, taken_;
  Offer* offer_ = nullptr;
  bool interrupted_ = false;
  bool closed_ = false;
};

// A buffer between the two: a write never blocks. Strict: first in, first out, without a limit.
// Otherwise only the newest message is kept.
class BufferedPort : public Connection {
 public:
  explicit BufferedPort(bool strict) : strict_(strict) {}
  bool write(Message message) override;
  std::optional<Message> read() override;
  std::optional<Message> try_read() override;
  void interrupt() override;
  void resume() override;
  void close() override;

 private:
  std::optional<Message> take();  // with the mutex held

  const bool strict_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Message> kept_;
  bool interrupted_ = false;
  bool closed_ = false;
};

}  // namespace maide::port
