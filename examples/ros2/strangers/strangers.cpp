// Ten strangers' answers. A planner asks, and is busy before it looks for the answer. Meanwhile a
// monitor calls the same service. Each answer goes to all clients, and each client keeps the last
// ten (rclcpp's default), so ten calls of the monitor push the planner's answer out.
//
//   strangers [CALLS [DEPTH]]     of the monitor, 10; what the planner's client keeps, 10
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <thread>

using std::chrono_literals::operator""s;
using Lookup = std_srvs::srv::Trigger;

int main(int argc, char** argv) {
  const int calls = argc > 1 ? std::atoi(argv[1]) : 10;
  const int depth = argc > 2 ? std::atoi(argv[2]) : 10;
  rclcpp::init(1, argv);
  const auto map = std::make_shared<rclcpp::Node>("map");
  const auto planner = std::make_shared<rclcpp::Node>("planner");
  const auto monitor = std::make_shared<rclcpp::Node>("monitor");

  const auto server = map->create_service<Lookup>(
      "lookup", [](Lookup::Request::SharedPtr, Lookup::Response::SharedPtr answer) {
        answer->success = true;
      });
  rclcpp::executors::SingleThreadedExecutor map_executor;
  map_executor.add_node(map);
  std::thread map_thread([&] { map_executor.spin(); });

  rmw_qos_profile_t qos = rmw_qos_profile_services_default;
  qos.depth = static_cast<std::size_t>(depth);
  const auto planners_client = planner->create_client<Lookup>("lookup", qos);
  const auto monitors_client = monitor->create_client<Lookup>("lookup");
  planners_client->wait_for_service();
  monitors_client->wait_for_service();

  const auto plan = planners_client->async_send_request(std::make_shared<Lookup::Request>());
  int answered = 0;
  for (int call = 0; call < calls; ++call) {
    const auto look = monitors_client->async_send_request(std::make_shared<Lookup::Request>());
    answered += rclcpp::spin_until_future_complete(monitor, look.future, 3s) ==
                rclcpp::FutureReturnCode::SUCCESS;
  }
  const bool is_answered = rclcpp::spin_until_future_complete(planner, plan.future, 3s) ==
                           rclcpp::FutureReturnCode::SUCCESS;
  std::cout << "monitor: " << answered << " of " << calls << " calls answered\n"
            << "planner: " << (is_answered ? "answered" : "no answer within 3 s") << "\n";

  map_executor.cancel();
  map_thread.join();
  rclcpp::shutdown();
  return is_answered ? 0 : 1;
}
