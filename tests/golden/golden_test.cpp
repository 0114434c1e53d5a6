// Every format, byte for byte, against approved files. After a change that is meant:
//   MAIDE_APPROVE=1 build/dev/bin/test_golden    and look at what git says.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <tuple>

#include "approved.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/export/promela_system.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

// What is hard for the formats: names that are no identifiers, keywords, or collide.
Model strange_mealy() {
  Mealy machine({"in put", "a / b", "class", "\"quoted\"", "zwölf*/"},
                {"quiet", "written,message", "mtype", "MODULE"}, 2);
  for (Symbol input = 0; input < 5; ++input) {
    machine.set_transition(0, input, input % 4, 1);
    machine.set_transition(1, input, (input + 1) % 4, input % 2);
  }
  machine.set_initial(1);
  machine.origin = {{"sul", "sim:strange.dot"}, {"versions", "1 */ -- \\ 2"}};
  machine.actors = {{"the writer", {"in put"}, {"quiet"}}};
  return machine;
}

Model strange_automaton() {
  InterfaceAutomaton automaton({"do", "in-put", "in put"}, {"od", "do", "never"}, 3);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  automaton.add_transition(0, {Action::Kind::input, 1}, 2);
  automaton.add_transition(0, {Action::Kind::input, 2}, 0, true);
  automaton.add_transition(1, {Action::Kind::output, 0}, 0);
  automaton.add_transition(1, {Action::Kind::output, 1}, 2);
  automaton.mark_unexplored(2, 0);
  automaton.mark_unexplored(2, 2);
  automaton.set_initial(2);
  automaton.hidden_returns = {"in put"};
  automaton.origin = {{"bound", "1"}};
  return automaton;
}

Model model_of(const std::string& name) {
  if (name == "strange-mealy") return strange_mealy();
  if (name == "strange-automaton") return strange_automaton();
  return read_model(MAIDE_SOURCE_DIR "/tests/models/" + name + ".dot");
}

class Golden : public testing::TestWithParam<std::tuple<const char*, std::string_view>> {};

TEST_P(Golden, IsAsApproved) {
  const auto [name, format] = GetParam();
  const Exporter& exporter = find_exporter(format);
  std::ostringstream out;
  exporter.write(out, model_of(name), {name, MarkLoss::accept});
  const std::string kind = exporter.takes_machines_alone ? ".mealy" : "";
  test::expect_approved(name + kind + std::string(exporter.extension), out.str());
}

INSTANTIATE_TEST_SUITE_P(
    Exports, Golden,
    testing::Combine(testing::Values("strange-mealy", "strange-automaton", "buffered-tryread",
                                     "strict-2", "strict-1-absorb"),
                     testing::Values("dot", "aut", "promela", "smv", "mcrl2", "cpp")),
    [](const auto& test) {
      std::string name = std::get<0>(test.param);
      for (char& letter : name) letter = letter == '-' ? '_' : letter;
      return name + "_" + std::string(std::get<1>(test.param));
    });

// Whole systems: of single inputs and outputs, and with all that is more.
const std::map<std::string, std::string> systems{{"relay", R"(
models:
  via: {file: strict-2.dot}
  sync: {file: buffered-tryread.dot, when_unexplored: drop}
programs:
  planner: |
    @go via.write; via.write;
    if * { via.write; }
    switch sync.tryread { message { } quiet { } }
  tracker: "loop { via.read -> message; @done sync.write; }"
)"},
                                                 {"robot", R"(
models:
  via: {file: strict-1.dot}
  lock: {use: mutex}
topics:
  image: {writers: camera, readers: [robot, logger], use: queue, with: {size: 1}, delivery: at_once}
variables: "var n: 0..2; var paused: bool;"
programs:
  camera: "loop { image.write(go); }"
  logger: "loop { idle image.read -> message(go); }"
  planner: {do: "via.write; via.write; lock.lock; paused = true;", may_die: true}
  robot: |
    loop {
      idle select {
        when (!paused) on image.read -> message(go) { atomic { n = n + 1; } }
        on via.read -> message { lock.lock; lock.unlock; }
        otherwise { @bored skip; }
      }
    }
)"}};

class SystemGolden : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(SystemGolden, IsAsApproved) {
  const std::string name = std::get<0>(GetParam()), format = std::get<1>(GetParam());
  const System system =
      parse_system(systems.at(name), name + ".yaml", [](const ModelRequest& request) {
        return read_interface_automaton(std::filesystem::path(MAIDE_SOURCE_DIR "/tests/models") /
                                        request.file);
      });
  std::ostringstream out;
  find_system_exporter(format).write(out, system, {std::uint64_t{1} << 30, {}});
  test::expect_approved(name + "." + format, out.str());
}

INSTANTIATE_TEST_SUITE_P(Exports, SystemGolden,
                         testing::Combine(testing::Values("relay", "robot"),
                                          testing::Values("promela", "aut", "smv", "mcrl2",
                                                          "pins")),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param)) + "_" +
                                  std::get<1>(test.param);
                         });

// Systems of the examples, which have what those above have not: nodes, executors and calls, topics
// with several ends, services, procedures, values.
class ExampleGolden : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(ExampleGolden, IsAsApproved) {
  const std::filesystem::path file = std::get<0>(GetParam());
  const std::string format = std::get<1>(GetParam());
  System system = read_system(MAIDE_SOURCE_DIR "/examples" / file);
  system.file = file.filename();  // wherever the tree lies
  std::ostringstream out;
  find_system_exporter(format).write(out, system, {std::uint64_t{1} << 30, {}});
  test::expect_approved(file.stem().string() + "." + format, out.str());
}

const auto example_name = [](const auto& test) {
  std::string name = std::filesystem::path(std::get<0>(test.param)).stem().string() + "_" +
                     std::get<1>(test.param);
  for (char& letter : name) letter = letter == '-' ? '_' : letter;
  return name;
};

INSTANTIATE_TEST_SUITE_P(
    Promela, ExampleGolden,
    testing::Combine(testing::Values("ros2/nested/nested-mended.yaml", "ros2/nested/reentrant.yaml",
                                     "ros2/late-server/late-server.yaml",
                                     "architectures/map-server-mended.yaml",
                                     "architectures/token.yaml", "architectures/heartbeats.yaml",
                                     "architectures/lifecycle.yaml", "architectures/failsafe.yaml",
                                     "architectures/cancel.yaml", "architectures/pipeline.yaml",
                                     "architectures/two-by-two.yaml",
                                     "architectures/double-buffer-mended.yaml"),
                     testing::Values("promela")),
    example_name);
INSTANTIATE_TEST_SUITE_P(
    All, ExampleGolden,
    testing::Combine(testing::Values("ros2/late-server/late-server-mended.yaml",
                                     "architectures/notice.yaml",
                                     "architectures/lifecycle-mended.yaml",
                                     "architectures/multiplexer.yaml",
                                     "architectures/cancel-mended.yaml"),
                     testing::Values("promela", "smv", "mcrl2", "pins", "aut")),
    example_name);

// Promela for each thing that SPIN is asked.
class PurposeGolden : public testing::TestWithParam<const char*> {};

TEST_P(PurposeGolden, IsAsApproved) {
  using Purpose = PromelaOptions::Purpose;
  const std::string name = GetParam();
  const System system =
      parse_system(systems.at(name) + "properties: {after: \"G F via!message\"}\n", name + ".yaml",
                   [](const ModelRequest& request) {
                     return read_interface_automaton(
                         std::filesystem::path(MAIDE_SOURCE_DIR "/tests/models") / request.file);
                   });
  std::string text;
  for (const Purpose purpose : {Purpose::deadlock, Purpose::error, Purpose::cut, Purpose::ltl}) {
    const PromelaSystem promela =
        write_promela(system, {purpose, find_property(system, "after").formula});
    text += promela.text + "\n/* claim: " + promela.claim + ", " +
            std::to_string(promela.processes) + " processes, " +
            (promela.has_start ? "a start, " : "") + (promela.is_doubled ? "doubled, " : "") +
            "lines:";
    for (const PromelaLine& line : promela.lines) {
      text += " " + std::to_string(static_cast<int>(line.kind)) + "." + std::to_string(line.owner) +
              "." + std::to_string(line.index) + (line.is_beyond ? "!" : "");
    }
    text += " */\n\n";
  }
  test::expect_approved(name + ".purposes.promela", text);
}

INSTANTIATE_TEST_SUITE_P(Promela, PurposeGolden, testing::Values("relay", "robot"));

INSTANTIATE_TEST_SUITE_P(Machines, Golden, testing::Values(std::tuple("strange-mealy", "mealy")),
                         [](const auto&) { return "strange_mealy_mealy"; });

TEST(Exporters, UnknownFormatsAreRefusedByName) {
  try {
    find_exporter("png");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(),
                 "unknown format 'png'; known are: dot, mealy, aut, promela, smv, mcrl2, cpp");
  }
}

}  // namespace
}  // namespace maide
