#include "topic.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "maide/base/error.hpp"
#include "qos.hpp"

namespace maide::ros2 {
namespace {

bool is_input(const OptionValues& options, const char* name) {
  const std::vector<std::string> inputs = options.list("inputs");
  return std::find(inputs.begin(), inputs.end(), name) != inputs.end();
}

bool keeps_all(const rclcpp::QoS& qos) { return qos.history() == rclcpp::HistoryPolicy::KeepAll; }

bool is_kept(const rclcpp::QoS& qos) {
  return qos.durability() == rclcpp::DurabilityPolicy::TransientLocal;
}

std::optional<Spin> spin_from(const OptionValues& options) {
  if (options.is("take", "direct")) return std::nullopt;
  if (options.is("take", "some")) return Spin::some;
  return options.is("take", "all") ? Spin::all : Spin::once;
}

rclcpp::IntraProcessSetting setting_of(bool intraprocess) {
  return intraprocess ? rclcpp::IntraProcessSetting::Enable : rclcpp::IntraProcessSetting::Disable;
}

}  // namespace

std::vector<OptionSpec> TopicSettings::options() {
  return {OptionSpec::choice("take", "once", {"once", "some", "all", "direct"},
                             "how a message is fetched: spin_once, spin_some, spin_all, or "
                             "Subscription::take() without an executor"),
          OptionSpec::choice("intraprocess", "off", {"off", "on"},
                             "rclcpp's own way from publisher to subscription in one process")};
}

TopicSettings TopicSettings::from(const OptionValues& options) {
  TopicSettings settings;
  settings.publisher = qos_from(options, "pub-");
  settings.subscription = qos_from(options, "sub-");
  settings.spin = spin_from(options);
  settings.intraprocess = options.is("intraprocess", "on");
  settings.writers = static_cast<std::size_t>(options.number("writers"));
  settings.readers = static_cast<std::size_t>(options.number("readers"));
  const bool keeps = keeps_all(settings.publisher) || keeps_all(settings.subscription);
  if (settings.intraprocess && options.is("contexts", "2")) {
    throw UsageError("option intraprocess: on needs contexts=1");
  }
  if (settings.intraprocess &&
      (keeps || is_kept(settings.publisher) || is_kept(settings.subscription))) {
    throw UsageError(
        "option intraprocess: rclcpp refuses it with keep_all and with transient_local");
  }
  if (keeps_all(settings.subscription) && options.number("size") == 0) {
    throw UsageError(
        "option history: keep_all grows without limit, so say size=N (messages in flight to try)");
  }
  if (is_input(options, "unsubscribe") && options.number("size") > 0) {
    throw UsageError(
        "option size: it counts messages in flight, and unsubscribe loses some; say keep_last");
  }
  return settings;
}

bool TopicSettings::match() const {
  return rclcpp::qos_check_compatible(publisher, subscription).compatibility !=
         rclcpp::QoSCompatibility::Error;
}

bool TopicSettings::keeps_for_late_readers() const {
  return is_kept(publisher) && is_kept(subscription);
}

SystemSetup topic_setup(const TopicSettings& settings, const OptionValues& options) {
  SystemSetup setup;
  setup.actors = {"writer", "reader"};
  setup.inputs = {{"write", "writer", {}},
                  {"read", "reader", {"message"}},
                  {"tryread", "reader", {}},
                  {"unsubscribe", "reader", {}},
                  {"subscribe", "reader", {}}};
  if (is_input(options, "unsubscribe")) setup.inputs[1].returns.emplace_back("unsubscribed");
  setup.events = {
      {"message", "reader"}, {"null", "reader"}, {"unsubscribed", "reader"}, {"written", "writer"}};
  setup.usual_inputs = {"write", "read"};
  setup.usual_events = {"message"};
  setup.messages_come_again = settings.keeps_for_late_readers();
  if (options.number("size") > 0) {
    const auto depth = std::max<std::size_t>(settings.subscription.depth(), 1);
    setup.in_flight.emplace().capacity = keeps_all(settings.subscription) ? 0 : depth;
  }
  return setup;
}

Topic::Topic(Nodes& nodes, const TopicSettings& settings, EventSink& sink)
    : nodes_(nodes),
      settings_(settings),
      sink_(sink),
      publishing_(nodes.sending()),
      subscribing_(nodes.receiving()),
      name_(nodes.next_word()),
      stop_(std::make_shared<rclcpp::GuardCondition>(
          subscribing_->get_node_base_interface()->get_context())) {
  rclcpp::PublisherOptions options;
  options.use_intra_process_comm = setting_of(settings.intraprocess);
  for (std::size_t writer = 0; writer < settings.writers; ++writer) {
    ends_->publishers.push_back(
        publishing_->create_publisher<Message>(name_, settings.publisher, options));
  }
  for (std::size_t reader = 0; reader < settings.readers; ++reader) {
    ends_->readers.push_back(std::make_unique<Reader>(subscribing_));
    subscribe(*ends_->readers.back());
  }
  wait_for_matches();
}

Topic::~Topic() { nodes_.retire(ends_); }

void Topic::subscribe(Reader& reader) {
  if (reader.subscription) return;
  rclcpp::SubscriptionOptions options;
  options.use_intra_process_comm = setting_of(settings_.intraprocess);
  options.callback_group = reader.spinner.group();
  reader.subscription = subscribing_->create_subscription<Message>(
      name_, settings_.subscription,
      [this, &reader](const Message& message) {
        reader.has_read = true;
        sink_.message(message.data);
      },
      options);
}

void Topic::unsubscribe(Reader& reader) { reader.subscription.reset(); }

bool Topic::know_each_other() const {
  const bool match = settings_.match();
  const auto subscriptions =
      std::count_if(ends_->readers.begin(), ends_->readers.end(),
                    [](const auto& reader) { return reader->subscription != nullptr; });
  for (const auto& publisher : ends_->publishers) {
    if (publisher->get_subscription_count() !=
        (match ? static_cast<std::size_t>(subscriptions) : 0))
      return false;
  }
  return std::all_of(ends_->readers.begin(), ends_->readers.end(), [&](const auto& reader) {
    return !reader->subscription ||
           reader->subscription->get_publisher_count() == (match ? ends_->publishers.size() : 0);
  });
}

void Topic::wait_for_matches() const {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (std::chrono::steady_clock::now() < limit) {
    if (know_each_other()) return;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  throw std::runtime_error("publishers and subscriptions do not meet, or part, within 2 s");
}

void Topic::call(std::string_view input) {
  if (stopped_) return;
  if (input == "write") return write();
  Reader& reader = *ends_->readers[sink_.end()];
  if (input == "read" || input == "tryread") {
    read(reader, input == "read");
  } else if (input == "unsubscribe") {
    unsubscribe(reader);
    wait_for_matches();
  } else if (input == "subscribe") {
    subscribe(reader);
    wait_for_matches();
  } else {
    throw std::logic_error("no input '" + std::string(input) + "'");
  }
}

// By a message of its own, so that rclcpp need not copy it on its own way.
void Topic::write() {
  auto message = std::make_unique<Message>();
  message->data = sink_.content(written_ + 1);
  ++written_;
  ends_->publishers[sink_.end()]->publish(std::move(message));
  sink_.report("written");
}

void Topic::read(Reader& reader, bool waits) {
  if (!reader.subscription) return sink_.report("unsubscribed");
  reader.has_read = false;
  if (!settings_.spin) {
    take_directly(reader, waits);
  } else if (waits) {
    reader.spinner.run_until([&] { return reader.has_read; });
  } else {
    reader.spinner.run_ready(*settings_.spin);
  }
  if (!reader.has_read && !waits) sink_.report("null");
}

void Topic::take_directly(Reader& reader, bool waits) {
  if (take_one(reader) || !waits) return;
  rclcpp::WaitSet waitset({}, {}, {}, {}, {}, {},
                          subscribing_->get_node_base_interface()->get_context());
  waitset.add_subscription(reader.subscription);
  waitset.add_guard_condition(stop_);
  while (!stopped_ && !take_one(reader)) {
    // Whatever woke it, the message is there or it is not.
    [[maybe_unused]] const auto why = waitset.wait();
  }
}

bool Topic::take_one(Reader& reader) {
  Message message;
  rclcpp::MessageInfo info;
  if (!reader.subscription->take(message, info)) return false;
  reader.has_read = true;
  sink_.message(message.data);
  return true;
}

void Topic::shutdown() {
  stopped_ = true;
  stop_->trigger();
  for (const auto& reader : ends_->readers) reader->spinner.stop();
}

}  // namespace maide::ros2
