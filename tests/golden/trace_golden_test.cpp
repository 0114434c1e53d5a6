// How counterexamples are shown, byte for byte, against approved files: as a chart in ASCII and in
// UTF-8, as steps, as SVG, as a page. The runs are given and not searched for, so that no engine
// matters. After a change that is meant: MAIDE_APPROVE=1 build/dev/bin/test_golden.
#include <gtest/gtest.h>

#include <sstream>

#include "approved.hpp"
#include "maide/base/file.hpp"
#include "maide/check/build/system_file.hpp"
#include "maide/check/rules/model_words.hpp"
#include "maide/report/html_report.hpp"
#include "maide/report/trace_text.hpp"
#include "scheduled_run.hpp"

namespace maide {
namespace {

const std::string folder = MAIDE_SOURCE_DIR "/examples/";

// A counterexample and what it is called.
struct Shown {
  std::string name;
  System system;
  std::string property;
  Trace trace;
};

System read_example(const std::string& file) {
  System system = parse_system(read_file(folder + file), file, [](const ModelRequest& request) {
    ModelRequest local = request;
    local.file = folder + "models/" + request.file.filename().string();
    return read_requested_model(local);
  });
  return system;
}

// An arrival, a loss, what waits for an answer, and what is on its way at the end.
Shown late_messages(const std::string& name) {
  System system = parse_system(
      "topics:\n"
      "  map: {writers: [server], readers: [robot], use: queue, with: {depth: 3},"
      " loses: true}\n"
      "services:\n  lookup: {server: server, clients: [robot]}\n"
      "programs:\n"
      "  server: |\n    map.write;\n    lookup.serve -> request;\n    map.write;\n"
      "    map.write;\n    lookup.answer;\n"
      "  robot: |\n    lookup.send;\n    lookup.receive -> answer;\n"
      "    switch map.tryread { message { skip; } null { @missed skip; } }\n"
      "properties:\n  first: \"G !robot@missed\"\n",
      "late.yaml", read_requested_model);
  Trace trace;
  GlobalState state = initial_state(system);
  const auto take = [&](std::uint32_t actor, const std::string& what) {
    for (const Step& step : enabled_steps(system, state)) {
      if (step.actor != actor) continue;
      if (actor == nobody && describe_action(system, step) != what) continue;
      trace.steps.push_back(step);
      state = apply(system, state, step);
      return;
    }
    FAIL() << "no step " << what;
  };
  for (const char* const what : {"0", "1", "map!lost", "lookup!request_arrives", "0", "0", "0", "0",
                                 "0", "1", "lookup!answer_arrives", "1", "1", "1"}) {
    const bool is_program = std::string(what).size() == 1;
    take(is_program ? static_cast<std::uint32_t>(what[0] - '0') : nobody, what);
  }
  return {name, std::move(system), "first", std::move(trace)};
}

Shown shown(const std::string& name) {
  if (name == "lost-messages") {
    System system = read_example("case-study-1/buffered.yaml");
    Trace trace = test::run_in_turns(system, "0000000111");
    return {name, std::move(system), "deadlock", std::move(trace)};
  }
  if (name == "thousand-steps") {
    System system = read_example("case-study-2/90-100-100-size-1.yaml");
    Trace trace = test::run_by_priority(system, {0, 1, 2});
    return {name, std::move(system), "deadlock", std::move(trace)};
  }
  if (name == "late-messages") return late_messages(name);
  // The first producer never writes; the second goes round.
  System system = parse_system(
      "models: {via: {file: strict-1.dot}, sync: {file: buffered.dot}}\nprograms:\n"
      "  tracker: |\n    if * {\n      via.write;\n    } else {\n      stop;\n    }\n"
      "  planner: |\n    loop {\n      sync.write;\n      sync.read -> message;\n    }\n"
      "  controller: |\n    @start via.read -> message;\n",
      "tracker.yaml", [](const ModelRequest& request) {
        ModelRequest local = request;
        local.file = folder + "models/" + request.file.filename().string();
        return read_requested_model(local);
      });
  Trace trace;
  GlobalState state = initial_state(system);
  for (const Step& step : enabled_steps(system, state)) {
    if (step.actor == 0) trace.steps = {step};  // the last: `else`
  }
  for (const std::uint32_t program : {2, 1, 1, 1}) {
    state = replay(system, trace).back();
    trace.steps.push_back(test::first_step(system, state, program).value());
  }
  trace.loop_start = 2;
  return {name, std::move(system), "stuck", std::move(trace)};
}

std::string write(const Shown& counterexample, const std::string& format) {
  const auto& [name, system, property, trace] = counterexample;
  std::ostringstream out;
  if (format == "ascii.txt") write_trace_text(out, system, trace);
  if (format == "utf8.txt") {
    write_trace_text(out, system, trace, TraceFormat::chart, {.width = 120, .unicode = true});
  }
  if (format == "narrow.txt") {
    write_trace_text(out, system, trace, TraceFormat::chart, {.width = 30});
  }
  if (format == "steps.txt") write_trace_text(out, system, trace, TraceFormat::steps);
  if (format == "svg") write_sequence_chart_svg(out, make_trace_chart(system, trace, name));
  if (format == "html") {
    CheckReport report;
    report.verdict = Verdict::violated;
    PropertyResult& result = report.properties.emplace_back();
    result.name = property;
    result.verdict = Verdict::violated;
    result.trace = trace;
    write_html_report(out, system, report, {});
  }
  return out.str();
}

class TraceGolden : public testing::TestWithParam<std::tuple<const char*, const char*>> {};

TEST_P(TraceGolden, IsAsApproved) {
  const auto [name, format] = GetParam();
  const Shown counterexample = shown(name);
  ASSERT_EQ(find_flaw(counterexample.system,
                      find_property(counterexample.system, counterexample.property),
                      counterexample.trace),
            "");
  const std::string text = write(counterexample, format);
  test::expect_approved(std::string(name) + "." + format, text);
}

INSTANTIATE_TEST_SUITE_P(Traces, TraceGolden,
                         testing::Combine(testing::Values("lost-messages", "thousand-steps",
                                                          "never-again", "late-messages"),
                                          testing::Values("ascii.txt", "utf8.txt", "narrow.txt",
                                                          "steps.txt", "svg", "html")),
                         [](const auto& test) {
                           std::string name =
                               std::string(std::get<0>(test.param)) + "_" + std::get<1>(test.param);
                           for (char& letter : name) {
                             letter = letter == '-' || letter == '.' ? '_' : letter;
                           }
                           return name;
                         });

}  // namespace
}  // namespace maide
