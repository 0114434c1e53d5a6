// The options of wrappers: what is allowed, what is said of what is not, the rows that all share.
#include "maide/wire/wrapper/wrapper_options.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "maide/base/error.hpp"

namespace maide {
namespace {

using testing::ElementsAre;

const std::vector<OptionSpec> table{
    OptionSpec::choice("kind", "strict", {"port", "strict"}, "which"),
    OptionSpec::choice("payload", "none", {"none", "values:V,..."}, "what"),
    common_options::inputs({"write", "read"}),
    common_options::observe({"message", "quiet"}),
    OptionSpec::integer("queue-size", 3, 1, 9, "how many", {"all"}),
    OptionSpec::text("name", "", "any"),
};

// What is said when this is given; "" if it is taken.
std::string refusal(const std::map<std::string, std::string>& given) {
  try {
    OptionValues values(table, given);
    return "";
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST(OptionSpec, SaysWhatIsAllowed) {
  const std::vector<std::string> expected{"port|strict",        "none|values:V,...",
                                          "some of write,read", "some of message,quiet",
                                          "all|1..9",           "text"};
  for (std::size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(table[i].describe_allowed(), expected[i]) << table[i].key;
  }
  EXPECT_EQ(OptionSpec::integer("n", 0, 5, 5, "").describe_allowed(), "5..5");
}

TEST(OptionSpec, KeepsMoreWithAValue) {
  const OptionSpec row = common_options::size(3, 9).keeping_more_with("+");
  EXPECT_EQ(row.keeps_more, "+");
  EXPECT_EQ(row.key, "size");
}

// A program may set the limits of these rows; by themselves they allow no number.
TEST(OptionSpec, HasLimitsForNumbersAlone) {
  for (const OptionSpec& row :
       {OptionSpec::choice("a", "b", {"b"}, ""), OptionSpec::list("a", "", {"b"}, ""),
        OptionSpec::text("a", "", "")}) {
    EXPECT_EQ(row.least, 0);
    EXPECT_EQ(row.most, -1);
  }
}

TEST(OptionValues, HaveDefaults) {
  const OptionValues values(table, {});
  EXPECT_EQ(values.all(), (std::map<std::string, std::string>{{"kind", "strict"},
                                                              {"payload", "none"},
                                                              {"inputs", "write,read"},
                                                              {"observe", "message"},
                                                              {"queue-size", "3"},
                                                              {"name", ""}}));
}

TEST(OptionValues, AreFoundByEitherSpelling) {
  const OptionValues values(table, {{"queue_size", "5"}, {"inputs", "read"}});
  EXPECT_EQ(values.all().at("queue-size"), "5");
  EXPECT_EQ(values.number("queue-size"), 5);
  EXPECT_EQ(values.text("queue_size"), "5");
  EXPECT_TRUE(values.has("queue_size"));
  EXPECT_FALSE(values.has("queue"));
  EXPECT_TRUE(values.is("kind", "strict"));
  EXPECT_FALSE(values.is("kind", "port"));
  EXPECT_THAT(values.list("inputs"), ElementsAre("read"));
  EXPECT_THAT(values.list("name"), ElementsAre());
  EXPECT_THROW(values.text("size"), std::logic_error);
  EXPECT_THROW(values.number("kind"), std::logic_error);
  EXPECT_TRUE(same_key("a-b_c", "a_b-c"));
  EXPECT_FALSE(same_key("a-b", "a-c"));
}

TEST(OptionValues, RefuseWhatIsNotAllowed) {
  EXPECT_EQ(refusal({{"kind", "port"}, {"queue-size", "1"}, {"name", "any text"}}), "");
  EXPECT_EQ(refusal({{"queue-size", "9"}}), "");
  EXPECT_EQ(refusal({{"queue-size", "all"}}), "");
  EXPECT_EQ(refusal({{"queue-size", "0"}}), "option queue-size=0: allowed is all|1..9");
  EXPECT_EQ(refusal({{"queue-size", "10"}}), "option queue-size=10: allowed is all|1..9");
  EXPECT_EQ(refusal({{"queue-size", "1x"}}), "option queue-size=1x: allowed is all|1..9");
  EXPECT_EQ(refusal({{"kind", "strikt"}}),
            "option kind=strikt: allowed is port|strict; did you mean 'strict'?");
  EXPECT_EQ(refusal({{"kind", "0"}}), "option kind=0: allowed is port|strict");
  EXPECT_EQ(refusal({{"kind", "-1"}}), "option kind=-1: allowed is port|strict");
  EXPECT_EQ(refusal({{"kind", ""}}), "option kind=: allowed is port|strict");
  EXPECT_EQ(refusal({{"name", "two\nlines"}}), "option name=...: one line");
  EXPECT_EQ(refusal({{"name", "two\rlines"}}), "option name=...: one line");
}

TEST(OptionValues, RefuseListsThatAreNone) {
  EXPECT_EQ(refusal({{"inputs", "write"}, {"observe", ""}}), "");
  EXPECT_EQ(refusal({{"inputs", ""}}), "option inputs=: name at least one");
  EXPECT_EQ(refusal({{"inputs", "read,write,read"}}),
            "option inputs=read,write,read: 'read' comes twice");
  EXPECT_EQ(refusal({{"inputs", "write,raed"}}),
            "option inputs=write,raed: 'raed' is not one of write,read; did you mean 'read'?");
}

TEST(OptionValues, RefuseValuesThatAreNoWords) {
  for (const char* good : {"values:a", "values:a,b", "values:A-z_09,0"}) {
    EXPECT_EQ(refusal({{"payload", good}}), "") << good;
  }
  for (const char* bad : {"values:", "values:a,a", "values:a,", "values:a b", "value:a", "values",
                          "values:a.b", "valuesa"}) {
    EXPECT_NE(refusal({{"payload", bad}}), "") << bad;
  }
}

TEST(OptionValues, RefuseUnknownKeysAndThoseGivenTwice) {
  EXPECT_EQ(refusal({{"queue-size", "1"}, {"queue_size", "1"}}),
            "option 'queue-size' is given twice");
  EXPECT_EQ(refusal({{"kid", "port"}}), "unknown option 'kid'; did you mean 'kind'?");
  EXPECT_EQ(refusal({{"zzzzzz", "port"}}),
            "unknown option 'zzzzzz'; known are: kind, payload, inputs, observe, queue-size, name");
}

// Quality of service by the clock, of an end or of both.
TEST(OptionValues, RefuseTime) {
  for (const std::string key : {"deadline", "lifespan", "liveliness", "latency-budget", "lease"}) {
    for (const std::string prefix : {"", "pub-", "sub-", "sub_"}) {
      EXPECT_EQ(refusal({{prefix + key, "1"}}),
                "option '" + prefix + key + "' is refused: time is not modelled");
    }
  }
  EXPECT_EQ(refusal({{"latency_budget", "1"}}),
            "option 'latency_budget' is refused: time is not modelled");
  EXPECT_NE(refusal({{"lub-lease", "1"}}), "option 'lub-lease' is refused: time is not modelled");
}

TEST(OptionValues, OfOneEndAreItsOwnOrThoseOfBoth) {
  const std::vector<OptionSpec> rows = common_options::with_each_end(
      {OptionSpec::integer("depth", 10, 1, 99, "how deep").keeping_more_with("+")});
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].keeps_more, "+");
  EXPECT_EQ(rows[2].keeps_more, "");
  EXPECT_EQ(to_string(rows),
            "depth=10\n    how deep (1..99)\n"
            "pub-depth=both\n    of the writer alone; both: as depth says (both|1..99)\n"
            "sub-depth=both\n    of the reader alone; both: as depth says (both|1..99)\n");
  const OptionValues values(rows, {{"depth", "7"}, {"sub-depth", "3"}});
  EXPECT_EQ(values.of_end("pub-", "depth"), "7");
  EXPECT_EQ(values.of_end("sub-", "depth"), "3");
}

TEST(OptionValues, HaveListsBehindAWord) {
  const auto behind = [](const std::string& value) {
    return OptionValues({OptionSpec::text("payload", value, "")}, {})
        .list_behind("payload", "values");
  };
  EXPECT_THAT(behind("values:a,b"), ElementsAre("a", "b"));
  EXPECT_THAT(behind("values:"), ElementsAre());
  EXPECT_THAT(behind("values"), ElementsAre());
  EXPECT_THAT(behind("valuesa:b"), ElementsAre());
  EXPECT_THAT(behind("value"), ElementsAre());
}

// As `--list-options` prints them.
TEST(CommonOptions, AreTheSameForAllWrappers) {
  std::vector<OptionSpec> rows = common_options::ends();
  for (OptionSpec& row : common_options::quiescence_rows(2)) rows.push_back(std::move(row));
  rows.push_back(common_options::size(3, 9));
  rows.push_back(common_options::at_bound());
  rows.push_back(common_options::payload());
  rows.push_back(common_options::inputs({"write", "read", "tryread"}));
  rows.push_back(common_options::observe({"message", "gap"}));
  EXPECT_EQ(to_string(rows), R"(writers=1
    ends that write: write, write2, ... (1..4)
readers=1
    ends that read: read, read2, ... (1..4)
quiescence=observed
    how the end of a step is known: the system's threads are observed, or a fixed delay in ms (observed|0..60000)
floor=2
    ms after the last event before a step may end (0..60000)
step-limit=5000
    ms that a step, or a reset, may take before it counts as hung (1..600000)
size=3
    learn for at most this many messages in flight (1..9)
at-bound=refuse
    an input beyond size: left unexplored, or drawn as a self-loop (refuse|absorb)
payload=none
    gap: a message says whether one before it was lost (next, gap); values: messages carry one of these, as in write(V) and message(V) (none|gap|values:V,...)
inputs=write,read
    the inputs to learn over (some of write,read,tryread)
observe=message
    the events that are outputs; others are not seen (some of message,gap)
)");
}

}  // namespace
}  // namespace maide
