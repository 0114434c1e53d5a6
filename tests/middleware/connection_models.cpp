#include "connection_models.hpp"

#include <algorithm>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "made_machine.hpp"

namespace maide::test {
namespace {

// Messages are numbered as they are written.
struct Content {
  std::deque<int> queue;    // to be read
  std::deque<int> history;  // what the writer keeps for a reader that connects
  int seen = 0, newest = 0;
  std::size_t stranded = 0;
  std::size_t uncredited = 0;  // read, and the writer does not know it
  bool connected = true;
  bool write_blocked = false;
  auto operator<=>(const Content&) const = default;
};

struct Step {
  Content next;
  std::string output;
};

// Which numbers are larger, and which follow on each other, is all that a reader can ever tell:
// numbered anew from 0, with steps of one and two.
Content renumber(Content content) {
  std::vector<int*> numbers{&content.seen, &content.newest};
  for (int& number : content.queue) numbers.push_back(&number);
  for (int& number : content.history) numbers.push_back(&number);
  std::sort(numbers.begin(), numbers.end(), [](const int* a, const int* b) { return *a < *b; });
  int last = *numbers.front();
  int renumbered = 0;
  for (int* number : numbers) {
    renumbered += std::min(*number - std::exchange(last, *number), 2);
    *number = renumbered;
  }
  return content;
}

bool has_room(const ConnectionModel& model, const Content& content) {
  if (!content.connected) return model.when_alone == WhenAlone::lose;
  return content.stranded == 0 && content.queue.size() + content.uncredited < model.capacity;
}

Content accept(const ConnectionModel& model, Content content) {
  ++content.newest;
  if (content.connected) content.queue.push_back(content.newest);
  content.history.push_back(content.newest);
  if (content.history.size() > model.replayed) content.history.pop_front();
  return content;
}

Step write(const ConnectionModel& model, Content content) {
  if (content.write_blocked) return {content, "refused"};
  if (has_room(model, content)) return {accept(model, content), "quiet"};
  if (content.stranded < model.stranded) {
    ++content.stranded;
    return {content, "quiet"};
  }
  switch (model.when_full) {
    case WhenFull::drop_oldest:
      if (!content.connected) {
        content.write_blocked = true;
        break;
      }
      content = accept(model, content);
      content.queue.pop_front();
      break;
    case WhenFull::drop_newest: ++content.newest; break;
    case WhenFull::fail: return {content, "failed"};
    case WhenFull::block: content.write_blocked = true; break;
  }
  return {content, "quiet"};
}

// A blocked write goes on once there is room.
Content unblock(const ConnectionModel& model, Content content) {
  if (!content.write_blocked || !has_room(model, content)) return content;
  content.write_blocked = false;
  return accept(model, content);
}

// The oldest message, of at least one.
std::string take(const ConnectionModel& model, Content& content) {
  const int number = content.queue.front();
  content.queue.pop_front();
  content.uncredited = (content.uncredited + 1) % model.credit_batch;
  const int seen = std::exchange(content.seen, std::max(content.seen, number));
  if (!model.payload_gap) return "message";
  return number <= seen ? "old" : number == seen + 1 ? "next" : "gap";
}

Step try_read(const ConnectionModel& model, Content content) {
  if (!content.connected) return {content, model.read_alone};
  if (content.queue.empty()) return {content, "null"};
  std::string output = take(model, content);
  while (model.reads_all && !content.queue.empty()) output += "," + take(model, content);
  return {unblock(model, content), output};
}

Step disconnect(Content content) {
  content.connected = false;
  content.queue.clear();
  content.uncredited = 0;
  return {content, "quiet"};
}

Step connect(const ConnectionModel& model, Content content) {
  if (!std::exchange(content.connected, true)) content.queue = content.history;
  while (content.queue.size() > model.capacity) content.queue.pop_front();
  return {unblock(model, content), "quiet"};
}

}  // namespace

Mealy make_connection(const ConnectionModel& model) {
  std::vector<std::string> inputs{"write", "tryread"};
  if (model.reconnects) inputs.insert(inputs.end(), {"disconnect", "connect"});
  return make_machine(inputs, Content{}, [&](const Content& content, const std::string& input) {
    const Step step = input == "write"        ? write(model, content)
                      : input == "tryread"    ? try_read(model, content)
                      : input == "disconnect" ? disconnect(content)
                                              : connect(model, content);
    return std::pair(step.output, renumber(step.next));
  });
}

}  // namespace maide::test
