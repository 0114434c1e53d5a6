#include "maide/check/language/program.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "maide/check/build/code_resolver.hpp"
#include "maide/check/build/parse_program.hpp"
#include "maide/check/language/code_parser.hpp"
#include "maide/check/system/model_actions.hpp"
#include "maide/check/system/system.hpp"
#include "maide/check/unroll/make_program.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using Kind = ProgramEdge::Kind;

class ProgramTest : public testing::Test {
 protected:
  Program parse(const std::string& text) const {
    System system;
    for (const std::string name : {"m", "odd name"}) {
      ModelInstance model;
      model.name = name;
      model.automaton = InterfaceAutomaton(inputs_, outputs_, 1);
      system.models.push_back(model);
    }
    return parse_program("p", ScalarText(text, text, {"p.yaml", 1, 1}), system);
  }
  std::string error(const std::string& text) const {
    return test::error_of([&] { parse(text); });
  }
  std::vector<ControlState> labelled(const Program& program, const std::string& label) const {
    const auto place = std::find(program.labels.begin(), program.labels.end(), label);
    std::vector<ControlState> states;
    for (ControlState state = 0; state < program.states.size(); ++state) {
      if (program.has_label(state, static_cast<std::uint32_t>(place - program.labels.begin()))) {
        states.push_back(state);
      }
    }
    return states;
  }
  Alphabet inputs_{"a", "b", "stop"}, outputs_{"x", "y", "quiet"};
};

TEST_F(ProgramTest, GiveThenTakeAreTwoSteps) {
  const Program program = parse("m.a -> x;\nm.b;");
  ASSERT_EQ(program.states.size(), 4u);
  const ProgramEdge give = program.edges_of(0)[0];
  EXPECT_EQ(give.kind, Kind::give);
  EXPECT_EQ(give.index, 0u);
  const ProgramEdge take = program.edges_of(give.target)[0];
  EXPECT_EQ(take.kind, Kind::take);
  EXPECT_EQ(take.column, 8);
  const ProgramEdge second = program.edges_of(take.target)[0];
  EXPECT_EQ(second.line, 2);
  EXPECT_TRUE(program.is_end(second.target));
}

TEST_F(ProgramTest, BookkeepingCostsNoStep) {
  EXPECT_EQ(parse("loop { skip; repeat 3 { skip; m.a; } repeat 0 { m.b; } }").states.size(), 3u);
  EXPECT_EQ(parse("repeat 5 { repeat 4 { m.a; } }").states.size(), 21u);
  EXPECT_EQ(parse("repeat 1000000 { repeat 1000000 { skip; } }").states.size(), 1u);
  EXPECT_EQ(parse("skip;").states.size(), 1u);
  EXPECT_EQ(parse("m.a; stop; m.b;").states.size(), 2u);
}

// Which rounds of which loops the state is in, outermost first: "2/3" of a repeat, "loop".
std::string rounds_of(const Program& program, ControlState state) {
  std::string text;
  for (std::uint32_t at = program.states[state].round; at != 0; at = program.rounds[at].outer) {
    const Program::Round& round = program.rounds[at];
    const std::string own = round.count == 0
                                ? "loop"
                                : std::to_string(round.number) + "/" + std::to_string(round.count);
    text = own + (text.empty() ? "" : " ") + text;
  }
  return text;
}

TEST_F(ProgramTest, StatesKnowTheRoundsTheyAreIn) {
  const Program program =
      parse("m.a; loop { repeat 2 { m.b; repeat 3 { m.a -> x; if * { m.stop; } } } m.b; }");
  std::vector<std::string> visited;
  std::vector<bool> seen(program.states.size());
  for (ControlState at = 0; !seen[at]; at = program.edges_of(at).back().target) {
    seen[at] = true;
    const std::string rounds = rounds_of(program, at);
    if (visited.empty() || visited.back() != rounds) visited.push_back(rounds);
  }
  const std::vector<std::string> expected{
      "",         "loop 1/2",     "loop 1/2 1/3", "loop 1/2 2/3", "loop 1/2 3/3",
      "loop 2/2", "loop 2/2 1/3", "loop 2/2 2/3", "loop 2/2 3/3", "loop"};
  EXPECT_EQ(visited, expected);
  EXPECT_EQ(rounds_of(program, program.edges_of(0)[0].target), "loop 1/2");
}

TEST_F(ProgramTest, ArmsJoinBehindTheSwitch) {
  const Program program = parse("switch m.a { x { m.b; } y {} \"quiet\" {} quiet {} } m.a;");
  // before; after the input; in x; behind; end
  EXPECT_EQ(program.states.size(), 5u);
  const auto arms = program.edges_of(program.edges_of(0)[0].target);
  ASSERT_EQ(arms.size(), 4u);
  EXPECT_EQ(arms[2].kind, Kind::take);
  EXPECT_EQ(arms[3].kind, Kind::quiet);
  EXPECT_EQ(arms[1].target, arms[3].target);
}

TEST_F(ProgramTest, ChoiceIsOneStepAndElseMayBeLeftOut) {
  const Program program = parse("loop { if * { m.a; } }");
  ASSERT_EQ(program.states.size(), 2u);
  ASSERT_EQ(program.edges_of(0).size(), 2u);
  EXPECT_EQ(program.edges_of(0)[0].kind, Kind::choice);
  EXPECT_EQ(program.edges_of(0)[1].target, 0u);
  EXPECT_EQ(parse("if * { m.a; } else { m.b; }").states.size(), 4u);
}

TEST_F(ProgramTest, LabelOnALoopHoldsInTheFirstRoundOnly) {
  const Program program = parse("@once loop { @each m.a; m.b; }");
  EXPECT_EQ(program.states.size(), 3u);
  EXPECT_EQ(labelled(program, "once"), std::vector<ControlState>{0});
  EXPECT_EQ(labelled(program, "each").size(), 2u);
}

TEST_F(ProgramTest, LabelOnNothingMarksThePoint) {
  const Program program = parse("m.a; @here skip; m.b; @over stop;");
  EXPECT_EQ(labelled(program, "here"), std::vector<ControlState>{1});
  ASSERT_EQ(labelled(program, "over").size(), 1u);
  EXPECT_TRUE(program.is_end(labelled(program, "over")[0]));
}

TEST_F(ProgramTest, QuotedNamesKeywordsAndComments) {
  const Program program = parse("\"odd name\".a; # one { \n m.stop; // two }\n m.\"a\";");
  EXPECT_EQ(program.states.size(), 4u);
  EXPECT_EQ(program.edges_of(0)[0].model, 1u);
}

TEST_F(ProgramTest, ErrorsNameThePlace) {
  EXPECT_EQ(error("loop {\n  m.wirte;\n}"),
            "model m has no input 'wirte'; it has: a, b, stop (p.yaml:2:5)");
  EXPECT_EQ(error("m.a -> z;"), "model m has no output 'z'; it has: x, y, quiet (p.yaml:1:8)");
  EXPECT_EQ(error("n.a;"), "unknown model 'n'; there is: m, odd name (p.yaml:1:1)");
  EXPECT_EQ(error("loop {\n  skip;\n}"),
            "this loop would go round for ever without a step: nothing in it gives an input, waits "
            "or chooses (p.yaml:1:1)");
  EXPECT_EQ(error("repeat 2 { m.a; "), "this '{' is not closed (p.yaml:1:10)");
  EXPECT_EQ(error("m.a; }"), "this '}' closes nothing (p.yaml:1:6)");
  EXPECT_EQ(error("@x m.a; @x m.b;"), "the label 'x' stands before two statements (p.yaml:1:10)");
  EXPECT_EQ(error("@end m.a;"),
            "the label 'end' is taken: it holds when the program has ended (p.yaml:1:2)");
  EXPECT_EQ(error("switch m.a { x {} x {} }"), "this 'switch' has two arms for 'x' (p.yaml:1:19)");
  EXPECT_EQ(error("switch m.a { }"), "this 'switch' has no arm (p.yaml:1:1)");
  EXPECT_EQ(
      error("repeat x { m.a; }"),
      "unknown name 'x': there is no such variable, constant or word of a variable (p.yaml:1:8)");
  EXPECT_EQ(error("repeat 3x { m.a; }"), "expected a number, not '3x' (p.yaml:1:8)");
  EXPECT_EQ(error("m.\"a;"), "a quoted name is not closed (p.yaml:1:3)");
  EXPECT_EQ(error("m.a $"), "unexpected '$' (p.yaml:1:5)");
  EXPECT_NE(error("m.a -> quiet;").find("it is an arm of"), std::string::npos);
  EXPECT_NE(error("m.a; @x").find("@x skip;"), std::string::npos);
  EXPECT_NE(error("").find("no statement"), std::string::npos);
  EXPECT_NE(error("wait m.a;").find("expected '->'"), std::string::npos);
}

TEST_F(ProgramTest, SizesAreBounded) {
  EXPECT_NE(error("repeat 99999999999 { m.a; }").find("goes up to 1000000"), std::string::npos);
  EXPECT_NE(error("repeat 10000 {\n repeat 10000 { m.a; } }").find("has more than 1000000"),
            std::string::npos);
  std::string deep;
  for (int level = 0; level < 100000; ++level) deep += "loop{";
  EXPECT_NE(error(deep).find("nested too deeply"), std::string::npos);
}

// A statement that was made from another file gives its place there to its edges.
TEST_F(ProgramTest, OriginsGoFromStatementsToEdges) {
  System system;
  ModelInstance model;
  model.name = "m";
  model.automaton = InterfaceAutomaton(inputs_, outputs_, 1);
  system.models.push_back(model);
  Names names;
  names.models.emplace("m", ModelName{0, {}, false, {}});
  const std::string text = "m.a -> x; m.b;";
  const ScalarText scalar(text, text, {"p.yaml", 1, 1});
  syntax::Code code = syntax::parse_program(scalar);
  code.block.statements[0].origin = SourcePosition{"planner.cpp", 41, 3};
  const program_syntax::Tree tree = program_syntax::resolve_program(
      code, {system.models, names, system.words, 0, {}, {}, nullptr, nullptr, {}});
  ModelActions actions(system);
  system.programs.push_back(program_syntax::make_program(tree, {"p", 0, scalar.position(0), false},
                                                         code.last.line, actions, names));
  const auto origin = [&](std::uint32_t edge) {
    Step step;
    step.action = edge;
    return origin_of(system, step);
  };
  ASSERT_EQ(system.programs[0].edges.size(), 3U);
  for (const std::uint32_t edge : {0U, 1U}) {
    ASSERT_TRUE(origin(edge).has_value());
    EXPECT_EQ(origin(edge)->file, "planner.cpp");
    EXPECT_EQ(origin(edge)->line, 41);
  }
  EXPECT_FALSE(origin(2).has_value());
}

}  // namespace
}  // namespace maide
