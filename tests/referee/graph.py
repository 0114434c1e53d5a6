"""Graphs of states, and whether they have a run that is fair.

An edge has the number of the state it leads to, and what fairness looks at: which program steps,
which arm and which fair choice it is, and which acceptance sets it is in. A message that arrives is
a step of its wire, which is named ("wire", connection, number) where programs have numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from machine import Program, Step, is_error

MAX_STATES = 200_000


class TooLarge(Exception):
    """The system has more states than the referee was told to look at."""


@dataclass
class Edge:
    """A step from one state to another."""

    target: int
    step: Step | None = None  # None: the last state is repeated
    marks: frozenset = frozenset()


@dataclass
class State:
    """A state: the control of all programs, in their order, and the world."""

    controls: tuple
    world: tuple
    edges: list[Edge] = field(default_factory=list)
    cuts: list[Step] = field(default_factory=list)
    failed: bool = False
    enabled: set[int] = field(default_factory=set)
    arms: set[tuple] = field(default_factory=set)
    choices: dict[tuple, set] = field(default_factory=dict)

    def can_move(self) -> bool:
        """Whether anything but a death can happen."""
        return bool(self.enabled)


class Component:
    """All reachable states of some programs of a system."""

    def __init__(self, system: Any, numbers: list[int], max_states: int) -> None:
        self.programs: list[Program] = [system.programs[n] for n in numbers]
        self.numbers = numbers
        self.callbacks = [p for p in self.programs if p.first_of_callback]
        self.states: list[State] = []
        self.transitions = 0
        self.known: dict[tuple, int] = {}
        self.max_states = max_states
        models = tuple(use.initial for use in system.uses)
        world = (models, tuple(variable.initial for variable in system.shared))
        controls = []
        for program in self.programs:
            control, world = program.begun(world)
            controls.append(control)
        self.number(tuple(controls), world)
        self.on_wires = [
            (k, use)
            for k, use in enumerate(system.uses)
            if hasattr(use, "arrivals") and any(k in system.models_of[n] for n in numbers)
        ]
        self.services = [
            (k, use)
            for k, use in enumerate(system.uses)
            if hasattr(use, "gone") and any(k in system.models_of[n] for n in numbers)
        ]
        self.processes = [
            process
            for process in system.processes
            if process.is_mortal and any(process.use in system.models_of[n] for n in numbers)
        ]
        self.spinners = [at for at, one in enumerate(self.programs) if hasattr(one, "followed")]
        self.streams = [(k, use) for k, use in enumerate(system.uses) if hasattr(use, "noted")]
        self.calls = any(use.acknowledges(n) for _, use in self.on_wires for n in numbers)
        at = 0
        while at < len(self.states):
            self.explore(self.states[at])
            at += 1
        self.is_cut = any(state.cuts for state in self.states)
        self.can_fail = any(state.failed for state in self.states)

    def number(self, controls: tuple, world: tuple) -> int:
        """The number of a state."""
        key = (controls, world)
        if key not in self.known:
            if len(self.states) >= self.max_states:
                raise TooLarge(f"more than {self.max_states} states")
            self.known[key] = len(self.states)
            self.states.append(State(controls, world))
        return self.known[key]

    def explore(self, state: State) -> None:
        """Finds the steps of a state."""
        if any(map(is_error, state.controls)):
            state.failed = True
            return
        seen = set()
        for at, step in self.steps(state):
            if not step.death:
                state.enabled.add(step.program)
            if step.arm is not None:
                state.arms.add((step.program, step.arm))
            if step.choice is not None:
                key = (step.program, step.choice[0])
                state.choices.setdefault(key, set()).add(step.choice[1])
            if step.cut:
                mark = (step.program, step.label, "cut")
                if mark not in seen:
                    state.cuts.append(step)
            else:
                controls = state.controls
                if at is not None:
                    controls = controls[:at] + (step.control,) + controls[at + 1 :]
                for other, control in step.also:
                    place = self.numbers.index(other)
                    controls = controls[:place] + (control,) + controls[place + 1 :]
                step.carries = self.carried(step.world)
                is_arrival = isinstance(step.program, tuple) and step.program[0] == "wire"
                target = self.number(*self.followed(controls, step.world, is_arrival))
                mark = (step.program, step.label, target)
                if mark not in seen:
                    state.edges.append(Edge(target, step))
            self.transitions += mark not in seen
            seen.add(mark)

    def steps(self, state: State) -> Iterator[tuple[int | None, Step]]:
        """All steps, with the place of the program that moves; None: a message arrives, a process
        dies or begins anew, or the death of a server is found out."""
        for at, program in enumerate(self.programs):
            for step in program.steps(state.controls[at], state.world):
                if step.death_of is None:
                    yield at, step
                    continue
                process = step.death_of[0]
                for one in process.in_step(self.numbers, state.controls, at, step):
                    yield at, one
        for process in self.processes:
            for step in process.steps(self.numbers, state.controls, state.world):
                yield None, step
        models, shared = state.world
        for k, use in self.services:
            after = use.gone(models[k])
            if after is not None:
                world = (models[:k] + (after,) + models[k + 1 :], shared)
                yield None, Step(("gone", k), ("gone",), None, world)
        for k, use in self.on_wires:
            for one in use.arrivals(models[k]):
                wire = ("wire", k, one.wire)
                if any(not s.is_next(models[n], (k, one.wire)) for n, s in self.streams):
                    continue
                label = (one.action, one.is_loss)
                if one.after is None:
                    yield None, Step(wire, label, cut=True)
                    continue
                world = (models[:k] + (one.after,) + models[k + 1 :], shared)
                yield None, Step(wire, label, None, world, (one.event,), death=one.is_loss)

    def carried(self, world: tuple) -> tuple:
        """Those who spin, and leave their statements in the step that led here."""
        return tuple(
            self.programs[at].number for at in self.spinners if self.programs[at].is_over(world)
        )

    def followed(self, controls: tuple, world: tuple, is_arrival: bool) -> tuple[tuple, tuple]:
        """What follows in the same step: streams note what was sent, and with what arrives or is
        lost calls end. Who spins goes on where a callback ended. Services forget what makes no
        difference any more."""
        for n, stream in self.streams:
            world = (stream.noted(n, world[0]), world[1])
        for k, use in self.services:
            world = Program.with_model(world, k, use.tidied(world[0][k]))
        if self.spinners:
            after = list(controls)
            for at in self.spinners:
                after[at], world = self.programs[at].followed(after[at], world)
            controls = tuple(after)
        if self.calls and is_arrival:
            ended = []
            for program, control in zip(self.programs, controls):
                control, world = program.called(control, world)
                ended.append(control)
            controls = tuple(ended)
        return controls, world


def components_of(nodes: set[int], edges: Callable[[int], list[int]]) -> list[list[int]]:
    """Strongly connected components (Tarjan, without recursion)."""
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    on_stack: set[int] = set()
    found = []
    for root in nodes:
        if root in index:
            continue
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        work = [(root, iter(edges(root)))]
        while work:
            node, rest = work[-1]
            for after in rest:
                if after not in nodes:
                    continue
                if after not in index:
                    index[after] = low[after] = len(index)
                    stack.append(after)
                    on_stack.add(after)
                    work.append((after, iter(edges(after))))
                    break
                if after in on_stack:
                    low[node] = min(low[node], index[after])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    members = []
                    while True:
                        members.append(stack.pop())
                        on_stack.discard(members[-1])
                        if members[-1] == node:
                            break
                    found.append(members)
    return found


class FairRuns:
    """Whether a graph has an infinite run that is fair and accepted.

    `states[n]` says what is enabled in node n; `edges[n]` are its edges; every accepted run
    has edges with each of `marks` again and again.
    """

    def __init__(
        self,
        states: list[State],
        edges: list[list[Edge]],
        marks: frozenset,
        fairness: str,
        programs: list[int],
    ) -> None:
        self.states = states
        self.edges = edges
        self.marks = marks
        self.fairness = fairness
        self.programs = programs

    def exists(self, nodes: set[int], banned: frozenset = frozenset()) -> bool:
        """Whether there is such a run inside of these nodes, without the banned edges."""

        def inside(node: int) -> list[int]:
            return [
                edge.target
                for k, edge in enumerate(self.edges[node])
                if edge.target in nodes and (node, k) not in banned
            ]

        for members in components_of(nodes, inside):
            part = set(members)
            inner = [
                (node, k, edge)
                for node in members
                for k, edge in enumerate(self.edges[node])
                if edge.target in part and (node, k) not in banned
            ]
            if inner and self.is_fair(part, inner, banned):
                return True
        return False

    def is_fair(self, part: set[int], inner: list[tuple], banned: frozenset) -> bool:
        """Whether a strongly connected part has a fair and accepted run."""
        seen_marks: set = set()
        for _, _, edge in inner:
            seen_marks |= edge.marks
        if not self.marks <= seen_marks:
            return False
        steps = [edge.step for _, _, edge in inner if edge.step is not None]
        stepping = {step.program for step in steps if not step.death}
        if self.fairness in ("weak", "strong"):
            for program in self.programs:
                always = all(program in self.states[node].enabled for node in part)
                if always and program not in stepping:
                    return False
            held_up = {
                node
                for node in part
                if any(isinstance(who, tuple) for who in self.states[node].enabled - stepping)
            }
            if held_up:  # wires, and news of a death, are strongly fair on every fair run
                return self.exists(part - held_up, banned)
            too_many = self.unfair_choices(inner)
            if too_many:
                return self.exists(part, banned | too_many)
        if self.fairness == "strong":
            taken = {(step.program, step.arm) for step in steps if step.arm is not None}
            bad = {
                node
                for node in part
                if self.states[node].enabled - stepping or self.states[node].arms - taken
            }
            if bad:
                return self.exists(part - bad, banned)
        return True

    def unfair_choices(self, inner: list[tuple]) -> frozenset:
        """The edges of fair choices of which an outcome, possible there, never comes."""
        outcomes: dict[tuple, set] = {}
        for _, _, edge in inner:
            if edge.step is not None and edge.step.choice is not None:
                place, outcome = edge.step.choice
                outcomes.setdefault((edge.step.program, place), set()).add(outcome)
        found = set()
        for node, k, edge in inner:
            if edge.step is not None and edge.step.choice is not None:
                key = (edge.step.program, edge.step.choice[0])
                if self.states[node].choices[key] - outcomes[key]:
                    found.add((node, k))
        return frozenset(found)
