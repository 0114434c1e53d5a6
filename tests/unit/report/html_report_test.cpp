#include "maide/report/html_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "maide/check/build/system_file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "maide/report/trace_text.hpp"

namespace maide {
namespace {

using testing::HasSubstr;
using testing::Not;

// A connection that never has a message to give.
InterfaceAutomaton silent_connection() {
  InterfaceAutomaton automaton({"read"}, {"message"}, 2);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  return automaton;
}

System waiting_system() {
  return parse_system(
      "models:\n  via: {file: via.dot}\nprograms:\n  reader: |\n    via.read -> message;\n",
      "a<b.yaml", [](const ModelRequest&) { return silent_connection(); });
}

// The reader gives its read and waits for ever.
Trace the_only_run(const System& system) {
  Trace trace;
  for (GlobalState state = initial_state(system); !enabled_steps(system, state).empty();
       state = apply(system, state, trace.steps.back())) {
    trace.steps.push_back(enabled_steps(system, state).front());
  }
  return trace;
}

TEST(TraceChart, HasALaneForEachPartAndSaysWhatIsWaitedFor) {
  const System system = waiting_system();
  const SequenceChart chart = make_trace_chart(system, the_only_run(system), "title");
  ASSERT_EQ(chart.lanes.size(), 2U);
  EXPECT_EQ(chart.lanes[0].name, "reader");
  EXPECT_TRUE(chart.lanes[1].is_model);
  ASSERT_EQ(chart.messages.size(), 1U);
  EXPECT_EQ(chart.messages[0].from, 0U);
  EXPECT_EQ(chart.messages[0].to, 1U);
  EXPECT_EQ(chart.messages[0].label, "read");
  EXPECT_EQ(chart.messages[0].place, "line 5");
  ASSERT_EQ(chart.notes.size(), 1U);
  EXPECT_EQ(chart.notes[0].text, "waits: via!message");
}

TEST(HtmlReport, ShowsVerdictsChartsAndModels) {
  const System system = waiting_system();
  CheckReport report;
  report.verdict = Verdict::violated;
  report.assumptions = {"x < y"};
  PropertyResult& result = report.properties.emplace_back();
  result.name = "deadlock";
  result.verdict = Verdict::violated;
  result.trace = the_only_run(system);
  std::ostringstream out;
  write_html_report(out, system, report,
                    [](const InterfaceAutomaton&) { return "<svg id=\"model\"/>"; });
  EXPECT_THAT(out.str(), HasSubstr("a&lt;b.yaml"));
  EXPECT_THAT(out.str(), Not(HasSubstr("a<b")));
  EXPECT_THAT(out.str(), HasSubstr("x &lt; y"));
  EXPECT_THAT(out.str(), HasSubstr("marker-end"));
  EXPECT_THAT(out.str(), HasSubstr("<svg id=\"model\"/>"));
  EXPECT_THAT(out.str(), HasSubstr("<p class=\"why\">reader waits at line 5 for a message from "
                                   "via; via has nothing to give"));
  EXPECT_THAT(out.str(),
              HasSubstr("<mark class=\"waits\">    5      via.read -&gt; message;</mark>"));
}

// The timer's callback waits in its second line; the other node rests. Models of executors are not
// the file's.
TEST(HtmlReport, ShowsWhereNodesWait) {
  const System system = parse_system(
      "models:\n"
      "  go: {use: semaphore, with: {count: 1}}\n"
      "  never: {use: queue, with: {size: 1}}\n"
      "executors:\n"
      "  main: {kind: multi, threads: 2}\n"
      "nodes:\n"
      "  n:\n"
      "    executor: main\n"
      "    callbacks:\n"
      "      t:\n"
      "        timer: 1\n"
      "        do: |\n"
      "          go.acquire;\n"
      "          go.acquire;\n"
      "  idle:\n"
      "    callbacks: {c: {takes: never.read -> message, do: \"go.release;\"}}\n",
      "s.yaml");
  NativeEngine engine;
  const CheckReport report = check_system(system, engine, {{"deadlock"}, {}});
  ASSERT_EQ(report.verdict, Verdict::violated);
  std::ostringstream out;
  write_html_report(out, system, report, {});
  EXPECT_THAT(out.str(), HasSubstr("<h3>n <small>waits here</small></h3>"));
  EXPECT_THAT(out.str(), HasSubstr("<mark class=\"waits\">   14            go.acquire;</mark>"));
  EXPECT_THAT(out.str(), HasSubstr("<h3>idle <small>rests</small></h3>"));
  EXPECT_THAT(out.str(), Not(HasSubstr("model main.threads")));
}

}  // namespace
}  // namespace maide
