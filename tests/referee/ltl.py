"""Linear temporal logic: formulas in negation normal form, and how they are unfolded step by step.

A formula is ("atom", n), ("not", n), ("true",), ("false",), ("and", a, b), ("or", a, b), ("X", a),
("U", a, b) or ("R", a, b). A state of its automaton is the set of formulas that must hold from here
on. A cover is one way in which they can: literals for now, formulas for the next position, and the
untils that it puts off. A run is accepted if no until is put off for ever.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from graph import components_of

Formula = tuple
TRUE, FALSE = ("true",), ("false",)


def negated(formula: Formula) -> Formula:
    """The negation, in negation normal form."""
    kind = formula[0]
    if kind == "true":
        return FALSE
    if kind == "false":
        return TRUE
    if kind == "atom":
        return ("not", formula[1])
    if kind == "not":
        return ("atom", formula[1])
    if kind == "X":
        return ("X", negated(formula[1]))
    dual = {"and": "or", "or": "and", "U": "R", "R": "U"}[kind]
    return (dual, negated(formula[1]), negated(formula[2]))


def is_true(formula: Formula, letter: tuple[bool, ...]) -> bool:
    """Whether a formula without temporal operators is true where the atoms have these values."""
    kind = formula[0]
    if kind in ("true", "false"):
        return kind == "true"
    if kind in ("atom", "not"):
        return letter[formula[1]] == (kind == "atom")
    parts = [is_true(part, letter) for part in formula[1:]]
    return all(parts) if kind == "and" else any(parts)


@dataclass(frozen=True)
class Cover:
    """One way in which formulas can hold: true and false atoms, what follows, what is put off."""

    true: frozenset
    false: frozenset
    next: frozenset
    put_off: frozenset

    def allows(self, letter: Callable[[int], bool]) -> bool:
        """Whether the atoms have these values."""
        return all(letter(n) for n in self.true) and not any(letter(n) for n in self.false)


@lru_cache(maxsize=None)
def covers(obligations: frozenset) -> tuple[Cover, ...]:
    """All ways in which these formulas can hold."""
    found: dict[Cover, None] = {}

    def unfold(todo: list, done: frozenset, cover: Cover) -> None:
        if not todo:
            found[cover] = None
            return
        formula, rest = todo[-1], todo[:-1]
        if formula in done:
            unfold(rest, done, cover)
            return
        done = done | {formula}
        kind = formula[0]
        true, false, after, put_off = cover.true, cover.false, cover.next, cover.put_off
        if kind == "true":
            unfold(rest, done, cover)
        elif kind == "atom":
            if formula[1] not in false:
                unfold(rest, done, Cover(true | {formula[1]}, false, after, put_off))
        elif kind == "not":
            if formula[1] not in true:
                unfold(rest, done, Cover(true, false | {formula[1]}, after, put_off))
        elif kind == "and":
            unfold(rest + [formula[1], formula[2]], done, cover)
        elif kind == "or":
            unfold(rest + [formula[1]], done, cover)
            unfold(rest + [formula[2]], done, cover)
        elif kind == "X":
            unfold(rest, done, Cover(true, false, after | {formula[1]}, put_off))
        elif kind == "U":
            unfold(rest + [formula[2]], done, cover)
            later = Cover(true, false, after | {formula}, put_off | {formula})
            unfold(rest + [formula[1]], done, later)
        elif kind == "R":
            unfold(rest + [formula[1], formula[2]], done, cover)
            unfold(rest + [formula[2]], done, Cover(true, false, after | {formula}, put_off))

    unfold(list(obligations), frozenset(), Cover(*[frozenset()] * 4))
    return tuple(found)


def untils(formula: Formula) -> frozenset:
    """All untils in a formula."""
    found = {formula} if formula[0] == "U" else set()
    for part in formula[1:]:
        if isinstance(part, tuple):
            found |= untils(part)
    return frozenset(found)


def satisfiable_states(formula: Formula) -> set[frozenset]:
    """The states of the formula's automaton from which some run is accepted."""
    start = frozenset([formula])
    states, waiting = {start}, [start]
    while waiting:
        for cover in covers(waiting.pop()):
            if cover.next not in states:
                states.add(cover.next)
                waiting.append(cover.next)
    numbered = list(states)
    number = {state: n for n, state in enumerate(numbered)}
    after = [[number[c.next] for c in covers(state)] for state in numbered]
    wanted = untils(formula)
    good: set[int] = set()
    for members in components_of(set(range(len(numbered))), lambda n: after[n]):
        part = set(members)
        fulfilled: set = set()
        has_edge = False
        for n in members:
            for cover in covers(numbered[n]):
                if number[cover.next] in part:
                    has_edge = True
                    fulfilled |= wanted - cover.put_off
        if has_edge and wanted <= fulfilled:
            good |= part
    grows = True
    while grows:
        grows = False
        for n, targets in enumerate(after):
            if n not in good and any(t in good for t in targets):
                good.add(n)
                grows = True
    return {numbered[n] for n in good}
