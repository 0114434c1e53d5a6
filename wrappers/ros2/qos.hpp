// The QoS that a user names, for each end by itself.
#pragma once

#include <rclcpp/version.h>

#include <rclcpp/qos.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::ros2 {

// Rows `depth`, `history`, `reliability`, `durability` for both ends, and `pub-depth`, `sub-depth`,
// ... for one of them.
std::vector<OptionSpec> qos_options();

// Of one end; `prefix` is "pub-" or "sub-". Throws UsageError for combinations that make no sense.
rclcpp::QoS qos_from(const OptionValues& options, const std::string& prefix);

// What create_client and create_service take: a QoS, or in Humble (16) the profile in it.
using ServiceQos = std::conditional_t<RCLCPP_VERSION_GTE(17, 0, 0), rclcpp::QoS, rmw_qos_profile_t>;

// Of both ends of a service.
ServiceQos service_qos(std::size_t depth);

}  // namespace maide::ros2
