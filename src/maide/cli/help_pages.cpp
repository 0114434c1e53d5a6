// The pages of `maide help PAGE`. They are made from the tables that the program reads: learners,
// test methods and their options, wrappers, formats.
#include <algorithm>
#include <array>
#include <own_wrappers.hpp>  // made by the build
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "maide/base/text.hpp"
#include "maide/check/engines/export/system_exporters.hpp"
#include "maide/cli/command.hpp"
#include "maide/cli/terminal.hpp"
#include "maide/conformance/method/test_methods.hpp"
#include "maide/experiment/open_system.hpp"
#include "maide/formats/exporters.hpp"
#include "maide/learn/learner.hpp"
#include "maide/report/sequence_chart.hpp"

namespace maide::cli {
namespace {

constexpr std::size_t widest_name = 26;

template <typename Table>
std::vector<TextRow> rows_of(const Table& table, auto&& text_of) {
  std::vector<TextRow> rows;
  for (const auto& row : table) rows.emplace_back(std::string(row.name), text_of(row));
  return rows;
}

std::string algorithms_page(std::size_t width) {
  const auto describe = [](const LearnerEntry& entry) { return std::string(entry.description); };
  return "Learning algorithms (--algorithm); the first is the default\n\n" +
         two_columns(rows_of(learners(), describe), width, widest_name);
}

std::string tests_page(std::size_t width) {
  const auto describe = [](const TestMethodEntry& entry) { return std::string(entry.description); };
  std::vector<TextRow> options;
  for (const TestOption& option : test_options()) {
    options.emplace_back(
        "--" + std::string(option.key) + " " + std::string(option.value),
        std::string(option.help) + (option.is_of_run ? "" : " (" + methods_with(option.key) + ")"));
  }
  return "How hypotheses are tested (--eq); the first is the default\n\n" +
         two_columns(rows_of(test_methods(), describe), width, widest_name) + "\n" +
         wrap(
             "Several with commas between are asked in turn, each with options of its own: "
             "--eq w:extra-states=1,random-hads:max-tests=5000",
             width, 0) +
         "\nOptions of tests, and the methods that look at them\n\n" +
         two_columns(options, width, widest_name);
}

std::string systems_page(std::size_t width) {
  std::vector<TextRow> wrappers;
  for (const OwnWrapper& wrapper : own_wrappers) {
    wrappers.emplace_back(
        std::string(wrapper.name),
        std::string(wrapper.title) + (find_wrapper(wrapper.name) ? "" : " (not on this machine)"));
  }
  std::vector<TextRow> machines;
  for (const MachineOption& option : machine_options()) {
    machines.emplace_back(std::string(option.flag) + " " + std::string(option.value),
                          std::string(option.help));
  }
  return "Systems (SUL), with options behind them: KEY=VALUE ...\n\n" +
         two_columns({{"NAME",
                       "The program maide-wrap-NAME, found beside maide, in "
                       "../libexec/maide or on PATH"},
                      {"sim:FILE", "A model, simulated"},
                      {"exec:PROGRAM ARGS", "Any program that speaks the wire protocol"},
                      {"tcp://HOST:PORT,...",
                       "Wrappers that listen; the token comes from "
                       "--token-file or MAIDE_TOKEN"}},
                     width, widest_name) +
         "\nWrappers on other machines (maide learn, test, cache check)\n\n" +
         two_columns(machines, width, widest_name) + "\nWrappers that come with Maide\n\n" +
         two_columns(wrappers, width, widest_name) + "\n" +
         wrap(
             "'maide learn NAME --list-options' lists the options of a system, 'maide doctor' "
             "tells what is usable on this machine. In keys - and _ are the same.",
             width, 0);
}

std::string formats_page(std::size_t width) {
  const auto describe = [](const auto& entry) { return std::string(entry.summary); };
  std::vector<TextRow> of_models = rows_of(exporters(), describe);
  of_models.emplace_back(tikz, tikz_summary);
  return "Formats of a model (maide export MODEL --to NAME)\n\n" +
         two_columns(of_models, width, widest_name) +
         "\nFormats of a system (maide export SYSTEM.yaml --to NAME)\n\n" +
         two_columns(rows_of(system_exporters(), describe), width, widest_name) +
         "\nFormat of a property of a system (--property NAME --to hoa)\n\n" +
         two_columns({{"hoa", "its automaton, for Spot and other tools of temporal logic"}}, width,
                     widest_name);
}

}  // namespace

std::span<const HelpPage> help_pages() {
  static constexpr std::array pages{
      HelpPage{"systems", "what can be learned and tested, and how it is named", systems_page},
      HelpPage{"algorithms", "the learning algorithms", algorithms_page},
      HelpPage{"tests", "how hypotheses and systems are tested", tests_page},
      HelpPage{"formats", "what models and systems can be written as", formats_page},
      HelpPage{"language", "how system files are written",
               [](std::size_t) { return std::string(language_help()); }},
  };
  return pages;
}

const HelpPage* find_help_page(std::string_view name) {
  for (const HelpPage& page : help_pages()) {
    if (page.name == name) return &page;
  }
  return nullptr;
}

std::string describe_help_pages() {
  std::vector<TextRow> rows;
  for (const HelpPage& page : help_pages()) {
    rows.emplace_back("maide help " + std::string(page.name), std::string(page.summary));
  }
  return two_columns(rows, help_width(), widest_name);
}

// What `maide help language` prints: the language of system files on a page. The grammar of
// programs stands in check/language/code_parser.cpp, that of formulas in check/ltl/formula.hpp.

std::string_view language_help() {
  return R"(The language of system files (what it means: docs/systems.md)

Sections; `programs` or `nodes` must be there:
  constants:   {n: 4, half: n / 2, fast: true}   holes: [TEXT]  nothing "holds"
  models:      NAME: {file: via.dot}  {learn: SUL, with: {KEY: VALUE}}
               {use: mutex}  {use: condition, with: {mutex: m}}
               {use: semaphore, with: {count: n}}  {use: queue, with: {size: n}}
               when_unexplored: stop|wait|drop  when_weak: inconclusive|accept
               ends: {writer: [P, Q], reader: R}         programs at its ends
  topics:      NAME: {writers: P, readers: [Q, R], use: queue, with: {depth: n},
                      readers_with: {R: {size: 1}}}      keys as at a model
  services:    NAME: {server: P, clients: [Q, R], with: {depth: n}}
               ends may be `anybody`: values: 0..3, fair: true, may_not_answer
               all three: delivery: late|at_once, loses: true   stream: A
  variables:   "var n: 0..3; var ok: bool;"     what several programs use
  procedures:  NAME(m, k): "STATEMENTS"         parameters: any names
  programs:    NAME: "STATEMENTS"  {do: "STATEMENTS", may_die: true, process: A}
  executors:   NAME: {kind: single, order: any|rounds} {kind: multi, threads: n}
  nodes:       NAME: {executor: E, groups: {G: exclusive, H: reentrant},
                      clients: {S: G}, variables: "...", callbacks: {C: {do:
                      "...", group: G, takes: M.read | timer: MS | serves: S}}}
  properties:  NAME: "FORMULA"  {ltl: "FORMULA", fairness: none|weak|strong}
               {always|possible|always_possible: "EXPRESSION"}  {never: F.hoa}
  NAME[i in LOW..HIGH] is an array, of all but constants, executors, properties.

Statements (M: model, x: variable, e: expression; @name before one labels it):
  M.input;  M.input -> output;            gives an input; then takes an output
  wait M -> output;  wait M -> arrived;   takes it; all it sent to M has arrived
  switch M.input { output { } quiet { } } goes on by what comes, or nothing due
  select { ARM ARM }                      waits for several things; an arm is
    [when (e)] on M.input -> output { }     an input and its output, in one step
    [when (e)] on M.input { a { } b { } }   several outputs; none: M.input { }
    [when (e)] on M!output { }              an output that is due, or `arrived`
    when (e) { }  otherwise { }  timeout MS { }  a condition; if all else waits
  S.send;  S.receive -> answer;  wait S -> there;  a client; a callback: wait S
  S.serve -> request;  S.answer;  offer S;  withdraw S;   a service's server
  if (e) { } else if (e) { } else { }     by values;  idle STATEMENT rests
  if * { } else { }  if fair * { }  x = any e..e;  x = any fair e..e;   choices
  loop { }  while (e) { }  repeat e { }  for k in e..e { }  break;  continue;
  var x: 0..3 = 1;  var ok: bool = any;  var m: {a, b};  var a[k in 0..9]: bool;
  x = e;  a[e] = e;  no step, unless shared;  STATEMENT at "FILE:LINE"; source
  atomic { x = e; if (e) { } }            one step; `when (e) atomic { }` waits
  call p(ARGS);  return;  stop;  skip;  unknown;  run T;  join T;  end;  kill E;
  spin;  spin once|some|all;  spin until S -> answer;   in an executor's `main`
Values:       M.write(e);  M.read -> message(x) sets x, message(var x) declares
              it, message(3) takes that one alone, message takes any.
Expressions:  + - * / %   < <= > >= == !=   ! && ||   ( )   true false WORD
Formulas:     P@label  N.callback@label  P@end  M.input  M!output  P:M.input
              P.x < n  ok  ! X F G U R W && || -> <->  forall i in 0..4: FORMULA
Names that are no identifiers are in double quotes. Comments: # and //
)";
}

}  // namespace maide::cli
