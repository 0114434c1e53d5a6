// Wrong command lines: each gives one line that fits two of a terminal, says what is wrong, and
// names what is near. `@` is a system file and `%` a model, of this project.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "maide/base/text.hpp"
#include "run_maide.hpp"

namespace maide::test {
namespace {

struct Wrong {
  const char* line;  // behind "maide "
  const char* says;
};

constexpr Wrong wrong_lines[] = {
    {"lern port", "did you mean 'learn'?"},
    {"chek a.yaml", "did you mean 'check'?"},
    {"doctr", "did you mean 'doctor'?"},
    {"exprot x", "did you mean 'export'?"},
    {"helpp", "did you mean 'help'?"},
    {"bnch models", "did you mean 'bench'?"},
    {"cahce show x", "did you mean 'cache'?"},
    {"veiw x.dot", "did you mean 'view'?"},
    {"replya x y", "did you mean 'replay'?"},
    {"comapre a b", "did you mean 'compare'?"},
    {"reprodcue table1", "did you mean 'reproduce'?"},
    {"formta x.yaml", "did you mean 'format'?"},
    {"tset x.dot", "did you mean 'test'?"},
    {"inti", "did you mean 'init'?"},
    {"nwe wrapper", "did you mean 'new'?"},
    {"--versoin", "did you mean '--version'?"},
    {"help langauge", "did you mean 'language'?"},
    {"help algoritms", "did you mean 'algorithms'?"},
    {"help sytems", "did you mean 'systems'?"},
    {"help lern", "did you mean 'learn'?"},
    {"learn", "SUL is required"},
    {"learn prot", "did you mean 'port'?"},
    {"learn port --algoritm lsharp", "did you mean '--algorithm'?"},
    {"learn port --algorithm lsharpp", "did you mean 'lsharp'?"},
    {"learn port --algorithm l*", "'l*' is none of lsharp, "},
    {"learn port --algorithm tt", "did you mean 'ttt'?"},
    {"learn port --algorithm LSHARP", "did you mean 'lsharp'?"},
    {"learn port --algorithm kw", "did you mean 'kv'?"},
    {"learn port --eq standart", "did you mean 'standard'?"},
    {"learn port --eq wpp", "did you mean 'wp'?"},
    {"learn port --eq w,randon-hads", "did you mean 'random-hads'?"},
    {"learn port --eq w:extra-state=1", "did you mean 'extra-states'?"},
    {"learn port --eq random-wrods", "did you mean 'random-words'?"},
    {"learn port --translation eagr", "did you mean 'eager'?"},
    {"learn port --translation aav", "did you mean 'av'?"},
    {"learn port --confirm yess", "did you mean 'yes'?"},
    {"learn port --confirm maybe", "--confirm: 'maybe' is none of yes, no"},
    {"learn port --as mealey", "did you mean 'mealy'?"},
    {"learn port --color alwyas --list-options", "did you mean 'always'?"},
    {"learn port --infix-inputs off-sink", "did you mean 'off-sinks'?"},
    {"learn port --prefix-states depe", "did you mean 'deep'?"},
    {"learn port --suffix-words non", "did you mean 'none'?"},
    {"learn port --strength extra-state=2", "did you mean 'extra-states'?"},
    {"learn port --strength pumpt=2",
     "--strength: 'pumpt=2' is no strength: extra-states, chained, pumped or random, '=' and a "
     "number"},
    {"learn port --strength chained",
     "--strength: 'chained' is no strength: extra-states, chained, pumped or random, '=' and a "
     "number"},
    {"learn port --effort 0", "--effort: '0' is not a whole number from 1 to 1000"},
    {"learn port --effort many", "--effort: 'many' is not a whole number from 1 to 1000"},
    {"learn port --seed -1", "--seed: '-1' is not a whole number from 0 to 18446744073709551615"},
    {"learn port --seed x", "--seed: 'x' is not a whole number from 0 to 18446744073709551615"},
    {"learn port --time 0", "--time: '0' is not a number of seconds from 0.001 to 1e8"},
    {"learn port --time soon", "--time: 'soon' is not a number of seconds from 0.001 to 1e8"},
    {"learn port --jobs 0", "--jobs: '0' is not a whole number from 1 to 256"},
    {"learn port --launch 'ssh {host} {wrapper}'", "--launch needs --hosts FILE"},
    {"learn port --hosts hosts.txt", "--hosts needs --launch COMMAND"},
    {"learn port --launch 'ssh {host}' --hosts /nowhere",
     "cannot read the file: No such file or directory (/nowhere)"},
    {"learn port --launch 'ssh {host}' --hosts h --accept localhost:1",
     "--launch and --accept exclude each other"},
    {"learn port --launch 'ssh {host}' --hosts h --jobs 2", "--jobs is of this machine"},
    {"learn port --accept localhost:1 --jobs 1", "--jobs is of this machine"},
    {"learn port --accept-wait 3", "--accept-wait needs --accept HOST:PORT"},
    {"learn port --accept localhost", "'localhost' is not HOST:PORT"},
    {"learn port --accept 0.0.0.0:0", "which is not loopback, needs a token"},
    {"learn sim:x.dot --accept localhost:1",
     "--accept is for a wrapper by its name or exec:PROGRAM, not for 'sim:x.dot'"},
    {"learn tcp://a:1 --launch '{host}' --hosts h",
     "--launch is for a wrapper by its name or exec:PROGRAM, not for 'tcp://a:1'"},
    {"learn --from-traces log --accept localhost:1", "--accept needs a system"},
    {"learn port --max-experiments many",
     "--max-experiments: 'many' is not a whole number from 0 to 18446744073709551615"},
    {"learn port --confidence 2", "'2' is not a number from 0.5 to 0.999999"},
    {"learn port --repeat 1", "--repeat: '1' is not a whole number from 10 to 100000"},
    {"learn port --output", "--output needs a value"},
    {"learn port -o", "--output needs a value"},
    {"learn port kind", "'kind' is not an option of the system: write KEY=VALUE"},
    {"learn port =strict", "'=strict' is not an option of the system: write KEY=VALUE"},
    {"learn port kind=stric", "did you mean 'strict'?"},
    {"learn port knid=strict", "did you mean 'kind'?"},
    {"learn port kind=strict kind=port", "option 'kind' of the system is given twice"},
    {"learn port size=0", "option size=0: allowed is 1..1000000"},
    {"learn port inputs=write,raed", "did you mean 'read'?"},
    {"learn port observe=mesage", "did you mean 'message'?"},
    {"learn port --depth 3",
     "unknown option '--depth'; an option of the system is written depth=3"},
    {"learn port payload=gapp", "did you mean 'gap'?"},
    {"learn sim:nowhere.dot", "cannot read the file: No such file or directory (nowhere.dot)"},
    {"learn sim:", "nothing follows 'sim:' in the system's name"},
    {"learn exec:", "nothing follows 'exec:' in the system's name"},
    {"learn exec:/nowhere/program",
     "cannot start '/nowhere/program': No such file or directory (exec:/nowhere/program)"},
    {"learn tcp://", "nothing follows 'tcp://' in the system's name"},
    {"learn tcp://localhost", "'localhost' is not HOST:PORT"},
    {"learn foo:bar",
     "unknown system 'foo:bar': give a wrapper's name (port, cyclonedds), sim:FILE, "
     "tcp://HOST:PORT or exec:PROGRAM"},
    {"learn %", "a model is simulated as sim:"},
    {"learn port --start-from nowhere", "there is no such file or folder (--start-from nowhere)"},
    {"learn port --purpose nowhere.dot",
     "cannot read the file: No such file or directory (nowhere.dot)"},
    {"learn port --cache /nowhere/x",
     "cannot open the cache: unable to open database file (/nowhere/x)"},
    {"learn port -o /nowhere/x.dot",
     "cannot write the file: No such file or directory (/nowhere/x.dot)"},
    {"learn port -q -v", "-q and -v exclude each other"},
    {"check", "SYSTEM is required"},
    {"check nowhere.yaml", "cannot read the file: No such file or directory (nowhere.yaml)"},
    {"check @ --engine nativ", "did you mean 'native'?"},
    {"check @ --engine spinn", "did you mean 'spin'?"},
    {"check @ --engine ltsmi", "did you mean 'ltsmin'?"},
    {"check @ --reduction ful", "did you mean 'full'?"},
    {"check @ --reduction cals", "did you mean 'calls'?"},
    {"check @ --property deadlok", "did you mean 'deadlock'?"},
    {"check @ --property acknowleged", "did you mean 'acknowledged'?"},
    {"check @ --trace-format chrat", "did you mean 'chart'?"},
    {"check @ --memory 0", "--memory: '0' is not a whole number from 1 to 1073741824"},
    {"check @ --time -1", "--time: '-1' is not a number of seconds from 0.001 to 1e8"},
    {"check @ --report x.pdf", "a report's name ends in .html or .svg (x.pdf)"},
    {"check @ --refinments 3", "did you mean '--refinements'?"},
    {"check @ extra", "unexpected argument 'extra'"},
    {"export % --to promla", "did you mean 'promela'?"},
    {"export % --to mealey", "did you mean 'mealy'?"},
    {"export % --to dto", "did you mean 'dot'?"},
    {"export @ --to sm", "did you mean 'smv'?"},
    {"export %", "--to is required"},
    {"export % --to hoa",
     "--to hoa writes the automaton of a system's property: it goes with --property NAME"},
    {"compare % nowhere.dot", "cannot read the file: No such file or directory (nowhere.dot)"},
    {"compare %", "B is required"},
    {"test %", "the model does not say what it was learned from"},
    {"test % port --junit", "--junit needs a value"},
    {"test % port --eq hadss", "did you mean 'hads'?"},
    {"cache shwo x", "did you mean 'show'?"},
    {"cache show nowhere.cache",
     "cannot open the cache: unable to open database file (nowhere.cache)"},
    {"cache check", "FILE is required"},
    {"reproduce table3", "did you mean 'table1'?"},
    {"reproduce tabel1", "did you mean 'table1'?"},
    {"reproduce table1 --system prot", "did you mean 'port'?"},
    {"bench nowhere", "there is no such folder (nowhere)"},
    {"bench tests/models --algorithm lsherp", "did you mean 'lsharp'?"},
    {"view nowhere.dot", "cannot read the file: No such file or directory (nowhere.dot)"},
    {"view %.xyz", "what is viewed is a model (.dot, .gv, .aut), a system (.yaml) or a trace"},
    {"format --chek @", "did you mean '--check'?"},
    {"replay @", "give a trace (maide check SYSTEM --trace FILE), or --random N"},
    {"replay @ nowhere.json --rounds 0", "--rounds: '0' is not a whole number from 1 to 1000000"},
    {"init first.yml --system zermq", "did you mean 'zeromq'?"},
    {"new wraper", "did you mean 'wrapper'?"},
    {"new wrapper --tcp x", "an address is HOST:PORT (--tcp x)"},
    {"learn port --tim 3", "did you mean '--time'?"},
    {"learn port --cahce x", "did you mean '--cache'?"},
    {"check @ --sugest", "did you mean '--suggest'?"},
    {"check @ --proprty x", "did you mean '--property'?"},
    {"export % --too dot", "did you mean '--to'?"},
    {"test % port --juint x", "did you mean '--junit'?"},
    {"bench % --cvs x", "did you mean '--csv'?"},
    {"doctor --jsno", "did you mean '--json'?"},
    {"view % --ouput x", "did you mean '--output'?"},
    {"replay @ --ronds 3", "did you mean '--rounds'?"},
    {"learn port reader=2", "did you mean 'readers'?"},
    {"learn port at_bound=absorbed", "did you mean 'absorb'?"},
    {"learn port quiescence=observd", "did you mean 'observed'?"},
    {"learn port step_limt=3", "did you mean 'step-limit'?"},
};

std::string replace(std::string text, char sign, const std::string& by) {
  for (std::size_t at = text.find(sign); at != text.npos; at = text.find(sign, at + by.size())) {
    text.replace(at, 1, by);
  }
  return text;
}

TEST(WrongCommandLines, GetALineThatHelps) {
  EXPECT_GE(std::size(wrong_lines), 100U);
  const std::string system = MAIDE_SOURCE_DIR "/examples/case-study-1/buffered.yaml";
  const std::string model = MAIDE_SOURCE_DIR "/tests/models/port.dot";
  for (const Wrong& wrong : wrong_lines) {
    SCOPED_TRACE(wrong.line);
    const std::string line = replace(replace(wrong.line, '@', system), '%', model);
    const SubprocessResult result = run_maide(split_shell_words(line));
    const bool cannot_start = line.starts_with("learn exec:/");
    expect_error(result, cannot_start ? 4 : 2, wrong.says);
    // Names of files apart, whose length is not ours.
    constexpr std::size_t two_lines = 160;
    std::string said = result.err;
    for (const std::string& name : {system, model}) {
      for (std::size_t at = said.find(name); at != said.npos; at = said.find(name)) {
        said.erase(at, name.size());
      }
    }
    EXPECT_LE(said.size(), two_lines) << said;
  }
}

// Of every name that a user can pick from a list, a near one is suggested.
TEST(WrongCommandLines, ANearNameIsSuggestedForMost) {
  const auto suggests = [](const Wrong& wrong) {
    return std::string_view(wrong.says).find("did you mean") != std::string_view::npos;
  };
  EXPECT_GE(std::count_if(std::begin(wrong_lines), std::end(wrong_lines), suggests), 60);
}

}  // namespace
}  // namespace maide::test
