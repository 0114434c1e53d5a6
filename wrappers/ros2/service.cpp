#include "service.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "qos.hpp"

namespace maide::ros2 {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds longest_way{2};

const std::vector<std::string>& larger_steps() {
  static const std::vector<std::string> names = {"ask", "wait", "call", "burst"};
  return names;
}

const std::vector<std::string>& small_steps() {
  static const std::vector<std::string> names = {"send",     "receive",    "tryreceive", "serve",
                                                 "tryserve", "answer",     "handle",     "send2",
                                                 "receive2", "tryreceive2"};
  return names;
}

bool names_one_of(const std::vector<std::string>& inputs, const std::vector<std::string>& names) {
  return std::any_of(inputs.begin(), inputs.end(), [&](const std::string& input) {
    return std::find(names.begin(), names.end(), input) != names.end();
  });
}

// `answer` is possible once a request was served, until it is answered or the server is gone.
LearningPurpose answers_what_was_served() {
  const std::vector<std::string> inputs = {"answer", "stop"};
  const std::vector<std::string> outputs = {"request", "request_gap", "handled", "handled_gap"};
  InterfaceAutomaton purpose{Alphabet(std::span<const std::string>(inputs)),
                             Alphabet(std::span<const std::string>(outputs)), 2};
  constexpr Action answer{Action::Kind::input, 0}, stop{Action::Kind::input, 1};
  purpose.add_transition(1, answer, 0);
  for (StateId state = 0; state < 2; ++state) {
    purpose.add_transition(state, stop, 0);
    for (Symbol output = 0; output < outputs.size(); ++output) {
      purpose.add_transition(state, {Action::Kind::output, output}, output < 2 ? 1 : 0);
    }
  }
  return LearningPurpose(std::move(purpose));
}

void add_client(SystemSetup& setup, const std::string& suffix, bool tells_gaps) {
  const std::string actor = "client" + suffix;
  std::vector<std::string> answers = {"answer" + suffix};
  if (tells_gaps) answers.push_back("answer" + suffix + "_gap");
  setup.actors.push_back(actor);
  setup.inputs.push_back({"send" + suffix, actor, {}});
  setup.inputs.push_back({"receive" + suffix, actor, answers});
  setup.inputs.push_back({"tryreceive" + suffix, actor, {}});
  setup.inputs.push_back({"ready" + suffix, actor, {}});
  for (const std::string& answer : answers) setup.events.push_back({answer, actor});
  for (const char* event : {"null", "present", "absent"}) {
    setup.events.push_back({event + suffix, actor});
  }
}

void add_server(SystemSetup& setup, bool tells_gaps) {
  std::vector<std::string> requests = {"request"};
  if (tells_gaps) requests.emplace_back("request_gap");
  std::vector<std::string> served = requests;
  served.emplace_back("down");
  setup.actors.emplace_back("server");
  setup.inputs.push_back({"serve", "server", served});
  for (const char* input : {"tryserve", "answer", "handle", "stop", "start"}) {
    setup.inputs.push_back({input, "server", {}});
  }
  for (const std::string& request : requests) setup.events.push_back({request, "server"});
  setup.events.push_back({"handled", "server"});
  if (tells_gaps) setup.events.push_back({"handled_gap", "server"});
  for (const char* event : {"none", "down"}) setup.events.push_back({event, "server"});
}

void add_larger_steps(SystemSetup& setup, std::size_t clients) {
  setup.inputs.push_back({"ask", "client", {}});
  setup.inputs.push_back({"wait", "client", {}});
  setup.events.push_back({"pending", "client"});
  if (clients < 2) return;
  setup.inputs.push_back({"call", "client2", {}});
  setup.inputs.push_back({"burst", "client2", {}});
  for (const char* event : {"called", "failed"}) setup.events.push_back({event, "client2"});
}

}  // namespace

std::vector<OptionSpec> ServiceSettings::options() {
  return {OptionSpec::integer("clients", 1, 1, 2, "kind=service: clients of the service"),
          OptionSpec::choice("server", "up", {"up", "down"},
                             "kind=service: whether the server is there before the first input"),
          OptionSpec::integer("burst", 10, 1, 100, "kind=service: calls that one burst makes")};
}

ServiceSettings ServiceSettings::from(const OptionValues& options) {
  ServiceSettings settings;
  settings.depth = static_cast<std::size_t>(options.number("depth"));
  settings.clients = static_cast<std::size_t>(options.number("clients"));
  settings.burst = static_cast<std::size_t>(options.number("burst"));
  settings.starts_up = options.is("server", "up");
  settings.tells_gaps = options.is("payload", "gap");
  const std::vector<std::string> inputs = options.list("inputs");
  if (names_one_of(inputs, larger_steps()) && names_one_of(inputs, small_steps())) {
    throw UsageError(
        "option inputs: ask, wait, call and burst have the server answer by itself, so they go "
        "with none of send, receive, serve, answer, handle");
  }
  if (!options.list_behind("payload", "values").empty()) {
    throw UsageError("option payload: requests carry no values; say none or gap");
  }
  return settings;
}

SystemSetup service_setup(const ServiceSettings& settings) {
  SystemSetup setup;
  add_client(setup, "", settings.tells_gaps);
  if (settings.clients > 1) add_client(setup, "2", settings.tells_gaps);
  add_server(setup, settings.tells_gaps);
  add_larger_steps(setup, settings.clients);
  setup.usual_inputs = {"send", "serve", "answer", "receive"};
  if (settings.clients > 1) {
    for (const char* input : {"send2", "receive2"}) setup.usual_inputs.emplace_back(input);
  }
  for (const SystemSetup::Event& event : setup.events) setup.usual_events.push_back(event.name);
  setup.purposes = {answers_what_was_served()};
  return setup;
}

std::vector<std::string> service_inputs() {
  ServiceSettings most;
  most.clients = 2;
  std::vector<std::string> names;
  for (const SystemSetup::Input& input : service_setup(most).inputs) names.push_back(input.name);
  return names;
}

std::vector<std::string> service_events() {
  ServiceSettings most;
  most.clients = 2;
  most.tells_gaps = true;
  return service_setup(most).usual_events;
}

Service::Service(Nodes& nodes, const ServiceSettings& settings, EventSink& sink)
    : nodes_(nodes),
      settings_(settings),
      sink_(sink),
      asking_(nodes.sending()),
      serving_(nodes.receiving()),
      name_(nodes.next_word()),
      ends_(std::make_shared<Ends>(serving_)) {
  for (std::size_t client = 0; client < settings.clients; ++client) {
    ends_->clients.push_back(std::make_unique<Client>(asking_));
    ends_->clients.back()->client = asking_->create_client<Type>(
        name_, service_qos(settings.depth), ends_->clients.back()->spinner.group());
    ends_->clients.back()->number = client;
    if (client > 0) ends_->clients.back()->suffix = std::to_string(client + 1);
  }
  if (settings.starts_up) start();
}

Service::~Service() { nodes_.retire(ends_); }

void Service::start() {
  if (ends_->server) return;
  ends_->server = serving_->create_service<Type>(
      name_,
      [this](const std::shared_ptr<rmw_request_id_t>& id,
             const std::shared_ptr<Type::Request>& request) { on_request(*id, *request); },
      service_qos(settings_.depth), ends_->spinner.group());
  wait_until_known(true);
}

void Service::stop() {
  ends_->server.reset();
  served_.reset();
  wait_until_known(false);
}

// A request that is sent before is lost.
void Service::wait_until_known(bool is_up) const {
  const auto limit = Clock::now() + longest_way;
  while (Clock::now() < limit) {
    if (std::all_of(ends_->clients.begin(), ends_->clients.end(), [&](const auto& client) {
          return client->client->service_is_ready() == is_up;
        })) {
      return;
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  throw std::runtime_error("clients and server do not meet, or part, within 2 s");
}

void Service::on_request(const rmw_request_id_t& id, const Type::Request& request) {
  Client& client = *ends_->clients.at(std::stoul(request.names.at(0)));
  const std::uint64_t place = std::stoull(request.names.at(1));
  lost_request_ = place != client.newest_served + 1;
  client.newest_served = std::max(client.newest_served, place);
  served_ = id;
  has_taken_ = true;
}

std::string Service::with_gap(const char* event, bool lost_one) const {
  return settings_.tells_gaps && lost_one ? std::string(event) + "_gap" : event;
}

void Service::call(std::string_view input) {
  if (stopped_) return;
  const bool is_of_second = input.ends_with('2') || input == "call" || input == "burst";
  const std::string_view name = input.ends_with('2') ? input.substr(0, input.size() - 1) : input;
  for (const char* of_client :
       {"send", "receive", "tryreceive", "ready", "ask", "wait", "call", "burst"}) {
    if (name == of_client) return call_as_client(*ends_->clients[is_of_second ? 1 : 0], name);
  }
  call_as_server(name);
}

void Service::call_as_client(Client& client, std::string_view input) {
  if (input == "send") {
    send(client);
  } else if (input == "receive" || input == "tryreceive") {
    receive(client, input == "receive");
  } else if (input == "ready") {
    sink_.report((client.client->service_is_ready() ? "present" : "absent") + client.suffix);
  } else if (input == "ask") {
    if (!std::exchange(client.is_open, true)) send(client), handle_all();
  } else if (input == "wait") {
    wait_for_answer(client);
  } else {
    make_calls(client, input == "burst" ? settings_.burst : 1, "called");
  }
}

void Service::call_as_server(std::string_view input) {
  if (input == "start") return start();
  if (input == "stop") return stop();
  if (input == "answer") {
    send_answer();
  } else if (!ends_->server) {
    sink_.report("down");
  } else if (input == "serve" || input == "tryserve") {
    serve(input == "serve");
  } else if (input == "handle") {
    sink_.report(handle_one() ? with_gap("handled", lost_request_) : "none");
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

void Service::send(Client& client) {
  const std::uint64_t place = ++client.sent;
  const rclcpp::Client<Type>::CallbackType on_answer =
      [&client, place](const rclcpp::Client<Type>::SharedFuture&) {
        client.has_received = true;
        client.lost_one = place != client.newest + 1;
        client.newest = std::max(client.newest, place);
      };
  auto request = std::make_shared<Type::Request>();
  request->names = {std::to_string(client.number), std::to_string(place)};
  client.client->async_send_request(request, on_answer);
}

void Service::receive(Client& client, bool waits) {
  client.has_received = false;
  if (waits) {
    client.spinner.run_until([&] { return client.has_received; });
  } else {
    client.spinner.run_ready(Spin::once);
  }
  if (client.has_received) {
    sink_.report(with_gap(("answer" + client.suffix).c_str(), client.lost_one));
  } else if (!waits) {
    sink_.report("null" + client.suffix);
  }
}

void Service::wait_for_answer(Client& client) {
  client.has_received = false;
  client.spinner.run_ready(Spin::all);
  if (client.has_received) client.is_open = false;
  sink_.report(client.has_received ? "answer" : "pending");
}

// The whole of it: the request is sent, served and answered, and the answer is received.
bool Service::make_call(Client& client) {
  client.has_received = false;
  send(client);
  if (!ends_->server) return false;
  const auto limit = Clock::now() + longest_way;
  while (!client.has_received && !stopped_ && Clock::now() < limit) {
    handle_all();
    client.spinner.run_ready(Spin::all);
  }
  return client.has_received;
}

void Service::make_calls(Client& client, std::size_t count, const char* done) {
  bool all_called = true;
  for (std::size_t i = 0; i < count; ++i) all_called = make_call(client) && all_called;
  sink_.report(all_called ? done : "failed");
}

void Service::serve(bool waits) {
  has_taken_ = false;
  if (waits) {
    ends_->spinner.run_until([&] { return has_taken_; });
  } else {
    ends_->spinner.run_ready(Spin::once);
  }
  if (has_taken_) {
    sink_.report(with_gap("request", lost_request_));
  } else if (!waits) {
    sink_.report("none");
  }
}

void Service::send_answer() {
  if (!served_ || !ends_->server) return;
  Type::Response response;
  ends_->server->send_response(*served_, response);
  served_.reset();
}

// False if there was no request.
bool Service::handle_one() {
  has_taken_ = false;
  if (ends_->server) ends_->spinner.run_ready(Spin::once);
  if (has_taken_) send_answer();
  return has_taken_;
}

void Service::handle_all() {
  while (!stopped_ && handle_one()) {
  }
}

void Service::shutdown() {
  stopped_ = true;
  for (const auto& client : ends_->clients) client->spinner.stop();
  ends_->spinner.stop();
}

}  // namespace maide::ros2
