#include "maide/wire/protocol/protocol.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "maide/base/random.hpp"

namespace maide::protocol {
namespace {

SulInfo example_info() {
  SulInfo info;
  info.name = "port";
  info.actors = {"writer", "reader"};
  info.inputs = {{"write", 0, {"written"}}, {"read", 1, {"next", "gap"}}, {"tryread", 1, {}}};
  info.outputs = {{"next", 1}, {"gap", 1}, {"written", 0}};
  info.options = {{"kind", "strict"}, {"size", "3"}};
  info.bound = "at most 3 messages in flight";
  return info;
}

// One query that was asked, under id 7.
class OneQuery : public AnswerContext {
 public:
  explicit OneQuery(SulQuery query = {}, bool open_outputs = false)
      : query_(std::move(query)), open_(open_outputs) {}
  const SulInfo& info() const override { return info_; }
  bool open_outputs() const override { return open_; }
  const SulQuery* find_query(std::uint64_t id) const override {
    return id == 7 ? &query_ : nullptr;
  }

 private:
  SulInfo info_ = example_info();
  SulQuery query_;
  bool open_;
};

template <typename Message>
Message from_wrapper(const std::string& line, const AnswerContext& context = OneQuery()) {
  EXPECT_EQ(line.find('\n'), std::string::npos);
  return std::get<Message>(decode_from_wrapper(line, context));
}

template <typename Message>
Message to_wrapper(const std::string& line) {
  EXPECT_EQ(line.find('\n'), std::string::npos);
  return std::get<Message>(decode_to_wrapper(line, example_info()));
}

SulQuery word_query(Word word, Translation translation = Translation::eager) {
  return {std::move(word), translation};
}

TEST(Protocol, HelloGoesThere) {
  Hello hello;
  hello.name = "zwölf\n";
  hello.versions = {{"a", "1"}, {"b", "2"}};
  hello.speaks_trees = hello.speaks_av = hello.needs_token = hello.announces_steps = true;
  hello.options = {OptionSpec::integer("size", 3, 1, 9, "how many", {"all"}),
                   common_options::observe({"x", "y"}, "x")};
  const auto back = from_wrapper<Hello>(encode(hello));
  EXPECT_EQ(back.name, hello.name);
  EXPECT_EQ(back.versions, hello.versions);
  EXPECT_TRUE(back.speaks_trees && back.speaks_av && back.needs_token && back.announces_steps &&
              !back.speaks_purposes);
  ASSERT_EQ(back.options.size(), 2u);
  EXPECT_EQ(back.options[0].describe_allowed(), "all|1..9");
  EXPECT_EQ(back.options[1].kind, OptionSpec::Kind::list);
  EXPECT_EQ(back.options[1].help, hello.options[1].help);
}

TEST(Protocol, InfoGoesThere) {
  const auto back = from_wrapper<Info>(encode(Info{example_info(), true, {{"server", "A"}}}));
  EXPECT_EQ(back.versions, (std::map<std::string, std::string>{{"server", "A"}}));
  const SulInfo info = example_info();
  EXPECT_TRUE(back.open_outputs);
  EXPECT_EQ(back.info.actors, info.actors);
  ASSERT_EQ(back.info.inputs.size(), 3u);
  EXPECT_EQ(back.info.inputs[1].returns, info.inputs[1].returns);
  EXPECT_EQ(back.info.inputs[2].actor, 1u);
  ASSERT_EQ(back.info.outputs.size(), 3u);
  EXPECT_EQ(back.info.outputs[2].name, "written");
  EXPECT_EQ(back.info.outputs[2].actor, 0u);
  EXPECT_EQ(back.info.options, info.options);
  EXPECT_EQ(back.info.bound, info.bound);
}

TEST(Protocol, AnswersGoThere) {
  const SulQuery query = word_query({0, 1, 1, 0});
  SulAnswer answer;
  answer.steps.resize(3);
  answer.steps[0].busy = {0, 1};
  answer.steps[0].duration = std::chrono::microseconds(17);
  answer.steps[0].settling = std::chrono::microseconds(5);
  answer.steps[1].status = StepStatus::unexplored;
  answer.steps[2].events = {{0, "written"}, {1, "gap"}, {1, "next"}};
  answer.end = WordEnd::aborted;
  answer.reset_duration = std::chrono::microseconds(99);
  answer.reset_wait = std::chrono::microseconds(33);
  const auto back =
      from_wrapper<Answer>(encode(Answer{7, answer}, example_info(), query), OneQuery(query));
  EXPECT_EQ(back.id, 7u);
  EXPECT_EQ(back.answer.inputs, (Word{0, 1, 1}));
  EXPECT_EQ(back.answer.end, WordEnd::aborted);
  EXPECT_EQ(back.answer.reset_duration, answer.reset_duration);
  EXPECT_EQ(back.answer.reset_wait, answer.reset_wait);
  ASSERT_EQ(back.answer.steps.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back.answer.steps[i].status, answer.steps[i].status);
    EXPECT_EQ(back.answer.steps[i].events, answer.steps[i].events);
    EXPECT_EQ(back.answer.steps[i].busy, answer.steps[i].busy);
    EXPECT_EQ(back.answer.steps[i].duration, answer.steps[i].duration);
    EXPECT_EQ(back.answer.steps[i].settling, answer.steps[i].settling);
  }
}

TEST(Protocol, AResetIsWaitedForUnlessTheWrapperSaysOtherwise) {
  const SulQuery query = word_query({});
  const auto back =
      from_wrapper<Answer>(R"({"type":"answer","id":7,"steps":[],"reset_us":20})", OneQuery(query));
  EXPECT_EQ(back.answer.reset_wait, std::chrono::microseconds(20));
}

// The last step has one event, whatever the wrapper says of it.
TEST(Protocol, ACrashIsAnEventOfTheInputsActor) {
  const SulQuery query = word_query({0, 1, 0});
  for (const char* events : {"[]", R"(["written","next"])", R"(["nonsense",[[]]])"}) {
    const auto back = from_wrapper<Answer>(std::string(R"({"type":"answer","id":7,"end":"crash",)"
                                                       R"("reason":"no\nlamp",)"
                                                       R"("steps":[{"events":[]},{"events":)") +
                                               events + "}]}",
                                           OneQuery(query));
    EXPECT_EQ(back.answer.end, WordEnd::crash);
    EXPECT_EQ(back.answer.reason, "no lamp");
    EXPECT_EQ(back.answer.inputs, (Word{0, 1}));
    EXPECT_EQ(back.answer.steps[1].events, (std::vector<Event>{{1, "crash"}}));
    const auto again = from_wrapper<Answer>(encode(Answer{7, back.answer}, example_info(), query),
                                            OneQuery(query));
    EXPECT_EQ(again.answer.steps[1].events, back.answer.steps[1].events);
    EXPECT_EQ(again.answer.reason, "no lamp");
  }
  EXPECT_THROW(
      decode_from_wrapper(R"({"type":"answer","id":7,"end":"hang","steps":[]})", OneQuery(query)),
      ProtocolError);
  EXPECT_THROW(
      decode_from_wrapper(R"({"type":"info","inputs":["a"],"outputs":["crash"]})", OneQuery(query)),
      ProtocolError);
}

TEST(Protocol, AnnouncementsGoThere) {
  const SulQuery query = word_query({0, 1});
  const std::string line = encode(protocol::Run{7, query, true}, example_info());
  EXPECT_TRUE(to_wrapper<protocol::Run>(line).announce);
  EXPECT_FALSE(to_wrapper<protocol::Run>(encode(protocol::Run{7, query}, example_info())).announce);
  EXPECT_EQ(from_wrapper<Ready>(encode(Ready{7}), OneQuery(query)).id, 7u);
  SulStep step;
  step.events = {{0, "written"}};
  step.busy = {1};
  const auto back = from_wrapper<Step>(encode(Step{7, step}, example_info()), OneQuery(query));
  EXPECT_EQ(back.id, 7u);
  EXPECT_EQ(back.step.events, step.events);
  EXPECT_EQ(back.step.busy, step.busy);
  EXPECT_THROW(decode_from_wrapper(encode(Ready{8}), OneQuery(query)), ProtocolError);
  EXPECT_THROW(decode_from_wrapper(encode(Step{8, step}, example_info()), OneQuery(query)),
               ProtocolError);
  EXPECT_EQ(from_wrapper<Leaving>(encode(Leaving{"tired", 7})).id, 7u);
  EXPECT_EQ(from_wrapper<Leaving>(encode(Leaving{"tired"})).id, std::nullopt);
}

BasicDecisionTree<std::string> example_tree() {
  BasicDecisionTree<std::string> tree;
  tree.nodes = {{1, {{"next", 2}, {"quiet", 1}}}, {0, {}}, {2, {{"refused", 1}}}};
  return tree;
}

TEST(Protocol, TreesGoThereAndTheirAnswersFollowTheBranches) {
  const SulQuery query = {example_tree(), Translation::eager};
  const auto back = to_wrapper<protocol::Run>(encode(protocol::Run{12, query}, example_info()));
  EXPECT_EQ(back.id, 12u);
  const auto& nodes = std::get<BasicDecisionTree<std::string>>(back.query.inputs).nodes;
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0].branches, example_tree().nodes[0].branches);
  EXPECT_EQ(nodes[2].input, 2u);
  SulAnswer answer;
  answer.steps.resize(3);
  answer.inputs = {1, 2, 0};
  answer.steps[0].events = {{1, "next"}};
  answer.steps[1].status = StepStatus::refused;
  const std::string line = encode(Answer{7, answer}, example_info(), query);
  EXPECT_EQ(from_wrapper<Answer>(line, OneQuery(query)).answer.inputs, answer.inputs);
  answer.steps.pop_back();
  EXPECT_THROW(
      decode_from_wrapper(encode(Answer{7, answer}, example_info(), query), OneQuery(query)),
      ProtocolError);
}

TEST(Protocol, WordsGoThereInBothTranslations) {
  const Symbol delta_symbol = 3;
  const SulQuery query = word_query({0, delta_symbol, 2}, Translation::av);
  const std::string line = encode(protocol::Run{3, query}, example_info());
  EXPECT_EQ(line, R"({"type":"run","id":3,"translation":"av","word":["write","Delta","tryread"]})");
  const auto back = to_wrapper<protocol::Run>(line);
  EXPECT_EQ(back.query.translation, Translation::av);
  EXPECT_EQ(std::get<Word>(back.query.inputs), (Word{0, delta_symbol, 2}));
  EXPECT_EQ(to_wrapper<protocol::Run>(encode(protocol::Run{4, word_query({})}, example_info())).id,
            4u);
}

TEST(Protocol, PurposesGoThere) {
  const std::vector<std::string> sends = {"write"};
  const std::vector<std::string> receives = {"next", "gap"};
  const auto purpose = LearningPurpose::in_flight(4, 0, sends, receives, AtBound::absorb);
  const auto back = to_wrapper<Purpose>(encode(purpose));
  EXPECT_EQ(back.purpose.automaton(), purpose.automaton());
  EXPECT_EQ(back.purpose.at_bound(), AtBound::absorb);
}

TEST(Protocol, SmallMessagesGoThere) {
  EXPECT_EQ(to_wrapper<Token>(encode(Token{"a \"b\""})).token, "a \"b\"");
  EXPECT_EQ(to_wrapper<Configure>(encode(Configure{{{"k", "v"}}})).options.at("k"), "v");
  to_wrapper<Cancel>(encode(Cancel{}));
  to_wrapper<Bye>(encode(Bye{}));
  from_wrapper<Ok>(encode(Ok{}));
  EXPECT_EQ(from_wrapper<Leaving>(encode(Leaving{"tired"})).reason, "tired");
  const auto error =
      from_wrapper<ErrorReport>(encode(ErrorReport{ErrorCode::system, "no\nlamp", 5}));
  EXPECT_EQ(error.message, "no lamp");
  EXPECT_EQ(error.id, 5u);
  EXPECT_EQ(error.code, ErrorCode::system);
}

std::string error_to_wrapper(const std::string& line) {
  try {
    decode_to_wrapper(line, example_info());
    return "no error";
  } catch (const ProtocolError& error) {
    return error.what();
  }
}

TEST(Protocol, NonsenseIsNamed) {
  EXPECT_EQ(error_to_wrapper(""), "a line is not JSON: ");
  EXPECT_EQ(error_to_wrapper("[]"), "a line is not a JSON object: []");
  EXPECT_EQ(error_to_wrapper("{}"), "'type' is missing");
  EXPECT_EQ(error_to_wrapper(R"({"type":3})"), "'type' is not a string");
  EXPECT_EQ(error_to_wrapper(R"({"type":"dance"})"), "unknown type 'dance' of line");
  EXPECT_EQ(error_to_wrapper(R"({"type":"run","id":1})"), "'word' is missing");
  EXPECT_EQ(error_to_wrapper(R"({"type":"run","id":1.5,"word":[]})"),
            "'id' is not a whole number from 0 to 18446744073709551615");
  EXPECT_EQ(error_to_wrapper(R"({"type":"run","id":1,"word":["fly"]})"), "unknown input 'fly'");
  EXPECT_EQ(error_to_wrapper(R"({"type":"run","id":1,"word":["Delta"]})"), "unknown input 'Delta'");
  EXPECT_EQ(error_to_wrapper(R"({"type":"run","id":1,"word":[["write"]]})"),
            "'word' is not a string");
  EXPECT_EQ(
      error_to_wrapper(R"({"type":"run","id":1,"tree":[{"input":"read","branches":{"quiet":1}}]})"),
      "'branches' is not a whole number from 0 to 0");
  EXPECT_EQ(error_to_wrapper(R"({"type":"run","id":1,"tree":[{"input":"read"},)"
                             R"({"input":"read","branches":{"a":2}},)"
                             R"({"input":"read","branches":{"b":1}}]})"),
            "a decision tree goes in a circle");
  EXPECT_EQ(error_to_wrapper(R"({"type":"configure","options":{"size":3}})"),
            "'options' is not a string");
  EXPECT_EQ(error_to_wrapper(R"({"type":"purpose","states":0,"initial":0})"),
            "a purpose without states");
  EXPECT_EQ(error_to_wrapper(R"({"type":"purpose","inputs":["a"],"outputs":[],"states":2,)"
                             R"("initial":0,"transitions":[[0,"?a",0],[0,"?a",1]]})"),
            "a learning purpose must be deterministic");
  EXPECT_EQ(error_to_wrapper(R"({"type":"purpose","inputs":["a"],"outputs":[],"states":1,)"
                             R"("initial":0,"transitions":[[0,"?a",1]]})"),
            "'transitions' is not a whole number from 0 to 0");
}

TEST(Protocol, OutputsMayGrowWhereTheWrapperSaysSo) {
  const std::string line = R"({"type":"answer","id":7,"steps":[{"events":["boom"]}]})";
  EXPECT_THROW(decode_from_wrapper(line, OneQuery(word_query({0}))), ProtocolError);
  const auto answer = from_wrapper<Answer>(line, OneQuery(word_query({0}), true));
  EXPECT_EQ(answer.answer.steps[0].events[0].output, "boom");
  EXPECT_THROW(decode_from_wrapper(R"({"type":"answer","id":7,"steps":[{"events":["a,b"]}]})",
                                   OneQuery(word_query({0}), true)),
               ProtocolError);
}

// A damaged line is either still a message or a ProtocolError: nothing else comes out.
TEST(Protocol, DamagedLinesDoNoHarm) {
  const SulQuery tree = {example_tree(), Translation::eager};
  SulAnswer answer;
  answer.inputs = {0, 1};
  answer.steps.resize(2);
  answer.steps[1].events = {{1, "next"}};
  const std::vector<std::string> sends = {"write"};
  Hello hello;
  hello.options = {common_options::payload(), common_options::size(3, 9)};
  const std::vector<std::string> lines = {
      encode(protocol::Run{1, tree}, example_info()),
      encode(protocol::Run{1, word_query({0, 1, 2})}, example_info()),
      encode(Answer{7, answer}, example_info(), word_query({0, 1})),
      encode(LearningPurpose::in_flight(2, 0, sends, sends, AtBound::refuse)),
      encode(Info{example_info(), false}),
      encode(hello),
      encode(Configure{{{"a", "b"}}}),
      encode(ErrorReport{ErrorCode::system, "x", 7})};
  Random random(1);
  const std::string letters = "{}[]\",:0123456789-.eE\\ntfu \x01\xff";
  std::size_t rejected = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string line = lines[random.below(lines.size())];
    for (std::uint64_t edits = random.between(1, 3); edits > 0; --edits) {
      const std::size_t place = random.below(line.size());
      if (random.chance(0.3)) {
        line.erase(place, random.below(8));
        if (line.empty()) line = " ";
      } else {
        line[place] = letters[random.below(letters.size())];
      }
    }
    try {
      decode_to_wrapper(line, example_info());
    } catch (const ProtocolError&) {
      ++rejected;
    }
    try {
      decode_from_wrapper(line, OneQuery(word_query({0, 1})));
    } catch (const ProtocolError&) {
      ++rejected;
    }
  }
  EXPECT_GT(rejected, 20000u);
}

}  // namespace
}  // namespace maide::protocol
