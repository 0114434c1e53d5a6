// What is said of system files in which one word is missing, comes twice, or is another: a line for
// each, against approved files. Those that can be read all the same have a line that says how large
// they are. After a change that is meant: MAIDE_APPROVE=1 build/dev/bin/test_golden.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "maide/automata/interface_automaton.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/report/picture.hpp"

namespace maide {
namespace {

const std::string root = MAIDE_SOURCE_DIR;

// All of the language, as small as may be.
const std::string everything = R"yaml(
constants: {burst: 2, half: burst / 2, is_open: true}
models:
  via: {file: strict-1.dot, when_unexplored: drop, when_weak: accept}
  lock: {use: mutex}
  units: {use: semaphore, with: {count: burst}}
  box[i in 0..1]: {use: queue, with: {size: 1}}
topics:
  image: {writers: camera, readers: [robot, logger], use: queue, with: {depth: 1}}
variables: "var n: 0..2 = half; var paused: bool; var mode: {idle, busy};"
procedures:
  take(m, k): "m.lock; n = (n + k) % 3; m.unlock;"
programs:
  camera: {do: "loop { image.write(go); }"}
  logger: "loop { idle image.read -> message(go); }"
  pair[i in 0..1]: "box[i].write; box[1 - i].read -> message; @there skip;"
  planner: {do: "repeat burst { via.write; } call take(lock, 1); paused = true;", may_die: true}
  robot: |
    var k: 0..3; var left: bool = is_open;
    loop {
      if (k < 3 && !left || paused) { k = any 0..2; } else if (k == 1) { continue; } else { break; }
    }
    for j in 0..1 { box[j].write; }
    while (mode != idle) { mode = busy; }
    if fair * { units.acquire; } else { units.release; }
    switch via.read { message { skip; } quiet { stop; } }
    loop {
      idle select {
        when (!paused) on image.read -> message(go) { atomic { n = n + 1; } }
        on via!message { lock.lock; lock.unlock; }
        on via.read { message { skip; } }
        when (k > 1) { n = k % 3; }
        timeout 100 { @bored skip; }
      }
    }
properties:
  calm: "forall i in 0..1: G (paused -> F (robot@bored || pair[i]@there))"
  low: {always: "n <= burst && !(robot.k == 3)"}
  busy: {ltl: "robot:via.read U camera@end || X via!message <-> [] <> n == 1", fairness: strong}
)yaml";

const std::string nodes = R"yaml(
topics:
  image: {writers: camera, readers: detector, use: queue, with: {depth: 2}}
services:
  lookup: {server: map, clients: [detector, camera], with: {depth: 1, rmw: fastrtps}}
executors:
  main: {kind: multi, threads: 2}
  other: {kind: single, order: rounds}
nodes:
  camera:
    executor: main
    variables: "var sent: 0..2;"
    callbacks:
      tick: {timer: 33, do: "if (sent < 2) { image.write; sent = sent + 1; }"}
  detector:
    executor: main
    groups: {answers: exclusive, rest: reentrant}
    clients: {lookup: answers}
    callbacks:
      on_image: {takes: image.read, group: rest, do: "lookup.send; @asked wait lookup -> answer;"}
  map:
    executor: other
    callbacks:
      find: {serves: lookup, do: "lookup.answer;"}
properties:
  asks: {ltl: "F detector.on_image@asked", fairness: strong}
)yaml";

System parse(const std::string& text) {
  return parse_system(text, "s.yaml", [](const ModelRequest& request) {
    return read_interface_automaton(std::filesystem::path(root) / "tests/models" / request.file);
  });
}

// What is said of it.
std::string outcome_of(const std::string& text) {
  try {
    const System system = parse(text);
    std::size_t states = 0, transitions = 0;
    for (const Program& program : system.programs) {
      states += size_of(program).states;
      transitions += size_of(program).transitions;
    }
    std::string line = std::to_string(system.programs.size()) + " programs of " +
                       std::to_string(states) + " states and " + std::to_string(transitions) +
                       " steps, " + std::to_string(system.models.size()) + " models, " +
                       std::to_string(system.properties.size()) + " properties";
    for (const std::string& remark : system.remarks) line += "; " + remark;
    return line;
  } catch (const Error& error) {
    return error.what();
  }
}

// A line for each word, sign and line break with which something is done.
std::string tell(const std::string& text, const std::string& by) {
  static const std::regex word("[A-Za-z_0-9.]+|\\n +|[^ \\nA-Za-z_0-9.]");
  std::string lines = "as it is: " + outcome_of(text) + "\n";
  for (auto match = std::sregex_iterator(text.begin(), text.end(), word);
       match != std::sregex_iterator(); ++match) {
    std::string changed = text;
    const auto at = static_cast<std::size_t>(match->position());
    changed.replace(at, static_cast<std::size_t>(match->length()),
                    by == "twice" ? match->str() + " " + match->str() : by);
    const std::size_t line = 1 + static_cast<std::size_t>(std::count(
                                     text.begin(), text.begin() + match->position(), '\n'));
    const std::string what = match->str()[0] == '\n' ? "line break" : match->str();
    lines += std::to_string(line) + " " + what + ": " + outcome_of(changed) + "\n";
  }
  return lines;
}

class LeftOut : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(LeftOut, IsAsApproved) {
  const std::string name = std::get<0>(GetParam()), by = std::get<1>(GetParam());
  const std::string text = tell(name == "nodes" ? nodes : everything, by == "nothing" ? ""
                                                                      : by == "zero"  ? "0"
                                                                                      : by);
  const std::string path =
      root + "/tests/golden/approved/" + name + ".words." + by + ".txt.approved";
  if (std::getenv("MAIDE_APPROVE") != nullptr) write_file_atomically(path, text);
  EXPECT_EQ(text, read_file(path)) << path;
}

INSTANTIATE_TEST_SUITE_P(Words, LeftOut,
                         testing::Combine(testing::Values("everything", "nodes"),
                                          testing::Values("nothing", "twice", "zero", "n")),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) + "_" +
                                  std::get<1>(test.param);
                         });

}  // namespace
}  // namespace maide
