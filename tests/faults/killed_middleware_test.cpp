// kill -9 of a middleware's wrapper at random moments of a learning run.
#include <sstream>
#include <string>
#include <vector>

#include "assassin.hpp"

namespace maide {
namespace {

// Those that are built here.
std::vector<std::string> middlewares() {
  std::istringstream names(MAIDE_KILLED_MIDDLEWARES);
  std::vector<std::string> all;
  for (std::string name; names >> name;) all.push_back(name);
  return all;
}

class KilledMiddleware : public testing::TestWithParam<std::string> {};

TEST_P(KilledMiddleware, LosesNoWord) {
  test::expect_same_model("maide-wrap-" + GetParam(), {}, Translation::eager);
}

INSTANTIATE_TEST_SUITE_P(Wrappers, KilledMiddleware, testing::ValuesIn(middlewares()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace maide
