// Loops that are sure to end. One kind goes over a container that the body does not change. The
// other counts a local number up or down, to a bound that nothing in the body changes.
//
//   for (int i = 0; i < n; ++i) { send(); }     ends
//   for (int i = 0; i < n; ++i) { ++*more; }    is not known to, if `more` was made by `&n`
#pragma once

#include <functional>

#include "maide/extract/sources.hpp"

namespace maide::extract {

// Whether a variable may be changed by another name: there is a reference or a pointer to it.
using IsShared = std::function<bool(int)>;

bool is_finite_loop(const Statement& loop, const Sources& sources, const IsShared& is_shared);

// The same of an algorithm that is given a range and a function.
bool is_finite_call(const Expression& call, const Function& function, const Sources& sources);

}  // namespace maide::extract
