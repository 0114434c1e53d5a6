"""What a program may do with a model or a topic, and what becomes of it.

Both answer, for a program by its number:

    give(state, program, action)    -> ([(next state, event)], cut): cut if it was never tried
    due(state, program)             -> [(action, next state, event)], what the program may take
    pick(state, program, action)    -> ([(action, next state, events)], cut), input and output in
                                       one step, for an arm of a select
    quiet(state, program, name)     whether nothing is due where this input or output belongs

An event is (program, name, readers or None, "?" or "!", action). A model takes no input while an
output is due.
"""

from __future__ import annotations

import itertools
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


class Instance:
    """A model that stands in a system by itself; `ends` says which program has which end."""

    def __init__(self, name: str, model: Model, policy: str, ends: dict[int, dict]) -> None:
        self.name = name
        self.model = model
        self.policy = policy
        self.initial = model.initial
        self.ends = ends

    def check_input(self, program: int, name: str) -> None:
        """Refuses an input that the model does not have."""
        if self.renamed(program, (name, ()))[0] not in self.model.input_names:
            raise Refused(f"{self.name} has no input {name}")

    def check_output(self, program: int, name: str) -> None:
        """Refuses an output that the model does not have."""
        if self.renamed(program, (name, ()))[0] not in self.model.output_names:
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

    def give(self, state: State, program: int, action: Action) -> tuple[list, bool]:
        after, cut = taken(self.model, state, self.renamed(program, action), self.policy)
        return [(state, self.event(program, "?", action)) for state in after], cut

    def due(self, state: State, program: int) -> list:
        found = []
        for action, after in self.model.outputs(state):
            called = self.called(program, action)
            if called is not None:
                found.append((called, after, self.event(program, "!", called)))
        return found

    def pick(self, state: State, program: int, action: Action) -> tuple[list, bool]:
        given = self.renamed(program, action)
        if self.model.unexplored(state, given) and not self.model.outputs(state):
            return [], self.policy == "stop"
        found = []
        for middle, event in self.give(state, program, action)[0]:
            for output, after, other in self.due(middle, program):
                if self.model.same_actor(given[0], self.renamed(program, output)[0]):
                    if (output, after, (event, other)) not in found:
                        found.append((output, after, (event, other)))
        return found, False

    def quiet(self, state: State, program: int, name: str) -> bool:
        return not self.model.outputs(state)

    def died(self, state: State, program: int) -> State:
        """The state after the program died."""
        return state


class Topic:
    """One model a reader; the writers' inputs go to all of them, or to one.

    The state is (the states of the readers' models, None where the reader died; the writers'
    outputs collected from each; the writer that waits for them, where writers may die)."""

    def __init__(
        self,
        name: str,
        models: list[Model],
        writers: set[int],
        readers: list[int],
        policy: str,
        deliver_one: bool,
        mortal: set[int],
    ) -> None:
        self.name = name
        self.models = models
        self.writers = writers
        self.readers = readers
        self.policy = policy
        self.deliver_one = deliver_one
        self.mortal = mortal & writers
        if not all(model.has_actors for model in models):
            raise Refused(f"topic {name}: a model without actors")
        states = tuple(model.initial for model in models)
        self.initial = (states, (None,) * len(models), None)

    def of_writer(self, name: str) -> bool:
        """Whether an input or output is one of the writer's actor."""
        return any(model.actor(name) == "writer" for model in self.models)

    def check_role(self, program: int, name: str) -> None:
        """Refuses a program that is not among those that may do this."""
        if program not in (self.writers if self.of_writer(name) else self.readers):
            raise Refused(f"topic {self.name}: this program may not use {name}")

    def check_input(self, program: int, name: str) -> None:
        """Refuses an input that the topic does not have, or not for this program."""
        if not any(name in model.input_names for model in self.models):
            raise Refused(f"topic {self.name} has no input {name}")
        self.check_role(program, name)

    def check_output(self, program: int, name: str) -> None:
        """Refuses an output that the topic does not have, or not for this program."""
        if not any(name in model.output_names for model in self.models):
            raise Refused(f"topic {self.name} has no output {name}")
        self.check_role(program, name)

    def written(self, state: tuple) -> Action | None:
        """The writers' output that the topic has due."""
        states, collected, _ = state
        found = [output for output in collected if output is not None]
        if not found:
            return None
        alive = [i for i in range(len(states)) if states[i] is not None]
        if not self.deliver_one and any(collected[i] is None for i in alive):
            return None
        failed = [output for output in found if output[0] == "failed"]
        return (failed or found)[0]

    def settled(self, state: tuple) -> list[tuple]:
        """The states after what came due for the writers was collected."""
        states, collected, writer = state
        for i, inner in enumerate(states):
            if inner is None:
                continue
            outputs = self.models[i].outputs(inner)
            due = [(o, t) for o, t in outputs if self.models[i].actor(o[0]) == "writer"]
            if due:
                found = []
                for output, after in due:
                    left = states[:i] + (after,) + states[i + 1 :]
                    got = collected[:i] + (output,) + collected[i + 1 :]
                    found += self.settled((left, got, writer))
                return found
        if writer == "dead" and self.written(state) is not None:
            return [(states, (None,) * len(states), None)]
        return [state]

    def give(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        states, collected, writer = state
        if not self.of_writer(action[0]):
            i = self.readers.index(program)
            after, cut = taken(self.models[i], states[i], action, self.policy)
            event = (program, self.name, (self.readers[i],), "?", action)
            return [
                (settled, event)
                for inner in after
                for settled in self.settled((states[:i] + (inner,) + states[i + 1 :], *state[1:]))
            ], cut
        if self.written(state) is not None:
            return [], False
        alive = [i for i in range(len(states)) if states[i] is not None]
        options = {i: taken(self.models[i], states[i], action, self.policy) for i in alive}
        owner = program if program in self.mortal else writer
        found: list = []

        def add(chosen: dict[int, State]) -> None:
            inner = tuple(chosen.get(i, states[i]) for i in range(len(states)))
            readers = tuple(self.readers[i] for i in chosen)
            event = (program, self.name, readers, "?", action)
            for settled in self.settled((inner, collected, owner)):
                found.append((settled, event))

        if self.deliver_one and alive:
            for i in alive:
                for after in options[i][0]:
                    add({i: after})
            return found, any(cut for _, cut in options.values())
        if any(not after and not cut for after, cut in options.values()):
            return [], False
        if any(cut for _, cut in options.values()):
            return [], True
        for choice in itertools.product(*(options[i][0] for i in alive)):
            add(dict(zip(alive, choice)))
        return found, False

    def due(self, state: tuple, program: int) -> list:
        states, collected, writer = state
        found = []
        if program in self.writers:
            output = self.written(state)
            if output is not None:
                after = (states, (None,) * len(states), None)
                found.append((output, after, (program, self.name, None, "!", output)))
        if program in self.readers:
            i = self.readers.index(program)
            if states[i] is not None:
                for output, inner in self.models[i].outputs(states[i]):
                    event = (program, self.name, (program,), "!", output)
                    after = (states[:i] + (inner,) + states[i + 1 :], collected, writer)
                    found += [(output, settled, event) for settled in self.settled(after)]
        return found

    def pick(self, state: tuple, program: int, action: Action) -> tuple[list, bool]:
        found: list = []
        writes = self.of_writer(action[0])
        if self.policy == "drop" and self.was_never_tried(state, program, action):
            return [], False
        given, cut = self.give(state, program, action)
        for middle, event in given:
            for output, after, other in self.due(middle, program):
                if self.of_writer(output[0]) == writes:
                    if (output, after, (event, other)) not in found:
                        found.append((output, after, (event, other)))
        return found, cut

    def was_never_tried(self, state: tuple, program: int, action: Action) -> bool:
        """Whether a model to which the input would go never had it tried."""
        states = state[0]
        if self.of_writer(action[0]):
            concerned = [i for i in range(len(states)) if states[i] is not None]
        else:
            concerned = [self.readers.index(program)]
        return any(self.models[i].unexplored(states[i], action) for i in concerned)

    def quiet(self, state: tuple, program: int, name: str) -> bool:
        states = state[0]
        if not self.of_writer(name):
            concerned = [self.readers.index(program)]
        elif self.written(state) is not None:
            return False
        else:
            concerned = list(range(len(states)))
        return not any(
            self.models[i].outputs(states[i]) for i in concerned if states[i] is not None
        )

    def died(self, state: tuple, program: int) -> tuple:
        """The state after the program died: its model leaves, what is due to it is thrown away."""
        states, collected, writer = state
        if program in self.readers:
            i = self.readers.index(program)
            states = states[:i] + (None,) + states[i + 1 :]
            collected = collected[:i] + (None,) + collected[i + 1 :]
        if program == writer:
            writer = "dead"
            if self.written((states, collected, writer)) is not None:
                collected, writer = (None,) * len(states), None
        return (states, collected, writer)
