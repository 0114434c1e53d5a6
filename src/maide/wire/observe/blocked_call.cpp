#include "maide/wire/observe/blocked_call.hpp"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>

#include <array>
#include <charconv>
#include <optional>
#include <utility>

namespace maide {
namespace {

// The call's arguments, "0x1a 0x0 ...", as far as they are there.
std::array<std::uint64_t, 4> parse_arguments(std::string_view text) {
  std::array<std::uint64_t, 4> arguments{};
  for (std::uint64_t& argument : arguments) {
    const std::size_t start = text.find("0x");
    if (start == std::string_view::npos) break;
    text.remove_prefix(start + 2);
    std::from_chars(text.data(), text.data() + text.size(), argument, 16);
  }
  return arguments;
}

// By which clock a futex operation's limit counts, if it is a point in time.
std::optional<clockid_t> clock_of(std::uint64_t operation) {
  const bool is_real = (operation & FUTEX_CLOCK_REALTIME) != 0;
  switch (operation & FUTEX_CMD_MASK) {
    case FUTEX_LOCK_PI: return CLOCK_REALTIME;
    case FUTEX_WAIT_BITSET:
    case FUTEX_WAIT_REQUEUE_PI:
    case FUTEX_LOCK_PI2: return is_real ? CLOCK_REALTIME : CLOCK_MONOTONIC;
    default: return std::nullopt;
  }
}

// The kernel reads it for us: the thread may be gone by now, and its stack with it.
std::optional<timespec> read_time(pid_t thread, std::uint64_t address) {
  timespec time{};
  const iovec here{&time, sizeof time};
  // NOLINTNEXTLINE(performance-no-int-to-ptr): the other process's address
  const iovec there{reinterpret_cast<void*>(address), sizeof time};
  const ssize_t size = ::process_vm_readv(thread, &here, 1, &there, 1, 0);
  if (size != static_cast<ssize_t>(sizeof time)) return std::nullopt;
  return time;
}

}  // namespace

// futex(address, operation, value, limit, ...)
std::optional<BlockedCall::Limit> BlockedCall::read_limit(std::string_view arguments,
                                                          pid_t thread) {
  const auto [address, operation, value, limit] = parse_arguments(arguments);
  const std::optional<clockid_t> clock = clock_of(operation);
  if (limit == 0 || !clock) return std::nullopt;
  const std::optional<timespec> time = read_time(thread, limit);
  if (!time) return std::nullopt;
  return Limit{*clock, *time};
}

BlockedCall BlockedCall::parse(std::string_view text, pid_t thread) {
  long number = -1;
  if (text.empty() || text.front() == 'r') return BlockedCall(Kind::running);
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (number == SYS_nanosleep || number == SYS_clock_nanosleep) {
    return BlockedCall(Kind::timed_sleep);
  }
  BlockedCall call(Kind::waiting);
  if (number == SYS_futex) {
    text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
    call.limit_ = read_limit(text, thread);
  }
  return call;
}

bool BlockedCall::is_overdue() const {
  if (!limit_) return false;
  timespec now{};
  ::clock_gettime(limit_->clock, &now);
  const timespec& time = limit_->time;
  return std::pair(time.tv_sec, time.tv_nsec) <= std::pair(now.tv_sec, now.tv_nsec);
}

}  // namespace maide
