// The threads of a wrapper's process: `ActorThread`, on which an actor makes its blocking calls,
// and `Watchdog`, which sees that a piece of work ends.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace maide {

// The thread of one actor: it makes one blocking call at a time. Between calls it is idle, so it
// can serve word after word. A thread whose call never returns can only be abandoned.
class ActorThread {
 public:
  // `name` shows in debuggers (the first 15 characters).
  explicit ActorThread(const std::string& name);
  // Ends the thread; one that is still in a call is abandoned: it leaves when its call returns.
  ~ActorThread();
  ActorThread(ActorThread&&) noexcept;
  ActorThread& operator=(ActorThread&&) noexcept;

  // In a call that has not returned.
  bool is_busy() const;
  // Makes `call` on the thread and returns at once; must not be busy. `call` must not throw.
  void start(std::function<void()> call);
  // When a call last returned; long ago if none has.
  std::chrono::steady_clock::time_point last_return() const;
  // Waits until the call has returned; false if it has not at `deadline`.
  bool wait_idle(std::chrono::steady_clock::time_point deadline);

 private:
  struct State;
  std::shared_ptr<State> state_;
};

// Sees that a piece of work ends. If it does not within its limit, the expiry function is called on
// the watchdog's own thread. For work that cannot be interrupted: an open or close of a middleware
// that hangs can only be ended with its process.
class Watchdog {
 public:
  // `on_expiry` is given the name of the work.
  explicit Watchdog(std::function<void(const std::string& work)> on_expiry);
  ~Watchdog();
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  // The work goes on as long as this object lives. One at a time.
  class Guard {
   public:
    Guard(Watchdog* watchdog, std::string work, std::chrono::milliseconds limit);
    ~Guard();
    Guard(const Guard&) = delete;
    Guard& operator=(const Guard&) = delete;

   private:
    Watchdog* watchdog_;
  };

 private:
  void watch();

  std::function<void(const std::string&)> on_expiry_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string work_;
  std::optional<std::chrono::steady_clock::time_point> deadline_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace maide
