// Sees that a piece of work ends: if it does not within its limit, the expiry function is called on
// the watchdog's own thread. For what cannot be interrupted: a middleware's open or close that
// hangs can only be ended with its process.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace maide {

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
