"""Small systems whose processes die, are killed, end, and begin anew.

    lives.py [--maide PROGRAM] [--write FOLDER]

As cases.py. Verdicts were derived by hand.
"""

from __future__ import annotations

import sys

from cases import HANGS, RUNS, Case, main

LIVES = "may_die: true, may_restart: {}".format

COUNTS = """
models: {{m: {{use: mutex}}, n: {{use: mutex}}}}
variables: "var x: 0..6;"
programs:
  p: {{do: "x = x + 1; m.lock;"{lives}}}
  q: "{other}"
  r: "n.lock; if (x == 6) {{ skip; }}"
"""

TWO = """
variables: "var x: bool; var y: bool;"
programs:
  p: {{do: "{code}"{lives}}}
  q: "{other}"
"""

SERVES = """
services: {{s: {{server: p, clients: [c], delivery: {delivery}}}}}
programs:
  p: {{do: "{server}"{lives}}}
  c: "{client}"
  q: "{other}"
"""

CLIENT = """
services: {{s: {{server: p, clients: [c], delivery: {delivery}}}}}
programs:
  p: "{server}"
  c: {{do: "s.send; s.receive -> answer; @got skip;"{lives}}}
  q: "{other}"
"""
SERVED = "loop { idle s.serve -> request; s.answer; }"
ONCE = "idle s.serve -> request; s.answer;"

NODE = """
topics: {{t: {{writers: n, readers: w, use: queue, with: {{depth: 9}}}}}}
executors: {{e: {{{executor}}}}}
nodes: {{n: {{executor: e, variables: "var x: bool; var y: bool;", {node}}}}}
programs: {{w: "loop {{ idle t.read -> message; }}", q: "{other}"}}
"""
SETS = 'callbacks: {a: {timer: once 1, do: "if (x) { @old skip; } x = true; @a t.write;"}}'

OFFERS = """
services: {s: {server: n, clients: [c]}}
executors: {e: {kind: single}}
nodes:
  n: {executor: e, start: "@up offer s;", callbacks: {a: {serves: s, do: "s.answer;"}}}
programs: {c: "skip;", q: "restart e; @done skip;"}
"""

TOGETHER = """
models: {{m: {{use: mutex}}, k: {{use: mutex}}}}
programs:
  a: {{do: "loop {{ m.lock; m.unlock; }}", process: one{lives}}}
  b: {{do: "loop {{ k.lock; k.unlock; }}", process: one}}
  q: "{other}"
"""
AT_ONCE = {"together": '{ltl: "F a@end <-> F b@end", fairness: strong}',
           "over": '"F (a@end && b@end)"'}  # fmt: skip

LABELS = """
models: {{m: {{use: mutex}}, k: {{use: mutex}}}}
variables: "var go: bool = true;"
programs:
  a: {{do: "@begins skip; @stands loop {{ m.lock; m.unlock; }}", process: one{lives}}}
  b: {{do: "@begins skip; @stands loop {{ k.lock; k.unlock; }}", process: one, may_die: true}}
  q: "select {{ when (go) {{ }} }} kill one; @killed skip;"
"""
OF_THE_DEAD = {"stands": '"G (q@killed -> !(a@stands && b@end) && !(a@end && b@stands))"',
               "both": '"G (a@end <-> b@end)"', "over": '"G (q@killed -> a@end)"'}  # fmt: skip

RESET = """
variables: "var x: bool;"
programs:
  a: {{do: "x = true;", process: one{lives}}}
  b: {{do: "if (x) {{ skip; }}", process: one}}
  q: "{how} a; @killed skip;"
"""
AS_AT_FIRST = {"reset": '"G (q@end -> !x)"', "was": '{possible: "x"}'}

HELD = """
models: {{m: {{use: mutex{recursive}}}}}
programs:
  p: {{do: "m.lock; m.unlock;"{lives}}}
  q: "{other}"
"""

ON_THE_WAY = """
topics: {{t: {{writers: p, readers: r, use: queue, with: {{depth: 5}}, delivery: late}}}}
programs:
  p: {{do: "{writes}"{writer}}}
  r: {{do: "{reads}"{reader}}}
  q: "{other}"
"""

THREADS = """
topics: {{t: {{writers: n, readers: w, use: queue, with: {{depth: 9}}}}}}
executors: {{e: {{kind: multi, threads: 2}}}}
nodes:
  n:
    executor: e
    groups: {{g: reentrant}}
    callbacks: {{a: {{timer: once 1, group: g, do: "{code}"}}}}
    threads: {{work: "@works t.write; loop {{ if * {{ skip; }} }}"}}
programs: {{w: "loop {{ idle t.read -> message; }}", q: "{other}"}}
"""


def counts(name: str, lives: str, verdicts: dict, other: str = "skip;") -> Case:
    """A program that counts its lives in the file's variable, before it waits for its end."""
    properties = {f"x{k}": f'{{possible: "x == {k}"}}' for k in range(1, 5)}
    return Case(name, COUNTS.format(lives=lives, other=other), verdicts, properties)


def comes_to(most: int) -> dict:
    """That so many lives and no more are possible."""
    return {f"x{k}": "holds" if k <= most else "violated" for k in range(1, 5)}


def two(name: str, code: str, other: str, verdicts: dict | None, lives: str = "",
        **own: str) -> Case:
    """A program that lives as is said, and another."""
    return Case(name, TWO.format(code=code, other=other, lives=lives), verdicts, own)


def serves(name: str, lives: str, client: str, other: str, verdicts: dict, server: str = SERVED,
           delivery: str = "at_once", **own: str) -> Case:
    """A server that lives as is said."""
    text = SERVES.format(server=server, lives=lives, client=client, other=other, delivery=delivery)
    return Case(name, text, verdicts, own)


def node(name: str, executor: str, other: str, verdicts: dict, code: str = SETS,
         **own: str) -> Case:
    """An executor that lives as is said, with one node."""
    return Case(name, NODE.format(executor=executor, other=other, node=code), verdicts, own)


CASES = [
    # What it wrote stays, for others read it; behind its end it does not die. Two deaths behind
    # the first write and before the second one end it, too, so all is over everywhere.
    counts("a program that only dies", ", may_die: true", {**RUNS, **comes_to(1)}),
    counts("a second life", ", " + LIVES("true"), {**RUNS, **comes_to(2)}),
    counts("three more lives", ", " + LIVES(3), {**RUNS, **comes_to(4)}),
    counts("begun anew by another", "", {**RUNS, **comes_to(2)}, "restart p;"),
    counts("begun anew twice by another", "", {**RUNS, **comes_to(3)}, "restart p; restart p;"),
    counts("killed, and not begun anew", "", {**RUNS, **comes_to(1)}, "kill p; kill p;"),
    # Killed after that it begins anew all the same; or it is killed in its second life.
    counts("begun anew, then killed", "", {**RUNS, **comes_to(2)}, "restart p; kill p;"),
    # By itself only once, and by the other once more.
    counts("begun anew by itself and by another", ", " + LIVES(1), {**RUNS, **comes_to(3)},
           "restart p;"),
    Case("a second life of what may not die", TWO.format(
        code="skip;", other="skip;", lives=", may_restart: true"), None),
    Case("101 more lives", TWO.format(code="skip;", other="skip;", lives=", " + LIVES(101)), None),
    Case("no more lives", TWO.format(code="skip;", other="skip;", lives=", " + LIVES(0)), None),
    # Killed, it begins anew by itself.
    counts("a second life of who is killed", ", may_restart: true", {**RUNS, **comes_to(2)},
           "kill p;"),
    counts("as many lives as it is killed", ", may_restart: 3", {**RUNS, **comes_to(3)},
           "kill p; kill p;"),
    two("nobody of this name is killed", "skip;", "kill z;", None),
    # Its own variable is as at first when it begins anew.
    two("its variables begin anew", "if (x) { @old skip; } x = true; y = true; y = true;",
        "restart p; if (y) { skip; }", {**RUNS, "old": "violated"},
        old='{possible: "p@old"}'),
    two("a program kills itself", "@before kill p; @behind y = true;", "if (y) { skip; }",
        {**RUNS, "behind": "violated", "over": "holds"},
        behind='{possible: "p@behind || y"}', over='"F p@end"'),
    two("a program begins anew for ever", "@here restart p; y = true;", "if (y) { skip; }",
        {"deadlock": "holds", "error": "holds", "again": "holds", "y": "violated"},
        again='"G F p@here"', y='{possible: "y"}'),
    two("a program ends itself", "if * { end; } y = true;", "if (y) { skip; }",
        {**RUNS, "over": "holds", "y": "holds", "not": "holds"},
        over='"F p@end"', y='{possible: "y"}', **{"not": '{possible: "p@end && !y"}'}),
    # Its end holds behind its last life alone.
    two("the end of a life is none", "@lives x = true; loop { y = x; }", "if (y) { skip; }",
        {"deadlock": "holds", "two": "violated", "last": "holds", "dead": "violated"},
        ", " + LIVES(1), two='{possible: "p@end && p@lives"}', last='{possible: "p@end"}',
        dead='"F p@end"'),
    two("the end of who may always begin anew", "@lives x = true; loop { y = x; }",
        "kill p; kill p; @killed skip; if (y) { restart p; }",
        {"deadlock": "holds", "end": "violated", "dead": "holds"},
        end='{possible: "p@end"}', dead='{possible: "q@killed && !p@lives"}'),
    # From its death on it is as at first.
    Case("variables are as at first from the death on", RESET.format(lives="", how="kill"),
         {**RUNS, "reset": "holds", "was": "holds"}, AS_AT_FIRST),
    Case("and stay so till the next life", RESET.format(lives="", how="restart"),
         {"deadlock": "holds", "reset": "violated", "was": "holds"}, AS_AT_FIRST),
    # So is what it uses alone; what its text declares is in no scope.
    two("the dead have no variables", "var z: bool = true; @lives x = z; loop { y = z; z = !z; }",
        "kill p; @killed if (y) { skip; }",
        {"deadlock": "holds", "none": "holds", "was": "holds"},
        none='"G (q@killed -> x == false && !(p.z == true) && !(p.z == false))"',
        was='{possible: "x && p.z"}'),
    two("who just dies keeps them", "var z: bool = true; z = false; @lives skip;", "skip;",
        {**RUNS, "stays": "holds"}, ", may_die: true", stays='"G (p.z == false)"'),
    # Weakly fair runs: the killer comes.
    Case("two programs of a process die together", TOGETHER.format(
        lives="", other="kill one;"), {"deadlock": "holds", "together": "holds", "over": "holds"},
         AT_ONCE),
    Case("the process of a program that is killed", TOGETHER.format(lives="", other="kill b;"),
         {"deadlock": "holds", "together": "holds", "over": "holds"}, AT_ONCE),
    Case("two programs of a process begin anew", TOGETHER.format(lives="", other="restart one;"),
         {"deadlock": "holds", "together": "holds", "over": "violated"}, AT_ONCE),
    Case("the labels of the dead", LABELS.format(lives=""), {
        "deadlock": "holds", "stands": "holds", "both": "holds", "over": "holds"}, OF_THE_DEAD),
    Case("the labels of the dead who begin anew", LABELS.format(lives=", may_restart: true"), {
        "deadlock": "holds", "stands": "holds", "both": "holds", "over": "violated"},
         OF_THE_DEAD),
    # Nothing else happens: all runs come to its next life, and those who may not be in it stay.
    two("all runs come to its next life", "@lives x = true;", "restart p; @done skip;",
        {**RUNS, "anew": "holds"},
        anew='{ltl: "F (q@done && !p@end) -> F (q@end && p@lives)", fairness: none}'),
    # Strongly fair runs: to die and to begin anew is no step of its own, and that comes.
    two("a step of its own in one of many lives", "x = true;",
        "loop { restart p; if (x) { @seen skip; } }",
        {"deadlock": "holds", "seen": "holds", "weak": "violated"},
        seen='{ltl: "F x", fairness: strong}', weak='"F x"'),
    # It would be stuck, but is dead again and again.
    Case("who is begun anew again and again", HELD.format(
        recursive="", lives="", other="m.lock; loop { restart p; @again skip; }"),
         {"deadlock": "holds", "again": "holds"},
         {"again": '{ltl: "G F q@again", fairness: none}'}),
    Case("one of two may die", TOGETHER.format(lives=", may_die: true", other="skip;"),
         {"deadlock": "holds", "together": "holds", "over": "violated"},
         AT_ONCE),
    # Its own mutex is free again; of another's it is still held.
    Case("a mutex of its own", HELD.format(recursive="", lives=", " + LIVES(2), other="skip;"),
         RUNS),
    Case("a mutex that others use", HELD.format(
        recursive="", lives=", " + LIVES(1), other="m.lock; m.unlock;"), HANGS),
    Case("a recursive mutex that others use", HELD.format(
        recursive=", with: {recursive: true}", lives=", " + LIVES(1), other="m.lock; m.unlock;"),
         HANGS),
    # The one request is lost, or answered.
    serves("a server that begins anew", "", "s.send; s.receive -> answer;", "restart p;",
           {**HANGS, "got": "holds"}, got='{possible: "c@end"}'),
    serves("asked again", "", "s.send; select { on s.receive -> answer { } timeout 9 { "
           "s.send; select { on s.receive -> answer { } timeout 9 { } } } }", "restart p;",
           {**RUNS, "got": "holds"}, got='{possible: "s!answer"}'),
    # It is away only until it begins anew, which comes.
    serves("there again", "", "skip;", "restart p; @done skip;",
           {**RUNS, "back": "holds", "stays": "violated"},
           back='"F G s.there"', stays='{always: "s.there"}'),
    serves("killed, and found out", "", "skip;", "kill p;",
           {**RUNS, "back": "violated", "gone": "holds"}, back='"F G s.there"',
           gone='"F G !s.there"'),
    # There is no time between its end and that it is known.
    serves("a server that ends itself", "", "skip;", "skip;", {**RUNS, "known": "holds"}, "end;",
           known='{always: "p@end -> !s.there"}'),
    serves("a server that ends", "", "skip;", "skip;", {**RUNS, "known": "violated"}, "skip;",
           known='"F !s.there"'),
    # The only answer may be to the request of the life before.
    Case("an answer to a life before", CLIENT.format(
        server=ONCE, other="restart c;", lives="", delivery="at_once"),
         {**HANGS, "got": "holds"}, {"got": '{possible: "c@got"}'}),
    Case("an answer to a life before, on its way", CLIENT.format(
        server=ONCE, other="restart c;", lives="", delivery="late"),
         {**HANGS, "got": "holds"}, {"got": '{possible: "c@got"}'}),
    Case("a client that begins anew", CLIENT.format(
        server=SERVED, other="skip;", lives=", " + LIVES(2), delivery="at_once"), RUNS),
    # Weakly fair runs: the timer of one life or of both, and what it set is as at first.
    node("a timer that comes once in each life", "kind: single", "restart e; @done skip;",
         {**RUNS, "again": "holds", "old": "violated"},
         again='{possible: "n@a && w:t!message"}', old='{possible: "n@old"}'),
    node("an executor that begins anew by itself", "kind: single, " + LIVES("true"), "skip;",
         {**RUNS, "again": "holds"}, again='{possible: "n.x"}'),
    node("a callback that ends its process", "kind: single", "skip;",
         {**RUNS, "once": "holds", "b": "violated"},
         'callbacks: {a: {timer: 1, do: "t.write; end; @b t.write;"}}',
         once='"F t.write && F G !t.write"', b='{possible: "n@b"}'),
    node("code of main begins anew", "kind: single, main: '@m t.write; spin;'", "restart e;",
         {**RUNS, "m": "holds"}, m='"F (q@end && n.main@m)"'),
    Case("a service that is offered again", OFFERS,
         {**RUNS, "back": "holds", "offer": "holds", "up": "holds"},
         {"back": '"F G s.there"', "offer": '{always: "n.start@up -> !s.there"}',
          "up": '"F (q@end && n.start@up)"'}),
    # What it wrote arrives, or is lost with it.
    Case("what a dead writer wrote", ON_THE_WAY.format(
        writes="t.write; t.write;", writer="", reads="t.read -> message; @one t.read -> message;",
        reader="", other="kill p;"),
         {**HANGS, "lost": "holds", "one": "holds"},
         {"lost": '{possible: "t!lost"}', "one": '{possible: "p@end && r@one"}'}),
    # Nothing comes that was sent before.
    Case("what was on its way to a dead reader", ON_THE_WAY.format(
        writes="t.write; @wrote restart r; skip;", writer="", reads="t.read -> message; @got skip;",
        reader="", other="skip;"),
         {**HANGS, "got": "violated"}, {"got": '{possible: "p@end && t!message"}'}),
    Case("a message to its second life", ON_THE_WAY.format(
        writes="restart r; t.write;", writer="", reads="t.read -> message; @got skip;",
        reader="", other="skip;"), {**HANGS, "got": "holds"}, {"got": '{possible: "r@end"}'}),
    Case("threads die with their executor", THREADS.format(
        code="run work;", other="kill e;"), {"deadlock": "holds", "over": "holds"},
         {"over": '"F G !t.write"'}),
    Case("a thread runs again in the next life", THREADS.format(
        code="run work;", other="restart e;"), {"error": "holds", "two": "holds"},
         {"two": '{possible: "n.work@works && q@end"}'}),
]  # fmt: skip


if __name__ == "__main__":
    sys.exit(main(CASES))
