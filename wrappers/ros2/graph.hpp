// `maide-wrap-ros2 --graph`: the running graph of ROS 2, as one JSON object on standard output, for
// `maide ros2 import` and `maide doctor ros2`. Nothing is isolated: the graph is that of the
// environment's ROS_DOMAIN_ID, over its RMW_IMPLEMENTATION.
//
//   {"rmw": "rmw_cyclonedds_cpp", "domain": 0, "settled": true,
//    "nodes": [{"name": "/camera", "process": "0110..."}],
//    "topics": [{"name": "/image", "publishers": [END], "subscriptions": [END]}],
//    "services": [{"name": "/find", "type": "...", "servers": ["/map"], "clients": ["/detector"]}]}
//
// END is {"node", "type", "reliability", "durability", "history", "depth", "deadline", "lifespan",
// "liveliness", "lease"}. Times are in seconds. `deadline`, `lifespan` and `lease` are absent where
// they are infinite, `depth` where the middleware does not tell it. Nodes of one `process` share a
// context.
// Actions are the services and topics of their protocol, under names with "/_action/".
#pragma once

namespace maide::ros2 {

// `arguments` are those of main. Returns the exit status; what is wrong is one line on standard
// error.
int print_graph(int argc, char** argv);

}  // namespace maide::ros2
