"""Small systems of mutexes and conditions.

    lock_cases.py [--maide PROGRAM] [--write FOLDER]

As cases.py. States, transitions and verdicts were derived by hand.
"""

from __future__ import annotations

import sys

from cases import HANGS, RUNS, SINGLE, Case, main, threads

FAILS = {"error": "violated"}
MODELS = """
models:
  m: {{use: mutex{recursive}}}
  cv: {{use: condition, with: {{mutex: m}}}}
variables: "var ready: bool;"
programs:
{programs}
"""


def locks(name: str, programs: dict[str, str], verdicts: dict | None, sizes: list | None = None,
          recursive: bool = False, **own: str) -> Case:
    """Programs that share a mutex and a condition."""
    text = MODELS.format(
        recursive=", with: {recursive: true}" if recursive else "",
        programs="\n".join(
            f"  {key}: {code}" if code.startswith("{") else f'  {key}: "{code}"'
            for key, code in programs.items()
        ),
    )
    return Case(name, text, verdicts, own, sizes)


def alone(name: str, code: str, verdicts: dict | None, sizes: list | None = None,
          recursive: bool = False, **own: str) -> Case:
    """One program."""
    return locks(name, {"p": code}, verdicts, sizes, recursive, **own)


TRIES = "switch m.trylock { yes { @in m.unlock; } no { @out skip; } }"
PICKS = "select { on m.trylock { yes { m.unlock; } no { } } }"
WAITS = "m.lock; cv.wait; m.unlock;"
READS = "m.lock; while (!ready) { cv.wait; } m.unlock;"
ONCE = "m.lock; if (!ready) { cv.wait; } m.unlock;"
SETS = "m.lock; ready = true; m.unlock; "
STRONG = '{{ltl: "F {0}", fairness: strong}}'

TURNS = """
models: {{m: {{use: mutex, with: {{recursive: true}}}}}}
executors: {{e: {executor}}}
nodes:
  n:
    executor: e
    groups: {{other: exclusive}}
    variables: "var set: bool;"
    callbacks:
      a: {{timer: once 1, do: "m.lock; set = true;"}}
      b: {{timer: once 1, when: "set", do: "m.unlock;"}}
"""

CALLBACKS = """
models: {{m: {{use: mutex}}, cv: {{use: condition, with: {{mutex: m}}}}}}
executors: {{e: {executor}}}
nodes:
  n:
    executor: e
    groups: {{other: exclusive}}
    variables: "var ready: bool;"
    callbacks:
      a: {{timer: once 1, do: "{waits}"}}
      b: {{timer: once 1, group: other, do: "{sets} cv.notify_all;"}}
"""

THREADS = """
models: {{m: {{use: mutex}}, cv: {{use: condition, with: {{mutex: m}}}}}}
nodes:
  n:
    variables: "var ready: bool;"
    callbacks: {{go: {{timer: once 1, do: "{sets} cv.{notify};"}}}}
    threads: {{work: {{count: 2, do: "{waits}"}}}}
"""

CASES = [
    # With p first: tries, takes, holds; the other tries meanwhile, is refused and comes before a
    # label at its end, or tries behind p's end.
    locks("two try", {"p": TRIES, "q": TRIES}, {**RUNS, "both": "holds", "in": "holds"},
          [(18, 18)], both='"G !(p@out && q@out)"', **{"in": '"G !(p@in && q@in)"'}),
    # Each before, inside or at its end, but not both inside, nor one inside when both began.
    locks("two try in a step", {"p": PICKS, "q": PICKS}, RUNS, [(8, 10)]),
    locks("an answer without an arm", {"p": PICKS.replace(" no { }", ""), "q": PICKS}, FAILS),
    locks("an answer that nobody takes", {"p": "m.trylock; m.unlock;"}, HANGS, [(2, 1)]),
    locks("anybody takes the answer", {"p": "m.trylock;", "q": "wait m -> yes;"},
          {**RUNS, "taken": "holds"}, [(3, 2)], taken='"F q:m!yes"'),
    alone("locked twice", "m.lock; m.lock; m.unlock; m.unlock;", HANGS, [(2, 1)]),
    alone("locked twice, recursive", "m.lock; m.lock; m.unlock; m.unlock;", RUNS, [(5, 4)], True),
    alone("locked eight times", "repeat 8 { m.lock; }", RUNS, [(9, 8)], True),
    alone("locked nine times", "repeat 9 { m.lock; }", FAILS, [(10, 9)], True),
    alone("tried eight times", "repeat 8 { m.trylock -> yes; }", RUNS, [(17, 16)], True),
    alone("tried nine times", "repeat 9 { m.trylock -> yes; }", FAILS, [(18, 17)], True),
    alone("an arm that locks a ninth time",
          "repeat 8 { m.lock; } select { on m.lock { } timeout 5 { } }", FAILS, [(10, 9)], True),
    locks("unlocked by another", {"p": "m.lock;", "q": "m.unlock;"}, RUNS, [(3, 2)]),
    locks("unlocked by another, recursive", {"p": "m.lock;", "q": "m.unlock;"}, FAILS, [(4, 3)],
          True),
    alone("an arm that unlocks what it does not hold",
          "select { on m.unlock { } timeout 5 { } }", FAILS, [(2, 1)], True),
    locks("a recursive one excludes others", {"p": "m.lock; @p m.unlock;",
                                              "q": "m.lock; @q m.unlock;"},
          {**RUNS, "apart": "holds"}, [(8, 8)], True, apart='"G !(p@p && q@q)"'),
    # While the answer is due, to be taken by p, nobody unlocks, rightly or not.
    locks("tried while another holds it", {"p": "m.lock; m.lock; m.unlock; m.unlock;",
                                           "q": "switch m.trylock { yes { m.unlock; } no { } }"},
          RUNS, None, True),
    # Start, lock, end of each.
    Case("one thread holds it in two callbacks", TURNS.format(executor=SINGLE), RUNS, {},
         [(7, 6)]),
    # It is not known which thread runs the second one.
    Case("one of two threads holds it behind a callback", TURNS.format(executor=threads(2)),
         dict.fromkeys(RUNS, "inconclusive")),
    Case("two callbacks of two groups", TURNS.format(executor=threads(2)).replace(
        "b: {timer: once 1", "b: {timer: once 1, group: other"), FAILS),
    locks("a dead program holds it", {"p": '{do: "m.lock; m.unlock;", may_die: true}',
                                      "q": "m.lock; m.unlock;"}, HANGS),
    # Lock, wait, wake by itself, unlock.
    alone("nobody wakes it", WAITS, {**HANGS, "stuck": "holds", "can": "holds", "does": "violated"},
          [(5, 4)], can='{possible: "p@end"}', does='{ltl: "F p@end", fairness: strong}'),
    alone("nobody wakes it, and it rests", WAITS.replace("cv", "idle cv"), RUNS, [(5, 4)]),
    locks("late, it does not rest", {"p": "m.lock; idle cv.wait timeout 5 { } m.unlock;",
                                     "q": "m.lock;"}, HANGS),
    alone("what happens at a condition", "m.lock; @before cv.wait; @behind m.unlock;",
          {"back": "holds", "again": "holds", "both": "violated"}, None,
          back='"G (p:m.unlock -> p:cv.wait || p@end)"', again='"G (p@behind -> p:m.lock)"',
          both='"G !(cv.wait && m.unlock)"'),
    locks("nobody wakes it, and another goes on", {"p": WAITS, "q": "loop { m.lock; m.unlock; }"},
          {"deadlock": "holds", "stuck": "violated"}),
    alone("it waits and holds nothing", "cv.wait;", FAILS, [(2, 1)]),
    alone("it waits and holds nothing, recursive", "cv.wait;", FAILS, [(2, 1)], True),
    locks("it waits, and another holds the mutex", {"p": "m.lock;", "q": "cv.wait;"},
          FAILS, None, True),
    alone("nobody waits", "cv.notify_one; cv.notify_all;", RUNS, [(3, 2)]),
    # Waiting: it wakes by itself, or is late, takes the mutex, and stands before a label.
    alone("a time-out", "m.lock; cv.wait timeout 5 { @late skip; } m.unlock;",
          {**RUNS, "late": "holds", "not": "holds"}, [(7, 7)],
          late='{possible: "p@late"}', **{"not": '{possible: "p@end"}'}),
    # It is not the mutex' last lock that is given back, and it is taken again; but not by others.
    alone("one of two locks is given back",
          "m.lock; m.lock; cv.wait timeout 5 { } m.unlock; m.unlock;", RUNS, [(8, 8)], True),
    locks("a lock is kept by who waits", {"p": "m.lock; m.lock; cv.wait; m.unlock; m.unlock;",
                                          "q": "m.lock; cv.notify_one; m.unlock;"}, HANGS, None,
          True),
    locks("a notification is lost", {"p": WAITS, "q": "cv.notify_one;"}, HANGS),
    locks("it looks before it waits", {"p": READS, "q": SETS + "cv.notify_one;"},
          {**RUNS, "got": "holds", "waits": "holds"}, None,
          got=STRONG.format("p@end"), waits='{possible: "p:cv.wait && !ready"}'),
    locks("it looks, recursive", {"p": READS, "q": SETS + "cv.notify_one;"},
          {**RUNS, "got": "holds"}, None, True, got=STRONG.format("p@end")),
    locks("nobody notifies it", {"p": READS, "q": SETS}, {**HANGS, "got": "violated"}, None,
          got=STRONG.format("p@end")),
    locks("one of two is notified", {"p": READS, "q": READS, "r": SETS + "cv.notify_one;"},
          {**HANGS, "one": "holds"}, None, one=STRONG.format("(p@end || q@end)")),
    locks("both are notified", {"p": READS, "q": READS, "r": SETS + "cv.notify_all;"},
          {**RUNS, "both": "holds"}, None, both=STRONG.format("(p@end && q@end)")),
    # p holds the mutex until q has ended, so what wakes p waits.
    locks("a wake-up waits for the mutex",
          {"p": WAITS, "q": "m.lock; cv.notify_all; @in m.unlock;"},
          {**HANGS, "in": "holds"}, None, **{"in": '"G (q@in -> X (q@in || q@end))"'}),
    # Lock, wait, wake, unlock; with each but the last it may die, and leaves all as it is.
    alone("the dead do not wait", f'{{do: "{WAITS}", may_die: true}}', HANGS, [(7, 8)]),
    # Waking by itself again and again, p keeps q from the mutex on runs that are weakly fair.
    locks("it wakes by itself again and again", {"p": READS, "q": SETS + "cv.notify_one;"},
          {"weak": "violated", "strong": "holds"}, None,
          weak='"F q@end"', strong=STRONG.format("q@end")),
    Case("a callback waits on the only thread",
         CALLBACKS.format(executor=SINGLE, waits=ONCE, sets=SETS), HANGS),
    Case("a callback waits on one of two threads",
         CALLBACKS.format(executor=threads(2), waits=ONCE, sets=SETS), RUNS),
    Case("a thread waits", THREADS.format(waits=READS, sets=SETS, notify="notify_all"), RUNS),
    Case("one of two threads is notified, and the other rests", THREADS.format(
        waits=READS.replace("cv", "idle cv"), sets=SETS, notify="notify_one"), RUNS),
    Case("no callback rests at a condition", CALLBACKS.format(
        executor=SINGLE, waits=ONCE.replace("cv", "idle cv"), sets=SETS), None),
    Case("one of two threads is notified",
         THREADS.format(waits=READS, sets=SETS, notify="notify_one"), HANGS),
    alone("no condition in a select", "select { on cv.notify_one { } }", None),
    alone("no outcomes of a condition", "switch cv.wait { quiet { } }", None),
    Case("a condition of no mutex", MODELS.replace("mutex: m", "mutex: k").format(
        recursive="", programs='  p: "skip;"'), None),
]  # fmt: skip


if __name__ == "__main__":
    sys.exit(main(CASES))
