#include "maide/wire/watchdog.hpp"

#include <utility>

#include "maide/wire/thread_scan.hpp"

namespace maide {

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
