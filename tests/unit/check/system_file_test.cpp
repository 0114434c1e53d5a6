#include "maide/check/build/system_file.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "systems.hpp"

namespace maide {
namespace {

const std::string models = "models:\n  via: {file: strict-2.dot}\n";

std::string error(const std::string& text) {
  return test::error_of([&] { parse_system(text, "s.yaml", test::test_model); });
}

TEST(SystemFile, ReadsEverything) {
  const System system = parse_system(
      "models:\n"
      "  via: {file: strict-2.dot, when_unexplored: drop, when_weak: accept}\n"
      "  sync: {file: buffered.dot}\n"
      "programs:\n"
      "  p: |\n"
      "    @go via.write;\n"
      "  q: 'via.read -> message;'\n"
      "properties:\n"
      "  one: G F p@go\n"
      "  two: {ltl: F q@end, fairness: none}\n"
      "  three: {always: \"!sync!message\"}\n",
      "s.yaml", test::test_model);
  ASSERT_EQ(system.models.size(), 2u);
  EXPECT_EQ(system.models[0].when_unexplored, WhenUnexplored::drop);
  EXPECT_EQ(system.models[1].when_unexplored, WhenUnexplored::stop);
  EXPECT_EQ(system.models[0].when_weak, WhenWeak::accept);
  EXPECT_EQ(system.models[1].when_weak, WhenWeak::inconclusive);
  ASSERT_EQ(system.programs.size(), 2u);
  EXPECT_EQ(system.programs[0].edges[0].line, 6);
  EXPECT_EQ(system.programs[0].edges[0].column, 9);
  EXPECT_EQ(system.programs[1].edges[1].line, 7);
  EXPECT_EQ(system.programs[1].edges[1].column, 19);
  ASSERT_EQ(system.properties.size(), 3u);
  EXPECT_EQ(system.properties[0].fairness, Fairness::weak);
  EXPECT_EQ(system.properties[1].fairness, Fairness::none);
  ASSERT_EQ(system.remarks.size(), 1u);
  EXPECT_EQ(system.remarks[0], "no program uses model 'sync' (s.yaml:3:3)");
}

TEST(SystemFile, RemarksOnStatementsThatAreNeverReached) {
  const auto remarks = [](const std::string& program) {
    return parse_system(models + "programs:\n  p: |\n    " + program + "\n", "s.yaml",
                        test::test_model)
        .remarks;
  };
  const auto place = [](const std::string& position) {
    return std::vector<std::string>{
        "program p never comes to this statement: the one before it does not end (s.yaml:" +
        position + ")"};
  };
  EXPECT_EQ(remarks("loop { via.write; } via.read -> message;"), place("5:25"));
  EXPECT_EQ(remarks("via.write; stop; @l via.read -> message; skip;"), place("5:25"));
  EXPECT_EQ(remarks("if * { stop; } else { loop { via.write; } } via.write;"), place("5:49"));
  EXPECT_EQ(remarks("switch via.read { message { stop; } quiet { stop; } } skip;"), place("5:59"));
  EXPECT_EQ(remarks("loop { repeat 2 { via.read; stop; } via.write; }"), place("5:41"));
  EXPECT_TRUE(remarks("if * { stop; } repeat 0 { stop; } via.write;").empty());
  EXPECT_TRUE(remarks("switch via.read { message { stop; } quiet { } } skip;").empty());
}

TEST(SystemFile, RemarksOnAtomsThatHoldNowhere) {
  const System system = parse_system(models +
                                         "programs:\n"
                                         "  p: 'loop { @a via.write; } @b skip;'\n"
                                         "  q: 'via.read -> message;'\n"
                                         "properties:\n"
                                         "  fine: G F (p@a || q@end)\n"
                                         "  end: F p@end\n"
                                         "  label: {always: \"!p@b\"}\n",
                                     "s.yaml", test::test_model);
  ASSERT_EQ(system.remarks.size(), 3u);
  EXPECT_EQ(system.remarks[1], "in property 'end', p@end never holds: p never ends (s.yaml:8:3)");
  EXPECT_EQ(system.remarks[2],
            "in property 'label', p@b never holds: p never comes there (s.yaml:9:3)");
}

TEST(SystemFile, ModelsToBeLearnedAreAskedFor) {
  ModelRequest seen;
  const auto source = [&](const ModelRequest& request) {
    seen = request;
    return InterfaceAutomaton({"write"}, {}, 1);
  };
  parse_system(
      "models: {m: {learn: cyclonedds, with: {history: keep_last, depth: 10}}}\n"
      "programs: {p: m.write;}",
      "dir/s.yaml", source);
  EXPECT_EQ(seen.learn, "cyclonedds");
  const std::vector<std::pair<std::string, std::string>> with{{"history", "keep_last"},
                                                              {"depth", "10"}};
  EXPECT_EQ(seen.with, with);
  EXPECT_NE(error("models: {m: {learn: cyclonedds}}\nprograms: {p: m.write;}")
                .find("run `maide learn cyclonedds"),
            std::string::npos);
}

TEST(SystemFile, PlacesInsideScalarsOfEveryStyle) {
  const std::string wrong = "via.wirte";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"  p: |\n    via.write;\n    via.wirte;\n", "(s.yaml:5:9)"},
      {"  p: |2-\n       via.write;\n\n       via.wirte;\n", "(s.yaml:6:12)"},
      {"  p: >\n    via.write;\n    via.wirte;\n", "(s.yaml:5:9)"},
      {"  p: via.write;\n    via.wirte;\n", "(s.yaml:4:9)"},
      {"  p: 'via.write; via.wirte;'\n", "(s.yaml:3:22)"},
      {"  p: \"via.\\\"write\\\";\\n via.wirte;\"\n", "(s.yaml:3:28)"},
      {"  p: \"via.\\x77rite; \\u0023 \\u00e9 \\n  via.wirte;\"\n", "(s.yaml:3:43)"},
      {"  p: 'via.\"write\"; # it''s\n\n   via.wirte;'\n", "(s.yaml:5:8)"},
      {"  p: !text &here |  # text\n    via.wirte;\n", "(s.yaml:4:9)"},
      {"  p: \"via.write;\\\n      via.wirte;\"\n", "(s.yaml:4:11)"},
  };
  for (const auto& [program, place] : cases) {
    const std::string message = error(
        models.substr(0, 0) + "models: {via: {file: strict-2.dot}}\n" + "programs:\n" + program);
    EXPECT_NE(message.find("no input 'wirte'"), std::string::npos) << program << message;
    EXPECT_NE(message.find(place), std::string::npos) << program << message;
  }
}

TEST(SystemFile, ErrorsNameThePlace) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "empty (s.yaml:1:1)"},
      {"- 1\n", "a system file must be a map (key: value) (s.yaml:1:1)"},
      {"models: {}\nprogrms: {}", "has no key 'progrms'"},
      {models, "there is no 'programs:' and no 'nodes:' (s.yaml:1:1)"},
      {models + "programs: {}", "there is no program (s.yaml:3:11)"},
      {models + "programs: {p: [1]}", "program 'p' must be a text (s.yaml:3:15)"},
      {models + "programs: {p: via.write;}\nprogams: {}\n",
       "a system file has no key 'progams'; it may have: holes, constants, models, topics, "
       "services, "
       "procedures, variables, programs, executors, nodes, properties; did you mean 'programs'? "
       "(s.yaml:4:1)"},
      {models + "programs: {p: via.write;, p: via.read;}", "'p' is there twice (s.yaml:3:27)"},
      {models + "programs: {p: {source: p.cpp, entry: \"P::run\"}}",
       "has no key 'source'; it may have: do, may_die"},
      {models + "programs: {p: {sauce: p.cpp}}", "has no key 'sauce'"},
      {"models:\n  via: {file: x.dot, when: stop}\nprograms: {p: via.write;}", "has no key 'when'"},
      {"models:\n  via: {file: strict-2.dot, when_unexplored: never}\nprograms: {p: via.write;}",
       "'when_unexplored' is one of stop, wait, drop, not 'never' (s.yaml:2:46)"},
      {"models:\n  via: {when_unexplored: stop}\nprograms: {p: via.write;}",
       "model 'via' needs 'file:', 'learn:' or 'use:' (s.yaml:2:3)"},
      {"models:\n  via: {file: a.dot, learn: b}\nprograms: {p: via.write;}",
       "one of 'file', 'learn' and 'use'"},
      {"models:\n  via: {file: nowhere.dot}\nprograms: {p: via.write;}", "there is no file"},
      {models + "programs: {p: via.write;}\nproperties: {deadlock: \"true\"}", "always there"},
      {models + "programs: {p: via.write;}\nproperties:\n  f: \"forall i in 0..0: F p@end\"\n"
                "  \"f[0]\": \"G p@end\"\n",
       "the property 'f[0]' is there twice (s.yaml:6:3)"},
      {models + "programs: {p: via.write;}\nproperties: {x: {fairness: none}}", "needs 'ltl:'"},
      {models + "programs: {p: via.write;}\nproperties: {x: {always: \"G p@end\"}}",
       "without X, F, G, U, R, W"},
      {models + "programs: {p: via.write;}\nproperties:\n  x: ! p@end",
       "put the formula in quotes"},
      {models + "programs: {p: via.write;}\nproperties: {x: {ltl: !via!message}}",
       "to YAML, this '!' begins a tag: a text that begins with it is put in quotes"},
      {models + "programs: {p: via.write;}\nproperties:\n  x: \"G p@ende\"",
       "program p has no label 'ende'; it has: end; did you mean 'end'? (s.yaml:5:11)"},
      {"a: b: c", "not YAML"},
      {"a: [1", "not YAML: a '[' is not closed, or a ',' is missing in it"},
      {"programs: {p: via.write;", "a '{' is not closed, or a ',' is missing between its entries"},
      {"programs:\n\tp: q.write;", "lines are indented with blanks, and here is a tab (s.yaml:2:"},
      {"programs: p: q", "a text with ': ' in it is in quotes, and a key begins a line"},
      {"models:\n  q: 1\n q2: 1", "this line is indented like none above it (s.yaml:3:2)"},
      {"variables: {n: 0..2}\nprograms: {p: skip;}", "as in variables: \"var n: 0..3; var ok"},
      {"constants: {n: 1.5}\nprograms: {p: skip;}", "numbers are whole, without a fraction"},
      {"a: 1\n---\nb: 2", "one YAML document (s.yaml:2:1)"},
      {std::string(100000, '['), "nested too deeply (s.yaml:1:101)"},
      {"constants: {n: 1 / 0}\nprograms: {p: skip;}",
       "this constant has no value: it divides by zero"},
      {"models:\n  q: {use: queue, with: {size: 1}, ends: {writr: p}}\nprograms: {p: q.write;}",
       "model q has no end 'writr'; it has: writer, reader; did you mean 'writer'? (s.yaml:2:43)"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string message = error(text);
    EXPECT_NE(message.find(expected), std::string::npos) << text.substr(0, 200) << "\n" << message;
  }
}

// What other languages write is named at its place, in programs and in formulas.
TEST(SystemFile, OperatorsOfOtherLanguagesAreNamed) {
  const auto in_program = [](const std::string& statement) {
    return error("models: {via: {file: strict-2.dot}}\nprograms:\n  p: |\n    var b: bool;\n    " +
                 statement + "\n");
  };
  const auto in_formula = [](const std::string& formula) {
    return error(
        "models: {via: {file: strict-2.dot}}\nvariables: \"var n: 0..1; var b: bool;\"\n"
        "programs: {p: via.write; n = 1; b = true;, r: n = 0; b = false;}\nproperties:\n  x: \"" +
        formula + "\"\n");
  };
  EXPECT_EQ(in_program("if (b and b) { via.write; }"),
            "'and' is no sign here: it is '&&' (s.yaml:5:11)");
  EXPECT_EQ(in_program("if (b or b) { via.write; }"),
            "'or' is no sign here: it is '||' (s.yaml:5:11)");
  EXPECT_EQ(in_program("if (not b) { via.write; }"),
            "'not' is no sign here: it is '!' (s.yaml:5:9)");
  EXPECT_EQ(in_program("if (b = true) { via.write; }"),
            "'=' is no sign here: it is '==' (s.yaml:5:11)");
  EXPECT_EQ(in_program("b = b and b; via.write;"),
            "'and' is no sign here: it is '&&' (s.yaml:5:11)");
  EXPECT_EQ(in_program("if (b) { via.write; } elif (b) { via.write; }"),
            "'elif' begins no statement; it is 'else if' (s.yaml:5:27)");
  EXPECT_EQ(in_formula("G (b => b)"), "'=>' is no sign here: it is '->' (s.yaml:5:12)");
  EXPECT_EQ(in_formula("G (b and b)"), "'and' is no sign here: it is '&&' (s.yaml:5:12)");
  EXPECT_EQ(in_formula("b or b"), "'or' is no sign here: it is '||' (s.yaml:5:9)");
  EXPECT_EQ(in_formula("G not b"), "'not' is no sign here: it is '!' (s.yaml:5:9)");
  EXPECT_EQ(in_formula("F (n = 1)"), "'=' is no sign here: it is '==' (s.yaml:5:12)");
  EXPECT_EQ(in_formula("b until p@end"), "'until' is no sign here: it is 'U' (s.yaml:5:9)");
  EXPECT_EQ(in_formula("always b"), "'always' is no sign here: it is 'G' (s.yaml:5:7)");
  EXPECT_EQ(in_formula("G (b == TRUE)"), "'TRUE' is no sign here: it is 'true' (s.yaml:5:15)");
  EXPECT_EQ(in_formula("G m"),
            "expected program@label, model.input or model!output, not 'm' alone: no variable, "
            "constant or word has this name (s.yaml:5:9)");
}

// The names of other languages' operators are free.
TEST(SystemFile, ModelsAndProgramsMayBeCalledLikeOperatorsOfOtherLanguages) {
  EXPECT_EQ(error("models: {and: {file: strict-2.dot}}\nprograms: {not: and.write;}\n"
                  "properties: {x: \"F and.write && F not@end\"}\n"),
            "");
}

// A source knows systems and options, and the reader their places.
TEST(SystemFile, UsageErrorsOfModelsStandAtTheOptionThatTheyName) {
  const auto with_source = [](const std::string& message) {
    return test::error_of([&] {
      parse_system(
          "models:\n  q: {learn: prt, with: {depth: 1, kid: strict}}\nprograms: {p: q.write;}",
          "s.yaml", [&](const ModelRequest&) -> InterfaceAutomaton { throw UsageError(message); });
    });
  };
  EXPECT_EQ(with_source("unknown system 'prt'"), "unknown system 'prt' (s.yaml:2:14)");
  EXPECT_EQ(with_source("unknown option 'kid'"), "unknown option 'kid' (s.yaml:2:36)");
  EXPECT_EQ(with_source("option kid=strict: allowed is port"),
            "option kid=strict: allowed is port (s.yaml:2:36)");
}

TEST(SystemFile, TextsThatAreCutOffAreErrorsOrSystems) {
  const std::string text =
      "models:\n  via: {file: strict-2.dot}\nprograms:\n  p: |\n    loop { @a via.read -> message; "
      "}\n"
      "properties:\n  x: {ltl: \"G (p@a -> F via!message)\", fairness: none}\n";
  for (std::size_t length = 0; length <= text.size(); ++length) {
    const std::string message = error(text.substr(0, length));
    EXPECT_TRUE(message.empty() || message.find("s.yaml") != std::string::npos) << message;
  }
  EXPECT_EQ(error(text), "");
}

TEST(SystemFile, DeeplyIndentedTextIsAnError) {
  std::string text;
  for (int level = 0; level < 200000; ++level) text += "- ";
  EXPECT_NE(error(text), "");
}

}  // namespace
}  // namespace maide
