"""What a program may do with a model or a topic, and what becomes of it.

Both answer, for a program by its number:

    give(state, program, action)    -> ([(next state, event)], cut): cut if it was never tried; a
                                       tuple of those by whom, where it is given to one of several
    due(state, program)             -> [(action, next state, event)], what the program may take
    pick(state, program, action)    -> ([(action, next state, events)], cut), input and output in
                                       one step, for an arm of a select
    quiet(state, program, name, is_input)
                                    whether nothing is due where this input or output belongs

An event is (program, name, readers or None, "?" or "!", action). A model takes no input while an
output is due.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from typing import Any

from language import Refused
from models import Action, Model, State


def taken(model: Model, state: State, action: Action, policy: str) -> tuple[list[State], bool]:
    """The states after an input, and whether the run is cut there."""
    if model.outputs(state):
        return [], False
    if model.unexplored(state, action):
        return ([state] if policy == "drop" else []), policy == "stop"
    return model.steps(state, action), False


@dataclass(frozen=True)
class End:
    """An end whose program may die: what belongs to it, and `disconnect` if the model has it."""

    program: int  # of a node the first
    inputs: frozenset
    outputs: frozenset
    disconnect: str | None


def end_of(model: Model, program: int, actor: str, number: int, count: int, others: set) -> End:
    """The end at this place (from 0) of those that this actor has."""

    def at_place(name: str) -> bool:
        ending = [k for k in range(1, count) if name.endswith(str(k + 1))]
        return (ending or [0])[0] == number

    name = "disconnect" if number == 0 else f"disconnect{number + 1}"
    owner = model.actor(name) if name in model.input_names else None
    has_it = owner is not None and owner not in others
    actors = {actor, owner} if has_it else {actor}
    inputs = {n for n in model.input_names if model.actor(n) in actors and at_place(n)}
    outputs = {n for n in model.output_names if model.actor(n) in actors and at_place(n)}
    return End(program, frozenset(inputs), frozenset(outputs), name if has_it else None)


# What a model still owes to an end that is dead.
NOTHING, THROWS_AWAY, DISCONNECTS = 0, 1, 2
ARRIVED = ("arrived", ())  # an output of a connection: all that was sent has arrived
LOST = "lost"  # a model that was disconnected where that was never tried


def left(model: Model, state: State, marks: tuple, ends: list[End], policy: str) -> list[tuple]:
    """(state, marks) after what is due to dead ends was thrown away, and `disconnect` was taken."""
    if state == LOST:
        return [(state, marks)]
    found: list[tuple] = []
    for (name, _), after in model.outputs(state):
        if any(mark and name in end.outputs for mark, end in zip(marks, ends)):
            found += left(model, after, marks, ends, policy)
    if found:
        return list(dict.fromkeys(found))
    for i, end in enumerate(ends):
        if marks[i] != DISCONNECTS or model.outputs(state):
            continue
        after_it = marks[:i] + (THROWS_AWAY,) + marks[i + 1 :]
        if model.unexplored(state, (end.disconnect, ())):
            if policy == "wait":
                continue
            if policy == "stop":
                return [(LOST, (NOTHING,) * len(ends))]
            return left(model, state, after_it, ends, policy)
        for after in model.steps(state, (end.disconnect, ())):
            found += left(model, after, after_it, ends, policy)
        if found:
            return list(dict.fromkeys(found))
    kept = tuple(
        NOTHING
        if mark == THROWS_AWAY and not model.reaches(state, set(end.outputs), set(end.inputs))
        else mark
        for mark, end in zip(marks, ends)
    )
    return [(state, kept)]


class Instance:
    """A model that stands in a system by itself; `ends` says which program has which end.

    The state is (the model's state, what it owes to each end that may die)."""

    def __init__(
        self, name: str, model: Model, policy: str, ends: dict[int, dict], mortal: list[End]
    ) -> None:
        self.name = name
        self.model = model
        self.policy = policy
        self.mortal = mortal
        self.initial = (model.initial, (NOTHING,) * len(mortal))
        self.ends = ends
        self.standing = set(ends)

    def check_input(self, program: int, name: str) -> None:
        """Refuses an input that the model does not have."""
        if self.renamed(program, (name, ()))[0] not in self.model.input_names:
            raise Refused(f"{self.name} has no input {name}")

    def check_output(self, program: int, name: str) -> None:
        """Refuses an output that the model does not have."""
        given = self.renamed(program, (name, ()))[0]
        if name != "arrived" and given not in self.model.output_names:
            raise Refused(f"{self.name} has no output {name}")

    def renamed(self, program: int, action: Action) -> Action:
        """The action's name in the model, for what the program calls it."""
        renaming = self.ends.get(program, {})
        return (renaming.get(action[0], action[0]), action[1])

    def called(self, program: int, action: Action) -> Action | None:
        """What the program calls an action of the model; None if it is at another end."""
        for short, name in self.ends.get(program, {}).items():
            if name == action[0]:
                return (short, action[1])
        if action[0] in self.ends.get(program, {}):
            return None
        return action

    def event(self, program: int, sign: str, action: Action) -> tuple:
        """The event of this program with this model."""
        return (program, self.name, None, sign, self.renamed(program, action))

    def left(self, state: State, marks: tuple) -> list[tuple]:
        """The states after what is due to dead ends was thrown away."""
        return left(self.model, state, marks, self.mortal, self.policy)

    def give(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        inner, marks = state
        if inner == LOST:
            return [], True
        given = self.renamed(program, action)
        dropped = self.model.unexplored(inner, given)
        after, cut = taken(self.model, inner, given, self.policy)
        if not dropped:
            marks = tuple(
                NOTHING if mark == THROWS_AWAY and given[0] in end.inputs else mark
                for mark, end in zip(marks, self.mortal)
            )
        event = self.event(program, "?", action)
        found = [(state, event) for one in after for state in self.left(one, marks)]
        return list(dict.fromkeys(found)), cut

    def due(self, state: tuple, program: int) -> list:
        found = self.outputs_due(state, program)
        if "arrived" not in self.model.output_names:
            found.append((ARRIVED, state, self.event(program, "!", ARRIVED)))
        return found

    def outputs_due(self, state: tuple, program: int) -> list:
        """What the program may take of the model."""
        inner, marks = state
        if inner == LOST:
            return []
        found = []
        for action, after in self.model.outputs(inner):
            called = self.called(program, action)
            if called is not None:
                event = self.event(program, "!", called)
                found += [(called, one, event) for one in self.left(after, marks)]
        return list(dict.fromkeys(found))

    def pick(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        given = self.renamed(program, action)
        if state[0] == LOST:
            return [], True
        if self.model.unexplored(state[0], given) and not self.model.outputs(state[0]):
            return [], self.policy == "stop"
        found = []
        for middle, event in self.give(state, program, action)[0]:
            for output, after, other in self.outputs_due(middle, program):
                if self.model.same_actor(given[0], self.renamed(program, output)[0]):
                    if (output, after, (event, other)) not in found:
                        found.append((output, after, (event, other)))
        return found, False

    def quiet(self, state: tuple, program: int, name: str, is_input: bool) -> bool:
        return state[0] == LOST or not self.model.outputs(state[0])

    def died(self, state: tuple, programs: frozenset[int]) -> tuple[list, bool]:
        """(the states after the programs died, whether the run is cut there)."""
        inner, marks = state
        if inner == LOST or all(end.program not in programs for end in self.mortal):
            return [state], False
        marks = tuple(
            mark if end.program not in programs else DISCONNECTS if end.disconnect else THROWS_AWAY
            for mark, end in zip(marks, self.mortal)
        )
        found = self.left(inner, marks)
        return [state for state in found if state[0] != LOST], any(s[0] == LOST for s in found)


class Topic:
    """One model a reader; the writers' inputs go to all of them, or to one.

    A reader is a program, or all copies of a callback; in events it is its place in the list.

    The state is (the states of the readers' models, None where the reader died; the writers'
    outputs collected from each; what each owes to a writer that died; the writer that may die and
    made the last call, where there are others)."""

    def __init__(
        self,
        name: str,
        models: list[Model],
        writers: set[int],
        readers: list[frozenset[int]],
        policy: str,
        deliver_one: bool,
        mortal: set[int],
        entries: int,
    ) -> None:
        self.name = name
        self.models = models
        self.writers = writers
        self.readers = readers
        self.reader_names: list[str] = []  # a node's callbacks have its name
        self.reader_of = {p: i for i, programs in enumerate(readers) for p in programs}
        self.standing = writers | set(self.reader_of)
        self.policy = policy
        self.deliver_one = deliver_one
        self.mortal = mortal & writers
        if not all(model.has_actors for model in models):
            raise Refused(f"topic {name}: a model without actors")
        returns = any(model.actor(n) == "writer" for model in models for n in model.output_names)
        self.keeps_caller = returns and bool(self.mortal) and entries > 1
        self.ends = []
        for model in models:
            end = end_of(model, -1, "writer", 0, 1, {"reader"})
            self.ends.append(replace(end, disconnect=end.disconnect if entries == 1 else None))
        states = tuple(model.initial for model in models)
        self.initial = (states, (None,) * len(models), (NOTHING,) * len(models), None)

    def of_writer(self, name: str) -> bool:
        """Whether an input or output is one of the writer's actor."""
        return any(model.actor(name) == "writer" for model in self.models)

    def check_role(self, program: int, name: str) -> None:
        """Refuses a program that is not among those that may do this."""
        if program not in (self.writers if self.of_writer(name) else self.reader_of):
            raise Refused(f"topic {self.name}: this program may not use {name}")

    def check_input(self, program: int, name: str) -> None:
        """Refuses an input that the topic does not have, or not for this program."""
        if not any(name in model.input_names for model in self.models):
            raise Refused(f"topic {self.name} has no input {name}")
        self.check_role(program, name)

    def check_output(self, program: int, name: str) -> None:
        """Refuses an output that the topic does not have, or not for this program."""
        if name in self.arrivals_of(program):
            return
        if not any(name in model.output_names for model in self.models):
            raise Refused(f"topic {self.name} has no output {name}")
        self.check_role(program, name)

    def arrivals_of(self, program: int) -> dict[str, set[int]]:
        """What a writer may wait for: by its name the readers that are to have all."""
        if program not in self.writers:
            return {}
        found: dict[str, set[int]] = {"arrived": set(range(len(self.readers)))}
        for i, name in enumerate(self.reader_names):
            found.setdefault(f"arrived[{name}]", set()).add(i)
        return found

    def alive(self, state: tuple) -> list[int]:
        """The readers that live."""
        return [i for i, inner in enumerate(state[0]) if inner is not None]

    def written(self, state: tuple) -> Action | None:
        """The writers' output that the topic has due."""
        _, collected, _, _ = state
        found = [output for output in collected if output is not None]
        if not found:
            return None
        if not self.deliver_one and any(collected[i] is None for i in self.alive(state)):
            return None
        failed = [output for output in found if output[0].startswith("failed")]
        return (failed or found)[0]

    @staticmethod
    def with_reader(state: tuple, i: int, **new: Any) -> tuple:
        """The state with something else of one reader."""
        parts = []
        for key, values in zip(("inner", "collected", "mark"), state):
            parts.append(values[:i] + (new[key],) + values[i + 1 :] if key in new else values)
        return (*parts, state[3])

    def settled(self, state: tuple) -> list[tuple]:
        """The states after what came due for the writers was collected or thrown away."""
        found = [state]
        for i in range(len(self.models)):
            found = [after for before in found for after in self.settled_at(before, i)]
        return list(dict.fromkeys(found))

    def settled_at(self, state: tuple, i: int) -> list[tuple]:
        """The same of one reader's model."""
        inner, mark = state[0][i], state[2][i]
        model, end = self.models[i], self.ends[i]
        if inner is None or inner == LOST:
            return [state]
        if not mark:
            found = []
            for output, after in model.outputs(inner):
                if model.actor(output[0]) == "writer":
                    later = self.with_reader(state, i, inner=after, collected=output)
                    found += self.settled_at(later, i)
            return found or [state]
        return [
            self.with_reader(state, i, inner=after, mark=kept, collected=None)
            if after == LOST
            else self.with_reader(state, i, inner=after, mark=kept)
            for after, (kept,) in left(model, inner, (mark,), [end], self.policy)
        ]

    def taken(self, state: tuple, i: int, action: Action, tried: bool = False) -> tuple[list, bool]:
        """The states of a reader's model after an input, with its mark; whether it is cut."""
        inner, mark = state[0][i], state[2][i]
        if inner == LOST:
            return [], True
        never = self.models[i].unexplored(inner, action)
        after, cut = taken(self.models[i], inner, action, self.policy)
        if never and tried:
            after = []
        is_call = action[0] in self.ends[i].inputs and not never
        return [(one, NOTHING if is_call and mark == THROWS_AWAY else mark) for one in after], cut

    def give(
        self, state: tuple, program: int, action: Action, tried: bool = False
    ) -> tuple[list, bool]:
        """As above; `tried`: only where the input was tried."""
        if not self.of_writer(action[0]):
            i = self.reader_of[program]
            if state[0][i] is None:
                return [], False
            after, cut = self.taken(state, i, action)
            event = (program, self.name, (i,), "?", action)
            found = [
                (settled, event)
                for inner, mark in after
                for settled in self.settled(self.with_reader(state, i, inner=inner, mark=mark))
            ]
            return list(dict.fromkeys(found)), cut
        if self.written(state) is not None:
            return [], False
        alive = self.alive(state)
        options = {i: self.taken(state, i, action, tried) for i in alive}
        if self.keeps_caller:
            state = (*state[:3], program if program in self.mortal else None)
        found = []

        def add(chosen: dict[int, tuple]) -> None:
            after = state
            for i, (inner, mark) in chosen.items():
                after = self.with_reader(after, i, inner=inner, mark=mark)
            event = (program, self.name, tuple(chosen), "?", action)
            found.extend((settled, event) for settled in self.settled(after))

        if self.deliver_one and alive:
            for i in alive:
                for after in options[i][0]:
                    add({i: after})
            cuts = tuple(i for i, (_, cut) in options.items() if cut)
            return list(dict.fromkeys(found)), cuts
        if any(not after and not cut for after, cut in options.values()):
            return [], False
        if any(cut for _, cut in options.values()):
            return [], True
        for choice in itertools.product(*(options[i][0] for i in alive)):
            add(dict(zip(alive, choice)))
        return list(dict.fromkeys(found)), False

    def due(self, state: tuple, program: int) -> list:
        found = self.outputs_due(state, program)
        for name in self.arrivals_of(program):
            found.append(((name, ()), state, (program, self.name, None, "!", ARRIVED)))
        return found

    def outputs_due(self, state: tuple, program: int) -> list:
        """What the program may take of the models."""
        found = []
        if program in self.writers:
            output = self.written(state)
            if output is not None:
                after = (state[0], (None,) * len(self.models), state[2], None)
                found.append((output, after, (program, self.name, None, "!", output)))
        if program in self.reader_of:
            i = self.reader_of[program]
            if state[0][i] is not None and state[0][i] != LOST:
                for output, inner in self.models[i].outputs(state[0][i]):
                    event = (program, self.name, (i,), "!", output)
                    after = self.with_reader(state, i, inner=inner)
                    found += [(output, settled, event) for settled in self.settled(after)]
        return list(dict.fromkeys(found))

    def pick(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        found: list = []
        writes = self.of_writer(action[0])
        if not writes and self.policy == "drop":
            i = self.reader_of[program]
            if self.models[i].unexplored(state[0][i], action):
                return [], False
        given, cut = self.give(state, program, action, tried=True)
        for middle, event in given:
            for output, after, other in self.outputs_due(middle, program):
                if self.of_writer(output[0]) == writes:
                    if (output, after, (event, other)) not in found:
                        found.append((output, after, (event, other)))
        return found, cut

    def quiet(self, state: tuple, program: int, name: str, is_input: bool) -> bool:
        if not self.of_writer(name) and not name.startswith("arrived"):
            concerned = [self.reader_of[program]]
        elif self.written(state) is not None:
            return False
        else:
            concerned = self.alive(state)
        return not any(
            self.models[i].outputs(state[0][i])
            for i in concerned
            if state[0][i] is not None and state[0][i] != LOST
        )

    def died(self, state: tuple, programs: frozenset[int]) -> tuple[list, bool]:
        """(the states after the programs died, whether the run is cut there): their models leave,
        and what is due to them is thrown away."""
        for i in {self.reader_of[p] for p in programs if p in self.reader_of}:
            state = self.with_reader(state, i, inner=None, collected=None, mark=NOTHING)
        if programs & self.writers and (not self.keeps_caller or state[3] in programs):
            for i in self.alive(state):
                if state[0][i] == LOST:
                    continue
                mark = DISCONNECTS if self.ends[i].disconnect else THROWS_AWAY
                state = self.with_reader(state, i, collected=None, mark=mark)
            state = (*state[:3], None)
        return self.not_lost(state)

    def reborn(self, state: tuple, programs: frozenset[int]) -> tuple:
        """The state after programs that had died began anew: their models are as at first."""
        for i in {self.reader_of[p] for p in programs if p in self.reader_of}:
            state = self.with_reader(state, i, inner=self.models[i].initial)
        return state

    def not_lost(self, state: tuple) -> tuple[list, bool]:
        """(the states after all was collected or thrown away, whether the run is cut there)."""
        found = self.settled(state)
        lost = [LOST in after[0] for after in found]
        was_lost = LOST in state[0]
        if was_lost:
            return found, False
        return [after for after, cut in zip(found, lost) if not cut], any(lost)
