// The figures of others that are compiled in.
#include "published_results.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/cli/tool_commands.hpp"

namespace maide {
namespace {

// `maide` names the systems in its help without having the figures.
TEST(PublishedResults, AreOfTheSystemsThatTheHelpNames) {
  EXPECT_THAT(table1_systems(), testing::ElementsAreArray(cli::reproduced_systems));
}

}  // namespace
}  // namespace maide
