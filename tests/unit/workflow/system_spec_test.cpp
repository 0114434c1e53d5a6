#include "maide/workflow/system_spec.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"

namespace maide {
namespace {

using Words = std::vector<std::string>;

SystemSpec parse(const std::string& sul, const Words& options = {}) {
  return parse_system_spec(sul, options);
}

TEST(SystemSpec, KnowsTheFourKinds) {
  EXPECT_EQ(parse("port").kind, SystemSpec::Kind::wrapper);
  EXPECT_EQ(parse("sim:a b.dot").target, "a b.dot");
  EXPECT_EQ(parse("tcp://127.0.0.1:7").target, "127.0.0.1:7");
  EXPECT_EQ(parse("exec:python3 'my wrapper.py' -v").command,
            (Words{"python3", "my wrapper.py", "-v"}));
}

TEST(SystemSpec, TreatsDashAndUnderscoreAlikeInKeys) {
  EXPECT_EQ(parse("port", {"at_bound=absorb", "x=a=b_c"}).options,
            (std::map<std::string, std::string>{{"at-bound", "absorb"}, {"x", "a=b_c"}}));
}

TEST(SystemSpec, RefusesWhatItCannotRead) {
  EXPECT_THROW(parse("udp://x"), UsageError);
  EXPECT_THROW(parse("sim:"), UsageError);
  EXPECT_THROW(parse("exec:  "), UsageError);
  EXPECT_THROW(parse(""), UsageError);
  EXPECT_THROW(parse("port", {"kind"}), UsageError);
  EXPECT_THROW(parse("port", {"=x"}), UsageError);
  EXPECT_THROW(parse("port", {"at-bound=refuse", "at_bound=absorb"}), UsageError);
}

TEST(ShellWords, SplitLikeAShellWithoutExpansion) {
  EXPECT_EQ(split_shell_words(R"(a 'b c' "d \"e\" $HOME" f\ g '' *)"),
            (Words{"a", "b c", "d \"e\" $HOME", "f g", "", "*"}));
  EXPECT_EQ(split_shell_words("  "), Words{});
  EXPECT_THROW(split_shell_words("a 'b"), UsageError);
}

}  // namespace
}  // namespace maide
