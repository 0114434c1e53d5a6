// A wrapper in one file: POSIX message queues (mq_overview(7)), the kernel's own middleware. It is
// walked through in docs/writing-a-wrapper.md.
#include <fcntl.h>
#include <mqueue.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <system_error>

#include "maide/wrapper.hpp"

namespace {

// One queue with a writer and a reader: what a word starts with, and what is thrown away after it.
class Queue : public maide::SystemInstance {
 public:
  Queue(const std::string& name, std::int64_t depth, maide::EventSink& sink)
      : sink_(sink), stop_(::eventfd(0, EFD_CLOEXEC)) {
    mq_attr attributes{};
    attributes.mq_maxmsg = depth;
    attributes.mq_msgsize = sizeof(std::uint64_t);
    queue_ = ::mq_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NONBLOCK, 0600, &attributes);
    if (queue_ < 0) throw std::system_error(errno, std::generic_category(), "mq_open");
    ::mq_unlink(name.c_str());  // it lives on until it is closed, and nothing is left behind
  }
  ~Queue() override {
    ::mq_close(queue_);
    ::close(stop_);
  }

  // On the actor's own thread: blocks as long as the real call would.
  void call(std::string_view input) override {
    if (input == "write") {
      const std::uint64_t number = sink_.content(written_ + 1);
      const auto* bytes = reinterpret_cast<const char*>(&number);
      while (::mq_send(queue_, bytes, sizeof number, 0) != 0) {
        if (errno != EAGAIN || !wait_for(POLLOUT)) return;
      }
      ++written_;
      sink_.report("written");
      return;
    }
    std::uint64_t number = 0;
    while (::mq_receive(queue_, reinterpret_cast<char*>(&number), sizeof number, nullptr) < 0) {
      if (errno != EAGAIN) throw std::system_error(errno, std::generic_category(), "mq_receive");
      if (input == "tryread") return sink_.report("null");
      if (!wait_for(POLLIN)) return;
    }
    sink_.message(number);
  }

  // From another thread: every call returns soon, now and later.
  void shutdown() override { ::eventfd_write(stop_, 1); }

 private:
  // False: the instance is being shut down.
  bool wait_for(short events) const {
    std::array<pollfd, 2> files{{{queue_, events, 0}, {stop_, POLLIN, 0}}};
    ::poll(files.data(), files.size(), -1);
    return files[1].revents == 0;
  }

  maide::EventSink& sink_;
  int stop_;
  mqd_t queue_ = -1;
  std::uint64_t written_ = 0;  // the writer's alone
};

class MqueueWrapper : public maide::SystemWrapper {
 public:
  MqueueWrapper() {
    description_.name = "mqueue";
    description_.summary = "A POSIX message queue between a writer and a reader";
    description_.versions = {{"wrapper", "1"}};
    description_.options = {
        maide::OptionSpec::integer("depth", 2, 1, 10, "messages that the queue keeps"),
        maide::common_options::inputs({"write", "read", "tryread"}),
        maide::common_options::observe({"message", "null", "written"}),
        maide::common_options::payload(),
    };
  }
  const maide::WrapperDescription& description() const override { return description_; }

  maide::SystemSetup configure(const maide::OptionValues& options) override {
    depth_ = options.number("depth");
    maide::SystemSetup setup;
    setup.actors = {"writer", "reader"};
    setup.inputs = {{"write", "writer", {"written"}},  // may block until it returns by `written`
                    {"read", "reader", {"message"}},   // may block too
                    {"tryread", "reader", {}}};        // never does
    setup.events = {{"written", "writer"}, {"message", "reader"}, {"null", "reader"}};
    return setup;
  }

  std::unique_ptr<maide::SystemInstance> reset(maide::EventSink& sink) override {
    const std::string name = "/maide-" + std::to_string(::getpid()) + "-" + std::to_string(++word_);
    return std::make_unique<Queue>(name, depth_, sink);
  }

 private:
  maide::WrapperDescription description_;
  std::int64_t depth_ = 0;
  std::uint64_t word_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  MqueueWrapper wrapper;
  return maide::run_wrapper(wrapper, argc, argv);
}
