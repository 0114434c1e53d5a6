#include "ros2_model.hpp"

#include <algorithm>
#include <compare>
#include <deque>
#include <map>
#include <stdexcept>
#include <utility>

#include "made_machine.hpp"

namespace maide::test {
namespace {

// Which client's request, and the how manyth: of the numbers only the order matters and who is
// whose neighbour.
struct Item {
  std::size_t client = 0, number = 0;
  auto operator<=>(const Item&) const = default;
};

struct Client {
  std::size_t sent = 0, served = 0, received = 0;  // the newest of each, 0: none
  std::deque<Item> answers;                        // not received, oldest first
  bool is_open = false;                            // of ask
  auto operator<=>(const Client&) const = default;
};

struct Content {
  std::deque<Item> requests;  // not served, oldest first
  std::vector<Client> clients;
  bool is_up = true;
  auto operator<=>(const Content&) const = default;
};

// The same future with small numbers: a distance above 1 is 2.
void normalize(Content& content, std::size_t client) {
  Client& own = content.clients[client];
  std::vector<std::size_t*> numbers{&own.sent, &own.served, &own.received};
  for (Item& item : content.requests) {
    if (item.client == client) numbers.push_back(&item.number);
  }
  for (Client& each : content.clients) {
    for (Item& item : each.answers) {
      if (item.client == client) numbers.push_back(&item.number);
    }
  }
  std::map<std::size_t, std::size_t> small;
  for (const std::size_t* number : numbers) small[*number] = 0;
  std::size_t last = small.begin()->first, next = 0;
  for (auto& [number, to] : small) {
    next += std::min<std::size_t>(number - last, 2);
    last = number;
    to = next;
  }
  for (std::size_t* number : numbers) *number = small[*number];
}

class ServiceMachine {
 public:
  explicit ServiceMachine(const Ros2Service& service) : service_(service) {}

  std::string step(Content& content, const std::string& input) const {
    const bool is_second = input.ends_with('2') || input == "call";
    Client& client = content.clients.at(is_second ? 1 : 0);
    const std::string name = input.ends_with('2') ? input.substr(0, input.size() - 1) : input;
    if (name == "send") return send(content, is_second ? 1 : 0);
    if (name == "tryreceive") return try_receive(client, is_second ? "2" : "");
    if (name == "tryserve") return serve(content, "request", false);
    if (name == "handle") return serve(content, "handled", true);
    if (name == "ask") return ask(content);
    if (name == "wait") return wait(client);
    if (name == "call") return call(content);
    if (name == "start") return content.is_up = true, "quiet";
    if (name != "stop") throw std::invalid_argument(input);
    content.is_up = false;
    content.requests.clear();
    return "quiet";
  }

 private:
  void keep(std::deque<Item>& queue, const Item& item) const {
    queue.push_back(item);
    if (queue.size() > service_.depth) queue.pop_front();
  }

  std::string send(Content& content, std::size_t client) const {
    const std::size_t number = ++content.clients[client].sent;
    if (content.is_up) keep(content.requests, {client, number});
    return "quiet";
  }

  std::string serve(Content& content, const std::string& event, bool answers) const {
    if (!content.is_up) return "down";
    if (content.requests.empty()) return "none";
    const Item item = content.requests.front();
    content.requests.pop_front();
    Client& asked = content.clients[item.client];
    const bool is_next = item.number == asked.served + 1;
    asked.served = item.number;
    if (answers) {
      for (Client& client : content.clients) keep(client.answers, item);
    }
    return with_gap(event, is_next);
  }

  std::string try_receive(Client& client, const std::string& suffix) const {
    const std::size_t own = suffix.empty() ? 0 : 1;
    while (!client.answers.empty()) {
      const Item item = client.answers.front();
      client.answers.pop_front();
      if (item.client != own) continue;
      const bool is_next = item.number == client.received + 1;
      client.received = item.number;
      return with_gap("answer" + suffix, is_next);
    }
    return "null" + suffix;
  }

  std::string ask(Content& content) const {
    if (content.clients[0].is_open) return "quiet";
    content.clients[0].is_open = true;
    send(content, 0);
    serve(content, "", true);
    return "quiet";
  }

  std::string wait(Client& client) const {
    if (try_receive(client, "") == "null") return "pending";
    client.is_open = false;
    return "answer";
  }

  std::string call(Content& content) const {
    send(content, 1);
    if (!content.is_up) return "failed";
    serve(content, "", true);
    try_receive(content.clients[1], "2");
    return "called";
  }

  std::string with_gap(const std::string& event, bool is_next) const {
    return service_.tells_gaps && !is_next ? event + "_gap" : event;
  }

  const Ros2Service service_;
};

}  // namespace

Mealy make_ros2_service(const Ros2Service& service, const std::vector<std::string>& inputs) {
  const ServiceMachine machine(service);
  const Content first{{}, std::vector<Client>(service.clients), true};
  return make_machine(inputs, first, [&](Content content, const std::string& input) {
    const std::string output = machine.step(content, input);
    for (std::size_t client = 0; client < service.clients; ++client) normalize(content, client);
    return std::pair(output, content);
  });
}

}  // namespace maide::test
