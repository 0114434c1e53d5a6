#include "maide/check/rules/locks.hpp"

#include <span>
#include <string>

namespace maide {
namespace {

constexpr StateId free_mutex = 0;

// ---- mutexes ------------------------------------------------------------------------------------

// The state in which that program has locked it so often, from 1.
StateId held_by(std::size_t user, std::uint32_t times) {
  return static_cast<StateId>(1 + user * max_depth_of_lock + times - 1);
}
StateId states_without_answers(std::size_t users) {
  return static_cast<StateId>(1 + users * max_depth_of_lock);
}
// The states in which `yes` or `no` is due, and that one follows, which is held.
StateId before_yes(StateId held, std::size_t users) {
  return states_without_answers(users) + held - 1;
}
StateId before_no(StateId held, std::size_t users) {
  return 2 * states_without_answers(users) - 1 + held - 1;
}

// ---- conditions ---------------------------------------------------------------------------------

enum Wait : StateId { absent, waits, notified, wait_kinds };

StateId power_of(std::size_t waiter) {
  StateId power = 1;
  while (waiter-- > 0) power *= wait_kinds;
  return power;
}
StateId wait_of(StateId at, std::size_t waiter) { return at / power_of(waiter) % wait_kinds; }
StateId with_wait(StateId at, std::size_t waiter, Wait wait) {
  return at + power_of(waiter) * wait - power_of(waiter) * wait_of(at, waiter);
}

}  // namespace

InterfaceAutomaton make_recursive_mutex(std::size_t users, bool has_trylock) {
  std::vector<std::string> inputs{"lock", "unlock"}, outputs;
  const StateId plain = states_without_answers(users);
  if (has_trylock) {
    inputs.emplace_back("trylock");
    outputs = {"yes", "no"};
  }
  InterfaceAutomaton mutex(Alphabet(std::span<const std::string>(inputs)),
                           Alphabet(std::span<const std::string>(outputs)),
                           has_trylock ? 3 * std::size_t{plain} - 2 : plain);
  mutex.origin = {{"recursive", "true"}};
  for (StateId held = 1; has_trylock && held < plain; ++held) {
    mutex.add_transition(before_yes(held, users), {Action::Kind::output, 0}, held);
    mutex.add_transition(before_no(held, users), {Action::Kind::output, 1}, held);
  }
  return mutex;
}

std::vector<ModelStep> holder_steps(StateId at, HolderStep step, std::size_t users,
                                    std::size_t user) {
  if (at >= states_without_answers(users)) return {};  // an answer is due
  const auto lead = [](StateId to) { return std::vector<ModelStep>{{to, false}}; };
  const bool is_holder = held_by(user, 1) <= at && at <= held_by(user, max_depth_of_lock);
  const bool may_lock = at == free_mutex || (is_holder && at < held_by(user, max_depth_of_lock));
  const StateId locked = is_holder ? at + 1 : held_by(user, 1);
  switch (step) {
    case HolderStep::lock:
    case HolderStep::trylock_yes:
      if (may_lock) return lead(locked);
      break;
    case HolderStep::unlock:
      if (is_holder) return lead(at == held_by(user, 1) ? free_mutex : at - 1);
      break;
    case HolderStep::trylock:
      if (may_lock) return lead(before_yes(locked, users));
      if (!is_holder) return lead(before_no(at, users));
      break;
    case HolderStep::trylock_no:
      if (!may_lock && !is_holder) return lead(at);
      break;
    case HolderStep::locks_once_more:
      if (is_holder && !may_lock) return lead(at);
      break;
    case HolderStep::is_not_holder:
      if (!is_holder) return lead(at);
      break;
  }
  return {};
}

bool holds_mutex(StateId at, std::size_t users, std::size_t user) {
  StateId held = at;
  if (at >= before_no(1, users)) {
    held = at - before_no(1, users) + 1;
  } else if (at >= before_yes(1, users)) {
    held = at - before_yes(1, users) + 1;
  }
  return held_by(user, 1) <= held && held <= held_by(user, max_depth_of_lock);
}

InterfaceAutomaton make_condition(std::size_t waiters) {
  InterfaceAutomaton condition({"wait", "notify_one", "notify_all"}, {}, power_of(waiters));
  const Action one{Action::Kind::input, 1}, all{Action::Kind::input, 2};
  for (StateId at = 0; at < condition.size(); ++at) {
    StateId woken = at;
    for (std::size_t waiter = 0; waiter < waiters; ++waiter) {
      if (wait_of(at, waiter) != waits) continue;
      condition.add_transition(at, one, with_wait(at, waiter, notified));
      woken = with_wait(woken, waiter, notified);
    }
    if (woken == at) condition.add_transition(at, one, at);
    condition.add_transition(at, all, woken);
  }
  return condition;
}

std::vector<ModelStep> waiter_steps(StateId at, WaiterStep step, std::size_t waiter) {
  const Wait before = step == WaiterStep::wait   ? absent
                      : step == WaiterStep::wake ? notified
                                                 : waits;
  if (wait_of(at, waiter) != before) return {};
  return {{with_wait(at, waiter, step == WaiterStep::wait ? waits : absent), false}};
}

}  // namespace maide
