#include "maide/sul/fatal_words.hpp"

#include <gtest/gtest.h>

#include "maide/base/error.hpp"
#include "maide/sul/ia_translation.hpp"
#include "maide/sul/ia_translator.hpp"
#include "maide/sul/simulated_sul.hpp"

namespace maide {
namespace {

constexpr Symbol press = 0, hit = 1, delta = 2;

SulInfo lamp_info() {
  SulInfo info;
  info.actors = {"finger", "hammer"};
  info.inputs = {{"press", 0, {"on"}}, {"hit", 1, {"dull"}}};
  info.outputs = {{"on", 0}, {"off", 0}, {"dull", 1}};
  return info;
}

// press, hit: on, crash; with words that a dying system said.
SulAnswer broken_lamp(Translation translation) {
  SulAnswer answer;
  answer.inputs = {press, hit};
  answer.steps.resize(2);
  answer.steps[0].events = {{0, "on"}};
  if (translation == Translation::av) {
    answer.inputs = {press, delta, hit};
    answer.steps.resize(3);
    answer.steps[1] = answer.steps[0];
    answer.steps[0].events.clear();
    answer.steps[1].status = StepStatus::delta;
  }
  answer.steps.back().events = {{0, "off"}, {1, "dull"}};
  answer.steps.back().busy = {1};
  answer.end = WordEnd::crash;
  answer.reason = "no bulb";
  mark_fatal_step(answer, lamp_info());
  return answer;
}

std::string outputs(const SulAnswer& answer, Translation translation) {
  std::string text;
  for (const SulStep& step : answer.steps) {
    text += (text.empty() ? "" : " ") + mealy_output(step, translation);
  }
  return text;
}

TEST(FatalWords, AFatalStepIsOneEventOfTheInputsActor) {
  const SulAnswer answer = broken_lamp(Translation::eager);
  EXPECT_EQ(answer.steps[1].events, (std::vector<Event>{{1, "crash"}}));
  EXPECT_TRUE(answer.steps[1].busy.empty());
}

TEST(FatalWords, TheRestIsRefused) {
  SulAnswer answer = broken_lamp(Translation::eager);
  const SulQuery query = {Word{press, hit, hit, press}, Translation::eager};
  answer_rest(answer, query, lamp_info());
  EXPECT_EQ(outputs(answer, Translation::eager), "on crash refused refused");
  EXPECT_EQ(answer.inputs, (Word{press, hit, hit, press}));
}

TEST(FatalWords, UnderAvTheEndWaitsInTheQueue) {
  SulAnswer answer = broken_lamp(Translation::av);
  const SulQuery query = {Word{press, delta, hit, press, delta, delta, hit}, Translation::av};
  answer_rest(answer, query, lamp_info());
  EXPECT_EQ(outputs(answer, Translation::av), "+ on + refused crash delta refused");
}

TEST(FatalWords, ATreeGoesOnAlongItsBranches) {
  SulAnswer answer = broken_lamp(Translation::eager);
  BasicDecisionTree<std::string> tree;
  tree.nodes = {{press, {{"on", 1}}},
                {hit, {{"crash", 3}, {"dull", 2}}},
                {hit, {}},
                {press, {{"refused", 2}}}};
  answer_rest(answer, {tree, Translation::eager}, lamp_info());
  EXPECT_EQ(outputs(answer, Translation::eager), "on crash refused refused");
  EXPECT_EQ(answer.inputs, (Word{press, hit, press, hit}));
}

TEST(FatalWords, OtherAnswersStayAsTheyAre) {
  SulAnswer answer = broken_lamp(Translation::eager);
  answer.end = WordEnd::aborted;
  answer_rest(answer, {Word{press, hit, hit}, Translation::eager}, lamp_info());
  EXPECT_EQ(answer.steps.size(), 2U);
  FatalWords words;
  words.add(answer, Translation::eager);
  EXPECT_TRUE(words.list(Translation::eager).empty());
}

TEST(FatalWords, AreFoundInWhateverBeginsWithThem) {
  FatalWords words;
  words.add(broken_lamp(Translation::eager), Translation::eager);
  words.add(broken_lamp(Translation::eager), Translation::eager);
  ASSERT_EQ(words.list(Translation::eager).size(), 1U);
  EXPECT_EQ(words.list(Translation::eager)[0].inputs, (Word{press, hit}));
  const auto found = words.find({Word{press, hit, press}, Translation::eager});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(outputs(*found, Translation::eager), "on crash");
  EXPECT_EQ(found->end, WordEnd::crash);
  EXPECT_EQ(found->reason, "no bulb");
  EXPECT_EQ(found->attempts, 0U);
  // Asked once more, it is run: that is how a vote asks.
  EXPECT_FALSE(words.find({Word{press, hit, press}, Translation::eager}).has_value());
  EXPECT_TRUE(words.find({Word{press, hit, hit}, Translation::eager}).has_value());
  EXPECT_FALSE(words.find({Word{press}, Translation::eager}).has_value());
  EXPECT_FALSE(words.find({Word{hit, press, hit}, Translation::eager}).has_value());
  EXPECT_FALSE(words.find({Word{press, hit}, Translation::av}).has_value());
  BasicDecisionTree<std::string> tree;
  tree.nodes = {{press, {{"on", 1}, {"off", 2}}}, {hit, {}}, {press, {}}};
  EXPECT_TRUE(words.find({tree, Translation::eager}).has_value());
  tree.nodes[0].branches = {{"off", 1}};
  EXPECT_FALSE(words.find({tree, Translation::eager}).has_value());
}

TEST(FatalWords, AreKnownFromTheNamesOfOutputs) {
  FatalWords words;
  const SulInfo info = lamp_info();
  words.add({press, hit, hit}, {"on", "hang", "refused"}, info, Translation::eager);
  words.add({press, press}, {"on", "off"}, info, Translation::eager);
  ASSERT_EQ(words.list(Translation::eager).size(), 1U);
  EXPECT_EQ(words.list(Translation::eager)[0].inputs, (Word{press, hit}));
  EXPECT_EQ(words.list(Translation::eager)[0].end, WordEnd::hang);
  words.add({press, delta, hit, press, delta}, {"+", "on", "+", "refused", "crash"}, info,
            Translation::av);
  ASSERT_EQ(words.list(Translation::av).size(), 1U);
  EXPECT_EQ(words.list(Translation::av)[0].inputs, (Word{press, delta, hit}));
  auto found = words.find({Word{press, delta, hit, delta}, Translation::av});
  ASSERT_TRUE(found.has_value());
  answer_rest(*found, {Word{press, delta, hit, delta}, Translation::av}, info);
  EXPECT_EQ(outputs(*found, Translation::av), "+ on + crash");
}

InterfaceAutomaton lamp_that_breaks() {
  InterfaceAutomaton lamp(Alphabet({"press", "hit"}), Alphabet({"on", "crash"}), 5);
  const auto input = [](Symbol symbol) { return Action{Action::Kind::input, symbol}; };
  const auto output = [](Symbol symbol) { return Action{Action::Kind::output, symbol}; };
  lamp.add_transition(0, input(press), 1);
  lamp.add_transition(1, output(0), 2);
  lamp.add_transition(2, input(hit), 3);
  lamp.add_transition(3, output(1), 4);
  return lamp;
}

// A model with a crash is simulated as it was learned.
TEST(FatalWords, AModelWithACrashIsASystem) {
  for (const Translation translation : {Translation::eager, Translation::av}) {
    SimulatedSul sul(lamp_that_breaks(), "sim:lamp");
    IaTranslator translator(sul, translation);
    const Mealy machine = to_mealy(lamp_that_breaks(), translation);
    const bool is_av = translation == Translation::av;
    const std::vector<Query> batch = {is_av ? Word{press, delta, hit, delta, hit, delta}
                                            : Word{press, hit, hit}};
    const MealyAnswer answer = translator.run(batch).front();
    EXPECT_EQ(to_string(answer.outputs, translator.outputs()),
              to_string(machine.output_word(std::get<Word>(batch[0])), machine.outputs()));
    // Behind `on` there is no further press: it blocks. Behind the crash nothing does.
    SulInfo unobserved = lamp_info();
    for (SulInput& input : unobserved.inputs) input.returns.clear();
    EXPECT_EQ(find_hidden_returns(machine, translation, unobserved),
              std::vector<std::string>{"press"});
  }
}

TEST(FatalWords, AModelThatGoesOnBehindItsCrashIsNone) {
  InterfaceAutomaton lamp = lamp_that_breaks();
  lamp.add_transition(4, {Action::Kind::input, press}, 4);
  EXPECT_THROW(SimulatedSul(std::move(lamp), "sim:lamp"), UsageError);
}

}  // namespace
}  // namespace maide
