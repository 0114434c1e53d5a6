"""Mutexes and conditions, which answer for a program as in use.py.

The state of a mutex is (who holds it, how often, the answer of a `trylock` that is due). Anybody
unlocks a plain one, so all programs are one holder of it. A recursive one is held by a thread: an
executor of one thread with all that runs on it, a copy of a callback, a copy of a thread, or a
program.

The state of a condition says of each program that waits whether it was notified. To wait, and to
wake, are steps that change the mutex, too.
"""

from __future__ import annotations

from typing import Any

from expressions import Mistake
from language import Refused
from models import Action

MOST_LOCKS = 8
ANYBODY, DEAD = "anybody", "dead"
FREE = (None, 0, None)


class Mutex:
    """A mutex."""

    models: list = []
    weak = False
    standing: set = set()
    initial = FREE
    inputs = {"lock", "unlock", "trylock"}
    outputs = {"yes", "no"}

    def __init__(self, name: str, threads: list | None) -> None:
        self.name = name
        self.threads = threads  # that of each program, where it is recursive

    def holder(self, program: int) -> Any:
        """What a program is to the mutex."""
        return ANYBODY if self.threads is None else self.threads[program]

    def check_input(self, program: int, name: str) -> None:
        """Refuses an input that it does not have."""
        if name not in self.inputs:
            raise Refused(f"{self.name} has no input {name}")

    def check_output(self, program: int, name: str) -> None:
        """Refuses an output that it does not have."""
        if name not in self.outputs:
            raise Refused(f"{self.name} has no output {name}")

    def event(self, program: int, name: str) -> tuple:
        """The event of an input that a program gives."""
        return (program, self.name, None, "?", (name, ()))

    def is_kept_by(self, state: tuple, program: int) -> bool:
        """Whether a program holds it, and nobody else may unlock it."""
        return self.threads is not None and state[0] == self.threads[program]

    def locked(self, state: tuple, program: int) -> tuple | None:
        """The state after `lock`; None if it waits."""
        who, times, _ = state
        if who is None:
            return (self.holder(program), 1, None)
        if self.threads is None or who != self.holder(program):
            return None
        if times == MOST_LOCKS:
            raise Mistake(f"{self.name} is locked more than {MOST_LOCKS} times")
        return (who, times + 1, None)

    def unlocked(self, state: tuple, program: int) -> tuple | None:
        """The state after `unlock`; None if it waits."""
        who, times, _ = state
        if self.threads is None:
            return None if who is None else FREE
        if who != self.holder(program):
            raise Mistake(f"{self.name} is not held by who unlocks it")
        return FREE if times == 1 else (who, times - 1, None)

    def tried(self, state: tuple, program: int) -> tuple:
        """The state after `trylock`, whose answer is due."""
        after = self.locked(state, program)
        return (*state[:2], "no") if after is None else (*after[:2], "yes")

    def after(self, state: tuple, program: int, action: Action) -> tuple | None:
        """The state after an input; None if it waits, as all do while an answer is due. A mistake
        if it is an error."""
        if state[2] is not None or action[1]:
            return None
        changed = {"lock": self.locked, "unlock": self.unlocked, "trylock": self.tried}
        return changed[action[0]](state, program)

    def mistake(self, state: tuple, program: int, action: Action) -> str | None:
        """Why an input is an error; None if it is none."""
        try:
            self.after(state, program, action)
        except Mistake as mistake:
            return str(mistake)
        return None

    def give(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        """The states after an input that is no error."""
        after = self.after(state, program, action)
        event = (program, self.name, None, "?", action)
        return ([] if after is None else [(after, event)]), False

    def due(self, state: tuple, program: int) -> list:
        """The answer that is due, to whoever takes it."""
        if state[2] is None:
            return []
        action = (state[2], ())
        return [(action, (*state[:2], None), (program, self.name, None, "!", action))]

    def pick(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        """Input and output in one step."""
        return [
            (output, after, (event, other))
            for middle, event in self.give(state, program, action)[0]
            for output, after, other in self.due(middle, program)
        ], False

    def quiet(self, state: tuple, program: int, name: str, is_input: bool) -> bool:
        """Whether no answer is due."""
        return state[2] is None

    def died(self, state: tuple, programs: frozenset[int]) -> tuple[list, bool]:
        """What a dead program holds stays held, also when it begins anew."""
        if self.threads is not None and state[0] in {self.threads[p] for p in programs}:
            state = ((DEAD, state[0]), *state[1:])
        return [state], False

    # --- for a condition

    def given_back(self, state: tuple, program: int) -> tuple | None:
        """The state after one lock was given back; None if that waits, a mistake if there is none
        to give back."""
        if state == FREE:
            raise Mistake(f"{self.name} is not held by who waits")
        return self.after(state, program, ("unlock", ()))

    def taken_again(self, state: tuple, program: int) -> tuple | None:
        """The state after it was taken; None if that waits. What was given back can be taken."""
        return self.after(state, program, ("lock", ()))


class Condition:
    """A condition."""

    models: list = []
    weak = False
    standing: set = set()
    initial: tuple = ()
    inputs = {"wait", "notify_one", "notify_all"}

    def __init__(self, name: str, mutex: Any) -> None:
        self.name = name
        self.mutex = mutex  # its name, and later its number among the models

    def check_input(self, program: int, name: str) -> None:
        """Refuses all that is no statement by itself."""
        raise Refused(f"{self.name}: a condition stands in a statement of its own")

    def check_output(self, program: int, name: str) -> None:
        """Refuses all outputs."""
        raise Refused(f"{self.name} has no output {name}")

    def event(self, program: int, name: str) -> tuple:
        """The event of a program."""
        return (program, self.name, None, "?", (name, ()))

    def with_waiting(self, state: tuple, program: int) -> tuple:
        """The state with one more that waits."""
        return tuple(sorted((*state, (program, False))))

    def without(self, state: tuple, program: int) -> tuple:
        """The state without one that waits."""
        return tuple(one for one in state if one[0] != program)

    def give(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        """The states after somebody, or all, were notified."""
        event = self.event(program, action[0])
        asleep = [who for who, is_notified in state if not is_notified]
        chosen = [asleep] if action[0] == "notify_all" or not asleep else [[one] for one in asleep]
        return [
            (tuple((who, is_notified or who in woken) for who, is_notified in state), event)
            for woken in chosen
        ], False

    def died(self, state: tuple, programs: frozenset[int]) -> tuple[list, bool]:
        """A dead program does not wait."""
        return [tuple(one for one in state if one[0] not in programs)], False

    @staticmethod
    def left_alone(state: tuple) -> tuple:
        """The state after all who use it died for ever: it stays, whoever of them waited."""
        return tuple((DEAD, is_notified) for _, is_notified in state)
