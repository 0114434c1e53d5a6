#include "ros2_wrapper.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
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
  for (const auto& more : {service_inputs(), executor_inputs(), nested_inputs()}) {
    append(names, more);
  }
  OptionSpec row = common_options::inputs(std::move(names), usual);
  row.help += "; usual: write,read of a topic, send,serve,answer,receive of a service, else all";
  return row;
}

OptionSpec observe_row() {
  std::vector<std::string> names{usual, "message", "null", "unsubscribed", "written"};
  for (const auto& more : {service_events(), executor_events(), nested_events()}) {
    append(names, more);
  }
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

// Options that mean something with some kinds alone.
struct RowsOfKinds {
  std::vector<std::string> kinds, keys;
};

std::vector<std::string> keys_of(const std::vector<OptionSpec>& rows) {
  std::vector<std::string> keys;
  for (const OptionSpec& row : rows) keys.push_back(row.key);
  return keys;
}

std::vector<RowsOfKinds> rows_by_kinds() {
  RowsOfKinds topic{{"topic"}, {"take", "size", "writers", "readers"}};
  append(topic.keys, keys_of(qos_options()));
  std::erase(topic.keys, "depth");
  return {std::move(topic),
          {{"topic", "service", "executor"}, {"depth"}},
          {{"topic", "executor"}, {"intraprocess"}},
          {{"topic", "service"}, {"payload"}},
          {{"executor", "nested"}, keys_of(ExecutorSettings::options())},
          {{"service"}, keys_of(ServiceSettings::options())},
          {{"executor"}, keys_of(ExecutorKindSettings::options())},
          {{"nested"}, keys_of(NestedSettings::options())},
          {{"nodes"}, keys_of(HeldGraph::options())}};
}

}  // namespace

Ros2Wrapper::Ros2Wrapper() {
  description_.name = "ros2";
  description_.summary = "ROS 2: topics, services and executors of rclcpp, in one process";
  description_.versions = {{"ros2", "rclcpp " RCLCPP_VERSION_STR}, {"wrapper", "1"}};
  std::vector<OptionSpec>& table = description_.options;
  table = {OptionSpec::choice("kind", "topic", {"topic", "service", "executor", "nested", "nodes"},
                              "what is learned: publishers and subscriptions, a service, what an "
                              "executor runs, a synchronous call in a callback; nodes: what maide "
                              "replay plays"),
           OptionSpec::choice("rmw", "cyclonedds", {"cyclonedds", "fastrtps"},
                              "the middleware under rclcpp")};
  append(table, qos_options());
  append(table, TopicSettings::options());
  append(table, ServiceSettings::options());
  append(table, ExecutorSettings::options());
  append(table, ExecutorKindSettings::options());
  append(table, NestedSettings::options());
  append(table, HeldGraph::options());
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
  const auto contains = [](const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const RowsOfKinds& rows : rows_by_kinds()) {
    if (contains(rows.kinds, options.text("kind"))) continue;
    for (const OptionSpec& row : description_.options) {
      if (!contains(rows.keys, row.key) || options.is(row.key, row.default_value)) continue;
      throw UsageError(fmt::format("option {}: it means something with kind={} only", row.key,
                                   fmt::join(rows.kinds, ", ")));
    }
  }
}

SystemSetup Ros2Wrapper::configure(const OptionValues& options) {
  refuse_options_of_other_kinds(options);
  SystemSetup setup;
  if (options.is("kind", "topic")) {
    topic_ = TopicSettings::from(options);
    setup = topic_setup(*topic_, options);
  } else if (options.is("kind", "service")) {
    service_ = ServiceSettings::from(options);
    setup = service_setup(*service_);
  } else if (options.is("kind", "executor")) {
    executor_ = ExecutorKindSettings::from(options);
    setup = executor_setup(*executor_);
  } else if (options.is("kind", "nodes")) {
    graph_ = HeldGraph::from(options.text("graph"));
    setup = held_setup(*graph_);
  } else {
    nested_ = NestedSettings::from(options);
    setup = nested_setup(*nested_);
  }
  prepare_process(options.text("rmw"));
  nodes_.emplace(static_cast<std::size_t>(options.number("contexts")));
  return setup;
}

std::unique_ptr<SystemInstance> Ros2Wrapper::reset(EventSink& sink) {
  if (topic_) return std::make_unique<Topic>(*nodes_, *topic_, sink);
  if (service_) return std::make_unique<Service>(*nodes_, *service_, sink);
  if (executor_) return std::make_unique<ExecutorKind>(*nodes_, *executor_, sink);
  if (graph_) return std::make_unique<HeldSystem>(*nodes_, *graph_, sink);
  return std::make_unique<Nested>(*nodes_, *nested_, sink);
}

}  // namespace maide::ros2
