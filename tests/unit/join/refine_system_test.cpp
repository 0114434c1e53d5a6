// Black-box checking on simulated systems whose first model is learned with few tests or none, so
// that it is wrong: an alarm that is none goes away, a deadlock that the model hides is found.
#include "maide/join/refine_system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "maide/automata/strength.hpp"
#include "maide/base/error.hpp"
#include "maide/base/file.hpp"
#include "maide/check/engines/engine.hpp"
#include "maide/formats/model_file.hpp"

namespace maide {
namespace {

using testing::Contains;
using testing::Each;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr const char* no_tests = ", learning: {eq: random-words, max-tests: 0}";

// A connection that hands over each message at once, twice; the third is lost.
constexpr const char* tired = R"(digraph g {
  inputs="write,read";
  outputs="message";
  actors="writer: ?write; reader: ?read !message";
  __start0 -> a0;
  a0 -> a1 [label="?write"]; a1 -> a2 [label="?read"]; a2 -> b0 [label="!message"];
  b0 -> b1 [label="?write"]; b1 -> b2 [label="?read"]; b2 -> c0 [label="!message"];
  c0 -> c0 [label="?write"]; c0 -> c1 [label="?read"];
  c1 -> c1 [label="?write"];
})";

class BlackBoxChecking : public testing::Test {
 protected:
  // A system in which `via` is learned from `model`.
  std::filesystem::path write_system(const std::string& model, const std::string& programs,
                                     const std::string& learning = no_tests) {
    write_file_atomically(folder_.path() / "real.dot", model);
    const std::filesystem::path file = folder_.path() / "system.yaml";
    write_file_atomically(
        file, "models:\n  via: {learn: \"sim:real.dot\"" + learning + "}\nprograms:\n" + programs);
    return file;
  }
  RefinedCheck run(const std::filesystem::path& file, std::size_t most_rounds = 100) {
    NativeEngine engine;
    CheckRequest request;
    request.properties = {"deadlock"};
    RefinementOptions options;
    options.models.folder = folder_.path();
    options.most_rounds = most_rounds;
    return check_and_refine(file, engine, request, options);
  }
  std::size_t first_model(const std::filesystem::path& file) const {
    return read_system(file, make_learning_source({folder_.path(), {}, {}, 0}))
        .models[0]
        .automaton.size();
  }

  const std::string strict_3_ = read_file(MAIDE_SOURCE_DIR "/tests/models/strict-3.dot");
  const std::string burst_of_three_ =
      "  planner: repeat 3 { via.write; }\n  controller: repeat 3 { via.read -> message; }\n";
  TempDir folder_{"maide-refine-"};
};

TEST_F(BlackBoxChecking, AnAlarmThatTheSystemDoesNotFollowRefinesTheModel) {
  const auto file = write_system(strict_3_, burst_of_three_);
  EXPECT_LT(first_model(file), 8U);  // states of strict-3
  const RefinedCheck checked = run(file);
  EXPECT_EQ(checked.report.verdict, Verdict::holds);
  ASSERT_THAT(checked.rounds, Not(IsEmpty()));
  const RefinementRound& first = checked.rounds.front();
  EXPECT_EQ(first.instance, "via");
  EXPECT_EQ(first.cause, "the counterexample to deadlock");
  EXPECT_THAT(first.word, Not(IsEmpty()));
  EXPECT_NE(first.expected, first.seen);
  EXPECT_EQ(checked.system.models[0].automaton.size(), 8U);
  EXPECT_THAT(checked.report.assumptions, Contains(HasSubstr("tested again on the real system")));
  // What was learned is kept: nothing is refined the next time.
  EXPECT_THAT(run(file).rounds, IsEmpty());
}

TEST_F(BlackBoxChecking, ADeadlockThatTheModelHidesIsFoundByTests) {
  const auto file = write_system(tired, "  p: loop { via.write; via.read -> message; }\n",
                                 ", when_weak: accept, learning: {eq: w, extra-states: 1}");
  NativeEngine engine;
  CheckRequest request;
  request.properties = {"deadlock"};
  const System weak = read_system(file, make_learning_source({folder_.path(), {}, {}, 0}));
  ASSERT_EQ(check_system(weak, engine, request).verdict, Verdict::holds);

  const RefinedCheck checked = run(file);
  EXPECT_EQ(checked.report.verdict, Verdict::violated);
  EXPECT_THAT(checked.rounds, Contains(Field(&RefinementRound::cause, "a test")));
  EXPECT_THAT(checked.report.assumptions,
              Contains("the real system followed the counterexample to deadlock"));
  EXPECT_THAT(checked.report.properties.front().trace->steps, SizeIs(8));
}

// The model is right, but the W-method alone leaves it weak; the default tests follow the verdict.
TEST_F(BlackBoxChecking, AVerdictLeansOnTheTestsAfterIt) {
  const auto file =
      write_system(strict_3_, burst_of_three_, ", learning: {eq: w, extra-states: 3}");
  NativeEngine engine;
  CheckRequest request;
  request.properties = {"deadlock"};
  const auto read = [&] {
    return read_system(file, make_learning_source({folder_.path(), {}, {}, 0}));
  };
  const CheckReport before = check_system(read(), engine, request);
  EXPECT_EQ(before.verdict, Verdict::inconclusive);
  EXPECT_THAT(before.properties.front().reason, HasSubstr("write `learning: {effort: 10}`"));

  const RefinedCheck checked = run(file);
  EXPECT_THAT(checked.rounds, IsEmpty());
  const bool is_weak = find_strength(read().models[0].automaton.origin)->is_weak;
  EXPECT_EQ(checked.report.verdict, is_weak ? Verdict::inconclusive : Verdict::holds);
}

TEST_F(BlackBoxChecking, StopsAfterSoManyRefinements) {
  const auto file = write_system(strict_3_, burst_of_three_);
  const RefinedCheck checked = run(file, 0);
  EXPECT_EQ(checked.report.verdict, Verdict::inconclusive);
  EXPECT_THAT(checked.report.properties.front().reason, HasSubstr("0 refinements were not enough"));
}

TEST_F(BlackBoxChecking, AModelThatIsAFileIsNotRefined) {
  write_system(strict_3_, burst_of_three_);
  std::string model = read_file(MAIDE_SOURCE_DIR "/tests/models/buffered.dot");
  model.insert(model.find("inputs="), "sul=\"sim:real.dot\";\n  ");
  write_file_atomically(folder_.path() / "model.dot", model);
  const auto file = folder_.path() / "fixed.yaml";
  write_file_atomically(file, "models:\n  via: {file: model.dot}\nprograms:\n" + burst_of_three_);
  const RefinedCheck checked = run(file);
  EXPECT_EQ(checked.report.verdict, Verdict::inconclusive);
  EXPECT_THAT(checked.report.properties.front().reason, HasSubstr("the model is a file"));
}

TEST_F(BlackBoxChecking, KnowsHowAModelIsToBeLearned) {
  const auto message_of = [&](const std::string& learning) -> std::string {
    try {
      first_model(write_system(strict_3_, burst_of_three_, ", learning: {" + learning + "}"));
    } catch (const Error& error) {
      EXPECT_EQ(error.status(), ExitStatus::usage);
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(message_of("speed: 3"),
              HasSubstr("'learning' has no key 'speed'; it may have: algorithm"));
  EXPECT_THAT(message_of("max-tests: many"), HasSubstr("max-tests: 'many' is not a whole number"));
  EXPECT_THAT(message_of("eq: best"), HasSubstr("best"));
  EXPECT_THAT(message_of("eq: w, effort: 2"), HasSubstr("'w' has the option 'effort'"));
  EXPECT_EQ(
      message_of("eq: w, algorithm: lmplus, seed: 3, extra-states: 1, strength: extra-states=1"),
      "");
}

}  // namespace
}  // namespace maide
