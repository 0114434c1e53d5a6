// Systems as people name them.
#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/experiment/open_system.hpp"

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

// What a model keeps of its system leads back there.
TEST(SystemSpec, AnOriginCanBeReadAgain) {
  const Words options{"payload=a b", "text=it's", "size=3"};
  for (const std::string name : {"sim:my models/a.dot", "exec:./wrap 'x y'", "port"}) {
    const SystemSpec spec = parse_system_spec(name, options);
    const Words words = split_shell_words(origin_of(spec, spec.options));
    const SystemSpec again = parse_system_spec(words.front(), std::span(words).subspan(1));
    EXPECT_EQ(again.text, spec.text);
    EXPECT_EQ(again.command, spec.command);
    EXPECT_EQ(again.options, spec.options);
  }
}

}  // namespace
}  // namespace maide
