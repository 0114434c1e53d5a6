// `maide learn` and `maide reproduce`: the real program, real processes, the reference port.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "maide/automata/compare.hpp"
#include "maide/base/file.hpp"
#include "maide/base/text.hpp"
#include "maide/formats/model_file.hpp"
#include "maide/sul/ia_translation.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path models = fs::path(MAIDE_SOURCE_DIR) / "tests" / "models";

std::vector<std::string> learn(std::vector<std::string> more) {
  std::vector<std::string> arguments{"learn"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// A row of the paper's Table 1: the port's options, the sizes printed there, the reference model.
struct Row {
  std::vector<std::string> options;
  std::size_t states, transitions;
  std::string reference;
};

const std::vector<Row>& table1() {
  static const std::vector<Row> rows = [] {
    const std::string tryread = "inputs=write,read,tryread";
    std::vector<Row> list{
        {{"kind=port"}, 4, 5, "port"},
        {{"kind=buffered"}, 4, 6, "buffered"},
        {{"kind=buffered", tryread, "at-bound=absorb"}, 4, 8, "buffered-tryread"},
        {{"kind=strict", "size=3", tryread}, 8, 15, "strict-3-tryread"},
        {{"kind=strict", "size=3", tryread, "at_bound=absorb"}, 8, 16, "strict-3-tryread-absorb"},
    };
    for (std::size_t size = 1; size <= 6; ++size) {
      const std::string number = std::to_string(size);
      list.push_back(
          {{"kind=strict", "size=" + number}, 2 * size + 2, 3 * size + 2, "strict-" + number});
    }
    return list;
  }();
  return rows;
}

class LearnTable1 : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Translations, LearnTable1, testing::Values("eager", "av"),
                         [](const auto& row) { return row.param; });

TEST_P(LearnTable1, GivesThePapersSizesAndTheReferenceModels) {
  const TempDir folder("learn-test");
  const std::string file = (folder.path() / "model.dot").string();
  for (const Row& row : table1()) {
    std::vector<std::string> arguments{"port", "--translation", GetParam(), "-o", file, "--json"};
    arguments.insert(arguments.end(), row.options.begin(), row.options.end());
    const SubprocessResult result = run_maide(learn(arguments));
    ASSERT_EQ(result.exit_status, 0) << row.reference << ": " << result.err;
    const Json json = json_of(result);
    EXPECT_EQ(json.at("states"), row.states) << row.reference;
    EXPECT_EQ(json.at("transitions"), row.transitions) << row.reference;
    EXPECT_EQ(json.at("model"), file);

    const InterfaceAutomaton learned = read_interface_automaton(file);
    const auto reference = read_interface_automaton(models / (row.reference + ".dot"));
    const IaComparison difference = compare(learned, reference);
    EXPECT_FALSE(difference.hard) << row.reference;
    EXPECT_TRUE(difference.soft.empty()) << row.reference;
    EXPECT_EQ(learned.size(), reference.size());
    EXPECT_EQ(learned.hidden_returns, reference.hidden_returns) << row.reference;
    std::size_t untried = 0;
    for (StateId state = 0; state < learned.size(); ++state) {
      untried += learned.unexplored(state).size();
    }
    const bool is_refusing = row.options.front() == "kind=strict" &&
                             row.options.back().find("absorb") == std::string::npos;
    EXPECT_EQ(untried, is_refusing ? 1U : 0U) << row.reference;
  }
}

TEST(Learn, GivesTheMealyMachineWhereItIsAskedFor) {
  const TempDir folder("learn-test");
  const std::string file = (folder.path() / "strict-2.dot").string();
  const SubprocessResult result =
      run_maide(learn({"port", "kind=strict", "size=2", "--as", "mealy", "-o", file, "--json"}));
  ASSERT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(json_of(result).at("model_kind"), "mealy");
  const Mealy learned = read_mealy(file);
  const InterfaceAutomaton reference = read_interface_automaton(models / "strict-2.dot");
  EXPECT_FALSE(find_difference(learned, to_mealy(reference, Translation::eager)));
  EXPECT_EQ(learned.origin.at("translation"), "eager");
  EXPECT_EQ(learned.actors, reference.actors);
  // The same commands take it.
  const SubprocessResult same = run_maide({"compare", file, (models / "strict-2.dot").string()});
  EXPECT_EQ(same.exit_status, 0) << same.out;
  const SubprocessResult tested = run_maide({"test", file, "--max-tests", "200"});
  EXPECT_THAT(tested.out, HasSubstr("no difference so far")) << tested.err;
  const SubprocessResult again = run_maide(learn({"sim:" + file, "--as", "ia", "-o", file}));
  EXPECT_EQ(again.exit_status, 0) << again.err;
  EXPECT_TRUE(compare(read_interface_automaton(file), reference).same());
}

TEST(Learn, SystemsWithoutActorsAreMealyMachines) {
  const TempDir folder("learn-test");
  const std::string file = (folder.path() / "queue.dot").string();
  const std::string queue = "exec:python3 " MAIDE_SOURCE_DIR "/examples/python/queue_wrapper.py";
  ASSERT_EQ(run_maide(learn({queue, "size=2", "-o", file})).exit_status, 0);
  const Mealy machine = read_mealy(file);
  EXPECT_EQ(machine.size(), 3U);
  EXPECT_TRUE(machine.actors.empty());
  ASSERT_EQ(run_maide(learn({queue, "size=2", "--as", "ia", "-o", file})).exit_status, 0);
  EXPECT_EQ(read_interface_automaton(file).transition_count(), 12U);
  expect_error(run_maide(learn({queue, "--as", "moore"})), 2, "--as");
}

// What a plain machine calls "refused" is an output like any other.
TEST(Learn, APlainMachineMayRefuseAndChange) {
  const TempDir folder("learn-test");
  const std::string file = (folder.path() / "door.dot").string();
  write_file_atomically(file, R"(digraph g { __start0 -> a; a -> b [label="knock / refused"];
    b -> a [label="knock / welcome"]; })");
  const SubprocessResult result = run_maide(learn({"sim:" + file, "--json"}));
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(json_of(result).at("states"), 2);
}

TEST(Learn, JsonHasWhatTheDesignNames) {
  const Json json = json_of(run_maide(learn({"port", "--json"})));
  for (const char* key :
       {"algorithm", "translation", "states", "transitions", "mealy_states", "output_queries",
        "equivalence_queries", "experiments", "symbols", "resets", "seconds", "seconds_in_system",
        "seconds_in_calls", "seconds_in_quiescence", "seconds_in_reset",
        "seconds_waiting_for_reset", "seconds_in_learner", "strength", "model"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json.at("translation"), "eager");
  EXPECT_TRUE(json.at("model").is_null());
  EXPECT_TRUE(json.at("dot").get<std::string>().starts_with("digraph "));
}

TEST(Learn, ListsTheOptionsOfASystemAsATable) {
  const Json json = json_of(run_maide({"learn", "port", "--list-options", "--json"}));
  EXPECT_EQ(json.at("system"), "port");
  const Json& first = json.at("options").at(0);
  EXPECT_EQ(first.at("key"), "kind");
  EXPECT_EQ(first.at("kind"), "choice");
  EXPECT_EQ(first.at("default"), "port");
  EXPECT_EQ(first.at("allowed"), (Json{"port", "buffered", "strict"}));
  EXPECT_FALSE(first.at("help").get<std::string>().empty());
  EXPECT_THAT(run_maide({"learn", "port", "--list-options"}).out,
              HasSubstr("port|buffered|strict"));
}

TEST(Learn, GivesTheSameModelAndCountsWhateverTheNumberOfJobs) {
  Json runs[2];
  for (const int i : {0, 1}) {
    const std::string jobs = i == 0 ? "1" : "3";
    runs[i] =
        json_of(run_maide(learn({"port", "kind=strict", "size=2", "--jobs", jobs, "--json"})));
    EXPECT_EQ(runs[i].at("jobs").dump(), jobs);
  }
  for (const char* key : {"dot", "output_queries", "experiments", "symbols", "resets"}) {
    EXPECT_EQ(runs[0].at(key), runs[1].at(key)) << key;
  }
  for (const char* wrong : {"0", "-1", "257", "x"}) {
    expect_error(run_maide(learn({"port", "--jobs", wrong})), 2, "from 1 to 256");
  }
}

TEST(Learn, PrintsTheModelAloneOnStandardOutputWithoutAFile) {
  const SubprocessResult result = run_maide(learn({"port", "kind=buffered"}));
  EXPECT_TRUE(result.out.starts_with("digraph ")) << result.out;
  EXPECT_THAT(result.err, HasSubstr("4 states, 6 transitions"));
  EXPECT_TRUE(run_maide(learn({"port", "kind=buffered", "-q"})).err.empty());
}

TEST(Learn, IsBriefWhenAsked) {
  const TempDir folder("learn-test");
  const std::string model = (folder.path() / "model.dot").string();
  const SubprocessResult result = run_maide(learn({"port", "kind=buffered", "-q", "-o", model}));
  EXPECT_EQ(result.out, model + ": 4 states, 6 transitions\n");
  EXPECT_TRUE(result.err.empty());
}

// What a wrapper says may hold anything; nothing of it moves the cursor or rings the bell.
TEST(Learn, ShowsNoControlCharactersOfAWrapper) {
  expect_error(run_maide(learn({"exec:sh -c 'printf \"\\033[2Jboom\\007\\n\" >&2; exit 3'"})), 4,
               "exited with status 3: ?[2Jboom?");
}

TEST(Learn, SaysWhichReturnsAreHidden) {
  const SubprocessResult result = run_maide(learn({"port", "kind=port"}));
  EXPECT_THAT(result.err, HasSubstr("write was seen to block"));
  const Json observed = json_of(run_maide(learn({"port", "observe=message,written", "--json"})));
  EXPECT_TRUE(observed.at("hidden_returns").empty());
}

TEST(Learn, SimulatedModelsComeBackFromAPerfectTeacher) {
  for (const char* name : {"port", "strict-6-tryread", "strict-3-tryread-absorb"}) {
    for (const char* algorithm : {"lmplus", "rs"}) {
      const TempDir folder("learn-test");
      const std::string file = (folder.path() / "model.dot").string();
      const std::string model = (models / (std::string(name) + ".dot")).string();
      const SubprocessResult result = run_maide(
          learn({"sim:" + model, "--eq", "perfect", "--algorithm", algorithm, "-o", file}));
      ASSERT_EQ(result.exit_status, 0) << result.err;
      EXPECT_TRUE(compare(read_interface_automaton(file), read_interface_automaton(model)).same());
    }
  }
}

TEST(Learn, PlainMealyMachinesStayWhatTheyAre) {
  const TempDir folder("learn-test");
  const std::string machine = (folder.path() / "machine.dot").string();
  write_file_atomically(machine,
                        "digraph g { __start0 -> a; a -> b [label=\"x / 1,2\"]; "
                        "b -> a [label=\"x / quiet\"]; }");
  const Json plain = json_of(run_maide(learn({"sim:" + machine, "--json"})));
  EXPECT_EQ(plain.at("translation"), "none");
  EXPECT_EQ(plain.at("states"), 2);
  EXPECT_EQ(plain.at("transitions"), 2);
  // Asked for a translation, the outputs are taken apart: 1 and 2 are due one after the other.
  const Json taken =
      json_of(run_maide(learn({"sim:" + machine, "--translation", "eager", "--json"})));
  EXPECT_EQ(taken.at("states"), 4);
  EXPECT_EQ(taken.at("transitions"), 4);
}

TEST(Learn, PurposesAreNeverLeft) {
  const TempDir folder("learn-test");
  const std::string purpose = (folder.path() / "purpose.dot").string();
  write_file_atomically(purpose,
                        "digraph g { inputs=\"write\"; outputs=\"message\"; __start0 -> a; "
                        "a -> b [label=\"?write\"]; b -> a [label=\"!message\"]; }");
  const std::string file = (folder.path() / "model.dot").string();
  const SubprocessResult result =
      run_maide(learn({"port", "kind=strict", "size=5", "--purpose", purpose, "-o", file}));
  ASSERT_EQ(result.exit_status, 0) << result.err;
  EXPECT_TRUE(
      compare(read_interface_automaton(file), read_interface_automaton(models / "strict-1.dot"))
          .same());
}

// But for a sample of five words, which show that it is the same system.
TEST(Learn, ResumesFromItsCacheWithoutAskingAgain) {
  const TempDir folder("learn-test");
  const std::string cache = (folder.path() / "answers.sqlite").string();
  const auto arguments = learn({"port", "kind=strict", "size=2", "--cache", cache, "--json"});
  const Json first = json_of(run_maide(arguments));
  EXPECT_GT(first.at("experiments"), 0);
  const Json second = json_of(run_maide(arguments));
  EXPECT_EQ(second.at("experiments"), 5);
  EXPECT_EQ(second.at("states"), first.at("states"));
  expect_error(run_maide(learn({"port", "kind=strict", "size=3", "--cache", cache})), 2, "size");
}

// strict-3 is another version of strict-4; buffered has other outputs, port other inputs.
TEST(Learn, StartsFromAModelOfAnotherVersion) {
  bool is_av = false;
  for (const char* old : {"strict-4", "strict-3", "buffered-tryread", "port"}) {
    for (const char* algorithm : {"lsharp", "rs", "op"}) {
      is_av = !is_av;
      const char* translation = is_av ? "av" : "eager";
      const TempDir folder("learn-test");
      const std::string file = (folder.path() / "model.dot").string();
      const std::string from = (models / (std::string(old) + ".dot")).string();
      const Json json = json_of(
          run_maide(learn({"port", "kind=strict", "size=4", "--start-from", from, "--algorithm",
                           algorithm, "--translation", translation, "-o", file, "--json"})));
      EXPECT_EQ(json.at("start_from"), from);
      const IaComparison difference = compare(read_interface_automaton(file),
                                              read_interface_automaton(models / "strict-4.dot"));
      EXPECT_TRUE(difference.same()) << old << " " << algorithm << " " << translation;
    }
  }
}

TEST(Learn, AModelOfTheSameVersionSavesHypotheses) {
  const std::string model = (models / "strict-6.dot").string();
  std::uint64_t hypotheses[2];
  for (const bool from_old : {false, true}) {
    auto arguments = learn({"sim:" + model, "--algorithm", "lsharp", "--json"});
    if (from_old) arguments.insert(arguments.end(), {"--start-from", model});
    hypotheses[from_old] = json_of(run_maide(arguments)).at("equivalence_queries");
  }
  EXPECT_GT(hypotheses[false], 1U);
  EXPECT_EQ(hypotheses[true], 1U);
}

TEST(Learn, AFolderOfModelsSaysWhichOneItIs) {
  const auto learned = [&](const std::string& size) {
    const TempDir folder("learn-test");
    for (const char* known : {"strict-2", "strict-3", "strict-4", "buffered"}) {
      const std::string name = std::string(known) + ".dot";
      fs::copy_file(models / name, folder.path() / name);
    }
    return json_of(run_maide(learn({"port", "kind=strict", "size=" + size, "--start-from",
                                    folder.path().string(), "--json"})));
  };
  const Json three = learned("3"), five = learned("5");
  EXPECT_EQ(three.at("identified").at("model"), "strict-3.dot");
  EXPECT_EQ(three.at("identified").at("known"), 4);
  EXPECT_LE(three.at("identified").at("words"), 3);
  EXPECT_EQ(three.at("equivalence_queries"), 1);
  EXPECT_EQ(five.at("identified").at("model"), nullptr);
  EXPECT_EQ(five.at("complete"), true);
  const SubprocessResult text = run_maide(
      learn({"port", "kind=strict", "size=2", "--start-from", models.string(), "-o", "/dev/null"}));
  EXPECT_NE(text.out.find("identified           strict-2.dot, one of "), std::string::npos)
      << text.out << text.err;
  expect_error(run_maide(learn({"port", "--start-from", "no-such-folder"})), 2,
               "there is no such file or folder (--start-from no-such-folder)");
}

// Every file of the folder that cannot be used is named in one way.
TEST(Learn, NamesTheKnownModelsThatItLeavesOut) {
  const TempDir folder("learn-test");
  fs::copy_file(models / "strict-2.dot", folder.path() / "a.dot");
  fs::copy_file(models / "strict-2.dot", folder.path() / "same.dot");
  fs::copy_file(models / "port.dot", folder.path() / "unreadable.png");
  write_file_atomically(folder.path() / "broken.dot", "digraph {");
  write_file_atomically(folder.path() / "other.dot",
                        "digraph { __start0 -> a; a -> a [label=\"other / x\"]; }");
  const SubprocessResult result = run_maide(learn({"port", "kind=strict", "size=2", "--start-from",
                                                   folder.path().string(), "-o", "/dev/null"}));
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const std::string path = folder.path().string() + "/";
  EXPECT_EQ(result.err, "maide: left out: '}' expected before the end of the file (" + path +
                            "broken.dot:1:10)\n"
                            "maide: left out: it has not all of the system's inputs (" +
                            path +
                            "other.dot)\n"
                            "maide: left out: it behaves as a.dot does (" +
                            path +
                            "same.dot)\n"
                            "maide: left out: a model's file ends in .dot, .gv or .aut (" +
                            path + "unreadable.png)\n");
}

TEST(Learn, ConfirmsOnceWhatItsCacheAnswers) {
  const TempDir folder("learn-test");
  const auto run = [&](const std::string& confirm) {
    return json_of(
        run_maide(learn({"port", "kind=strict", "size=2", "--cache",
                         (folder.path() / "answers").string(), "--confirm", confirm, "--json"})));
  };
  EXPECT_EQ(run("no").at("confirmation_experiments"), 0);
  const Json second = run("yes");
  EXPECT_GT(second.at("confirmation_experiments"), 0);
  EXPECT_EQ(second.at("experiments"), second.at("confirmation_experiments"));
  EXPECT_EQ(run("yes").at("experiments"), 5);
}

TEST(Learn, RefusesOldModelsThatItCannotUse) {
  expect_error(run_maide(learn({"port", "--start-from", "/no/such/model.dot"})), 2,
               "/no/such/model.dot");
  const std::string model = (models / "port.dot").string();
  expect_error(run_maide(learn({"port", "--start-from", model, "--algorithm", "nstar"})), 2,
               "nstar cannot start from an old model");
  std::string coin;
  for (const auto& entry : fs::directory_iterator(models / "nondeterministic")) {
    if (entry.path().extension() == ".dot") coin = entry.path().string();
  }
  expect_error(run_maide(learn({"port", "--start-from", coin})), 2, "(" + coin + ")");
  const TempDir folder("learn-test");
  const std::string coffee = (folder.path() / "coffee.dot").string();
  write_file_atomically(coffee, "digraph { __start0 -> a; a -> a [label=\"coin / beep\"]; }");
  for (const char* translation : {"eager", "av"}) {
    expect_error(
        run_maide(learn({"port", "--start-from", coffee, "--translation", translation})), 2,
        "a model with none of the system's inputs, which are write, read (" + coffee + ")");
  }
}

TEST(Learn, OverwritesNoFileThatItUses) {
  const TempDir folder("learn-test");
  const std::string file = (folder.path() / "file").string();
  const std::string other = (folder.path() / "." / "file").string();
  for (const char* option : {"--plot", "--cache"}) {
    expect_error(run_maide(learn({"port", option, file, "-o", other})), 2,
                 "--output and " + std::string(option) + " are the same file");
  }
  expect_error(run_maide(learn({"port", "--cache", file, "--plot", other})), 2,
               "--plot and --cache are the same file");
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Learn, SaysHowMuchOfASuiteIsAsked) {
  for (const bool is_cut : {false, true}) {
    const SubprocessResult result =
        run_maide(learn({"sim:" + (models / "strict-3.dot").string(), "--eq", "w", "-v",
                         "--max-tests", is_cut ? "3" : "1000000"}));
    EXPECT_THAT(result.err, HasSubstr("a suite of "));
    EXPECT_EQ(result.err.find("; the first 3 are asked") != std::string::npos, is_cut)
        << result.err;
  }
}

TEST(Learn, DfasAndMooreMachinesStayWhatTheyAre) {
  const TempDir folder("learn-test");
  const std::string system = (folder.path() / "system.dot").string();
  const std::string file = (folder.path() / "model.dot").string();
  const char* const texts[] = {
      // Words that end in a: one state as a Mealy machine, two as a DFA.
      "digraph g { s0; s1 [shape=doublecircle]; __start0 -> s0; s0 -> s1 [label=a]; "
      "s0 -> s0 [label=b]; s1 -> s1 [label=a]; s1 -> s0 [label=b]; }",
      "digraph g { s0 [label=\"s0|red\"]; s1 [label=\"s1|green\"]; __start0 -> s0; "
      "s0 -> s1 [label=go]; s1 -> s0 [label=go]; s0 -> s0 [label=stay]; s1 -> s1 [label=stay]; }"};
  for (const char* text : texts) {
    write_file_atomically(system, text);
    for (const char* algorithm : {"lsharp", "rs", "op"}) {
      const Json json = json_of(
          run_maide(learn({"sim:" + system, "--algorithm", algorithm, "-o", file, "--json"})));
      EXPECT_EQ(json.at("states"), 2);
      EXPECT_EQ(json.at("transitions"), 4);
      const SubprocessResult compared = run_maide({"compare", system, file});
      EXPECT_EQ(compared.exit_status, 0) << compared.out;
    }
  }
  // Another initial state: nothing but the empty word shows it.
  write_file_atomically(system, texts[0]);
  write_file_atomically(file,
                        "digraph g { s0 [shape=doublecircle]; s1; __start0 -> s0; "
                        "s0 -> s0 [label=a]; s0 -> s1 [label=b]; s1 -> s0 [label=a]; "
                        "s1 -> s1 [label=b]; }");
  const SubprocessResult compared = run_maide({"compare", system, file});
  EXPECT_EQ(compared.exit_status, 1);
  EXPECT_THAT(compared.out, HasSubstr("the empty word tells them apart"));
}

TEST(Learn, KeepsWhatWasLearnedWhenInterrupted) {
  const TempDir folder("learn-test");
  const std::string file = (folder.path() / "model.dot").string();
  // A fixed delay of 30 ms a step makes the run far longer than the interrupt is away.
  const SubprocessResult result = run_with_maide(
      "timeout -s INT 4 \"$maide\" learn port kind=strict size=4 quiescence=30 "
      "--json -o '" +
      file + "'; exit_status=$?; exit $exit_status");
  // `timeout` says 124 for whatever it interrupted; the JSON says the rest.
  EXPECT_EQ(result.exit_status, 124);
  const Json json = json_of(result);
  EXPECT_EQ(json.at("complete"), false);
  EXPECT_GT(json.at("experiments"), 0);
  EXPECT_THAT(result.err, HasSubstr("interrupted"));
  EXPECT_EQ(fs::exists(file), json.at("states") > 0);
}

TEST(Learn, LimitsEndInconclusive) {
  const SubprocessResult result =
      run_maide(learn({"port", "kind=strict", "--max-experiments", "20", "--json"}));
  EXPECT_EQ(result.exit_status, 3);
  EXPECT_EQ(json_of(result).at("complete"), false);
}

TEST(Learn, RefusesWhatItCannotUseInOneLine) {
  expect_error(run_maide(learn({"nothing-here"})), 2, "nothing-here");
  expect_error(run_maide(learn({""})), 2, "the system's name is empty");
  expect_error(run_maide(learn({"prot"})), 2, "did you mean 'port'");
  expect_error(run_maide(learn({"udp://1"})), 2, "udp://1");
  expect_error(run_maide(learn({"port", "--time", "1e300"})), 2, "--time");
  expect_error(run_maide(learn({"port", "kind=round"})), 2, "round");
  expect_error(run_maide(learn({"port", "colour=red"})), 2, "colour");
  expect_error(run_maide(learn({"port", "size"})), 2, "KEY=VALUE");
  expect_error(run_maide(learn({"port", "--algorithm", "magic"})), 2, "magic");
  expect_error(run_maide(learn({"port", "--eq", "perfect"})), 2, "perfect");
  expect_error(run_maide(learn({"port", "--translation", "lazy"})), 2, "lazy");
  expect_error(run_maide(learn({"sim:/no/such/file.dot"})), 2, "/no/such/file.dot");
  expect_error(run_maide(learn({"port", "-o", "/no/such/folder/m.dot"})), 2, "/no/such/folder");
  expect_error(run_maide(learn({"tcp://127.0.0.1:1"})), 4, "127.0.0.1:1");
  expect_error(run_maide(learn({"exec:/no/such/program"})), 4, "/no/such/program");
  expect_error(run_maide(learn({"exec:sh -c 'echo nonsense'"})), 4, "sh -c");
}

TEST(Learn, RefusesNumbersThatAreNone) {
  for (const char* option :
       {"--extra-states", "--max-tests", "--max-experiments", "--seed", "--time"}) {
    for (const char* text : {"-1", "1e30", "x", "99999999999999999999999", "nan", "inf", "1 2"}) {
      const SubprocessResult result = run_maide(learn({"port", std::string(option) + "=" + text}));
      expect_error(result, 2, option);
      EXPECT_THAT(result.err, HasSubstr("'" + std::string(text) + "' is not a ")) << option;
    }
  }
  const std::string most = "18446744073709551615";
  EXPECT_EQ(run_maide(learn({"port", "--extra-states", most, "--max-tests", "5"})).exit_status, 0);
  EXPECT_EQ(run_maide(learn({"port", "--time", "1e8", "--seed", most})).exit_status, 0);
}

TEST(Learn, NamesTheFileOfAModelThatCannotBeSimulated) {
  const TempDir folder("learn-test");
  const std::string model = (folder.path() / "model.dot").string();
  write_file_atomically(model,
                        "digraph g { __start0 -> a; a -> b [label=\"!x\"]; "
                        "b -> a [label=\"?y\"]; }");
  expect_error(run_maide(learn({"sim:" + model})), 2, "(" + model + ")");
}

// Without it, a long run would end in nothing.
TEST(Learn, KnowsBeforehandWhereTheModelCannotGo) {
  const TempDir folder("learn-test");
  const std::string trace = (folder.path() / "started").string();
  expect_error(run_maide(learn({"exec:sh -c 'touch " + trace + "'", "-o", folder.path().string()})),
               2, "Is a directory");
  EXPECT_FALSE(fs::exists(trace));
}

TEST(Learn, AFullDiskDoesNotCostTheModel) {
  const SubprocessResult text = run_maide(learn({"port", "-o", "/dev/full"}));
  EXPECT_EQ(text.exit_status, 3);
  EXPECT_TRUE(text.out.starts_with("digraph ")) << text.out;
  EXPECT_THAT(text.err, HasSubstr("/dev/full"));
  const SubprocessResult result = run_maide(learn({"port", "-o", "/dev/full", "--json"}));
  EXPECT_EQ(result.exit_status, 3);
  const Json json = json_of(result);
  EXPECT_THAT(json.at("dot").get<std::string>(), testing::StartsWith("digraph "));
  EXPECT_THAT(json.at("error").get<std::string>(), HasSubstr("/dev/full"));
}

// A state that changes though the input was not tried: what was learned is kept, as it was seen.
TEST(Learn, RefusesTheWordOfAWrapperThatBreaksTheRules) {
  const TempDir folder("learn-test");
  const std::string wrapper = (folder.path() / "wrapper.py").string();
  write_file_atomically(wrapper, R"(
import json, sys
def send(**message): print(json.dumps(message), flush=True)
send(type="hello", protocol=1, name="fickle")
for line in sys.stdin:
    message = json.loads(line)
    if message["type"] == "configure":
        send(type="info", inputs=["press"], outputs=["on"])
    elif message["type"] == "run":
        steps = [{"events": ["on"]} if i % 2 else {"status": "unexplored"}
                 for i in range(len(message["word"]))]
        send(type="answer", id=message["id"], steps=steps)
)");
  const SubprocessResult result = run_maide(learn({"exec:python3 '" + wrapper + "'", "--json"}));
  EXPECT_EQ(result.exit_status, 4) << result.err;
  EXPECT_THAT(result.err, HasSubstr("input 'press' is refused and yet changes the state"));
  EXPECT_THAT(result.err, HasSubstr("\"press press\" was answered \"unexplored on\""));
}

TEST(Reproduce, Table1OnTheReferencePort) {
  const SubprocessResult result = run_maide({"reproduce", "table1", "--system", "port", "--json"});
  EXPECT_EQ(result.exit_status, 0);
  const Json json = json_of(result);
  EXPECT_EQ(json.at("sizes_equal"), true);
  EXPECT_EQ(json.at("rows").size(), 11U);
}

TEST(Reproduce, InterruptOnTheReferencePort) {
  const SubprocessResult result =
      run_maide({"reproduce", "interrupt", "--system", "port", "--json"});
  EXPECT_EQ(result.exit_status, 0) << result.err;
  const Json json = json_of(result);
  EXPECT_EQ(json.at("agree"), true);
  EXPECT_EQ(json.at("expected").at("mealy_states"), 5);
  EXPECT_EQ(json.at("paper").at("mealy_states"), 6);
  const Json& port = json.at("systems").at(0);
  EXPECT_EQ(port.at("mealy_states"), 5);
  EXPECT_TRUE(port.at("from_expected").is_null());
  EXPECT_EQ(port.at("from_paper").at("word"), Json::parse(R"(["write", "interrupt"])"));
  EXPECT_EQ(port.at("from_paper").at("here"), "failed,done");
}

TEST(Reproduce, SaysWhatIsNotThere) {
  expect_error(run_maide({"reproduce", "table7"}), 2, "table7");
  expect_error(run_maide({"reproduce", "table2", "--system", "mqtt"}), 2, "mqtt");
  expect_error(run_maide({"reproduce", "table1", "--system", "ros"}), 2, "ros");
}

// Each crash is named with its shortest word, and is in the model.
TEST(LearnCommand, NamesCrashes) {
  const std::string system = "exec:" MAIDE_BINARY_DIR "/bin/fragile_wrapper";
  const TempDir folder;
  const std::string model = folder.path() / "lamp.dot";
  const Json json = json_of(run_maide(learn({system, "--json", "-o", model})));
  EXPECT_EQ(json["states"], 7);
  EXPECT_EQ(json["replacements"]["count"], 0);
  ASSERT_EQ(json["ends"].size(), 1U);
  EXPECT_EQ(json["ends"][0]["output"], "crash");
  EXPECT_EQ(json["ends"][0]["word"], Json({"press", "hit"}));
  EXPECT_EQ(json["ends"][0]["states"], 1);
  EXPECT_EQ(json["ends"][0]["reason"], "the wrapper was killed by signal 6 (Aborted)");
  EXPECT_THAT(read_file(model),
              HasSubstr("crash: press hit (the wrapper was killed by signal 6 (Aborted))"));
  EXPECT_EQ(json_of(run_maide(learn({"sim:" + model, "--json"})))["states"], 7);
  EXPECT_THAT(run_maide(learn({system})).err,
              HasSubstr("  crash                press hit: the wrapper was killed by signal 6"));
}

}  // namespace
}  // namespace maide::test
