// Steps of nobody: a message that a program sends is on a wire, and arrives by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "maide/check/build/parse_program.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/spin_engine.hpp"
#include "maide/check/system/trace_file.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/report/explanation.hpp"
#include "maide/report/sequence_chart.hpp"
#include "maide/report/trace_text.hpp"
#include "systems.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;
using Kind = ModelUse::Kind;

// `send` puts one more of at most `room` messages on the wire.
ModelInstance make_wire(StateId room) {
  ModelInstance wire;
  wire.name = "wire";
  wire.source = ModelInstance::Source::wire;
  wire.automaton = InterfaceAutomaton(Alphabet({"send"}), Alphabet({"none"}), room + 1);
  ModelAction arrives{"wire arrives", {}};
  for (StateId held = 0; held <= room; ++held) {
    if (held < room) wire.automaton.add_transition(held, {Action::Kind::input, 0}, held + 1);
    arrives.steps.emplace_back();
    if (held > 0) arrives.steps.back().push_back({held - 1, false});
    wire.state_texts.push_back(held == 0 ? "" : std::to_string(held) + " of writer");
  }
  wire.actions.push_back(std::move(arrives));
  return wire;
}

struct WireOptions {
  bool is_fair = true, counts_for_deadlock = true;
};

// A wire to `via`, a port for two messages. What has arrived is written there, by nobody.
System wire_system(const std::vector<std::pair<std::string, std::string>>& programs,
                   const WireOptions& options = {}) {
  System system = system_of("  unused: skip;\n", "", "wait");
  system.programs.clear();
  system.models.push_back(make_wire(2));
  const auto via = static_cast<std::uint32_t>(0), wire = static_cast<std::uint32_t>(2);
  NobodysAction arrival;
  arrival.what.uses = {{Kind::act, wire, 0}, {Kind::give, via, 0}};
  arrival.what.events = {{Kind::give, via, 0}};
  arrival.what.text = "via arrives";
  arrival.what.fair = options.is_fair ? 1 : 0;
  arrival.counts_for_deadlock = options.counts_for_deadlock;
  arrival.position = {"system.yaml", 3, 1};
  system.nobodys_groups = {"", "wire"};
  system.nobodys_actions.push_back(std::move(arrival));
  for (const auto& [name, text] : programs) {
    system.programs.push_back(
        parse_program(name, ScalarText(text, text, {"system.yaml", 7, 1}), system));
  }
  return system;
}

const std::pair<std::string, std::string> writer{"writer", "repeat 2 { wire.send; }"};
const std::pair<std::string, std::string> reader{"reader", "repeat 2 { via.read -> message; }"};
const std::pair<std::string, std::string> spinner{"spinner",
                                                  "loop { sync.write; sync.read -> message; }"};

CheckReport check_all(const System& system) {
  NativeEngine engine;
  return check_system(system, engine, {});
}

TEST(Nobody, WhereAMessageMayArriveIsNoDeadlock) {
  for (const auto& [property, verdict] :
       {std::pair("deadlock", Verdict::holds), std::pair("stuck", Verdict::holds)}) {
    const System system = wire_system({writer, reader});
    const CheckReport report = check_all(system);
    for (const PropertyResult& result : report.properties) {
      if (result.name == property) {
        EXPECT_EQ(result.verdict, verdict) << property;
      }
    }
  }
  const CheckReport idle = check_all(wire_system({writer, reader}, {.counts_for_deadlock = false}));
  EXPECT_EQ(idle.properties[0].verdict, Verdict::violated);
  ASSERT_TRUE(idle.properties[0].trace.has_value());
  EXPECT_EQ(idle.properties[0].trace->steps.size(), 3U);  // both are sent, and one read begins
}

TEST(Nobody, IsAskedByFairnessWhereAGroupSaysSo) {
  Property stuck;
  stuck.name = "stuck";
  stuck.kind = Property::Kind::stuck;
  NativeEngine engine;
  // Who spins joins no wire: together in one component by the third model.
  for (const bool is_fair : {true, false}) {
    const System system = wire_system({writer, reader, spinner}, {.is_fair = is_fair});
    for (const Reduction reduction :
         {Reduction::none, Reduction::calls, Reduction::order, Reduction::full}) {
      EngineOptions options;
      options.reduction = reduction;
      const PropertyResult result = engine.check(system, stuck, options);
      EXPECT_EQ(result.verdict, is_fair ? Verdict::holds : Verdict::violated);
      if (result.trace) {
        EXPECT_EQ(find_flaw(system, stuck, *result.trace), "");
      }
    }
  }
}

// A clock ticks for ever, and nobody but it does anything.
TEST(Nobody, StepsOnAloneWhileAProgramIsStuck) {
  System system = wire_system({{"reader", "sync.read -> message; wire.send;"}});
  NobodysAction tick;
  tick.what.uses = {{Kind::quiet, 0, 0}};
  tick.what.text = "the clock ticks";
  system.nobodys_actions.push_back(tick);
  system.programs[0].names = {0, 1, 2};
  const CheckReport report = check_all(system);
  EXPECT_EQ(report.properties[0].verdict, Verdict::holds);  // deadlock
  ASSERT_EQ(report.properties[1].name, "stuck");
  ASSERT_EQ(report.properties[1].verdict, Verdict::violated);
  const Trace& trace = *report.properties[1].trace;
  EXPECT_EQ(trace.steps.back().actor, nobody);
  EXPECT_THAT(explain(system, find_property(system, "stuck"), trace),
              HasSubstr("what happens by itself goes on for ever"));
}

TEST(Nobody, BelongsToTheComponentWhoseModelsItUses) {
  const System system = wire_system({writer, reader, spinner});
  EXPECT_EQ(find_components(system), (std::vector<std::vector<std::uint32_t>>{{0, 1}, {2}}));
  const SystemPart of_wire(system, {0, 1}), of_spinner(system, {2});
  EXPECT_EQ(of_wire.system().nobodys_actions.size(), 1U);
  EXPECT_TRUE(of_spinner.system().nobodys_actions.empty());
  Step arrival;
  arrival.actor = nobody;
  EXPECT_TRUE(of_wire.has(arrival));
  EXPECT_FALSE(of_spinner.has(arrival));
  EXPECT_EQ(of_wire.to_whole(of_wire.from_whole(arrival)), arrival);
}

TEST(Nobody, IsInSpinsTextAProcessThatCountsNowhere) {
  NativeEngine native;
  SpinOptions fast;
  fast.optimisation = "-O0";
  SpinEngine spin(fast);
  for (const bool counts : {true, false}) {
    for (const auto& programs :
         {std::vector{writer, reader}, std::vector{writer, reader, spinner}, std::vector{reader}}) {
      const System system = wire_system(programs, {.counts_for_deadlock = counts});
      const PropertyResult ours = native.check(system, deadlock_property(), {});
      const PropertyResult theirs = spin.check(system, deadlock_property(), {});
      EXPECT_EQ(theirs.verdict, ours.verdict) << theirs.reason;
      if (ours.verdict == Verdict::holds) {
        EXPECT_EQ(theirs.states, ours.states);
      }
    }
  }
  const System system = wire_system({writer, reader});
  Property property;
  property.name = "arrives";
  FormulaNode atom;
  atom.op = FormulaNode::Operator::atom;
  atom.atom = {Atom::Kind::input, 0, 0, Atom::any_program};
  FormulaNode never;
  never.op = FormulaNode::Operator::finally;
  never.left = std::make_shared<const FormulaNode>(atom);
  property.formula = std::make_shared<const FormulaNode>(never);
  property.fairness = Fairness::none;
  EXPECT_EQ(native.check(system, property, {}).verdict, Verdict::holds);
  EXPECT_EQ(spin.check(system, property, {}).verdict, Verdict::holds);
  property.fairness = Fairness::weak;
  EXPECT_EQ(native.check(system, property, {}).verdict, Verdict::holds);
  EXPECT_THAT(spin.obstacle(system, property), HasSubstr("--engine native"));
}

// The run in which both messages arrive and one is read.
Trace run_of(const System& system) {
  Trace trace;
  const StepsByTheBook steps(system);
  GlobalState state = steps.initial();
  for (const std::uint32_t actor : {0U, 0U, nobody, nobody, 1U, 1U}) {
    std::optional<StepBefore> first;
    GlobalState next;
    steps.by_event(
        state, {actor, {}},
        [&](const GlobalState& after, std::size_t, std::uint32_t, bool, std::uint64_t code) {
          if (first) return;
          first = steps.undo(after, code);
          next = after;
        });
    trace.steps.push_back(first.value().step);
    state = next;
  }
  return trace;
}

TEST(Nobody, IsReadBackFromATraceOfVersionTwo) {
  System system = wire_system({writer, reader});
  system.nobodys_actions[0].origin = SourcePosition{"robot.cpp", 41, 0};
  system.nobodys_actions[0].lost = "nothing";
  Program& program = system.programs[0];
  program.origins = {{}, {"writer.cpp", 12, 7}};
  for (ProgramEdge& edge : program.edges) edge.origin = 1;
  const Trace trace = run_of(system);
  const Json file = trace_file_to_json(system, "it", trace);
  EXPECT_EQ(file["version"], 2);
  const Json& steps = file["steps"];
  EXPECT_EQ(to_json_line(steps[0]), R"({"actor":"writer","line":1,"model":"wire","event":"?send",)"
                                    R"("origin":{"file":"writer.cpp","line":12,"column":7},)"
                                    R"("on_its_way":{"wire":"1 of writer"}})");
  EXPECT_EQ(to_json_line(steps[2]), R"({"actor":null,"line":3,"model":null,"event":"via arrives",)"
                                    R"("origin":{"file":"robot.cpp","line":41},)"
                                    R"("on_its_way":{"wire":"1 of writer"},"lost":"nothing"})");
  EXPECT_FALSE(steps[3].contains("on_its_way"));
  EXPECT_EQ(parse_trace(to_json_line(file), "t.json", system).trace, trace);
  // `--json` says the same of a step, and calls its actor `program`.
  EXPECT_TRUE(trace_to_json(system, trace)[2]["program"].is_null());
  Json later = file;
  later["version"] = 3;
  EXPECT_THAT(error_of([&] { parse_trace(to_json_line(later), "t.json", system); }),
              HasSubstr("a trace of version 3; this maide reads up to version 2 (t.json)"));
}

TEST(Nobody, HasALineInTextsAndANoteInCharts) {
  const System system = wire_system({writer, reader});
  const Trace trace = run_of(system);
  std::ostringstream text;
  write_trace_text(text, system, trace, TraceFormat::steps, {});
  EXPECT_THAT(text.str(), HasSubstr("    3  -       system.yaml:3  via arrives"));
  const SequenceChart chart = make_trace_chart(system, trace, "");
  ASSERT_EQ(chart.messages.size(), 6U);
  EXPECT_EQ(chart.messages[2].label, "via arrives");
  EXPECT_EQ(chart.lanes[chart.messages[2].from].name, "via");  // wires have no lane
  EXPECT_EQ(chart.lanes[chart.messages[2].to].name, "via");
  System hidden = system;
  hidden.nobodys_actions[0].is_shown = false;
  const SequenceChart shown = make_trace_chart(hidden, trace, "");
  ASSERT_EQ(shown.messages.size(), 4U);
  EXPECT_EQ(shown.messages[2].step, 4U);
  const SequenceChart read =
      chart_of_trace(to_json_line(trace_file_to_json(system, "it", trace)), "t.json");
  EXPECT_EQ(read.messages.size(), 6U);
}

}  // namespace
}  // namespace maide::test
