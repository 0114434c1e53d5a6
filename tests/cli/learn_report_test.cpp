// What `maide learn` says of runs that are made up, word for word: everything that can be said.
#include "maide/cli/learn_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace maide::cli {
namespace {

using testing::HasSubstr;

QueryCounts counts(std::uint64_t words, std::uint64_t symbols, std::uint64_t resets) {
  QueryCounts result;
  result.queries = words;
  result.symbols = symbols;
  result.resets = resets;
  return result;
}

// What had been spent in learning, refinement, testing, confirmation.
Statistics spent(std::uint64_t learning, std::uint64_t refinement, std::uint64_t testing,
                 std::uint64_t confirmation) {
  Statistics result;
  result.at(LearnPhase::learning) = counts(learning, 3 * learning, learning + 1);
  result.at(LearnPhase::refinement) = counts(refinement, 4 * refinement, refinement + 2);
  result.at(LearnPhase::testing) = counts(testing, 5 * testing, testing + 3);
  result.at(LearnPhase::confirmation) = counts(confirmation, 6 * confirmation, confirmation + 4);
  return result;
}

// A queue of one, whose second write was never tried and whose third is lost.
InterfaceAutomaton small_queue() {
  InterfaceAutomaton automaton({"write", "read", "tryread"}, {"message", "quiet"}, 3);
  automaton.add_transition(0, {Action::Kind::input, 0}, 1);
  automaton.add_transition(1, {Action::Kind::input, 0}, 1, true);
  automaton.add_transition(1, {Action::Kind::input, 1}, 2);
  automaton.add_transition(2, {Action::Kind::output, 0}, 0);
  automaton.mark_unexplored(2, 0);
  automaton.origin["bound"] = "at most 1 message in flight";
  automaton.hidden_returns = {"tryread"};
  return automaton;
}

LearnedModel rich_run() {
  LearnedModel learned;
  learned.model = small_queue();
  learned.translation = Translation::av;
  learned.mealy_states = 5;
  learned.ends = {{"crash", {"write", "read"}, 2, "it was killed"}, {"hang", {"read"}, 1, ""}};
  learned.inputs_without_effect = {"tryread"};
  for (const char* after : {"write read", ""}) {
    learned.incidents.add({"it was killed by signal 11", after, "write"});
  }
  ExperimentResult& run = learned.experiment;
  run.model = Mealy({"write", "read", "tryread", "delta"}, {"quiet"}, 1);
  run.algorithm = "lsharp";
  run.test_method = "standard";
  run.guarantee = "some tests found nothing";
  run.contradictions = {{"write read", {{"a b", 9}, {"a c", 1}}},
                        {"write", {{"a", 5}, {"b", 3}, {"c", 2}}}};
  run.restarts = 2;
  run.log_contradictions = {{"write write", "full", "written"}};
  run.identified = Identification{"old.dot", 3, 1};
  run.output_queries = 70;
  run.equivalence_queries = 3;
  run.experiments = 60;
  run.symbols = 400;
  run.resets = 50;
  run.seconds = 12.5;
  run.seconds_in_system = 8;
  run.seconds_in_reset = 3;
  run.seconds_in_reset_wait = 2;
  run.seconds_in_settling = 6.5;
  run.seconds_in_learner = 1.25;
  run.statistics = spent(10, 20, 30, 40);
  run.hypotheses = {{1, spent(4, 0, 0, 0)}, {2, spent(4, 8, 5, 0)}, {5, spent(4, 18, 15, 3)}};
  TestedStrength tested;
  tested.strength.extra_states = 1;
  tested.strength.chained = 2;
  tested.strength.random = 2500;
  tested.cost_of_missing = {100, 800};
  tested.is_weak = true;
  run.strength = tested;
  return learned;
}

SystemSpec spec() {
  SystemSpec result;
  result.text = "port";
  result.options = {{"kind", "strict"}, {"size", "1"}};
  return result;
}

TEST(LearnReport, SaysEverythingOfARun) {
  EXPECT_EQ(describe_learned(rich_run(), spec(), {}, 4, "m.dot"), R"(port kind=strict size=1
  interface automaton  3 states, 4 transitions
  Mealy machine        5 states (av)
  queries              70 output queries (lsharp), 3 equivalence queries (standard)
  experiments          60 words run on the system: 50 resets, 400 symbols
  time                 12.50 s: 1.25 learner and tests, 11.25 asking
  in the system        1.50 s calls, 6.50 waiting for quiescence, 3.00 resets (2.00 waited for); sums over 4 at once
  confirmation         40 of these words to confirm answers
  contradictions       2 words were answered in several ways; the majority of each is believed
                       (confidence 0.99)
    write: 5 times "a", 3 times "b", 2 times "c"
    write read: 9 times "a b", 1 time "a c"
    the first input of a word is among them: the reset leaves something behind, or a step ends too early
  the log is wrong     about 1 word: "write write" ends in 'written', there in 'full'
  result               some tests found nothing
  strength             weak: extra-states=1,chained=2,pumped=0,random=2500
  no effect            1 of 3 inputs never had an effect: tryread
  identified           old.dot, one of 3 known models (1 word told them apart)
  bound                at most 1 message in flight: beyond it nothing was tried
  hidden return        tryread was seen to block, and its return is not observed: see observe=
  crash                write read: it was killed; so in 2 states
  hang                 read: known from the cache
  replaced             the wrapper, 2 times: it was killed by signal 11, after "write read"
  model                m.dot
)");
}

TEST(LearnReport, SaysEverythingInNumbers) {
  EXPECT_EQ(learned_as_json(rich_run(), 4, "m.dot").dump(1), R"({
 "algorithm": "lsharp",
 "equivalence_method": "standard",
 "translation": "av",
 "complete": true,
 "states": 3,
 "transitions": 4,
 "mealy_states": 5,
 "output_queries": 70,
 "equivalence_queries": 3,
 "experiments": 60,
 "symbols": 400,
 "resets": 50,
 "jobs": 4,
 "seconds": 12.5,
 "seconds_in_system": 8.0,
 "seconds_in_calls": 1.5,
 "seconds_in_quiescence": 6.5,
 "seconds_in_reset": 3.0,
 "seconds_waiting_for_reset": 2.0,
 "seconds_in_learner": 1.25,
 "guarantee": "some tests found nothing",
 "confirmation_experiments": 40,
 "confirmation_symbols": 240,
 "contradictions": [
  {
   "word": [
    "write",
    "read"
   ],
   "answers": [
    {
     "answer": "a b",
     "count": 9
    },
    {
     "answer": "a c",
     "count": 1
    }
   ]
  },
  {
   "word": [
    "write"
   ],
   "answers": [
    {
     "answer": "a",
     "count": 5
    },
    {
     "answer": "b",
     "count": 3
    },
    {
     "answer": "c",
     "count": 2
    }
   ]
  }
 ],
 "restarts": 2,
 "model": "m.dot",
 "inputs_without_effect": [
  "tryread"
 ],
 "strength": {
  "weak": true,
  "extra_states": 1,
  "chained": 2,
  "pumped": 0,
  "random": 2500
 },
 "strength_demanded": {
  "extra_states": 1,
  "chained": 3,
  "pumped": 64,
  "random": 2000
 },
 "strength_missing": "chained=3,pumped=64",
 "cost_of_missing": {
  "words": 100,
  "symbols": 800,
  "seconds": 25.0
 },
 "phases": {
  "learning": {
   "words": 10,
   "symbols": 30,
   "resets": 11
  },
  "refinement": {
   "words": 20,
   "symbols": 80,
   "resets": 22
  },
  "testing": {
   "words": 30,
   "symbols": 150,
   "resets": 33
  },
  "confirmation": {
   "words": 40,
   "symbols": 240,
   "resets": 44
  }
 },
 "hypotheses": [
  {
   "states": 1,
   "to_make": {
    "words": 4,
    "symbols": 12,
    "resets": 7
   },
   "to_test": {
    "words": 5,
    "symbols": 25,
    "resets": 5
   }
  },
  {
   "states": 2,
   "to_make": {
    "words": 8,
    "symbols": 32,
    "resets": 8
   },
   "to_test": {
    "words": 13,
    "symbols": 68,
    "resets": 13
   }
  },
  {
   "states": 5,
   "to_make": {
    "words": 10,
    "symbols": 40,
    "resets": 10
   },
   "to_test": {
    "words": 52,
    "symbols": 297,
    "resets": 52
   }
  }
 ],
 "ends": [
  {
   "output": "crash",
   "word": [
    "write",
    "read"
   ],
   "states": 2,
   "reason": "it was killed"
  },
  {
   "output": "hang",
   "word": [
    "read"
   ],
   "states": 1,
   "reason": null
  }
 ],
 "identified": {
  "model": "old.dot",
  "known": 3,
  "words": 1
 },
 "replacements": {
  "count": 2,
  "first": [
   {
    "reason": "it was killed by signal 11",
    "after": "write read",
    "asked_again": "write"
   },
   {
    "reason": "it was killed by signal 11",
    "after": "",
    "asked_again": "write"
   }
  ]
 },
 "model_kind": "ia",
 "hidden_returns": [
  "tryread"
 ],
 "bound": "at most 1 message in flight"
})");
}

// Nothing that did not happen is mentioned.
TEST(LearnReport, IsShortWhereThereIsLittleToSay) {
  LearnedModel learned;
  learned.is_plain = true;
  learned.model = Mealy({"coin"}, {"ok"}, 1);
  learned.mealy_states = 1;
  ExperimentResult& run = learned.experiment;
  run.algorithm = "ttt";
  run.test_method = "w";
  run.guarantee = "it is so";
  run.error = std::make_exception_ptr(std::runtime_error("stopped"));
  run.identified = Identification{"", 1, 2};
  SystemSpec plain;
  plain.text = "sim:coffee.dot";
  EXPECT_EQ(describe_learned(learned, plain, {}, 1, ""), R"(sim:coffee.dot  (not finished)
  Mealy machine        1 states
  queries              0 output queries (ttt), 0 equivalence queries (w)
  experiments          0 words run on the system: 0 resets, 0 symbols
  time                 0.00 s: 0.00 learner and tests, 0.00 asking
  in the system        0.00 s calls, 0.00 waiting for quiescence, 0.00 resets (0.00 waited for)
  result               it is so
  identified           not yet (1 known model; 2 words told them apart)
)");
  const Json json = learned_as_json(learned, 1, "");
  EXPECT_EQ(json.at("model"), nullptr);
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_EQ(json.at("model_kind"), "mealy");
  EXPECT_EQ(json.at("translation"), "none");
  EXPECT_EQ(json.at("identified").dump(), R"({"model":null,"known":1,"words":2})");
  EXPECT_EQ(json.at("replacements").dump(), R"({"count":0,"first":[]})");
  EXPECT_EQ(json.at("strength"), nullptr);
  EXPECT_EQ(describe_briefly(learned, "c.dot"), "c.dot: 1 states, 1 transitions (not finished)\n");
  EXPECT_EQ(describe_briefly(rich_run(), "m.dot"), "m.dot: 3 states, 4 transitions (weak)\n");
}

TEST(LearnReport, SaysWhetherAModelIsKnown) {
  LearnedModel learned = rich_run();
  const auto line = [&](const std::string& name, std::size_t known, std::uint64_t words) {
    learned.experiment.identified = Identification{name, known, words};
    const std::string text = describe_learned(learned, spec(), {}, 1, "");
    const std::size_t at = text.find("  identified");
    return text.substr(at, text.find('\n', at) - at);
  };
  EXPECT_EQ(line("", 1, 1),
            "  identified           as none of 1 known model (1 word told them apart)");
  EXPECT_EQ(line("a.dot", 2, 0),
            "  identified           a.dot, one of 2 known models (0 words told them apart)");
  learned.experiment.error = std::make_exception_ptr(std::runtime_error("stopped"));
  EXPECT_EQ(line("", 2, 2),
            "  identified           not yet (2 known models; 2 words told them apart)");
}

// Delta is no input of the system.
TEST(LearnReport, CountsTheInputsThatHadNoEffect) {
  LearnedModel learned = rich_run();
  EXPECT_THAT(describe_strength(learned),
              HasSubstr("  no effect            1 of 3 inputs never had an effect: tryread\n"));
  learned.translation = Translation::eager;
  EXPECT_THAT(describe_strength(learned), HasSubstr("1 of 4 inputs"));
  learned.translation = Translation::av;
  learned.is_plain = true;
  EXPECT_THAT(describe_strength(learned), HasSubstr("1 of 4 inputs"));
  learned.inputs_without_effect.assign(10, "a");
  EXPECT_THAT(describe_strength(learned), HasSubstr(": a, a, a, a, a, a, a, a, a, a\n"));
  learned.inputs_without_effect.assign(12, "a");
  EXPECT_THAT(describe_strength(learned), HasSubstr(": a, a, a, a, a, a, a, a, a, a and 2 more\n"));
  learned.inputs_without_effect.clear();
  learned.experiment.strength.reset();
  EXPECT_EQ(describe_strength(learned), "");
}

TEST(LearnReport, NamesTheLeastCertainWordsFirst) {
  std::vector<Contradiction> wrong;
  for (std::uint64_t i = 1; i <= 12; ++i) {
    wrong.push_back({"a w" + std::to_string(i), {{"x", 50}, {"y", i}}});
  }
  const std::string text = describe_contradictions(wrong, {});
  EXPECT_THAT(text, HasSubstr("12 words were answered in several ways"));
  EXPECT_LT(text.find("a w12: "), text.find("a w11: "));
  EXPECT_THAT(text,
              HasSubstr("a w3: 50 times \"x\", 3 times \"y\"\n    and 2 more\n    a reset that "
                        "leaves something behind, and a step"));
  wrong.resize(10);
  EXPECT_EQ(describe_contradictions(wrong, {}).find(" more\n"), std::string::npos);
  wrong.back().word = "a";
  EXPECT_THAT(describe_contradictions(wrong, {}), HasSubstr("the first input of a word is among"));
  EXPECT_EQ(describe_contradictions(std::vector<Contradiction>(), {}), "");
}

TEST(LearnReport, SaysWhereALogIsWrong) {
  std::vector<LogContradiction> wrong{{"a b", "x", "y"}};
  EXPECT_EQ(describe_contradictions(wrong),
            "  the log is wrong     about 1 word: \"a b\" ends in 'y', there in 'x'\n");
  wrong.resize(LoggedTraces::most_contradictions - 1, {"c", "v", "w"});
  EXPECT_THAT(describe_contradictions(wrong), HasSubstr(" words: \"a b\" ends in 'y'"));
  EXPECT_THAT(describe_contradictions(wrong), testing::EndsWith("there in 'x'\n"));
  wrong.push_back({"c", "v", "w"});
  EXPECT_THAT(describe_contradictions(wrong), testing::EndsWith("in 'x'; it was given up\n"));
  EXPECT_EQ(contradictions_as_json(wrong)[0].dump(),
            R"({"word":["a","b"],"logged":"x","answered":"y"})");
  EXPECT_EQ(describe_contradictions(std::vector<LogContradiction>()), "");
}

TEST(LearnReport, HasATableOfCosts) {
  EXPECT_EQ(describe_statistics(rich_run().experiment),
            R"(  by phase                  words      symbols     resets
    learning                   10           30         11
    refinement                 20           80         22
    testing                    30          150         33
    confirmation               40          240         44
  by hypothesis                                to make it              to test it
                           states      words      symbols      words      symbols
    1                           1          4           12          5           25
    2                           2          8           32         13           68
    3                           5         10           40         52          297
)");
  // Of many hypotheses the first and the last ten.
  ExperimentResult run;
  for (std::size_t i = 1; i <= 20; ++i) run.hypotheses.push_back({100 + i, {}});
  EXPECT_EQ(describe_statistics(run).find("more"), std::string::npos);
  for (std::size_t i = 21; i <= 23; ++i) run.hypotheses.push_back({100 + i, {}});
  const std::string text = describe_statistics(run);
  EXPECT_THAT(text, HasSubstr("    10                        110 "));
  EXPECT_THAT(text, HasSubstr("    ... 3 more ...\n    14                        114 "));
  EXPECT_THAT(text, HasSubstr("    23                        123 "));
  EXPECT_EQ(text.find("    11 "), std::string::npos);
  EXPECT_EQ(text.find("    13 "), std::string::npos);
}

TEST(LearnReport, EstimatesTimesInWords) {
  ExperimentResult run = rich_run().experiment;
  const auto said = [&](double seconds) {
    run.seconds = seconds;
    run.seconds_in_reset_wait = 0;
    run.resets = run.symbols = 1;
    run.strength->cost_of_missing = {1, 1};
    const std::string text = describe_weakness(run);
    const std::size_t at = text.find("symbols, ") + 9;
    return text.substr(at, text.find(" at the speed") - at);
  };
  EXPECT_EQ(said(0.99), "less than a second");
  EXPECT_EQ(said(1), "1 s");
  EXPECT_EQ(said(119), "119 s");
  EXPECT_EQ(said(120), "2 min");
  EXPECT_EQ(said(7199), "120 min");
  EXPECT_EQ(said(7200), "2 h");
  EXPECT_EQ(said(172799), "48 h");
  EXPECT_EQ(said(172800), "2 days");
}

TEST(LearnReport, SaysWhatWasNotTried) {
  ExperimentResult run = rich_run().experiment;
  run.strength->strength = {};
  run.strength->cost_of_missing = {~std::uint64_t{0}, 1};
  const std::string all =
      "WEAK: parts of the system may be missing from this model. Not tried: all tests that find "
      "one state more (reached: none); in every state, all rows of 3 inputs that change nothing "
      "there one by one (reached: 0); in every state, such an input 64 times in a row (reached: "
      "0); 2000 random tests (reached: 0)";
  const std::string countless = ". That would cost more words or symbols than can be counted";
  EXPECT_EQ(describe_weakness(run), all + countless);
  run.strength->cost_of_missing = {1, ~std::uint64_t{0}};
  EXPECT_EQ(describe_weakness(run), all + countless);
  run.strength->cost_of_missing = {};
  EXPECT_EQ(describe_weakness(run), all);
  run.strength->demand = {2, 4, 5, 6};
  EXPECT_EQ(describe_missing(*run.strength),
            "extra-states=2 (reached: none), chained=4 (reached: 0), pumped=5 (reached: 0), "
            "random=6 (reached: 0)");
  // The larger of what is asked for and what every model must reach.
  EXPECT_THAT(describe_weakness(run),
              HasSubstr("all tests that find 2 states more (reached: none)"));
  EXPECT_THAT(describe_weakness(run), HasSubstr("all rows of 4 inputs"));
  EXPECT_THAT(describe_weakness(run), HasSubstr("input 64 times"));
  EXPECT_THAT(describe_weakness(run), HasSubstr("2000 random tests"));
  run.strength->strength.extra_states = 1;
  EXPECT_THAT(describe_weakness(run), HasSubstr("2 states more (reached: 1)"));
  run.error = std::make_exception_ptr(std::runtime_error("stopped"));
  EXPECT_THAT(describe_weakness(run), HasSubstr("WEAK: this model was not tested to the end;"));
  run = rich_run().experiment;
  run.strength->demand = {0, 0, 0, 0};
  EXPECT_THAT(describe_weakness(run), HasSubstr("WEAK, as --strength allows: parts of"));
}

}  // namespace
}  // namespace maide::cli
