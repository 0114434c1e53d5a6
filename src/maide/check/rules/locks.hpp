// Mutexes that know who holds them, and conditions: written by hand, after std::recursive_mutex and
// std::condition_variable_any (ISO C++20, 32.5.3 and 32.6). Who holds or waits is a program, by its
// place among those that use the model.
#pragma once

#include <cstdint>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/check/system/system.hpp"

namespace maide {

inline constexpr std::uint32_t max_depth_of_lock = 8;  // locks of one holder at a time
inline constexpr std::size_t max_waiters = 8;          // programs: each is one of three states

// A mutex that its holder may lock again. Its inputs are `lock`, `unlock` and perhaps `trylock`, as
// of make_mutex(); they are given by holder_steps(). 1 + 8 `users` states, and twice as many more
// for the answers of `trylock`.
InterfaceAutomaton make_recursive_mutex(std::size_t users, bool has_trylock);
enum class HolderStep : std::uint8_t {
  lock,
  unlock,
  trylock,
  trylock_yes,  // with its answer
  trylock_no,
  locks_once_more,  // a condition: it holds the mutex as often as it can
  is_not_holder,    // a condition
};
// What that program's step leads to. `users` as above.
std::vector<ModelStep> holder_steps(StateId at, HolderStep step, std::size_t users,
                                    std::size_t user);

// The program holds it, or does once the answer that is due has been taken.
bool holds_mutex(StateId at, std::size_t users, std::size_t user);

// A condition: `notify_one`, `notify_all`, and `wait`, which is given by waiter_steps().
// 3^`waiters` states.
InterfaceAutomaton make_condition(std::size_t waiters);
enum class WaiterStep : std::uint8_t {
  wait,
  wake,           // it was notified
  wake_causeless  // it was not
};
std::vector<ModelStep> waiter_steps(StateId at, WaiterStep step, std::size_t waiter);

}  // namespace maide
