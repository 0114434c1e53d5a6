#include "ros2_executor_model.hpp"

#include <algorithm>
#include <compare>
#include <deque>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "made_machine.hpp"

namespace maide::test {
namespace {

// Outputs of a step, as an answer spells them.
std::string joined(const std::vector<std::string>& events) {
  std::string text;
  for (const std::string& event : events) text += (text.empty() ? "" : ",") + event;
  return text.empty() ? "quiet" : text;
}

// Of each callback, in the order in which they are run.
struct Work {
  std::vector<std::size_t> pending, running;
  std::vector<char> seen;                 // ready at the last look, and not begun since
  std::vector<std::deque<char>> answers;  // by client, which come last; whether each is its own
  auto operator<=>(const Work&) const = default;
};

class Rule {
 public:
  // `groups` by callback; "reentrant" is none. The last `clients` callbacks are those of clients.
  Rule(std::size_t threads, std::vector<std::string> groups, std::size_t clients = 0,
       bool takes_one_by_one = false)
      : threads_(threads),
        groups_(std::move(groups)),
        clients_(clients),
        takes_one_by_one_(takes_one_by_one) {}

  Work idle() const {
    const std::size_t count = groups_.size();
    return {std::vector<std::size_t>(count), std::vector<std::size_t>(count),
            std::vector<char>(count), std::vector<std::deque<char>>(clients_)};
  }

  void look(Work& work) const {
    for (std::size_t callback = 0; callback < groups_.size(); ++callback) {
      const bool is_ready = is_client(callback) ? !work.answers[client_of(callback)].empty()
                                                : work.pending[callback] > 0;
      work.seen[callback] = is_ready && is_free(work, callback) ? 1 : 0;
    }
  }

  // A client's answer arrives at all of them.
  void answer(Work& work, std::size_t asking, std::size_t depth) const {
    for (std::size_t client = 0; client < clients_; ++client) {
      std::deque<char>& answers = work.answers[client];
      answers.push_back(client == asking ? 1 : 0);
      if (answers.size() > depth) answers.pop_front();
    }
  }

  // The next callback's turn, if there is one and a thread for it. A client whose answers are to
  // others begins nothing.
  struct Turn {
    std::size_t callback = 0;
    bool begins = true;
  };
  std::optional<Turn> begin(Work& work) const {
    const std::size_t busy =
        std::accumulate(work.running.begin(), work.running.end(), std::size_t{0});
    if (busy == threads_) return std::nullopt;
    if (const auto turn = begin_seen(work)) return turn;
    look(work);
    return begin_seen(work);
  }

 private:
  bool is_client(std::size_t callback) const { return callback + clients_ >= groups_.size(); }
  std::size_t client_of(std::size_t callback) const { return callback + clients_ - groups_.size(); }

  // Whether what the client takes is its own.
  bool take_answer(std::deque<char>& answers) const {
    bool is_own = false;
    do {
      is_own = answers.front() != 0;
      answers.pop_front();
    } while (!takes_one_by_one_ && !is_own && !answers.empty());
    return is_own;
  }

  bool is_free(const Work& work, std::size_t callback) const {
    if (groups_[callback] == "reentrant") return true;
    for (std::size_t other = 0; other < groups_.size(); ++other) {
      if (groups_[other] == groups_[callback] && work.running[other] > 0) return false;
    }
    return true;
  }

  std::optional<Turn> begin_seen(Work& work) const {
    for (std::size_t callback = 0; callback < groups_.size(); ++callback) {
      if (work.seen[callback] == 0 || !is_free(work, callback)) continue;
      work.seen[callback] = 0;
      if (!is_client(callback)) {
        --work.pending[callback];
      } else if (!take_answer(work.answers[client_of(callback)])) {
        return Turn{callback, false};
      }
      ++work.running[callback];
      return Turn{callback};
    }
    return std::nullopt;
  }

  const std::size_t threads_;
  const std::vector<std::string> groups_;
  const std::size_t clients_;
  const bool takes_one_by_one_;
};

// The callbacks of kind=executor, and what makes each ready.
struct Callbacks {
  std::vector<std::string> inputs, events;
  std::vector<std::size_t> most_pending;

  void add(const std::string& input, const std::string& event, std::size_t count,
           std::size_t depth) {
    for (std::size_t number = 1; number <= count; ++number) {
      inputs.push_back(input + std::to_string(number));
      events.push_back(event + std::to_string(number));
      most_pending.push_back(depth);
    }
  }
};

Callbacks callbacks_of(const Ros2Executor& executor) {
  Callbacks all;
  all.add("due", "timer", executor.timers, 1);
  if (!executor.intraprocess) all.add("arrive", "sub", executor.subscriptions, executor.depth);
  all.add("request", "service", executor.services, executor.depth);
  if (executor.intraprocess) all.add("arrive", "sub", executor.subscriptions, executor.depth);
  all.add("ask", "client", executor.clients, executor.depth);
  return all;
}

// In the wrapper's order, whatever the order of running.
std::vector<std::string> inputs_of(const Ros2Executor& executor) {
  Ros2Executor usual = executor;
  usual.intraprocess = false;
  const Callbacks callbacks = callbacks_of(usual);
  std::vector<std::string> inputs = callbacks.inputs;
  if (executor.spin != "forever") {
    inputs.emplace_back("spin");
  } else {
    for (const std::string& event : callbacks.events) inputs.push_back("end_" + event);
  }
  return inputs;
}

std::string spin(const Rule& rule, Work& work, const std::string& how,
                 const std::vector<std::string>& events) {
  std::vector<std::string> ran;
  if (how == "some") rule.look(work);
  const auto has_seen = [&] { return std::count(work.seen.begin(), work.seen.end(), 1) > 0; };
  for (std::size_t turns = 0; how == "all" || turns == 0 || (how == "some" && has_seen());
       ++turns) {
    const auto turn = rule.begin(work);
    if (!turn) break;
    if (!turn->begins) continue;
    work.running[turn->callback] = 0;
    ran.push_back(events[turn->callback]);
  }
  return ran.empty() ? "nothing" : joined(ran);
}

std::string begin_all(const Rule& rule, Work& work, const std::vector<std::string>& events) {
  std::vector<std::string> began;
  while (const auto turn = rule.begin(work)) {
    if (turn->begins) began.push_back(events[turn->callback]);
  }
  return joined(began);
}

// A caller's callback, and what is under way between client and server: who asked.
struct Calls {
  enum class Phase { idle, triggered, held, waiting };
  Work work;
  std::vector<Phase> callers;
  std::vector<std::size_t> asked;  // the how manyth request of each it waits for
  std::deque<std::pair<std::size_t, std::size_t>> requests, answers;
  auto operator<=>(const Calls&) const = default;
};

class NestedMachine {
 public:
  explicit NestedMachine(const Ros2Nested& nested)
      : nested_(nested),
        server_(nested.callers),
        client_(nested.callers + 1),
        rule_(nested.threads, groups_of(nested)) {}

  Calls first() const {
    return {rule_.idle(),
            std::vector<Calls::Phase>(nested_.callers, Calls::Phase::idle),
            std::vector<std::size_t>(nested_.callers),
            {},
            {}};
  }

  std::string step(Calls& calls, const std::string& input) const {
    using Phase = Calls::Phase;
    const auto is_in = [&](Phase phase) {
      return std::find(calls.callers.begin(), calls.callers.end(), phase) != calls.callers.end();
    };
    if (input == "look")
      return !is_in(Phase::waiting) ? "idle" : is_in(Phase::held) ? "waits" : "hangs";
    const std::string name = input.substr(0, input.size() - 1);
    const std::size_t caller = input.back() == '2' ? 1 : 0;
    Phase& phase = calls.callers[caller];
    std::vector<std::string> events;
    if (name == "trigger" && phase == Phase::idle) {
      phase = Phase::triggered;
      ++calls.work.pending[caller];
    } else if (name == "call" && phase == Phase::held) {
      ask(calls, caller, events);
    } else if (name == "timeout" && phase == Phase::waiting) {
      end(calls, caller, "timed_out", events);
    } else {
      return "unexplored";
    }
    settle(calls, events);
    // In the order of the actors: the first callback's outputs come first.
    std::stable_sort(events.begin(), events.end(), [](const auto& left, const auto& right) {
      return left.back() < right.back();
    });
    return joined(events);
  }

 private:
  static std::vector<std::string> groups_of(const Ros2Nested& nested) {
    std::vector<std::string> groups(nested.callers, nested.caller_group);
    groups.push_back(nested.server_group);
    groups.push_back(nested.client_group);
    return groups;
  }

  void ask(Calls& calls, std::size_t caller, std::vector<std::string>& events) const {
    if (nested_.spins) return end(calls, caller, "exception", events);
    calls.callers[caller] = Calls::Phase::waiting;
    calls.asked[caller] = 1 - calls.asked[caller];
    const std::pair request{caller, calls.asked[caller]};
    if (nested_.server_group == "elsewhere") return answer(calls, request);
    calls.requests.push_back(request);
    ++calls.work.pending[server_];
  }

  void answer(Calls& calls, const std::pair<std::size_t, std::size_t>& request) const {
    calls.answers.push_back(request);
    ++calls.work.pending[client_];
  }

  void end(Calls& calls, std::size_t caller, const std::string& how,
           std::vector<std::string>& events) const {
    events.push_back(how + std::to_string(caller + 1));
    calls.callers[caller] = Calls::Phase::idle;
    calls.work.running[caller] = 0;
  }

  void settle(Calls& calls, std::vector<std::string>& events) const {
    while (const auto turn = rule_.begin(calls.work)) {
      const std::size_t callback = turn->callback;
      if (callback < nested_.callers) {
        calls.callers[callback] = Calls::Phase::held;
        events.push_back("began" + std::to_string(callback + 1));
        continue;
      }
      calls.work.running[callback] = 0;
      auto& queue = callback == server_ ? calls.requests : calls.answers;
      const auto front = queue.front();
      queue.pop_front();
      if (callback == server_) {
        answer(calls, front);
      } else if (calls.callers[front.first] == Calls::Phase::waiting &&
                 calls.asked[front.first] == front.second) {
        end(calls, front.first, "returned", events);
      }
    }
  }

  const Ros2Nested nested_;
  const std::size_t server_, client_;  // callbacks
  const Rule rule_;
};

}  // namespace

Mealy make_ros2_executor(const Ros2Executor& executor) {
  const Callbacks callbacks = callbacks_of(executor);
  std::vector<std::string> groups = callbacks.events;
  if (executor.groups != "own") std::fill(groups.begin(), groups.end(), executor.groups);
  const Rule rule(executor.threads, groups, executor.clients, executor.takes_one_by_one);
  const auto step = [&](Work work, const std::string& input) {
    if (input == "spin") {
      const std::string ran = spin(rule, work, executor.spin, callbacks.events);
      return std::pair(ran, work);
    }
    const auto ready = std::find(callbacks.inputs.begin(), callbacks.inputs.end(), input);
    if (ready != callbacks.inputs.end()) {
      const auto callback = static_cast<std::size_t>(ready - callbacks.inputs.begin());
      if (input.starts_with("ask")) {
        rule.answer(work, callback + executor.clients - callbacks.inputs.size(), executor.depth);
        const std::string began =
            executor.spin == "forever" ? begin_all(rule, work, callbacks.events) : "quiet";
        return std::pair(began, work);
      }
      std::size_t& pending = work.pending[callback];
      pending = std::min(pending + 1, callbacks.most_pending[callback]);
    } else {
      const auto ended =
          std::find(callbacks.events.begin(), callbacks.events.end(), input.substr(4));
      std::size_t& running =
          work.running.at(static_cast<std::size_t>(ended - callbacks.events.begin()));
      if (running > 0) --running;
    }
    const std::string began =
        executor.spin == "forever" ? begin_all(rule, work, callbacks.events) : "quiet";
    return std::pair(began, work);
  };
  return make_machine(inputs_of(executor), rule.idle(), step);
}

Mealy make_ros2_nested(const Ros2Nested& nested) {
  std::vector<std::string> inputs;
  for (std::size_t caller = 1; caller <= nested.callers; ++caller) {
    for (const char* input : {"trigger", "call", "timeout"}) {
      inputs.push_back(input + std::to_string(caller));
    }
  }
  inputs.emplace_back("look");
  const NestedMachine machine(nested);
  return make_machine(inputs, machine.first(), [&](Calls calls, const std::string& input) {
    const std::string output = machine.step(calls, input);
    return std::pair(output, calls);
  });
}

}  // namespace maide::test
