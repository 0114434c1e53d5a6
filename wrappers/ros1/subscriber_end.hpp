// The subscriber's end of a topic whose publisher is in the same process. NodeHandle::subscribe
// would always take roscpp's shortcut there: the publisher hands the message straight to the
// subscriber's queue, past its own. So the end over TCPROS is made from the parts that roscpp
// itself makes one from when the publisher is elsewhere, and told where the publisher listens; from
// there on all is as between two nodes: the connection over TCP, the header, the queues.
//
// Left out is the way to that address: registering with the master and asking the publisher's node
// (requestTopic), which costs 200 ms, because roscpp looks at such requests every 100 ms.
#pragma once

#include <ros/node_handle.h>
#include <ros/subscribe_options.h>

#include <memory>

#include "queues.hpp"

namespace maide::ros1 {

class SubscriberEnd {
 public:
  virtual ~SubscriberEnd() = default;  // unsubscribes; what is queued is lost
  // Publishers that it is connected to.
  virtual std::uint32_t count_publishers() = 0;
};

// Subscribes; returns before the connection is made.
std::unique_ptr<SubscriberEnd> subscribe(ros::NodeHandle& node, ros::SubscribeOptions options,
                                         Transport transport);

}  // namespace maide::ros1
