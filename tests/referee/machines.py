"""Machines of rclcpp, computed from the referee's rules: their sizes must be those measured.

    machines.py

Each machine answers its inputs with what the referee's services, queues and executors do. Messages
have numbers, and a receiver says `gap` if one is missing before the message that it gets, as the
systems under learning do. A number matters only by its neighbours, so states are kept with numbers
as small as possible. The minimal Mealy machine is found by refining blocks of states. Exit status
1: one has another size.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from models import Queue
from services import NOBODY, STRANGER, Client, Rest, Service
from system import System

State = Any


def minimal_size(start: State, step: Callable[[State, str], tuple], inputs: list[str]) -> int:
    """The states of the minimal machine; `step` gives (output, next state)."""
    known, states, table = {start: 0}, [start], []
    for state in states:
        row = []
        for given in inputs:
            output, after = step(state, given)
            if after not in known:
                known[after] = len(states)
                states.append(after)
            row.append((output, known[after]))
        table.append(row)
    blocks, count = [0] * len(states), 0
    while True:
        numbers: dict[tuple, int] = {}
        refined = [
            numbers.setdefault((block, tuple((out, blocks[to]) for out, to in row)), len(numbers))
            for block, row in zip(blocks, table)
        ]
        if len(numbers) == count:
            return count
        blocks, count = refined, len(numbers)


def renumbered(numbers: list[int]) -> dict[int, int]:
    """Smaller numbers, of which two are neighbours where they were."""
    found: dict[int, int] = {}
    last = None
    for number in sorted(set(numbers)):
        found[number] = 0 if last is None else found[last] + (1 if number == last + 1 else 2)
        last = number
    return found


def said(number: int, before: int) -> str:
    """What a receiver says of a message."""
    return "next" if number == before + 1 else "gap"


def topic(depth: int) -> int:
    """A topic: write, spin once."""
    queue = Queue(depth, True)

    def step(state: tuple, given: str) -> tuple:
        held, sent, got = state
        if given == "write":
            ((held, _, _),) = queue.steps((held, False, None), ("write", (sent + 1,)))
            output, sent = "written", sent + 1
        elif not held:
            return "null", state
        else:
            ((held, _, (number,)),) = queue.steps((held, False, None), ("read", ()))
            output, got = said(number[0], got), number[0]
        new = renumbered([*(v for (v,) in held), sent, got])
        return output, (tuple((new[v],) for (v,) in held), new[sent], new[got])

    return minimal_size(((), 0, 0), step, ["write", "spin"])


class NumberedService(Service):
    """A service whose clients take any own answer, as rclcpp's do: the first client's requests have
    numbers; others' have none."""

    number = 0

    def sent(self, state: Rest, program: int) -> Rest:
        i = self.client_of[program]
        who = ("number", self.number) if i == 0 else NOBODY
        return state._replace(requests=self.kept(state.requests + ((i, who),)))


class ServiceMachine:
    """A service whose server answers what it serves; the second client makes whole calls."""

    SERVER, FIRST, SECOND = 2, 0, 1

    def __init__(self, depth: int, clients: int, one_open: bool = False) -> None:
        ends = [Client(frozenset([number]), is_node=True) for number in range(clients)]
        self.service = NumberedService("s", depth, frozenset([self.SERVER]), ends)
        self.one_open = one_open
        self.start = (self.service.initial, (0, 0, 0), False)

    def serve(self, state: Rest) -> tuple[Rest, Any] | None:
        """(the state after a request was answered, who asked)."""
        found = self.service.pick(state, self.SERVER, ("serve", ()))[0]
        if not found:
            return None
        state = found[0][1]
        who = state.served[0]
        return self.service.give(state, self.SERVER, ("answer", ()))[0][0][0], who

    def receive(self, state: Rest, client: int) -> tuple[Rest, Any]:
        """(the state after a client looked once for its answer, that answer or None)."""
        if not self.service.has_answer(state, client):
            return state, None
        own = self.service.own_answers(state.clients[client][0])
        return self.service.received_by(state, client, client)[0], own[0]

    def call(self, state: Rest, served: int) -> tuple[Rest, int]:
        """The second client asks, the server serves all, and the client gets its answer.

        Gives the state, and the last number that the server saw."""
        state = self.service.sent(state, self.SECOND)
        while (result := self.serve(state)) is not None:
            state, (_, who) = result
            served = served if who == NOBODY else who[1]
        state, answer = self.receive(state, self.SECOND)
        assert answer == NOBODY
        return self.service.with_client(state, self.SECOND, (), frozenset()), served

    def step(self, at: tuple, given: str) -> tuple:
        """(output, next state)."""
        state, (sent, served, got), is_open = at
        output = given
        if given in ("send", "ask"):
            if self.one_open and is_open:
                return "refused", at
            sent += 1
            is_open = True
            self.service.number = sent
            state = self.service.sent(state, self.FIRST)
        if given in ("serve", "ask"):
            result = self.serve(state)
            if result is None:
                output = "null"
            else:
                state, (_, (_, number)) = result
                output, served = said(number, served), number
        elif given == "receive":
            state, answer = self.receive(state, self.FIRST)
            output = "null"
            if answer is not None:
                output, got = said(answer[1], got), answer[1]
                is_open = False
        elif given == "call":
            state, served = self.call(state, served)
        return output, self.small(state, sent, served, got, is_open and self.one_open)

    @staticmethod
    def small(state: Rest, sent: int, served: int, got: int, is_open: bool) -> tuple:
        """The state with smaller numbers."""
        requests, _, _, clients, _, _ = state
        asked = [who[1] for _, who in requests]
        answered = [who[1] for who in clients[0][0] if who != STRANGER]
        new = renumbered([sent, served, got, *asked, *answered])
        requests = tuple((i, ("number", new[who[1]])) for i, who in requests)
        answers = tuple(
            who if who == STRANGER else ("number", new[who[1]]) for who in clients[0][0]
        )
        clients = ((answers, clients[0][1]), *clients[1:])
        small = state._replace(requests=requests, clients=clients)
        return small, (new[sent], new[served], new[got]), is_open


def service(depth: int, inputs: list[str], clients: int = 1, one_open: bool = False) -> int:
    """A service's machine."""
    machine = ServiceMachine(depth, clients, one_open)
    return minimal_size(machine.start, machine.step, inputs)


class ExecutorMachine:
    """A single-threaded executor of subscriptions, each with a topic of its own, and of clients of
    one service, which answers at once."""

    def __init__(self, subscriptions: int, depth: int, clients: int = 0, rmw: str = "") -> None:
        names = [f"t{k}" for k in range(subscriptions)]
        askers = [f"c{k}" for k in range(clients)]
        lines = ["executors: {main: {kind: single, order: rounds}}", "topics:"]
        options = f"writers: world, readers: n, use: queue, with: {{depth: {depth}}}"
        lines += [f"  {name}: {{{options}}}" for name in names]
        if askers:
            options = f"server: map, clients: [{', '.join(askers)}]"
            options += f", with: {{depth: {depth}, rmw: {rmw}}}"
            lines += ["services:", f"  s: {{{options}}}"]
        writes = " ".join(f"{name}.write;" for name in names)
        lines += ["programs:", f"  world: {writes}"]
        lines += ["  map: loop { s.serve -> request; s.answer; }"] if askers else []
        lines += ["nodes:", "  n:", "    executor: main", "    callbacks:"]
        lines += [f"      on_{name}: {{takes: {name}.read, do: skip;}}" for name in names]
        for name in askers:
            lines += [f"  {name}:", "    executor: main", "    clients: {s: {do: skip;}}"]
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "system.yaml"
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            self.system = System(str(path), at_once=True)
        self.callbacks = self.system.programs[1 + bool(askers) : -1]
        self.look = self.system.programs[-1]
        self.asking = {callback.name: callback.number for callback in self.callbacks}
        self.inputs = [f"arrive {name}" for name in names] + [f"ask {name}" for name in askers]
        self.start = (tuple(use.initial for use in self.system.uses), ())

    MAP = 1  # the program that answers

    def spin_once(self, world: tuple) -> tuple:
        """(the callback that ran, or `null`; the world after it)."""
        for _ in range(2):
            for callback in self.callbacks:
                for step in callback.steps(callback.start(), world):
                    (end,) = callback.steps(step.control, step.world)
                    return callback.text.full_name(), end.world
            for step in self.look.steps(self.look.start(), world):
                world = step.world
                if step.label[0] == "discard":
                    return "null", world
        return "null", world

    def ask(self, world: tuple, client: int) -> tuple:
        """The world after that client's request was answered."""
        number = self.system.numbers[("s", ())]
        service = self.system.uses[number]
        state = service.sent(world[0][number], client)
        ((_, state, _),) = service.pick(state, self.MAP, ("serve", ()))[0]
        ((state, _),) = service.give(state, self.MAP, ("answer", ()))[0]
        return self.callbacks[0].with_model(world, number, state)

    def step(self, world: tuple, given: str) -> tuple:
        """(output, next state)."""
        if given == "spin once":
            return self.spin_once(world)
        if given == "spin some":
            ran, world = self.spin_once(world)
            output = [ran]
            while world[0][self.look.executor.use][1]:
                ran, world = self.spin_once(world)
                output.append(ran)
            return " ".join(one for one in output if one != "null") or "null", world
        if given.startswith("ask"):
            return given, self.ask(world, self.asking[given.split()[1]])
        number = self.system.numbers[(given.split()[1], ())]
        ((state, _),) = self.system.uses[number].give(world[0][number], 0, ("write", ()))[0]
        return given, self.callbacks[0].with_model(world, number, state)


def executor(
    subscriptions: int, spin: str, depth: int = 1, clients: int = 0, rmw: str = ""
) -> int:
    """An executor's machine."""
    machine = ExecutorMachine(subscriptions, depth, clients, rmw)
    return minimal_size(machine.start, machine.step, [*machine.inputs, spin])


# Clients, depth, rmw, spin, states.
CLIENTS = [
    (1, 1, "cyclonedds", "spin once", 6),
    (2, 1, "cyclonedds", "spin once", 34),
    (2, 1, "fastrtps", "spin once", 34),
    (2, 2, "cyclonedds", "spin once", 123),
    (2, 2, "fastrtps", "spin once", 177),
    (3, 1, "cyclonedds", "spin once", 128),
    (3, 1, "fastrtps", "spin once", 128),
    (2, 2, "cyclonedds", "spin some", 21),
    (2, 2, "fastrtps", "spin some", 21),
]
MACHINES: list[tuple[str, Callable[[], int], int]] = [
    *((f"topic of depth {d}", lambda d=d: topic(d), d + 2) for d in (1, 2, 3, 10)),
    ("service of depth 1", lambda: service(1, ["send", "serve", "receive"]), 9),
    ("service of depth 2", lambda: service(2, ["send", "serve", "receive"]), 25),
    ("service of depth 1, another client's calls",
     lambda: service(1, ["send", "serve", "receive", "call"], 2), 12),
    ("service of depth 2, another client's calls",
     lambda: service(2, ["send", "serve", "receive", "call"], 2), 37),
    ("client of depth 10 with one open request: ask, receive, another's call",
     lambda: service(10, ["ask", "receive", "call"], 2, True), 12),
    *((f"executor of {k} subscriptions, spin once", lambda k=k: executor(k, "spin once"),
       2 * 3 ** (k - 1)) for k in (1, 2, 3, 4)),
    *((f"executor of {k} subscriptions of depth {d}, spin once",
       lambda k=k, d=d: executor(k, "spin once", d), (d + 1) * (2 * d + 1) ** (k - 1))
      for k, d in ((2, 2), (3, 2), (2, 10))),
    ("executor of 2 subscriptions, spin some", lambda: executor(2, "spin some"), 4),
    ("executor of 3 subscriptions, spin some", lambda: executor(3, "spin some"), 8),
    *((f"executor of a subscription and {k} clients, depth {d}, {rmw}, {spin}",
       lambda k=k, d=d, rmw=rmw, spin=spin: executor(1, spin, d, k, rmw), size)
      for k, d, rmw, spin, size in CLIENTS),
]  # fmt: skip


def main() -> int:
    """Computes all machines."""
    wrong = 0
    for name, compute, measured in MACHINES:
        size = compute()
        wrong += size != measured
        print(f"{name}: {size} states" + ("" if size == measured else f", not {measured}"))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
