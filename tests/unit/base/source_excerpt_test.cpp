// The line of a file in which something is wrong.
#include <gtest/gtest.h>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"

namespace maide {
namespace {

class SourceExcerpt : public testing::Test {
 protected:
  std::string excerpt(const std::string& text, int line, int column) {
    const std::string path = folder_.path() / "f.yaml";
    write_file_atomically(path, text);
    return source_excerpt({path, line, column});
  }
  TempDir folder_;
};

TEST_F(SourceExcerpt, PutsACaretUnderThePlace) {
  EXPECT_EQ(excerpt("one\n  two three\n", 2, 7), "    two three\n        ^\n");
  EXPECT_EQ(excerpt("one", 1, 1), "  one\n  ^\n");
  EXPECT_EQ(excerpt("one\r\ntwo", 1, 4), "  one\n     ^\n");  // behind the end
}

TEST_F(SourceExcerpt, KeepsColumnsUnderTabsAndLetters) {
  EXPECT_EQ(excerpt("\ta x", 1, 4), "  \ta x\n  \t  ^\n");
  EXPECT_EQ(excerpt("\xc3\xa4\xc3\xb6 x", 1, 6), "  \xc3\xa4\xc3\xb6 x\n     ^\n");
  EXPECT_EQ(excerpt("a\x1b[31mb", 1, 1), "  a?[31mb\n  ^\n");
  EXPECT_EQ(excerpt("\xc2\x9b"
                    "31m\xff x",
                    1, 8),
            "  ?31m? x\n        ^\n");
}

TEST_F(SourceExcerpt, PassesTheByteOrderMark) {
  EXPECT_EQ(excerpt("\xEF\xBB\xBFone two\n", 1, 5), "  one two\n      ^\n");
}

TEST_F(SourceExcerpt, CutsLongLines) {
  const std::string text = excerpt(std::string(5000, 'a') + "b" + std::string(5000, 'c'), 1, 5001);
  EXPECT_EQ(text, "  " + std::string(70, 'a') + "b" + std::string(29, 'c') + "\n  " +
                      std::string(70, ' ') + "^\n");
}

TEST_F(SourceExcerpt, IsEmptyWhereThePlaceIsNotKnown) {
  EXPECT_EQ(excerpt("one\n", 5, 1), "");
  EXPECT_EQ(excerpt("one\n", 1, 9), "");
  EXPECT_EQ(excerpt("one\n", 1, 0), "");
  EXPECT_EQ(excerpt("one\n", 0, 0), "");
  EXPECT_EQ(source_excerpt({(folder_.path() / "none").string(), 1, 1}), "");
}

}  // namespace
}  // namespace maide
