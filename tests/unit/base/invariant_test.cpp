// A check that fails says where; one that is off is compiled and not evaluated.
#include "maide/base/invariant.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace maide {
namespace {

constexpr int line_of_check = __LINE__ + 4;

std::string message_of_failure(int value) {
  try {
    MAIDE_CHECK_ALWAYS(value < 3);
  } catch (const std::logic_error& error) {
    return error.what();
  }
  return "";
}

TEST(Check, AFailureNamesTheConditionAndItsPlace) {
  EXPECT_EQ(message_of_failure(2), "");
  const std::string message = message_of_failure(3);
  EXPECT_EQ(message.find("check failed: value < 3 ("), 0U) << message;
  EXPECT_NE(message.find("invariant_test.cpp:" + std::to_string(line_of_check) + ")"),
            std::string::npos)
      << message;
}

TEST(Check, IsEvaluatedWhereChecksAreOnAndNowhereElse) {
  int evaluations = 0;
  MAIDE_CHECK(++evaluations > 0);
#ifdef MAIDE_CHECKS
  EXPECT_EQ(evaluations, 1);
  EXPECT_THROW(MAIDE_CHECK(evaluations == 2), std::logic_error);
#else
  EXPECT_EQ(evaluations, 0);
  EXPECT_NO_THROW(MAIDE_CHECK(evaluations == 2));
#endif
}

}  // namespace
}  // namespace maide
