#include "ros2_model.hpp"

#include <algorithm>
#include <compare>
#include <deque>
#include <map>
#include <optional>
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
  bool is_receiving = false;                       // waits
  auto operator<=>(const Client&) const = default;
};

struct Content {
  std::deque<Item> requests;  // not served, oldest first
  std::vector<Client> clients;
  bool is_up = true;
  bool is_serving = false;     // waits
  std::optional<Item> served;  // not answered
  auto operator<=>(const Content&) const = default;
};

// The same future with small numbers: a distance above 1 is 2, and where nothing tells gaps none
// matters.
void normalize(Content& content, std::size_t client, bool tells_gaps) {
  Client& own = content.clients[client];
  std::vector<std::size_t*> numbers{&own.sent, &own.served, &own.received};
  for (Item& item : content.requests) {
    if (item.client == client) numbers.push_back(&item.number);
  }
  if (content.served && content.served->client == client) {
    numbers.push_back(&content.served->number);
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
    to = tells_gaps ? next : 0;
  }
  for (std::size_t* number : numbers) *number = small[*number];
}

class ServiceMachine {
 public:
  explicit ServiceMachine(const Ros2Service& service) : service_(service) {}

  std::string step(Content& content, const std::string& input) const {
    const bool is_second = input.ends_with('2') || input == "call";
    const std::size_t client = is_second ? 1 : 0;
    const std::string name = input.ends_with('2') ? input.substr(0, input.size() - 1) : input;
    const bool is_waiting =
        is_of_server(name) ? content.is_serving : content.clients.at(client).is_receiving;
    if (is_waiting) return "refused";
    if (name == "receive" || name == "serve") {
      (name == "serve" ? content.is_serving : content.clients[client].is_receiving) = true;
      return end_waiting(content, "quiet");
    }
    return end_waiting(content, step_without_waiting(content, name, client));
  }

 private:
  static bool is_of_server(const std::string& name) {
    return name == "serve" || name == "tryserve" || name == "answer" || name == "handle" ||
           name == "stop" || name == "start";
  }

  std::string step_without_waiting(Content& content, const std::string& name,
                                   std::size_t number) const {
    if (name == "send") return send(content, number);
    if (name == "tryreceive") return try_receive(content.clients[number], number);
    if (name == "tryserve") return serve(content, "request");
    if (name == "handle") return handle(content);
    if (name == "answer") return answer(content) ? "quiet" : "unexplored";
    if (name == "ask") return ask(content);
    if (name == "wait") return wait(content.clients[number]);
    if (name == "call") return call(content);
    if (name == "start") return content.is_up = true, "quiet";
    if (name != "stop") throw std::invalid_argument(name);
    content.is_up = false;
    content.requests.clear();
    content.served.reset();
    return "quiet";
  }

  // What waits ends if it can: a serve by what a client sent, which says nothing itself; a receive
  // by what the server did, and clients come first in an answer.
  std::string end_waiting(Content& content, const std::string& output) const {
    if (content.is_serving && (!content.is_up || !content.requests.empty())) {
      content.is_serving = false;
      return serve(content, "request");
    }
    for (std::size_t number = 0; number < content.clients.size(); ++number) {
      Client& client = content.clients[number];
      if (!client.is_receiving) continue;
      const std::string answer = try_receive(client, number);
      if (answer.starts_with("null")) continue;
      client.is_receiving = false;
      return output == "quiet" ? answer : answer + "," + output;
    }
    return output;
  }

  void keep(std::deque<Item>& queue, const Item& item) const {
    queue.push_back(item);
    if (queue.size() > service_.depth) queue.pop_front();
  }

  std::string send(Content& content, std::size_t client) const {
    const std::size_t number = ++content.clients[client].sent;
    if (content.is_up) keep(content.requests, {client, number});
    return "quiet";
  }

  std::string serve(Content& content, const std::string& event) const {
    if (!content.is_up) return "down";
    if (content.requests.empty()) return "none";
    const Item item = content.requests.front();
    content.requests.pop_front();
    Client& asked = content.clients[item.client];
    const bool is_next = item.number == asked.served + 1;
    asked.served = item.number;
    content.served = item;
    return with_gap(event, is_next);
  }

  bool answer(Content& content) const {
    if (!content.served) return false;
    for (Client& client : content.clients) keep(client.answers, *content.served);
    content.served.reset();
    return true;
  }

  std::string handle(Content& content) const {
    const std::string event = serve(content, "handled");
    if (event.starts_with("handled")) answer(content);
    return event;
  }

  std::string try_receive(Client& client, std::size_t own) const {
    const std::string suffix = own == 0 ? "" : "2";
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
    handle(content);
    return "quiet";
  }

  std::string wait(Client& client) const {
    if (try_receive(client, 0) == "null") return "pending";
    client.is_open = false;
    return "answer";
  }

  std::string call(Content& content) const {
    send(content, 1);
    if (!content.is_up) return "failed";
    handle(content);
    try_receive(content.clients[1], 1);
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
  Content first;
  first.clients.resize(service.clients);
  return make_machine(inputs, first, [&](Content content, const std::string& input) {
    const std::string output = machine.step(content, input);
    for (std::size_t client = 0; client < service.clients; ++client) {
      normalize(content, client, service.tells_gaps);
    }
    return std::pair(output, content);
  });
}

Mealy make_ros2_topic(std::size_t depth) {
  struct Queue {
    std::size_t messages = 0;
    bool is_reading = false;  // waits
    auto operator<=>(const Queue&) const = default;
  };
  const std::vector<std::string> inputs{"write", "read"};
  return make_machine(inputs, Queue{}, [&](Queue queue, const std::string& input) {
    const bool writes = input == "write";
    if (!writes && queue.is_reading) return std::pair<std::string, Queue>("refused", queue);
    if (writes) queue.messages = std::min(queue.messages + 1, depth);
    if (!writes) queue.is_reading = true;
    const bool reads = queue.is_reading && queue.messages > 0;
    if (reads) queue = {queue.messages - 1, false};
    return std::pair<std::string, Queue>(reads ? "message" : "quiet", queue);
  });
}

}  // namespace maide::test
