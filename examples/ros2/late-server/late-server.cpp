// A service that is called before it is discovered. The server runs in a process of its own. Ten
// clients, one process after the other, ask as soon as they are made. A request that is sent before
// client and server have found each other is lost, or its answer is (rmw_fastrtps#842), and nobody
// says so.
//
//   late-server          clients ask at once
//   late-server wait     wait_for_service(): they ask when they see the server
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <iostream>
#include <memory>
#include <rclcpp/rclcpp.hpp>
#include <std_srvs/srv/trigger.hpp>
#include <string>

using std::chrono_literals::operator""s;
using Lookup = std_srvs::srv::Trigger;

constexpr int calls = 10;

int serve() {
  const auto map = std::make_shared<rclcpp::Node>("map");
  const auto server = map->create_service<Lookup>(
      "lookup", [](Lookup::Request::SharedPtr, Lookup::Response::SharedPtr answer) {
        answer->success = true;
      });
  rclcpp::spin(map);
  return 0;
}

int ask(bool waits) {
  const auto planner = std::make_shared<rclcpp::Node>("planner");
  const auto client = planner->create_client<Lookup>("lookup");
  if (waits) client->wait_for_service();
  const auto answer = client->async_send_request(std::make_shared<Lookup::Request>());
  return rclcpp::spin_until_future_complete(planner, answer.future, 3s) ==
                 rclcpp::FutureReturnCode::SUCCESS
             ? 0
             : 1;
}

// This program again, in another process.
pid_t start(char** argv, std::string role) {
  const pid_t process = ::fork();
  if (process != 0) return process;
  char* words[] = {argv[0], role.data(), nullptr};
  ::execv("/proc/self/exe", words);
  ::_exit(2);
}

int main(int argc, char** argv) {
  const std::string role = argc > 1 ? argv[1] : "";
  if (role.rfind("as-", 0) == 0) {
    rclcpp::init(1, argv);
    const int status = role == "as-server" ? serve() : ask(role == "as-patient-client");
    rclcpp::shutdown();
    return status;
  }
  const pid_t server = start(argv, "as-server");
  int answered = 0;
  for (int call = 0; call < calls; ++call) {
    int status = 1;
    ::waitpid(start(argv, role == "wait" ? "as-patient-client" : "as-client"), &status, 0);
    answered += status == 0;
  }
  ::kill(server, SIGTERM);
  ::waitpid(server, nullptr, 0);
  std::cout << "planner: " << answered << " of " << calls << " requests answered"
            << (answered < calls ? "; it waits for the others for ever\n" : "\n");
  return answered == calls ? 0 : 1;
}
