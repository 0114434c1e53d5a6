// The wrapper for ROS 1: `maide learn ros1 queue_size=10`. Publishers and subscribers of one
// topic, in one process, over TCPROS or through roscpp's shortcut. The actor `writer` calls
// Publisher::publish; `reader` calls CallbackQueue::callOne on a queue of its own, waiting (read)
// or not (tryread); `network` unsubscribes and subscribes again; `control` disables, enables
// and clears the callback queue.
//
// A reset keeps process, node and master; topic, publishers and subscribers are fresh for each
// word.
#pragma once

#include <memory>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "node.hpp"
#include "queues.hpp"
#include "ros1_connection.hpp"

namespace maide::ros1 {

class Ros1Wrapper : public SystemWrapper {
 public:
  Ros1Wrapper();
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues& options) override;
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override;

 private:
  WrapperDescription description_;
  Queues queues_;
  Node* node_ = nullptr;
  IdleQueues idle_;
};

}  // namespace maide::ros1
