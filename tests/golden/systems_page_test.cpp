// The examples of docs/systems.md are system files as the program reads them.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/language/system_file.hpp"

namespace maide {
namespace {

// The blocks of YAML that have programs, with as many lines before them as on the page.
std::vector<std::string> examples() {
  const std::string page = read_file(MAIDE_SOURCE_DIR "/docs/systems.md");
  std::vector<std::string> result;
  std::string block, before;
  bool is_inside = false;
  for (const std::string_view line : split_lines(page)) {
    before += '\n';
    if (line == "```yaml") {
      is_inside = true;
      block = before;
    } else if (line == "```") {
      if (is_inside && block.find("\nprograms:") != std::string::npos) result.push_back(block);
      is_inside = false;
    } else if (is_inside) {
      block += std::string(line) + "\n";
    }
  }
  return result;
}

// In place of every model: a message that is kept, or none.
InterfaceAutomaton any_model(const ModelRequest&) {
  InterfaceAutomaton automaton({"write", "read", "tryread"}, {"message", "null"}, 4);
  const auto input = [](Symbol symbol) { return Action{Action::Kind::input, symbol}; };
  automaton.add_transition(0, input(0), 1);
  automaton.add_transition(0, input(2), 2);
  automaton.add_transition(1, input(1), 3);
  automaton.add_transition(1, input(2), 3);
  automaton.add_transition(2, {Action::Kind::output, 1}, 0);
  automaton.add_transition(3, {Action::Kind::output, 0}, 0);
  return automaton;
}

TEST(SystemsPage, ItsExamplesAreSystemFiles) {
  const std::vector<std::string> files = examples();
  EXPECT_GE(files.size(), 8u);
  for (const std::string& file : files) {
    try {
      const System system = parse_system(file, "docs/systems.md", any_model);
      EXPECT_EQ(system.remarks, std::vector<std::string>{});
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
  }
}

}  // namespace
}  // namespace maide
