#include "ros1_model.hpp"

#include <algorithm>
#include <compare>
#include <deque>
#include <map>
#include <stdexcept>
#include <utility>

#include "made_machine.hpp"

namespace maide::test {
namespace {

// Messages by their numbers, of which only the order matters and who is whose neighbour.
struct Content {
  std::size_t newest_read = 0;   // 0: none
  std::deque<std::size_t> kept;  // the subscriber's queue, oldest first
  std::size_t published = 0;
  std::size_t callbacks = 0;  // in the callback queue: each takes one message
  bool connected = true, enabled = true;
  auto operator<=>(const Content&) const = default;
};

// The same future with small numbers: a distance above 1 is 2.
Content normalized(Content content, bool latch) {
  std::map<std::size_t, std::size_t> numbers{{content.newest_read, 0}, {content.published, 0}};
  for (const std::size_t number : content.kept) numbers[number] = 0;
  const bool never_published = content.published == 0;
  std::size_t last = numbers.begin()->first, small = latch && !never_published ? 1 : 0;
  for (auto& [number, to] : numbers) {
    small += std::min<std::size_t>(number - last, 2);
    last = number;
    to = small;
  }
  content.newest_read = numbers[content.newest_read];
  content.published = numbers[content.published];
  for (std::size_t& number : content.kept) number = numbers[number];
  return content;
}

class Ros1Machine {
 public:
  explicit Ros1Machine(const Ros1Model& model) : model_(model) {}

  std::string step(Content& content, const std::string& input) const {
    if (input == "write") {
      publish(content);
    } else if (input == "burst") {
      for (std::size_t i = 0; i < model_.burst; ++i) publish(content);
    } else if (input == "tryread") {
      return try_read(content);
    } else if (input == "disconnect") {
      content.connected = false;
      content.kept.clear();
      content.callbacks = 0;
    } else if (input == "connect") {
      connect(content);
    } else if (input == "interrupt" || input == "resume") {
      content.enabled = input == "resume";
    } else if (input == "clear") {
      content.callbacks = 0;
    } else {
      throw std::invalid_argument(input);
    }
    return "quiet";
  }

 private:
  // Only a message that pushes none out gets a callback, and none does while the queue is disabled.
  void arrive(Content& content) const {
    if (content.kept.size() == model_.queue_size) {
      content.kept.pop_front();
    } else if (content.enabled) {
      ++content.callbacks;
    }
    content.kept.push_back(content.published);
  }

  void publish(Content& content) const {
    ++content.published;
    if (content.connected) arrive(content);
  }

  void connect(Content& content) const {
    if (content.connected) return;
    content.connected = true;
    if (model_.latch && content.published > 0) arrive(content);
  }

  std::string try_read(Content& content) const {
    if (!content.enabled) return "failed";
    if (content.callbacks == 0) return "null";
    --content.callbacks;
    const std::size_t number = content.kept.front();
    content.kept.pop_front();
    const std::size_t last = content.newest_read;
    content.newest_read = std::max(last, number);
    if (!model_.payload_gap) return "message";
    return number == last + 1 ? "next" : number > last ? "gap" : "old";
  }

  const Ros1Model model_;
};

}  // namespace

Mealy make_ros1_connection(const Ros1Model& model, const std::vector<std::string>& inputs) {
  const Ros1Machine machine(model);
  return make_machine(inputs, Content{}, [&](Content content, const std::string& input) {
    const std::string output = machine.step(content, input);
    return std::pair(output, normalized(content, model.latch));
  });
}

}  // namespace maide::test
