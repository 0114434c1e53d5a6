"""The death of an executor of one thread: one step of all that runs on it.

Its nodes stand at their starts for ever, and what they stand at the ends of takes their death as
that of a program. Their variables stay, as those of a program that died.
"""

from __future__ import annotations

from typing import Any

from machine import Control, Program, Step, World, after_death
from nodes import DEAD, Executor


class Death:
    """An executor that may die, as a program."""

    first_of_callback = False
    part = None
    name = None

    def __init__(self, system: Any, number: int, executor: Executor) -> None:
        self.system = system
        self.number = number
        self.executor = executor
        nodes = [node for node in system.nodes if node.executor is executor]
        self.dying = frozenset(n for node in nodes for n in node.numbers())
        self.timers = [c.come for node in nodes for c in node.callbacks if c.come is not None]

    def start(self) -> Control:
        """It is always at the same place."""
        return ("awaits",)

    def begun(self, world: World) -> tuple[Control, World]:
        """The control state at first, and the world."""
        return self.start(), world

    def called(self, control: Control, world: World) -> tuple[Control, World]:
        """It makes no calls."""
        return control, world

    def rests(self, control: Control) -> bool:
        """It need not die."""
        return True

    def steps(self, control: Control, world: World) -> list[Step]:
        """The death, if the executor lives."""
        if world[0][self.executor.use][0] == DEAD[0]:
            return []
        shared = list(world[1])
        for come in self.timers:
            pass
        models_after, cut = after_death(self.system, world, self.dying)
        also = tuple((n, self.system.programs[n].start()) for n in sorted(self.dying))
        found = []
        for models in models_after:
            after = Program.with_model((models, tuple(shared)), self.executor.use, (DEAD[0], world[0][self.executor.use][1]))
            found.append(Step(self.number, ("dies",), control, after, also=also, death=True))
        if cut:
            found.append(Step(self.number, ("dies",), cut=True, death=True))
        return found
