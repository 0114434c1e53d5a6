"""Services whose requests and answers arrive later.

A wire lies between each client and the server (the first half of `wires`, box 0), and between the
server and each client (the second half). The state is (the state of the service as in services.py,
what is on the wires, how many of that are of somebody who died, the wires that a stream must note).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from deliveries import ACKNOWLEDGED, AT_ONCE, Wire
from models import Action
from services import DUE, FREE, NOBODY, STRANGER, WAITS, Client, Rest, Service
from wires import Arrival, Line

SERVER = -1  # its entry; a client's is its number


class Calls(NamedTuple):
    """The state of a service with wires."""

    rest: Rest
    lines: tuple
    old: tuple
    journal: tuple = ()


class ServiceOnWires(Line, Service):
    """A service as two topics with wires; what it does at rest is a Service's.

    On a request's wire are (the request,), on an answer's (whose it is, the program whose call of
    `answer` ends when it arrives)."""

    def __init__(
        self,
        name: str,
        depth: int,
        server: frozenset[int],
        clients: list[Client],
        slots: tuple[int, ...],
        one_by_one: bool,
        wires: list[Wire],
    ) -> None:
        arguments = (name, depth, server, clients, slots, one_by_one)
        Service.__init__(self, *arguments)
        self.rest = Service(*arguments)
        self.wires = wires
        self.initial: Any = Calls(self.rest.initial, ((),) * len(wires), (0,) * len(wires))

    def to_server(self, i: int) -> int:
        """The wire of a client's requests."""
        return i

    def to_client(self, i: int) -> int:
        """The wire of a client's answers."""
        return len(self.clients) + i

    def at_rest(self, state: Calls, found: list) -> list:
        """Results of the service at rest, with the wires as they are."""
        return [(*one[:-2], state._replace(rest=one[-2]), one[-1]) for one in found]

    # --- whether it is there

    def watch(self, is_watched: bool) -> None:
        self.rest.watch(is_watched)

    def is_there(self, state: Calls) -> bool:
        return self.rest.is_there(state.rest)

    def offered(self, state: Calls) -> Calls:
        return state._replace(rest=self.rest.offered(state.rest))

    def withdrawn(self, state: Calls) -> Calls:
        """The state after it was withdrawn: requests on their way are lost, too."""
        for i in range(len(self.clients)):
            state = self.with_line(state, self.to_server(i), ())
        return state._replace(rest=self.rest.withdrawn(state.rest))

    # --- what programs do

    def renamed(self, state: Calls, i: int, names: dict) -> Calls:
        """The state with other names for those who asked at one client."""
        state = state._replace(rest=self.rest.renamed(state.rest, i, names))
        k = self.to_server(i)
        line = tuple(((i, names.get(who, who)),) for ((_, who),) in state.lines[k])
        state = self.with_line(state, k, line)
        k = self.to_client(i)
        line = tuple((names.get(who, who), by) for who, by in state.lines[k])
        return self.with_line(state, k, line)

    def names(self, state: Calls, i: int) -> set:
        """Those of a client who may still be answered."""
        found = self.rest.names(state.rest, i)
        found |= {who for ((_, who),) in state.lines[self.to_server(i)]}
        return found | {who for who, _ in state.lines[self.to_client(i)]}

    def worth_keeping(self, state: Calls, i: int, answerable: set) -> tuple[Any, dict]:
        """The state with those open requests that make a difference, and the new names of all."""
        rest, names = self.rest.worth_keeping(state.rest, i, answerable)
        return state._replace(rest=rest), names

    def timed_out(self, state: Calls, program: int) -> Calls:
        """The state after the time-out of a `select` that waited for answers to a program."""
        return state._replace(rest=self.rest.timed_out(state.rest, program))

    def forgotten(self, state: Calls, program: int) -> Calls:
        """The state after nobody waits any more for what this copy of a callback asked for."""
        i = self.client_of.get(program)
        state = state._replace(rest=self.rest.forgotten(state.rest, program))
        if i is None or not self.clients[i].is_node or state.rest.clients[i] is None:
            return state
        return self.renamed(state, i, {program: NOBODY})

    def sent(self, state: Calls, program: int) -> Calls:
        """The state after a request."""
        state = self.forgotten(state, program)
        rest, request = self.rest.asked_by(state.rest, program)
        state = state._replace(rest=rest)
        k = self.to_server(request[0])
        if self.wires[k].delivery == AT_ONCE:
            return state._replace(rest=self.rest.requested(state.rest, request))
        return self.put(state, k, (request,)) if self.rest.takes_requests(state.rest) else state

    def answered(self, state: Calls, program: int) -> Calls:
        """The state after the request that was served last was answered, to all clients."""
        asking, who = state.rest.served[self.slot(program)]
        state = state._replace(rest=self.rest.with_served(state.rest, program, None))
        for i, client in enumerate(state.rest.clients):
            entry, k = who if i == asking else STRANGER, self.to_client(i)
            if client is None:
                continue
            if self.wires[k].delivery == AT_ONCE:
                state = state._replace(rest=self.rest.reached(state.rest, i, entry))
            else:
                by = program if self.wires[k].delivery == ACKNOWLEDGED else None
                state = self.put(state, k, (entry, by))
        return state

    def give(self, state: Calls, program: int, action: Action) -> tuple[list, bool]:
        """The states after an input."""
        name, rest = action[0], state.rest
        if name not in ("send", "answer") or action[1]:
            found, cut = self.rest.give(rest, program, action)
            return self.at_rest(state, found), cut
        event = self.event(program, "?", name)
        if name == "send":
            at_once = self.wires[self.to_server(self.client_of[program])].delivery == AT_ONCE
            if at_once and rest.server not in (FREE, WAITS):
                return [], False
            return [(self.sent(state, program), event)], False
        if rest.served[self.slot(program)] is None:
            return [], False
        for i, client in enumerate(rest.clients):
            at_once = self.wires[self.to_client(i)].delivery == AT_ONCE
            if at_once and client is not None and client[1] == DUE:
                return [], False
        return [(self.answered(state, program), event)], False

    def due(self, state: Calls, program: int) -> list:
        return self.at_rest(state, self.rest.due(state.rest, program))

    def pick(self, state: Calls, program: int, action: Action) -> tuple[list, bool]:
        found, cut = self.rest.pick(state.rest, program, action)
        return self.at_rest(state, found), cut

    def quiet(self, state: Calls, program: int, name: str, is_input: bool) -> bool:
        """As at rest, but nothing that is due elsewhere matters to who sends on a wire."""
        if name == "send" and self.wires[self.client_of[program]].delivery != AT_ONCE:
            return True
        if name == "answer" and is_input:
            return all(
                client is None or client[1] != DUE
                for i, client in enumerate(state.rest.clients)
                if self.wires[self.to_client(i)].delivery == AT_ONCE
            )
        return self.rest.quiet(state.rest, program, name, is_input)

    def is_calling(self, state: Calls, program: int) -> bool:
        """Whether a program stands in an `answer` that ends when all clients have it."""
        lines = state.lines[len(self.clients) :]
        return any(by == program for line in lines for _, by in line)

    def acknowledges(self, program: int) -> bool:
        """Whether calls of a program end with an arrival."""
        wires = self.wires[len(self.clients) :]
        return program in self.server and any(w.delivery == ACKNOWLEDGED for w in wires)

    def died(self, state: Calls, programs: frozenset[int]) -> tuple[list, bool]:
        """The states after programs died."""
        ((rest,), cut) = self.rest.died(state.rest, programs)
        state = state._replace(rest=rest)
        if programs & self.server:
            for i in range(len(self.clients)):
                state = self.with_line(state, self.to_server(i), ())
            for k in range(len(self.clients), len(self.wires)):
                state = self.with_line(state, k, tuple((who, None) for who, _ in state.lines[k]))
            state = self.left_by(state, SERVER)
        for i in self.clients_among(programs):
            requests = (((i, STRANGER),) for _ in state.lines[self.to_server(i)])
            state = self.with_line(state, self.to_server(i), tuple(requests))
            state = self.with_line(state, self.to_client(i), ())
            state = self.left_by(state, i)
        return [state], cut

    def reborn(self, state: Calls, programs: frozenset[int], is_there: bool) -> Calls:
        return state._replace(rest=self.rest.reborn(state.rest, programs, is_there))

    def away(self, state: Calls) -> Calls:
        return state._replace(rest=self.rest.away(state.rest))

    def gone(self, state: Calls) -> Calls | None:
        rest = self.rest.gone(state.rest)
        return None if rest is None else state._replace(rest=rest)

    # --- what nobody does

    def arrivals(self, state: Calls) -> list[Arrival]:
        """What may arrive or be lost."""
        found = []
        for k, line in enumerate(state.lines):
            if not line:
                continue
            is_request = k < len(self.clients)
            i = k if is_request else k - len(self.clients)
            if is_request:
                if state.rest.server not in (FREE, WAITS):
                    continue
                rest = self.rest.requested(state.rest, line[0][0])
            else:
                if state.rest.clients[i][1] == DUE:
                    continue
                rest = self.rest.reached(state.rest, i, line[0][0])
            without = self.without_oldest(state, k)
            kind = "request" if is_request else "answer"
            for what, after in (("arrives", rest), ("lost", state.rest)):
                if what == "lost" and not self.may_lose(state, k):
                    continue
                now = without._replace(rest=after)
                action = (f"{kind}_{what}", ())
                event = (None, self.name, (i,), "!", action)
                found.append(Arrival(k, action, now, event, what == "lost"))
        return found

    # --- what the executor of a node does

    def has_request(self, state: Calls) -> bool:
        return self.rest.has_request(state.rest)

    def served_by(self, state: Calls, program: int) -> tuple[Any, tuple]:
        rest, events = self.rest.served_by(state.rest, program)
        return state._replace(rest=rest), events

    def is_found(self, state: Calls, i: int) -> bool:
        return self.rest.is_found(state.rest, i)

    def takes_others(self, state: Calls, i: int) -> Any:
        rest = self.rest.takes_others(state.rest, i)
        return None if rest is None else state._replace(rest=rest)

    def has_answer(self, state: Calls, i: int) -> bool:
        return self.rest.has_answer(state.rest, i)

    def received_by(self, state: Calls, i: int, program: int) -> tuple[Any, tuple]:
        rest, events = self.rest.received_by(state.rest, i, program)
        return state._replace(rest=rest), events
