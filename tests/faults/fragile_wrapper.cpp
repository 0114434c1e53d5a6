// A wrapper of the SDK whose system dies as a part of its behaviour: a lamp that `press` switches
// on and off, and that `hit` breaks if it is on. How it dies, and how its teardown goes wrong after
// a hit that did it no harm, the options say.
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <condition_variable>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "maide/wire/client/child_process.hpp"
#include "maide/wire/wrapper/system_wrapper.hpp"

namespace {

void block_for_ever() {
  std::mutex mutex;
  std::condition_variable never;
  std::unique_lock lock(mutex);
  never.wait(lock, [] { return false; });
}

// As a library does whose own bookkeeping finds no memory.
void eat_memory() noexcept {
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = rlim_t{1} << 28;
  ::setrlimit(RLIMIT_AS, &limit);
  std::vector<std::unique_ptr<char[]>> eaten;
  while (true) eaten.push_back(std::make_unique_for_overwrite<char[]>(std::size_t{1} << 24));
}

class Lamp : public maide::SystemInstance {
 public:
  Lamp(maide::EventSink& sink, std::string death, std::string teardown, pid_t broker)
      : sink_(sink), death_(std::move(death)), teardown_(std::move(teardown)), broker_(broker) {}

  ~Lamp() override {
    if (!was_hit_) return;
    if (teardown_ == "abort") std::abort();
    if (teardown_ == "corrupt") {
      char* volatile memory = static_cast<char*>(std::malloc(64));
      std::free(memory);
      std::free(memory);
    }
  }

  void call(std::string_view input) override {
    if (input == "press") {
      is_on_ = !is_on_;
      sink_.report(is_on_ ? "on" : "off");
    } else if (!is_on_) {
      was_hit_ = true;
      sink_.report("dull");
    } else {
      sink_.report("dull");  // a dying system's last words: sometimes heard, sometimes not
      die();
    }
  }

  void shutdown() override {
    stopped_ = true;
    if (was_hit_ && teardown_ == "hang") block_for_ever();
  }

 private:
  void die() {
    if (death_ == "abort") std::abort();
    if (death_ == "segfault") ::raise(SIGSEGV);
    if (death_ == "exit") ::_exit(3);
    if (death_ == "kill") ::kill(::getpid(), SIGKILL);
    if (death_ == "memory") eat_memory();
    if (death_ == "seen") sink_.crashed("the bulb burst");
    if (death_ == "broker") ::kill(broker_, SIGKILL);
    while (death_ == "hang" && !stopped_) {
    }
    if (death_ == "stop") ::kill(::getpid(), SIGSTOP);
  }

  maide::EventSink& sink_;
  std::string death_, teardown_;
  pid_t broker_;
  bool is_on_ = false;
  std::atomic<bool> was_hit_ = false, stopped_ = false;
};

class FragileWrapper : public maide::SystemWrapper {
 public:
  FragileWrapper() {
    description_.name = "fragile";
    description_.versions = {{"fragile", "1"}};
    description_.options = {
        maide::OptionSpec::choice(
            "death", "abort",
            {"abort", "segfault", "exit", "kill", "memory", "seen", "broker", "hang", "stop"},
            "what a hit does to a lamp that is on"),
        maide::OptionSpec::choice("teardown", "good", {"good", "abort", "corrupt", "hang"},
                                  "what the teardown of a lamp does that was hit while off"),
    };
  }
  const maide::WrapperDescription& description() const override { return description_; }

  maide::SystemSetup configure(const maide::OptionValues& options) override {
    death_ = options.text("death");
    teardown_ = options.text("teardown");
    maide::SystemSetup setup;
    setup.actors = {"finger", "hammer"};
    setup.inputs = {{"press", "finger", {"on", "off"}}, {"hit", "hammer", {"dull"}}};
    setup.events = {{"on", "finger"}, {"off", "finger"}, {"dull", "hammer"}};
    if (death_ == "broker") {
      broker_ = std::make_unique<maide::ServiceProcess>(
          std::vector<std::string>{"/proc/self/exe", "broker"});
      setup.processes = {broker_->id()};
    }
    return setup;
  }

  std::unique_ptr<maide::SystemInstance> reset(maide::EventSink& sink) override {
    return std::make_unique<Lamp>(sink, death_, teardown_, broker_ ? broker_->id() : 0);
  }

 private:
  maide::WrapperDescription description_;
  std::string death_, teardown_;
  std::unique_ptr<maide::ServiceProcess> broker_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "broker") ::pause();
  FragileWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
