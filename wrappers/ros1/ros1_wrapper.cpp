#include "ros1_wrapper.hpp"

#include <fmt/format.h>
#include <ros/common.h>

#include <algorithm>
#include <string>
#include <vector>

#include "maide/base/error.hpp"

namespace maide::ros1 {
namespace {

// The subscriber's queue bounds itself; only queue_size=0 needs a bound to be learned.
OptionSpec size_row() {
  OptionSpec row = common_options::size(0, 1000);
  row.least = 0;
  row.help += "; 0: no bound but the subscriber's queue";
  return row;
}

// Every input and event; an actor whose inputs nobody asks for needs no thread.
SystemSetup setup_for(const std::vector<std::string>& wanted) {
  const auto is_wanted = [&](const std::string& input) {
    return std::find(wanted.begin(), wanted.end(), input) != wanted.end();
  };
  SystemSetup setup;
  setup.actors = {"writer", "reader"};
  setup.of_reader = {"reader", "network", "control"};
  setup.inputs = {{"write", "writer", {}},
                  {"burst", "writer", {}},
                  {"read", "reader", {"message"}},
                  {"tryread", "reader", {}}};
  setup.events = {
      {"message", "reader"}, {"null", "reader"}, {"failed", "reader"}, {"written", "writer"}};
  if (is_wanted("disconnect") || is_wanted("connect")) {
    setup.actors.emplace_back("network");
    setup.inputs.insert(setup.inputs.end(),
                        {{"disconnect", "network", {}}, {"connect", "network", {}}});
    setup.events.insert(setup.events.end(),
                        {{"disconnected", "network"}, {"connected", "network"}});
  }
  if (is_wanted("interrupt") || is_wanted("resume") || is_wanted("clear")) {
    setup.actors.emplace_back("control");
    setup.inputs.insert(
        setup.inputs.end(),
        {{"interrupt", "control", {}}, {"resume", "control", {}}, {"clear", "control", {}}});
    setup.events.insert(setup.events.end(),
                        {{"done", "control"}, {"resumed", "control"}, {"cleared", "control"}});
    setup.inputs[2].returns.emplace_back("failed");
  }
  return setup;
}

}  // namespace

Ros1Wrapper::Ros1Wrapper() {
  description_.name = "ros1";
  description_.summary = "ROS 1: publishers and subscribers of one topic, in one process";
  description_.versions = {
      {"ros1", fmt::format("{}.{}.{}", ROS_VERSION_MAJOR, ROS_VERSION_MINOR, ROS_VERSION_PATCH)},
      {"wrapper", "1"}};
  description_.options = Queues::options();
  for (OptionSpec& row : std::vector<OptionSpec>{
           OptionSpec::text("master", "own",
                            "URI of the rosmaster to use; own: start one on the loopback"),
           common_options::inputs({"write", "burst", "read", "tryread", "disconnect", "connect",
                                   "interrupt", "resume", "clear"}),
           common_options::observe({"message", "null", "failed", "written", "disconnected",
                                    "connected", "done", "resumed", "cleared"}),
           common_options::payload(),
           size_row(),
           common_options::at_bound(),
       }) {
    description_.options.push_back(std::move(row));
  }
  for (OptionSpec& row : common_options::ends()) description_.options.push_back(std::move(row));
}

SystemSetup Ros1Wrapper::configure(const OptionValues& options) {
  queues_ = Queues::from(options);
  node_ = &Node::start(options.text("master"));

  const std::vector<std::string> inputs = options.list("inputs");
  const bool has_values = !options.list_behind("payload", "values").empty();
  if (has_values && std::find(inputs.begin(), inputs.end(), "burst") != inputs.end()) {
    throw UsageError("option payload: with values there is no input burst");
  }
  SystemSetup setup = setup_for(inputs);
  setup.messages_come_again = queues_.latch;
  setup.processes = node_->processes();
  if (options.number("size") > 0) setup.in_flight.emplace().capacity = queues_.subscriber;
  return setup;
}

std::unique_ptr<SystemInstance> Ros1Wrapper::reset(EventSink& sink) {
  return std::make_unique<Ros1Connection>(*node_, queues_, sink, idle_);
}

}  // namespace maide::ros1
