// MAIDE_CHECK(condition): what must hold here if Maide is right, checked while it runs. A check
// that fails throws std::logic_error with the condition and its place, and the command line ends
// with "internal error" (exit status 5). Errors of users and of systems are maide::Error, and never
// this.
//
// Checks are on where MAIDE_CHECKS is defined: in the presets dev, asan and tsan. Elsewhere the
// condition is compiled and not evaluated, so it must have no effect of its own. A check on a hot
// path costs O(1), or no more than the step that it is about. check_invariants() of a class looks
// at the whole structure. It is there in every build, and tests call it.
#pragma once

namespace maide {

// Throws std::logic_error: "check failed: CONDITION (maide/learn/cache/cache.cpp:12)".
[[noreturn]] void fail_check(const char* condition, const char* file, int line);

}  // namespace maide

// Checks in every build: for check_invariants().
#define MAIDE_CHECK_ALWAYS(...) \
  (static_cast<bool>(__VA_ARGS__) ? void() : ::maide::fail_check(#__VA_ARGS__, __FILE__, __LINE__))

#ifdef MAIDE_CHECKS
#define MAIDE_CHECK(...) MAIDE_CHECK_ALWAYS(__VA_ARGS__)
#else
#define MAIDE_CHECK(...) static_cast<void>(sizeof(static_cast<bool>(__VA_ARGS__)))
#endif
