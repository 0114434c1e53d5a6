// An executor whose threads are held at two points of the loop in which rclcpp's executors spin:
//
//   get_next_executable()      held before: pick() lets one idle thread go on
//   execute_any_executable()   held before: start() lets the thread that picked it go on
//
// SingleThreadedExecutor::spin and MultiThreadedExecutor::run are this loop, on one thread and on
// several. The system's scheduler may hold a thread at both points for as long as it likes. So what
// a held executor does, rclcpp's own may do. Which callback it picks is rclcpp's decision.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <rclcpp/rclcpp.hpp>
#include <thread>
#include <vector>

namespace maide::ros2 {

class HeldExecutor : public rclcpp::Executor {
 public:
  // What a thread picked: the timer, subscription, service or client; null: nothing is ready.
  using OnPick = std::function<void(const void* picked)>;
  // Whether what the client takes next is for others, and that is no step. To take it runs nothing,
  // so the thread is not held, and picks again.
  using IsForNobody = std::function<bool(const void* client)>;

  // Both are called by the threads; `on_pick` until set_free().
  HeldExecutor(const rclcpp::ExecutorOptions& options, std::size_t threads, OnPick on_pick,
               IsForNobody is_for_nobody);
  ~HeldExecutor() override;

  // Its threads begin to wait. Once, when all that they run is there.
  void spin() override;
  // One idle thread picks what comes next, and is held before it runs it. Waits for nothing.
  void pick();
  // The thread that picked it runs it.
  void start(const void* picked);
  // No thread is held any more, and idle ones wait for what comes.
  void set_free();
  // From another thread. All threads end behind the callbacks that they run.
  void stop();

 private:
  void run();
  // Waits for it, or for the end. False at the end.
  bool wait_for(const std::function<bool()>& condition);

  const std::size_t thread_count_;
  const OnPick on_pick_;
  const IsForNobody is_for_nobody_;
  std::mutex mutex_of_holds_;  // for what follows
  std::condition_variable changed_;
  std::size_t picks_ = 0;
  std::map<const void*, std::size_t> starts_;
  bool is_free_ = false, is_stopped_ = false;

  std::mutex mutex_of_waiting_;  // as in MultiThreadedExecutor: one thread at a time looks
  std::vector<std::jthread> threads_;
};

}  // namespace maide::ros2
