// kill -9 of a middleware's wrapper at random moments of a learning run.
#include "assassin.hpp"

namespace maide {
namespace {

TEST(KilledMiddleware, OfCycloneDdsLosesNoWord) {
  test::expect_same_model("maide-wrap-cyclonedds", {{"depth", "2"}}, Translation::eager);
}

}  // namespace
}  // namespace maide
