// Tests that are there once for each learner: their names.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "maide/learn/learner.hpp"

namespace maide::test {

// Of those that learn deterministic machines.
inline std::vector<std::string> learner_names() {
  std::vector<std::string> names;
  for (const LearnerEntry& entry : deterministic_learners()) names.emplace_back(entry.name);
  return names;
}

// A test's name has no hyphens.
inline std::string as_test_name(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

}  // namespace maide::test
