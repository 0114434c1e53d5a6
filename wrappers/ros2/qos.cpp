#include "qos.hpp"

#include <fmt/core.h>
#include <rmw/qos_profiles.h>

#include <utility>

#include "maide/base/error.hpp"

namespace maide::ros2 {
namespace {

constexpr const char* both = "both";

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

// The row for one end alone.
OptionSpec row_of_one(OptionSpec row, const std::string& prefix) {
  const bool publishes = prefix == "pub-";
  row.help = fmt::format("of the {} alone; both: as {} says",
                         publishes ? "publisher" : "subscription", row.key);
  row.key = prefix + row.key;
  row.default_value = both;
  row.allowed.emplace_back(both);
  return row;
}

std::string value_of(const OptionValues& options, const std::string& prefix, const char* key) {
  const std::string& own = options.text(prefix + key);
  return own == both ? options.text(key) : own;
}

}  // namespace

std::vector<OptionSpec> qos_options() {
  std::vector<OptionSpec> rows = rows_of_both();
  for (const char* prefix : {"pub-", "sub-"}) {
    for (OptionSpec& row : rows_of_both()) rows.push_back(row_of_one(std::move(row), prefix));
  }
  return rows;
}

rclcpp::QoS qos_from(const OptionValues& options, const std::string& prefix) {
  const auto depth = static_cast<std::size_t>(std::stoul(value_of(options, prefix, "depth")));
  const std::string history = value_of(options, prefix, "history");
  rclcpp::QoS qos{rclcpp::KeepLast(depth)};
  if (history == "keep_all") qos = rclcpp::QoS{rclcpp::KeepAll()};
  // Depth 0 stands for the middleware's own.
  if (history == "system_default")
    qos = rclcpp::QoS{rclcpp::QoSInitialization(RMW_QOS_POLICY_HISTORY_SYSTEM_DEFAULT, 0)};
  const bool is_reliable = value_of(options, prefix, "reliability") == "reliable";
  is_reliable ? qos.reliable() : qos.best_effort();
  const bool is_volatile = value_of(options, prefix, "durability") == "volatile";
  is_volatile ? qos.durability_volatile() : qos.transient_local();
  return qos;
}

rmw_qos_profile_t service_qos(std::size_t depth) {
  rmw_qos_profile_t profile = rmw_qos_profile_services_default;
  profile.depth = depth;
  return profile;
}

}  // namespace maide::ros2
