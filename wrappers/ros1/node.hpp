// The ROS node of this process, and its master. roscpp allows one node in a process and cannot
// start a second one after it, so there is one for all wrappers, which ends with the process.
#pragma once

#include <ros/node_handle.h>
#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "maide/wire/client/child_process.hpp"

namespace maide::ros1 {

class Node {
 public:
  // The node; the first call starts it. `master`: the URI of a rosmaster, or "own" to start one on
  // a free port of the loopback. Throws UsageError if the node has another master already,
  // std::runtime_error if there is no such master.
  static Node& start(const std::string& master);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  ros::NodeHandle& handle() { return *handle_; }
  // The name of a topic that was not there before, at this master.
  std::string fresh_topic();
  // The master's, if it is our own.
  std::vector<pid_t> processes() const;

 private:
  explicit Node(const std::string& master);
  void start_master();

  std::string master_;  // as the option named it
  std::string uri_;
  std::unique_ptr<ServiceProcess> own_master_;
  std::unique_ptr<ros::NodeHandle> handle_;
  std::uint64_t topics_ = 0;
};

}  // namespace maide::ros1
