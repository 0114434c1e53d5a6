// A running graph of ROS 2, as the wrapper's program sees it from another process: ends with their
// QoS, services with their servers and clients.
#include "maide/ros2/ros2_graph.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <string>

namespace maide {
namespace {

using Message = std_msgs::msg::UInt64;
using Request = rcl_interfaces::srv::GetParameters;
using testing::ElementsAre;

// On the loopback device, in a domain that no other test uses.
class Ros2RunningGraph : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
    ::setenv("ROS_DOMAIN_ID", std::to_string(101 + ::getpid() % 100).c_str(), 1);
    ::setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp", 1);
    rclcpp::init(0, nullptr);
  }
  static void TearDownTestSuite() { rclcpp::shutdown(); }
};

TEST_F(Ros2RunningGraph, HasTheQosOfEachEnd) {
  const auto camera = std::make_shared<rclcpp::Node>("camera", "front");
  const auto detector = std::make_shared<rclcpp::Node>("detector");
  const auto publisher = camera->create_publisher<Message>("/image", rclcpp::SensorDataQoS());
  const auto subscription = detector->create_subscription<Message>(
      "/image", rclcpp::QoS(7).deadline(std::chrono::milliseconds(1500)),
      [](Message::ConstSharedPtr) {});
  const auto server = camera->create_service<Request>(
      "/lookup", [](Request::Request::SharedPtr, Request::Response::SharedPtr) {});
  const auto client = detector->create_client<Request>("/lookup");

  const Ros2Graph graph = observe_ros2_graph(0.5, {});
  EXPECT_TRUE(graph.is_settled);
  EXPECT_EQ(graph.rmw, "rmw_cyclonedds_cpp");
  ASSERT_EQ(graph.nodes.size(), 2U);
  EXPECT_EQ(graph.nodes[1].name, "/front/camera");
  EXPECT_EQ(graph.nodes[0].process, graph.nodes[1].process);
  EXPECT_FALSE(graph.nodes[0].process.empty());
  ASSERT_EQ(graph.topics.size(), 1U);
  const Ros2Topic& topic = graph.topics[0];
  ASSERT_EQ(topic.publishers.size(), 1U);
  ASSERT_EQ(topic.subscriptions.size(), 1U);
  EXPECT_EQ(topic.publishers[0].node, "/front/camera");
  EXPECT_EQ(topic.publishers[0].type, "std_msgs/msg/UInt64");
  EXPECT_EQ(topic.publishers[0].qos.reliability, "best_effort");
  EXPECT_EQ(topic.publishers[0].qos.depth, 5U);
  EXPECT_EQ(topic.subscriptions[0].qos.reliability, "reliable");
  EXPECT_EQ(topic.subscriptions[0].qos.depth, 7U);
  EXPECT_EQ(topic.subscriptions[0].qos.deadline, 1.5);
  EXPECT_NE(find_mismatch(topic.publishers[0], topic.subscriptions[0]), "");
  ASSERT_EQ(graph.services.size(), 1U);
  EXPECT_EQ(graph.services[0].name, "/lookup");
  EXPECT_THAT(graph.services[0].servers, ElementsAre("/front/camera"));
  EXPECT_THAT(graph.services[0].clients, ElementsAre("/detector"));
}

TEST_F(Ros2RunningGraph, MayBeEmpty) {
  ::setenv("ROS_DOMAIN_ID", "99", 1);
  const Ros2Graph graph = observe_ros2_graph(0.2, {});
  EXPECT_TRUE(graph.nodes.empty());
  EXPECT_TRUE(graph.topics.empty());
}

}  // namespace
}  // namespace maide
