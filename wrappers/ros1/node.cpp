#include "node.hpp"

#include <fmt/format.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpc.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>

#include "maide/base/error.hpp"

namespace maide::ros1 {
namespace {

using namespace std::chrono_literals;

// The master is a Python program: half a second on an idle machine. A client waits 60 s for all.
constexpr std::chrono::milliseconds master_start_limit = 50s;
// A master that does not answer for so long is gone; by default roscpp asks it for ever.
constexpr double master_answer_limit = 5;

// Whether the master that takes connections at `port` is that process, and not one that was quicker
// to take the port.
bool is_master(pid_t process, std::uint16_t port) {
  XmlRpc::XmlRpcClient client("127.0.0.1", port, "/");
  XmlRpc::XmlRpcValue parameters, answer;
  parameters[0] = std::string("/maide");
  const bool answered = client.execute("getPid", parameters, answer) &&
                        answer.getType() == XmlRpc::XmlRpcValue::TypeArray && answer.size() == 3 &&
                        answer[2].getType() == XmlRpc::XmlRpcValue::TypeInt;
  client.close();
  return answered && static_cast<int>(answer[2]) == process;
}

// What the user's environment says of ROS must not change what is learned.
void set_environment() {
  // The node is reached from this process and from its master only.
  ::setenv("ROS_IP", "127.0.0.1", 1);
  for (const char* name : {"ROS_HOSTNAME", "ROS_NAMESPACE", "ROSCONSOLE_CONFIG_FILE", "ROS_IPV6"}) {
    ::unsetenv(name);
  }
}

void silence() {
  if (ros::console::set_logger_level(ROSCONSOLE_DEFAULT_NAME, ros::console::levels::Fatal)) {
    ros::console::notifyLoggerLevelsChanged();
  }
  XmlRpc::setVerbosity(0);
}

}  // namespace

Node& Node::start(const std::string& master) {
  static Node node(master);
  if (node.master_ != master) {
    throw UsageError(
        fmt::format("option master: this process has its node at the master '{}'", node.master_));
  }
  return node;
}

Node::Node(const std::string& master) : master_(master), uri_(master) {
  set_environment();
  silence();
  if (master == "own") start_master();
  const ros::M_string remappings{{"__master", uri_}, {"__ip", "127.0.0.1"}};
  ros::init(remappings, "maide",
            ros::init_options::NoRosout | ros::init_options::NoSigintHandler |
                ros::init_options::AnonymousName);
  ros::master::setRetryTimeout(ros::WallDuration(master_answer_limit));
  if (!ros::master::check()) {
    throw std::runtime_error("no rosmaster answers at " + uri_);
  }
  handle_ = std::make_unique<ros::NodeHandle>("/");
}

Node::~Node() {
  handle_.reset();
  ros::shutdown();  // while there is a master to take leave of
}

void Node::start_master() {
  for (int attempts = 0; attempts < 5; ++attempts) {
    const std::uint16_t port = free_loopback_port();
    // Its log would be a file in the user's home for each run, and it prints that there is none.
    own_master_ = std::make_unique<ServiceProcess>(
        std::vector<std::string>{"rosmaster", "--core", "-p", std::to_string(port)},
        std::map<std::string, std::string>{{"ROS_IP", "127.0.0.1"},
                                           {"ROS_LOG_DIR", "/"},
                                           {"ROS_PYTHON_LOG_CONFIG_FILE", "/dev/null"}});
    own_master_->wait_for_tcp(port, master_start_limit);
    uri_ = fmt::format("http://127.0.0.1:{}/", port);
    if (is_master(own_master_->id(), port)) return;
  }
  throw std::runtime_error("rosmaster finds no free port on the loopback");
}

std::string Node::fresh_topic() {
  return fmt::format("{}/topic_{}", ros::this_node::getName(), ++topics_);
}

std::vector<pid_t> Node::processes() const {
  if (!own_master_) return {};
  return {own_master_->id()};
}

}  // namespace maide::ros1
