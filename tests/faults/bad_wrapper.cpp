// A wrapper of the SDK whose system does what no system should; which, the options and inputs say.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>

#include "maide/wire/wrapper/system_wrapper.hpp"

namespace {

void block_for_ever() {
  std::mutex mutex;
  std::condition_variable never;
  std::unique_lock lock(mutex);
  never.wait(lock, [] { return false; });
}

class BadInstance : public maide::SystemInstance {
 public:
  BadInstance(maide::EventSink& sink, bool hangs_in_teardown)
      : sink_(sink), hangs_in_teardown_(hangs_in_teardown) {}

  void call(std::string_view input) override {
    if (input == "work") sink_.report("done");
    if (input == "stick") block_for_ever();  // and shutdown() does not help
    if (input == "throw") throw std::runtime_error("the lamp\nfell");
    if (input == "abort") std::abort();
    if (input == "crash") sink_.crashed("the daemon is gone");
    if (input == "invent") sink_.report("rain");
    if (input == "print") std::puts("{\"type\":\"bye\"}");  // to standard output
    while (input == "spin" && !stopped_) {
    }
  }

  void shutdown() override {
    stopped_ = true;
    if (hangs_in_teardown_) block_for_ever();
  }

 private:
  maide::EventSink& sink_;
  bool hangs_in_teardown_;
  std::atomic<bool> stopped_ = false;
};

class BadWrapper : public maide::SystemWrapper {
 public:
  BadWrapper() {
    description_.name = "bad";
    description_.versions = {{"bad", "1"}};
    description_.options = {
        maide::OptionSpec::choice("reset", "good", {"good", "hang", "throw"}, "what a reset does"),
        maide::OptionSpec::choice("teardown", "good", {"good", "hang"}, "what a teardown does"),
    };
  }
  const maide::WrapperDescription& description() const override { return description_; }

  maide::SystemSetup configure(const maide::OptionValues& options) override {
    reset_ = options.text("reset");
    hangs_in_teardown_ = options.is("teardown", "hang");
    maide::SystemSetup setup;
    setup.actors = {"one"};
    for (const char* input :
         {"work", "stick", "throw", "abort", "crash", "invent", "print", "spin"}) {
      setup.inputs.push_back({input, "one", {"done"}});
    }
    setup.events = {{"done", "one"}};
    return setup;
  }

  std::unique_ptr<maide::SystemInstance> reset(maide::EventSink& sink) override {
    if (reset_ == "hang") block_for_ever();
    if (reset_ == "throw") throw std::runtime_error("no more lamps");
    return std::make_unique<BadInstance>(sink, hangs_in_teardown_);
  }

 private:
  maide::WrapperDescription description_;
  std::string reset_;
  bool hangs_in_teardown_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  BadWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
