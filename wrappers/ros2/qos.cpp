#include "qos.hpp"

#include <rmw/qos_profiles.h>

namespace maide::ros2 {
namespace {

std::vector<OptionSpec> rows_of_both() {
  return {
      OptionSpec::integer("depth", 10, 0, 1000,
                          "messages that keep_last keeps, requests and answers of a service; "
                          "ROS 2's usual value")
          .keeping_more_with("+"),
      OptionSpec::choice("history", "keep_last", {"keep_last", "keep_all", "system_default"},
                         "QoS of both ends; ROS 2's default")
          .keeping_more_with("keep_all"),
      OptionSpec::choice("reliability", "reliable", {"reliable", "best_effort"},
                         "QoS of both ends; ROS 2's default")
          .keeping_more_with("reliable"),
      OptionSpec::choice("durability", "volatile", {"volatile", "transient_local"},
                         "QoS of both ends; transient_local: a late subscription gets what the "
                         "publisher keeps")
          .keeping_more_with("transient_local"),
  };
}

template <typename Qos>
Qos qos_of(const rmw_qos_profile_t& profile) {
  if constexpr (std::is_same_v<Qos, rmw_qos_profile_t>) {
    return profile;
  } else {
    return Qos(rclcpp::QoSInitialization::from_rmw(profile), profile);
  }
}

}  // namespace

std::vector<OptionSpec> qos_options() { return common_options::with_each_end(rows_of_both()); }

rclcpp::QoS qos_from(const OptionValues& options, const std::string& prefix) {
  const auto depth = static_cast<std::size_t>(std::stoul(options.of_end(prefix, "depth")));
  const std::string history = options.of_end(prefix, "history");
  rclcpp::QoS qos{rclcpp::KeepLast(depth)};
  if (history == "keep_all") qos = rclcpp::QoS{rclcpp::KeepAll()};
  // Depth 0 stands for the middleware's own.
  if (history == "system_default")
    qos = rclcpp::QoS{rclcpp::QoSInitialization(RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT, 0)};
  const bool is_reliable = options.of_end(prefix, "reliability") == "reliable";
  is_reliable ? qos.reliable() : qos.best_effort();
  const bool is_volatile = options.of_end(prefix, "durability") == "volatile";
  is_volatile ? qos.durability_volatile() : qos.transient_local();
  return qos;
}

ServiceQos service_qos(std::size_t depth) {
  rmw_qos_profile_t profile = rmw_qos_profile_services_default;
  profile.depth = depth;
  return qos_of<ServiceQos>(profile);
}

}  // namespace maide::ros2
