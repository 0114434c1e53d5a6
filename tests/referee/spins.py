"""Small systems whose start code, or `main:`, gives the callbacks of an executor their turns.

    spins.py [--maide PROGRAM] [--write FOLDER]

As cases.py. States, transitions and verdicts were derived by hand.
"""

from __future__ import annotations

import sys

from cases import HANGS, RUNS, Case, main

SINGLE, ROUNDS = "{{kind: single, main: '{}'}}", "{{kind: single, order: rounds, main: '{}'}}"
ONLY_A, BOTH = '"G !n.b@b"', '"F n.b@b"'

TIMER = """
executors: {{e: {executor}}}
nodes: {{n: {{executor: e, callbacks: {{a: {{timer: 1, do: "@a skip;"}}}}}}}}
"""

TIMERS = """
models: {{m: {{use: mutex}}}}
executors: {{e: {executor}}}
nodes:
  n:
    executor: e
    variables: "var set: bool;"
    callbacks:
      a: {{{first}timer: {kind}1, do: "@a {code}"}}
      b: {{{second}timer: {kind}2, do: "@b {code}"}}
"""

MESSAGES = """
topics:
  t: {{writers: p, readers: n.a, use: queue, with: {{depth: {depth}}}}}
  u: {{writers: n, readers: n.b, use: queue, with: {{depth: 2}}}}
  v: {{writers: n, readers: p, use: queue, with: {{depth: 1}}}}
executors: {{e: {executor}}}
nodes:
  n:
    executor: e
    callbacks:
      a: {{takes: t.read, do: "@a {code}"}}
      b: {{takes: u.read, do: "@b skip;"}}
programs: {{p: "{writes}"}}
"""

ASKS = """
services: {{s: {{server: {server}, clients: [n]}}}}
models: {{m: {{use: mutex}}}}
executors: {{e: {executor}}}
programs: {{p: "{program}"}}
nodes:
  n:
    executor: e
    variables: "var heard: bool;"
    {more}
"""
ANSWERS = "loop {{ idle s.serve -> request; s.answer; }}".format()
SERVED = "s.send; spin until s -> answer; @got skip; spin;"
HEARS = 'clients: {s: {do: "heard = true;"}}'
OWN_TIMER = 'callbacks: {a: {timer: 1, do: "@a skip;"}}'

STARTS = """
executors: {{e: {{kind: single}}}}
nodes:
  n: {{executor: e, start: "{start}", callbacks: {{a: {{timer: once 1, do: "@a skip;"}}}}}}
  o: {{executor: e, callbacks: {{b: {{timer: once 1, do: "@b skip;"}}}}}}
"""

ASKS_IN_START = """
services: {{s: {{server: o, clients: [n]}}}}
executors: {{e: {{kind: single}}, f: {{kind: single}}}}
nodes:
  n: {{executor: e, start: "s.send; spin until s -> answer; @got skip;", callbacks: {{}}}}
  o: {{executor: {0}, callbacks: {{serve: {{serves: s, do: "s.answer;"}}}}}}
"""


def timer(name: str, executor: str, code: str, *more: object) -> Case:
    """An executor of one timer, with this `main:`."""
    return Case(name, TIMER.format(executor=executor.format(code)), *more)


def timers(name: str, spins: str, *more: object, executor: str = SINGLE, **own: str) -> Case:
    """Two timers, with this `main:`."""
    options = {"code": "skip;", "kind": "", "first": "", "second": "", **own}
    return Case(name, TIMERS.format(executor=executor.format(spins), **options), *more)


def messages(name: str, spins: str, *more: object, executor: str = SINGLE, **own: str) -> Case:
    """A subscription, and another for what it writes perhaps."""
    options = {"code": "skip;", "writes": "t.write;", "depth": 2, **own}
    return Case(name, MESSAGES.format(executor=executor.format(spins), **options), *more)


def asks(name: str, code: str, more: str, *verdicts: object, **own: str) -> Case:
    """A node that asks a program, in `main:`."""
    options = {"server": "p", "program": ANSWERS, "executor": SINGLE.format(code), **own}
    return Case(name, ASKS.format(more=more, **options), *verdicts)


OVER = {"over": '"F n.main@over"'}
ENDS = {**RUNS, "over": "holds"}

CASES = [
    # It stands at `spin`, or the callback runs.
    timer("main that spins for ever", SINGLE, "spin;", RUNS, {}, [(2, 2)]),
    # The same with rounds: nothing was found, found, runs.
    timer("main that spins for ever, rounds", ROUNDS, "spin;", RUNS, {}, [(3, 3)]),
    # A callback first, then those of `spin;`.
    timer("a callback, then all", SINGLE, "spin once; spin;", RUNS, {}, [(4, 5)]),
    # At `spin once`, the callback or a turn for nothing, before the end; then nothing starts.
    timer("main ends", SINGLE, "spin once; @over skip;", {**ENDS, "stop": "holds"},
          {**OVER, "stop": '"G (n.main@over -> X G !n.a@a)"'}, [(4, 4)]),
    # Before the lock, behind it, the callback, before the unlock, the end; a time-out skips one.
    timers("a callback or a time-out", "m.lock; spin once timeout 9 { @late skip; } m.unlock;",
           {**RUNS, "late": "violated"}, {"late": '"F n.main@late"'}),
    messages("nothing ever comes", "spin once; @over skip;", {**HANGS, "over": "violated"}, OVER,
             writes="skip;"),
    messages("nothing ever comes, but a time-out", "spin once timeout 9 { } @over skip;", ENDS,
             OVER, writes="skip;"),
    # The first alone, or none, for each message that was there: both writes, or one, or none.
    messages("a look finds each callback once", "spin some; @over skip;",
             {**RUNS, "over": "holds", "twice": "holds"},
             {**OVER, "twice": '"G (t!message -> X (!t!message W n.main@over))"'},
             writes="t.write; t.write;"),
    # What the callback writes is found by no look any more.
    messages("what comes later is not found", "spin some; @over spin some;",
             {**RUNS, "early": "holds", "late": "holds"},
             {"early": '"!n.b@b W n.main@over"', "late": "{possible: n.b@b}"}, code="u.write;"),
    # All that the callback writes is found in the same statement.
    messages("until nothing is there", "spin all; @over skip;", {**RUNS, "all": "holds"},
             {"all": '"G (n.a@a -> (!n.main@over U n.b@b))"'}, code="u.write;"),
    messages("until nothing is there, but one", "spin all 1; @over skip;",
             {**RUNS, "one": "holds"}, {"one": '"G !n.b@b"'}, code="u.write;"),
    # The look (none, one, the other, both), then those that were found; over, and the end. Of both
    # the first is any: 3 sets that have something left, 2 callbacks and 2 that leave nothing.
    timers("any of the timers, each once", "spin some; @over skip;", {**ENDS, "twice": "holds"},
           {**OVER, "twice": '"G (n.a@a -> X (!n.a@a W n.main@over))"'}),
    timers("one of those that were found", "spin some 1; @over skip;",
           {**ENDS, "two": "violated"}, {**OVER, "two": "{possible: n.main@over && n.set}"}),
    # The other was found, and its `when` is false where the first has run.
    timers("what was found and may not start any more", "spin some; @over skip;",
           {**ENDS, "b": "violated"}, {**OVER, "b": '"F n.b@b"'}, code="set = true;",
           second='when: "!set", ', first='when: "!set", '),
    # Everything is over: found no more.
    timers("timers that come once", "spin all; @over skip;", ENDS, OVER, kind="once "),
    timers("timers that come again and again", "spin all; @over skip;",
           {"deadlock": "holds", "over": "violated"}, OVER),
    # A fair look finds none, too.
    timers("timers that come again and again, fair", "spin all; @over skip;", {"over": "holds"},
           {"over": '{ltl: "F n.main@over", fairness: strong}'}),
    # The callback hands the answer over, and then it is taken.
    asks("until the answer", SERVED, OWN_TIMER, {**RUNS, "got": "holds"},
         {"got": '{ltl: "F n.main@got", fairness: strong}'}),
    asks("until an answer that never comes", SERVED, OWN_TIMER,
         {"deadlock": "holds", "stuck": "violated", "got": "violated"},
         {"got": '{ltl: "F n.main@got", fairness: strong}'}, program="s.serve -> request;"),
    asks("until an answer or a time-out", "s.send; spin until s -> answer timeout 9 { @late skip; "
         "} @over skip;", "callbacks: {}", {**ENDS, "both": "holds"},
         {**OVER, "both": "{possible: n.main@late}"}),
    # Its own code runs, and then the answer is taken, which is its event twice.
    asks("a client with its own code hands over, too", SERVED, HEARS,
         {**RUNS, "got": "holds", "heard": "holds", "twice": "violated"},
         {"got": '"F n.main@got"', "heard": '"G (n.main@got -> n.heard)"',
          "twice": '"G (s!answer -> X G !s!answer)"'}),
    asks("nobody waits for what a client's code takes", "s.send; spin;", HEARS,
         {**RUNS, "heard": "holds", "once": "holds"},
         {"heard": '"F n.heard"', "once": '"G (s!answer -> X G !s!answer)"'}),
    # The executor does not run: nobody hands it over.
    asks("a wait in main", "s.send; wait s -> answer;", "callbacks: {}", HANGS),
    # Measured on rclcpp: the turn may be for nothing.
    asks("handed over by a turn, or not", "s.send; spin once; wait s -> answer; @over skip;",
         "callbacks: {}", {**HANGS, "over": "violated"}, OVER),
    # In start code the callbacks of its own node alone.
    Case("start code that spins", STARTS.format(start="spin once; @over skip;"),
         {**RUNS, "own": "holds", "all": "holds"},
         {"own": '"!o.b@b W n.start@over"', "all": '"F n.a@a && F o.b@b"'}),
    Case("start code that spins for ever", STARTS.format(start="spin;"),
         {**RUNS, "own": "holds"}, {"own": '"G !o.b@b"'}),
    Case("start code that waits for an answer", ASKS_IN_START.format("f"),
         {**RUNS, "got": "holds"}, {"got": '"F n.start@got"'}),
    Case("start code that waits for an answer of its own executor",
         ASKS_IN_START.format("e"), HANGS),
    # At `spin`, the callback, before the end; it died there, or ended: that is one.
    timer("it dies in main", SINGLE.replace("main", "may_die: true, main"), "spin once; @over "
          "skip;", {**RUNS, "over": "violated"}, OVER, [(4, 7)]),
    timers("a callback that spins", "spin;", {"error": "violated"}, code="spin some;"),
    Case("a program that spins", 'programs: {p: "spin;"}', None),
    timer("no 'spin once' with rounds", ROUNDS, "spin once;", None),
    Case("no main with several threads",
         TIMER.format(executor="{kind: multi, threads: 2, main: 'spin;'}"), None),
    timer("no more than a hundred", SINGLE, "spin some 101;", None),
]  # fmt: skip


if __name__ == "__main__":
    sys.exit(main(CASES))
