// Queues carry the values that occur: what a variable could hold besides changes nothing.
#include "maide/check/build/value_flow.hpp"

#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <vector>

#include "maide/base/error.hpp"
#include "maide/base/run_control.hpp"
#include "maide/check/build/build_system.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/system/steps.hpp"
#include "maide/check/system/trace.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using Texts = std::vector<std::string>;

System system_of_text(const std::string& text, const RunControl& control = {}) {
  const Declarations declared = declare(read_tree(text, "s.yaml"));
  return build_system(declared, find_models(declared, test::test_model, {}, control), {}, control);
}

// "TOP" stands for the greatest value of each range.
std::string with_top(std::string text, const std::string& top) {
  for (std::size_t at = text.find("TOP"); at != std::string::npos; at = text.find("TOP")) {
    text.replace(at, 3, top);
  }
  return text;
}

// Counts, verdicts and the steps of runs.
Texts outcome(const System& system) {
  NativeEngine engine;
  Texts result;
  for (const PropertyResult& property : check_system(system, engine, {}).properties) {
    std::string line = property.name + " " + to_string(property.verdict) + " " +
                       std::to_string(property.states) + " " + std::to_string(property.transitions);
    if (property.trace) {
      for (const Step& step : property.trace->steps) {
        const StepText text = describe_step(system, step);
        line += " " + text.actor + " " + text.model + " " + text.event;
      }
    }
    result.push_back(line);
  }
  return result;
}

constexpr const char* forward =
    "models: {p: {use: queue, with: {size: 1}}, q: {use: queue, with: {size: 1}}}\n"
    "programs:\n"
    "  a: \"p.write(5);\"\n"
    "  f: \"var x: 0..TOP; p.read -> message(x); q.write(x);\"\n"
    "  g: \"var x: 0..TOP; q.read -> message(x); idle q.read -> message(x);\"\n";

TEST(ValueFlow, AQueueCarriesWhatOccurs) {
  const System system = system_of_text(with_top(forward, "800"));
  for (const ModelInstance& queue : system.models) {
    EXPECT_EQ(queue.automaton.inputs().names(), (Texts{"write(5)", "read"})) << queue.name;
    EXPECT_EQ(queue.automaton.outputs().names(), (Texts{"message(5)"})) << queue.name;
  }
}

// A thousand times the range, the same states, steps and runs.
class Ranges : public testing::TestWithParam<const char*> {};

TEST_P(Ranges, ChangeNothing) {
  EXPECT_EQ(outcome(system_of_text(with_top(GetParam(), "9"))),
            outcome(system_of_text(with_top(GetParam(), "9000"))));
}

INSTANTIATE_TEST_SUITE_P(
    ValueFlow, Ranges,
    testing::Values(
        forward,
        // what is computed of a value
        "models: {q: {use: queue, with: {size: 2}}}\n"
        "programs:\n"
        "  a: \"var n: 0..TOP = 2; repeat 2 { q.write(n * 3 + 1); n = n - 1; }\"\n"
        "  b: \"var x: 0..TOP; loop { idle q.read -> message(x); if (x > 4) { @big skip; } }\"\n"
        "properties: {never_big: \"G !b@big\", written: \"F q.write(7)\", other: \"G "
        "!q.write(8)\"}\n",
        // two values each, in a `select` with guards, given on in a ring
        "models:\n  q[i in 0..1]: {use: queue, with: {size: 1}}\n"
        "programs:\n"
        "  p[i in 0..1]: |\n"
        "    var x: 0..TOP = 3; var y: 0..TOP;\n"
        "    if (i == 0) { q[1].write(x, 1); }\n"
        "    loop {\n"
        "      select {\n"
        "        when (x > 0) on q[i].read -> message(x, y) { }\n"
        "        when (x == 0) { stop; }\n"
        "      }\n"
        "      if (x > 0) { q[1 - i].write(x - 1, y); }\n"
        "    }\n",
        // a topic of two readers, and an error behind the range
        "topics: {t: {writers: w, readers: [r, s], use: queue, with: {depth: 1}}}\n"
        "programs:\n"
        "  w: \"var n: 0..TOP; n = any 1..3; t.write(n); t.write(n + 1);\"\n"
        "  r: \"var x: 0..TOP; loop { idle t.read -> message(x); }\"\n"
        "  s: \"var x: 0..3; loop { idle t.read -> message(x); }\"\n",
        // shared variables, `atomic`, and a death
        "models: {q: {use: queue, with: {size: 1}, ends: {writer: [a], reader: [b]}}}\n"
        "variables: \"var turn: 0..2;\"\n"
        "programs:\n"
        "  a: {do: \"var n: 0..TOP; while (turn < 2) { n = turn; q.write(n); "
        "atomic { turn = turn + 1; } }\", may_die: true}\n"
        "  b: \"var x: 0..TOP; loop { idle q.read -> message(x); if (turn == 2) { stop; } }\"\n",
        // callbacks, by rounds
        "topics: {t: {writers: w, readers: n, use: queue, with: {depth: 2}}}\n"
        "models: {q: {use: queue, with: {size: 1}}}\n"
        "executors: {e: {kind: single, order: rounds}}\n"
        "programs:\n"
        "  w: \"var k: 0..TOP = 4; t.write(k); t.write(k * 2);\"\n"
        "  r: \"var x: 0..TOP; repeat 2 { q.read -> message(x); }\"\n"
        "nodes:\n"
        "  n:\n"
        "    executor: e\n"
        "    variables: \"var last: 0..TOP;\"\n"
        "    callbacks:\n"
        "      on: {takes: \"t.read -> message(last)\", do: \"q.write(last);\"}\n"));

// Words are values, too; a formula may name what never occurs, if it is of the type.
TEST(ValueFlow, AFormulaMayNameWhatNeverOccurs) {
  const std::string system =
      "models: {q: {use: queue, with: {size: 1}}}\n"
      "programs:\n"
      "  a: \"var m: {idle, busy, lost}; q.write(m, 3); m = busy; q.write(m, 3);\"\n"
      "  b: \"repeat 2 { q.read -> message; }\"\n"
      "properties:\n";
  const System known =
      system_of_text(system + "  p: \"G !q.write(lost,3) && G !q!message(lost,3)\"\n");
  EXPECT_EQ(known.models[0].automaton.inputs().names(),
            (Texts{"write(idle,3)", "write(busy,3)", "read"}));
  EXPECT_EQ(outcome(known).back().substr(0, 7), "p holds");
  EXPECT_NE(test::error_of([&] {
              system_of_text(system + "  p: \"G !q.write(gone,3)\"\n");
            }).find("has no input 'write(gone,3)'"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              system_of_text(system + "  p: \"G !q.write(lost,4)\"\n");
            }).find("has no input 'write(lost,4)'"),
            std::string::npos);
}

// Where control never comes to the write, the names say nevertheless that there is a value.
TEST(ValueFlow, WhatIsNeverWrittenHasAValue) {
  const System system = system_of_text(
      "models: {q: {use: queue, with: {size: 1}}}\n"
      "programs: {a: \"if (1 > 2) { q.write(7); }\", b: \"idle q.read -> message(var x);\"}\n");
  EXPECT_EQ(outcome(system).front().substr(0, 14), "deadlock holds");
}

TEST(ValueFlow, HearsThatItIsToStop) {
  std::stop_source source;
  source.request_stop();
  RunControl late;
  late.stop = source.get_token();
  EXPECT_THROW(system_of_text("models: {q: {use: queue, with: {size: 1}}}\n"
                              "programs: {a: \"for n in 0..20000 { q.write(n); }\"}\n",
                              late),
               Interrupted);
}

}  // namespace
}  // namespace maide
