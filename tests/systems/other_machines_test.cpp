// Wrappers on other machines, as processes of this one: launched by a command, or dialling in. The
// run is the one of a single wrapper, whoever comes late or is killed.
#include "maide/experiment/other_machines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <future>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/protocol/tcp.hpp"
#include "processes.hpp"

namespace maide {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;

const std::string port_program = MAIDE_BINARY_DIR "/bin/maide-wrap-port";
const std::vector<std::string> small_port{"kind=strict", "size=4", "payload=gap"};

OpenedSystem open_port(const SystemAccess& access, const std::string& sul = "port",
                       const std::vector<std::string>& options = small_port) {
  return open_system(parse_system_spec(sul, options), access);
}

OpenedSystem open_alone() { return open_port(SystemAccess(), "exec:" + port_program); }

struct LearningRun {
  std::string model;
  std::uint64_t words, symbols, resets, cache_hits;
  std::string cache;  // the file's bytes
  auto operator<=>(const LearningRun&) const = default;
};

LearningRun run_learning(const OpenedSystem& system, std::uint64_t seed = 1,
                         ExperimentOptions options = {}) {
  const TempDir folder;
  options.testing.seed = seed;
  options.cache_file = folder.path() / "cache";
  const LearnedModel learned = learn_model(*system.sul, Translation::eager, options);
  const ExperimentResult& run = learned.experiment;
  if (run.error) std::rethrow_exception(run.error);
  std::ostringstream text;
  write_dot(text, *learned.model);
  return {text.str(), run.experiments, run.symbols,
          run.resets, run.cache_hits,  read_file(options.cache_file)};
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return std::to_string(static_cast<int>(error.status())) + " " + error.what();
  }
  return "no error";
}

bool comes_true(const std::function<bool()>& condition) {
  for (int round = 0; round < 1000; ++round) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

// ---- Launched ----

class Launched : public testing::Test {
 protected:
  std::string write_hosts(const std::string& text) {
    const std::string path = folder_.path() / "hosts";
    std::ofstream(path) << text;
    return path;
  }
  SystemAccess access(const std::string& hosts, const std::string& launch) {
    SystemAccess access;
    access.launch = launch;
    access.hosts_file = write_hosts(hosts);
    return access;
  }
  // A host is a file with the number of its process; one that has a file HOST.down is down.
  SystemAccess mortal_hosts(const std::string& hosts) {
    return access(hosts, "sh -c 'cd " + folder_.path().string() +
                             "; test -e {host}.down && exit 9; echo $$ > {host}; exec " +
                             MAIDE_BINARY_DIR "/bin/{wrapper}'");
  }
  void pull_the_plug(const std::string& host) {
    std::ofstream(folder_.path() / (host + ".down")) << "down\n";
    kill(host);
  }
  void kill(const std::string& host) {
    ::kill(std::stoi(read_file(folder_.path() / host)), SIGKILL);
  }

  TempDir folder_;
};

TEST_F(Launched, TheRunIsTheSameOnSeveralHosts) {
  const auto system = open_port(access("# mine\none\n\ntwo 2  # two there\n",
                                       "env HOST={host} " MAIDE_BINARY_DIR "/bin/{wrapper}"));
  EXPECT_EQ(count_systems(*system.sul), 3U);
  EXPECT_EQ(run_learning(system), run_learning(open_alone()));
}

TEST_F(Launched, TheRunIsTheSameWhenTwoOfThreeHostsDie) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto system = open_port(mortal_hosts("a\nb\nc\n"));
    std::jthread killer([&] {
      std::this_thread::sleep_for(seed * 30ms);
      pull_the_plug("a");
      std::this_thread::sleep_for(seed * 20ms);
      pull_the_plug("c");
    });
    EXPECT_EQ(run_learning(system, seed), run_learning(open_alone(), seed)) << seed;
    killer.join();
    for (const char* host : {"a", "c"})
      std::filesystem::remove(folder_.path() / (std::string(host) + ".down"));
  }
}

// What a word costs that is asked again is counted; nothing else differs.
TEST_F(Launched, AWrapperThatIsKilledIsStartedAgain) {
  const auto system = open_port(mortal_hosts("a\nb\n"));
  ExperimentOptions options;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t) { kill("a"); };
  LearningRun learned = run_learning(system, 1, options);
  const LearningRun expected = run_learning(open_alone());
  EXPECT_GE(learned.resets, expected.resets);
  learned.resets = expected.resets;
  learned.symbols = expected.symbols;
  EXPECT_EQ(learned, expected);
  EXPECT_NE(system.sul->incidents().count, 0U);
}

TEST_F(Launched, AHostThatCannotBeStartedIsLeftOut) {
  std::ofstream(folder_.path() / "b.down") << "down\n";
  EXPECT_EQ(run_learning(open_port(mortal_hosts("a\nb\nc\n"))), run_learning(open_alone()));
  std::ofstream(folder_.path() / "a.down") << "down\n";
  std::ofstream(folder_.path() / "c.down") << "down\n";
  EXPECT_THAT(error_of([&] { open_port(mortal_hosts("a\nb\nc\n")); }),
              HasSubstr("4 no hello: the wrapper exited with status 9; it was started 4 times "
                        "(host a)"));
}

TEST_F(Launched, TheRunEndsWithTheLastHost) {
  const auto system = open_port(mortal_hosts("a\nb\n"));
  ExperimentOptions options;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t) {
    pull_the_plug("a");
    pull_the_plug("b");
  };
  EXPECT_THAT(error_of([&] { run_learning(system, 1, options); }), testing::StartsWith("4 "));
}

TEST_F(Launched, OneThatDiffersIsAnError) {
  const SystemAccess differing = access("a\nb\n", "sh -c 'test {host} = a && exec " MAIDE_BINARY_DIR
                                                  "/bin/{wrapper}; exec " MAIDE_MQUEUE_WRAPPER "'");
  EXPECT_THAT(error_of([&] { open_port(differing, "port", {}); }),
              HasSubstr("2 systems that are asked at once must be the same: they are "));
}

TEST_F(Launched, CommandsAreMadeOfWords) {
  using Words = std::vector<std::string>;
  const Words wrapper{"my wrapper", "--of={host}"};
  EXPECT_EQ(launch_command("ssh -p 22 {host} {wrapper}", "me@a", {"w"}),
            (Words{"ssh", "-p", "22", "me@a", "w"}));
  EXPECT_EQ(launch_command("env 'H={host} {host}' {wrapper}", "a", wrapper),
            (Words{"env", "H=a a", "my wrapper", "--of={host}"}));
  EXPECT_EQ(launch_command("ssh {host} 'cd /x; {wrapper}'", "a", wrapper),
            (Words{"ssh", "a", "cd /x; 'my wrapper' --of={host}"}));
  EXPECT_THAT(error_of([] { launch_command("ssh {wrapper}", "a", {"w"}); }),
              HasSubstr("2 --launch has no {host}"));
  EXPECT_THAT(error_of([] { launch_command("ssh '{host}", "a", {"w"}); }), HasSubstr("2 "));
}

TEST_F(Launched, FilesOfHostsAreChecked) {
  const auto read = [&](const std::string& text) {
    return error_of([&] { read_hosts(write_hosts(text)); });
  };
  EXPECT_EQ(read_hosts(write_hosts("a\nb 3\r\n #c\n")).at(1).wrappers, 3U);
  EXPECT_THAT(read(""), HasSubstr("2 there is no host in the file"));
  EXPECT_THAT(read("# a\n"), HasSubstr("2 there is no host in the file"));
  EXPECT_THAT(read("a\nb\na 2\n"), HasSubstr("2 host a is there twice, first in line 1"));
  EXPECT_THAT(read("a 0\n"), HasSubstr("hosts:1"));
  EXPECT_THAT(read("a 2 3\n"), HasSubstr("2 a line is HOST"));
  EXPECT_THAT(read("a 257\n"), HasSubstr("2 a line is HOST"));
  EXPECT_THAT(read("a 200\nb 200\n"), HasSubstr("2 more than 256 wrappers"));
  EXPECT_THAT(read("-oProxyCommand=x\n"), HasSubstr("2 '-oProxyCommand=x' is no name of a host"));
  EXPECT_THAT(error_of([] { read_hosts("/nonexistent"); }), HasSubstr("2 "));
}

// ---- Dialling in ----

class DialledIn : public testing::Test {
 protected:
  SystemAccess access(double wait = 60) {
    SystemAccess access;
    access.accept = address_;
    access.accept_wait = wait;
    return access;
  }
  std::unique_ptr<ChildProcess> dial(std::vector<std::string> arguments = {}) {
    std::vector<std::string> argv{port_program, "--connect", address_};
    argv.insert(argv.end(), arguments.begin(), arguments.end());
    return std::make_unique<ChildProcess>(argv);
  }
  std::string write_token(const std::string& name, const std::string& token) {
    const std::string path = folder_.path() / name;
    std::ofstream(path) << token << '\n';
    return path;
  }
  static std::string end_of(ChildProcess& wrapper) {
    if (!wrapper.wait(20s)) return "it does not end";
    wrapper.collect_errors();
    return wrapper.describe_end() + ": " + wrapper.last_error_line();
  }
  // Takes part, and a little later all that come do.
  static bool has(const OpenedSystem& system, std::size_t count) {
    return comes_true([&] {
      system.sul->run({}, {}, {});
      return count_systems(*system.sul) >= count;
    });
  }

  TempDir folder_;
  const std::string address_ = "127.0.0.1:" + std::to_string(free_loopback_port());
};

TEST_F(DialledIn, TheRunIsTheSameWithOneThatComesLate) {
  const auto first = dial();
  std::unique_ptr<ChildProcess> second;
  auto system = open_port(access());
  ExperimentOptions options;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t round) {
    if (round != 1) return;
    second = dial();
    EXPECT_TRUE(has(system, 2));
  };
  EXPECT_EQ(run_learning(system, 1, options), run_learning(open_alone()));
  EXPECT_EQ(count_systems(*system.sul), 2U);
  system.sul.reset();
  EXPECT_EQ(end_of(*first), "exited with status 0: ");
  EXPECT_EQ(end_of(*second), "exited with status 0: ");
}

TEST_F(DialledIn, TheRunIsTheSameWhenTwoOfThreeAreKilled) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto first = dial(), second = dial(), third = dial();
    const auto system = open_port(access());
    ASSERT_TRUE(has(system, 3));
    std::jthread killer([&] {
      std::this_thread::sleep_for(seed * 30ms);
      ::kill(first->id(), SIGKILL);
      std::this_thread::sleep_for(seed * 20ms);
      ::kill(third->id(), SIGKILL);
    });
    EXPECT_EQ(run_learning(system, seed), run_learning(open_alone(), seed)) << seed;
  }
}

// The process that serves a connection is killed: its wrapper dials again.
TEST_F(DialledIn, AProcessThatDiesIsReplaced) {
  const auto wrapper = dial();
  const auto system = open_port(access());
  ExperimentOptions options;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t) {
    for (const pid_t child : test::children_of(wrapper->id())) ::kill(child, SIGKILL);
  };
  LearningRun learned = run_learning(system, 1, options);
  const LearningRun expected = run_learning(open_alone());
  learned.resets = expected.resets;
  learned.symbols = expected.symbols;
  EXPECT_EQ(learned, expected);
  EXPECT_NE(system.sul->incidents().count, 0U);
  EXPECT_EQ(count_systems(*system.sul), 1U);
}

TEST_F(DialledIn, WhenAllAreGoneANewOneIsWaitedFor) {
  auto first = dial();
  std::unique_ptr<ChildProcess> second;
  std::jthread helper;
  const auto system = open_port(access());
  ExperimentOptions options;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t round) {
    if (round != 1) return;
    first->kill();
    helper = std::jthread([&] {
      std::this_thread::sleep_for(1500ms);  // the lost one is given up before
      second = dial();
    });
  };
  EXPECT_EQ(run_learning(system, 1, options), run_learning(open_alone()));
}

// One of another version dials in just when the only one is gone, and is no loss.
TEST_F(DialledIn, AStrangerInThePlaceOfOneThatIsGoneEndsNothing) {
  auto first = dial();
  std::unique_ptr<ChildProcess> second;
  std::jthread helper;
  const auto system = open_port(access());
  const auto be_a_stranger = [&] {
    Descriptor socket = tcp::connect(tcp::parse_address(address_), 10s, [] { return false; });
    write_all(socket.get(), R"({"type":"hello","protocol":1,"name":"port"})"
                            "\n"
                            R"({"type":"error","code":"option","message":"there is no size"})"
                            "\n");
    return socket;
  };
  ExperimentOptions options;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t round) {
    if (round != 1) return;
    first->kill();
    helper = std::jthread([&] {
      std::vector<Descriptor> strangers;
      try {
        for (int i = 0; i < 30; ++i) {
          strangers.push_back(be_a_stranger());
          std::this_thread::sleep_for(50ms);
        }
      } catch (const std::runtime_error&) {
        return;  // nobody listens any more
      }
      second = dial();
    });
  };
  EXPECT_EQ(run_learning(system, 1, options), run_learning(open_alone()));
}

TEST_F(DialledIn, NobodyIsWaitedForWithoutEnd) {
  EXPECT_EQ(error_of([&] { open_port(access(0.2)); }),
            "4 no wrapper has come within 0.2 s (--accept " + address_ + ")");
  const auto wrapper = dial();
  const auto system = open_port(access(1));
  ExperimentOptions options;
  options.on_hypothesis = [&](const Mealy&, std::uint64_t) { wrapper->kill(); };
  EXPECT_THAT(error_of([&] { run_learning(system, 1, options); }),
              HasSubstr("4 all systems are gone, and none has come within 1 s; the last one: "));
}

TEST_F(DialledIn, AWaitCanBeStopped) {
  std::stop_source stop;
  RunControl control;
  control.stop = stop.get_token();
  std::jthread stopper([&] {
    std::this_thread::sleep_for(100ms);
    stop.request_stop();
  });
  EXPECT_THROW(open_system(parse_system_spec("port", {}), access(), control), Interrupted);
}

TEST_F(DialledIn, TheTokenIsAskedFor) {
  SystemAccess guarded = access();
  guarded.token_file = write_token("right", "sesame");
  auto system = std::async(std::launch::async, [&] { return open_port(guarded); });
  const auto stranger = dial({"--token-file", write_token("wrong", "simsim")});
  const auto ignorant = dial();
  EXPECT_EQ(end_of(*stranger),
            "exited with status 2: maide-wrap-port: refused: the token is wrong");
  EXPECT_EQ(end_of(*ignorant), "exited with status 2: maide-wrap-port: refused: a token is needed");
  EXPECT_EQ(system.wait_for(0s), std::future_status::timeout);
  const auto friendly = dial({"--token-file", guarded.token_file});
  EXPECT_EQ(run_learning(system.get()), run_learning(open_alone()));
}

TEST_F(DialledIn, WithoutATokenItIsOnLoopbackOnly) {
  SystemAccess open_to_all = access();
  open_to_all.accept = "0.0.0.0:0";
  EXPECT_THAT(error_of([&] { open_port(open_to_all); }),
              HasSubstr("is not loopback, needs a token"));
  // What it tells others to dial is no address that only this machine understands.
  open_to_all.accept_wait = 0.1;
  open_to_all.token_file = write_token("token", "sesame");
  testing::internal::CaptureStderr();
  EXPECT_THAT(error_of([&] { open_port(open_to_all); }), HasSubstr("4 no wrapper has come"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr(" --connect "), Not(HasSubstr("0.0.0.0"))));
  open_to_all.accept = "nowhere";
  EXPECT_EQ(error_of([&] { open_port(open_to_all); }), "2 'nowhere' is not HOST:PORT");
}

// What the other side says, up to its end.
std::string hear(int socket, std::chrono::milliseconds limit) {
  std::string text, bytes;
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (std::chrono::steady_clock::now() < deadline) {
    pollfd waiting{socket, POLLIN, 0};
    ::poll(&waiting, 1, 100);
    const ReadResult result = read_some(socket, bytes);
    if (result == ReadResult::ended) return text;
    if (result == ReadResult::some) text += bytes;
  }
  return text + "[still open]";
}

// The kernel asks a silent peer whether it is there, and ends the connection within a minute.
TEST_F(DialledIn, AMachineThatVanishesIsNoticed) {
  const tcp::Listener listener = tcp::listen(tcp::parse_address(address_));
  const Descriptor socket = tcp::connect(tcp::parse_address(address_), 10s, [] { return false; });
  const auto get = [&](int option) {
    int value = 0;
    socklen_t size = sizeof value;
    EXPECT_EQ(::getsockopt(socket.get(), IPPROTO_TCP, option, &value, &size), 0);
    return value;
  };
  EXPECT_LE(get(TCP_KEEPIDLE) + get(TCP_KEEPINTVL) * get(TCP_KEEPCNT), 60);
  EXPECT_GT(get(TCP_USER_TIMEOUT), 0);
  EXPECT_LE(get(TCP_USER_TIMEOUT), 60'000);
}

TEST_F(DialledIn, SilentConnectionsKeepNobodyOut) {
  auto opened = std::async(std::launch::async, [&] { return open_port(access()); });
  const auto connect = [&] {
    return tcp::connect(tcp::parse_address(address_), 10s, [] { return false; });
  };
  std::vector<Descriptor> silent;
  ASSERT_TRUE(comes_true([&] {
    try {
      silent.push_back(connect());
      return true;
    } catch (const std::runtime_error&) {
      return false;
    }
  }));
  const auto start = std::chrono::steady_clock::now();
  for (int i = 1; i < 50; ++i) silent.push_back(connect());
  const Descriptor other_protocol = connect();
  ASSERT_TRUE(write_all(other_protocol.get(), "GET / HTTP/1.1\r\n\r\n"));
  EXPECT_THAT(hear(other_protocol.get(), 5s), HasSubstr("error"));
  const auto wrapper = dial();
  EXPECT_EQ(run_learning(opened.get()), run_learning(open_alone()));
  // One after the other they would take ten seconds each.
  EXPECT_LT(std::chrono::steady_clock::now() - start, 100s);
}

// A wrapper of the same name that says something else of itself.
TEST_F(DialledIn, AnotherSystemIsRefusedOnBothSides) {
  const auto first = dial();
  const auto system = open_port(access(), "port", {"kind=strict", "size=1"});
  const auto say_hello = [&](const std::string& name, const std::string& version) {
    Descriptor socket = tcp::connect(tcp::parse_address(address_), 10s, [] { return false; });
    EXPECT_TRUE(write_all(socket.get(), R"({"type":"hello","protocol":1,"name":")" + name +
                                            R"(","versions":{"port":")" + version + "\"}}\n"));
    EXPECT_TRUE(
        write_all(socket.get(),
                  R"({"type":"info","inputs":["write","read"],"outputs":["message"],"options":{}})"
                  "\n"));
    return hear(socket.get(), 5s);
  };
  EXPECT_THAT(say_hello("lamp", "1"), HasSubstr("it is a wrapper of 'lamp', not of 'port'"));
  EXPECT_THAT(say_hello("port", "0.0"), HasSubstr("the version of port is "));
  EXPECT_EQ(count_systems(*system.sul), 1U);
  run_learning(system);
  EXPECT_EQ(count_systems(*system.sul), 1U);
}

TEST_F(DialledIn, AWrapperOfOtherOptionsEndsWithALine) {
  const auto wrapper = dial();
  EXPECT_THAT(error_of([&] { open_port(access(), "port", {"kind=nonsense"}); }), HasSubstr("2 "));
  EXPECT_THAT(end_of(*wrapper),
              MatchesRegex("exited with status 2: maide-wrap-port: refused: .*kind.*"));
}

}  // namespace
}  // namespace maide
