// Starts a process that sleeps, prints its number, and sleeps itself: to be killed.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

#include "maide/wire/client/child_process.hpp"

int main() {
  const maide::ChildProcess child({"sleep", "1000"});
  fmt::print("{}\n", child.id());
  std::fflush(stdout);
  ::pause();
}
