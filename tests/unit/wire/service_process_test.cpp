// A system of two processes: the wrapper's, and a service that answers after some work of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "busy_machine.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/observe/thread_scan.hpp"
#include "maide/wire/wrapper/wrapper_session.hpp"

namespace maide {
namespace {

using namespace std::chrono_literals;

// Takes one connection after the other; answers each byte after some computing.
constexpr const char* service = R"(
import socket, sys
listener = socket.create_server(("127.0.0.1", int(sys.argv[1])))
while True:
    client, _ = listener.accept()
    while True:
        request = client.recv(1)
        if not request:
            break
        sum(range(20000))
        client.sendall(request)
)";

std::vector<std::string> python(const std::string& script, std::uint16_t port) {
  return {"python3", "-c", script, std::to_string(port)};
}

Descriptor connect_to(std::uint16_t port) {
  Descriptor client(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  if (::connect(client.get(), reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
    throw std::runtime_error("the service takes no connection");
  }
  return client;
}

// One input `ask`, which returns at once; the service's reply comes as the event `reply`.
class AskingWrapper : public SystemWrapper {
 public:
  AskingWrapper() { description_.name = "asking"; }
  const WrapperDescription& description() const override { return description_; }
  SystemSetup configure(const OptionValues&) override {
    port_ = free_loopback_port();
    service_.emplace(python(service, port_));
    service_->wait_for_tcp(port_, 60s);
    SystemSetup setup;
    setup.actors = {"client"};
    setup.inputs = {{"ask", "client", {}}};
    setup.events = {{"reply", "client"}};
    setup.processes = {service_->id()};
    return setup;
  }
  std::unique_ptr<SystemInstance> reset(EventSink& sink) override {
    return std::make_unique<Instance>(sink, port_);
  }
  pid_t service_id() const { return service_->id(); }

 private:
  class Instance : public SystemInstance {
   public:
    Instance(EventSink& sink, std::uint16_t port)
        : socket_(connect_to(port)), listener_([this, &sink] {
            char reply = 0;
            while (::recv(socket_.get(), &reply, 1, 0) == 1) sink.report("reply");
          }) {}
    ~Instance() override { listener_.join(); }
    void call(std::string_view) override {
      // The service may be dead already.
      static_cast<void>(::send(socket_.get(), "?", 1, MSG_NOSIGNAL));
    }
    void shutdown() override { ::shutdown(socket_.get(), SHUT_RDWR); }

   private:
    Descriptor socket_;
    std::thread listener_;
  };

  WrapperDescription description_;
  std::uint16_t port_ = 0;
  std::optional<ServiceProcess> service_;
};

TEST(ServiceProcess, QuiescenceWaitsForItsWork) {
  AskingWrapper wrapper;
  LocalSul sul(wrapper);
  const test::BusyMachine load(2);
  const std::vector<SulQuery> batch(50, {Word{0, 0, 0, 0}, Translation::eager});
  std::size_t replies = 0;
  sul.run(batch,
          [&](std::size_t, const SulAnswer& answer) {
            for (const SulStep& step : answer.steps) replies += step.events.size();
          },
          {});
  EXPECT_EQ(replies, 200U);
}

TEST(ServiceProcess, ItsDeathEndsTheWord) {
  AskingWrapper wrapper;
  LocalSul sul(wrapper);
  const std::vector<SulQuery> batch(2, {Word{0}, Translation::eager});
  std::size_t answers = 0;
  try {
    sul.run(batch,
            [&](std::size_t, const SulAnswer&) {
              ++answers;
              ::kill(wrapper.service_id(), SIGKILL);
            },
            {});
    FAIL() << "nobody noticed";
  } catch (const WrapperError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("was killed by signal 9"));
  }
  EXPECT_EQ(answers, 1U);
}

TEST(ServiceProcess, ItsThreadsAreSeen) {
  ServiceProcess asleep({"cat"});
  ServiceProcess busy({"sh", "-c", "while :; do :; done"});
  ThreadScan scan;
  scan.watch_process(asleep.id());
  bool rests = false;
  while (!rests) rests = scan.begin() && scan.end();  // once it has started
  scan.watch_process(busy.id());
  for (int look = 0; look < 100; ++look) EXPECT_FALSE(scan.begin() && scan.end());
}

TEST(ServiceProcess, SaysWhyItIsNotThere) {
  ServiceProcess loud({"sh", "-c", "echo \"no room for $WHAT\" >&2; exit 3"}, {{"WHAT", "you"}});
  try {
    loud.wait_for_tcp(free_loopback_port(), 60s);
    FAIL() << "it never listened";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("sh exited with status 3"));
  }
  EXPECT_TRUE(loud.has_ended());
  EXPECT_THROW(ServiceProcess({"/nowhere/at/all"}), std::runtime_error);
}

// What it prints must not fill a pipe that nobody reads: 1 MB is more than one holds.
TEST(ServiceProcess, MayPrintAsMuchAsItLikes) {
  ServiceProcess loud(
      {"sh", "-c", "yes | head -c 1000000 | tee /dev/stderr; echo done >&2; exec sleep 1000"});
  while (loud.last_error_line() != "done") {
    ASSERT_FALSE(loud.has_ended());
    std::this_thread::sleep_for(1ms);
  }
}

}  // namespace
}  // namespace maide
