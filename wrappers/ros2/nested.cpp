#include "nested.hpp"

#include <algorithm>
#include <chrono>
#include <set>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "qos.hpp"

namespace maide::ros2 {
namespace {

constexpr const char* elsewhere = "elsewhere";
constexpr const char* reentrant = "reentrant";
constexpr std::size_t service_depth = 10;  // ROS 2's default

// A callback is triggered, begins, calls, and ends. Several runs of it at once would race for what
// comes next; two callbacks show as much.
LearningPurpose one_run_at_a_time(const std::string& suffix) {
  const std::vector<std::string> inputs = {"trigger" + suffix, "call" + suffix, "timeout" + suffix};
  const std::vector<std::string> outputs = {"began" + suffix, "returned" + suffix,
                                            "timed_out" + suffix, "exception" + suffix};
  enum : StateId { idle, triggered, held, waiting };
  InterfaceAutomaton run{Alphabet(std::span<const std::string>(inputs)),
                         Alphabet(std::span<const std::string>(outputs)), 4};
  run.add_transition(idle, {Action::Kind::input, 0}, triggered);
  run.add_transition(triggered, {Action::Kind::output, 0}, held);
  run.add_transition(held, {Action::Kind::input, 1}, waiting);
  run.add_transition(waiting, {Action::Kind::input, 2}, waiting);
  for (Symbol end = 1; end < outputs.size(); ++end) {
    run.add_transition(waiting, {Action::Kind::output, end}, idle);
  }
  return LearningPurpose(std::move(run));
}

}  // namespace

std::vector<OptionSpec> NestedSettings::options() {
  const std::vector<std::string> groups = {"a", "b", "c", reentrant};
  std::vector<std::string> of_second = groups, of_server = groups;
  of_second.emplace_back("same");
  of_server.emplace_back(elsewhere);
  return {OptionSpec::integer("callers", 1, 1, 2, "kind=nested: callbacks that call"),
          OptionSpec::choice("caller-group", "a", groups,
                             "kind=nested: the callback's group; a, b, c are exclusive"),
          OptionSpec::choice("caller2-group", "same", of_second,
                             "kind=nested: the group of the second one"),
          OptionSpec::choice("client-group", "a", groups,
                             "kind=nested: the group in which the answers come"),
          OptionSpec::choice("server-group", elsewhere, of_server,
                             "kind=nested: the server's group, or an executor of its own"),
          OptionSpec::choice("call", "wait", {"wait", "spin"},
                             "kind=nested: the callback waits for its answer, or spins its "
                             "executor until it comes")};
}

NestedSettings NestedSettings::from(const OptionValues& options) {
  NestedSettings settings;
  settings.executor = ExecutorSettings::from(options);
  settings.callers = static_cast<std::size_t>(options.number("callers"));
  const std::string& first = options.text("caller-group");
  const std::string& second = options.text("caller2-group");
  settings.caller_groups = {first, second == "same" ? first : second};
  settings.client_group = options.text("client-group");
  settings.server_group = options.text("server-group");
  settings.spins = options.is("call", "spin");
  return settings;
}

SystemSetup nested_setup(const NestedSettings& settings) {
  SystemSetup setup;
  setup.actors = {"world"};
  for (std::size_t caller = 1; caller <= settings.callers; ++caller) {
    const std::string suffix = std::to_string(caller), actor = "callback" + suffix;
    setup.actors.push_back(actor);
    for (const char* input : {"trigger", "call", "timeout"}) {
      setup.inputs.push_back({input + suffix, "world", {}});
    }
    for (const char* event : {"began", "returned", "timed_out", "exception"}) {
      setup.events.push_back({event + suffix, actor});
    }
    setup.purposes.push_back(one_run_at_a_time(suffix));
  }
  setup.bound = "one run of each callback at a time";
  setup.inputs.push_back({"look", "world", {}});
  for (const char* event : {"hangs", "waits", "idle"}) setup.events.push_back({event, "world"});
  for (const SystemSetup::Input& input : setup.inputs) setup.usual_inputs.push_back(input.name);
  for (const SystemSetup::Event& event : setup.events) setup.usual_events.push_back(event.name);
  return setup;
}

std::vector<std::string> nested_inputs() {
  NestedSettings most;
  most.callers = 2;
  return nested_setup(most).usual_inputs;
}

std::vector<std::string> nested_events() {
  NestedSettings most;
  most.callers = 2;
  return nested_setup(most).usual_events;
}

Nested::Nested(Nodes& nodes, const NestedSettings& settings, EventSink& sink)
    : nodes_(nodes), settings_(settings), sink_(sink) {
  const std::string name = nodes.next_word();
  ends_->sending = nodes.sending();
  ends_->receiving = nodes.receiving();
  ends_->executor = make_executor(settings.executor, ends_->receiving);
  make_groups_of_executor();
  for (std::size_t caller = 0; caller < settings.callers; ++caller) make_caller(caller, name);
  ends_->client = ends_->receiving->create_client<Type>(name, service_qos(service_depth),
                                                        ends_->groups.at(settings.client_group));
  ends_->server = ends_->receiving->create_service<Type>(
      name, [](const std::shared_ptr<Type::Request>&, const std::shared_ptr<Type::Response>&) {},
      service_qos(service_depth), ends_->groups.at(settings.server_group));
  wait_for_matches();
  ends_->thread = std::make_unique<SpinningThread>(*ends_->executor);
  if (ends_->elsewhere) {
    ends_->elsewhere_thread = std::make_unique<SpinningThread>(*ends_->elsewhere);
  }
}

Nested::~Nested() {
  ends_->thread.reset();
  ends_->elsewhere_thread.reset();
  nodes_.retire(ends_);
}

void Nested::make_groups_of_executor() {
  const auto node = ends_->receiving->get_node_base_interface();
  std::set<std::string> exclusive{settings_.client_group, settings_.server_group};
  exclusive.insert(settings_.caller_groups.begin(), settings_.caller_groups.end());
  if (exclusive.erase(reentrant) > 0) {
    ends_->groups[reentrant] =
        make_groups(ends_->receiving, 1, rclcpp::CallbackGroupType::Reentrant).front();
    ends_->executor->add_callback_group(ends_->groups[reentrant], node);
  }
  const auto groups = make_groups(ends_->receiving, exclusive.size());
  auto group = groups.begin();
  for (const std::string& name : exclusive) {
    ends_->groups[name] = *group;
    if (name == elsewhere) {
      ends_->elsewhere = make_executor({}, ends_->receiving);
      ends_->elsewhere->add_callback_group(*group, node);
    } else {
      ends_->executor->add_callback_group(*group, node);
    }
    ++group;
  }
}

void Nested::make_caller(std::size_t number, const std::string& topic) {
  auto caller = std::make_unique<Caller>();
  caller->suffix = std::to_string(number + 1);
  const rclcpp::QoS qos{rclcpp::KeepLast(1)};
  rclcpp::SubscriptionOptions options;
  options.callback_group = ends_->groups.at(settings_.caller_groups[number]);
  const std::string name = topic + "_" + caller->suffix;
  caller->publisher = ends_->sending->create_publisher<Message>(name, qos);
  caller->subscription = ends_->receiving->create_subscription<Message>(
      name, qos, [this, &own = *caller](const Message&) { run(own); }, options);
  ends_->callers.push_back(std::move(caller));
}

void Nested::wait_for_matches() const {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (!ends_->client->service_is_ready() ||
         std::any_of(ends_->callers.begin(), ends_->callers.end(), [](const auto& caller) {
           return caller->publisher->get_subscription_count() != 1 ||
                  caller->subscription->get_publisher_count() != 1;
         })) {
    if (std::chrono::steady_clock::now() > limit) {
      throw std::runtime_error("the ends do not meet within 2 s");
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
}

// The callback.
void Nested::run(Caller& caller) {
  std::unique_lock lock(mutex_);
  if (stopped_) return;
  sink_.report("began" + caller.suffix);
  ++caller.held;
  changed_.wait(lock, [&] { return stopped_ || caller.released > 0; });
  --caller.held;
  if (stopped_) return;
  --caller.released;
  if (settings_.spins) {
    lock.unlock();
    spin_for_answer(caller);
  } else {
    make_call(caller, lock);
  }
}

void Nested::make_call(Caller& caller, std::unique_lock<std::mutex>& lock) {
  // Shared with an answer that comes after the wait was given up.
  const auto has_answer = std::make_shared<bool>(false);
  const rclcpp::Client<Type>::CallbackType on_answer =
      [this, has_answer](const rclcpp::Client<Type>::SharedFuture&) {
        const std::scoped_lock own(mutex_);
        *has_answer = true;
        changed_.notify_all();
      };
  ++caller.waiting;
  lock.unlock();
  ends_->client->async_send_request(std::make_shared<Type::Request>(), on_answer);
  lock.lock();
  changed_.wait(lock, [&] { return stopped_ || *has_answer || caller.given_up > 0; });
  --caller.waiting;
  if (stopped_) return;
  if (!*has_answer) --caller.given_up;
  sink_.report((*has_answer ? "returned" : "timed_out") + caller.suffix);
}

void Nested::spin_for_answer(Caller& caller) {
  try {
    const auto future = ends_->client->async_send_request(std::make_shared<Type::Request>());
    ends_->executor->spin_until_future_complete(future);
    sink_.report("returned" + caller.suffix);
  } catch (const std::runtime_error&) {
    sink_.report("exception" + caller.suffix);
  }
}

void Nested::call(std::string_view input) {
  if (input == "look") return look();
  const std::string_view name = input.substr(0, input.size() - 1);
  Caller& caller = *ends_->callers.at(input.back() == '2' ? 1 : 0);
  if (name == "trigger") return caller.publisher->publish(Message());
  const std::scoped_lock lock(mutex_);
  if (name == "call") {
    if (caller.held > caller.released) ++caller.released;
  } else if (name == "timeout") {
    if (caller.waiting > caller.given_up) ++caller.given_up;
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
  changed_.notify_all();
}

void Nested::look() {
  const std::scoped_lock lock(mutex_);
  const auto some = [&](std::size_t Caller::*number) {
    return std::any_of(ends_->callers.begin(), ends_->callers.end(),
                       [&](const auto& caller) { return (*caller).*number > 0; });
  };
  sink_.report(!some(&Caller::waiting) ? "idle" : some(&Caller::held) ? "waits" : "hangs");
}

void Nested::shutdown() {
  {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  ends_->thread->stop();
  if (ends_->elsewhere_thread) ends_->elsewhere_thread->stop();
}

}  // namespace maide::ros2
