// A late joiner that acts twice. The operator publishes one order under transient_local, so that a
// robot that comes later gets it, too. The robot carries it out, is started again, and gets the
// same order once more.
//
//   late-joiner             the robot acts on each order that it gets
//   late-joiner numbered    an order has a number, and the robot keeps the last one that it did
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/u_int64.hpp>
#include <string>

using std::chrono_literals::operator""ms;
using Order = std_msgs::msg::UInt64;

int main(int argc, char** argv) {
  const bool looks_at_number = argc > 1 && std::string(argv[1]) == "numbered";
  rclcpp::init(1, argv);
  const auto qos = rclcpp::QoS(1).reliable().transient_local();
  const auto operators = std::make_shared<rclcpp::Node>("operator");
  const auto publisher = operators->create_publisher<Order>("order", qos);
  Order order;
  order.data = 1;
  publisher->publish(order);

  int acted = 0;
  std::uint64_t last = 0;  // in a file that outlives the robot's process
  for (int start = 1; start <= 2; ++start) {
    const auto robot = std::make_shared<rclcpp::Node>("robot");
    const auto subscription =
        robot->create_subscription<Order>("order", qos, [&](Order::ConstSharedPtr got) {
          if (looks_at_number && got->data <= last) return;
          last = got->data;
          ++acted;
          std::cout << "start " << start << ": the robot carries out order " << got->data << "\n";
        });
    rclcpp::executors::SingleThreadedExecutor executor;
    executor.add_node(robot);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
    while (std::chrono::steady_clock::now() < end) executor.spin_once(10ms);
  }
  std::cout << "one order, carried out " << acted << (acted == 1 ? " time\n" : " times\n");
  rclcpp::shutdown();
  return acted == 1 ? 0 : 1;
}
