// `maide check --refine` on the reference port, a real system: its first model is learned without
// any test and hangs; the port does not, and in the end the model does not either.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Refine, EndsWithAVerdictThatTheRealSystemConfirms) {
  const TempDir folder("refine-test");
  const std::string file = (folder.path() / "system.yaml").string();
  const auto write_system = [&](const std::string& kind) {
    write_file_atomically(file, "models:\n  via:\n    learn: port\n    with: {kind: " + kind +
                                    "}\n    learning: {eq: random-words, max-tests: 0}\n"
                                    "programs:\n  planner: |\n    repeat 3 { via.write; }\n"
                                    "  controller: |\n    repeat 3 { via.read -> message; }\n");
  };
  const std::vector<std::string> check{"check",  file,         "--engine",
                                       "native", "--property", "deadlock"};
  write_system("strict, size: 3");
  EXPECT_EQ(run_maide(check).exit_status, 1);  // a false alarm

  std::vector<std::string> refine = check;
  refine.insert(refine.end(), {"--refine", "--json"});
  const SubprocessResult result = run_maide(refine);
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("via: refined from"));
  EXPECT_THAT(result.err, HasSubstr("by the counterexample to deadlock: after"));
  const Json json = json_of(result);
  EXPECT_FALSE(json["refinements"].empty());
  EXPECT_EQ(json["verdict"], "holds");
  EXPECT_THAT(run_maide(refine).err, Not(HasSubstr("refined from")));

  expect_error(run_maide({"check", file, "--refinements", "0", "-q"}), 2, "--refinements");
}

}  // namespace
}  // namespace maide::test
