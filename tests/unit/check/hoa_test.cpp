// Automata in the HOA format: reading and writing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "maide/base/file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/check/engines/spin_engine.hpp"
#include "maide/check/ltl/ltl_automaton.hpp"
#include "maide/check/verdict/check_system.hpp"
#include "systems.hpp"

namespace maide {
namespace {

using testing::HasSubstr;

// Two programs: p writes twice, with a label between; q reads for ever.
System two_programs(const std::string& properties = "") {
  return test::system_of(
      "  p: \"via.write; @half via.write;\"\n"
      "  q: \"loop { via.read -> message; }\"\n",
      properties);
}

class Hoa : public testing::Test {
 protected:
  LtlAutomaton read(const std::string& text) const {
    return read_hoa(text, "a.hoa", {system_.programs, interfaces_});
  }
  // Of a body over p@half and via!message, with one acceptance set.
  LtlAutomaton read_body(const std::string& body) const {
    return read(
        "HOA: v1\nStart: 0\nAP: 2 \"p@half\" \"via!message\"\nAcceptance: 1 Inf(0)\n--BODY--\n" +
        body + "\n--END--\n");
  }
  std::string error(const std::string& text) const {
    return test::error_of([&] { read(text); });
  }
  std::string body_error(const std::string& body) const {
    return test::error_of([&] { read_body(body); });
  }

  System system_ = two_programs();
  std::vector<ProgramInterface> interfaces_ = system_.interfaces();
};

TEST_F(Hoa, IsWrittenAsTheFormatSays) {
  const std::string text = "F G via!message";
  const Formula formula =
      parse_formula(ScalarText(text, text, {"f", 1, 1}), {system_.programs, interfaces_});
  std::ostringstream out;
  write_hoa(out, translate(formula), {system_.programs, interfaces_}, "a \"name\"");
  EXPECT_THAT(out.str(),
              testing::StartsWith("HOA: v1\nname: \"a \\\"name\\\"\"\ntool: \"maide\" "));
  EXPECT_THAT(out.str(),
              HasSubstr("AP: 1 \"via!message\"\nacc-name: Buchi\nAcceptance: 1 Inf(0)\n"));
  EXPECT_THAT(out.str(), testing::EndsWith("--END--\n"));
}

TEST_F(Hoa, LabelsMayStandOnStatesBeImplicitOrNamed) {
  const LtlAutomaton plain =
      read_body("State: 0 [!0&!1] 0 [0&!1] 0 {0} [!0&1] 1 [0&1] 1\nState: 1");
  EXPECT_EQ(read_body("State: 0 0 0 {0} 1 1\nState: 1"), plain);
  EXPECT_EQ(read_body("State: [0|!1] 0 \"its name\" 0\nState: 1"),
            read_body("State: 0 [!(!0&1)] 0\nState: 1"));
  EXPECT_EQ(
      read("HOA: v1 /* one /* in */ another */ Start: 0 AP: 1 \"p@half\" Alias: @half 0 "
           "acc-name: all Acceptance: 0 t --BODY-- State: 0 [@half & !@half | !@half] 0 --END--"),
      read("HOA: v1 States: 1 Start: 0 AP: 1 \"p@half\" Acceptance: 0 t\n--BODY--\n"
           "State: 0\n[!0] 0\n--END--"));
}

TEST_F(Hoa, MarksOfStatesAndSetsThatAreNotAskedFor) {
  const LtlAutomaton on_state = read_body("State: 0 {0} [0] 0 [!0] 0");
  EXPECT_EQ(on_state, read_body("State: 0 [0] 0 {0} [!0] 0 {0}"));
  const LtlAutomaton one_of_two = read(
      "HOA: v1 Start: 0 AP: 0 Acceptance: 2 Inf(1) --BODY-- State: 0 [t] 0 {0} [t] 0 {0 1} "
      "--END--");
  EXPECT_EQ(one_of_two.mark_count, 1U);
  EXPECT_EQ(one_of_two.states[0][0].marks, 0U);
  EXPECT_EQ(one_of_two.states[0][1].marks, 1U);
  EXPECT_EQ(one_of_two.universal, 0U);
}

TEST_F(Hoa, ErrorsHaveTheirPlace) {
  EXPECT_THAT(error(""), HasSubstr("begins with 'HOA: v1', not the end of the file (a.hoa:1:1)"));
  EXPECT_THAT(error("HOA: v2"),
              HasSubstr("version v1 of the format is read, not 'v2' (a.hoa:1:6)"));
  EXPECT_THAT(error("HOA: v1\nAP: 1 \"via!gap\""), HasSubstr("a.hoa:2:"));
  EXPECT_THAT(error("HOA: v1\nAP: 1 \"F p@half\""), HasSubstr("(a.hoa:2:7)"));
  EXPECT_THAT(error("HOA: v1\nAcceptance: 2 Inf(0)|Inf(1)"),
              HasSubstr("acceptance other than generalized Buchi"));
  EXPECT_THAT(error("HOA: v1\nAcceptance: 1 Fin(0)"), HasSubstr("(a.hoa:2:15)"));
  EXPECT_THAT(error("HOA: v1 Start: 0&1"), HasSubstr("alternating automata"));
  EXPECT_THAT(error("HOA: v1 Controllable: 0"), HasSubstr("'Controllable:' is not understood"));
  EXPECT_THAT(error("HOA: v1 --BODY--"), HasSubstr("no 'Acceptance:'"));
  EXPECT_THAT(body_error("State: 0 [0] 0&1"), HasSubstr("alternating automata"));
  EXPECT_THAT(body_error("State: 0 [2] 0"),
              HasSubstr("there is no atomic proposition 2 (a.hoa:6:11)"));
  EXPECT_THAT(body_error("State: 0 [0] 0 {1}"), HasSubstr("there is no acceptance set 1"));
  EXPECT_THAT(body_error("State: 0 0 0"), HasSubstr("has 2 transitions without label, not 4"));
  EXPECT_THAT(body_error("State: 0 State: 0"), HasSubstr("is there twice"));
  EXPECT_THAT(body_error("State: 0 [@x] 0"), HasSubstr("there is no alias @x"));
}

// The property file and the formula that it is of: the same verdicts.
TEST_F(Hoa, NeverIsAProperty) {
  const TempDir folder;
  const auto verdict = [&](const std::string& formula) {
    System system = two_programs("  f: \"" + formula + "\"\n");
    const std::vector<ProgramInterface> interfaces = system.interfaces();
    Property never = system.properties[0];
    FormulaNode negation;
    negation.op = FormulaNode::Operator::negation;
    negation.left = never.formula;
    std::ostringstream text;
    write_hoa(text, translate(std::make_shared<const FormulaNode>(negation)),
              {system.programs, interfaces}, "");
    write_file_atomically(folder.path() / "bad.hoa", text.str());
    const System other =
        two_programs("  f: {never: \"" + (folder.path() / "bad.hoa").string() + "\"}\n");
    EXPECT_EQ(other.properties.at(0).kind, Property::Kind::never);
    const PropertyResult result = NativeEngine().check(other, other.properties[0], {});
    const PropertyResult expected = NativeEngine().check(system, system.properties[0], {});
    EXPECT_EQ(result.verdict, expected.verdict) << formula;
    if (result.trace) {
      EXPECT_EQ(find_flaw(other, other.properties[0], *result.trace), "");
      EXPECT_EQ(find_flaw(system, system.properties[0], *result.trace), "") << formula;
    }
    EXPECT_NE(SpinEngine().obstacle(other, other.properties[0]), "");
    return result.verdict;
  };
  EXPECT_EQ(verdict("G (p@half -> F p@end)"), Verdict::holds);
  EXPECT_EQ(verdict("G !via!message"), Verdict::violated);
  EXPECT_EQ(verdict("G F via.write"), Verdict::violated);
  EXPECT_EQ(verdict("F via!message"), Verdict::holds);
}

TEST_F(Hoa, NeverNamesAFile) {
  EXPECT_THAT(test::error_of([] { two_programs("  f: {never: nowhere.hoa}\n"); }),
              HasSubstr("there is no file 'nowhere.hoa'"));
  EXPECT_THAT(test::error_of([] { two_programs("  f: {ltl: \"G true\", never: x.hoa}\n"); }),
              HasSubstr("one of 'ltl', 'always', 'possible', 'always_possible' and 'never'"));
}

// As many marks and propositions as a word of 64 bits has; not one more.
TEST_F(Hoa, HasAtMost64Marks) {
  const auto with_marks = [](int count) {
    std::string sets, marks;
    for (int i = 0; i < count; ++i) {
      sets += (i == 0 ? "" : "&") + std::string("Inf(") + std::to_string(i) + ")";
      marks += (i == 0 ? "" : " ") + std::to_string(i);
    }
    return "HOA: v1\nStart: 0\nAP: 1 \"p@half\"\nAcceptance: " + std::to_string(count) + " " +
           sets + "\n--BODY--\nState: 0\n[t] 0 {" + marks + "}\n--END--\n";
  };
  for (const int count : {1, 2, 63, 64}) {
    const LtlAutomaton automaton = read(with_marks(count));
    EXPECT_EQ(automaton.mark_count, static_cast<std::uint32_t>(count));
    EXPECT_EQ(find_universal(automaton), 0U);
    EXPECT_TRUE(accepts(automaton, {0, 1}, 1));
    std::ostringstream out;
    write_hoa(out, automaton, {system_.programs, interfaces_}, "");
    EXPECT_EQ(read(out.str()).mark_count, automaton.mark_count);
  }
  EXPECT_THAT(error(with_marks(65)), HasSubstr("64"));
}

}  // namespace
}  // namespace maide
