// Where all words of a run live: one context of rclcpp or two, with a node in each. A reset makes
// new names in them; a context of its own for each word would take some 20 ms.
#pragma once

#include <cstddef>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <vector>

namespace maide::ros2 {

// Picks the implementation of rmw ("cyclonedds") and shuts the process off from everybody else's
// topics, whatever the environment says. Once, before anything else of ROS. Throws UsageError if
// the implementation is not there.
void prepare_process(const std::string& rmw);

class Nodes {
 public:
  // `contexts`: 1 or 2. Throws std::runtime_error.
  explicit Nodes(std::size_t contexts);
  ~Nodes();
  Nodes(const Nodes&) = delete;
  Nodes& operator=(const Nodes&) = delete;

  // A name that no word had before. A node keeps a little of each group that it ever had, so the
  // nodes are new ones from time to time; those of earlier words live as long as they are used.
  std::string next_word();

  // Takes what a word made and does not need any more, to be deleted when that is cheap: deleting
  // an end waits some milliseconds for the middleware, but many can wait at the same time.
  void retire(std::shared_ptr<void> ends);

  // A node beside these, with nothing in it. Its name is one that no other node has.
  rclcpp::Node::SharedPtr make_node(const std::string& name, std::size_t context = 0) const;

  // Of what writes, asks, or sends; of what reads, serves, or is run by an executor.
  const rclcpp::Node::SharedPtr& sending() const { return nodes_.front(); }
  const rclcpp::Node::SharedPtr& receiving() const { return nodes_.back(); }

 private:
  void make_nodes();
  void delete_retired();

  const std::string name_;  // that no other process has
  std::vector<rclcpp::Context::SharedPtr> contexts_;
  std::vector<rclcpp::Node::SharedPtr> nodes_;  // by context
  std::size_t words_ = 0;
  std::vector<std::shared_ptr<void>> retired_;
};

}  // namespace maide::ros2
