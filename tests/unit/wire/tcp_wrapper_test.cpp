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
#include "maide/base/temp_dir.hpp"
#include "maide/wire/line_io.hpp"
#include "maide/wire/tcp.hpp"
#include "maide/wire/wrapper_proxy.hpp"
#include "maide/wire/wrapper_server.hpp"
#include "port_model.hpp"

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
