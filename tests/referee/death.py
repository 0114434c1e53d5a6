"""The death of an executor of one thread: one step of all that runs on it.

Its nodes stand at their starts for ever, and what they stand at the ends of takes their death as
that of a program. Their variables stay, as those of a program that died.
"""

from __future__ import annotations

from typing import Any

from machine import Control, Program, Step, World, after_death
from nodes import AtExecutor, Executor
from turns import DEAD, ENDED, LOOK, NOBODY, Turn


class Death(AtExecutor):
    """An executor that may die."""

    def __init__(self, system: Any, number: int, executor: Executor) -> None:
        super().__init__(system, number, executor)
        nodes = [node for node in system.nodes if node.executor is executor]
        self.dying = frozenset(n for node in nodes for n in node.numbers())

    def steps(self, control: Control, world: World) -> list[Step]:
        """The death, if the executor lives."""
        turn = world[0][self.executor.use]
        if turn.running == DEAD or turn.spin == ENDED:
            return []
        models_after, cut = after_death(self.system, world, self.dying)
        also = tuple((n, self.system.programs[n].start()) for n in sorted(self.dying))
        found = []
        for models in models_after:
            dead = Turn(DEAD, turn.left, NOBODY)
            if self.executor.main is not None:  # it cannot be told from one that ended
                dead = Turn((), () if turn.left == LOOK else turn.left, ENDED)
            after = Program.with_model((models, world[1]), self.executor.use, dead)
            found.append(Step(self.number, ("dies",), control, after, also=also, death=True))
        if cut:
            found.append(Step(self.number, ("dies",), cut=True, death=True))
        return found
