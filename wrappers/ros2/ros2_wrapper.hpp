// The wrapper for ROS 2: `maide learn ros2 kind=topic depth=10`. What is learned is rclcpp over an
// implementation of rmw, in one process, as programs use it:
//
//   kind=topic     publishers and subscriptions (topic.hpp)
//   kind=service   a server and one or two clients (service.hpp)
//   kind=executor  what an executor runs, and in which order (executor.hpp)
//   kind=nested    a synchronous call inside a callback (nested.hpp)
//   kind=nodes     the nodes of a system file, for maide replay (held_system.hpp)
//
// The process stays by itself: it has a domain of its own, Cyclone DDS has no network, and the
// others stay on the loopback device. A reset keeps the contexts and makes new names.
#pragma once

#include <memory>
#include <optional>

#include "executor.hpp"
#include "held_graph.hpp"
#include "held_system.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "nested.hpp"
#include "nodes.hpp"
#include "service.hpp"
#include "topic.hpp"

namespace maide::ros2 {

class Ros2Wrapper : public SystemWrapper {
 public:
  Ros2Wrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  void refuse_options_of_other_kinds(const OptionValues& options) const;

  WrapperDescription description_;
  std::optional<TopicSettings> topic_;  // the settings of the kind that is learned
  std::optional<ServiceSettings> service_;
  std::optional<ExecutorKindSettings> executor_;
  std::optional<NestedSettings> nested_;
  std::optional<HeldGraph> graph_;
  std::optional<Nodes> nodes_;
};

}  // namespace maide::ros2
