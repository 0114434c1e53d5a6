// Lists of names and actors in one line of text: whatever a name holds, it comes back.
#include "maide/formats/names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/formats/dot_syntax.hpp"

namespace maide {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Names, PlainListsReadAsTheyLook) {
  EXPECT_THAT(split_names("write, tryread ,read"), ElementsAre("write", "tryread", "read"));
  EXPECT_THAT(split_names("  "), IsEmpty());
  const std::vector<std::string> names{"write", "try read"};
  EXPECT_EQ(join_names(names), "write,try read");
}

TEST(Names, StrangeNamesRoundTrip) {
  const std::vector<std::string> names{"a,b",         " edge ", "\"quoted\"", "back\\slash",
                                       "in \"side\"", "zwölf",  "new\nline",  "\\",
                                       "\"",          ","};
  EXPECT_EQ(split_names(join_names(names)), names);
}

TEST(Names, BrokenListsAreRefused) {
  for (const char* text : {"a,", ",a", "a,,b", "\"a", "\"a\"b", "\"\""}) {
    EXPECT_THROW(split_names(text), UsageError) << text;
  }
}

TEST(Names, LongTextIsCutBetweenCharacters) {
  const std::string text = std::string(59, 'x') + "ö and more";
  EXPECT_EQ(shown(text), "'" + std::string(59, 'x') + "...'");
  EXPECT_EQ(shown("a\nb"), "'a b'");
}

TEST(ActorsText, RoundTrips) {
  const std::vector<Actor> actors{{"writer", {"write"}, {"written"}},
                                  {"the reader:", {"read", "try;read"}, {"mess age", "!"}},
                                  {"idle", {}, {}}};
  EXPECT_EQ(actors_from_text(actors_to_text(actors)), actors);
  EXPECT_THAT(actors_from_text(""), IsEmpty());
}

TEST(ActorsText, ReadsTheFormPeopleWrite) {
  const std::vector<Actor> expected{{"writer", {"write"}, {"written"}},
                                    {"reader", {"read", "tryread"}, {"message", "null"}}};
  EXPECT_EQ(actors_from_text("writer: ?write !written; reader:?read ?tryread !message !null"),
            expected);
}

TEST(ActorsText, BrokenTextIsRefused) {
  for (const char* text : {"writer", "writer: write", ": ?a", "a: ?", "a: ?b c", "a: \"b"}) {
    EXPECT_THROW(actors_from_text(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace maide
