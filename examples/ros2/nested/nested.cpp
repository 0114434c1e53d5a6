// A call inside of a callback. For each image the detector asks a database and waits for the
// answer. The answer comes by the same executor: if no thread or no callback group is free for it,
// the callback waits for ever.
//
//   nested single       SingleThreadedExecutor
//   nested multi        two threads; subscription and client in the node's own group
//   nested reentrant    two threads; "fixed with Reentrant": both in one reentrant group
//   nested own          two threads; the client in a callback group of its own
//
// Two images come at once.
#include <chrono>
#include <future>
#include <iostream>
#include <memory>
#include <mutex>
#include <rclcpp/rclcpp.hpp>
#include <std_msgs/msg/empty.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>
#include <thread>

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;
using Image = std_msgs::msg::Empty;
using Lookup = std_srvs::srv::Trigger;
using rclcpp::CallbackGroupType;

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "single";
  rclcpp::init(1, argv);
  const auto database = std::make_shared<rclcpp::Node>("database");
  const auto server = database->create_service<Lookup>(
      "lookup", [](Lookup::Request::SharedPtr, Lookup::Response::SharedPtr answer) {
        answer->success = true;
      });
  rclcpp::executors::SingleThreadedExecutor database_executor;
  database_executor.add_node(database);
  std::thread database_thread([&] { database_executor.spin(); });

  const auto detector = std::make_shared<rclcpp::Node>("detector");
  rclcpp::CallbackGroup::SharedPtr of_image, of_client;  // none: the node's own
  if (mode == "reentrant") {
    of_image = of_client = detector->create_callback_group(CallbackGroupType::Reentrant);
  } else if (mode == "own") {
    of_client = detector->create_callback_group(CallbackGroupType::MutuallyExclusive);
  }
  const auto client =
      detector->create_client<Lookup>("lookup", rmw_qos_profile_services_default, of_client);
  client->wait_for_service();

  std::mutex mutex;  // for these two
  int ended = 0, answered = 0;
  rclcpp::SubscriptionOptions options;
  options.callback_group = of_image;
  const auto subscription = detector->create_subscription<Image>(
      "image", 10,
      [&](Image::ConstSharedPtr) {
        const auto answer = client->async_send_request(std::make_shared<Lookup::Request>());
        // A real detector says wait(): this limit is for the sake of the demonstration.
        const bool is_answered = answer.future.wait_for(5s) == std::future_status::ready;
        const std::lock_guard lock(mutex);
        ++ended;
        answered += is_answered;
        std::cout << (is_answered ? "answered" : "no answer within 5 s") << std::endl;
      },
      options);
  const auto camera = std::make_shared<rclcpp::Node>("camera");
  const auto publisher = camera->create_publisher<Image>("image", 10);
  while (publisher->get_subscription_count() == 0) std::this_thread::sleep_for(1ms);
  publisher->publish(Image());
  publisher->publish(Image());

  std::unique_ptr<rclcpp::Executor> executor;
  if (mode == "single") {
    executor = std::make_unique<rclcpp::executors::SingleThreadedExecutor>();
  } else {
    executor =
        std::make_unique<rclcpp::executors::MultiThreadedExecutor>(rclcpp::ExecutorOptions(), 2);
  }
  executor->add_node(detector);
  std::thread thread([&] { executor->spin(); });
  for (bool is_over = false; !is_over;) {
    std::this_thread::sleep_for(10ms);
    const std::lock_guard lock(mutex);
    is_over = ended == 2;
  }
  executor->cancel();
  thread.join();
  database_executor.cancel();
  database_thread.join();
  rclcpp::shutdown();
  return answered == 2 ? 0 : 1;
}
