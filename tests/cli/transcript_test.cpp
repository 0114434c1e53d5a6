// What maide prints, whole, for many command lines, against an approved file. Systems are simulated
// and models lie in the tree, so that all that changes from run to run is times. After a change
// that is meant: MAIDE_APPROVE=1 build/dev/bin/test_cli --gtest_filter='Transcript.*'.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "maide/base/file.hpp"
#include "maide/base/version.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

const std::string root = MAIDE_SOURCE_DIR;

// SRC stands for the tree, TMP for a folder of the test. Each goes on from what those before it
// have written.
const std::vector<std::string> command_lines{
    // Checking: every verdict, as text and as JSON, by property and by component.
    "check --threads 1 SRC/examples/case-study-1/buffered.yaml",
    "check --threads 1 SRC/examples/case-study-1/buffered.yaml --json",
    "check --threads 1 SRC/examples/case-study-1/buffered.yaml --trace TMP/deadlock.json -q",
    "check --threads 1 SRC/examples/case-study-1/buffered.yaml --trace-format steps",
    "check --threads 1 SRC/examples/architectures/lifecycle.yaml",
    "check --threads 1 SRC/examples/architectures/lifecycle.yaml -v",
    "check --threads 1 SRC/examples/architectures/lifecycle-mended.yaml --json",
    "check --threads 1 SRC/examples/architectures/token.yaml",
    "check --threads 1 SRC/examples/architectures/map-server.yaml",
    "check --threads 1 SRC/examples/architectures/two-by-two.yaml",
    "check --threads 1 SRC/examples/architectures/heartbeats.yaml",
    "check --threads 1 SRC/examples/architectures/double-buffer.yaml",
    "check --threads 1 SRC/examples/ros2/nested/nested.yaml",
    "check --threads 1 SRC/examples/ros2/late-server/late-server.yaml",
    "check --threads 1 SRC/examples/ros2/nested/nested-mended.yaml --property none",
    "check --threads 1 TMP/none.yaml",
    "check --threads 1 --suggest SRC/examples/architectures/lifecycle.yaml",
    "check --threads 1 --suggest SRC/examples/architectures/token.yaml",
    "check --threads 1 --suggest --json SRC/examples/architectures/double-buffer.yaml",
    "check --threads 1 --suggest SRC/examples/architectures/charging.yaml",
    "check --threads 1 --reduction full SRC/examples/architectures/lifecycle.yaml",
    "check --threads 1 --reduction calls SRC/examples/ros2/nested/nested.yaml",
    "check --threads 1 --reduction all SRC/examples/ros2/nested/nested.yaml",
    "check --threads 1 --engine none SRC/examples/ros2/nested/nested.yaml",
    "check --threads 1 --report TMP/report.png SRC/examples/ros2/nested/nested.yaml",
    "check --threads 0 SRC/examples/ros2/nested/nested.yaml",
    // Comparing.
    "compare SRC/tests/models/strict-1.dot SRC/tests/models/strict-1.dot",
    "compare SRC/tests/models/strict-1.dot SRC/tests/models/strict-2.dot",
    "compare SRC/tests/models/strict-1.dot SRC/tests/models/strict-2.dot --json",
    "compare SRC/tests/models/strict-3.dot SRC/tests/models/buffered-tryread.dot",
    "compare SRC/tests/models/port.dot SRC/tests/models/buffered.dot",
    "compare SRC/tests/models/strict-1-absorb.dot SRC/tests/models/strict-1.dot",
    "compare SRC/tests/models/strict-2.dot sim:SRC/tests/models/strict-3.dot",
    "compare SRC/tests/models/strict-2.dot TMP/none.dot",
    // Learning, from simulations.
    "learn sim:SRC/tests/models/strict-3-tryread.dot -o TMP/strict.dot",
    "learn sim:SRC/tests/models/strict-3-tryread.dot -o TMP/strict-v.dot -v --strength random=100",
    "learn sim:SRC/tests/models/strict-3-tryread.dot -o TMP/strict-q.dot -q --eq perfect",
    "learn sim:SRC/tests/models/buffered.dot --algorithm ttt --eq w --extra-states 1 --json",
    "learn sim:SRC/tests/models/buffered.dot --max-experiments 20 --translation av",
    "learn sim:SRC/tests/models/port.dot --cache TMP/port.cache -q -o TMP/port.dot",
    "learn sim:SRC/tests/models/strict-2.dot --start-from SRC/tests/models/strict-1.dot -o "
    "TMP/known.dot",
    "learn sim:SRC/tests/models/none.dot",
    "learn sim:SRC/tests/models/strict-1.dot --algorithm lsharp2",
    "learn sim:SRC/tests/models/strict-1.dot --eq ww",
    "learn sim:SRC/tests/models/strict-1.dot --strength randm=2",
    // Caches.
    "cache show TMP/port.cache",
    "cache show TMP/port.cache --json",
    "cache merge TMP/port.cache TMP/port.cache -o TMP/both.cache",
    "cache check TMP/both.cache --system sim:SRC/tests/models/port.dot",
    "cache check TMP/both.cache --system sim:SRC/tests/models/strict-1.dot",
    // Testing.
    "test SRC/tests/models/strict-2.dot sim:SRC/tests/models/strict-2.dot",
    "test SRC/tests/models/strict-2.dot sim:SRC/tests/models/strict-2.dot --json",
    "test SRC/tests/models/strict-2.dot sim:SRC/tests/models/strict-3.dot",
    "test SRC/tests/models/strict-2.dot sim:SRC/tests/models/port.dot -v",
    "test SRC/tests/models/strict-2.dot sim:SRC/tests/models/port.dot --json",
    "test SRC/tests/models/strict-3-tryread.dot sim:SRC/tests/models/buffered-tryread.dot "
    "--junit -",
    "test SRC/tests/models/strict-3.dot sim:SRC/tests/models/strict-3.dot --max-tests 5",
    "test SRC/tests/models/strict-3-tryread.dot sim:SRC/tests/models/strict-3.dot",
    // Exporting.
    "export SRC/tests/models/strict-1.dot --to aut",
    "export SRC/tests/models/strict-1.dot --to aut --lossy",
    "export SRC/tests/models/strict-1.dot --to tikz -o TMP/strict.tex",
    "export SRC/tests/models/strict-1.dot --to promla",
    "export SRC/tests/models/strict-1.dot --to mealy",
    "export SRC/tests/models/strict-1.dot --to promela --component p",
    "export SRC/examples/architectures/lifecycle.yaml --to promela --component none",
    "export SRC/examples/architectures/lifecycle.yaml --to aut -o TMP/lifecycle.aut",
    "export SRC/examples/architectures/lifecycle.yaml --to smv -o TMP/lifecycle.smv --json",
    "export SRC/examples/architectures/lifecycle.yaml --to cpp",
    "export SRC/examples/architectures/lifecycle.yaml --to hoa",
    "export SRC/examples/architectures/lifecycle.yaml --to hoa --property deadlock",
    // Drawing, layout, replaying.
    "view SRC/tests/models/strict-1.dot -o TMP/strict.html",
    "view TMP/deadlock.json -o TMP/deadlock.svg",
    "view TMP/deadlock.json -o TMP/deadlock.png",
    "view SRC/README.md -o TMP/deadlock.svg",
    "format --check SRC/examples/architectures/lifecycle.yaml "
    "SRC/examples/architectures/token.yaml",
    "format TMP/none.yaml",
    "replay SRC/examples/case-study-1/buffered.yaml TMP/deadlock.json",
    "replay SRC/examples/case-study-1/buffered.yaml TMP/none.json",
    "replay SRC/examples/case-study-1/buffered.yaml",
    // Help.
    "help none",
    "chek",
    "check --propertie x",
};

// Times, and what depends on the machine, are the same letters in every run.
std::string without_times(std::string text, const std::string& temporary) {
  const auto replace = [&](const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
      text.replace(at, what.size(), by);
    }
  };
  replace(temporary, "TMP");
  replace(MAIDE_BINARY_DIR, "BUILD");
  replace(root, "SRC");
  const auto replace_all = [&](const char* pattern, const char* by) {
    text = std::regex_replace(text, std::regex(pattern), by);
  };
  replace_all(
      R"re(("(?:[a-z_]*seconds[a-z_]*|peak_[a-z_]*|memory[a-z_]*|bytes[a-z_]*|us|[a-z]+_us)": *)[0-9.e+-]+)re",
      "$01T");
  replace_all(R"re(\b[0-9]+(\.[0-9]+)? (s|ms|MiB|MB|kB|KiB|GiB)\b)re", "T $2");
  replace_all(R"re([0-9]+ on disk, [0-9.]+ an observation)re", "N on disk, N an observation");
  replace(std::string(version()), "VERSION");
  replace_all(R"re(time="[0-9.]+")re", "time=\"T\"");
  replace_all(R"re(: [0-9.]+ learner and tests, [0-9.]+ asking)re",
              ": T learner and tests, T asking");
  replace_all(R"re([0-9.]+ waiting for quiescence, [0-9.]+ resets \([0-9.]+ waited)re",
              "T waiting for quiescence, T resets (T waited");
  return text;
}

// Every example that is checked within a second, but those that are learned; as JSON, too, where a
// run of executors is searched for.
std::vector<std::string> checks_of_examples() {
  std::vector<std::string> lines;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root + "/examples")) {
    const std::string file = entry.path().string().substr(root.size() + 1);
    const auto is_of = [&file](const char* part) { return file.find(part) != std::string::npos; };
    if (entry.path().extension() != ".yaml" || is_of("nonblocking") || is_of("180-200") ||
        is_of("hundred-robots") || read_file(entry.path()).find("learn:") != std::string::npos) {
      continue;
    }
    lines.push_back("check --threads 1 SRC/" + file);
    if (is_of("ros2/")) lines.push_back("check --threads 1 --json SRC/" + file);
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

std::string transcript(const std::vector<std::string>& lines) {
  // Whatever the locale of this machine is.
  ::setenv("LC_ALL", "C.UTF-8", 1);
  ::unsetenv("COLUMNS");
  const TempDir folder;
  const std::string temporary = folder.path().string();
  std::string text;
  for (const std::string& line : lines) {
    std::vector<std::string> words;
    std::string word;
    for (const char letter : line + " ") {
      if (letter != ' ') {
        word += letter;
        continue;
      }
      for (const auto& [name, path] : {std::pair{"SRC", root}, std::pair{"TMP", temporary}}) {
        const std::size_t at = word.find(name);
        if (at != std::string::npos) word.replace(at, 3, path);
      }
      words.push_back(word);
      word.clear();
    }
    const SubprocessResult result = run_maide(words);
    text += "$ maide " + line + "\n" + without_times(result.out, temporary);
    if (!result.err.empty()) text += "[err]\n" + without_times(result.err, temporary);
    text += "[" + std::to_string(result.exit_status) + "]\n\n";
  }
  return text;
}

void expect_approved(const std::string& name, const std::string& text) {
  const std::string path = root + "/tests/cli/" + name + ".approved";
  if (std::getenv("MAIDE_APPROVE") != nullptr) write_file_atomically(path, text);
  EXPECT_EQ(text, read_file(path)) << path;
}

TEST(Transcript, OfCommandsIsAsApproved) {
  expect_approved("transcript", transcript(command_lines));
}

TEST(Transcript, OfExamplesIsAsApproved) {
  expect_approved("examples-transcript", transcript(checks_of_examples()));
}

}  // namespace
}  // namespace maide::test
