// Lists of words as a shell has them.
#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

using Words = std::vector<std::string>;

TEST(ShellWords, SplitLikeAShellWithoutExpansion) {
  EXPECT_EQ(split_shell_words(R"(a 'b c' "d \"e\" $HOME" f\ g '' *)"),
            (Words{"a", "b c", "d \"e\" $HOME", "f g", "", "*"}));
  EXPECT_EQ(split_shell_words("  "), Words{});
  EXPECT_THROW(split_shell_words("a 'b"), UsageError);
}

TEST(ShellWords, AQuotedWordComesBackAsItWas) {
  for (const std::string word :
       {"", "plain", "a b", "it's", "\"", "a\\b", "''", "tab\tnewline\n"}) {
    EXPECT_EQ(split_shell_words("x " + quote_shell_word(word) + " y"), (Words{"x", word, "y"}));
  }
  EXPECT_EQ(quote_shell_word("depth=3"), "depth=3");
}

}  // namespace
}  // namespace maide
