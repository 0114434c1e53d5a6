#include "executor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "qos.hpp"

namespace maide::ros2 {
namespace {

constexpr std::size_t most_of_each = 4;

// The callbacks that settings ask for: in the order in which one round of an executor runs them.
struct Callbacks {
  const char *input, *event;
  std::size_t count;
};

std::vector<Callbacks> callbacks_of(const ExecutorKindSettings& settings) {
  return {{"due", "timer", settings.timers},
          {"arrive", "sub", settings.subscriptions},
          {"request", "service", settings.services},
          {"ask", "client", settings.clients}};
}

ExecutorKindSettings with_most() {
  ExecutorKindSettings most;
  most.subscriptions = most.timers = most.services = most.clients = most_of_each;
  most.spin.reset();
  return most;
}

std::optional<Spin> spin_from(const OptionValues& options) {
  if (options.is("spin", "forever")) return std::nullopt;
  if (options.is("spin", "some")) return Spin::some;
  return options.is("spin", "all") ? Spin::all : Spin::once;
}

// The number behind such a name, from 0.
std::size_t number_of(std::string_view name, std::string_view prefix) {
  return static_cast<std::size_t>(std::stoul(std::string(name.substr(prefix.size())))) - 1;
}

}  // namespace

std::vector<OptionSpec> ExecutorKindSettings::options() {
  const auto count = [](const char* key, std::int64_t usual, const char* help) {
    return OptionSpec::integer(key, usual, 0, most_of_each, help);
  };
  return {count("subscriptions", 2, "kind=executor: subscriptions of its node"),
          count("timers", 0, "kind=executor: timers of its node, made due by an input"),
          count("services", 0, "kind=executor: services of its node"),
          count("executor-clients", 0, "kind=executor: clients of its node, all of one service"),
          OptionSpec::choice("spin", "once", {"once", "some", "all", "forever"},
                             "kind=executor: spin_once, spin_some or spin_all, or a thread that "
                             "spins, whose callbacks end by an input"),
          OptionSpec::choice("groups", "one", {"one", "own", "reentrant"},
                             "kind=executor: one exclusive callback group, one for each callback, "
                             "or a reentrant one")};
}

ExecutorKindSettings ExecutorKindSettings::from(const OptionValues& options) {
  ExecutorKindSettings settings;
  settings.executor = ExecutorSettings::from(options);
  settings.subscriptions = static_cast<std::size_t>(options.number("subscriptions"));
  settings.timers = static_cast<std::size_t>(options.number("timers"));
  settings.services = static_cast<std::size_t>(options.number("services"));
  settings.clients = static_cast<std::size_t>(options.number("executor-clients"));
  settings.depth = static_cast<std::size_t>(options.number("depth"));
  settings.spin = spin_from(options);
  if (options.is("groups", "own")) settings.groups = Groups::own;
  if (options.is("groups", "reentrant")) settings.groups = Groups::reentrant;
  settings.intraprocess = options.is("intraprocess", "on");
  if (settings.subscriptions + settings.timers + settings.services + settings.clients == 0) {
    throw UsageError("option subscriptions: an executor without callbacks runs nothing");
  }
  return settings;
}

SystemSetup executor_setup(const ExecutorKindSettings& settings) {
  SystemSetup setup;
  setup.actors = {"world", "executor"};
  for (const Callbacks& callbacks : callbacks_of(settings)) {
    for (std::size_t number = 1; number <= callbacks.count; ++number) {
      setup.inputs.push_back({fmt::format("{}{}", callbacks.input, number), "world", {}});
      setup.events.push_back({fmt::format("{}{}", callbacks.event, number), "executor"});
    }
  }
  if (settings.spin) {
    setup.inputs.push_back({"spin", "executor", {}});
    setup.events.push_back({"nothing", "executor"});
  } else {
    const std::vector<SystemSetup::Event> began = setup.events;
    for (const SystemSetup::Event& event : began) {
      setup.inputs.push_back({"end_" + event.name, "world", {}});
    }
  }
  for (const SystemSetup::Input& input : setup.inputs) setup.usual_inputs.push_back(input.name);
  for (const SystemSetup::Event& event : setup.events) setup.usual_events.push_back(event.name);
  return setup;
}

std::vector<std::string> executor_inputs() {
  std::vector<std::string> names = executor_setup(with_most()).usual_inputs;
  names.emplace_back("spin");
  return names;
}

std::vector<std::string> executor_events() {
  std::vector<std::string> names = executor_setup(with_most()).usual_events;
  names.emplace_back("nothing");
  return names;
}

ExecutorKind::ExecutorKind(Nodes& nodes, const ExecutorKindSettings& settings, EventSink& sink)
    : nodes_(nodes), settings_(settings), sink_(sink) {
  const std::string name = nodes.next_word();
  ends_->sending = nodes.sending();
  ends_->receiving = nodes.receiving();
  const std::size_t count =
      settings.timers + settings.subscriptions + settings.services + settings.clients;
  const bool has_own = settings.groups == ExecutorKindSettings::Groups::own;
  ends_->groups = make_groups(ends_->receiving, has_own ? count : 1,
                              settings.groups == ExecutorKindSettings::Groups::reentrant
                                  ? rclcpp::CallbackGroupType::Reentrant
                                  : rclcpp::CallbackGroupType::MutuallyExclusive);
  for (std::size_t i = 0; i < settings.timers; ++i) make_timer();
  for (std::size_t i = 0; i < settings.subscriptions; ++i) {
    make_subscription(fmt::format("{}_topic_{}", name, i));
  }
  for (std::size_t i = 0; i < settings.services; ++i) {
    make_service(fmt::format("{}_service_{}", name, i));
  }
  if (settings.clients > 0) make_clients(fmt::format("{}_service", name));
  ends_->executor = make_executor(settings.executor, ends_->receiving);
  for (const rclcpp::CallbackGroup::SharedPtr& group : ends_->groups) {
    ends_->executor->add_callback_group(group, ends_->receiving->get_node_base_interface());
  }
  wait_for_matches();
  if (!settings.spin) ends_->thread = std::make_unique<SpinningThread>(*ends_->executor);
}

ExecutorKind::~ExecutorKind() {
  ends_->thread.reset();
  nodes_.retire(ends_);
}

rclcpp::CallbackGroup::SharedPtr ExecutorKind::next_group() {
  return ends_->groups[groups_used_++ % ends_->groups.size()];
}

void ExecutorKind::make_subscription(const std::string& name) {
  const auto intraprocess = settings_.intraprocess ? rclcpp::IntraProcessSetting::Enable
                                                   : rclcpp::IntraProcessSetting::Disable;
  rclcpp::PublisherOptions of_publisher;
  of_publisher.use_intra_process_comm = intraprocess;
  rclcpp::SubscriptionOptions of_subscription;
  of_subscription.use_intra_process_comm = intraprocess;
  of_subscription.callback_group = next_group();
  const rclcpp::QoS qos{rclcpp::KeepLast(settings_.depth)};
  ends_->publishers.push_back(ends_->sending->create_publisher<Message>(name, qos, of_publisher));
  callbacks_.push_back({fmt::format("sub{}", ends_->publishers.size())});
  ends_->subscriptions.push_back(ends_->receiving->create_subscription<Message>(
      name, qos, [this, callback = callbacks_.size() - 1](const Message&) { run(callback); },
      of_subscription));
}

void ExecutorKind::make_timer() {
  callbacks_.push_back({fmt::format("timer{}", ends_->timers.size() + 1)});
  ends_->timers.push_back(std::make_unique<ManualTimer>(
      ends_->receiving, [this, callback = callbacks_.size() - 1] { run(callback); }, next_group()));
}

void ExecutorKind::make_service(const std::string& name) {
  callbacks_.push_back({fmt::format("service{}", ends_->services.size() + 1)});
  ends_->clients.push_back(ends_->sending->create_client<Type>(name, service_qos(settings_.depth)));
  ends_->services.push_back(ends_->receiving->create_service<Type>(
      name,
      [this, callback = callbacks_.size() - 1](const std::shared_ptr<Type::Request>&,
                                               const std::shared_ptr<Type::Response>&) {
        run(callback);
      },
      service_qos(settings_.depth), next_group()));
}

void ExecutorKind::make_clients(const std::string& name) {
  ends_->answering = std::make_unique<Spinner>(ends_->sending);
  ends_->asked = ends_->sending->create_service<Type>(
      name,
      [this](const std::shared_ptr<Type::Request>&, const std::shared_ptr<Type::Response>&) {
        is_answered_ = true;
      },
      service_qos(settings_.depth), ends_->answering->group());
  first_client_ = callbacks_.size();
  for (std::size_t client = 1; client <= settings_.clients; ++client) {
    callbacks_.push_back({fmt::format("client{}", client)});
    ends_->asking.push_back(
        ends_->receiving->create_client<Type>(name, service_qos(settings_.depth), next_group()));
  }
}

bool ExecutorKind::is_matched() const {
  const auto is_ready = [](const auto& client) { return client->service_is_ready(); };
  return std::all_of(ends_->asking.begin(), ends_->asking.end(), is_ready) &&
         std::all_of(
             ends_->publishers.begin(), ends_->publishers.end(),
             [](const auto& publisher) { return publisher->get_subscription_count() == 1; }) &&
         std::all_of(
             ends_->subscriptions.begin(), ends_->subscriptions.end(),
             [](const auto& subscription) { return subscription->get_publisher_count() == 1; }) &&
         std::all_of(ends_->clients.begin(), ends_->clients.end(), is_ready);
}

void ExecutorKind::wait_for_matches() const {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (!is_matched()) {
    if (std::chrono::steady_clock::now() > limit) {
      throw std::runtime_error("the ends do not meet within 2 s");
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
}

// In the executor's thread: a callback.
void ExecutorKind::run(std::size_t callback) {
  std::unique_lock lock(mutex_);
  Callback& own = callbacks_[callback];
  ++run_;
  if (stopped_) return;
  sink_.report(own.name);
  if (settings_.spin) return;
  ++own.running;
  ended_.wait(lock, [&] { return stopped_ || own.ends > 0; });
  if (own.ends > 0) --own.ends;
  --own.running;
}

void ExecutorKind::call(std::string_view input) {
  if (input == "spin") {
    spin();
  } else if (input.starts_with("arrive")) {
    ends_->publishers.at(number_of(input, "arrive"))->publish(std::make_unique<Message>());
  } else if (input.starts_with("due")) {
    ends_->timers.at(number_of(input, "due"))->make_due();
  } else if (input.starts_with("request")) {
    ends_->clients.at(number_of(input, "request"))
        ->async_send_request(std::make_shared<Type::Request>());
  } else if (input.starts_with("ask")) {
    ask(number_of(input, "ask"));
  } else if (input.starts_with("end_")) {
    end(std::string(input.substr(4)));
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

// The service takes the request, and its answer is under way, when this returns.
void ExecutorKind::ask(std::size_t client) {
  const rclcpp::Client<Type>::CallbackType on_answer =
      [this, callback = first_client_ + client](const rclcpp::Client<Type>::SharedFuture&) {
        run(callback);
      };
  is_answered_ = false;
  ends_->asking.at(client)->async_send_request(std::make_shared<Type::Request>(), on_answer);
  ends_->answering->run_until([&] { return is_answered_; });
}

void ExecutorKind::spin() {
  using std::chrono::nanoseconds;
  run_ = 0;
  switch (*settings_.spin) {
    case Spin::once: ends_->executor->spin_once(nanoseconds(0)); break;
    case Spin::some: ends_->executor->spin_some(nanoseconds(0)); break;
    case Spin::all: ends_->executor->spin_all(nanoseconds(0)); break;
  }
  if (run_ == 0) sink_.report("nothing");
}

// One run of that callback ends, if it runs.
void ExecutorKind::end(const std::string& name) {
  const std::scoped_lock lock(mutex_);
  for (Callback& callback : callbacks_) {
    if (callback.name == name && callback.running > callback.ends) ++callback.ends;
  }
  ended_.notify_all();
}

void ExecutorKind::shutdown() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    ended_.notify_all();
  }
  if (ends_->answering) ends_->answering->stop();
  if (ends_->thread) ends_->thread->stop();
}

}  // namespace maide::ros2
