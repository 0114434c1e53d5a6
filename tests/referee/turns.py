"""What runs on an executor, and what is left of the last look: the executor's state.

Where start code or the code of `main:` stands in a `spin`, the callbacks have turns as that
statement says. The functions here say how a turn begins and ends; the steps are in nodes.py, and
those of the one who spins in spinning.py.
"""

from __future__ import annotations

from typing import Any, NamedTuple

# What runs on an executor that died, for ever.
DEAD = ("dead",)

# Who gives the callbacks their turns: the endless loop; nobody, while code runs and when it ended.
USUAL, NOBODY, ENDED = "usual", "nobody", "ended"
ERRED = "erred"  # an error of a callback, which keeps nothing of the one who spins

# In place of what is left of a look, where a look comes next.
LOOK = "look"


class Spin(NamedTuple):
    """A `spin` at which somebody stands."""

    by: int  # the program
    node: int
    service: int | None = None  # until its answer
    more: int | None = None  # how many callbacks may still run, where that makes a difference
    moved: str | None = None  # within a step: "on", or "over", and then it leaves the statement


class Turn(NamedTuple):
    """The state of an executor."""

    running: tuple
    left: Any  # a tuple of callbacks, LOOK, or how far a look is
    spin: Any

    def moved(self, how: str = "on") -> Turn:
        """The same after a step of those who are spun."""
        is_spun = isinstance(self.spin, Spin)
        return self._replace(spin=self.spin._replace(moved=how)) if is_spun else self

    def over(self) -> Turn:
        """The same when the statement is over, which forgets what was found."""
        return self._replace(left=()).moved("over")


def statement_of(system: Any, turn: Turn) -> Any:
    """The `spin` at which somebody stands; None if nobody does."""
    if not isinstance(turn.spin, Spin):
        return None
    return system.programs[turn.spin.by].nodes[turn.spin.node]


def is_spun(system: Any, turn: Turn, text: Any) -> bool:
    """Whether callbacks have turns, and this one is among them: start code spins its own node."""
    if turn.spin == USUAL:
        return True
    if not isinstance(turn.spin, Spin):
        return False
    spinner = system.programs[turn.spin.by].text
    return spinner.kind == "main" or spinner.node is text.node


def is_answered(system: Any, turn: Turn, world: tuple) -> bool:
    """Whether the answer for which somebody spins was handed over."""
    if not isinstance(turn.spin, Spin) or turn.spin.service is None:
        return False
    number = turn.spin.service
    due = system.uses[number].due(world[0][number], turn.spin.by)
    return any(action[0] == "answer" for action, _, _ in due)


def is_looking(statement: Any) -> bool:
    """Whether only what a look of this statement found may start."""
    return statement is not None and statement.mode in ("some", "all")


def with_one_more(system: Any, turn: Turn, number: int, left: tuple) -> Turn:
    """The state after a callback got a thread."""
    statement = statement_of(system, turn)
    turn = turn._replace(running=tuple(sorted((*turn.running, number))), left=left)
    if statement is None:
        return turn
    if turn.spin.more is not None:
        turn = turn._replace(spin=turn.spin._replace(more=turn.spin.more - 1))
    if turn.spin.more == 0:
        turn = turn._replace(left=())  # it is over behind this one
    return counted(statement, turn).moved()


def counted(statement: Any, turn: Turn) -> Turn:
    """The same without the count where it is over behind this one anyway."""
    is_last = statement.mode == "some" and not turn.left
    return turn._replace(spin=turn.spin._replace(more=None)) if is_last else turn


def with_one_less(system: Any, turn: Turn, number: int) -> Turn:
    """The state after a callback ended."""
    turn = turn._replace(running=tuple(n for n in turn.running if n != number))
    statement = statement_of(system, turn)
    if statement is None:
        return turn
    if statement.mode == "once":
        return turn.over()
    if turn.spin.more == 0:
        return turn.over()
    return passed(statement, turn.moved())


def passed(statement: Any, turn: Turn) -> Turn:
    """The state after one of those that were found ran, or was passed over."""
    if not is_looking(statement):
        return turn
    if turn.left:
        return turn
    return turn.over() if statement.mode == "some" else turn._replace(left=LOOK)
