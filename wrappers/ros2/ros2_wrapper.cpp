#include "ros2_wrapper.hpp"

#include <fmt/format.h>
#include <rclcpp/version.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "maide/base/error.hpp"
#include "qos.hpp"

namespace maide::ros2 {
namespace {

// What `inputs=usual` and `observe=usual` stand for depends on the kind.
constexpr const char* usual = "usual";

void append(std::vector<OptionSpec>& table, std::vector<OptionSpec> rows) {
  for (OptionSpec& row : rows) table.push_back(std::move(row));
}

void append(std::vector<std::string>& names, const std::vector<std::string>& more) {
  for (const std::string& name : more) {
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
}

OptionSpec inputs_row() {
  std::vector<std::string> names{usual, "write", "read", "tryread", "unsubscribe", "subscribe"};
  append(names, service_inputs());
  OptionSpec row = common_options::inputs(std::move(names), usual);
  row.help += "; usual: write,read of a topic, send,serve,answer,receive of a service";
  return row;
}

OptionSpec observe_row() {
  std::vector<std::string> names{usual, "message", "null", "unsubscribed", "written"};
  append(names, service_events());
  OptionSpec row = common_options::observe(std::move(names), usual);
  row.help += "; usual: message of a topic, all of the other kinds";
  return row;
}

OptionSpec size_row() {
  OptionSpec row = common_options::size(0, 1000);
  row.least = 0;
  row.help += "; 0: no bound but the QoS; kind=topic";
  return row;
}

// Options that mean something with one kind alone.
struct RowsOfKind {
  const char* kind;
  std::vector<std::string> keys;
};

std::vector<RowsOfKind> rows_by_kind() {
  RowsOfKind topic{"topic", {"history", "reliability", "durability", "size", "writers", "readers"}};
  for (const OptionSpec& row : TopicSettings::options()) topic.keys.push_back(row.key);
  for (const OptionSpec& row : qos_options()) {
    if (row.key.starts_with("pub-") || row.key.starts_with("sub-")) topic.keys.push_back(row.key);
  }
  RowsOfKind service{"service", {}};
  for (const OptionSpec& row : ServiceSettings::options()) service.keys.push_back(row.key);
  return {std::move(topic), std::move(service)};
}

}  // namespace

Ros2Wrapper::Ros2Wrapper() {
  description_.name = "ros2";
  description_.summary = "ROS 2: topics and services of rclcpp, in one process";
  description_.versions = {{"ros2", "rclcpp " RCLCPP_VERSION_STR}, {"wrapper", "1"}};
  std::vector<OptionSpec>& table = description_.options;
  table = {OptionSpec::choice("kind", "topic", {"topic", "service"}, "what is learned"),
           OptionSpec::choice("rmw", "cyclonedds", {"cyclonedds", "fastrtps"},
                              "the middleware under rclcpp")};
  append(table, qos_options());
  append(table, TopicSettings::options());
  append(table, ServiceSettings::options());
  table.push_back(OptionSpec::integer(
      "contexts", 1, 1, 2, "contexts of rclcpp; 2: what sends and what receives have one each"));
  table.push_back(inputs_row());
  table.push_back(observe_row());
  table.push_back(common_options::payload());
  table.push_back(size_row());
  table.push_back(common_options::at_bound());
  append(table, common_options::ends());
}

// Such an option would silently do nothing.
void Ros2Wrapper::refuse_options_of_other_kinds(const OptionValues& options) const {
  for (const RowsOfKind& rows : rows_by_kind()) {
    if (options.is("kind", rows.kind)) continue;
    for (const OptionSpec& row : description_.options) {
      const bool is_of_kind =
          std::find(rows.keys.begin(), rows.keys.end(), row.key) != rows.keys.end();
      if (!is_of_kind || options.is(row.key, row.default_value)) continue;
      throw UsageError(
          fmt::format("option {}: it means something with kind={} only", row.key, rows.kind));
    }
  }
}

SystemSetup Ros2Wrapper::configure(const OptionValues& options) {
  refuse_options_of_other_kinds(options);
  SystemSetup setup;
  if (options.is("kind", "topic")) {
    topic_ = TopicSettings::from(options);
    setup = topic_setup(*topic_, options);
  } else {
    service_ = ServiceSettings::from(options);
    setup = service_setup(*service_);
  }
  prepare_process(options.text("rmw"));
  nodes_.emplace(static_cast<std::size_t>(options.number("contexts")));
  return setup;
}

std::unique_ptr<SystemInstance> Ros2Wrapper::reset(EventSink& sink) {
  if (topic_) return std::make_unique<Topic>(*nodes_, *topic_, sink);
  return std::make_unique<Service>(*nodes_, *service_, sink);
}

}  // namespace maide::ros2
