// `maide check` as a person meets it: the readable trace, the JSON, errors in one line, limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/base/file.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// A system file in a folder of its own, over the models of tests/models.
class CheckCommand : public testing::Test {
 protected:
  std::string system(const std::string& programs, const std::string& properties = "",
                     const std::string& via = "strict-2.dot") {
    const std::string path = (folder_.path() / "s.yaml").string();
    const std::string models = std::string(MAIDE_SOURCE_DIR) + "/tests/models/";
    write_file_atomically(path, "models:\n  via: {file: " + models + via + "}\n  sync: {file: " +
                                    models + "buffered.dot}\nprograms:\n" + programs +
                                    (properties.empty() ? "" : "properties:\n" + properties));
    return path;
  }
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = (folder_.path() / name).string();
    write_file_atomically(path, text);
    return path;
  }
  TempDir folder_{"maide-test-"};
};

const std::string waiting =
    "  p: |\n    via.write;\n    sync.read -> message;\n  q: |\n    via.read;\n    if * { skip; "
    "}\n";

TEST_F(CheckCommand, ReadableTrace) {
  const SubprocessResult result =
      run_with_maide("LC_ALL=C \"$maide\" check '" + system(waiting) + "'");
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.out, HasSubstr("deadlock  violated"));
  EXPECT_THAT(result.out, HasSubstr("p waits at line 7 for a message from sync; sync was given "
                                    "none; no other program would ever write"));
  EXPECT_THAT(result.out, HasSubstr("|- write ->|"));
  EXPECT_THAT(result.out, HasSubstr("line 6  via.write;"));
  EXPECT_THAT(result.out, HasSubstr("nothing can happen any more:\n  p waits at line 7 for "
                                    "sync!message; sync has nothing to give; it would take write"));
  EXPECT_THAT(result.out, HasSubstr("q has ended"));
  EXPECT_THAT(result.out, HasSubstr("via has message due, which no program takes"));
  EXPECT_THAT(result.out, HasSubstr("stuck     holds"));
  EXPECT_THAT(result.out, HasSubstr("verdict: violated"));
}

// What a run says but its times and its memory. Run under the thread sanitizer, too.
class CheckThreads : public CheckCommand {};

TEST_F(CheckThreads, FindTheSame) {
  const auto programs = [](const std::string& rounds) {
    std::string text;
    for (const char* name : {"a", "b", "c", "d"}) {
      text += "  " + std::string(name) + ": \"repeat " + rounds +
              " { if * { sync.write; sync.read -> message; } }\"\n";
    }
    return text;
  };
  const auto result = [&](const std::string& threads, const std::string& name = "deadlock") {
    const SubprocessResult run = run_maide({"check", system(programs(name == "stuck" ? "3" : "13")),
                                            "--property", name, "--threads", threads, "--json"});
    EXPECT_LE(run.exit_status, 1) << run.err;
    Json property = Json::parse(run.out).at("properties").at(0);
    for (const char* other : {"seconds", "peak_bytes", "bytes_per_state"}) property.erase(other);
    return property;
  };
  const Json one = result("1");
  EXPECT_GT(one.at("states"), 20'000);
  EXPECT_EQ(result("2"), one);
  EXPECT_EQ(result("5"), one);
  const Json stuck = result("1", "stuck");
  EXPECT_GT(stuck.at("states"), 70'000);
  EXPECT_EQ(result("2", "stuck"), stuck);
  EXPECT_EQ(result("5", "stuck"), stuck);
  expect_error(run_maide({"check", system(waiting), "--threads", "0"}), 2, "--threads");
  expect_error(run_maide({"check", system(waiting), "--threads", "2", "--engine", "spin"}), 2,
               "spin searches with one thread; --threads is for native and ltsmin");
}

TEST_F(CheckCommand, TraceAsSteps) {
  const SubprocessResult result = run_maide({"check", system(waiting), "--trace-format", "steps"});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.out, HasSubstr("p  s.yaml:6   via.write"));
  EXPECT_THAT(result.out, HasSubstr("via.write;\n"));
  expect_error(run_maide({"check", system(waiting), "--trace-format", "poem"}), 2,
               "--trace-format");
}

TEST_F(CheckCommand, TracesAreDrawnInUtf8WhereTheLocaleIs) {
  const std::string path = system(waiting);
  const auto check = [&](const std::string& locale) {
    return run_with_maide(locale + " \"$maide\" check '" + path + "'").out;
  };
  EXPECT_THAT(check("LC_ALL=C.UTF-8"), HasSubstr("│─ write ─→│"));
  EXPECT_THAT(check("LC_ALL=C"), HasSubstr("|- write ->|"));
}

TEST_F(CheckCommand, TraceFile) {
  const std::string trace = (folder_.path() / "trace.json").string();
  const SubprocessResult result =
      run_maide({"check",
                 system("  p: loop { if * { via.write; via.read -> message; } }\n",
                        "  busy: G F via!message\n"),
                 "--property", "busy", "--trace", trace, "--json"});
  EXPECT_EQ(result.exit_status, 1);
  const Json file = Json::parse(read_file(trace));
  EXPECT_EQ(file["property"], "busy");
  ASSERT_TRUE(file["loop_start"].is_number());
  const Json& step = file["steps"][file["loop_start"].get<std::size_t>()];
  EXPECT_EQ(step["actor"], "p");
  EXPECT_EQ(step["model"], nullptr);
  EXPECT_EQ(step["event"], "else");
  const Json report = json_of(result);
  // The report calls the actor of each step a program.
  auto steps = nlohmann::json::parse(report["properties"][0]["trace"].dump());
  for (auto& said : steps) {
    said["actor"] = said["program"];
    said.erase("program");
  }
  EXPECT_EQ(steps, nlohmann::json::parse(file["steps"].dump()));
  EXPECT_EQ(report["properties"][0]["loop_start"], file["loop_start"]);
}

constexpr const char* counted =
    "constants: {n: 2, half: n / 2, ok: true}\n"
    "models: {m: {use: mutex}}\n"
    "programs: {a: 'repeat half { m.lock; m.unlock; } @d skip;'}\n"
    "properties: {never: 'G !a@d', \"<&'\\\"\": 'G !a@end'}\n";

// A run that shows that something is possible is no violation, and what is not possible is one.
TEST_F(CheckCommand, WhatIsPossibleIsShown) {
  const std::string path =
      system("  p: |\n    via.write;\n    sync.write;\n  q: |\n    via.read -> message;\n",
             "  comes: {possible: \"q@end && !p@end\"}\n  both: {possible: \"sync.write && "
             "via!message\"}\n");
  const std::string trace = (folder_.path() / "t.json").string();
  const SubprocessResult good = run_maide({"check", path, "--property", "comes", "--trace", trace});
  EXPECT_EQ(good.exit_status, 0) << good.err;
  EXPECT_THAT(good.out, testing::StartsWith("verdict: holds\n"));
  EXPECT_THAT(good.out, HasSubstr("\ncomes  possible  ("));
  EXPECT_THAT(good.out, HasSubstr("  q@end holds after step 3, and p@end does not hold after"));
  EXPECT_THAT(good.out, Not(HasSubstr("violated")));
  EXPECT_EQ(parse_json(read_file(trace), trace)["steps"].size(), 3U);
  const std::string junit = (folder_.path() / "j.xml").string();
  const SubprocessResult bad = run_maide({"check", path, "--property", "both", "--junit", junit});
  EXPECT_EQ(bad.exit_status, 1) << bad.err;
  EXPECT_THAT(bad.out, testing::StartsWith("verdict: violated (both: not possible)\n"));
  EXPECT_THAT(bad.out, HasSubstr("\nboth  not possible  ("));
  EXPECT_THAT(bad.out, HasSubstr("  no run comes to it\n"));
  EXPECT_THAT(read_file(junit), HasSubstr("no run comes to it"));
  const Json json = json_of(run_maide({"check", path, "--json"}));
  EXPECT_EQ(json["properties"][2]["verdict"], "holds");
  EXPECT_EQ(json["properties"][2]["possible"], true);
  EXPECT_EQ(json["properties"][2]["trace"].size(), 3U);
  EXPECT_EQ(json["properties"][3]["possible"], false);
  EXPECT_FALSE(json["properties"][0].contains("possible"));
  const std::string page = (folder_.path() / "r.html").string();
  run_maide({"check", path, "--report", page});
  EXPECT_THAT(read_file(page), HasSubstr("comes: how it is possible"));
  EXPECT_THAT(run_maide({"format", path}).err + read_file(path),
              HasSubstr("comes: {possible: \"q@end && !p@end\"}"));
}

TEST_F(CheckCommand, JUnitHasACaseForEachProperty) {
  const std::string path = file("s.yaml", counted), junit = (folder_.path() / "r.xml").string();
  const SubprocessResult result = run_maide({"check", path, "--junit", junit, "--set", "n=4"});
  EXPECT_EQ(result.exit_status, 1) << result.err;
  const std::string text = read_file(junit);
  EXPECT_THAT(text, HasSubstr("<testsuite name=\"s\" tests=\"4\" failures=\"2\" errors=\"0\""));
  EXPECT_THAT(text, HasSubstr("<property name=\"constant n\" value=\"4\"/>"));
  EXPECT_THAT(text, testing::ContainsRegex("classname=\"s\" name=\"deadlock\" time=\"[0-9.]+\"/>"));
  EXPECT_THAT(text, testing::ContainsRegex(
                        "name=\"never\" time=\"[0-9.]+\">\n      <failure message=\"a@d holds"));
  EXPECT_THAT(text, HasSubstr("name=\"&lt;&amp;&apos;&quot;\""));
  // An answer that is none is an error, and standard output is a file like others.
  const SubprocessResult limited =
      run_maide({"check", MAIDE_SOURCE_DIR "/examples/case-study-2/nonblocking-drop.yaml",
                 "--property", "deadlock", "--memory", "1", "--junit", "-"});
  EXPECT_EQ(limited.exit_status, 3);
  EXPECT_THAT(limited.out, testing::StartsWith("<?xml"));
  EXPECT_THAT(limited.out, testing::ContainsRegex("name=\"deadlock\" time=\"[0-9.]+\">\n      "
                                                  "<error message=\"[^\"]*needs more than 1 MiB"));
  EXPECT_THAT(limited.err, HasSubstr("verdict: inconclusive"));
  expect_error(run_maide({"check", path, "--junit", path}), 2, "write over");
  EXPECT_EQ(run_maide({"check", path, "--junit", "-", "--json"}).exit_status, 2);
  const SubprocessResult full = run_maide({"check", path, "--junit", "/dev/full"});
  EXPECT_EQ(full.exit_status, 2);
  EXPECT_THAT(full.out, HasSubstr("verdict: violated"));
}

// A violation at the line of its last step, with its run as a flow.
TEST_F(CheckCommand, SarifHasWhatIsViolated) {
  const std::string path = file("s s.yaml", counted), sarif = (folder_.path() / "r.sarif").string();
  const SubprocessResult result = run_maide({"check", path, "--sarif", sarif, "--set", "n=4"});
  EXPECT_EQ(result.exit_status, 1) << result.err;
  const Json json = parse_json(read_file(sarif), sarif);
  EXPECT_EQ(json["version"], "2.1.0");
  const Json& run = json["runs"][0];
  EXPECT_EQ(run["tool"]["driver"]["rules"].size(), 4U);
  ASSERT_EQ(run["results"].size(), 2U);
  for (const Json& found : run["results"]) {
    EXPECT_EQ(found["level"], "error");
    const Json& place = found["locations"][0]["physicalLocation"];
    EXPECT_THAT(place["artifactLocation"]["uri"].get<std::string>(),
                AllOf(testing::StartsWith("file:///"), testing::EndsWith("/s%20s.yaml")));
    const Json& steps = found["codeFlows"][0]["threadFlows"][0]["locations"];
    ASSERT_FALSE(steps.empty());
    EXPECT_EQ(steps.back()["location"]["physicalLocation"]["region"], place["region"]);
    EXPECT_FALSE(steps[0]["location"]["message"]["text"].get<std::string>().empty());
  }
  EXPECT_THAT(run["results"][0]["message"]["text"].get<std::string>(), HasSubstr("a@d holds"));
  expect_error(run_maide({"check", path, "--sarif", path}), 2, "write over");
  EXPECT_EQ(run_maide({"check", path, "--sarif", "/dev/full"}).exit_status, 2);
}

TEST_F(CheckCommand, ConstantsMayHaveOtherValues) {
  const std::string path = file("s.yaml", counted), trace = (folder_.path() / "t.json").string();
  const auto set = [&](const std::string& value) {
    return run_maide({"check", path, "--set", value});
  };
  const SubprocessResult more =
      run_maide({"check", path, "--set", "n=6", "--set", "ok=false", "--json", "--trace", trace});
  EXPECT_EQ(more.exit_status, 1) << more.err;
  const Json report = json_of(more);
  EXPECT_EQ(report["set"], (Json{{"n", "6"}, {"ok", "false"}}));
  EXPECT_THAT(report["remarks"][0].get<std::string>(), HasSubstr("n=6, ok=false"));
  EXPECT_EQ(report["properties"][2]["trace"].size(), 6u);
  EXPECT_EQ(read_file(path), counted);
  // The trace is one of the system with these values alone.
  EXPECT_EQ(Json::parse(read_file(trace))["set"], report["set"]);
  EXPECT_THAT(run_maide({"replay", path, trace}).err, HasSubstr("as in the trace: --set n=6"));
  expect_error(run_maide({"replay", path, trace, "--set", "n=4"}), 2,
               "the trace was found with n=6, ok=false, and not with n=4");
  const SubprocessResult chart = run_maide({"view", trace, "-o", trace + ".html"});
  EXPECT_THAT(read_file(trace + ".html"), HasSubstr("with n=6, ok=false"));
  // Others.
  expect_error(set("k=1"), 2, "'k' is no constant; the constants are: n, half, ok");
  expect_error(set("a=1"), 2, "'a' is no constant, it stands under 'programs:'");
  expect_error(set("n"), 2, "a constant is set as in n=5, not 'n'");
  expect_error(set("n=x"), 2, "a whole number, true or false, not 'x'");
  expect_error(set("n=9223372036854775808"), 2, "a number of 64 bits");
  expect_error(set("n=true"), 2, "the constant 'n' is a number");
  expect_error(set("ok=1"), 2, "the constant 'ok' is true or false");
  expect_error(run_maide({"check", path, "--set", "n=1", "--set", "n=2"}), 2, "set twice");
  EXPECT_EQ(set("n=-4").exit_status, 2);
  expect_error(run_maide({"export", std::string(MAIDE_SOURCE_DIR) + "/tests/models/strict-2.dot",
                          "--to", "promela", "--set", "n=1"}),
               2, "--set goes with a system");
  EXPECT_THAT(run_maide({"export", path, "--to", "promela", "--set", "n=8"}).out,
              HasSubstr("s.yaml with n=8"));
  EXPECT_THAT(run_maide({"view", path, "--stage", "tree", "--set", "n=8"}).out,
              HasSubstr("{n: 8, half: n / 2, ok: true}"));
}

TEST_F(CheckCommand, ATraceThatCannotBeWrittenLeavesTheVerdict) {
  const SubprocessResult result = run_maide(
      {"check", system("  p: sync.read -> message;\n"), "--trace", "/dev/full", "--json"});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_EQ(json_of(result).at("verdict"), "violated");
  EXPECT_THAT(result.err,
              HasSubstr("maide: cannot write the file: No space left on device (/dev/full)\n"));
  EXPECT_EQ(run_maide({"check", system("  p: sync.write;\n"), "--trace", "/dev/full"}).exit_status,
            0);
  const SubprocessResult report = run_maide(
      {"check", system("  p: sync.read -> message;\n"), "--report", "/no-such-folder/r.html"});
  EXPECT_EQ(report.exit_status, 1);
  EXPECT_THAT(report.err, HasSubstr("/no-such-folder/r.html"));
}

TEST_F(CheckCommand, AFormulaWithAConstantIsNoInternalError) {
  const std::string programs = "  p: |\n    loop { sync.write; }\n";
  for (const char* engine : {"native", "spin"}) {
    const SubprocessResult result =
        run_maide({"check", system(programs, "  never: \"G (sync.write -> F false)\"\n"),
                   "--engine", engine});
    EXPECT_EQ(result.exit_status, 1) << engine << result.err;
    EXPECT_THAT(result.out, HasSubstr("whatever comes now, the property is violated"));
    EXPECT_EQ(run_maide({"check", system(programs, "  well: \"G (sync.write -> F true)\"\n"),
                         "--engine", engine})
                  .exit_status,
              0);
  }
}

TEST_F(CheckCommand, JsonOfAPropertyThatHolds) {
  const SubprocessResult result =
      run_maide({"check", system("  p: via.write;\n", "  done: F p@end\n"), "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const Json report = json_of(result);
  EXPECT_EQ(report["verdict"], "holds");
  ASSERT_EQ(report["assumptions"].size(), 2u);
  EXPECT_THAT(report["assumptions"][1].get<std::string>(), HasSubstr("via: strength unknown"));
  ASSERT_EQ(report["properties"].size(), 3u);  // and stuck
  const Json& deadlock = report["properties"][0];
  for (const char* key :
       {"name", "verdict", "states", "transitions", "seconds", "peak_bytes", "trace"}) {
    EXPECT_TRUE(deadlock.contains(key)) << key;
  }
  EXPECT_EQ(deadlock["states"], 2);
  EXPECT_GT(deadlock["peak_bytes"], 0);
  EXPECT_THAT(result.err, HasSubstr("no program uses model 'sync'"));
}

TEST_F(CheckCommand, SaysOnceWhatInstancesOfOneModelRestOn) {
  const std::string model =
      "digraph g { tests=\"not refuted by 7 words\"; strength=\"exact\"; __start0 [label=\"\"]; "
      "__start0 -> a;\n"
      "a -> b [label=\"?write\"]; b -> a [label=\"?read\"]; }";
  const std::string path = file("same.dot", model);
  const std::string other = file("other.dot", std::string(model).replace(model.find('7'), 1, "8"));
  const std::string system =
      file("system.yaml", "models:\n  a: {file: " + path + "}\n  b: {file: " + path +
                              "}\n  c: {file: " + other +
                              "}\nprograms:\n  p: a.write; b.write; c.write;\n");
  const Json report = json_of(run_maide({"check", system, "--property", "deadlock", "--json"}));
  EXPECT_EQ(report["assumptions"], Json({"a, b are hypotheses: not refuted by 7 words",
                                         "c is a hypothesis: not refuted by 8 words"}));
}

TEST_F(CheckCommand, HiddenReturnsMakeHoldsInconclusive) {
  const std::string model =
      "digraph g { inputs=\"write,read\"; outputs=\"message\"; hidden_returns=\"write\"; __start0 "
      "[label=\"\"];\n__start0 -> a; a -> b [label=\"?write\"]; b -> c [label=\"?read\"]; c -> a "
      "[label=\"!message\"]; }";
  const std::string path = file("port.dot", model);
  const SubprocessResult result =
      run_maide({"check",
                 file("h.yaml",
                      "models: {via: {file: port.dot}}\nprograms:\n  p: loop "
                      "{ via.write; via.read -> message; }\n"),
                 "--json"});
  ASSERT_EQ(result.exit_status, 3) << result.err;
  const Json report = json_of(result);
  EXPECT_THAT(report["properties"][0]["reason"].get<std::string>(),
              HasSubstr("learn with observe=message,written, write `via.write -> written;`"));
}

TEST_F(CheckCommand, TheNativeEngineIsTheDefaultAndChecksWhatSpinCannot) {
  const std::string file = system(
      "  p: '@a via.write; via.read -> message;'\n"
      "  q: loop { sync.write; sync.read -> message; }\n",
      "  next: X X q@end\n");
  const SubprocessResult next = run_maide({"check", file, "--property", "next"});
  EXPECT_EQ(next.exit_status, 1) << next.err;
  const SubprocessResult stuck =
      run_maide({"check", file, "--engine", "native", "--property", "stuck"});
  EXPECT_EQ(stuck.exit_status, 0) << stuck.out << stuck.err;
}

TEST_F(CheckCommand, SpinLeavesOutStuckAndSaysSo) {
  const SubprocessResult result = run_maide({"check", system(waiting), "--engine", "spin"});
  EXPECT_EQ(result.exit_status, 1);
  EXPECT_THAT(result.out, HasSubstr("deadlock  violated"));
  EXPECT_THAT(result.out, HasSubstr("stuck was not checked"));
}

TEST_F(CheckCommand, ErrorsAreOneLineWithThePlace) {
  expect_error(run_maide({"check", system("  p: via.wirte;\n")}), 2,
               "model via has no input 'wirte'; it has: write, read");
  expect_error(run_maide({"check", system("  p: via.wirte;\n")}), 2, "s.yaml:5:10)");
  const std::string good = system("  p: '@a via.write;'\n", "  next: X p@a\n");
  expect_error(run_maide({"check", good, "--engine", "spin"}), 2, "checks no formula with X");
  expect_error(run_maide({"check", good, "--engine", "spin", "--property", "stuck"}), 2,
               "does not check 'stuck'");
  expect_error(run_maide({"check", good, "--property", "nothing"}), 2, "there is no property");
  expect_error(run_maide({"check", good, "--engine", "magic"}), 2, "there is no engine 'magic'");
  expect_error(run_maide({"check", good, "--time", "-1"}), 2, "--time");
  expect_error(run_maide({"check", (folder_.path() / "none.yaml").string()}), 2, "none.yaml");
  expect_error(run_maide({"check", file("bad.yaml", "a: [1")}), 2, "bad.yaml:");
  file("bad.dot", "digraph g { a -> b [label=\"?x\"");
  expect_error(
      run_maide({"check", file("b.yaml", "models: {m: {file: bad.dot}}\nprograms: {p: m.x;}")}), 2,
      "bad.dot:1:");
}

// What is no regular file: an error, or a pipe that the first signal ends the waiting for.
TEST_F(CheckCommand, SystemsMayComeThroughPipesThatTheFirstSignalEnds) {
  const std::string folder = folder_.path().string();
  const std::string path = system("  p: via.write;\n");
  EXPECT_EQ(run_with_maide("cat '" + path + "' | \"$maide\" check /dev/stdin").exit_status,
            run_maide({"check", path}).exit_status);
  for (const char* writer : {"", "exec 3> pipe; "}) {
    const SubprocessResult result = run_with_maide(
        "cd '" + folder +
        "'; rm -f pipe; mkfifo pipe; \"$maide\" check pipe & run=$!; "
        "until ls -l /proc/$run/fd 2> /dev/null | grep -q pipe$; do sleep 0.01; done; " +
        writer + "kill -TERM $run; wait $run");
    expect_error(result, 3, "reading the file was interrupted");
  }
  expect_error(run_maide({"check", folder}), 2, "there is no C++ source");
  expect_error(run_maide({"check", "/dev/zero"}), 2, "cannot read the file: it is a device");
}

TEST_F(CheckCommand, ModelsAreRegularFiles) {
  const std::string pipe = (folder_.path() / "pipe.dot").string();
  const std::string error = "cannot read the file: it is no regular file";
  const SubprocessResult made = run_with_maide("mkfifo '" + pipe + "'");
  ASSERT_EQ(made.exit_status, 0);
  expect_error(run_maide({"view", pipe}), 2, error);
  const std::string path =
      file("f.yaml", "models:\n  via: {file: pipe.dot}\nprograms:\n  p: skip;\n");
  expect_error(run_maide({"check", path}), 2, error);
  expect_error(run_maide({"learn", "sim:" + pipe}), 2, error);
}

// Programs, formulas, YAML and models: the line and a caret under what is wrong.
TEST_F(CheckCommand, ErrorsShowTheSource) {
  const auto shown = [&](const std::string& path) {
    const SubprocessResult result = run_maide({"check", path});
    EXPECT_EQ(result.exit_status, 2);
    return result.err.substr(result.err.find('\n') + 1);
  };
  EXPECT_EQ(shown(system("  p: via.wirte;\n")), "    p: via.wirte;\n           ^\n");
  EXPECT_EQ(shown(system("  p: |\n    loop {\n      via.read => message;\n    }\n")),
            "        via.read => message;\n                 ^\n");
  EXPECT_EQ(shown(system("  p: '@a via.write;'\n", "  f: \"G (p@a -> F p@b)\"\n")),
            "    f: \"G (p@a -> F p@b)\"\n                      ^\n");
  EXPECT_EQ(shown(system("  p: via.write;\n", "  f: {always: p@end, fairnes: weak}\n")),
            "    f: {always: p@end, fairnes: weak}\n                       ^\n");
  file("bad.dot", "digraph g {\n  a -> b [label=];\n}\n");
  const std::string of_model =
      shown(file("b.yaml", "models: {m: {file: bad.dot}}\nprograms: {p: m.x;}"));
  EXPECT_EQ(of_model, "    a -> b [label=];\n                  ^\n");
  file("bad.dot", "\xEF\xBB\xBF/* \u00e4\u20ac */ digraph g { \u00e4 -> \u00f6 [label=]; }\n");
  EXPECT_EQ(shown(file("b.yaml", "models: {m: {file: bad.dot}}\nprograms: {p: m.x;}")),
            "  /* \u00e4\u20ac */ digraph g { \u00e4 -> \u00f6 [label=]; }\n" +
                std::string(37, ' ') + "^\n");
  file("bad.aut", "des (0, 1, 2)\n(0, \"\u00e4!\", \u00f6)\n");
  EXPECT_EQ(shown(file("c.yaml", "models: {m: {file: bad.aut}}\nprograms: {p: m.x;}")),
            "  (0, \"\u00e4!\", \u00f6)\n            ^\n");
}

TEST_F(CheckCommand, SaysWhatIsNeverReached) {
  const SubprocessResult result = run_maide(
      {"check",
       system("  p: loop { via.write; via.read -> message; } sync.write;\n", "  done: F p@end\n"),
       "--property", "deadlock"});
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_THAT(result.err, HasSubstr("program p never comes to this statement"));
  EXPECT_THAT(result.err, HasSubstr("p@end never holds: p never ends"));
}

TEST_F(CheckCommand, LimitsAreInconclusive) {
  const std::string path = system("  p: loop { via.write; via.read -> message; }\n");
  const SubprocessResult late =
      run_maide({"check", path, "--engine", "spin", "--time", "0.001", "--json"});
  EXPECT_EQ(late.exit_status, 3);
  EXPECT_EQ(json_of(late)["properties"][0]["reason"], "out of time");
  const SubprocessResult large = run_maide({"check", path, "--engine", "spin", "--memory", "1"});
  EXPECT_EQ(large.exit_status, 3);
  // Two million states.
  const std::string many = MAIDE_SOURCE_DIR "/examples/case-study-2/nonblocking-drop.yaml";
  const SubprocessResult native = run_maide({"check", many, "--memory", "1", "--json"});
  EXPECT_EQ(native.exit_status, 3);
  EXPECT_THAT(json_of(native)["properties"][0]["reason"].get<std::string>(),
              HasSubstr("needs more than 1 MiB of memory after"));
  const SubprocessResult short_time = run_maide({"check", many, "--time", "0.001", "--json"});
  EXPECT_EQ(short_time.exit_status, 3);
  EXPECT_THAT(json_of(short_time)["properties"][0]["reason"].get<std::string>(),
              HasSubstr("out of time"));
}

// The signal comes when the system has been read, and its two million states have not been seen.
TEST_F(CheckCommand, JsonSaysThatASignalEndedTheCheck) {
  const std::string examples = MAIDE_SOURCE_DIR "/examples";
  const SubprocessResult result =
      run_with_maide("cd '" + folder_.path().string() +
                     "'; mkfifo pipe; \"$maide\" check --json pipe & run=$!; "
                     "sed 's#[.][.]/models#" +
                     examples + "/models#' '" + examples +
                     "/case-study-2/nonblocking-drop.yaml' > pipe; "
                     "while ls -l /proc/$run/fd 2> /dev/null | grep -q pipe$; do sleep 0.01; done; "
                     "kill -TERM $run; wait $run");
  EXPECT_EQ(result.exit_status, 3);
  const Json json = json_of(result);
  EXPECT_EQ(json.at("status"), 3);
  EXPECT_EQ(json.at("error"), "interrupted");
  EXPECT_EQ(json.at("verdict"), "inconclusive");
}

TEST_F(CheckCommand, ToolsThatAreMissingAreNamed) {
  const std::string path = system("  p: via.write;\n");
  EXPECT_EQ(run_with_maide("PATH=/nowhere \"$maide\" check '" + path + "'").exit_status, 0);
  const SubprocessResult result =
      run_with_maide("PATH=/nowhere \"$maide\" check --engine spin '" + path + "'");
  expect_error(result, 2, "'spin' cannot be run");
  expect_error(run_with_maide("PATH=/nowhere \"$maide\" check --engine ltsmin '" + path + "'"), 2,
               "the engine ltsmin needs a C++ compiler, and 'c++' cannot be run");
}

// A crash is an output: a program may wait for it, and if none does it is named.
TEST_F(CheckCommand, AProgramCanWaitForACrash) {
  const std::string lamp =
      file("lamp.dot",
           "digraph lamp {\n__start0 [label=\"\" shape=\"none\"];\n__start0 -> s0;\n"
           "s0 -> s1 [label=\"?press\"];\ns1 -> s2 [label=\"!on\"];\n"
           "s2 -> s3 [label=\"?hit\"];\ns3 -> s4 [label=\"!crash\"];\n}\n");
  const auto check = [&](const std::string& statements) {
    return run_maide({"check", file("lamp.yaml", "models:\n  lamp: {file: " + lamp +
                                                     "}\nprograms:\n  p: |\n    lamp.press -> "
                                                     "on;\n    " +
                                                     statements + "\n")});
  };
  EXPECT_EQ(check("lamp.hit -> crash;").exit_status, 0);
  const SubprocessResult unaware = check("lamp.hit; lamp.press;");
  EXPECT_EQ(unaware.exit_status, 1);
  EXPECT_THAT(unaware.out, HasSubstr("lamp has crash due, which no program takes"));
}

// What Maide has started does not outlive it. The program says its number, then sleeps; a zombie is
// as dead as one that was taken away.
TEST_F(CheckCommand, ProgramsDieWithMaideEvenIfItIsKilled) {
  const std::string spin = file("spin",
                                "#!/bin/sh\n"
                                "echo $$ > '" +
                                    (folder_.path() / "pid").string() + "'\nexec sleep 1000\n");
  std::filesystem::permissions(spin, std::filesystem::perms::owner_all);
  const SubprocessResult result = run_with_maide(
      "cd '" + folder_.path().string() + "'; PATH=\"$PWD:$PATH\" \"$maide\" check '" +
      system(waiting) +
      "' --engine spin >/dev/null 2>&1 &\n"
      "while [ ! -s pid ]; do sleep 0.02; done; kill -9 $!; wait $! 2>/dev/null\n"
      "while grep -qs '^State:.[^Z]' /proc/$(cat pid)/status; do sleep 0.02; done; echo gone");
  EXPECT_EQ(result.out, "gone\n") << result.err;
}

// What SPIN has a word for is checked component by component; what it has none for is refused
// before anything runs.
TEST(Check, SpinChecksProgramsWithState) {
  const TempDir folder;
  const std::string path = (folder.path() / "select.yaml").string();
  write_file_atomically(path, R"yaml(models:
  q: {use: queue, with: {size: 1}}
  lock: {use: mutex}
programs:
  w: "if fair * { q.write; } else { q.write; }"
  r: "var n: 0..1; select { on q.read -> message { n = 1; } }"
  other: "idle lock.unlock;"
properties:
  taken: "F (r.n == 1)"
  free: {ltl: "G !lock.unlock", fairness: none}
)yaml");
  const SubprocessResult result = run_maide({"check", path, "--engine", "spin", "--property",
                                             "deadlock", "--property", "free", "--json", "-q"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const Json answer = json_of(result);
  EXPECT_EQ(answer.at("components").size(), 2u);
  EXPECT_EQ(answer.at("components")[0].at("states"), 5);
  EXPECT_EQ(answer.at("components")[1].at("states"), 1);
  expect_error(run_maide({"check", path, "--engine", "spin", "-q"}), 2,
               "property 'taken': the engine spin has no `fair` choices, and w makes one "
               "(--engine native has) (");
}

}  // namespace
}  // namespace maide::test
