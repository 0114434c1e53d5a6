// The examples of docs/systems.md are system files as the program reads them.
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "expected_verdicts.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/check/build/system_file.hpp"

namespace maide {
namespace {

// The blocks of YAML that are systems, with as many lines before them as on the page.
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
      const auto has = [&](const char* section) { return block.find(section) != block.npos; };
      if (is_inside && (has("\nprograms:") || has("\nnodes:"))) result.push_back(block);
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
  EXPECT_GE(files.size(), 14u);
  std::size_t with_verdicts = 0;
  for (const std::string& file : files) {
    try {
      System system = parse_system(file, "docs/systems.md", any_model);
      std::erase_if(system.remarks, [](const std::string& remark) {
        return remark.starts_with("'depth: unknown'");
      });
      EXPECT_EQ(system.remarks, std::vector<std::string>{});
      // Some say which verdicts they have.
      const auto expected = test::expected_verdicts(file);
      if (expected.empty()) continue;
      std::map<std::string, std::string> found = test::verdicts(system);
      for (const auto& [property, verdict] : expected) {
        EXPECT_EQ(found[property], verdict) << property << " of" << file;
      }
      with_verdicts += 1;
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
  }
  EXPECT_EQ(with_verdicts, 12u);
}

// A row of the table of calls that hang: executor, groups of callback, client and server, the call.
System system_of(const std::vector<std::string_view>& row) {
  const bool is_elsewhere = row[4] == "elsewhere";
  return parse_system(
      "services: {lookup: {server: " + std::string(is_elsewhere ? "database" : "detector") +
          ", clients: [detector]}}\n"
          "topics: {image: {writers: camera, readers: detector, use: queue, with: {size: 2}}}\n"
          "programs:\n"
          "  camera: \"repeat 2 { image.write; }\"\n" +
          (is_elsewhere ? "  database: \"loop { idle lookup.serve -> request; lookup.answer; }\"\n"
                        : "") +
          "executors: {main: " + std::string(row[1]) + "}\n" +
          "nodes:\n"
          "  detector:\n"
          "    executor: main\n"
          "    groups: {a: exclusive, c: exclusive, s: exclusive, r: reentrant}\n"
          "    clients: {lookup: " +
          std::string(row[3]) +
          "}\n"
          "    callbacks:\n"
          "      on_image: {takes: image.read, group: " +
          std::string(row[2]) + ", do: \"lookup.send; wait lookup -> answer;\"}\n" +
          (is_elsewhere ? ""
                        : "      find: {serves: lookup, group: " + std::string(row[4]) +
                              ", do: lookup.answer;}\n"),
      "a row of the table", any_model);
}

TEST(SystemsPage, CallsHangAsItsTableSays) {
  std::size_t count = 0;
  const std::string page = read_file(MAIDE_SOURCE_DIR "/docs/systems.md");
  for (const std::string_view line : split_lines(page)) {
    if (!line.starts_with("| `{kind: ")) continue;
    std::vector<std::string_view> row = split(line, '|');
    ASSERT_EQ(row.size(), 7u) << line;
    for (std::string_view& cell : row) {
      while (cell.starts_with(' ') || cell.starts_with('`')) cell.remove_prefix(1);
      while (cell.ends_with(' ') || cell.ends_with('`')) cell.remove_suffix(1);
    }
    ++count;
    EXPECT_EQ(test::verdicts(system_of(row))["deadlock"],
              row[5].starts_with("hangs") ? "violated" : "holds")
        << line;
  }
  EXPECT_EQ(count, 10u);
}

}  // namespace
}  // namespace maide
