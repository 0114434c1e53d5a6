// A burst of 12 messages, of which the subscription keeps the last DEPTH. A planner that waits for
// all twelve waits for ever. "Reliable" does not help: the messages were delivered, and thrown away
// by the reader's own queue. The publisher's depth does not matter.
//
//   burst [DEPTH [PUBLISHERS_DEPTH]]      10, 10
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <thread>

using std::chrono_literals::operator""ms;
using Image = std_msgs::msg::UInt64;

int main(int argc, char** argv) {
  const auto depth = static_cast<std::size_t>(argc > 1 ? std::atoi(argv[1]) : 10);
  const auto publishers = static_cast<std::size_t>(argc > 2 ? std::atoi(argv[2]) : 10);
  rclcpp::init(1, argv);
  const auto camera = std::make_shared<rclcpp::Node>("camera");
  const auto planner = std::make_shared<rclcpp::Node>("planner");
  int received = 0;
  std::uint64_t last = 0;
  const auto subscription = planner->create_subscription<Image>(
      "image", rclcpp::QoS(depth).reliable(), [&](Image::ConstSharedPtr image) {
        for (++last; last < image->data; ++last) std::cout << "image " << last << " is lost\n";
        ++received;
      });
  const auto publisher =
      camera->create_publisher<Image>("image", rclcpp::QoS(publishers).reliable());
  while (publisher->get_subscription_count() == 0) std::this_thread::sleep_for(1ms);

  for (std::uint64_t n = 1; n <= 12; ++n) {
    Image image;
    image.data = n;
    publisher->publish(image);
  }
  std::this_thread::sleep_for(100ms);  // the planner is busy

  rclcpp::executors::SingleThreadedExecutor executor;
  executor.add_node(planner);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  while (received < 12 && std::chrono::steady_clock::now() < end) executor.spin_once(10ms);
  std::cout << "planner: " << received << " of 12 images"
            << (received < 12 ? "; it waits for the others for ever\n" : "\n");
  rclcpp::shutdown();
  return received == 12 ? 0 : 1;
}
