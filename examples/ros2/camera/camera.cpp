// Four nodes on one executor. A camera publishes at 30 Hz. A detector takes 100 ms for an image and
// calls a service in its callback. A map serves it. A planner waits for twelve detections.
//
//   camera                    SingleThreadedExecutor, depth 10: the detector's first call hangs
//   camera own [DEPTH [MS]]   two threads; the detector's client in a callback group of its own; an
//                             image takes MS milliseconds.
//
// It runs until Ctrl-C, so that `maide ros2 import` can read its graph.
#include <atomic>
#include <chrono>
#include <future>
#include <iostream>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <thread>

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using Number = std_msgs::msg::UInt64;
using Lookup = std_srvs::srv::Trigger;

constexpr int images = 12;

int main(int argc, char** argv) {
  const bool has_own_group = argc > 1 && std::string(argv[1]) == "own";
  const std::size_t depth = argc > 2 ? std::stoul(argv[2]) : 10;
  const std::chrono::milliseconds work(argc > 3 ? std::stoul(argv[3]) : 100);
  rclcpp::init(1, argv);

  const auto map = std::make_shared<rclcpp::Node>("map");
  const auto server = map->create_service<Lookup>(
      "lookup", [](Lookup::Request::SharedPtr, Lookup::Response::SharedPtr answer) {
        answer->success = true;
      });

  const auto planner = std::make_shared<rclcpp::Node>("planner");
  std::atomic<int> found = 0;
  const auto of_found = planner->create_subscription<Number>(
      "found", depth, [&](Number::ConstSharedPtr) { ++found; });

  const auto detector = std::make_shared<rclcpp::Node>("detector");
  rclcpp::CallbackGroup::SharedPtr group;  // none: the node's own
  if (has_own_group) {
    group = detector->create_callback_group(rclcpp::CallbackGroupType::MutuallyExclusive);
  }
  const auto client =
      detector->create_client<Lookup>("lookup", rmw_qos_profile_services_default, group);
  const auto detections = detector->create_publisher<Number>("found", 10);
  std::atomic<bool> is_waiting = false;
  const auto of_image =
      detector->create_subscription<Number>("image", depth, [&](Number::ConstSharedPtr image) {
        std::this_thread::sleep_for(work);
        const auto answer = client->async_send_request(std::make_shared<Lookup::Request>());
        is_waiting = true;
        while (rclcpp::ok() && answer.future.wait_for(100ms) != std::future_status::ready) {
        }
        is_waiting = false;
        detections->publish(*image);
      });

  const auto camera = std::make_shared<rclcpp::Node>("camera");
  const auto publisher = camera->create_publisher<Number>("image", 10);
  std::atomic<int> sent = 0;
  const auto tick = camera->create_wall_timer(33ms, [&] {
    if (sent == images) return;
    Number image;
    image.data = static_cast<std::uint64_t>(++sent);
    publisher->publish(image);
  });

  std::unique_ptr<rclcpp::Executor> executor;
  if (has_own_group) {
    executor =
        std::make_unique<rclcpp::executors::MultiThreadedExecutor>(rclcpp::ExecutorOptions(), 2);
  } else {
    executor = std::make_unique<rclcpp::executors::SingleThreadedExecutor>();
  }
  for (const auto& node : {camera, detector, map, planner}) executor->add_node(node);
  std::thread spinning([&] { executor->spin(); });
  for (int seconds = 3; rclcpp::ok(); seconds += 3) {
    std::this_thread::sleep_for(3s);
    std::cout << "after " << seconds << " s: " << sent << " images, " << found << " of " << images
              << " detections" << (is_waiting ? "; the detector waits for an answer" : "")
              << std::endl;
  }
  spinning.join();
  return found == images ? 0 : 1;
}
