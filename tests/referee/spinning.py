"""Start code and the code of `main:`, which run before the callbacks of an executor have turns, or
give them turns themselves: with `spin`.

While callbacks are spun, the one who spins stands at its statement. It leaves it in a step of its
own or, in the same step, when a callback ends: then the executor's state says so (`moved`), and
`followed` lets it go on.
"""

from __future__ import annotations

import itertools

from control import Node
from machine import Control, Step, World
from nodes import NodeProgram, next_of
from turns import (
    ENDED,
    ERRED,
    LOOK,
    NOBODY,
    USUAL,
    Spin,
    Turn,
    is_answered,
    is_looking,
    is_spun,
    statement_of,
)


class Start(NodeProgram):
    """The start code of a node, or the code of `main:`. It begins with the system, or where the
    code before it in its executor ends."""

    # --- the begin and the end

    def begun(self, world: World) -> tuple[Control, World]:
        is_first = self.number == self.executor.starts[0]
        return self.entered(world) if is_first else (self.start(), world)

    def entered(self, world: World) -> tuple[Control, World]:
        """Where control comes to stand at the begin of the code, and the world there."""
        values = self.values_at(self.first, self.start(), world)
        return self.settled(self.arrive(self.first.arms[0][1], values), world)

    def steps_start(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        return []

    def steps_finish(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        world = self.released(world)
        behind = self.executor.starts[self.executor.starts.index(self.number) + 1 :]
        at_last = ENDED if self.text.kind == "main" else USUAL
        turn = Turn(tuple(behind[:1]), (), NOBODY if behind else at_last)
        world = self.with_model(world, self.executor.use, turn)
        step = Step(self.number, ("end",), self.start(), world)
        if behind:
            after, step.world = self.system.programs[behind[0]].entered(step.world)
            step.also = ((behind[0], after),)
        return [step]

    # --- spinning

    def settled(self, control: Control, world: World) -> tuple[Control, World]:
        """Where control comes to stand; the executor's state says whether it spins there."""
        control, world = super().settled(control, world)
        turn = Turn((self.number,), (), NOBODY)
        if self.spins(control):
            node = self.nodes[control[0]]
            values = self.values_at(node, control, world)
            service = None if node.model is None else self.model(node.model, values.__getitem__)
            left = LOOK if is_looking(node) else ()
            turn = Turn((), left, Spin(self.number, node.number, service, node.limit))
        return control, self.with_model(world, self.executor.use, turn)

    def is_over(self, world: World) -> bool:
        """Whether a callback's step ends its statement."""
        turn = world[0][self.executor.use]
        is_mine = isinstance(turn.spin, Spin) and turn.spin.by == self.number
        return is_mine and turn.spin.moved == "over"

    def followed(self, control: Control, world: World) -> tuple[Control, World]:
        """What follows in the step of a callback: no label of the statement holds any more, or it
        is over."""
        turn = world[0][self.executor.use]
        if turn.spin == ERRED and control[0] != "error":
            return self.start(), world
        if not isinstance(turn.spin, Spin) or turn.spin.by != self.number:
            return control, world
        if turn.spin.moved is None:
            return control, world
        if self.is_over(world):
            node = self.nodes[control[0]]
            values = self.values_at(node, control, world)
            return self.settled(self.arrive(node.next, values), world)
        turn = turn._replace(spin=turn.spin._replace(moved=None))
        return self.unlabelled(control), self.with_model(world, self.executor.use, turn)

    @staticmethod
    def unlabelled(control: Control) -> Control:
        """The same place, when no label holds any more."""
        return (control[0], frozenset(), *control[2:])

    def steps_spin(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        turn = world[0][self.executor.use]
        if turn.running:
            return []
        if is_answered(self.system, turn, world):
            return self.steps_answered(node, values, world)
        if is_looking(node):
            if turn.left == LOOK:
                return self.looks(node, control, values, world)
            if self.is_in_vain(world):
                return [self.nothing_more(node, control, values, world)]
            return []
        found = []
        if node.mode == "once":  # a turn for what no text has
            found.append(self.step(("turn",), node.next, values, world, death=True))
        if node.late is not None:
            found.append(self.step(("timeout",), node.late, values, world))
        return found

    def steps_answered(self, node: Node, values: dict, world: World) -> list[Step]:
        """It takes the answer that was handed over."""
        number = self.model(node.model, values.__getitem__)
        found = []
        for action, after, event in self.system.uses[number].due(world[0][number], self.number):
            if action[0] == "answer":
                world_after = self.with_model(world, number, after)
                label = (number, "!", action)
                found.append(self.step(label, node.next, values, world_after, events=(event,)))
        return found

    def looks(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        """A look, for each set of timers that may be due."""
        turn = world[0][self.executor.use]
        programs = self.system.programs
        there = [
            callback
            for callback in self.executor.callbacks
            if is_spun(self.system, turn, callback)
            and programs[callback.numbers[0]].is_found(world)
        ]
        timers = [callback for callback in there if callback.kind == "timer"]
        found = []
        for due in itertools.product((False, True), repeat=len(timers)):
            is_due = dict(zip(timers, due))
            seen = tuple(c.numbers[0] for c in there if is_due.get(c, True))
            mark = (node.place, tuple(c.numbers[0] for c in timers if is_due[c]))
            label = ("look", seen)
            if not seen:
                found.append(self.step(label, node.next, values, world, arm=mark))
                continue
            after = self.with_model(world, self.executor.use, turn._replace(left=seen))
            found.append(Step(self.number, label, self.unlabelled(control), after, arm=mark))
        return found

    def is_in_vain(self, world: World) -> bool:
        """Whether none of those that were found can start any more."""
        left = world[0][self.executor.use].left
        if self.executor.rounds:
            return next_of(self.system, left, world) is None
        return not any(self.system.programs[number].has_something(world) for number in left)

    def nothing_more(self, node: Node, control: Control, values: dict, world: World) -> Step:
        """None of those that were found has anything more: it is over, or the next look comes."""
        turn = world[0][self.executor.use]
        label = ("nothing more",)
        if node.mode == "some":
            return self.step(label, node.next, values, world)
        after = self.with_model(world, self.executor.use, turn._replace(left=LOOK))
        return Step(self.number, label, self.unlabelled(control), after)

    def spins(self, control: Control) -> bool:
        """Whether it stands at a `spin`."""
        return control[0] != "error" and self.nodes[control[0]].kind == "spin"

    def rests(self, control: Control) -> bool:
        """Where it spins for ever, too, it may stand for ever."""
        is_spinning = self.spins(control)
        return super().rests(control) or is_spinning and self.nodes[control[0]].mode == "forever"
