// A session whose system cannot be shut down says so, and ends without harm.
#include "maide/wire/wrapper/wrapper_session.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "maide/base/error.hpp"

namespace maide {
namespace {

class NeverShutDown : public SystemWrapper {
 public:
  NeverShutDown() { description_.name = "never-shut-down"; }
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues&) override {
    SystemSetup setup;
    setup.actors = {"actor"};
    setup.inputs = {{"poke", "actor", {}}};
    setup.events = {{"done", "actor"}};
    return setup;
  }
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override {
    return std::make_unique<Instance>(sink);
  }

 private:
  struct Instance : SystemInstance {
    explicit Instance(EventSink& events) : sink(events) {}
    void call(std::string_view) override { sink.report("done"); }
    void shutdown() override { throw std::runtime_error("the port is not mine"); }
    EventSink& sink;
  };
  WrapperDescription description_;
};

// Its protocol has timers only over a network.
class WithNetwork : public NeverShutDown {
 public:
  SystemSetup configure(const OptionValues& options) override {
    SystemSetup setup = NeverShutDown::configure(options);
    setup.floor = std::chrono::milliseconds(40);
    return setup;
  }
};

TEST(WrapperSession, ASetupSetsTheDefaultOfTheFloorButNotTheUsersWord) {
  WithNetwork wrapper;
  EXPECT_EQ(LocalSul(wrapper).info().options.at("floor"), "40");
  EXPECT_EQ(LocalSul(wrapper, {{"floor", "7"}}).info().options.at("floor"), "7");
}

TEST(WrapperSession, AShutdownThatThrowsIsAnErrorOfTheNextWord) {
  NeverShutDown wrapper;
  LocalSul sul(wrapper);
  std::size_t answers = 0;
  const std::vector<SulQuery> batch(2, {Word{0}, Translation::eager});
  try {
    sul.run(batch, [&](std::size_t, const SulAnswer&) { ++answers; }, {});
    FAIL() << "nobody noticed";
  } catch (const WrapperError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("the port is not mine"));
  }
  EXPECT_EQ(answers, 1U);
}

TEST(WrapperSession, MayEndWhenTheShutdownThrows) {
  NeverShutDown wrapper;
  LocalSul sul(wrapper);
  const std::vector<SulQuery> batch(1, {Word{0}, Translation::eager});
  sul.run(batch, [](std::size_t, const SulAnswer& answer) { EXPECT_EQ(answer.steps.size(), 1U); },
          {});
}

// Counts its instances; the reset of some fails, and some have crashed before their first input.
class Counted : public SystemWrapper {
 public:
  Counted() { description_.name = "counted"; }
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues&) override {
    SystemSetup setup;
    setup.actors = {"actor"};
    setup.inputs = {{"poke", "actor", {}}};
    setup.events = {{"done", "actor"}};
    return setup;
  }
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override {
    ++resets;
    if (fails) throw std::runtime_error("no such port");
    if (resets == crashes_at) sink.crashed("out of memory");
    return std::make_unique<Instance>(sink);
  }
  int resets = 0;
  int crashes_at = 0;
  bool fails = false;

 private:
  struct Instance : SystemInstance {
    explicit Instance(EventSink& events) : sink(events) {}
    void call(std::string_view) override { sink.report("done"); }
    void shutdown() override {}
    EventSink& sink;
  };
  WrapperDescription description_;
};

class PreparedSession : public testing::Test {
 protected:
  PreparedSession() : session(wrapper) { session.configure({}); }
  SulAnswer run() {
    return session.run({Word{0}, Translation::eager}, [] { return false; });
  }
  Counted wrapper;
  WrapperSession session;
};

TEST_F(PreparedSession, MakesTheNextInstanceOnceAndNobodyWaitsForIt) {
  session.prepare();
  session.prepare();
  EXPECT_EQ(wrapper.resets, 1);
  const SulAnswer first = run();
  EXPECT_EQ(wrapper.resets, 1);
  EXPECT_EQ(first.steps.at(0).events, (std::vector<Event>{{0, "done"}}));
  EXPECT_EQ(first.reset_wait.count(), 0);
  // An instance that has played a word serves no other.
  run();
  EXPECT_EQ(wrapper.resets, 2);
  session.prepare();
  EXPECT_EQ(wrapper.resets, 3);
}

TEST_F(PreparedSession, AQueryThatWaitedDuringTheResetSaysSo) {
  const auto arrived = std::chrono::steady_clock::now();
  session.prepare();
  const SulAnswer answer = session.run(
      {Word{0}, Translation::eager}, [] { return false; }, arrived);
  EXPECT_GE(answer.reset_wait, answer.reset_duration);
}

TEST_F(PreparedSession, AnInstanceThatCannotBeMadeIsTheNextQuerysError) {
  wrapper.fails = true;
  session.prepare();
  EXPECT_EQ(wrapper.resets, 1);
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_EQ(wrapper.resets, 2);
  wrapper.fails = false;
  EXPECT_EQ(run().steps.size(), 1U);
}

TEST_F(PreparedSession, AnInstanceThatDiedBeforeItsFirstInputIsMadeAnew) {
  wrapper.crashes_at = 1;
  session.prepare();
  EXPECT_EQ(run().end, WordEnd::complete);
  EXPECT_EQ(wrapper.resets, 2);
}

// `pub-KEY` and `sub-KEY` are what KEY says, unless one of them is named.
TEST(OptionsOfEachEnd, AreThoseOfBothUnlessNamed) {
  const std::vector<OptionSpec> table = common_options::with_each_end(
      {OptionSpec::integer("depth", 1, 1, 9, "kept").keeping_more_with("+")});
  ASSERT_EQ(table.size(), 3U);
  EXPECT_EQ(table[1].key, "pub-depth");
  EXPECT_EQ(table[2].help, "of the reader alone; both: as depth says");
  EXPECT_EQ(table[2].keeps_more, "");
  const OptionValues values(table, {{"depth", "5"}, {"sub_depth", "2"}});
  EXPECT_EQ(values.of_end("pub-", "depth"), "5");
  EXPECT_EQ(values.of_end("sub-", "depth"), "2");
  EXPECT_THROW(OptionValues(table, {{"pub-depth", "10"}}), UsageError);
}

TEST(OptionsOfTime, AreRefusedWithTheReason) {
  const std::vector<OptionSpec> table{OptionSpec::integer("depth", 1, 1, 9, "kept")};
  for (const char* key : {"lifespan", "deadline", "sub_deadline", "pub-liveliness"}) {
    try {
      OptionValues(table, {{key, "100"}});
      ADD_FAILURE() << key;
    } catch (const UsageError& error) {
      EXPECT_EQ(error.what(), "option '" + std::string(key) + "' is refused: time is not modelled");
    }
  }
}

}  // namespace
}  // namespace maide
