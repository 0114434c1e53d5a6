// maide-wrap-ros2: speaks the protocol of docs/protocol.md, or, with `--graph`, prints the running
// graph.
#include <algorithm>
#include <span>
#include <string_view>

#include "graph.hpp"
#include "ros2_wrapper.hpp"

int main(int argc, char** argv) {
  const std::span words(argv, static_cast<std::size_t>(argc));
  if (std::find(words.begin(), words.end(), std::string_view("--graph")) != words.end()) {
    return maide::ros2::print_graph(argc, argv);
  }
  maide::ros2::Ros2Wrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
