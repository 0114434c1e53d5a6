// Whether this kernel, and the container around this process, show what an observation reads
// (docs/platforms.md). Each feature is tried, on this process and on a child. A look at the
// kernel's version would not do: a seccomp profile or a restriction of ptrace takes features away.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace maide {

struct KernelFeature {
  std::string_view name;     // "schedstat"
  std::string_view purpose;  // what it tells
  std::string_view without;  // what becomes of an observation that lacks it
  bool is_usable = false;
  std::string detail{};  // what was read, or why nothing was
};

// In the order of docs/platforms.md. Starts a child that sleeps, and ends it: some milliseconds.
std::vector<KernelFeature> examine_kernel();

}  // namespace maide
