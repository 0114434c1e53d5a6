// Tables of systems and the verdicts that they must have, whatever the reduction.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide::test {

inline constexpr const char* V = "violated";
inline constexpr const char* H = "holds";

struct VerdictCase {
  const char* name;
  const char* property;
  const char* verdict;
  std::string text;
};
inline void PrintTo(const VerdictCase& system, std::ostream* out) { *out << system.name; }

inline void expect_verdict(const VerdictCase& expected) {
  const System system = parse_system(expected.text, "s.yaml", test_model);
  NativeEngine engine;
  for (const Reduction reduction :
       {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
    CheckRequest request;
    request.properties = {expected.property};
    request.options.reduction = reduction;
    const CheckReport report = check_system(system, engine, request);
    EXPECT_EQ(to_string(report.properties.at(0).verdict), std::string(expected.verdict))
        << to_string(reduction);
  }
}

// "waits_deadlock"
inline std::string name_of(const testing::TestParamInfo<VerdictCase>& system) {
  return std::string(system.param.name) + "_" + system.param.property;
}

}  // namespace maide::test
