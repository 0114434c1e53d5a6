// kind=service: one server, one or two clients. Both ends take through an executor, as programs do.
//
//   send         sends a request and does not wait
//   receive      the client spins until an answer came: `answer`
//   tryreceive   the client spins once, without waiting: `answer` or `null`
//   ready        is the server there? `present` or `absent`
//   serve        the server spins until a request came: `request`
//   tryserve     the server spins once, without waiting: `request` or `none`
//   answer       answers the request served last
//   handle       takes a request, if there is one, and answers it at once: `handled` or `none`
//   stop, start  drops the server, makes it anew; a server that is down says `down`
//
// Inputs of the second client end in 2. With payload=gap an answer or a request says whether one of
// the same client was lost before it: `answer_gap`, `request_gap`, `handled_gap`.
//
// ask, wait, call and burst are larger steps, in which the server answers whatever it gets: the
// first client asks, unless an answer is still open, and later waits (`answer` or `pending`); the
// second client makes one whole call (`called` or `failed`), or many.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <rcl_interfaces/srv/get_parameters.hpp>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "maide/wire/wrapper/system_wrapper.hpp"
#include "nodes.hpp"
#include "spinner.hpp"

namespace maide::ros2 {

struct ServiceSettings {
  std::size_t depth = 10, clients = 1;
  std::size_t burst = 10;   // calls of one `burst`
  bool starts_up = true;    // the server is there at the reset
  bool tells_gaps = false;  // payload=gap

  static std::vector<OptionSpec> options();
  // Throws UsageError for inputs that do not go together.
  static ServiceSettings from(const OptionValues& options);
};

SystemSetup service_setup(const ServiceSettings& settings);

// All names that any setting knows.
std::vector<std::string> service_inputs();
std::vector<std::string> service_events();

class Service : public SystemInstance {
 public:
  // Returns when the clients know the server. Throws std::runtime_error.
  Service(Nodes& nodes, const ServiceSettings& settings, EventSink& sink);
  ~Service() override;
  void call(std::string_view input) override;
  void shutdown() override;

 private:
  // Any type does whose request has room for two numbers: who asks, and for which time.
  using Type = rcl_interfaces::srv::GetParameters;
  struct Client {
    explicit Client(const rclcpp::Node::SharedPtr& node) : spinner(node) {}
    Spinner spinner;
    rclcpp::Client<Type>::SharedPtr client;
    std::string suffix;  // "" or "2"
    std::size_t number = 0;
    std::uint64_t newest_served = 0;     // the place of the request that was served last
    std::uint64_t sent = 0, newest = 0;  // requests; the newest answer's place among them
    bool is_open = false;                // of ask
    bool has_received = false;           // since the call began
    bool lost_one = false;               // before the answer that came last
  };

  // All that takes long to delete.
  struct Ends {
    explicit Ends(const rclcpp::Node::SharedPtr& serving) : spinner(serving) {}
    std::vector<std::unique_ptr<Client>> clients;
    Spinner spinner;                          // the server's
    rclcpp::Service<Type>::SharedPtr server;  // none: down
  };

  void call_as_client(Client& client, std::string_view input);
  void call_as_server(std::string_view input);
  void send(Client& client);
  void receive(Client& client, bool waits);
  void wait_for_answer(Client& client);
  bool make_call(Client& client);
  void make_calls(Client& client, std::size_t count, const char* done);
  void serve(bool waits);
  void on_request(const rmw_request_id_t& id, const Type::Request& request);
  void send_answer();
  bool handle_one();
  void handle_all();
  void start();
  void stop();
  void wait_until_known(bool is_up) const;
  std::string with_gap(const char* event, bool lost_one) const;

  Nodes& nodes_;
  const ServiceSettings settings_;
  EventSink& sink_;
  const rclcpp::Node::SharedPtr asking_, serving_;
  const std::string name_;
  const std::shared_ptr<Ends> ends_;
  std::optional<rmw_request_id_t> served_;  // not answered yet
  bool has_taken_ = false;                  // a request, since the call began
  bool lost_request_ = false;               // before the one that was served last
  std::atomic<bool> stopped_ = false;
};

}  // namespace maide::ros2
