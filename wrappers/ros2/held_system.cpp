#include "held_system.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "qos.hpp"

namespace maide::ros2 {
namespace {

using Kind = HeldGraph::Callback::Kind;
constexpr std::size_t most_tries = 2000;  // to make a group whose address is a greater one

bool contains(const std::vector<std::size_t>& list, std::size_t number) {
  return std::find(list.begin(), list.end(), number) != list.end();
}

}  // namespace

HeldSystem::HeldSystem(Nodes& nodes, const HeldGraph& graph, EventSink& sink)
    : nodes_(nodes),
      graph_(graph),
      sink_(sink),
      name_(nodes.next_word()),
      written_(graph.topics.size()),
      callbacks_(graph.callbacks.size()) {
  for (std::size_t node = 0; node < graph.nodes.size(); ++node) {
    ends_->nodes.push_back(nodes.make_node(fmt::format("{}_{}", name_, node)));
  }
  make_groups();
  ends_->services.resize(graph.services.size());
  for (std::size_t number = 0; number < graph.callbacks.size(); ++number) make_callback(number);
  make_ends_of_topics();
  make_ends_of_services();
  make_executors();
  make_calls_of_callbacks();
  make_calls_of_programs();
  wait_for_matches();
  for (const auto& executor : ends_->executors) executor->spin();
}

HeldSystem::~HeldSystem() {
  for (const auto& executor : ends_->executors) executor->stop();
  nodes_.retire(ends_);
}

// Executors look through groups in the order of their addresses. Those that come too early are kept
// until the next ones are made.
void HeldSystem::make_groups() {
  std::vector<rclcpp::CallbackGroup::SharedPtr> too_early;
  for (const HeldGraph::Group& group : graph_.groups) {
    const auto type = group.is_reentrant ? rclcpp::CallbackGroupType::Reentrant
                                         : rclcpp::CallbackGroupType::MutuallyExclusive;
    for (;;) {
      auto made = ends_->nodes[group.node]->create_callback_group(type, false);
      if (ends_->groups.empty() || ends_->groups.back().owner_before(made)) {
        ends_->groups.push_back(std::move(made));
        break;
      }
      if (too_early.size() == most_tries) {
        throw std::runtime_error("callback groups do not come in the order of the file");
      }
      too_early.push_back(std::move(made));
    }
  }
}

void HeldSystem::make_executors() {
  for (std::size_t number = 0; number < graph_.executors.size(); ++number) {
    rclcpp::ExecutorOptions options;
    options.context = ends_->nodes.front()->get_node_base_interface()->get_context();
    const auto on_pick = [this, number](const void* picked) {
      const auto callback = callback_of_.find(picked);
      sink_.report(callback == callback_of_.end()
                       ? fmt::format("e{}.nothing", number)
                       : fmt::format("e{}.c{}", number, callback->second));
    };
    ends_->executors.push_back(std::make_unique<HeldExecutor>(
        options, graph_.executors[number].threads, on_pick,
        [this, rounds = graph_.executors[number].goes_by_rounds](const void* client) {
          return !rounds && takes_for_nobody(client);
        }));
    for (std::size_t group = 0; group < graph_.groups.size(); ++group) {
      if (graph_.groups[group].executor != number) continue;
      ends_->executors.back()->add_callback_group(
          ends_->groups[group], ends_->nodes[graph_.groups[group].node]->get_node_base_interface());
    }
  }
}

// ---- ends ---------------------------------------------------------------------------------------

void HeldSystem::make_callback(std::size_t number) {
  const HeldGraph::Callback& callback = graph_.callbacks[number];
  const std::size_t node = graph_.node_of(callback);
  for (std::size_t run = 0; run < graph_.runs_of(callback); ++run) {
    callbacks_[number].runs.push_back(
        {fmt::format("c{}.{}.", number, run), {}, false, false, {}, {}});
  }
  switch (callback.kind) {
    case Kind::timer: make_timer(number); break;
    case Kind::subscription: make_subscription(number); break;
    case Kind::service: make_server(number); break;
    case Kind::client:
      make_client(node, callback.end, ends_->groups[callback.group]);
      callbacks_[number].picked = ends_->clients.at({node, callback.end}).get();
      callback_of_client_[{node, callback.end}] = number;
      break;
  }
  callback_of_[callbacks_[number].picked] = number;
}

void HeldSystem::make_timer(std::size_t number) {
  const HeldGraph::Callback& callback = graph_.callbacks[number];
  const auto timer = std::make_shared<ManualTimer>(
      ends_->nodes[graph_.node_of(callback)], [this, number] { run(number, "began"); },
      ends_->groups[callback.group]);
  calls_[fmt::format("c{}.due", number)] = [timer] { timer->make_due(); };
  ends_->timers.push_back(timer);
  callbacks_[number].picked = timer->timer();
}

void HeldSystem::make_subscription(std::size_t number) {
  const HeldGraph::Callback& callback = graph_.callbacks[number];
  rclcpp::SubscriptionOptions options;
  options.callback_group = ends_->groups[callback.group];
  const auto on_message = [this, number, topic = callback.end](const Message& message) {
    const char* label = nullptr;
    {
      const std::scoped_lock lock(mutex_);
      label = label_of(topic, message.data, callbacks_[number].newest);
    }
    run(number, label);
  };
  const auto subscription = ends_->nodes[graph_.node_of(callback)]->create_subscription<Message>(
      fmt::format("{}_topic_{}", name_, callback.end), graph_.topics[callback.end].subscription,
      on_message, options);
  ends_->subscriptions.emplace_back(callback.end, subscription);
  callbacks_[number].picked = subscription.get();
}

void HeldSystem::make_server(std::size_t number) {
  const HeldGraph::Callback& callback = graph_.callbacks[number];
  const auto on_request = [this, number](const std::shared_ptr<rmw_request_id_t>& id,
                                         const std::shared_ptr<Type::Request>& request) {
    run(number, "began", Served{*id, std::stoul(request->names.at(0))});
  };
  ends_->services[callback.end] = ends_->nodes[graph_.node_of(callback)]->create_service<Type>(
      fmt::format("{}_service_{}", name_, callback.end), on_request,
      service_qos(graph_.services[callback.end].depth), ends_->groups[callback.group]);
  callbacks_[number].picked = ends_->services[callback.end].get();
}

void HeldSystem::make_client(std::size_t node, std::size_t service,
                             const rclcpp::CallbackGroup::SharedPtr& group) {
  ends_->clients[{node, service}] =
      ends_->nodes[node]->create_client<Type>(fmt::format("{}_service_{}", name_, service),
                                              service_qos(graph_.services[service].depth), group);
}

void HeldSystem::make_ends_of_topics() {
  for (std::size_t number = 0; number < graph_.topics.size(); ++number) {
    const HeldGraph::Topic& topic = graph_.topics[number];
    const std::string name = fmt::format("{}_topic_{}", name_, number);
    for (const std::size_t node : topic.writers) {
      ends_->publishers[{node, number}] =
          ends_->nodes[node]->create_publisher<Message>(name, topic.publisher);
    }
    for (const std::size_t node : topic.readers) {
      auto& reader = ends_->readers[{node, number}];
      reader = std::make_unique<Receiver>(ends_->nodes[node]);
      rclcpp::SubscriptionOptions options;
      options.callback_group = reader->spinner.group();
      const auto on_message = [this, number, own = reader.get()](const Message& message) {
        own->has_received = true;
        own->label = label_of(number, message.data, own->newest);
      };
      ends_->subscriptions.emplace_back(number, ends_->nodes[node]->create_subscription<Message>(
                                                    name, topic.subscription, on_message, options));
    }
  }
}

void HeldSystem::make_ends_of_services() {
  for (std::size_t number = 0; number < graph_.services.size(); ++number) {
    const HeldGraph::Service& service = graph_.services[number];
    for (const std::size_t node : service.clients) {
      if (!graph_.is_program(node)) continue;
      auto& asker = ends_->askers[{node, number}];
      asker = std::make_unique<Receiver>(ends_->nodes[node]);
      make_client(node, number, asker->spinner.group());
    }
    if (ends_->services[number]) continue;
    auto& server = ends_->servers[number];
    server = std::make_unique<Receiver>(ends_->nodes[service.server]);
    ends_->services[number] = ends_->nodes[service.server]->create_service<Type>(
        fmt::format("{}_service_{}", name_, number),
        [own = server.get()](const std::shared_ptr<rmw_request_id_t>& id,
                             const std::shared_ptr<Type::Request>& request) {
          own->has_received = true;
          own->served = Served{*id, std::stoul(request->names.at(0))};
        },
        service_qos(service.depth), server->spinner.group());
  }
}

bool HeldSystem::is_matched() const {
  const auto is_met = [&](std::size_t number) {
    const HeldGraph::Topic& topic = graph_.topics[number];
    return rclcpp::qos_check_compatible(topic.publisher, topic.subscription).compatibility !=
           rclcpp::QoSCompatibility::Error;
  };
  const auto readers = [&](std::size_t topic) {
    return static_cast<std::size_t>(
        std::count_if(ends_->subscriptions.begin(), ends_->subscriptions.end(),
                      [&](const auto& subscription) { return subscription.first == topic; }));
  };
  return std::all_of(ends_->publishers.begin(), ends_->publishers.end(),
                     [&](const auto& publisher) {
                       const std::size_t topic = publisher.first.second;
                       return publisher.second->get_subscription_count() ==
                              (is_met(topic) ? readers(topic) : 0);
                     }) &&
         std::all_of(ends_->subscriptions.begin(), ends_->subscriptions.end(),
                     [&](const auto& subscription) {
                       const std::size_t topic = subscription.first;
                       return subscription.second->get_publisher_count() ==
                              (is_met(topic) ? graph_.topics[topic].writers.size() : 0);
                     }) &&
         std::all_of(ends_->clients.begin(), ends_->clients.end(),
                     [](const auto& client) { return client.second->service_is_ready(); });
}

void HeldSystem::wait_for_matches() const {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (!is_matched()) {
    if (std::chrono::steady_clock::now() > limit) {
      throw std::runtime_error("the ends do not meet within 2 s");
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
}

// ---- inputs -------------------------------------------------------------------------------------

void HeldSystem::add_call(std::size_t callback, std::size_t run, const std::string& name,
                          Call call) {
  calls_[callbacks_[callback].runs[run].prefix + name] = [this, callback, run,
                                                          call = std::move(call)] {
    const std::scoped_lock lock(mutex_);
    callbacks_[callback].runs[run].next = call;
    changed_.notify_all();
  };
}

void HeldSystem::make_calls_of_callbacks() {
  calls_["free"] = [this] {
    for (const auto& executor : ends_->executors) executor->set_free();
  };
  for (std::size_t executor = 0; executor < graph_.executors.size(); ++executor) {
    calls_[fmt::format("e{}.pick", executor)] = [this, executor] {
      ends_->executors[executor]->pick();
    };
  }
  for (std::size_t number = 0; number < graph_.callbacks.size(); ++number) {
    const HeldGraph::Callback& callback = graph_.callbacks[number];
    const std::size_t node = graph_.node_of(callback);
    HeldExecutor* const executor = ends_->executors[graph_.groups[callback.group].executor].get();
    if (graph_.discards(callback)) {
      calls_[fmt::format("c{}.discard", number)] = [this, number, executor] {
        takes_for_nobody(callbacks_[number].picked);
        executor->start(callbacks_[number].picked);
      };
    }
    for (std::size_t place = 0; place < callbacks_[number].runs.size(); ++place) {
      Run& run = callbacks_[number].runs[place];
      calls_[run.prefix + "start"] = [this, number, place, executor] {
        {
          const std::scoped_lock lock(mutex_);
          callbacks_[number].next_run = place;
        }
        executor->start(callbacks_[number].picked);
      };
      add_call(number, place, "end", [&run] { run.is_over = true; });
      for (std::size_t topic = 0; topic < graph_.topics.size(); ++topic) {
        if (!contains(graph_.topics[topic].writers, node)) continue;
        add_call(number, place, fmt::format("t{}.write", topic),
                 [this, end = End{node, topic}] { publish(end); });
      }
      for (std::size_t service = 0; service < graph_.services.size(); ++service) {
        const std::string prefix = fmt::format("s{}.", service);
        if (graph_.services[service].server == node) {
          add_call(number, place, prefix + "answer",
                   [this, service, &run] { answer(service, served_for(service, run)); });
        }
        if (!contains(graph_.services[service].clients, node)) continue;
        add_call(number, place, prefix + "send", [this, node, service, &run] {
          send(node, service, run.answers[service] = std::make_shared<bool>(false));
        });
        add_call(number, place, prefix + "wait", [this, service, &run] { wait_for(run, service); });
      }
    }
  }
}

void HeldSystem::make_calls_of_programs() {
  for (const auto& [end, publisher] : ends_->publishers) {
    calls_[fmt::format("n{}.t{}.write", end.first, end.second)] = [this, of = end] { publish(of); };
  }
  for (const auto& [end, reader] : ends_->readers) {
    const std::string prefix = fmt::format("n{}.t{}.", end.first, end.second);
    calls_[prefix + "read"] = [this, prefix, own = reader.get()] { receive(*own, prefix); };
  }
  for (const auto& [end, asker] : ends_->askers) {
    const std::string prefix = fmt::format("n{}.s{}.", end.first, end.second);
    calls_[prefix + "send"] = [this, of = end] { send(of.first, of.second, nullptr); };
    calls_[prefix + "receive"] = [this, prefix, own = asker.get()] {
      receive(*own, prefix + "answer");
    };
  }
  for (const auto& [service, server] : ends_->servers) {
    const std::string prefix = fmt::format("n{}.s{}.", graph_.services[service].server, service);
    calls_[prefix + "serve"] = [this, prefix, own = server.get()] {
      receive(*own, prefix + "request");
    };
    calls_[prefix + "answer"] = [this, of = service, own = server.get()] {
      answer(of, own->served);
    };
  }
}

void HeldSystem::call(std::string_view input) {
  const auto call = calls_.find(input);
  if (call == calls_.end()) throw std::logic_error("no input '" + std::string(input) + "'");
  call->second();
}

// ---- what they do -------------------------------------------------------------------------------

const char* HeldSystem::label_of(std::size_t topic, std::uint64_t message,
                                 std::uint64_t& newest) const {
  if (!graph_.topics[topic].tells_gaps) return "message";
  const std::uint64_t last = std::exchange(newest, std::max(newest, message));
  return message == last + 1 ? "next" : message > last ? "gap" : "old";
}

void HeldSystem::publish(const End& end) {
  auto message = std::make_unique<Message>();
  {
    const std::scoped_lock lock(mutex_);
    message->data = ++written_[end.second];
  }
  ends_->publishers.at(end)->publish(std::move(message));
}

// `answer` is null for a program, which receives by itself.
void HeldSystem::send(std::size_t node, std::size_t service, const std::shared_ptr<bool>& answer) {
  const rclcpp::Client<Type>::CallbackType on_answer =
      [this, node, service, answer](const rclcpp::Client<Type>::SharedFuture&) {
        if (!answer) {
          ends_->askers.at({node, service})->has_received = true;
          return;
        }
        {
          const std::scoped_lock lock(mutex_);
          *answer = true;
          changed_.notify_all();
          auto& left = answers_[ends_->clients.at({node, service}).get()];
          const auto own = std::find(left.begin(), left.end(), true);
          left.erase(left.begin(), own == left.end() ? own : own + 1);
        }
        run(callback_of_client_.at({node, service}), "began");
      };
  auto request = std::make_shared<Type::Request>();
  request->names = {std::to_string(node)};
  ends_->clients.at({node, service})->async_send_request(request, on_answer);
}

void HeldSystem::wait_for(Run& run, std::size_t service) {
  std::unique_lock lock(mutex_);
  const std::shared_ptr<bool> answer = run.answers[service];
  changed_.wait(lock, [&] { return is_stopped_ || (answer && *answer); });
  if (!is_stopped_) sink_.report(run.prefix + "answered");
}

// Any callback of the server's node answers what was served last; where several runs serve at once,
// each answers its own.
std::optional<HeldSystem::Served>& HeldSystem::served_for(std::size_t service, Run& run) {
  for (std::size_t number = 0; number < graph_.callbacks.size(); ++number) {
    const HeldGraph::Callback& callback = graph_.callbacks[number];
    if (callback.kind != Kind::service || callback.end != service) continue;
    auto& runs = callbacks_[number].runs;
    return runs.size() == 1 ? runs.front().served : run.served;
  }
  return run.served;
}

// All clients get it, and each keeps the newest ones.
void HeldSystem::answer(std::size_t service, std::optional<Served>& served) {
  std::optional<Served> request;
  {
    const std::scoped_lock lock(mutex_);
    request = std::exchange(served, std::nullopt);
    if (!request) return;
    for (const std::size_t node : graph_.services[service].clients) {
      if (graph_.is_program(node)) continue;
      auto& left = answers_[ends_->clients.at({node, service}).get()];
      left.push_back(node == request->client);
      if (left.size() > graph_.services[service].depth) left.pop_front();
    }
  }
  Type::Response response;
  ends_->services[service]->send_response(request->id, response);
}

// Taking an answer takes all that are older than the first own one, too (Cyclone DDS), or takes the
// oldest, whosever it is (Fast DDS).
bool HeldSystem::takes_for_nobody(const void* client) {
  const std::scoped_lock lock(mutex_);
  auto& left = answers_[client];
  if (left.empty()) return false;
  if (takes_one_by_one_) {
    if (left.front()) return false;
    left.pop_front();
    return true;
  }
  if (std::find(left.begin(), left.end(), true) != left.end()) return false;
  left.clear();
  return true;
}

void HeldSystem::receive(Receiver& receiver, const std::string& event) {
  receiver.has_received = false;
  receiver.spinner.run_until([&] { return receiver.has_received; });
  if (receiver.has_received) sink_.report(event + receiver.label);
}

// In a thread of an executor: a callback. Where the executors are free, any of its runs starts.
void HeldSystem::run(std::size_t callback, const std::string& event,
                     const std::optional<Served>& served) {
  std::unique_lock lock(mutex_);
  if (is_stopped_) return;
  Callback& own = callbacks_[callback];
  auto place = own.runs.begin() + static_cast<std::ptrdiff_t>(own.next_run);
  while (place != own.runs.end() && place->is_running) ++place;
  if (place == own.runs.end()) place = own.runs.begin();
  Run& run = *place;
  run.is_running = true;
  run.is_over = false;
  run.answers.clear();
  run.served = served;
  sink_.report(run.prefix + event);
  while (!run.is_over) {
    changed_.wait(lock, [&] { return is_stopped_ || run.next != nullptr; });
    if (is_stopped_) return;
    const Call call = std::exchange(run.next, nullptr);
    lock.unlock();
    call();
    lock.lock();
  }
  run.is_running = false;
}

void HeldSystem::shutdown() {
  {
    const std::scoped_lock lock(mutex_);
    is_stopped_ = true;
    changed_.notify_all();
  }
  for (const auto& ends : {&ends_->readers, &ends_->askers}) {
    for (const auto& [end, receiver] : *ends) receiver->spinner.stop();
  }
  for (const auto& [service, server] : ends_->servers) server->spinner.stop();
  for (const auto& executor : ends_->executors) executor->stop();
}

}  // namespace maide::ros2
