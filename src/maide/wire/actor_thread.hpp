// The thread of one actor: makes one blocking call at a time. Idle between calls, so it can serve
// word after word; a thread whose call never returns can only be abandoned.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace maide {

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

}  // namespace maide
