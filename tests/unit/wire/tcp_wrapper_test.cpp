// A wrapper that listens: several clients, tokens, clients that vanish.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <fstream>
#include <memory>
#include <thread>

#include "listening_wrapper.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/protocol/line_io.hpp"
#include "maide/wire/protocol/tcp.hpp"
#include "maide/wire/wrapper/wrapper_server.hpp"
#include "port_model.hpp"
#include "processes.hpp"

namespace maide {
namespace {

constexpr std::chrono::milliseconds long_enough{60'000};

// "quiet message ": the answer to write, read.
std::string ask(Sul& sul) {
  std::string text;
  const std::vector<SulQuery> batch = {{Word{0, 1}, Translation::eager}};
  sul.run(batch,
          [&](std::size_t, const SulAnswer& answer) {
            for (const SulStep& step : answer.steps) {
              text += mealy_output(step, Translation::eager) + ' ';
            }
          },
          {});
  return text;
}

std::string connect_error(const std::string& address, const std::string& token) {
  try {
    connect_tcp(address, token);
    return "no error";
  } catch (const WrapperError& error) {
    return error.what();
  }
}

TEST(TcpWrapper, ServesSeveralClientsAtOnce) {
  const test::ListeningWrapper wrapper;
  const auto first = connect_tcp(wrapper.address(), "", {{"kind", "strict"}});
  const auto second = connect_tcp(wrapper.address(), "", {{"kind", "buffered"}});
  EXPECT_EQ(first->info().options.at("kind"), "strict");
  EXPECT_EQ(second->info().options.at("kind"), "buffered");
  EXPECT_EQ(ask(*first), "quiet message ");
  EXPECT_EQ(ask(*second), "quiet message ");
  EXPECT_EQ(ask(*first), "quiet message ");
}

TEST(TcpWrapper, ATokenIsAskedFor) {
  const TempDir folder;
  const std::string file = (folder.path() / "token").string();
  std::ofstream(file) << "open sesame\n";
  const test::ListeningWrapper wrapper({"--token-file", file});
  const std::string place = " (tcp://" + wrapper.address() + ")";
  EXPECT_EQ(connect_error(wrapper.address(), ""), "a token is needed" + place);
  EXPECT_EQ(connect_error(wrapper.address(), "open sesam"), "the token is wrong" + place);
  EXPECT_EQ(ask(*connect_tcp(wrapper.address(), "open sesame")), "quiet message ");
}

TEST(TcpWrapper, WithoutATokenItListensOnLoopbackOnly) {
  ChildProcess process({MAIDE_BINARY_DIR "/bin/maide-wrap-port", "--listen=0.0.0.0:0"});
  ASSERT_TRUE(process.wait(long_enough));
  process.collect_errors();
  EXPECT_EQ(process.describe_end(), "exited with status 2");
  EXPECT_EQ(process.last_error_line().rfind("maide-wrap-port: listening on 0.0.0.0:", 0), 0u)
      << process.last_error_line();
}

TEST(TcpWrapper, ClientsThatVanishOrTalkNonsenseDoNoHarm) {
  const test::ListeningWrapper wrapper;
  const tcp::Address address = tcp::parse_address(wrapper.address());
  const auto never = [] { return false; };
  for (const std::string text : {R"({"type":"configure","options":{}})"
                                 "\n"
                                 R"({"type":"run","id":1,"word":["read","write","write"]})"
                                 "\n",
                                 "GET / HTTP/1.1\r\n\r\n",
                                 R"({"type":"run","id":1,"word":[]})"
                                 "\n",
                                 "{\"type\":\"conf", ""}) {
    const Descriptor client = tcp::connect(address, long_enough, never);
    EXPECT_EQ(write_some(client.get(), text), static_cast<std::ptrdiff_t>(text.size()));
  }
  EXPECT_EQ(ask(*connect_tcp(wrapper.address(), "")), "quiet message ");
}

// More of them than clients that are served at once, and than connections that may wait.
TEST(TcpWrapper, SilentConnectionsKeepNobodyOut) {
  const test::ListeningWrapper wrapper;
  const tcp::Address address = tcp::parse_address(wrapper.address());
  const auto never = [] { return false; };
  std::vector<Descriptor> silent;
  for (int i = 0; i < 300; ++i) silent.push_back(tcp::connect(address, long_enough, never));
  ProxySettings settings;
  settings.hello_limit = settings.configure_limit = std::chrono::seconds(20);
  WrapperProxy client(WrapperEndpoint::tcp(wrapper.address()), {}, settings);
  EXPECT_EQ(ask(client), "quiet message ");
  EXPECT_EQ(test::children_of(wrapper.process()).size(), 1U);  // none for those who say nothing
  EXPECT_LE(test::count_descriptors(wrapper.process()), 256U + 20U);
}

// What a client hears, up to the end of the connection.
std::string hear(int socket) {
  std::string text, bytes;
  while (true) {
    pollfd waiting{socket, POLLIN, 0};
    ::poll(&waiting, 1, 100);
    const ReadResult result = read_some(socket, bytes);
    if (result == ReadResult::ended) return text;
    if (result == ReadResult::some) text += bytes;
  }
}

class ReceptionTest : public testing::Test {
 protected:
  Descriptor connect() {
    return tcp::connect(tcp::parse_address(listener_.name), long_enough, [] { return false; });
  }
  static void say(const Descriptor& client, const std::string& line) {
    ASSERT_TRUE(write_all(client.get(), line + "\n"));
  }
  std::optional<AcceptedClient> wait_for_client(Reception& reception) {
    for (int round = 0; round < 50; ++round) {
      if (auto client = reception.take_ready()) return client;
      reception.wait(std::chrono::milliseconds(20));
    }
    return std::nullopt;
  }

  const std::string configure_ = R"({"type":"configure","options":{}})";
  tcp::Listener listener_ = tcp::listen({"127.0.0.1", "0"});
  WrapperDescription description_{"lamp", "a lamp", {}, {}};
};

TEST_F(ReceptionTest, OnlyThoseWhoSendTheirOptionsAreReady) {
  Reception reception(listener_.socket.get(), rules_for_clients(description_, std::nullopt));
  const Descriptor silent = connect();
  const Descriptor half = connect();
  ASSERT_TRUE(write_all(half.get(), configure_.substr(0, 10)));
  const Descriptor leaving = connect();
  say(leaving, R"({"type":"bye"})");
  const Descriptor wrong = connect();
  say(wrong, R"({"type":"run","id":1,"word":[]})");
  const Descriptor good = connect();
  say(good, R"({"type":"token","token":"not asked for"})");
  say(good, configure_);
  const auto client = wait_for_client(reception);
  ASSERT_TRUE(client);
  EXPECT_NE(client->received.find("configure"), std::string::npos);
  EXPECT_FALSE(wait_for_client(reception));
  EXPECT_EQ(reception.size(), 2U);  // the silent one and the half one
  EXPECT_NE(hear(wrong.get()).find("the first line must be of type 'configure'"),
            std::string::npos);
}

TEST_F(ReceptionTest, WhoeverIsLateIsDropped) {
  ReceptionRules rules = rules_for_clients(description_, "sesame");
  rules.limit = std::chrono::milliseconds(200);
  Reception reception(listener_.socket.get(), std::move(rules));
  const Descriptor silent = connect();
  const Descriptor known = connect();
  say(known, R"({"type":"token","token":"sesame"})");
  const auto start = std::chrono::steady_clock::now();
  do {
    reception.wait(std::nullopt);  // its own deadlines end it
  } while (reception.size() > 0);
  EXPECT_GE(std::chrono::steady_clock::now() - start, std::chrono::milliseconds(150));
  EXPECT_NE(hear(silent.get()).find("no token within 0.2 s"), std::string::npos);
  EXPECT_NE(hear(known.get()).find("no options within 0.2 s"), std::string::npos);
}

TEST_F(ReceptionTest, ANewcomerTakesThePlaceOfTheMostSilent) {
  ReceptionRules rules = rules_for_clients(description_, std::nullopt);
  rules.most_waiting = 3;
  Reception reception(listener_.socket.get(), std::move(rules));
  const Descriptor ready = connect();
  say(ready, configure_);
  while (reception.size() < 1) reception.wait(long_enough);
  std::vector<Descriptor> silent;
  for (int i = 0; i < 5; ++i) {
    silent.push_back(connect());
    reception.wait(long_enough);
  }
  EXPECT_EQ(reception.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NE(hear(silent[static_cast<std::size_t>(i)].get()).find("too many"), std::string::npos);
  }
  EXPECT_TRUE(wait_for_client(reception));  // whoever has spoken keeps its place
}

TEST_F(ReceptionTest, OptionsWithoutEndAreRefused) {
  Reception reception(listener_.socket.get(), rules_for_clients(description_, std::nullopt));
  const Descriptor endless = connect();
  std::thread writer([&] { write_all(endless.get(), std::string(200'000, 'x')); });
  do {
    reception.wait(long_enough);
  } while (reception.size() > 0);
  writer.join();
  EXPECT_FALSE(reception.take_ready());
}

TEST(TcpWrapper, NobodyThere) {
  std::string address;
  { address = test::ListeningWrapper().address(); }
  EXPECT_EQ(connect_error(address, ""), "Connection refused (tcp://" + address + ")");
}

TEST(TcpWrapper, BadAddresses) {
  for (const char* text :
       {"", "localhost", "localhost:", ":80", "localhost:99999", "::1:80", "localhost:http"}) {
    EXPECT_THROW(tcp::parse_address(text), UsageError) << text;
  }
  EXPECT_EQ(tcp::parse_address("[::1]:80").host, "::1");
}

TEST(Token, IsComparedWhole) {
  EXPECT_TRUE(equal_in_constant_time("secret", "secret"));
  EXPECT_FALSE(equal_in_constant_time("secret", "secreT"));
  EXPECT_FALSE(equal_in_constant_time("secret", "secretsecret"));
  EXPECT_FALSE(equal_in_constant_time("secretsecret", "secret"));
  EXPECT_FALSE(equal_in_constant_time("secret", ""));
  EXPECT_FALSE(equal_in_constant_time("", "secret"));
}

}  // namespace
}  // namespace maide
