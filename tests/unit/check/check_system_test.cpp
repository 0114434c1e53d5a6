// What check_system makes of an engine's answers; the engine here is one that breaks.
#include "maide/check/explore/check_system.hpp"

#include <gtest/gtest.h>

#include <new>
#include <set>
#include <stdexcept>

#include "maide/check/explore/engine.hpp"
#include "systems.hpp"

namespace maide {
namespace {

// The native engine, but for the properties of some names and for the search for runs beyond what
// was learned, if told so.
class BreakingEngine : public Engine {
 public:
  std::set<std::string> breaks_on;
  bool breaks_on_cut = false;
  bool is_out_of_memory = false;

  std::string name() const override { return "breaking"; }
  std::string obstacle(const Property&) const override { return ""; }
  PropertyResult check(const System& system, const Property& property,
                       const EngineOptions& options) override {
    if (breaks_on.contains(property.name)) {
      if (is_out_of_memory) throw std::bad_alloc();
      throw std::logic_error("the search lost a node");
    }
    return native_.check(system, property, options);
  }
  CutResult find_cut(const System& system, const EngineOptions& options) override {
    if (breaks_on_cut) throw std::logic_error("the run to the bound does not replay");
    return native_.find_cut(system, options);
  }

 private:
  NativeEngine native_;
};

// `reads` holds, `writes` is violated, and nothing deadlocks.
System talking() {
  return test::system_of("  p: loop { sync.write; sync.read -> message; }\n",
                         "  reads: G F sync.read\n  writes: G !sync.write\n");
}

CheckReport check(BreakingEngine& engine, const std::vector<std::string>& properties) {
  CheckRequest request;
  request.properties = properties;
  return check_system(talking(), engine, request);
}

TEST(CheckSystem, AnInternalErrorHidesNoOtherVerdict) {
  BreakingEngine engine;
  engine.breaks_on = {"reads"};
  const CheckReport report = check(engine, {"reads", "writes", "deadlock"});
  ASSERT_EQ(report.properties.size(), 3U);
  EXPECT_EQ(report.properties[0].name, "reads");
  EXPECT_EQ(report.properties[0].verdict, Verdict::inconclusive);
  EXPECT_EQ(report.properties[0].reason,
            "internal error: the search lost a node (please report it)");
  EXPECT_EQ(report.properties[1].verdict, Verdict::violated);
  EXPECT_EQ(report.properties[2].verdict, Verdict::holds);
  EXPECT_EQ(report.verdict, Verdict::violated);
  EXPECT_EQ(exit_status_of(report), ExitStatus::violated);
}

TEST(CheckSystem, AnInternalErrorIsExitStatusFive) {
  BreakingEngine engine;
  engine.breaks_on = {"reads"};
  const CheckReport report = check(engine, {"reads", "deadlock"});
  EXPECT_EQ(report.verdict, Verdict::inconclusive);
  EXPECT_EQ(exit_status_of(report), ExitStatus::internal);
  EXPECT_EQ(static_cast<int>(ExitStatus::internal), 5);
  engine.breaks_on.clear();
  EXPECT_EQ(exit_status_of(check(engine, {"reads", "deadlock"})), ExitStatus::ok);
}

// A "holds" that could not be looked into is none.
TEST(CheckSystem, AnErrorBehindAVerdictUndoesIt) {
  BreakingEngine engine;
  engine.breaks_on_cut = true;
  const CheckReport report = check(engine, {"reads"});
  EXPECT_EQ(report.properties[0].verdict, Verdict::inconclusive);
  EXPECT_TRUE(report.properties[0].is_internal_error);
}

TEST(CheckSystem, MemoryThatIsOutIsNoInternalError) {
  BreakingEngine engine;
  engine.breaks_on = {"reads"};
  engine.is_out_of_memory = true;
  EXPECT_THROW(check(engine, {"reads"}), std::bad_alloc);
}

}  // namespace
}  // namespace maide
