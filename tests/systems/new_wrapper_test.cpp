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
  LineServer()
      : process_(std::vector<std::string>{MAIDE_PYTHON,
                                          MAIDE_SOURCE_DIR "/tests/systems/line_server.py"}) {
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
  ChildProcess process_;
  std::string address_;
};

Mealy learn_through(const std::vector<std::string>& wrapper,
                    const std::map<std::string, std::string>& options = {}) {
  const auto sul = spawn_wrapper(wrapper, options);
  LearnedModel learned = learn_model(*sul, Translation::eager, {}, {}, ModelKind::machine);
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
  std::vector<std::string> command{MAIDE_BINARY_DIR "/bin/maide", "new", "wrapper", "--tcp"};
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
            (Texts{"503", "331", "530", "230", "226-a", "221", "closed"}));
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
            (Texts{"5xx", "3xx", "5xx", "2xx", "2xx", "2xx", "closed"}));
}

}  // namespace
}  // namespace maide
