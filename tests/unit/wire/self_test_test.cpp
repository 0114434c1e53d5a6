// --self-test of a wrapper: one line that says what was found, or one that says what is wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>

#include "maide/base/error.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"
#include "port_wrapper.hpp"

namespace maide {
namespace {

TEST(SelfTest, SaysWhatItFound) {
  port::PortWrapper wrapper;
  EXPECT_EQ(run_self_test(wrapper), "port 1: write -> quiet, read -> message");
}

// A system with one input, whose call is given.
class OneCall : public SystemWrapper {
 public:
  using Call = std::function<void(EventSink&)>;
  explicit OneCall(Call call) : call_(std::move(call)) {
    description_.name = "one-call";
    description_.versions = {{"one-call", "7"}};
  }
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues&) override {
    SystemSetup setup;
    setup.actors = {"actor"};
    setup.inputs = {{"poke", "actor", {}}};
    setup.events = {{"done", "actor"}};
    return setup;
  }
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override {
    if (!call_) throw std::runtime_error("no broker at localhost");
    return std::make_unique<Instance>(call_, sink);
  }

 private:
  struct Instance : SystemInstance {
    Instance(const Call& called, EventSink& events) : call_(called), sink_(events) {}
    void call(std::string_view) override { call_(sink_); }
    void shutdown() override {}
    const Call& call_;
    EventSink& sink_;
  };
  WrapperDescription description_;
  Call call_;
};

std::string failure_of(OneCall wrapper) {
  try {
    run_self_test(wrapper);
  } catch (const WrapperError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(SelfTest, SaysWhatIsWrong) {
  EXPECT_EQ(failure_of(OneCall([](EventSink& sink) { sink.report("done"); })), "no failure");
  EXPECT_EQ(failure_of(OneCall(nullptr)), "no broker at localhost (one-call 7)");
  EXPECT_EQ(failure_of(OneCall([](EventSink&) {})),
            "nothing was observed: poke -> quiet (one-call 7)");
  EXPECT_EQ(failure_of(OneCall([](EventSink&) { throw std::runtime_error("refused"); })),
            "refused (one-call 7)");
  EXPECT_THAT(failure_of(OneCall([](EventSink& sink) { sink.crashed("signal 11"); })),
              testing::HasSubstr("the system died"));
}

}  // namespace
}  // namespace maide
