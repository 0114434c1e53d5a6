#include "nodes.hpp"

#include <fmt/core.h>
#include <rcutils/logging.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <random>
#include <rcpputils/shared_library.hpp>
#include <stdexcept>

#include "maide/base/error.hpp"

namespace maide::ros2 {
namespace {

constexpr std::size_t words_per_node = 200;
constexpr std::size_t most_retired = 50;
constexpr std::size_t deleting_threads = 4;

// Cyclone needs no network at all within a process, the others stay on the loopback device. There
// another process may be on this domain, but has other names.
std::size_t domain() { return static_cast<std::size_t>(1 + ::getpid() % 100); }

std::string own_name() { return fmt::format("maide_{}_{}", ::getpid(), std::random_device()()); }

// Fast DDS answers a late subscription 70 ms after it has matched, while all threads sleep. With
// these timers it does so at once, as wrappers/fastdds/protocol_timers.cpp says in more detail.
constexpr std::string_view short_timers = R"(<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <data_writer profile_name="writer" is_default_profile="true"><times>
    <initialHeartbeatDelay><nanosec>0</nanosec></initialHeartbeatDelay>
    <heartbeatPeriod><nanosec>2000000</nanosec></heartbeatPeriod>
    <nackResponseDelay><nanosec>0</nanosec></nackResponseDelay>
  </times></data_writer>
  <data_reader profile_name="reader" is_default_profile="true"><times>
    <initialAcknackDelay><nanosec>0</nanosec></initialAcknackDelay>
    <heartbeatResponseDelay><nanosec>0</nanosec></heartbeatResponseDelay>
  </times></data_reader>
</profiles>
)";

// In a file without a name, which the process keeps open.
void shorten_timers() {
  const int file = ::memfd_create("profiles", 0);
  const auto size = static_cast<ssize_t>(short_timers.size());
  if (file < 0 || ::write(file, short_timers.data(), short_timers.size()) != size) {
    throw std::system_error(errno, std::generic_category(), "a file in memory");
  }
  ::setenv("FASTRTPS_DEFAULT_PROFILES_FILE", fmt::format("/proc/self/fd/{}", file).c_str(), 1);
}

void load_rmw(const std::string& library) {
  try {
    const rcpputils::SharedLibrary loaded(rcpputils::get_platform_library_name(library));
  } catch (const std::exception&) {
    throw UsageError(fmt::format("option rmw: {} is not installed beside rclcpp", library));
  }
}

}  // namespace

void prepare_process(const std::string& rmw) {
  const std::string library = "rmw_" + rmw + "_cpp";
  for (const char* name : {"ROS_DISCOVERY_SERVER", "FASTRTPS_DEFAULT_PROFILES_FILE",
                           "FASTDDS_DEFAULT_PROFILES_FILE", "RMW_FASTRTPS_USE_QOS_FROM_XML",
                           "ROS_SECURITY_ENABLE", "ROS_LOCALHOST_ONLY", "CYCLONEDDS_URI"}) {
    ::unsetenv(name);
  }
  ::setenv("SKIP_DEFAULT_XML", "1", 1);
  if (rmw == "cyclonedds") {
    ::setenv("CYCLONEDDS_URI", "<General><Transport>none</Transport></General>", 1);
  } else {
    ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
    shorten_timers();
  }
  ::setenv("RMW_IMPLEMENTATION", library.c_str(), 1);
  load_rmw(library);
  // What fails says so by an exception or a return code, and standard error is not the log's.
  if (rcutils_logging_initialize() == RCUTILS_RET_OK) {
    rcutils_logging_set_default_logger_level(RCUTILS_LOG_SEVERITY_FATAL);
  }
}

Nodes::Nodes(std::size_t contexts) : name_(own_name()) {
  for (std::size_t context = 0; context < contexts; ++context) {
    rclcpp::InitOptions options;
    options.auto_initialize_logging(false);
    options.set_domain_id(domain());
    contexts_.push_back(std::make_shared<rclcpp::Context>());
    contexts_.back()->init(0, nullptr, options);
  }
  make_nodes();
}

Nodes::~Nodes() {
  delete_retired();
  nodes_.clear();
  for (const rclcpp::Context::SharedPtr& context : contexts_)
    context->shutdown("all words are done");
}

std::string Nodes::next_word() {
  if (retired_.size() >= most_retired) delete_retired();
  if (++words_ % words_per_node == 0) make_nodes();
  return fmt::format("{}_{}", name_, words_);
}

void Nodes::retire(std::shared_ptr<void> ends) { retired_.push_back(std::move(ends)); }

void Nodes::delete_retired() {
  {
    std::array<std::jthread, deleting_threads> threads;
    for (std::size_t first = 0; first < threads.size(); ++first) {
      threads[first] = std::jthread([this, first] {
        for (std::size_t i = first; i < retired_.size(); i += deleting_threads) retired_[i].reset();
      });
    }
  }
  retired_.clear();
}

// Nothing of a node but what a word makes in it: no services, no topics of its own.
rclcpp::Node::SharedPtr Nodes::make_node(const std::string& name, std::size_t context) const {
  rclcpp::NodeOptions options;
  options.context(contexts_[context])
      .use_global_arguments(false)
      .enable_rosout(false)
      .start_parameter_services(false)
      .start_parameter_event_publisher(false)
      .use_clock_thread(false);
  return std::make_shared<rclcpp::Node>(name, options);
}

void Nodes::make_nodes() {
  nodes_.clear();
  for (std::size_t context = 0; context < contexts_.size(); ++context) {
    nodes_.push_back(make_node(fmt::format("{}_{}_{}", name_, context, words_), context));
  }
}

}  // namespace maide::ros2
