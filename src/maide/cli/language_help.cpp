// What `maide help language` prints: the language of system files on a page. The grammar of
// programs stands in check/language/program.hpp, that of formulas in check/ltl/formula.hpp.
#include "maide/cli/command.hpp"

namespace maide::cli {

std::string_view language_help() {
  return R"(The language of system files (what it means: docs/systems.md)

Sections; `programs` or `nodes` must be there:
  constants:   {n: 4, half: n / 2, fast: true}
  models:      NAME: {file: via.dot}  {learn: SUL, with: {KEY: VALUE}}
               {use: mutex}  {use: semaphore, with: {count: n}}
               {use: queue, with: {size: n}}    depth: n|unknown keeps the last
               when_unexplored: stop|wait|drop  when_weak: inconclusive|accept
               ends: {writer: [P, Q], reader: R}         programs at its ends
  topics:      NAME: {writers: P, readers: [Q, R], use: queue, with: {size: n},
                      readers_with: {R: {size: 1}}}      keys as at a model
  services:    NAME: {server: P, clients: [Q, R], with: {depth: n}}
  variables:   "var n: 0..3; var ok: bool;"     what several programs use
  procedures:  NAME(m, k): "STATEMENTS"         parameters: any names
  programs:    NAME: "STATEMENTS"  {do: "STATEMENTS", may_die: true}
  executors:   NAME: {kind: single, order: any|rounds} {kind: multi, threads: n}
  nodes:       NAME: {executor: E, groups: {G: exclusive, H: reentrant},
                      clients: {S: G}, variables: "...", callbacks: {C: {do:
                      "...", group: G, takes: M.read | timer: MS | serves: S}}}
  properties:  NAME: "FORMULA"  {ltl: "FORMULA", fairness: none|weak|strong}
               {always: "EXPRESSION"}  {never: FILE.hoa}
  NAME[i in LOW..HIGH] is an array, of all but constants, executors, properties.

Statements (M: model, x: variable, e: expression; @name before one labels it):
  M.input;  M.input -> output;            gives an input; then takes an output
  wait M -> output;                       takes an output
  switch M.input { output { } quiet { } } goes on by what comes, or nothing due
  select { ARM ARM }                      waits for several things; an arm is
    [when (e)] on M.input -> output { }     an input and its output, in one step
    [when (e)] on M.input { a { } b { } }   the same with several outputs
    [when (e)] on M.input { }               an input without outputs
    [when (e)] on M!output { }              an output that is due
    when (e) { }                            a condition
    otherwise { }  timeout MS { }           nothing else there can be taken
  S.send;  S.receive -> answer;           a client; a callback says wait S
  S.serve -> request;  S.answer;          a service's server
  idle STATEMENT                          may wait there for ever
  if (e) { } else if (e) { } else { }     by values
  if * { } else { }  if fair * { }  x = any e..e;  x = any fair e..e;   choices
  loop { }  while (e) { }  repeat e { }  for k in e..e { }  break;  continue;
  var x: 0..3 = 1;  var ok: bool;  var m: {idle, busy};  var a[k in 0..9]: bool;
  x = e;  a[e] = e;                       no step, unless a variable is shared
  atomic { x = e; if (e) { } }            one step
  call p(ARGUMENTS);  return;  stop;  skip;
Values:       M.write(e);  M.read -> message(x) sets x, message(var x) declares
              it, message(3) takes that one alone, message takes any.
Expressions:  + - * / %   < <= > >= == !=   ! && ||   ( )   true false WORD
Formulas:     P@label  N.callback@label  P@end  M.input  M!output  P:M.input
              P.x < n  ok  ! X F G U R W && || -> <->  forall i in 0..4: FORMULA
Names that are no identifiers are in double quotes. Comments: # and //
)";
}

}  // namespace maide::cli
