// Frees what is large beside what comes next: millions of values take seconds, and who was told to
// stop should not wait for it.
#pragma once

#include <memory>
#include <system_error>
#include <thread>
#include <type_traits>
#include <utility>

namespace maide {

// The value goes on a thread of its own; here, if there can be no other thread. At the end of the
// process it is not waited for.
template <typename Value>
void free_beside(Value&& value) {
  auto owned = std::make_shared<std::decay_t<Value>>(std::forward<Value>(value));
  try {
    std::thread([owned = std::move(owned)]() mutable { owned.reset(); }).detach();
  } catch (const std::system_error&) {
    return;
  }
}

}  // namespace maide
