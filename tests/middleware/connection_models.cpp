#include "connection_models.hpp"

#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "maide/automata/minimize.hpp"

namespace maide::test {
namespace {

// What is kept, as far as the reader can ever tell: for each message whether one was lost before
// it; and whether one was lost since the newest.
struct Content {
  std::deque<bool> gaps;
  bool lost = false;
  bool write_blocked = false;
  auto operator<=>(const Content&) const = default;
};

struct Step {
  Content next;
  std::string output;
};

Content accept(Content content) {
  content.gaps.push_back(std::exchange(content.lost, false));
  return content;
}

Step write(const ConnectionModel& model, Content content) {
  if (content.write_blocked) return {content, "refused"};
  if (content.gaps.size() < model.capacity) return {accept(content), "quiet"};
  switch (model.when_full) {
    case WhenFull::drop_oldest:
      content = accept(content);
      content.gaps.pop_front();
      content.gaps.front() = true;
      break;
    case WhenFull::drop_newest: content.lost = true; break;
    case WhenFull::fail: return {content, "failed"};
    case WhenFull::block: content.write_blocked = true; break;
  }
  return {content, "quiet"};
}

Step try_read(const ConnectionModel& model, Content content) {
  if (content.gaps.empty()) return {content, "null"};
  const bool gap = content.gaps.front();
  content.gaps.pop_front();
  if (std::exchange(content.write_blocked, false)) content = accept(content);
  return {content, !model.payload_gap ? "message" : gap ? "gap" : "next"};
}

}  // namespace

Mealy make_connection(const ConnectionModel& model) {
  Mealy machine({"write", "tryread"}, {}, 1);
  std::map<Content, StateId> numbers{{Content{}, 0}};
  std::vector<Content> contents{Content{}};
  for (StateId state = 0; state < contents.size(); ++state) {
    const Step steps[] = {write(model, contents[state]), try_read(model, contents[state])};
    for (Symbol input = 0; input < 2; ++input) {
      const auto [entry, is_new] = numbers.try_emplace(steps[input].next, machine.size());
      if (is_new) {
        machine.add_state();
        contents.push_back(steps[input].next);
      }
      machine.set_transition(state, input, machine.intern_output(steps[input].output),
                             entry->second);
    }
  }
  return minimize(machine);
}

}  // namespace maide::test
