// The changes of nodes and depths that are cures in C++: a callback group for a client or a
// callback of its own, an executor with more threads, a longer queue. Each is a system file's text
// with the change in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace maide {

struct NodeChange {
  std::string node;         // whose cure it is
  std::string text;         // of the whole file
  std::string description;  // "detector: the client of lookup in a callback group of its own, ..."
};

// Of each node the smallest changes first. None of a file without nodes, or that is not YAML.
std::vector<NodeChange> list_node_changes(const std::string& text);

// A depth or size of a service, a topic or a built-in queue that is written as a number.
struct DepthPlace {
  std::string section, name, option;  // "services", "lookup", "depth"
  std::int64_t value = 0;
};
std::vector<DepthPlace> find_depths(const std::string& text);
std::string with_depth(const std::string& text, const DepthPlace& place, std::int64_t value);

}  // namespace maide
