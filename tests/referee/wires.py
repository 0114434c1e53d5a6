"""Messages on their way: topics and models whose writers' inputs arrive in a step of their own.

A wire lies between each writer's entry and each box: the model of a topic's reader, or the model.
The state of a connection is

    (inners, marks, collected, debts, lines, dead, caller, journal)

    inners     of each box the model's state; None if the reader died
    marks      of a model that stands by itself, what it owes to ends that died
    collected  of each box the return (`written`) that the writer may take
    debts      of each box how many returns were given before the model put them out
    lines      of each wire the messages on it, the oldest first, as (input, the program whose call
               ends when it arrives, or None)
    old        of each wire how many of its messages, the oldest, are of a writer that died
    caller     the program that may die and made the last call, where there are others; then DEAD
    journal    the wires on which this step put something, where they belong to a stream

A write is judged as if all that is on its way had arrived, so a wire adds no room.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

from deliveries import ACKNOWLEDGED, AT_ONCE, Wire
from language import Refused
from models import Action, Model, Queue, State
from use import ARRIVED, LOST, NOTHING, End, Instance, Topic, left, taken

ANY = "any"  # a model in a state that was never tried
DEAD = "dead"
EMPTIES = {"disconnect", "close"}
WRITES = ("write", "send", "answer", "publish")
RECEIVES = ("read", "tryread", "receive", "serve", "take")


class Arrival(NamedTuple):
    """A step of nobody: the oldest message of a wire arrives, or is lost."""

    wire: int
    action: tuple
    after: Any  # None: the run is cut
    event: tuple
    is_loss: bool


class Line:
    """What is on wires, whatever the messages are."""

    wires: list[Wire]

    @staticmethod
    def is_counted(message: Any) -> bool:
        """Whether it is data, which may be lost and of which the writer keeps the newest."""
        return True

    def put(self, state: Any, k: int, message: Any) -> Any:
        """The state with one message more on a wire."""
        wire, line = self.wires[k], (*state.lines[k], message)
        if wire.keep is not None and len(line) > wire.most():
            at = next((n for n, one in enumerate(line) if self.is_counted(one)), 0)
            line = line[:at] + line[at + 1 :]
            state = self.with_old(state, k, state.old[k] - (at < state.old[k]))
        journal = state.journal if wire.stream is None else (*state.journal, k)
        return self.with_line(state, k, line)._replace(journal=journal)

    @staticmethod
    def with_line(state: Any, k: int, line: tuple) -> Any:
        """The state with something else on a wire."""
        state = state._replace(lines=state.lines[:k] + (line,) + state.lines[k + 1 :])
        return Line.with_old(state, k, min(state.old[k], len(line)))

    @staticmethod
    def with_old(state: Any, k: int, count: int) -> Any:
        """The state with another number of messages on a wire whose writer died."""
        return state._replace(old=state.old[:k] + (count,) + state.old[k + 1 :])

    def without_oldest(self, state: Any, k: int) -> Any:
        """The state after the oldest message left its wire."""
        state = self.with_old(state, k, max(0, state.old[k] - 1))
        return self.with_line(state, k, state.lines[k][1:])

    def left_by(self, state: Any, entry: int) -> Any:
        """The state after the entry died whose messages are on their way."""
        for k, wire in enumerate(self.wires):
            if wire.entry == entry:
                state = self.with_old(state, k, len(state.lines[k]))
        return state

    def has_room(self, state: Any, k: int) -> bool:
        """Whether a wire that loses nothing has room."""
        wire = self.wires[k]
        return wire.keep is not None or len(state.lines[k]) < wire.most()

    def may_lose(self, state: Any, k: int) -> bool:
        """Whether the oldest message of a wire may be lost."""
        wire, line = self.wires[k], state.lines[k]
        if not self.is_counted(line[0]):
            return False
        newer = sum(map(self.is_counted, line[1:]))
        older = wire.keep is not None and newer >= wire.keep
        return wire.loses or older or state.old[k] > 0


class Way(NamedTuple):
    """The state of a connection with wires."""

    inners: tuple
    marks: tuple
    collected: tuple
    debts: tuple
    lines: tuple
    old: tuple
    caller: Any = None
    journal: tuple = ()


class Boxes(Line):
    """What topics and single models on wires have in common."""

    name: str
    models: list[Model]
    policy: str
    deliver_one = False
    keeps_caller = False
    mortal: Any = ()

    def set_up(self, wires: list[Wire], entry_of: dict[int, int]) -> None:
        """Notes the wires, and whose entry each program is."""
        self.wires = wires
        self.entry_of = entry_of
        self.into = [
            [k for k, w in enumerate(wires) if w.box == i] for i in range(len(self.models))
        ]
        # A model that refuses nothing and returns nothing need not be asked.
        self.is_open = [isinstance(m, Queue) and m.drops_oldest for m in self.models]
        self.waits_for = [
            any(wires[k].delivery == ACKNOWLEDGED for k in into) for into in self.into
        ]
        self.returning = [i for i in range(len(self.models)) if self.has_returns(i)]
        self.boxes_of: dict[int, list[int]] = {}
        for k, wire in enumerate(wires):
            self.boxes_of.setdefault(wire.entry, []).append(k)
        self.as_if_arrived = lru_cache(maxsize=None)(self.compute_as_if_arrived)
        count = len(self.models)
        self.first = Way(
            tuple(model.initial for model in self.models),
            self.first_marks(),
            (None,) * count,
            (0,) * count,
            ((),) * len(wires),
            (0,) * len(wires),
        )

    def first_marks(self) -> tuple:
        """What is owed to dead ends at first."""
        return ()

    def is_return(self, i: int, output: str) -> bool:
        """Whether an output of a box is one for the writer."""
        raise NotImplementedError

    @staticmethod
    def is_counted(message: Any) -> bool:
        return message[0][0] not in EMPTIES

    # --- what the model would do

    def emptied(self, i: int, inner: State, returns_only: bool) -> list[tuple]:
        """(state, returns) of a model after its outputs were taken, or its returns alone."""
        if returns_only and i not in self.returning:
            return [(inner, ())]
        if inner == LOST:
            return [(inner, ())]
        found, seen, waiting = [], set(), [(inner, ())]
        while waiting:
            at = waiting.pop()
            if at in seen or len(at[1]) > 20:
                continue
            seen.add(at)
            after = [
                (target, at[1] + (output,) if self.is_return(i, output[0]) else at[1])
                for output, target in self.models[i].outputs(at[0])
                if not returns_only or self.is_return(i, output[0])
            ]
            if after:
                waiting += after
            else:
                found.append(at)
        return found

    def compute_as_if_arrived(self, i: int, inner: State, lines: tuple) -> tuple:
        """(state, returns) of a model after its outputs were taken and all on the wires arrived."""
        found, seen = set(), set()
        waiting = [(*at, (0,) * len(lines)) for at in self.emptied(i, inner, False)]
        while waiting:
            at = waiting.pop()
            if at in seen:
                continue
            seen.add(at)
            now, returns, places = at
            if all(place == len(line) for place, line in zip(places, lines)):
                found.add((now, returns))
            for n, line in enumerate(lines):
                if places[n] == len(line):
                    continue
                after, cut = taken(self.models[i], now, line[places[n]], self.policy)
                if cut:
                    found.add((ANY, returns))
                moved = places[:n] + (places[n] + 1,) + places[n + 1 :]
                for one in after:
                    for two, more in self.emptied(i, one, False):
                        waiting.append((two, returns + more, moved))
        return tuple(found)

    def after_all(self, state: Way, i: int) -> tuple:
        """The same in a state of the connection."""
        lines = tuple(tuple(m[0] for m in state.lines[k]) for k in self.into[i])
        return self.as_if_arrived(i, state.inners[i], lines)

    def would_take(self, state: Way, i: int, action: Action) -> bool:
        """Whether a box would take an input if all on its way had arrived."""
        if self.is_open[i] and (action[0] == "write"):
            return True
        outcomes = self.after_all(state, i)
        for inner, _ in outcomes:
            if inner == ANY:
                continue
            after, cut = taken(self.models[i], inner, action, self.policy)
            if not after and not cut:
                return False
        return bool(outcomes)

    # --- returns

    def refreshed(self, state: Way) -> Way:
        """The state with the returns that the writers may take by now."""
        for i in self.returning:
            if state.inners[i] in (None, LOST):
                continue
            least = min((len(outs) for _, outs in self.after_all(state, i)), default=0)
            if state.debts[i] > least:  # what would have been returned was lost
                state = self.with_box(state, i, debts=least)
            while not self.waits_for[i] and state.collected[i] is None and state.debts[i] < least:
                at = state.debts[i]
                output = min((outs[at] for _, outs in self.after_all(state, i)), key=str)
                state = self.with_box(state, i, debts=at + 1)
                if state.caller != DEAD:
                    state = self.with_box(state, i, collected=output)
        return state

    def has_returns(self, i: int) -> bool:
        """Whether a box has outputs for the writer."""
        return any(self.is_return(i, name) for name in self.models[i].output_names)

    @staticmethod
    def with_box(state: Way, i: int, **new: Any) -> Way:
        """The state with something else of one box."""
        for key, value in new.items():
            old = getattr(state, key)
            state = state._replace(**{key: old[:i] + (value,) + old[i + 1 :]})
        return state

    def moved(self, state: Way, i: int, inner: State) -> list[Way]:
        """The states after a box's model came to this state, and its returns were taken."""
        found = []
        for after, returns in self.emptied(i, inner, True):
            now = self.with_box(state, i, inners=after)
            for output in returns:
                if now.debts[i]:
                    now = self.with_box(now, i, debts=now.debts[i] - 1)
                elif now.caller != DEAD:
                    now = self.with_box(now, i, collected=output)
            found += self.settled(now)
        return found

    def settled(self, state: Way) -> list[Way]:
        """The states after what is due to the dead was thrown away."""
        return [self.refreshed(state)]

    def returns(self, state: Way) -> Action | None:
        """The output that the writers may take."""
        found = [output for output in state.collected if output is not None]
        alive = [i for i, inner in enumerate(state.inners) if inner is not None]
        if not found or not self.deliver_one and any(state.collected[i] is None for i in alive):
            return None
        failed = [output for output in found if output[0].startswith("failed")]
        return (failed or found)[0]

    # --- what writers do

    def written(self, state: Way, program: int, action: Action) -> tuple[list, Any]:
        """([(the state after a writer's input, the boxes that were given it)], cut)."""
        if self.returns(state) is not None:
            return [], False
        wires = [
            k for k in self.boxes_of[self.entry_of[program]]
            if state.inners[self.wires[k].box] is not None
        ]  # fmt: skip
        ways = {k: self.write_on(state, k, program, action) for k in wires}
        if self.keeps_caller:
            state = state._replace(caller=program if program in self.mortal else None)
        if self.deliver_one and wires:
            chosen = [[(k, way)] for k in wires for way in ways[k][0]]
            cuts: Any = tuple(self.wires[k].box for k, (_, cut) in ways.items() if cut)
        else:
            if any(not found and not cut for found, cut in ways.values()):
                return [], False
            if any(cut for _, cut in ways.values()):
                return [], True
            chosen = [
                list(zip(wires, each)) for each in itertools.product(*(ways[k][0] for k in wires))
            ]
            cuts = False
        found = []
        for choice in chosen:
            after = [state]
            for k, way in choice:
                after = [two for one in after for two in way(one)]
            boxes = tuple(self.wires[k].box for k, _ in choice)
            found += [(two, boxes) for one in after for two in self.settled(one)]
        return list(dict.fromkeys(found)), cuts

    def write_on(
        self, state: Way, k: int, program: int, action: Action
    ) -> tuple[list[Callable[[Way], list[Way]]], bool]:
        """What the input may do to one wire, and whether the run is cut there."""
        wire = self.wires[k]
        if not self.would_take(state, wire.box, action):
            return [], False
        if wire.delivery == AT_ONCE:
            after, cut = taken(
                self.models[wire.box], state.inners[wire.box], action, self.policy
            )
            return [lambda s, one=one: self.moved(s, wire.box, one) for one in after], cut
        if not self.has_room(state, k):
            return [], False
        message = (action, program if wire.delivery == ACKNOWLEDGED else None)
        return [lambda s: [self.put(s, k, message)]], False

    def is_calling(self, state: Way, program: int) -> bool:
        """Whether a program stands in a call that ends when all readers have the message."""
        return any(message[1] == program for line in state.lines for message in line)

    def acknowledges(self, program: int) -> bool:
        """Whether calls of a program end with an arrival."""
        wires = self.boxes_of.get(self.entry_of.get(program, -1), [])
        return any(self.wires[k].delivery == ACKNOWLEDGED for k in wires)

    def has_arrived(self, state: Way, program: int) -> bool:
        """Whether all that the program's entry sent has arrived."""
        return not any(state.lines[k] for k in self.boxes_of.get(self.entry_of[program], []))

    # --- what nobody does

    def arrivals(self, state: Way) -> list[Arrival]:
        """What may arrive or be lost."""
        found: list[Arrival] = []
        for k, line in enumerate(state.lines):
            if not line:
                continue
            i, (action, _) = self.wires[k].box, line[0]
            rest = self.without_oldest(state, k)
            if state.inners[i] == LOST:
                event = self.of_nobody(i, ("arrives", action[1]))
                found.append(Arrival(k, event[4], None, event, False))
                continue
            after, cut = taken(self.models[i], state.inners[i], action, self.policy)
            event = self.of_nobody(i, ("arrives", action[1]))
            if cut:
                found.append(Arrival(k, event[4], None, event, False))
            for one in after:
                found += [Arrival(k, event[4], s, event, False) for s in self.moved(rest, i, one)]
            if (after or cut) and self.may_lose(state, k):
                event = self.of_nobody(i, ("lost", action[1]))
                found += [Arrival(k, event[4], s, event, True) for s in self.settled(rest)]
        return list(dict.fromkeys(found))

    def of_nobody(self, i: int, action: Action) -> tuple:
        """An event on the way to a box."""
        return (None, self.name, (i,), "!", action)

    def without_messages(self, state: Way, i: int) -> Way:
        """The state with nothing on its way to a box."""
        for k in self.into[i]:
            state = self.with_line(state, k, ())
        return state

    def without_callers(self, state: Way, programs: frozenset[int]) -> Way:
        """The state in which no call of these programs ends when a message arrives."""
        for k, line in enumerate(state.lines):
            line = tuple((action, None if by in programs else by) for action, by in line)
            state = self.with_line(state, k, line)
        return state

    def disconnected(self, state: Way, entry: int, ends: dict[int, End]) -> Way:
        """The state after a writer died: its wires remember it, and `disconnect` goes on them."""
        for k in self.boxes_of.get(entry, []):
            i = self.wires[k].box
            if i in ends and ends[i].disconnect is not None and state.inners[i] is not None:
                state = self.put(state, k, ((ends[i].disconnect, ()), None))
        return self.left_by(state, entry)


class TopicOnWires(Boxes, Topic):
    """A topic whose writes arrive later."""

    def __init__(self, *arguments: Any, wires: list[Wire], entry_of: dict[int, int]) -> None:
        Topic.__init__(self, *arguments)
        self.set_up(wires, entry_of)
        self.initial: Any = self.first

    def is_return(self, i: int, output: str) -> bool:
        return self.models[i].actor(output) == "writer"

    def give(
        self, state: Way, program: int, action: Action, tried: bool = False
    ) -> tuple[list, Any]:
        """As of a topic."""
        if self.of_writer(action[0]):
            found, cut = self.written(state, program, action)
            return [(s, (program, self.name, boxes, "?", action)) for s, boxes in found], cut
        i = self.reader_of[program]
        if state.inners[i] is None:
            return [], False
        after, cut = taken(self.models[i], state.inners[i], action, self.policy)
        if action[0] in EMPTIES:
            state = self.without_messages(state, i)
        event = (program, self.name, (i,), "?", action)
        found = [(now, event) for one in after for now in self.moved(state, i, one)]
        return list(dict.fromkeys(found)), cut

    def due(self, state: Way, program: int) -> list:
        """What the program may take."""
        found = self.outputs_due(state, program)
        mine = self.boxes_of.get(self.entry_of.get(program, -1), [])
        for name, boxes in self.arrivals_of(program).items():
            if not any(state.lines[k] for k in mine if self.wires[k].box in boxes):
                found.append(((name, ()), state, (program, self.name, None, "!", ARRIVED)))
        return found

    def outputs_due(self, state: Way, program: int) -> list:
        """The same, of the models alone."""
        found = []
        if program in self.writers:
            output = self.returns(state)
            if output is not None:
                event = (program, self.name, None, "!", output)
                after = state._replace(collected=(None,) * len(self.models), caller=None)
                found += [(output, now, event) for now in self.settled(after)]
        if program in self.reader_of:
            i = self.reader_of[program]
            if state.inners[i] is not None:
                for output, inner in self.models[i].outputs(state.inners[i]):
                    event = (program, self.name, (i,), "!", output)
                    found += [(output, now, event) for now in self.moved(state, i, inner)]
        return list(dict.fromkeys(found))

    def pick(self, state: Way, program: int, action: Action) -> tuple[list, Any]:
        found: list = []
        writes = self.of_writer(action[0])
        if not writes and self.policy == "drop":
            i = self.reader_of[program]
            if self.models[i].unexplored(state.inners[i], action):
                return [], False
        given, cut = self.give(state, program, action)
        for middle, event in given:
            for output, after, other in self.outputs_due(middle, program):
                if self.of_writer(output[0]) == writes:
                    if (output, after, (event, other)) not in found:
                        found.append((output, after, (event, other)))
        return found, cut

    def quiet(self, state: Way, program: int, name: str, is_input: bool) -> bool:
        if self.of_writer(name) or name.startswith("arrived"):
            return self.returns(state) is None
        i = self.reader_of[program]
        return state.inners[i] is None or not self.models[i].outputs(state.inners[i])

    def died(self, state: Way, programs: frozenset[int]) -> tuple[list, bool]:
        for i in {self.reader_of[p] for p in programs if p in self.reader_of}:
            state = self.without_messages(state, i)
            state = self.with_box(state, i, inners=None, collected=None, debts=0)
        writers = programs & self.writers
        if writers and (not self.keeps_caller or state.caller in writers):
            state = state._replace(collected=(None,) * len(self.models))
            state = state._replace(caller=DEAD if self.keeps_caller else state.caller)
        for entry in {self.entry_of[p] for p in writers}:
            state = self.disconnected(state, entry, dict(enumerate(self.ends)))
        return self.settled(self.without_callers(state, programs)), False

    def reborn(self, state: Way, programs: frozenset[int]) -> Way:
        """The state after programs that had died began anew: their models are as at first."""
        for i in {self.reader_of[p] for p in programs if p in self.reader_of}:
            state = self.with_box(state, i, inners=self.models[i].initial)
        return state


def inputs_named(model: Model, names: tuple) -> set[str]:
    """The inputs of a model with these names, those of further ends among them."""
    return {name for name in model.input_names if name.rstrip("0123456789") in names}


def writing_inputs(model: Model) -> set[str]:
    """The inputs of a model that go on wires."""
    return inputs_named(model, WRITES)


class ModelOnWires(Boxes, Instance):
    """A model that stands by itself, whose writing side is on wires.

    Other inputs of an actor that sends are given at once, behind what is on its way from the
    same entry."""

    def __init__(
        self,
        name: str,
        model: Model,
        policy: str,
        ends: dict[int, dict],
        mortal: list[End],
        wires: list[Wire],
        entry_of: dict[int, int],
    ) -> None:
        self.inputs = writing_inputs(model)
        writers = [end for end in mortal if end.inputs & self.inputs]
        self.writers_end = {end.program: end for end in writers}
        reading = [end for end in mortal if end.program not in self.writers_end]
        Instance.__init__(self, name, model, policy, ends, reading)
        self.models = [model]
        self.write_actors = {model.actor(n) for n in self.inputs} - {None}
        self.read_actors = {model.actor(n) for n in inputs_named(model, RECEIVES)} - {None}
        self.set_up(wires, entry_of)
        self.initial: Any = self.first

    def first_marks(self) -> tuple:
        return (NOTHING,) * len(self.mortal)

    def is_return(self, i: int, output: str) -> bool:
        actor = self.model.actor(output)
        return actor in self.write_actors and actor not in self.read_actors

    def settled(self, state: Way) -> list[Way]:
        found = left(self.model, state.inners[0], state.marks, self.mortal, self.policy)
        return [
            self.refreshed(state._replace(inners=(inner,), marks=marks))
            for inner, marks in found
        ]

    def is_behind(self, state: Way, program: int, name: str) -> bool:
        """Whether an input waits until what its own entry sent has arrived."""
        sends = self.model.actor(name) in self.write_actors
        return name not in self.inputs and sends and not self.has_arrived(state, program)

    def at_rest(self, state: Way) -> tuple:
        """The state of the model without wires."""
        return (state.inners[0], state.marks)

    def of_nobody(self, i: int, action: Action) -> tuple:
        return (None, self.name, None, "!", action)

    def give(self, state: Way, program: int, action: Action) -> tuple[list, Any]:
        given = self.renamed(program, action)
        event = self.event(program, "?", action)
        if state.inners[0] == LOST:
            return [], True
        if given[0] in self.inputs:
            found, cut = self.written(state, program, given)
            return [(now, event) for now, _ in found], cut
        if self.is_behind(state, program, given[0]):
            return [], False
        if given[0] in EMPTIES and self.model.actor(given[0]) not in self.write_actors:
            state = self.without_messages(state, 0)
        inner_after, cut = Instance.give(self, self.at_rest(state), program, action)
        found = [
            (now, event)
            for (inner, marks), _ in inner_after
            for now in self.moved(state._replace(marks=marks), 0, inner)
        ]
        return list(dict.fromkeys(found)), cut

    def due(self, state: Way, program: int) -> list:
        found = self.outputs_due(state, program)
        if self.has_arrived(state, program) and "arrived" not in self.model.output_names:
            found.append((ARRIVED, state, self.event(program, "!", ARRIVED)))
        return found

    def outputs_due(self, state: Way, program: int) -> list:
        """What the program may take of the model."""
        found = []
        output = self.returns(state)
        if output is not None:
            called = self.called(program, output)
            if called is not None:
                event = self.event(program, "!", called)
                after = state._replace(collected=(None,))
                found += [(called, now, event) for now in self.settled(after)]
        at_rest = Instance.outputs_due(self, self.at_rest(state), program)
        for called, (inner, marks), event in at_rest:
            for now in self.moved(state._replace(marks=marks), 0, inner):
                found.append((called, now, event))
        return list(dict.fromkeys(found))

    def pick(self, state: Way, program: int, action: Action) -> tuple[list, Any]:
        given = self.renamed(program, action)
        if state.inners[0] == LOST:
            return [], True
        if self.is_behind(state, program, given[0]):
            return [], False
        if given[0] not in self.inputs and self.model.unexplored(state.inners[0], given):
            if not self.model.outputs(state.inners[0]):
                return [], self.policy == "stop"
        found = []
        after, cut = self.give(state, program, action)
        for middle, event in after:
            for output, now, other in self.outputs_due(middle, program):
                if self.model.same_actor(given[0], self.renamed(program, output)[0]):
                    if (output, now, (event, other)) not in found:
                        found.append((output, now, (event, other)))
        return found, cut if given[0] in self.inputs else False

    def quiet(self, state: Way, program: int, name: str, is_input: bool) -> bool:
        given = self.renamed(program, (name, ()))[0]
        if given == "arrived" or given in self.inputs or not is_input and self.is_return(0, given):
            return self.returns(state) is None
        return state.inners[0] == LOST or not self.model.outputs(state.inners[0])

    def died(self, state: Way, programs: frozenset[int]) -> tuple[list, bool]:
        inner_after, cut = Instance.died(self, self.at_rest(state), programs)
        if any(end.program in programs for end in self.mortal):
            state = self.without_messages(state, 0)
        writing = [end for p, end in self.writers_end.items() if p in programs]
        found = []
        for inner, marks in inner_after:
            now = state._replace(marks=marks)
            if writing:
                now = now._replace(collected=(None,))
            for entry in sorted({self.entry_of[p] for p in programs}):
                own = [end for end in writing if self.entry_of[end.program] == entry]
                ends = {0: own[0]} if own and len(self.writers_end) == 1 else {}
                if own or any(now.lines[k] for k in self.boxes_of.get(entry, [])):
                    now = self.disconnected(now, entry, ends)
            found += self.moved(now, 0, inner)
        return list(dict.fromkeys(found)), cut


def refuse_arms(use: Any, program: int, name: str) -> None:
    """Refuses an arm on an input whose call ends with an arrival."""
    if hasattr(use, "acknowledges") and use.acknowledges(program):
        if use.of_writer(name) if isinstance(use, Topic) else name == "answer":
            raise Refused(f"{use.name}: no arm on an input that several readers acknowledge")


class Stream:
    """The order of what is on several wires of one stream between the same two processes.

    The state has (number of the connection, wire) of each message, the oldest first."""

    models: list = []
    weak = False
    standing: set = set()
    initial: tuple = ()

    def __init__(self, members: list[tuple[int, int]], uses: list) -> None:
        self.members = members
        self.uses = uses

    def died(self, state: tuple, programs: frozenset[int]) -> tuple[list, bool]:
        """No death changes it."""
        return [state], False

    def is_next(self, state: tuple, member: tuple[int, int]) -> bool:
        """Whether the oldest message of a wire is the oldest of all; wires of others may."""
        return member not in self.members or state[0] == member

    def noted(self, number: int, models: tuple) -> tuple:
        """The states of all after what this step did to the wires is noted."""
        order = models[number]
        for use in dict.fromkeys(k for k, _ in self.members):
            state = models[use]
            mine = [k for k in state.journal if (use, k) in self.members]
            order += tuple((use, k) for k in mine)
            rest = tuple(k for k in state.journal if (use, k) not in self.members)
            state = state._replace(journal=rest)
            models = models[:use] + (state,) + models[use + 1 :]
        for use, k in self.members:
            while order.count((use, k)) > len(models[use].lines[k]):
                at = order.index((use, k))
                order = order[:at] + order[at + 1 :]
        return models[:number] + (order,) + models[number + 1 :]
