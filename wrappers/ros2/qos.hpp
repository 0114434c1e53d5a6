// The QoS that a user names, for each end by itself.
#pragma once

#include <rclcpp/qos.hpp>
#include <string>
#include <vector>

#include "maide/wire/wrapper/wrapper_options.hpp"

namespace maide::ros2 {

// Rows `depth`, `history`, `reliability`, `durability` for both ends, and `pub-depth`, `sub-depth`,
// ... for one of them.
std::vector<OptionSpec> qos_options();

// Of one end; `prefix` is "pub-" or "sub-". Throws UsageError for combinations that make no sense.
rclcpp::QoS qos_from(const OptionValues& options, const std::string& prefix);

// Of both ends of a service.
rmw_qos_profile_t service_qos(std::size_t depth);

}  // namespace maide::ros2
