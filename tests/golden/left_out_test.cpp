// What is said of texts in which one word is missing, comes twice, or is another: system files,
// models, automata, logs, lines of the wire. A line for each, against approved files. Those that
// can be read all the same have a line that says what was read. After a change that is meant:
// MAIDE_APPROVE=1 build/dev/bin/test_golden.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <regex>
#include <sstream>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "approved.hpp"
#include "maide/automata/interface_automaton.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/base/version.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/ltl/formula.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/formats/trace_log.hpp"
#include "maide/report/picture.hpp"
#include "maide/wire/protocol/protocol.hpp"

namespace maide {
namespace {

using test::expect_approved;
using test::source_root;

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
    return read_interface_automaton(std::filesystem::path(source_root) / "tests/models" /
                                    request.file);
  });
}

// What is said of it.
std::string outcome_of_system(const std::string& text) {
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

using Outcome = std::function<std::string(const std::string& text)>;

// A line for each word, sign and line break with which something is done.
std::string tell(const std::string& text, const std::string& by, const Outcome& outcome_of) {
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

// ---- Other texts ----

const std::string dot = R"dot(/* all that DOT has */ strict digraph "a g" {
  graph [inputs="write,read" outputs="message"];
  actors="writer: ?write; reader: ?read !message";
  node [shape=circle]; edge [style=solid];
  __start0 [label="" shape=none];
  s0 [label="s 0"]; s1; subgraph cluster_a { s2 }
  __start0 -> s0;
  s0 -> s1 [label="?write"]; // forth
  s1 -> s1 [label="?write", absorbed=true];
  s1:e -> s2 [label="?read"] s0 -> { s2 } [label="?read"];
  s2 -> s0 [label="!message"];
  -1.5 [shape=box]
}
)dot";

const std::string aut = R"aut(des (0, 5, 4)
(0, "?write", 2)
(0, ?read, 1)
(1, "?write", 3)
(2, "?read", 3)
(3, "!message", 0)
)aut";

const std::string mealy = R"dot(digraph { a -> b [label="coin / ok"]; a -> a [label="push/"];
  b -> a [label="push / tea, no milk"] b -> b [label="coin / ok"] }
)dot";

const std::string hoa = R"hoa(HOA: v1
name: "often" /* a comment */
States: 2
Start: 0
AP: 2 "p@half" "via!message"
Alias: @a 0 & !1
acc-name: generalized-Buchi 2
Acceptance: 2 Inf(0) & Inf(1)
properties: trans-acc
--BODY--
State: 0 "one"
[@a | t] 0 {0}
[1] 1
State: 1
[!0 & 1] 1 {0 1}
[f] 0
--END--
)hoa";

// One a line.
const std::string formulas = R"ltl(true
p@half
!p@half && via!message
p@end || via.write -> q:via.read
p@half <-> via!message
G F via!message
[] <> via!message -> F G p@half
X X p@half
p@half U via!message
p@half R via!message
p@half W (via!message U p@end)
G (via.write -> X (!via.write U via!message))
!(p@half U (via!message R X p@end))
(F p@half && F q:via.read) || G !(p@end)
F (p@half && X F (via!message && X F p@end))
G (p@half -> F via!message) && G F p@half
(G F p@half) -> (G F via!message)
F G (p@half U via!message)
false R p@half
true U p@half
p@half && !p@half
p@nowhere
via!nothing
via?write
r@half
p@half U
(p@half
p@half)
p:sync.write
)ltl";

const std::string log = R"log([["write","quiet"],["read","a \"message\""]]
[]

[["read","quiet"]]
)log";

const SulInfo& port_info() {
  static const SulInfo info = [] {
    SulInfo result;
    result.name = "port";
    result.actors = {"writer", "reader"};
    result.inputs = {{"write", 0, {"written"}}, {"read", 1, {"next", "gap"}}};
    result.outputs = {{"next", 1}, {"gap", 1}, {"written", 0}};
    result.options = {{"kind", "strict"}};
    result.bound = "at most 1";
    return result;
  }();
  return info;
}

// A word was asked under id 7, a tree under id 8.
class Asked : public protocol::AnswerContext {
 public:
  const SulInfo& info() const override { return port_info(); }
  bool open_outputs() const override { return false; }
  const SulQuery* find_query(std::uint64_t id) const override {
    static const SulQuery word{Word{0, 1}, Translation::eager};
    return id == 7 ? &word : nullptr;
  }
};

const std::vector<std::string> lines_from_wrapper{
    R"({"type":"hello","protocol":1,"name":"port","versions":{"a":"1"},"features":["trees","av"],)"
    R"("options":[{"key":"size","kind":"integer","default":"3","least":1,"most":9,"help":"h"}]})",
    R"({"type":"info","actors":["w","r"],"inputs":[{"name":"write","actor":"w","returns":["ok"]}],)"
    R"("outputs":[{"name":"ok","actor":"w"}],"options":{"size":"3"},"bound":"b"})",
    R"({"type":"ok"})",
    R"({"type":"answer","id":7,"end":"aborted","reason":"why","reset_us":5,"steps":[{"events":[["writer",)"
    R"("written"]],"us":3,"settling_us":1},{"events":[],"busy":["reader"],"us":4}]})",
    R"({"type":"ready","id":7})",
    R"({"type":"step","id":7,"events":[["reader","gap"]],"us":3})",
    R"({"type":"error","code":"system","message":"it is gone","id":7})",
    R"({"type":"leaving","reason":"the broker is gone"})",
};

const std::vector<std::string> lines_to_wrapper{
    R"({"type":"token","token":"t"})",
    R"({"type":"configure","options":{"size":"3"}})",
    R"({"type":"run","id":7,"word":["write","read"],"translation":"eager","announce":true})",
    R"({"type":"cancel"})",
    R"({"type":"bye"})",
};

std::string message_from(const std::string& line) {
  using namespace protocol;
  try {
    const FromWrapper message = decode_from_wrapper(line, Asked());
    if (const auto* hello = std::get_if<Hello>(&message)) return encode(*hello);
    if (const auto* info = std::get_if<Info>(&message)) return encode(*info);
    if (const auto* answer = std::get_if<Answer>(&message)) {
      return encode(*answer, port_info(), *Asked().find_query(7));
    }
    if (const auto* ready = std::get_if<Ready>(&message)) return encode(*ready);
    if (const auto* step = std::get_if<protocol::Step>(&message)) return encode(*step, port_info());
    if (const auto* error = std::get_if<ErrorReport>(&message)) return encode(*error);
    if (const auto* leaving = std::get_if<Leaving>(&message)) return encode(*leaving);
    return "ok";
  } catch (const ProtocolError& error) {
    return error.what();
  }
}

std::string message_to(const std::string& line) {
  using namespace protocol;
  try {
    const ToWrapper message = decode_to_wrapper(line, port_info());
    if (const auto* token = std::get_if<protocol::Token>(&message)) return encode(*token);
    if (const auto* options = std::get_if<Configure>(&message)) return encode(*options);
    if (const auto* run = std::get_if<Run>(&message)) return encode(*run, port_info());
    return "message " + std::to_string(message.index());
  } catch (const ProtocolError& error) {
    return error.what();
  }
}

std::string tell_lines(const std::vector<std::string>& lines, const std::string& by,
                       const Outcome& outcome_of) {
  std::string text;
  for (const std::string& line : lines) text += tell(line, by, outcome_of) + "\n";
  return text;
}

std::string model_of(const std::string& text,
                     Model (*read)(std::string_view, const std::string&, const ModelReading&)) {
  try {
    std::ostringstream out;
    find_exporter("dot").write(out, read(text, "file", {}), {"file", MarkLoss::accept});
    return std::regex_replace(out.str(), std::regex("\\s+"), " ");
  } catch (const Error& error) {
    return error.what();
  }
}

// Over programs and models that it may name.
const System& two_programs() {
  static const System system = parse(
      "models: {via: {file: strict-1.dot}, sync: {use: mutex}}\n"
      "programs: {p: \"via.write; @half via.write;\", q: \"loop { via.read -> message; }\"}\n");
  return system;
}

std::string without_version(std::string text) {
  const std::string words = "tool: \"maide\" \"" + std::string(version()) + "\"";
  const std::size_t at = text.find(words);
  return at == std::string::npos ? text : text.replace(at, words.size(), "tool: maide");
}

std::string automaton_of_formula(const std::string& text) {
  static const std::vector<ProgramInterface> interfaces = two_programs().interfaces();
  const FormulaScope scope{two_programs().programs, interfaces};
  try {
    const Formula formula = parse_formula(ScalarText(text, text, {"formula", 1, 1}), scope);
    std::ostringstream out;
    write_hoa(out, translate(formula), scope, to_string(formula, scope));
    return without_version(out.str());
  } catch (const Error& error) {
    return std::string(error.what()) + "\n";
  }
}

std::string automaton_of_hoa(const std::string& text) {
  static const std::vector<ProgramInterface> interfaces = two_programs().interfaces();
  const FormulaScope scope{two_programs().programs, interfaces};
  try {
    std::ostringstream out;
    write_hoa(out, read_hoa(text, "a.hoa", scope), scope, "");
    return std::regex_replace(without_version(out.str()), std::regex("\\s+"), " ");
  } catch (const Error& error) {
    return error.what();
  }
}

std::string log_of(const std::string& text) {
  try {
    std::ostringstream out;
    write_trace_log(out, read_trace_log(text, "log"));
    return std::regex_replace(out.str(), std::regex("\\n"), "|");
  } catch (const Error& error) {
    return error.what();
  }
}

std::string tell(const std::string& name, const std::string& by) {
  if (name == "everything") return tell(everything, by, outcome_of_system);
  if (name == "nodes") return tell(nodes, by, outcome_of_system);
  if (name == "dot") return tell(dot, by, [](auto& text) { return model_of(text, read_dot); });
  if (name == "mealy") return tell(mealy, by, [](auto& text) { return model_of(text, read_dot); });
  if (name == "aut") return tell(aut, by, [](auto& text) { return model_of(text, read_aut); });
  if (name == "hoa") return tell(hoa, by, automaton_of_hoa);
  if (name == "log") return tell(log, by, log_of);
  if (name == "from-wrapper") return tell_lines(lines_from_wrapper, by, message_from);
  return tell_lines(lines_to_wrapper, by, message_to);
}

class LeftOut : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(LeftOut, IsAsApproved) {
  const std::string name = std::get<0>(GetParam()), by = std::get<1>(GetParam());
  const std::string text = by == "nothing" ? "" : by == "zero" ? "0" : by;
  expect_approved(name + ".words." + by + ".txt", tell(name, text));
}

INSTANTIATE_TEST_SUITE_P(Words, LeftOut,
                         testing::Combine(testing::Values("everything", "nodes", "dot", "mealy",
                                                          "aut", "hoa", "log", "from-wrapper",
                                                          "to-wrapper"),
                                          testing::Values("nothing", "twice", "zero", "n")),
                         [](const auto& test) {
                           std::string name =
                               std::string(std::get<0>(test.param)) + "_" + std::get<1>(test.param);
                           for (char& letter : name) letter = letter == '-' ? '_' : letter;
                           return name;
                         });

// Each formula, its automaton, or why it is none.
TEST(Formulas, AreTheAutomataThatWereApproved) {
  std::string text;
  for (const std::string_view line : split_lines(formulas)) {
    text += std::string(line) + "\n" + automaton_of_formula(std::string(line)) + "\n";
  }
  expect_approved("formulas.txt", text);
}

}  // namespace
}  // namespace maide
