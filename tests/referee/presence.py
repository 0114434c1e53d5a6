"""Small systems of start code, threads, timers that come once, services that are offered, and
servers and clients that die.

    presence.py [--maide PROGRAM] [--write FOLDER]

As cases.py. States, transitions and verdicts were derived by hand.
"""

from __future__ import annotations

import sys

from cases import ASKS, HANGS, ROUNDS, RUNS, SINGLE, Case, main, threads

LATE = """
services: {{s: {{server: server, clients: [client]}}}}
programs:
  server: "{server}"
  client: "{client}"
"""
SERVES = "s.serve -> request; s.answer;"
CALLS = "s.send; s.receive -> answer;"


def late(name: str, server: str, client: str, sizes: list, verdicts: dict, **own: str) -> Case:
    """A program that serves, and one that asks."""
    return Case(name, LATE.format(server=server, client=client), verdicts, own, sizes)


TWO_CLIENTS = """
services: {s: {server: server, clients: [a, b]}}
programs:
  server: "offer s; s.serve -> request; withdraw s; s.answer;"
  a: "wait s -> there; s.send; s.receive -> answer;"
  b: "wait s -> there; s.send; s.receive -> answer;"
"""

LOST_ON_ITS_WAY = """
topics: {{sent: {{writers: client, readers: server, use: queue, with: {{depth: 1}}}}}}
services: {{s: {{server: server, clients: [client], delivery: {delivery}}}}}
programs:
  server: |
    offer s; sent.read -> message; withdraw s; offer s;
    loop {{ idle s.serve -> request; s.answer; }}
  client: "wait s -> there; s.send; sent.write; s.receive -> answer;"
"""

STRANGER = """
services: {s: {server: server, clients: [client]}}
programs:
  server: "offer s; withdraw s;"
  client: "skip;"
  watcher: "wait s -> there; if (s.there) { @up stop; } @down skip;"
"""

FOR_EACH_OTHER = """
services: {{s: {{server: second, clients: [first]}}}}
executors: {{one: {{kind: single}}, two: {{kind: single}}}}
nodes:
  first: {{executor: one, start: "wait s -> there;"}}
  second:
    executor: {executor}
    start: "offer s;"
    callbacks: {{find: {{serves: s, do: "s.answer;"}}}}
"""

START = """
models: {{k: {{use: mutex}}}}
topics: {{a: {{writers: world, readers: n, use: queue, with: {{depth: 1}}}}}}
executors: {{main: {executor}}}
programs: {{world: "a.write;"}}
nodes:
  n:
    executor: main
    groups: {{other: exclusive}}
    variables: "var ready: bool;"
    start: "{start}"
    callbacks: {{on_a: {{takes: a.read, group: other, do: "@works k.lock; k.unlock;"}}}}
"""
FIRST = "k.lock; ready = true; @starts k.unlock;"
READY = {"ready": '{always: "n@works -> n.ready"}',
         "apart": '"G (n.start@starts -> !n.on_a@works)"', "comes": '"F n.on_a@works"'}  # fmt: skip
IS_READY = {**RUNS, "ready": "holds", "apart": "holds", "comes": "holds"}

STARTS_IN_ORDER = """
models: {k: {use: mutex}}
executors: {main: {kind: single}}
variables: "var at: 0..2;"
nodes:
  a: {executor: main, start: "@a k.lock; at = 1;", callbacks: {}}
  b: {executor: main, callbacks: {never: {timer: once 1, when: "at == 0", do: "skip;"}}}
  c: {executor: main, start: "if (at == 1) { at = 2; } @c k.unlock;", callbacks: {}}
"""

ASKS_IN_START = """
services: {{lookup: {{server: database, clients: [caller]}}}}
executors: {{main: {executor}}}
programs: {{database: "loop {{ idle lookup.serve -> request; lookup.answer; }}"}}
nodes: {{caller: {{executor: main, start: "{code}", callbacks: {{}}}}}}
"""
GIVES_UP = "lookup.send; select { on lookup!answer { @got skip; } timeout 9 { @gave_up skip; } }"

ONCE = """
models: {{k: {{use: mutex}}}}
executors: {{main: {executor}}}
nodes:
  n:
    executor: main
    groups: {{free: reentrant}}
    callbacks: {{go: {{timer: once 10, group: free, do: "k.lock; k.unlock;"}}}}
"""

WHEN = """
executors: {{main: {executor}}}
nodes:
  n:
    executor: main
    variables: "var set: bool;"
    callbacks:
      a: {{timer: once 1, do: "set = true;"}}
      b: {{timer: once 1, when: "{when}", do: "@b skip;"}}
"""

KEPT = """
topics:
  a: {{writers: world, readers: n.on_a, use: queue, with: {{depth: 1}}}}
  b: {{writers: world, readers: n.on_b, use: queue, with: {{depth: 1}}}}
executors: {{main: {executor}}}
programs: {{world: "{writes}"}}
nodes:
  n:
    executor: main
    variables: "var open: bool;"
    callbacks:
      on_a: {{takes: a.read, when: "open", do: "skip;"}}
      on_b: {{takes: b.read, do: "open = true;"}}
"""
TAKEN = {"taken": '"F a!message"', "closed": '{always: "a!message -> n.open"}'}

WHEN_THERE = """
services: {s: {server: server, clients: [n]}}
programs: {server: "offer s; loop { idle s.serve -> request; s.answer; }"}
nodes:
  n:
    clients: {s: {do: "@got skip;"}}
    callbacks: {go: {timer: once 1, when: "s.there", do: "s.send;"}}
"""

THREAD = """
models: {{k: {{use: mutex}}}}
nodes:
  n:
    callbacks: {{go: {{timer: once 1, do: "{code}"}}}}
    threads: {{work: {{count: {count}, do: "@works k.lock; k.unlock;"}}}}
"""

UNNAMED = """
models: {k: {use: mutex}}
nodes: {n: {callbacks: {}, threads: {work: {count: 2, do: "k.lock; @in k.unlock;"}}}}
"""

ASKING_THREAD = """
services: {{lookup: {{server: database, clients: [n]}}}}
executors: {{main: {executor}}}
programs: {{database: "loop {{ idle lookup.serve -> request; lookup.answer; }}"}}
nodes:
  n:
    executor: main
    groups: {{answers: exclusive}}
    clients: {{lookup: answers}}
    callbacks: {{go: {{timer: once 1, do: "{code}"}}}}
    threads: {{work: "%s"}}
""" % ASKS

THREAD_ENDS = """
services: {lookup: {server: database, clients: [n]}}
programs: {database: "loop { idle lookup.serve -> request; lookup.answer; }"}
nodes:
  n:
    variables: "var asked: bool;"
    callbacks: {go: {timer: once 1, do: "run work; join work; run work;"}}
    threads:
      work: "if (!asked) { asked = true; lookup.send; } else { wait lookup -> answer; }"
"""

THREAD_VARIABLES = """
nodes:
  n:
    variables: "var count: 0..2;"
    callbacks: {{go: {{timer: once 1, do: "run work;{second} join work;{third}"}}}}
    threads: {{work: "count = count + 1;"}}
"""

DEATH = """
services: {{s: {{server: server, clients: [client]{delivery}}}}}
programs:
  server: {server}
  client: {client}
"""
MORTAL = '{{do: "{0}", may_die: true}}'.format
SAFE = '"{0}"'.format
TURNS = "loop { if * { skip; } }"


def dies(name: str, server: str, client: str, sizes: list | None, verdicts: dict | None,
         delivery: str = "", **own: str) -> Case:
    """A program that serves, and one that asks; one of them may die."""
    text = DEATH.format(server=server, client=client, delivery=delivery)
    return Case(name, text, verdicts, own, sizes)


FOUND_OUT = {"comes": '"G (server@end -> F client@end)"',
             "never": '{ltl: "G (server@end -> F client@end)", fairness: none}',
             "can": '{possible: "client@end"}'}  # fmt: skip
ON_WIRES = {"lost": '{possible: "s!answer_lost"}',
            "none": '"G (server@end -> G !s!request_arrives)"'}  # fmt: skip

DYING_SERVER = """
services: {{s: {{server: n, clients: [client]}}}}
executors: {{e: {executor}}}
programs: {{client: "{client}"}}
nodes: {{n: {{executor: e{start}, callbacks: {{find: {{serves: s, do: "s.answer;"}}}}}}}}
"""
DIES, DIES_ROUNDS = "{kind: single, may_die: true}", "{kind: single, order: rounds, may_die: true}"

DYING_CLIENT = """
services: {s: {server: server, clients: [n]}}
executors: {e: {kind: single, may_die: true}}
programs: {server: "idle s.serve -> request; s.answer;"}
nodes:
  n:
    executor: e
    clients: {s: {do: "skip;"}}
    callbacks: {go: {timer: once 1, do: "s.send;"}}
"""

DYING_READER = """
topics: {a: {writers: world, readers: n, use: queue, with: {size: 1}}}
executors: {e: {kind: single, may_die: true}}
programs: {world: "a.write; a.write;"}
nodes: {n: {executor: e, callbacks: {on_a: {takes: a.read, do: "skip;"}}}}
"""

DYING_START = """
models: {k: {use: mutex}}
executors: {e: {kind: single, may_die: true}}
nodes:
  n: {executor: e, variables: "var set: bool;", start: "set = true; @n k.lock;", callbacks: {}}
  m:
    executor: e
    start: "@m k.unlock;"
    callbacks: {never: {timer: once 1, when: "false", do: "skip;"}}
"""

DYING_THREAD = """
executors: {e: {kind: single, may_die: true}}
nodes: {n: {executor: e, callbacks: {}, threads: {w: "skip;"}}}
"""

CASES = [
    # The server: offer, serve, wait, answer, end; the client: wait, send, receive, wait, end.
    late("a client that waits until its service is there", f"offer s; {SERVES}",
         f"wait s -> there; @asks {CALLS}", [(14, 18)],
         {**RUNS, "asks": "holds", "answered": "holds"},
         asks='"G (client@asks -> s.there)"', answered='"F client@end"'),
    # Three states with the service away and four with the request lost; eleven as above.
    late("a client that does not wait", f"offer s; {SERVES}", CALLS, [(18, 23)],
         {**HANGS, "answered": "violated"}, answered='"F client@end"'),
    late("waiting for a service that is always there", f"loop {{ idle {SERVES} }}",
         f"wait s -> there; {CALLS}", [(16, 22)], RUNS),
    late("a service that is always there", f"loop {{ idle {SERVES} }}",
         f"if (s.there) {{ {CALLS} }}", [(14, 19)], {**RUNS, "there": "holds"},
         there='"G s.there"'),
    late("offered twice", "offer s; offer s; withdraw s; withdraw s;",
         "wait s -> there; wait s -> there;", [(13, 14)], HANGS),
    Case("what was taken can be answered, what waits is lost", TWO_CLIENTS,
         {**HANGS, "one": "holds", "both": "holds"},
         {"one": '"F (a@end || b@end)"', "both": '"G !(a@end && b@end)"'}),
    Case("a request that is withdrawn", LOST_ON_ITS_WAY.format(delivery="at_once"),
         {**HANGS, "none": "holds"}, {"none": '{always: "!s!request"}'}),
    Case("a request that is withdrawn on its way", LOST_ON_ITS_WAY.format(delivery="late"),
         {**HANGS, "none": "holds"}, {"none": '{always: "!s!request"}'}),
    # Away, there, away again; the watcher waits, then reads, and ends up or down.
    Case("who looks whether a service is there", STRANGER,
         {**HANGS, "up": "holds", "down": "holds"},
         {"up": '{possible: "watcher@up"}', "down": '{possible: "watcher@down"}'},
         [(8, 7), (1, 0)]),
    Case("withdrawn and never offered", LATE.format(server="withdraw s;", client="skip;"), None),
    Case("no offer by others", LATE.format(server=SERVES, client="offer s;"), None),
    Case("no offer of a topic", START.format(executor=SINGLE, start="offer a;"), None),
    # Each start: its statement, its end, and what is behind it.
    Case("two starts on one executor, one waits for the other",
         FOR_EACH_OTHER.format(executor="one"), HANGS, {}, [(1, 0)]),
    Case("two starts on two executors", FOR_EACH_OTHER.format(executor="two"), RUNS, {}, [(7, 8)]),
    # Three places of the start beside two of the world; six states behind it.
    Case("a start before a callback", START.format(executor=SINGLE, start=FIRST), IS_READY, READY,
         [(12, 14)]),
    Case("a start before a callback, two threads", START.format(executor=threads(2), start=FIRST),
         IS_READY, READY, [(12, 14)]),
    # The look is one step more; what is found is what was there.
    Case("a start before a callback, rounds", START.format(executor=ROUNDS, start=FIRST),
         IS_READY, READY, [(13, 15)]),
    Case("a start that begins with an error", START.format(
        executor=SINGLE, start="var x: 0..1 = 2; skip;"), {"error": "violated"}, {}, [(1, 0)]),
    # k.lock, the end, k.unlock, the end.
    Case("starts in the file's order, a variable between them", STARTS_IN_ORDER,
         {**RUNS, "c": "holds", "a": "violated"},
         {"c": '"G (c.start@c -> at == 2) && F c@c"', "a": '"G !a@a"'}, [(5, 4)]),
    Case("no answer in start code", ASKS_IN_START.format(executor=SINGLE, code=ASKS), HANGS),
    Case("no answer in start code, four threads",
         ASKS_IN_START.format(executor=threads(4), code=ASKS), HANGS),
    Case("start code that gives up", ASKS_IN_START.format(executor=SINGLE, code=GIVES_UP),
         {**RUNS, "got": "holds", "over": "holds"},
         {"got": '"G !caller@got"', "over": '"F caller.start@gave_up"'}),
    # It starts, locks, unlocks, ends.
    Case("a timer that comes once", ONCE.format(executor=SINGLE), RUNS, {}, [(5, 4)]),
    Case("a timer that comes once, in a reentrant group", ONCE.format(executor=threads(2)), RUNS,
         {}, [(5, 4)]),
    Case("a timer that comes once, rounds", ONCE.format(executor=ROUNDS), RUNS, {}, [(6, 5)]),
    Case("a timer that waits for a variable", WHEN.format(executor=SINGLE, when="set"),
         {**RUNS, "b": "holds"}, {"b": '"F n.set && G (n@b -> n.set)"'}, [(5, 4)]),
    # First b and then a, or a alone.
    Case("a timer that a variable stops", WHEN.format(executor=SINGLE, when="!set"), RUNS, {},
         [(7, 6)]),
    # Looks at a, at b, at both; that at b alone, when a has come, is there for ever.
    Case("a timer that a variable stops, rounds", WHEN.format(executor=ROUNDS, when="!set"), RUNS,
         {}, [(13, 14)]),
    Case("a message is kept until it may be taken",
         KEPT.format(executor=SINGLE, writes="a.write; b.write;"),
         {**RUNS, "taken": "holds", "closed": "holds"}, TAKEN),
    Case("a message is kept until it may be taken, rounds",
         KEPT.format(executor=ROUNDS, writes="a.write; b.write;"),
         {**RUNS, "taken": "holds", "closed": "holds"}, TAKEN),
    Case("a message that may never be taken", KEPT.format(executor=SINGLE, writes="a.write;"),
         {**RUNS, "taken": "violated", "closed": "holds"}, TAKEN, [(2, 1)]),
    # The world writes; looks find the message again and again.
    Case("a message that may never be taken, rounds",
         KEPT.format(executor=ROUNDS, writes="a.write;"),
         {**RUNS, "taken": "violated", "closed": "holds"}, TAKEN, [(3, 3)]),
    Case("a timer that waits for a service", WHEN_THERE, {**RUNS, "got": "holds"},
         {"got": '"F n@got"'}),
    # It starts, asks, waits; the thread starts, locks, unlocks, ends; both end.
    Case("a thread", THREAD.format(count=1, code="run work; join work;"),
         {**RUNS, "works": "holds"}, {"works": '"F n.work@works"'}, [(9, 8)]),
    Case("no copy is free", THREAD.format(count=1, code="run work; run work;"),
         {"error": "violated", "deadlock": "inconclusive"}),
    Case("two copies", THREAD.format(count=2, code="run work; run work; join work;"), RUNS),
    Case("one after the other",
         THREAD.format(count=1, code="run work; join work; run work;"), RUNS),
    # Each copy is asked, before lock, before unlock, before its end, or free; not both lock.
    Case("threads that nobody asks", UNNAMED, {**RUNS, "both": "holds"}, {"both": '"F n.work@in"'},
         [(24, 36)]),
    Case("no thread of this name", THREAD.format(count=1, code="run walk;"), None),
    # A callback that joins a thread that waits for an answer hangs; else it is answered.
    Case("a callback joins a thread that asks",
         ASKING_THREAD.format(executor=SINGLE, code="run work; join work;"), HANGS),
    Case("a callback joins a thread that asks, two threads",
         ASKING_THREAD.format(executor=threads(2), code="run work; join work;"), RUNS),
    Case("a thread that asks", ASKING_THREAD.format(executor=SINGLE, code="run work;"),
         {**RUNS, "asks": "holds"}, {"asks": '"F n.work@asked && G (n@asked -> F lookup!answer)"'}),
    Case("an answer to a thread's run that has ended", THREAD_ENDS, HANGS),
    # The thread alone counts: no steps, and its variable stays.
    Case("a thread's own variable", THREAD_VARIABLES.format(second=" join work; run work;",
         third=""), {**RUNS, "two": "holds"}, {"two": '"F n.count == 2"'}, [(11, 10)]),
    # The callback reads and writes it, too: both cost steps.
    Case("a variable of a thread and a callback",
         THREAD_VARIABLES.format(second="", third=" count = count + 1;"),
         {**RUNS, "two": "holds"}, {"two": '"F n.count == 2"'}, [(11, 10)]),
    Case("nobody knows how it goes on", "programs: {p: '@here unknown;'}",
         {"deadlock": "inconclusive", "here": "inconclusive"}, {"here": '"F p@end"'}, [(1, 1)]),
    # Serve, take; send. Two that die before it was sent, two behind it; the dead one's loses it.
    dies("a server dies", MORTAL("idle s.serve -> request;"), SAFE("s.send;"), [(7, 10)], RUNS),
    # Its death alone changes what the client sees: there, dead, found out; then the client ends.
    dies("a death is found out", MORTAL("idle s.serve -> request;"),
         SAFE("while (s.there) { skip; }"), [(5, 8)],
         {"deadlock": "holds", "stuck": "holds", "comes": "holds", "never": "violated",
          "can": "holds"}, **FOUND_OUT),
    # Nothing but that can happen: no progress, but it comes.
    dies("a death is found out where nothing else happens", MORTAL(TURNS),
         SAFE("select { when (!s.there) { skip; } }"), [(4, 5)],
         {"deadlock": "holds", "stuck": "violated", "comes": "holds", "never": "holds",
          "can": "holds"}, **FOUND_OUT),
    # The same, and nobody asks in a program: the formula does.
    dies("a formula asks whether a server is there", MORTAL(TURNS), SAFE("skip;"), [(3, 4), (1, 0)],
         {**RUNS, "comes": "holds", "stays": "violated"},
         comes='"G (server@end -> F !s.there)"', stays='"G s.there"'),
    dies("nobody asks whether a server is there", MORTAL(TURNS), SAFE("skip;"),
         [(2, 3), (1, 0)], RUNS),
    dies("a server dies, late", MORTAL("s.serve -> request; s.answer; " + TURNS), SAFE(CALLS),
         None, {**HANGS, "lost": "holds", "none": "holds"}, ", delivery: late", **ON_WIRES),
    dies("no server dies, late", SAFE("s.serve -> request; s.answer; " + TURNS), SAFE(CALLS),
         None, {"lost": "violated"}, ", delivery: late", lost=ON_WIRES["lost"]),
    dies("a client dies, late", SAFE("loop { idle s.serve -> request; s.answer; }"),
         MORTAL("s.send; idle s.receive -> answer; " + TURNS), None,
         {**RUNS, "lost": "holds", "none": "holds", "taken": "holds"}, ", delivery: late",
         lost='{possible: "s!request_lost"}', none='"G (client@end -> G !s!answer_arrives)"',
         taken='{possible: "client@end && s!request_arrives"}'),
    # Eleven states and 14 steps of those who live. Of the dead six: before the request, behind it
    # without an answer and with one, waiting and answered, and the end.
    Case("the executor of a server dies", DYING_SERVER.format(
        executor=DIES, client=CALLS, start=""),
         {**HANGS, "answered": "violated"}, {"answered": '"F client@end"'}, [(17, 29)]),
    Case("the executor of a server dies, rounds", DYING_SERVER.format(
        executor=DIES_ROUNDS, client=CALLS, start=""),
         {**HANGS, "answered": "violated"}, {"answered": '"F client@end"'}),
    Case("a server dies before it is there", DYING_SERVER.format(
        executor=DIES, client="wait s -> there; @up skip;", start=', start: "offer s;"'),
         {**HANGS, "up": "holds"}, {"up": '{possible: "client@end"}'}),
    # Fourteen states and 18 steps of those who live; six of the dead, four steps among them.
    Case("the executor of a client dies", DYING_CLIENT, RUNS, {}, [(22, 37)]),
    # Eight states and steps of those who live; the world writes all the same.
    Case("the executor of a reader dies", DYING_READER, {**RUNS, "written": "holds"},
         {"written": '"F world@end"'}, [(11, 18)]),
    # Lock, end, unlock, end; in front of each, and at last, it may die, with the mutex as it is.
    Case("an executor dies in start code", DYING_START,
         {"deadlock": "holds", "m": "violated", "stays": "holds"},
         {"m": '"F m@m"', "stays": '"G n.set"'}, [(7, 9)]),
    # As on one thread.
    Case("an executor of several threads dies", DYING_SERVER.format(
        executor="{kind: multi, threads: 2, may_die: true}", client=CALLS, start=""),
         {**HANGS, "answered": "violated"}, {"answered": '"F client@end"'}, [(17, 29)]),
    # Asked, before the end, over, each before the death; and dead.
    Case("a thread dies with its executor", DYING_THREAD, RUNS, {}, [(4, 5)]),
]  # fmt: skip


if __name__ == "__main__":
    sys.exit(main(CASES))
