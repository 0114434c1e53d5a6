"""Small systems in which messages are on their way, with the verdicts that they must have.

    on_the_way.py [--maide PROGRAM] [--write FOLDER]

Each system is decided with everything at once, with wires, and with wires whose writers keep ten.
Some look as if a wire could be left out where it cannot, others look as if one were needed. With
--maide, that program must give the same verdicts. Exit status 1: it, or the referee, has another.
"""

from __future__ import annotations

import argparse
import copy
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import yaml

from compare import Comparison, words_of, write
from referee import judge

H, V = "holds", "violated"
COLUMNS = ["at_once", "late", "ten"]


@dataclass
class Case:
    """A system; of each property the verdicts, one for each column or the same for all.

    None: the file is refused."""

    name: str
    text: str
    verdicts: dict[str, str | tuple[str, ...]] | None

    def file(self, column: str) -> dict:
        """The system's document in one column."""
        document = copy.deepcopy(yaml.safe_load(self.text))
        for section in ("topics", "services"):
            for entry in (document.get(section) or {}).values():
                if column == "at_once":
                    entry["delivery"] = "at_once"
                elif column == "ten" and section == "topics":
                    entry.setdefault("with", {})["pub-depth"] = 10
        return document

    def expected(self, column: str) -> dict[str, str]:
        """The verdicts in one column."""
        at = COLUMNS.index(column)
        return {k: v if isinstance(v, str) else v[at] for k, v in (self.verdicts or {}).items()}


CASES = [
    Case("a notice overtakes the map", """
topics:
  map: {writers: server, readers: robot, use: queue, with: {depth: 1}}
  note: {writers: server, readers: robot, use: queue, with: {depth: 1}}
programs:
  server: "map.write; note.write;"
  robot: "note.read -> message; switch map.tryread { message { } null { @misses skip; } }"
properties: {there: "G !robot@misses"}
""", {"there": (H, V, V), "deadlock": H}),
    Case("an answer overtakes the map", """
topics: {map: {writers: server, readers: robot, use: queue, with: {depth: 10}}}
services: {set: {server: server, clients: [robot]}}
programs:
  server: "loop { idle set.serve -> request; map.write; set.answer; }"
  robot: |
    set.send; set.receive -> answer;
    select { on map.read -> message { } otherwise { @misses skip; } }
properties: {there: "G !robot@misses"}
""", {"there": (H, V, V), "deadlock": H}),
    Case("the server waits until the map has arrived", """
topics: {map: {writers: server, readers: robot, use: queue, with: {depth: 10}}}
services: {set: {server: server, clients: [robot]}}
programs:
  server: "loop { idle set.serve -> request; map.write; wait map -> arrived; set.answer; }"
  robot: |
    set.send; set.receive -> answer;
    select { on map.read -> message { } otherwise { @misses skip; } }
properties: {there: "G !robot@misses"}
""", {"there": H, "deadlock": H, "stuck": H}),
    Case("one stream for the map and the notice", """
topics:
  map: {writers: server, readers: robot, use: queue, with: {depth: 1}, stream: tcp}
  note: {writers: server, readers: robot, use: queue, with: {depth: 1}, stream: tcp}
programs:
  server: "map.write; note.write;"
  robot: "note.read -> message; switch map.tryread { message { } null { @misses skip; } }"
properties: {there: "G !robot@misses"}
""", {"there": H, "deadlock": H}),
    Case("a stream does not bind two writers", """
topics:
  map: {writers: server, readers: robot, use: queue, with: {depth: 1}, stream: tcp}
  go: {writers: server, readers: other, use: queue, with: {depth: 1}, stream: tcp}
  note: {writers: other, readers: robot, use: queue, with: {depth: 1}, stream: tcp}
programs:
  server: "map.write; go.write;"
  other: "go.read -> message; note.write;"
  robot: "note.read -> message; switch map.tryread { message { } null { @misses skip; } }"
properties: {there: "G !robot@misses"}
""", {"there": (H, V, V), "deadlock": H}),
    Case("nothing is there unless three are late", """
topics:
  data: {writers: source, readers: sink, use: queue, with: {depth: 3}}
  go: {writers: source, readers: sink, use: queue, with: {depth: 1}}
programs:
  source: "repeat 3 { data.write; } go.write;"
  sink: "go.read -> message; switch data.tryread { message { } null { @misses skip; } }"
properties: {there: "G !sink@misses"}
""", {"there": (H, V, V)}),
    Case("a queue that runs over only if writes come early", """
topics:
  data: {writers: source, readers: sink, use: queue, with: {depth: 1}}
  go: {writers: source, readers: sink, use: queue, with: {depth: 1}}
programs:
  source: "data.write; data.write; go.write;"
  sink: "go.read -> message; data.read -> message; data.read -> message; @both skip;"
properties: {one: "G !sink@both"}
""", {"deadlock": V, "one": (H, V, V)}),
    Case("nothing is there, and then both", """
topics:
  data: {writers: source, readers: sink, use: queue, with: {depth: 1}}
  go: {writers: source, readers: sink, use: queue, with: {depth: 2}}
programs:
  source: "repeat 2 { data.write; go.write; }"
  sink: |
    go.read -> message; go.read -> message;
    switch data.tryread { message { stop; } null { } }
    data.read -> message; data.read -> message; @two skip;
properties: {never: "G !sink@two"}
""", {"never": (H, V, V), "deadlock": (H, V, V)}),
    Case("values of two writers change places", """
topics:
  data: {writers: [first, second], readers: sink, use: queue, with: {depth: 2}}
  go: {writers: first, readers: second, use: queue, with: {depth: 1}}
programs:
  first: "data.write(1); go.write;"
  second: "go.read -> message; data.write(2);"
  sink: "var x: 0..2; data.read -> message(x); if (x == 2) { @wrong skip; }"
properties: {in_order: "G !sink@wrong"}
""", {"in_order": (H, V, V)}),
    Case("a writer that dies with a message on its way", """
topics:
  data: {writers: source, readers: sink, use: queue, with: {depth: 1}}
  go: {writers: source, readers: sink, use: queue, with: {depth: 1}}
programs:
  source: {do: "data.write; go.write;", may_die: true}
  sink: "idle go.read -> message; switch data.tryread { message { } null { @misses skip; } }"
properties:
  there: "G !sink@misses"
  it_comes: "G (source.data.write -> F data!arrives)"
""".replace("source.data", "source:data"), {"there": (H, V, V), "it_comes": V}),
    Case("a reader that polls does not hold up its writer", """
topics: {data: {writers: source, readers: sink, use: queue, with: {depth: 1}}}
programs:
  source: "data.write;"
  sink: "loop { switch data.tryread { message { } null { } } }"
properties: {weak: "F source@end", strong: {ltl: "F source@end", fairness: strong}}
""", {"weak": (V, H, H), "strong": H, "deadlock": H, "stuck": H}),
    Case("two readers, each with something late", """
topics:
  a: {writers: source, readers: [left, right], use: queue, with: {depth: 2}}
  b: {writers: right, readers: left, use: queue, with: {depth: 2}}
programs:
  source: "a.write;"
  left: |
    a.read -> message;
    switch b.tryread { message { loop { idle b.read -> message; } } null { } }
  right: |
    b.write;
    switch a.tryread { message { loop { idle a.read -> message; } } null { } }
properties: {one_waits: {always: "!(left@end && right@end)"}}
""", {"one_waits": (H, V, V)}),
    Case("the same with one who hears of it", """
topics:
  a: {writers: source, readers: [left, right], use: queue, with: {depth: 2}}
  b: {writers: right, readers: left, use: queue, with: {depth: 2}}
  c: {writers: [left, right], readers: judge, use: queue, with: {depth: 2}}
programs:
  source: "a.write;"
  left: "a.read -> message; switch b.tryread { message { } null { c.write; } }"
  right: "b.write; switch a.tryread { message { } null { c.write; } }"
  judge: "repeat 2 { idle c.read -> message; }"
properties: {not_both: "G !judge@end"}
""", {"not_both": (H, V, V), "deadlock": H}),
    Case("two writers are seen in two orders", """
topics:
  a1: {writers: p, readers: left, use: queue, with: {depth: 1}}
  a2: {writers: p, readers: right, use: queue, with: {depth: 1}}
  b1: {writers: q, readers: right, use: queue, with: {depth: 1}}
  b2: {writers: q, readers: left, use: queue, with: {depth: 1}}
programs:
  p: "a1.write; a2.write;"
  q: "b1.write; b2.write;"
  left: |
    b2.read -> message;
    switch a1.tryread { message { } null { @none skip; skip; loop { idle a1.read -> message; } } }
  right: |
    a2.read -> message;
    switch b1.tryread { message { } null { @none skip; skip; loop { idle b1.read -> message; } } }
properties:
  both: {always: "!(left@none && right@none)"}
  one: "G !left@none"
""", {"both": (H, V, V), "one": V}),
    Case("the writer has ended and the reader finds nothing", """
topics: {data: {writers: source, readers: sink, use: queue, with: {depth: 2}}}
programs:
  source: "data.write;"
  sink: "@looks switch data.tryread { message { @got idle data.read -> message; } null { } }"
properties:
  there: {always: "!(source@end && data!null)"}
  then: "G ((source@end && sink@looks) -> F sink@got)"
""", {"there": (H, V, V), "then": (H, V, V)}),
    Case("a wire adds no room", """
topics: {data: {writers: [a, b], readers: sink, use: queue, with: {size: 1}, delivery: late}}
models: {m: {use: mutex}}
programs:
  a: "m.lock; m.unlock; data.write;"
  b: "data.write;"
  sink: "m.lock; m.unlock; if (1 == 2) { data.read -> message; }"
properties: {one: {always: "!(a@end && b@end)"}}
""", {"one": H, "deadlock": V}),
    Case("the writer keeps less than the reader", """
topics: {data: {writers: source, readers: sink, use: queue, with: {depth: 2, pub-depth: 1}}}
programs:
  source: "data.write; data.write;"
  sink: "data.read -> message; data.read -> message;"
properties: {both: "F sink@end", lost: "G !data!lost"}
""", {"both": (H, V, H), "deadlock": (H, V, H), "lost": (H, V, H)}),
    Case("an older one arrives or is lost, the newest arrives", """
topics: {data: {writers: source, readers: sink, use: queue, with: {depth: 10, pub-depth: 1}, delivery: late}}
programs:
  source: "data.write(1); data.write(2); data.write(3);"
  sink: "var x: 0..3; loop { data.read -> message(x); if (x == 3) { stop; } @old skip; }"
properties:
  newest: "F sink@end"
  only_newest: "G !sink@old"
  not_the_first: "G !data!arrives(1)"
""", {"newest": H, "only_newest": V, "not_the_first": (H, V, V), "deadlock": H}),
    Case("eleven are one too many for a wire", """
topics: {data: {writers: source, readers: sink, use: queue, with: {depth: 11, pub-depth: 1}}}
programs:
  source: "data.write(1); repeat 10 { data.write(0); }"
  sink: "var x: 0..1; loop { idle data.read -> message(x); if (x == 1) { stop; } }"
properties: {first: "F sink@end", lost: "G !data!lost -> F sink@end"}
""", {"first": (H, V, V), "lost": (H, V, V)}),
    Case("what loses does so again and again, but not for ever", """
topics:
  data: {writers: source, readers: sink, use: queue, with: {depth: 1}, loses: true}
programs:
  source: "loop { data.write; }"
  sink: "loop { data.read -> message; @got skip; }"
properties:
  again: "G F sink@got"
  unfair: {ltl: "G F sink@got", fairness: none}
  none: "G !data!lost"
""", {"again": H, "unfair": V, "none": (H, V, V), "stuck": H}),
    Case("what loses may lose the only message", """
topics: {data: {writers: source, readers: sink, use: queue, with: {depth: 1}, loses: true}}
programs: {source: "data.write;", sink: "data.read -> message;"}
properties: {got: "F sink@end"}
""", {"got": (H, V, V), "deadlock": (H, V, V)}),
    Case("a call that all readers acknowledge", """
topics: {data: {writers: source, readers: [left, right], use: queue, with: {depth: 1},
  delivery: acknowledged}}
programs:
  source: "data.write;"
  left: "switch data.tryread { message { } null { loop { idle data.read -> message; } } }"
  right: "switch data.tryread { message { } null { loop { idle data.read -> message; } } }"
properties:
  all_have_it: {always: "!(source@end && data!null)"}
  together: "G !(data[left]!message && F (data[right]!null))"
""", {"all_have_it": H, "together": (H, V, V), "deadlock": H}),
    Case("no arm on what several readers acknowledge", """
topics: {data: {writers: source, readers: [left, right], use: queue, with: {depth: 1},
  delivery: acknowledged}}
programs:
  source: "select { on data.write { } }"
  left: "data.read -> message;"
  right: "data.read -> message;"
""", None),
    Case("requests of one client in order, of two in any", """
services: {lookup: {server: server, clients: [first, second]}}
topics: {go: {writers: first, readers: second, use: queue, with: {depth: 1}}}
programs:
  server: "loop { idle lookup.serve -> request; lookup.answer; }"
  first: "lookup.send; go.write; lookup.receive -> answer;"
  second: "go.read -> message; lookup.send; @asked lookup.receive -> answer;"
properties:
  in_turn: "G (lookup[second]!request_arrives -> F lookup[first]!request_arrives)"
  answered: "F second@end && F first@end"
""", {"in_turn": (H, V, V), "answered": H, "deadlock": H, "stuck": H}),
    Case("an answer reaches one client and not yet another", """
services: {lookup: {server: server, clients: [first, second]}}
programs:
  server: "loop { idle lookup.serve -> request; lookup.answer; }"
  first: "lookup.send; lookup.receive -> answer;"
  second: "lookup.send; lookup.receive -> answer;"
properties:
  both: "G (lookup[first]!answer_arrives -> X lookup[second]!answer_arrives)"
  arrives: "F lookup[first]!answer_arrives"
""", {"both": (H, V, V), "arrives": (V, H, H), "deadlock": H}),
    Case("a look finds the answer and not the map", """
topics:
  go: {writers: user, readers: robot.on_go, use: queue, with: {depth: 1}, delivery: late}
  map: {writers: server, readers: robot.on_map, use: queue, with: {depth: 1}, delivery: late}
services: {lookup: {server: server, clients: [robot], delivery: late}}
executors: {main: {kind: single, order: rounds}}
programs:
  user: "go.write;"
  server: "lookup.serve -> request; map.write; lookup.answer;"
nodes:
  robot:
    executor: main
    variables: "var has: bool; var answered: bool;"
    clients: {lookup: {do: "answered = true;"}}
    callbacks:
      on_go: {takes: go.read, do: "lookup.send;"}
      on_map: {takes: map.read, do: "has = true;"}
properties:
  order: {always: "robot.answered -> robot.has"}
  both: "F (robot.answered && robot.has)"
""", {"order": (H, V, V), "both": H, "deadlock": H, "stuck": H}),
    Case("a service of one executor's nodes hands over at once", """
topics:
  go: {writers: user, readers: robot.on_go, use: queue, with: {depth: 1}}
services: {lookup: {server: map, clients: [robot]}}
executors: {main: {kind: multi, threads: 2}}
programs: {user: "go.write;"}
nodes:
  robot:
    executor: main
    groups: {own: exclusive}
    clients: {lookup: own}
    callbacks: {on_go: {takes: go.read, do: "lookup.send; @asked wait lookup -> answer;"}}
  map: {executor: main, callbacks: {find: {serves: lookup, do: "lookup.answer;"}}}
properties: {never: "G !lookup!request_arrives && G !lookup!answer_arrives"}
""", {"never": H, "deadlock": H, "stuck": H}),
    Case("nodes of two executors, and of one process", """
topics: {go: {writers: user, readers: robot.on_go, use: queue, with: {depth: 1}}}
services: {lookup: {server: map, clients: [robot]}}
executors: {one: {kind: single}, two: {kind: single}}
programs: {user: "go.write;"}
nodes:
  robot:
    executor: one
    clients: {lookup: {do: "@got skip;"}}
    callbacks: {on_go: {takes: go.read, do: "lookup.send;"}}
  map: {executor: two, callbacks: {find: {serves: lookup, do: "lookup.answer;"}}}
properties: {never: "G !lookup!request_arrives", got: "F robot@got"}
""", {"never": (H, V, V), "got": H, "deadlock": H}),
    Case("the same in one process", """
topics: {go: {writers: user, readers: robot.on_go, use: queue, with: {depth: 1}}}
services: {lookup: {server: map, clients: [robot]}}
executors: {one: {kind: single, process: robot}, two: {kind: single, process: robot}}
programs: {user: "go.write;"}
nodes:
  robot:
    executor: one
    clients: {lookup: {do: "@got skip;"}}
    callbacks: {on_go: {takes: go.read, do: "lookup.send;"}}
  map: {executor: two, callbacks: {find: {serves: lookup, do: "lookup.answer;"}}}
properties: {never: "G !lookup!request_arrives", got: "F robot@got"}
""", {"never": H, "got": H, "deadlock": H}),
    Case("a service of a node and of a program in one process", """
services: {lookup: {server: map, clients: [user, other]}}
executors: {one: {kind: single, process: robot}}
programs:
  user: {do: "lookup.send; lookup.receive -> answer;", process: robot}
  other: "skip;"
nodes: {map: {executor: one, callbacks: {find: {serves: lookup, do: "lookup.answer;"}}}}
properties: {never: "G !lookup!request_arrives", answer: "G !lookup[user]!answer_arrives",
  others: "G !lookup[other]!answer_arrives"}
""", {"never": H, "answer": H, "others": (H, V, V), "deadlock": H}),
    Case("a service of programs in one process", """
services: {lookup: {server: map, clients: [user]}}
programs:
  user: {do: "lookup.send; lookup.receive -> answer;", process: robot}
  map: {do: "lookup.serve -> request; lookup.answer;", process: robot}
properties: {never: "G !lookup!request_arrives"}
""", {"never": (H, V, V), "deadlock": H}),
    Case("each write to one reader that has room", """
topics: {data: {writers: source, readers: [left, right], use: queue, with: {size: 1}, deliver: one, delivery: late}}
programs:
  source: "data.write; data.write; @third data.write;"
  left: "skip;"
  right: "skip;"
properties:
  two: "F source@third"
  not_three: "G !source@end"
  both: "F data[left]!arrives || F data[right]!arrives"
""", {"two": H, "not_three": H, "both": (V, H, H), "deadlock": V}),
    Case("a write waits while ten are on a wire that loses nothing", """
topics:
  data: {writers: source, readers: sink, use: queue, with: {depth: 12, pub-history: keep_all}}
  done: {writers: source, readers: sink, use: queue, with: {depth: 1}, delivery: at_once}
programs:
  source: "repeat 11 { data.write; } done.write;"
  sink: |
    done.read -> message;
    switch data.tryread { message { } null { @none stop; } }
properties: {some: "G !sink@none", lost: "G !data!lost"}
""", {"some": H, "lost": H, "deadlock": H}),
    Case("a reader's own depth is not what its writer keeps", """
topics:
  data: {writers: source, readers: sink, use: queue, with: {depth: 3}, readers_with:
    {sink: {depth: 1}}}
programs:
  source: "data.write; data.write; data.write;"
  sink: "skip;"
properties: {lost: "G !data!lost"}
""", {"lost": H}),
    Case("a reader that dies frees its writer", """
topics:
  data: {writers: source, readers: [left, right], use: queue, with: {size: 1}, delivery: late}
programs:
  source: "data.write; data.write; wait data -> arrived;"
  left: {do: "data.read -> message; data.read -> message;", may_die: true}
  right: "data.read -> message; idle data.read -> message;"
properties: {sent: "F source@end"}
""", {"sent": H, "deadlock": H}),
    Case("one stream for the map and the answer", """
topics: {map: {writers: server, readers: robot, use: queue, with: {depth: 10}, stream: tcp}}
services: {set: {server: server, clients: [robot], stream: tcp}}
programs:
  server: "loop { idle set.serve -> request; map.write; set.answer; }"
  robot: |
    set.send; set.receive -> answer;
    select { on map.read -> message { } otherwise { @misses skip; } }
properties: {there: "G !robot@misses"}
""", {"there": H, "deadlock": H}),
    Case("an answer that all clients acknowledge", """
topics: {note: {writers: server, readers: second, use: queue, with: {depth: 1}}}
services: {ask: {server: server, clients: [first, second], delivery: acknowledged}}
programs:
  server: "ask.serve -> request; ask.answer; note.write;"
  first: "ask.send; ask.receive -> answer;"
  second: |
    note.read -> message;
    select { on ask.receive -> answer { @own skip; } otherwise { @none skip; } }
properties: {none: "F second@none", told: "F first@end"}
""", {"none": H, "told": H, "deadlock": H}),
    Case("no arm on an answer that several clients acknowledge", """
services: {ask: {server: server, clients: [first, second], delivery: acknowledged}}
programs:
  server: "ask.serve -> request; select { on ask.answer { } }"
  first: "ask.send; ask.receive -> answer;"
  second: "skip;"
""", None),
    Case("readers that die end the call", """
topics: {data: {writers: source, readers: [left, right], use: queue, with: {size: 1},
  delivery: acknowledged}}
programs:
  source: "data.write; data.write;"
  left: {do: "idle data.read -> message;", may_die: true}
  right: {do: "loop { idle data.read -> message; }", may_die: true}
properties: {sent: "F (left@end && right@end) -> F source@end"}
""", {"sent": H}),
    Case("a look over Fast DDS misses what came before", """
topics: {map: {writers: server, readers: robot.on_map, use: queue, with: {depth: 1}}}
services: {ask: {server: server, clients: [robot], with: {depth: 2, rmw: fastrtps}}}
programs: {server: "ask.serve -> request; map.write; wait map -> arrived; ask.answer;"}
executors: {main: {kind: single, order: rounds}}
nodes:
  robot:
    executor: main
    variables: "var came: bool; var asked: bool;"
    clients: {ask: {do: "if (!came) { @blind skip; }"}}
    callbacks:
      start: {timer: 1, do: "if (!asked) { asked = true; ask.send; }"}
      on_map: {takes: "map.read -> message", do: "came = true;"}
properties: {there: "G !robot@blind"}
""", {"there": (H, V, V), "deadlock": H, "stuck": H}),
    Case("a look over Cyclone DDS finds what came before", """
topics: {map: {writers: server, readers: robot.on_map, use: queue, with: {depth: 1}}}
services: {ask: {server: server, clients: [robot], with: {depth: 2, rmw: cyclonedds}}}
programs: {server: "ask.serve -> request; map.write; wait map -> arrived; ask.answer;"}
executors: {main: {kind: single, order: rounds}}
nodes:
  robot:
    executor: main
    variables: "var came: bool; var asked: bool;"
    clients: {ask: {do: "if (!came) { @blind skip; }"}}
    callbacks:
      start: {timer: 1, do: "if (!asked) { asked = true; ask.send; }"}
      on_map: {takes: "map.read -> message", do: "came = true;"}
properties: {there: "G !robot@blind"}
""", {"there": H, "deadlock": H, "stuck": H}),
    Case("requests that push each other off", """
services: {ask: {server: server, clients: [client], with: {depth: 1}}}
programs:
  server: "loop { idle ask.serve -> request; ask.answer; }"
  client: "ask.send; ask.send; ask.receive -> answer; ask.receive -> answer;"
properties: {both: "F client@end"}
""", {"both": (V, V, V), "deadlock": V}),
]  # fmt: skip


def main() -> int:
    """Decides all cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maide", help="compare with this program, too")
    parser.add_argument("--without", nargs="*", default=[], help="words that it does not know")
    parser.add_argument("--write", type=Path, help="keep the systems in this folder")
    options = parser.parse_args()
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.write or Path(scratch)
        for case in CASES:
            states = []
            for column in COLUMNS:
                own = folder / f"wires-{re.sub('[^a-z0-9]+', '-', case.name)}-{column}"
                own.mkdir(parents=True, exist_ok=True)
                write(case.file(column), own / "system.yaml")
                report = judge(str(own / "system.yaml"))
                states.append("+".join(str(c["states"]) for c in report.get("components", [])))
                found = []
                if case.verdicts is None:
                    found += [] if "error" in report or column == "at_once" else ["not refused"]
                elif "properties" not in report:
                    found.append(str(report))
                else:
                    found += [
                        f"{name} is {report['properties'][name]['verdict']}, not {verdict}"
                        for name, verdict in case.expected(column).items()
                        if report["properties"][name]["verdict"] != verdict
                    ]
                path = own / "system.yaml"
                if options.maide and not words_of(path) & set(options.without):
                    comparison = Comparison(options.maide, 200_000, False, [])
                    found += [why for _, why in comparison.differences(path)]
                for why in found:
                    print(f"{case.name}, {column}: {why}")
                wrong += bool(found)
            print(f"{case.name}: {', '.join(states)} states")
    print(f"{len(CASES)} cases, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
