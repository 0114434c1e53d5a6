#include "maide/wire/wrapper/actor_thread.hpp"

#include <pthread.h>

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "maide/wire/observe/thread_scan.hpp"

namespace maide {

// Shared with the thread itself, which may outlive its owner.
struct ActorThread::State {
  std::mutex mutex;
  std::condition_variable changed;
  std::function<void()> call;  // to be made; empty: none
  bool busy = false;
  bool ending = false;
  std::chrono::steady_clock::time_point last_return;
  std::thread thread;

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return ending || call; });
      if (!call) return;
      const std::function<void()> now = std::exchange(call, nullptr);
      lock.unlock();
      now();
      lock.lock();
      busy = false;
      last_return = std::chrono::steady_clock::now();
      changed.notify_all();
    }
  }
};

ActorThread::ActorThread(const std::string& name) : state_(std::make_shared<State>()) {
  state_->thread = std::thread([state = state_] { state->run(); });
  ::pthread_setname_np(state_->thread.native_handle(), name.substr(0, 15).c_str());
}

ActorThread::~ActorThread() {
  if (!state_) return;
  std::unique_lock lock(state_->mutex);
  state_->ending = true;
  state_->changed.notify_all();
  const bool is_busy = state_->busy;
  lock.unlock();
  if (is_busy) {
    state_->thread.detach();
  } else {
    state_->thread.join();
  }
}

ActorThread::ActorThread(ActorThread&&) noexcept = default;
ActorThread& ActorThread::operator=(ActorThread&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

bool ActorThread::is_busy() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->busy;
}

std::chrono::steady_clock::time_point ActorThread::last_return() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->last_return;
}

void ActorThread::start(std::function<void()> call) {
  const std::scoped_lock lock(state_->mutex);
  state_->call = std::move(call);
  state_->busy = true;
  state_->changed.notify_all();
}

bool ActorThread::wait_idle(std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(state_->mutex);
  return state_->changed.wait_until(lock, deadline, [this] { return !state_->busy; });
}

Watchdog::Watchdog(std::function<void(const std::string& work)> on_expiry)
    : on_expiry_(std::move(on_expiry)), thread_([this] { watch(); }) {}

Watchdog::~Watchdog() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Watchdog::watch() {
  const SdkThread own;
  std::unique_lock lock(mutex_);
  while (!ending_) {
    if (!deadline_) {
      changed_.wait(lock);
    } else if (std::chrono::steady_clock::now() < *deadline_) {
      // A later deadline needs no notice: an early awakening finds it.
      changed_.wait_until(lock, *deadline_);
    } else {
      deadline_.reset();
      const std::string work = work_;
      lock.unlock();
      on_expiry_(work);
      lock.lock();
    }
  }
}

Watchdog::Guard::Guard(Watchdog* watchdog, std::string work, std::chrono::milliseconds limit)
    : watchdog_(watchdog) {
  if (watchdog_ == nullptr) return;
  const std::scoped_lock lock(watchdog_->mutex_);
  watchdog_->work_ = std::move(work);
  watchdog_->deadline_ = std::chrono::steady_clock::now() + limit;
  watchdog_->changed_.notify_all();
}

Watchdog::Guard::~Guard() {
  if (watchdog_ == nullptr) return;
  const std::scoped_lock lock(watchdog_->mutex_);
  watchdog_->deadline_.reset();
}

}  // namespace maide
