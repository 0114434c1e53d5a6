// The wrappers that `maide new wrapper` writes, run for real: a server that speaks lines is learned
// through them, in Python and in C++.
#include <gtest/gtest.h>
#include <poll.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/subprocess.hpp"
#include "maide/experiment/learn_model.hpp"
#include "maide/wire/client/child_process.hpp"
#include "maide/wire/client/wrapper_proxy.hpp"
#include "maide/wire/protocol/line_io.hpp"

namespace maide {
namespace {

// line_server.py, on a free port.
class LineServer {
 public:
  explicit LineServer(const std::vector<std::string>& options = {}) : process_(command(options)) {
    LineSplitter lines;
    std::string bytes;
    std::optional<std::string> line;
    while (!(line = lines.take_line())) {
      pollfd waiting{process_.output.get(), POLLIN, 0};
      ::poll(&waiting, 1, 100);
      const ReadResult result = read_some(process_.output.get(), bytes);
      if (result == ReadResult::ended) throw std::runtime_error("it does not listen");
      if (result == ReadResult::some) lines.append(bytes);
    }
    address_ = line->substr(line->rfind(' ') + 1);
  }
  const std::string& address() const { return address_; }

 private:
  static std::vector<std::string> command(const std::vector<std::string>& options) {
    std::vector<std::string> words{MAIDE_PYTHON, MAIDE_SOURCE_DIR "/tests/systems/line_server.py"};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

  ChildProcess process_;
  std::string address_;
};

Mealy learn_through(const std::vector<std::string>& wrapper,
                    const std::map<std::string, std::string>& options = {}) {
  const auto sul = spawn_wrapper(wrapper, options);
  ExperimentOptions experiment;
  experiment.testing.budget = {60, 600};  // each step is a round trip to the server
  LearnedModel learned = learn_model(*sul, Translation::eager, experiment, {}, ModelKind::machine);
  if (learned.experiment.error) std::rethrow_exception(learned.experiment.error);
  return std::get<Mealy>(*learned.model);
}

std::vector<std::string> answers(const Mealy& machine, const std::vector<std::string>& inputs) {
  Word word;
  for (const std::string& input : inputs) word.push_back(machine.inputs().at(input));
  std::vector<std::string> outputs;
  for (const Symbol output : machine.output_word(word)) {
    outputs.push_back(machine.outputs().name(output));
  }
  return outputs;
}

void write_wrapper(const std::vector<std::string>& more) {
  std::vector<std::string> command{MAIDE_BINARY_DIR "/bin/maide", "new", "wrapper"};
  if (!more.front().starts_with("--")) command.emplace_back("--tcp");
  command.insert(command.end(), more.begin(), more.end());
  const SubprocessResult written = run_program(command);
  ASSERT_TRUE(written.succeeded()) << written.err;
}

using Texts = std::vector<std::string>;

TEST(NewWrapper, InPythonLearnsAServerAtOnce) {
  const LineServer server;
  const TempDir folder;
  const std::string file = (folder.path() / "session.py").string();
  write_wrapper({server.address(), "--lines", "--python", "--input", "USER", "--input",
                 "login=PASS secret", "--input", "LIST", "--input", "QUIT", "-o", file});
  const Mealy machine = learn_through({MAIDE_PYTHON, file});
  EXPECT_EQ(machine.size(), 4U);  // outside, named, inside, ended
  EXPECT_EQ(answers(machine, {"login", "USER", "LIST", "login", "LIST", "QUIT", "LIST"}),
            (Texts{"503", "331", "530", "230", "226-a", "221,closed", "closed"}));
}

// What strangers' servers do. The four states are outside, named, inside and ended.
const std::vector<std::string> session_inputs{"--input", "USER", "--input", "login=PASS secret",
                                              "--input", "LIST", "--input", "QUIT"};

void expect_session(const std::string& transport, const std::string& address,
                    const std::map<std::string, std::string>& options = {}) {
  const TempDir folder;
  const std::string file = (folder.path() / "session.py").string();
  std::vector<std::string> more{transport, address, "-o", file};
  more.insert(more.end(), session_inputs.begin(), session_inputs.end());
  write_wrapper(more);
  const Mealy machine = learn_through({MAIDE_PYTHON, file}, options);
  EXPECT_EQ(machine.size(), transport == "--udp" ? 3U : 4U);
  EXPECT_EQ(answers(machine, {"login", "USER", "LIST", "login", "LIST"}),
            (Texts{"503", "331", "530", "230", "226-a"}));
}

TEST(NewWrapper, WaitsForTheSecondPartOfAnAnswer) {
  for (const char* gap : {"3", "30"}) {
    SCOPED_TRACE(gap);
    const LineServer server({"--gap", gap});
    expect_session("--tcp", server.address());
  }
}

TEST(NewWrapper, WaitsForALateGreeting) {
  const std::vector<std::vector<std::string>> all{{"--late-first", "500"},
                                                  {"--late-others", "50"},
                                                  {"--late-first", "50", "--late-others", "70"}};
  for (const std::vector<std::string>& late : all) {
    SCOPED_TRACE(late.front());
    const LineServer server(late);
    expect_session("--tcp", server.address());
  }
}

TEST(NewWrapper, NeedsNoGreeting) {
  const LineServer server({"--silent"});
  expect_session("--tcp", server.address(), {{"greeting", "100"}});
}

TEST(NewWrapper, SpeaksUdp) {
  const LineServer server({"--udp"});
  expect_session("--udp", server.address());
}

TEST(NewWrapper, SpeaksTls) {
  const TempDir folder;
  const std::string file = (folder.path() / "server.pem").string();
  const SubprocessResult made =
      run_program({"openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj",
                   "/CN=localhost", "-days", "2", "-keyout", file, "-out", file + ".crt"});
  ASSERT_TRUE(made.succeeded()) << made.err;
  write_file_atomically(file, read_file(file) + read_file(file + ".crt"));
  const LineServer server({"--tls", file});
  expect_session("--tls", server.address());
}

TEST(NewWrapper, SendsSeveralLines) {
  const LineServer server;
  const TempDir folder;
  const std::string file = (folder.path() / "store.py").string();
  write_wrapper({server.address(), "--line-end", "lf", "--input", "store=STORE\\na file", "--input",
                 "LIST", "-o", file});
  const Mealy machine = learn_through({MAIDE_PYTHON, file});
  EXPECT_EQ(machine.size(), 1U);
  EXPECT_EQ(answers(machine, {"store", "LIST", "store"}), (Texts{"250", "530", "250"}));
}

// The hooks that stand in the file.
TEST(NewWrapper, ReadsAnswersThatTellTheirLength) {
  const LineServer server({"--binary", "--gap", "30"});
  const TempDir folder;
  const std::string file = (folder.path() / "binary.py").string();
  write_wrapper({server.address(), "--input", "USER", "--input", "login=PASS secret", "--input",
                 "LIST", "--input", "QUIT", "-o", file});
  std::string text = read_file(file);
  const auto put = [&](const std::string& before, const std::string& behind) {
    const std::size_t place = text.find(before);
    ASSERT_NE(place, std::string::npos) << before;
    text.replace(place, before.size(), behind);
  };
  put("request = as_lines", "request = with_length");
  put("is_whole = by_silence", "is_whole = by_length");
  write_file_atomically(file, text);
  EXPECT_EQ(learn_through({MAIDE_PYTHON, file}).size(), 4U);
}

TEST(NewWrapper, KnowsTheEndsOfItsHooks) {
  const TempDir folder;
  const std::string file = (folder.path() / "hooks.py").string();
  write_wrapper({"127.0.0.1:1", "-o", file});
  const SubprocessResult result = run_program({MAIDE_PYTHON, "-c", R"py(
import sys
sys.path.insert(0, sys.argv[1])
from hooks import *
for rule, whole in ((by_redis, b"+OK\r\n"), (by_redis, b"$5\r\nhe\r\no\r\n"), (by_redis, b"$-1\r\n"),
                    (by_redis, b"*2\r\n$1\r\na\r\n:12\r\n"), (by_redis, b"*0\r\n"),
                    (by_code, b"220-a\r\n220 b\r\n"), (by_length, b"\0\0\0\3abc")):
    for end in range(len(whole)):
        assert not rule(whole[:end]), whole[:end]
    assert rule(whole), whole
assert by_silence(b"220 a\r\n") is None and by_silence(b"220-a\r\n") is False
several = [b"220 A, Sat, 28 Nov 2026 16:52:00 +0000 <12.34@a> no. 1",
           b"220 A, Sun, 29 Nov 2026 06:52:01 +0000 <56.78@a> no. 2"]
assert find_version(several) == "220 A, # # # # # # no. #", find_version(several)
assert find_version(several[:1]) != find_version([b"220 B"])
)py",
                                               folder.path().string()});
  EXPECT_TRUE(result.succeeded()) << result.err;
}

// So that a cache of another server is noticed.
TEST(NewWrapper, TellsWhichServerItIs) {
  const TempDir folder;
  const std::string file = (folder.path() / "which.py").string();
  write_wrapper({"127.0.0.1:1", "--input", "LIST", "-o", file});
  const auto version = [&](const std::string& banner) {
    const LineServer server({"--banner", banner});
    return spawn_wrapper({MAIDE_PYTHON, file}, {{"server", server.address()}})
        ->info()
        .versions.at("server");
  };
  EXPECT_EQ(version("A 1.0"), "220-welcome 220 A 1.0");
  EXPECT_EQ(version("B 1.0"), "220-welcome 220 B 1.0");
}

// What the server keeps from word to word.
TEST(NewWrapper, ForgetsWhatItIsToldToReset) {
  const LineServer server;
  const TempDir folder;
  const std::string file = (folder.path() / "count.py").string();
  write_wrapper({server.address(), "--input", "COUNT", "--reset", "FORGET", "-o", file});
  const Mealy machine = learn_through({MAIDE_PYTHON, file});
  EXPECT_EQ(answers(machine, {"COUNT", "COUNT", "COUNT"}), (Texts{"250.1", "250.2", "250.2"}));
}

TEST(NewWrapper, ASilentServerIsQuiet) {
  const LineServer server;
  const TempDir folder;
  const std::string file = (folder.path() / "hush.py").string();
  write_wrapper({server.address(), "--input", "HUSH", "-o", file});
  const auto sul = spawn_wrapper({MAIDE_PYTHON, file}, {{"patience", "20"}});
  IaTranslator translator(*sul, Translation::eager);
  const std::vector<Query> asked{Word{0, 0}};
  const MealyAnswer answer = translator.run(asked).front();
  ASSERT_EQ(answer.outputs.size(), 2U);
  EXPECT_EQ(translator.outputs().name(answer.outputs.back()), "quiet");
}

TEST(NewWrapper, SaysThatThereIsNoServer) {
  const TempDir folder;
  const std::string file = (folder.path() / "nobody.py").string();
  write_wrapper({"127.0.0.1:1", "-o", file});
  try {
    spawn_wrapper({MAIDE_PYTHON, file}, {});
    FAIL();
  } catch (const WrapperError& error) {
    EXPECT_NE(std::string(error.what()).find("no connection to 127.0.0.1:1"), std::string::npos)
        << error.what();
  }
}

// Written and compiled by the build.
TEST(NewWrapper, InCppLearnsAServerAtOnce) {
  const LineServer server;
  const Mealy machine = learn_through({MAIDE_NEW_WRAPPER}, {{"server", server.address()}});
  EXPECT_EQ(machine.size(), 4U);
  EXPECT_EQ(answers(machine, {"login", "USER", "LIST", "login", "LIST", "QUIT", "LIST"}),
            (Texts{"5xx", "3xx", "5xx", "2xx", "2xx", "2xx,closed", "closed"}));
}

}  // namespace
}  // namespace maide
