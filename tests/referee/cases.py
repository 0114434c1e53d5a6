"""Small systems of services and nodes, with the verdicts that they must have.

    cases.py [--maide PROGRAM] [--write FOLDER]

The rows of the table of calls inside of callbacks that were measured on rclcpp, answers of
strangers that push out one's own, updates that are lost, and looks of an executor that are stale.
The referee must give these verdicts, and Maide the same components, counts and verdicts. Exit
status 1: it, or the referee, has another one.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from compare import Comparison, write
from referee import judge


@dataclass
class Case:
    """A system, and its verdicts; None where the file must be refused."""

    name: str
    text: str
    verdicts: dict[str, str] | None
    properties: dict[str, str] = field(default_factory=dict)
    sizes: list[tuple[int, int]] | None = None  # states and transitions of each component

    def file(self) -> str:
        """The system's file."""
        lines = [self.text.strip("\n")]
        if self.properties:
            lines.append("properties:")
            lines += [f"  {name}: {text}" for name, text in self.properties.items()]
        return "\n".join(lines) + "\n"


HANGS, RUNS = {"deadlock": "violated"}, {"deadlock": "holds", "stuck": "holds", "error": "holds"}

ASKS = "lookup.send; @asked wait lookup -> answer;"
GIVES_UP = (
    "lookup.send; select {{ on lookup!answer {{ @{0}_got skip; }} "
    "timeout 100 {{ @{0}_gave_up skip; }} }}"
)


def nested(
    name: str,
    executor: str,
    verdicts: dict | None,
    *,
    caller: str = "own",
    answers: str = "own",
    server: str = "own",
    callers: int = 1,
    code: str = ASKS,
    properties: dict | None = None,
) -> Case:
    """Callbacks that ask and wait, each for one message; groups of the callbacks by their names.

    `server` is the group of the server's callback in the same node, or `program`, or `node` for a
    node of its own on the same executor."""
    kinds = {"shared": "exclusive", "other": "exclusive", "third": "exclusive", "free": "reentrant"}
    go = [f"go{k}" for k in range(callers)]
    writes = " ".join(f"{topic}.write;" for topic in go)
    serves = 'serves: lookup, do: "lookup.answer;"'

    def group(of: str) -> str:
        return "" if of == "own" else f", group: {of}"

    node = "caller" if server not in ("program", "node") else "database"
    lines = ["topics:"]
    lines += [f"  {t}: {{writers: world, readers: caller, use: queue, with: {{depth: 1}}}}"
              for t in go]  # fmt: skip
    lines += ["services:", f"  lookup: {{server: {node}, clients: [caller]}}"]
    lines += ["executors:", f"  main: {executor}", "programs:", f'  world: "{writes}"']
    if server == "program":
        lines.append('  database: "loop { idle lookup.serve -> request; lookup.answer; }"')
    lines += ["nodes:"]
    if server == "node":
        lines += ["  database:", "    executor: main", "    callbacks:"]
        lines.append(f"      answer: {{{serves}}}")
    groups = ", ".join(f"{group}: {kind}" for group, kind in kinds.items())
    lines += ["  caller:", "    executor: main", f"    groups: {{{groups}}}"]
    if answers != "own":
        lines.append(f"    clients: {{lookup: {answers}}}")
    lines.append("    callbacks:")
    for topic in go:
        text = code.format(topic)
        lines.append(f'      on_{topic}: {{takes: {topic}.read, do: "{text}"{group(caller)}}}')
    if server not in ("program", "node"):
        lines.append(f"      answer: {{{serves}{group(server)}}}")
    return Case(name, "\n".join(lines), verdicts, properties or {})


SINGLE, ROUNDS = "{kind: single}", "{kind: single, order: rounds}"


def threads(count: int) -> str:
    """An executor with several threads."""
    return f"{{kind: multi, threads: {count}}}"


FREE = {"caller": "free", "answers": "free"}
CALLS = [
    # SingleThreaded, any groups: never answered.
    nested("single, the node's own group", SINGLE, HANGS),
    nested("single, reentrant", SINGLE, HANGS, **FREE, server="free"),
    nested("single, a group each", SINGLE, HANGS, caller="shared", answers="other", server="third"),
    nested("single, rounds", ROUNDS, HANGS, **FREE, server="free"),
    nested("single, the server is a program", SINGLE, HANGS, server="program"),
    nested("single, the server is a node on it", SINGLE, HANGS, server="node"),
    # MultiThreaded, both in one mutually exclusive group; reentrant with 1 thread: never answered.
    nested("four threads, one exclusive group", threads(4), HANGS, server="program"),
    nested("four threads, one exclusive group with a name", threads(4), HANGS, caller="shared",
           answers="shared", server="program"),
    nested("one thread, reentrant", threads(1), HANGS, **FREE, server="program"),
    # 2 threads, reentrant, two such callbacks at once: both block; when one times out the other
    # gets its answer.
    nested("two threads, two calls at once", threads(2), HANGS, **FREE, callers=2,
           server="program"),
    nested("two threads, two calls at once, with time limits", threads(2), {
        **RUNS, "one_never_gives_up": "violated", "one_gives_up_and_the_other_never_gets_it":
        "violated"}, **FREE, callers=2, server="program", code=GIVES_UP, properties={
        "one_never_gives_up": '"G !caller@go0_gave_up"',
        "one_gives_up_and_the_other_never_gets_it":
        '"G (caller@go0_gave_up -> G !caller@go1_got)"'}),
    # 4 threads reentrant; or the client in a group of its own: answered.
    nested("four threads, reentrant", threads(4), RUNS, **FREE, server="program"),
    nested("four threads, two calls at once", threads(4), RUNS, **FREE, callers=2,
           server="program"),
    nested("three threads, two calls at once", threads(3), RUNS, **FREE, callers=2,
           server="program"),
    nested("two threads, the client in a group of its own", threads(2), RUNS, answers="other",
           server="program"),
    # The server in the caller's own mutually exclusive group, 4 threads: never answered; fine if
    # reentrant or in a third group.
    nested("four threads, the server in the caller's group", threads(4), HANGS, caller="shared",
           answers="other", server="shared"),
    nested("four threads, the server reentrant", threads(4), RUNS, caller="shared",
           answers="other", server="free"),
    nested("four threads, the server in a third group", threads(4), RUNS, caller="shared",
           answers="other", server="third"),
    nested("two threads, three groups", threads(2), RUNS, caller="shared", answers="other",
           server="third"),
    # Spinning inside the callback: throws at once.
    nested("a callback that receives by itself", threads(4), None, server="program",
           code="lookup.send; lookup.receive -> answer;"),
]  # fmt: skip

TIMER = """
services: {{lookup: {{server: database, clients: [caller]}}}}
executors: {{main: {{kind: multi, threads: {0}}}}}
programs: {{database: "loop {{ idle lookup.serve -> request; lookup.answer; }}"}}
nodes:
  caller:
    executor: main
    groups: {{free: reentrant, alone: exclusive}}
    clients: {{lookup: free}}
    callbacks: {{tick: {{timer: 10, group: {1}, do: "{2}"}}}}
"""

STRANGERS = """
services: {{lookup: {{server: database, clients: [planner, monitor], with: {{depth: {depth}}}}}}}
programs:
  database: "loop {{ idle lookup.serve -> request; lookup.answer; }}"
  monitor: "repeat {calls} {{ lookup.send; lookup.receive -> answer; }}"
  planner: "lookup.send; @waits lookup.receive -> answer;"
"""

NODES_STRANGERS = """
topics: {{go: {{writers: [world], readers: [planner], use: queue, with: {{depth: 1}}}}}}
services: {{lookup: {{server: database, clients: [planner, monitor], with: {{depth: {depth}}}}}}}
executors: {{main: {{kind: multi, threads: 2}}}}
programs:
  world: "go.write;"
  monitor: "repeat {calls} {{ lookup.send; lookup.receive -> answer; }}"
nodes:
  database: {{callbacks: {{answer: {{serves: lookup, do: "lookup.answer;"}}}}}}
  planner:
    executor: main
    groups: {{own: exclusive}}
    clients: {{lookup: own}}
    callbacks: {{on_go: {{takes: go.read, do: "lookup.send; @asked wait lookup -> answer;"}}}}
"""

LOST = """
topics:
  a: {{writers: world, readers: n, use: queue, with: {{size: 2}}}}
  b: {{writers: world, readers: n, use: queue, with: {{size: 2}}}}
executors: {{main: {executor}}}
programs: {{world: "{writes}"}}
nodes:
  n:
    executor: main
    groups: {{g: {group}}}
    variables: "var count: 0..2;"
    callbacks:
      on_a: {{takes: a.read, group: g, do: "count = count + 1;"}}
      on_b: {{takes: b.read, group: g, do: "{code}"}}
"""
BOTH = {"both_count": '{ltl: "F (n.count == 2)", fairness: strong}'}
COUNTED, NOT_COUNTED = {**RUNS, "both_count": "holds"}, {**RUNS, "both_count": "violated"}


def lost(name: str, executor: str, group: str, verdicts: dict, same: bool = False) -> Case:
    """Two callbacks, or two copies of one, that count in one variable."""
    writes = "a.write; a.write;" if same else "a.write; b.write;"
    code = "skip;" if same else "count = count + 1;"
    text = LOST.format(executor=executor, group=group, writes=writes, code=code)
    return Case(name, text, verdicts, BOTH)


# The executor looks while both topics hold a message; a second one comes to `a` while the first
# is worked on. By rounds `b` is next, whatever else is there.
STALE = """
models:
  m: {{use: mutex}}
  k: {{use: mutex}}
topics:
  hold: {{writers: world, readers: n, use: queue, with: {{depth: 1}}}}
  held: {{writers: n, readers: world, use: queue, with: {{depth: 1}}}}
  a: {{writers: world, readers: n, use: queue, with: {{depth: 1}}}}
  b: {{writers: world, readers: n, use: queue, with: {{depth: 1}}}}
executors: {{main: {executor}}}
programs:
  world: |
    m.lock; k.lock;
    hold.write; held.read -> message;
    a.write; b.write; m.unlock;
    idle held.read -> message;
    a.write; @again k.unlock;
nodes:
  n:
    executor: main
    callbacks:
      on_hold: {{takes: hold.read, do: "held.write; m.lock; m.unlock;"}}
      on_a: {{takes: a.read, do: "held.write; @works k.lock; k.unlock;"}}
      on_b: {{takes: b.read, do: "skip;"}}
"""
IN_TURN = {"b_before_a_again": '"G (n@works && world@again -> X (!a!message W b!message))"'}


def stale(name: str, executor: str, verdict: str) -> Case:
    """A message that comes behind one that the executor saw."""
    verdicts = {**RUNS, "stuck": "holds", "b_before_a_again": verdict}
    return Case(name, STALE.format(executor=executor), verdicts, IN_TURN)


PASSED_OVER = """
topics:
  go: {{writers: world, readers: n, use: queue, with: {{depth: 1}}}}
services: {{lookup: {{server: database, clients: [n, world], with: {{depth: 1}}}}}}
executors: {{main: {{kind: single, order: rounds}}}}
programs:
  database: "loop {{ idle lookup.serve -> request; lookup.answer; }}"
  world: "go.write; lookup.send; {receive} go.write;"
nodes:
  n:
    executor: main
    callbacks: {{on_go: {{takes: go.read, do: "lookup.send;"}}}}
"""

# The look finds the node's client by the other's answer, before the server writes to `a`. rclcpp
# over both middlewares does what the verdicts say.
FOUND = """
topics:
  go: {{writers: other, readers: n.on_go, use: queue, with: {{depth: 1}}}}
  a: {{writers: server, readers: n.on_a, use: queue, with: {{depth: 1}}}}
services: {{s: {{server: server, clients: [n, other], with: {options}}}}}
executors: {{main: {{kind: single, order: rounds}}}}
programs:
  other: "s.send; s.receive -> answer; go.write;"
  server: "s.serve -> request; s.answer; s.serve -> request; a.write; s.answer;"
nodes:
  n:
    executor: main
    clients: {{s: {{do: "answered = true;"}}}}
    variables: "var came: bool; var answered: bool;"
    callbacks:
      on_go: {{takes: go.read, do: "s.send;"}}
      on_a: {{takes: a.read, do: "came = true;"}}
"""
IN_ORDER = {"order": '{always: "n.answered -> n.came"}'}


def found(options: str, verdict: str) -> Case:
    """A client that is found by an answer to another."""
    name = f"a client found by an answer to another, {options}"
    return Case(name, FOUND.format(options=options), {**RUNS, "order": verdict}, IN_ORDER)


REENTRANT_SERVER = """
services: {lookup: {server: database, clients: [c], with: {depth: 2}}}
executors: {main: {kind: multi, threads: 2}}
programs:
  c[k in 0..1]: "lookup.send; lookup.receive -> answer;"
nodes:
  database:
    executor: main
    groups: {free: reentrant}
    callbacks:
      answer: {serves: lookup, group: free, do: "@works skip; lookup.answer;"}
"""

ARRAYS = """
services:
  lookup[i in 0..1]: {{server: "database[i]", clients: "robot[i]"}}
executors: {{main: {executor}}}
programs:
  database[i in 0..1]: "loop {{ idle lookup[i].serve -> request; lookup[i].answer; }}"
nodes:
  robot[i in 0..1]:
    executor: main
    groups: {{answers: exclusive}}
    clients: {{"lookup[i]": answers}}
    variables: "var done: bool;"
    callbacks:
      tick: {{timer: 5, do: "lookup[i].send; @asks wait lookup[i] -> answer; done = true;"}}
"""
DONE = {"each_is_done": '{ltl: "forall i in 0..1: F robot[i].done", fairness: strong}',
        "one_at_a_time": '"G !(robot[0]@asks && robot[1].tick@asks)"'}  # fmt: skip

STARVED = """
topics: {{t: {{writers: world, readers: n, use: queue, with: {{depth: 1}}}}}}
executors: {{main: {executor}}}
programs: {{world: "loop {{ t.write; }}"}}
nodes:
  n:
    executor: main
    groups: {{other: exclusive}}
    callbacks:
      on_t: {{takes: t.read, do: "skip;"}}
      busy: {{timer: 1, group: other, do: "loop {{ if * {{ skip; }} }}"}}
"""

CASES = CALLS + [
    # As many copies as there are threads may wait at once.
    Case("a reentrant timer that asks, four threads", TIMER.format(4, "free", ASKS), HANGS),
    Case("an exclusive timer that asks, two threads", TIMER.format(2, "alone", ASKS), RUNS),
    Case("a timer that asks in its node's group, the client's is another",
         TIMER.format(2, "alone", "lookup.send; lookup.send; @asked wait lookup -> answer;"), RUNS),
    Case("waiting twice for one request", TIMER.format(
        2, "alone", "lookup.send; wait lookup -> answer; wait lookup -> answer;"), HANGS),
    # Ten strangers' answers push out one's own.
    Case("nine strangers' answers", STRANGERS.format(depth=10, calls=9), RUNS),
    Case("ten strangers' answers", STRANGERS.format(depth=10, calls=10), HANGS),
    Case("ten strangers' answers, depth 11", STRANGERS.format(depth=11, calls=10), RUNS),
    Case("nine strangers' answers at nodes", NODES_STRANGERS.format(depth=10, calls=9), RUNS),
    Case("ten strangers' answers at nodes", NODES_STRANGERS.format(depth=10, calls=10), HANGS),
    # n = n + 1 is two steps where two of them can run at the same time.
    lost("lost update, reentrant", threads(2), "reentrant", NOT_COUNTED),
    lost("lost update, two copies", threads(2), "reentrant", NOT_COUNTED, same=True),
    lost("no lost update, exclusive", threads(2), "exclusive", COUNTED),
    lost("no lost update, one thread", threads(1), "reentrant", COUNTED),
    lost("no lost update, single", SINGLE, "reentrant", COUNTED),
    # A look is worked off before the next one.
    stale("stale look", ROUNDS, "holds"),
    stale("no look", SINGLE, "violated"),
    Case("an answer that was seen and then pushed out", PASSED_OVER.format(
        receive="lookup.receive -> answer;"), HANGS),
    Case("an answer that was seen and then pushed out by one that nobody awaits",
         PASSED_OVER.format(receive=""), RUNS),
    found("{depth: 2, rmw: cyclonedds}", "violated"),
    found("{depth: 2, rmw: fastrtps}", "holds"),
    found("{depth: 1, rmw: fastrtps}", "violated"),
    Case("two robots, one thread", ARRAYS.format(executor=SINGLE),
         {"deadlock": "violated", "each_is_done": "violated", "one_at_a_time": "holds"}, DONE),
    Case("two robots, two threads", ARRAYS.format(executor=threads(2)),
         {"deadlock": "violated", "each_is_done": "violated", "one_at_a_time": "violated"}, DONE),
    Case("two robots, three threads", ARRAYS.format(executor=threads(3)),
         {**RUNS, "each_is_done": "holds", "one_at_a_time": "violated"}, DONE),
    Case("two requests served at once", REENTRANT_SERVER, RUNS),
    Case("a callback that never ends", STARVED.format(executor=SINGLE),
         {"deadlock": "holds", "stuck": "violated"}),
    Case("a callback that never ends, on a thread of its own", STARVED.format(
        executor=threads(2)), RUNS),
]  # fmt: skip


def at_once(document: dict) -> dict:
    """The document with nothing on its way where it does not say so, as the systems were
    measured."""
    for section in ("topics", "services"):
        for entry in (document.get(section) or {}).values():
            entry.setdefault("delivery", "at_once")
    return document


def main(cases: list[Case]) -> int:
    """Decides all cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maide", help="compare with this program, too")
    parser.add_argument("--write", type=Path, help="keep the systems in this folder")
    options = parser.parse_args()
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.write or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for case in cases:
            path = folder / f"{re.sub('[^a-z0-9]+', '-', case.name)}.yaml"
            write(at_once(yaml.safe_load(case.file())), path)
            report = judge(str(path))
            if case.verdicts is None:
                found = [] if "error" in report else ["not refused"]
            elif "properties" not in report:
                found = [str(report)]
            else:
                found = [
                    f"{name} is {report['properties'][name]['verdict']}, not {verdict}"
                    for name, verdict in case.verdicts.items()
                    if report["properties"][name]["verdict"] != verdict
                ]
                sizes = [(c["states"], c["transitions"]) for c in report["components"]]
                if case.sizes not in (None, sizes):
                    found.append(f"states and transitions are {sizes}, not {case.sizes}")
            if options.maide:
                comparison = Comparison(options.maide, 200_000, False, [])
                found += [why for _, why in comparison.differences(path)]
            states = [c["states"] for c in report.get("components", [])]
            print(f"{case.name}: {', '.join(map(str, states)) or 'no'} states"
                  + "".join(f"\n  {why}" for why in found))  # fmt: skip
            wrong += bool(found)
    print(f"{len(cases)} cases, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(CASES))
