#include "maide/workflow/suggest_change.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/check/explore/engine.hpp"

namespace maide {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

const std::string folder = MAIDE_SOURCE_DIR "/examples/";

CheckReport check_deadlock(const System& system) {
  NativeEngine engine;
  CheckRequest request;
  request.properties = {"deadlock"};
  return check_system(system, engine, request);
}

Suggestions suggest(const System& system, ModelSource models = {}) {
  SuggestOptions options;
  options.models = std::move(models);
  return suggest_changes(system, check_deadlock(system), options);
}

TEST(SystemVariant, HasOtherCountsAndModels) {
  const System system = read_system(folder + "case-study-1/buffered.yaml");
  std::vector<Repeat> repeats = find_repeats(system);
  ASSERT_EQ(repeats.size(), 2U);
  EXPECT_EQ(repeats[0].count, 6U);
  for (Repeat& repeat : repeats) repeat.count = 12;
  const auto longer = make_variant(system, {repeats, {}});
  ASSERT_TRUE(longer);
  EXPECT_EQ(find_repeats(*longer)[1].count, 12U);
  EXPECT_EQ(longer->models[0].automaton, system.models[0].automaton);
  // A model without the input that programs give is none for this system.
  InterfaceAutomaton other({"press"}, {"message"}, 1);
  EXPECT_FALSE(make_variant(system, {{}, {{"via", other}}}));
  repeats[0].column += 1;
  EXPECT_FALSE(make_variant(system, {repeats, {}}));
}

TEST(SuggestChange, FindsTheModelAndTheBurstThatFits) {
  const Suggestions found = suggest(read_system(folder + "case-study-1/buffered.yaml"));
  EXPECT_GT(found.tried, 4U);
  EXPECT_THAT(found.changes,
              Contains(StartsWith(
                  "via: ../models/strict-6.dot in place of ../models/buffered.dot (checked: ")));
  EXPECT_THAT(found.changes,
              Contains(StartsWith("`repeat 1` in place of `repeat 6` in lines 10 and 15")));
  // A strict port learned for one message in flight is not known to be enough.
  EXPECT_THAT(found.changes, testing::Not(Contains(HasSubstr("via: ../models/strict-1.dot"))));
}

TEST(SuggestChange, FindsTheNumberThatWasMeant) {
  const Suggestions found = suggest(read_system(folder + "case-study-2/90-100-100-size-1.yaml"));
  EXPECT_THAT(found.changes,
              Contains(StartsWith("`repeat 100` in place of `repeat 90` in line 8")));
}

}  // namespace
}  // namespace maide
