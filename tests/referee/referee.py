"""An independent referee of the system language: explores all states, decides all properties.

    referee.py SYSTEM.yaml --json [--max-states N]

Prints {"components": [{"programs", "parts", "states", "transitions"}], "properties": {NAME:
{"verdict", "component"}}}; the parts of a node are `node.callback` and the like. A file that is
refused gives {"error": ...} and exit status 4, one that is too large {"too_large": ...} and exit
status 5.
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

from formulas import Formulas, Letter, instances, parse_formula
from graph import MAX_STATES, Component, Edge, FairRuns, State, TooLarge
from language import Refused
from ltl import Formula, covers, is_true, negated, satisfiable_states, untils
from system import System

sys.setrecursionlimit(100_000)

WORST = ["holds", "inconclusive", "violated"]


class Referee:
    """Decides the properties of one system."""

    def __init__(self, system: System, max_states: int) -> None:
        self.system = system
        self.max_states = max_states
        self.explored: dict[tuple, Component] = {}
        self.components = [self.explore(numbers) for numbers in system.components]

    def explore(self, numbers: list[int]) -> Component:
        """The states of these programs."""
        key = tuple(sorted(numbers))
        if key not in self.explored:
            self.explored[key] = Component(self.system, sorted(numbers), self.max_states)
        return self.explored[key]

    def verdict(self, component: Component, violated: bool) -> str:
        """The verdict on a component, for what rests on all its runs."""
        if violated:
            return "violated"
        weak = self.system.rests_on_hidden_return(component.numbers)
        if component.is_cut or component.can_fail or weak:
            return "inconclusive"
        return "holds"

    def of_each(self, is_violated: Any) -> dict:
        """A property that is decided in each component."""
        verdicts = [self.verdict(c, is_violated(c)) for c in self.components]
        worst = max(range(len(verdicts)), key=lambda n: WORST.index(verdicts[n]))
        return {"verdict": verdicts[worst], "component": worst}

    def has_deadlock(self, component: Component) -> bool:
        """Whether nothing can happen somewhere, and some program neither ended nor rests."""
        for state in component.states:
            if not state.failed and not state.can_move():
                for program, control in zip(component.programs, state.controls):
                    if not program.rests(control):
                        return True
                if any(c.has_something(state.world) for c in component.callbacks):
                    return True
        return False

    def has_stuck(self, component: Component) -> bool:
        """Whether some program never steps again on a strongly fair run."""
        return self.is_any_stuck(component, lambda program, control: False)

    def has_stuck_but_spinning(self, component: Component) -> bool:
        """The same, but for those who spin, whose callbacks may step."""
        return self.is_any_stuck(
            component,
            lambda program, control: hasattr(program, "followed") and program.spins(control),
        )

    @staticmethod
    def is_any_stuck(component: Component, is_left_out: Any) -> bool:
        """Whether some program never steps again, and stands at no place that is left out."""
        edges = [state.edges for state in component.states]
        for at, program in enumerate(component.programs):
            nodes = {
                number
                for number, state in enumerate(component.states)
                if not state.failed
                and program.number not in state.enabled
                and not program.rests(state.controls[at])
                and not is_left_out(program, state.controls[at])
            }
            runs = FairRuns(component.states, edges, frozenset(), "strong", component.numbers)
            going_on = frozenset(
                (number, k)
                for number in nodes
                for k, edge in enumerate(edges[number])
                if program.number in edge.step.carries
            )
            if runs.exists(nodes, going_on):
                return True
        return False

    def is_starving(self, component: Component) -> bool:
        """Whether some callback is never started any more, though there is something for it."""
        return any(self.is_starved(component, callback) for callback in component.callbacks)

    @staticmethod
    def is_starved(component: Component, callback: Any) -> bool:
        """Whether a callback has something again and again, and no copy of it steps any more."""
        copies = set(callback.text.numbers)
        mark = frozenset(["something"])
        edges = []
        for state in component.states:
            marks = mark if callback.has_something(state.world) else frozenset()
            edges.append([Edge(edge.target, edge.step, marks) for edge in state.edges])
        nodes = {
            number
            for number, state in enumerate(component.states)
            if not state.failed and not state.enabled & copies
        }
        runs = FairRuns(component.states, edges, mark, "strong", component.numbers)
        return runs.exists(nodes)

    def stuck(self) -> dict:
        """Whether a program or callback is stuck; `unless_starved`, apart from callbacks that are
        never started, and from who spins them for ever."""
        started = self.of_each(self.has_stuck)
        starving = self.of_each(self.is_starving)
        worst = max(started, starving, key=lambda found: WORST.index(found["verdict"]))
        return {**worst, "unless_starved": self.of_each(self.has_stuck_but_spinning)["verdict"]}

    def error(self) -> dict:
        """Whether a program makes a mistake."""
        verdicts = []
        for component in self.components:
            if component.can_fail:
                verdicts.append("violated")
            else:
                verdicts.append("inconclusive" if component.is_cut else "holds")
        worst = max(range(len(verdicts)), key=lambda n: WORST.index(verdicts[n]))
        return {"verdict": verdicts[worst], "component": worst}

    def own(self, name: str, description: Any) -> dict:
        """A property of the file; each instance of a `forall` is one formula."""
        fairness = "weak"
        always = possible = False
        text = description
        if isinstance(description, dict):
            fairness = description.get("fairness", "weak")
            always = "always" in description
            possible = "possible" in description
            text = description["always" if always else "possible" if possible else "ltl"]
        ranges, body = parse_formula(text, name)
        verdicts = []
        for scope in instances(self.system, ranges):
            formulas = Formulas(self.system, scope)
            formula = formulas.resolve(body)
            if always:
                formula = ("R", ("false",), formula)
            numbers = {
                number
                for members in self.system.components
                if formulas.programs & set(members)
                for number in members
            }
            component = self.explore(sorted(numbers or self.system.components[0]))
            if possible:
                verdicts.append(self.possible(component, formulas.atoms, formula))
                continue
            violated = self.is_violated(component, formulas.atoms, formula, fairness)
            verdicts.append(self.verdict(component, violated))
        return {"verdict": max(verdicts, key=WORST.index, default="holds")}

    def possible(self, component: Component, atoms: list, formula: Formula) -> str:
        """Whether some run comes to a position at which the formula, of one position, is true.

        A position behind a cut, or at an error, is none.
        """
        positions = Positions(self.system, component, atoms)
        known, waiting = {0}, [0]
        while waiting:
            at = waiting.pop()
            if component.states[positions.states[at]].failed:
                continue
            if is_true(formula, positions.letters[at]):
                return "holds"
            for _, target in positions.after(at):
                if target not in known:
                    known.add(target)
                    waiting.append(target)
        return "violated" if self.verdict(component, False) == "holds" else "inconclusive"

    def is_violated(
        self, component: Component, atoms: list, formula: Formula, fairness: str
    ) -> bool:
        """Whether some fair run breaks the formula, or some run has a prefix that is bad."""
        positions = Positions(self.system, component, atoms)
        bad = negated(formula)
        wanted = untils(bad)
        known: dict[tuple, int] = {}
        states: list[State] = []
        edges: list[list[Edge]] = []
        waiting: list[tuple] = []

        def number(node: tuple) -> int:
            if node not in known:
                if len(known) > 20 * self.max_states:
                    raise TooLarge("the product with a formula")
                known[node] = len(known)
                states.append(component.states[positions.states[node[0]]])
                edges.append([])
                waiting.append(node)
            return known[node]

        number((0, frozenset([bad])))
        while waiting:
            node = waiting.pop()
            at, obligations = node
            for cover in covers(obligations):
                if cover.allows(positions.letters[at].__getitem__):
                    marks = wanted - cover.put_off
                    for step, target in positions.after(at):
                        edge = Edge(number((target, cover.next)), step, marks)
                        edges[known[node]].append(edge)
        runs = FairRuns(states, edges, wanted, fairness, component.numbers)
        if runs.exists(set(range(len(states)))):
            return True
        if not component.is_cut and not component.can_fail:
            return False
        return self.has_bad_prefix(positions, formula)

    def has_bad_prefix(self, positions: Positions, formula: Formula) -> bool:
        """Whether some run has a prefix after which the formula cannot hold any more.

        A run is cut before its step into an error.
        """
        good = satisfiable_states(formula)
        start = frozenset([formula])
        first = (0, frozenset([start]) & frozenset(good))
        known, waiting = {first}, [first]
        while waiting:
            at, possible = waiting.pop()
            letter = positions.letters[at].__getitem__
            after = frozenset(
                cover.next
                for obligations in possible
                for cover in covers(obligations)
                if cover.allows(letter) and cover.next in good
            )
            if not after:
                return True
            for _, target in positions.after(at):
                if positions.component.states[positions.states[target]].failed:
                    continue
                if (target, after) not in known:
                    known.add((target, after))
                    waiting.append((target, after))
        return False

    def report(self) -> dict:
        """All that is found out."""
        properties = {
            "deadlock": self.of_each(self.has_deadlock),
            "stuck": self.stuck(),
            "error": self.error(),
        }
        for name, description in self.system.properties.items():
            properties[name] = self.own(name, description)
        return {
            "components": [
                {
                    "programs": sorted({p.name for p in component.programs if p.name}),
                    "parts": sorted({p.part for p in component.programs if p.part}),
                    "states": len(component.states),
                    "transitions": component.transitions,
                }
                for component in self.components
            ],
            "properties": properties,
        }


class Positions:
    """States with the values of a formula's atoms, which also depend on the step that led there."""

    def __init__(self, system: System, component: Component, atoms: list) -> None:
        self.system = system
        self.component = component
        self.atoms = atoms
        self.known: dict[tuple, int] = {}
        self.reached: dict[tuple, int] = {}  # the same by what led there
        self.states: list[int] = []
        self.letters: list[tuple[bool, ...]] = []
        self.successors: dict[int, list] = {}
        self.number(0, ())

    def number(self, state: int, events: tuple) -> int:
        """The position of a state that was reached with these events."""
        found = self.reached.get((state, events))
        if found is not None:
            return found
        letter = Letter(self.system, self.component, self.component.states[state], events)
        values = tuple(letter.holds(atom) for atom in self.atoms)
        if (state, values) not in self.known:
            self.known[(state, values)] = len(self.states)
            self.states.append(state)
            self.letters.append(values)
        self.reached[(state, events)] = self.known[(state, values)]
        return self.known[(state, values)]

    def after(self, position: int) -> list:
        """The steps from a position; the last state of a finished or deadlocked run is repeated."""
        if position not in self.successors:
            number = self.states[position]
            state = self.component.states[number]
            found: list = [
                (edge.step, self.number(edge.target, edge.step.events)) for edge in state.edges
            ]
            if not state.can_move() and not state.failed:
                found.append((None, self.number(number, ())))
            self.successors[position] = found
        return self.successors[position]


def judge(path: str, max_states: int = MAX_STATES, at_once: bool = False) -> dict:
    """The report on a system file; `at_once`: nothing is ever on its way."""
    try:
        return Referee(System(path, at_once), max_states).report()
    except Refused as refused:
        return {"error": str(refused)}
    except TooLarge as large:
        return {"too_large": str(large)}


def main() -> int:
    """Runs the referee."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("system")
    parser.add_argument("--json", action="store_true", help="the only form there is")
    parser.add_argument("--at-once", action="store_true", help="nothing is ever on its way")
    parser.add_argument("--max-states", type=int, default=MAX_STATES)
    options = parser.parse_args()
    report = judge(options.system, options.max_states, options.at_once)
    print(json.dumps(report, indent=None))
    return 4 if "error" in report else 5 if "too_large" in report else 0


if __name__ == "__main__":
    sys.exit(main())
