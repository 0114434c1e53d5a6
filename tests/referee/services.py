"""Services: two topics with numbers, requests to the server and answers to all clients.

A Service answers what a program may do with it, as in use.py. Its state has

    requests  those that wait, the oldest first; None if the server died
    server    FREE, WAITS (a `serve` that found nothing), or the request that is due to it
    served    of each slot the request that was served last and not answered, or None
    clients   of each (answers, how it stands): FREE, WAITS or DUE for a program; for a node the
              programs to which an answer was handed over; None if the client died
    there     whether it is offered; where it is not, requests are lost. It stays when the server
              dies, until a step that comes on fair runs, where the file asks for it
    asked     of each client that is a program its open requests

A request is (number of the client, who asked). An answer in a client's queue is STRANGER, that to
requests of the client's life before, too, or who asked. Where that is a program, this is the number
of the request, or NOBODY if the program gave it up; in a node the copy of a callback whose run made the request, if it was the last one of that run
and the run goes on, or else NOBODY.

An executor with rounds finds a client by any answer in its queue, and the client takes answers to
others in its turn: over Cyclone DDS all at once, over Fast DDS one a turn.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from language import Refused
from models import Action

FREE, WAITS, DUE = "free", "waits", "due"
NOBODY, STRANGER = "nobody", "stranger"
INPUTS = {"send": "client", "receive": "client", "serve": "server", "answer": "server"}
OUTPUTS = {"request": "server", "answer": "client"}


@dataclass(frozen=True)
class Client:
    """A client: its programs (all copies of all callbacks of a node)."""

    programs: frozenset[int]
    is_node: bool = False
    hands_over: bool = False  # answers go to the callback that asked
    looked_at: bool = False  # by an executor with rounds
    has_code: bool = False  # of its own, for each answer


class Asked(NamedTuple):
    """The open requests of a program, the oldest first, each as (number, whether its answer was
    kept by a `receive` that looked for another)."""

    requests: tuple = ()
    overdue: bool = False  # a time-out came while all of these were open: `send` gives them up

    def without_oldest(self) -> Asked:
        """The same when the answer to the oldest is due."""
        return self._replace(requests=self.requests[1:])

    def after_taking(self) -> Asked:
        """The same after that answer was taken."""
        return self._replace(overdue=self.overdue and bool(self.requests))

    def with_kept(self, number: int) -> Asked:
        """The same after the answer to one was kept; to one that is not open it is thrown away."""
        kept = tuple((one, has or one == number) for one, has in self.requests)
        return self._replace(requests=kept)


class Rest(NamedTuple):
    """The state of a service."""

    requests: tuple | None
    server: Any
    served: tuple
    clients: tuple
    there: bool
    asked: tuple


class Service:
    """A service, as two topics with keep-last queues."""

    models: list = []
    weak = False
    is_watched = False

    def __init__(
        self,
        name: str,
        depth: int,
        server: frozenset[int],
        clients: list[Client],
        slots: tuple[int, ...] = (),
        one_by_one: bool = False,
    ) -> None:
        if depth < 1:
            raise Refused(f"service {name}: a depth below 1")
        self.name = name
        self.depth = depth
        self.server = server
        self.clients = clients
        self.client_of = {p: i for i, client in enumerate(clients) for p in client.programs}
        self.standing = set(server) | set(self.client_of)
        self.slots = slots  # the copies that have one of their own
        self.one_by_one = one_by_one  # a client takes one answer, whosever it is: Fast DDS
        at_first = [((), frozenset() if client.is_node else FREE) for client in clients]
        served, asked = (None,) * max(1, len(slots)), (Asked(),) * len(clients)
        self.initial: Any = Rest((), FREE, served, tuple(at_first), True, asked)

    # --- who may do what

    def check(self, program: int, name: str, roles: dict[str, str]) -> None:
        """Refuses what the service does not have, or not for this program."""
        if name not in roles:
            raise Refused(f"service {self.name} has no {name}")
        if program not in (self.server if roles[name] == "server" else self.client_of):
            raise Refused(f"service {self.name}: this program may not use {name}")

    def check_input(self, program: int, name: str) -> None:
        """Refuses an input that the service does not have, or not for this program."""
        self.check(program, name, INPUTS)
        if name == "answer" and self.slots and program not in self.slots:
            raise Refused(f"service {self.name}: what runs several times at once answers itself")

    def check_output(self, program: int, name: str) -> None:
        """Refuses an output that the service does not have, or not for this program."""
        self.check(program, name, OUTPUTS)
        if name == "answer" and program in self.client_of:
            client = self.clients[self.client_of[program]]
            if client.is_node and not client.hands_over:
                raise Refused(f"service {self.name}: nobody waits for its answers")

    # --- changes of the state

    def event(self, program: int, sign: str, name: str) -> tuple:
        """The event of this program with the service."""
        return (program, self.name, None, sign, (name, ()))

    # --- whether it is there

    def watch(self, is_watched: bool) -> None:
        """Notes whether the server may die and the file asks whether the service is there."""
        self.is_watched = is_watched

    def is_there(self, state: Rest) -> bool:
        """Whether it is offered."""
        return state.there

    def offered(self, state: Rest) -> Rest:
        """The state after it was offered."""
        return state._replace(there=True)

    def withdrawn(self, state: Rest) -> Rest:
        """The state after it was withdrawn: the requests that wait are lost, not the one that is
        due, and not what was served."""
        return state._replace(requests=(), there=False)

    def takes_requests(self, state: Rest) -> bool:
        """Whether a request that is sent is kept."""
        return state.there and state.requests is not None

    # --- queues

    def kept(self, entries: tuple) -> tuple:
        """The newest entries, as many as the depth."""
        return entries[-self.depth :]

    def with_client(self, state: Rest, i: int, answers: tuple, stands: Any) -> Rest:
        """The state with another queue of one client, without the answers in its front that are
        strangers', or to requests that a program gave up: they are thrown away before anything is
        taken, and push nothing out."""
        return self.with_clients(state, i, (self.what_counts(i, answers), stands))

    def what_counts(self, i: int, answers: tuple) -> tuple:
        """The part of a client's queue that makes a difference. An executor with rounds looks
        whether there is anything in it; over Fast DDS it takes each answer by itself."""
        if not self.clients[i].is_node:
            while answers and answers[0] in (STRANGER, NOBODY):
                answers = answers[1:]
            return answers
        if not self.clients[i].looked_at:
            return self.own_answers(answers)
        if self.one_by_one:
            return answers
        return self.own_answers(answers) or answers[-1:]

    def renamed(self, state: Rest, i: int, names: dict) -> Rest:
        """The state with other names for those who asked at one client."""

        def of_request(request: Any) -> Any:
            is_theirs = isinstance(request, tuple) and request[0] == i
            return (i, names.get(request[1], request[1])) if is_theirs else request

        state = state._replace(
            requests=None if state.requests is None else tuple(map(of_request, state.requests)),
            server=of_request(state.server),
            served=tuple(map(of_request, state.served)),
        )
        if state.clients[i] is None:
            return state
        answers, stands = state.clients[i]
        answers = tuple(names.get(who, who) for who in answers)
        return self.with_client(state, i, answers, stands)

    def names(self, state: Rest, i: int) -> set:
        """Those of a client who may still be answered."""
        requests = (*(state.requests or ()), state.server, *state.served)
        found = {one[1] for one in requests if isinstance(one, tuple) and one[0] == i}
        return found.union(state.clients[i][0] if state.clients[i] is not None else ())

    def forgotten(self, state: Rest, program: int) -> Rest:
        """The state after nobody waits any more for what this copy of a callback asked for."""
        i = self.client_of.get(program)
        if i is None or not self.clients[i].is_node or state.clients[i] is None:
            return state
        state = self.renamed(state, i, {program: NOBODY})
        answers, over = state.clients[i]
        return self.with_client(state, i, answers, over - {program})

    def sent(self, state: Rest, program: int) -> Rest:
        """The state after a request."""
        return self.requested(*self.asked_by(self.forgotten(state, program), program))

    def asked_by(self, state: Rest, program: int) -> tuple[Rest, tuple]:
        """The state after a program has one more open request, and that request."""
        i = self.client_of[program]
        client = self.clients[i]
        if client.is_node:
            return state, (i, program if client.hands_over else NOBODY)
        open_ones = state.asked[i].requests
        number = max((one for one, _ in open_ones), default=-1) + 1
        kept = () if state.asked[i].overdue else open_ones
        return self.with_asked(state, i, Asked((*kept, (number, False)))), (i, number)

    @staticmethod
    def with_asked(state: Rest, i: int, asked: Asked) -> Rest:
        """The state with other open requests of one client."""
        return state._replace(asked=state.asked[:i] + (asked,) + state.asked[i + 1 :])

    def timed_out(self, state: Rest, program: int) -> Rest:
        """The state after the time-out of a `select` that waited for answers to a program."""
        i = self.client_of[program]
        is_overdue = bool(state.asked[i].requests)
        return self.with_asked(state, i, state.asked[i]._replace(overdue=is_overdue))

    def tidied(self, state: Rest) -> Rest:
        """The state with as few open requests, and as small numbers, as make a difference."""
        for i in range(len(self.clients)):
            if not self.clients[i].is_node:
                state, names = self.worth_keeping(state, i, self.names(state, i))
                if any(old != new for old, new in names.items()):
                    state = self.renamed(state, i, names)
        return state

    def worth_keeping(self, state: Rest, i: int, answerable: set) -> tuple[Rest, dict]:
        """The state with those open requests of a program that make a difference, and the new names
        of all. Behind one that can never be answered nothing can be received: the last request
        alone can still be waited for."""
        requests = state.asked[i].requests
        lost = next(
            (at for at, (one, kept) in enumerate(requests) if not kept and one not in answerable),
            len(requests),
        )
        requests = requests[: lost + 1] + requests[lost + 1 :][-1:]
        names: dict = {who: NOBODY for who in answerable if isinstance(who, int)}
        names |= {one: at for at, (one, _) in enumerate(requests)}
        numbered = tuple((at, kept) for at, (_, kept) in enumerate(requests))
        return self.with_asked(state, i, state.asked[i]._replace(requests=numbered)), names

    def requested(self, state: Rest, request: tuple) -> Rest:
        """The state after a request came to the server."""
        if not self.takes_requests(state):
            return state
        if state.server == WAITS:
            return state._replace(server=request)
        return state._replace(requests=self.kept(state.requests + (request,)))

    def slot(self, program: int) -> int:
        """Where it is kept what this program served."""
        return self.slots.index(program) if self.slots else 0

    def with_served(self, state: Rest, program: int, request: tuple | None) -> Rest:
        """The state after a program served a request, or answered it."""
        at = self.slot(program)
        return state._replace(served=state.served[:at] + (request,) + state.served[at + 1 :])

    def answered(self, state: Rest, program: int) -> Rest:
        """The state after the request that was served last was answered, to all clients."""
        asking, who = state.served[self.slot(program)]
        state = self.with_served(state, program, None)
        for i, client in enumerate(state.clients):
            if client is not None:
                state = self.reached(state, i, who if i == asking else STRANGER)
        return state

    def reached(self, state: Rest, i: int, entry: Any) -> Rest:
        """The state after an answer came to a client."""
        answers, stands = state.clients[i]
        answers = self.kept(answers + (entry,))
        state = self.with_client(state, i, answers, stands)
        return self.received(state, i) if stands == WAITS else state

    def received(self, state: Rest, i: int) -> Rest:
        """The state after a program looked for the answer to its oldest open request: those to its
        other open ones are kept, and what is in front of it is thrown away."""
        asked, queue = state.asked[i], state.clients[i][0]
        oldest, kept = asked.requests[0] if asked.requests else (None, False)
        while not kept and queue:
            who, queue = queue[0], queue[1:]
            kept = who == oldest
            asked = asked.with_kept(who)
        if kept:
            asked = asked.without_oldest()
        state = self.with_client(state, i, queue, DUE if kept else WAITS)
        return self.with_asked(state, i, asked)

    def last_received(self, state: Rest, i: int) -> Rest | None:
        """The state after a program took the answer to its last request, and gave up all others;
        None if it is not there."""
        requests, queue = state.asked[i].requests, state.clients[i][0]
        if not requests:
            return None
        last, kept = requests[-1]
        if not kept and last not in queue:
            return None
        queue = queue if kept else queue[queue.index(last) + 1 :]
        state = self.with_asked(state, i, Asked())
        return self.with_client(state, i, queue, FREE)

    @staticmethod
    def own_answers(answers: tuple) -> tuple:
        """The queue from its first answer that is not a stranger's."""
        while answers and answers[0] == STRANGER:
            answers = answers[1:]
        return answers

    # --- what programs do

    def give(self, state: Rest, program: int, action: Action) -> tuple[list, bool]:
        """The states after an input."""
        requests, server, served, clients, _, _ = state
        name = action[0]
        after = None
        if action[1]:
            return [], False
        if name == "send" and server in (FREE, WAITS):
            after = self.sent(state, program)
        elif name == "serve" and server == FREE and requests is not None:
            if requests:
                after = state._replace(requests=requests[1:], server=requests[0])
            else:
                after = state._replace(server=WAITS)
        elif name == "answer" and served[self.slot(program)] is not None:
            if all(client is None or client[1] != DUE for client in clients):
                after = self.answered(state, program)
        elif name == "receive":
            i = self.client_of[program]
            if clients[i] is not None and clients[i][1] == FREE:
                after = self.received(state, i)
        return [] if after is None else [(after, self.event(program, "?", name))], False

    def due(self, state: Rest, program: int) -> list:
        """What the program may take."""
        found: list = []
        if program in self.server and state.server not in (FREE, WAITS):
            event = self.event(program, "!", "request")
            after = self.with_served(state._replace(server=FREE), program, state.server)
            found.append((("request", ()), after, event))
        i = self.client_of.get(program)
        if i is not None and state.clients[i] is not None:
            answers, stands = state.clients[i]
            after = None
            if stands == DUE:
                after = self.with_client(state, i, answers, FREE)
                after = self.with_asked(after, i, after.asked[i].after_taking())
            elif stands == FREE:
                after = self.last_received(state, i)
            elif self.clients[i].is_node and program in stands:
                after = self.with_client(state, i, answers, stands - {program})
            if after is not None:
                found.append((("answer", ()), after, self.event(program, "!", "answer")))
        return found

    def pick(self, state: Rest, program: int, action: Action) -> tuple[list, bool]:
        """Input and output in one step."""
        expected = {"serve": "request", "receive": "answer"}.get(action[0])
        found = []
        for middle, event in self.give(state, program, action)[0]:
            for output, after, other in self.due(middle, program):
                if output[0] == expected:
                    found.append((output, after, (event, other)))
        return found, False

    def quiet(self, state: Rest, program: int, name: str, is_input: bool) -> bool:
        """Whether nothing is due where this belongs: at the server, or at the clients."""
        if name in ("send", "serve", "request"):
            return state.server in (FREE, WAITS)
        if name == "receive" or not is_input:
            i = self.client_of[program]
            if state.clients[i] is None:
                return True
            stands = state.clients[i][1]
            return program not in stands if self.clients[i].is_node else stands != DUE
        return all(client is None or client[1] != DUE for client in state.clients)

    def clients_among(self, programs: frozenset[int]) -> set[int]:
        """The clients that these programs are."""
        return {self.client_of[p] for p in programs if p in self.client_of}

    def died(self, state: Rest, programs: frozenset[int]) -> tuple[list, bool]:
        """The states after programs died."""
        for i in self.clients_among(programs):
            state = self.renamed(state, i, dict.fromkeys(self.names(state, i), STRANGER))
            state = self.with_asked(self.with_clients(state, i, None), i, Asked())
        if programs & self.server:
            state = state._replace(
                requests=None,
                server=FREE,
                served=(None,) * len(state.served),
            )
        return [state], False

    def reborn(self, state: Rest, programs: frozenset[int], is_there: bool) -> Rest:
        """The state after programs that had died began anew; `is_there` as in the beginning."""
        for i in self.clients_among(programs):
            at_first = ((), frozenset() if self.clients[i].is_node else FREE)
            state = self.with_clients(state, i, at_first)
        if programs & self.server:
            state = state._replace(requests=(), there=is_there)
        return state

    @staticmethod
    def with_clients(state: Rest, i: int, client: tuple | None) -> Rest:
        """The state with something else of one client."""
        return state._replace(clients=state.clients[:i] + (client,) + state.clients[i + 1 :])

    def away(self, state: Rest) -> Rest:
        """The state after it was found out that the server is gone."""
        return state._replace(there=False)

    def gone(self, state: Rest) -> Rest | None:
        """The state after it was found out that the server died; None if there is nothing to find
        out, or nobody asks."""
        is_found_out = self.is_watched and state.requests is None and state.there
        return state._replace(there=False) if is_found_out else None

    # --- what the executor of a node does

    def has_request(self, state: Rest) -> bool:
        """Whether there is something for the callback of a server."""
        return bool(state.requests)

    def served_by(self, state: Rest, program: int) -> tuple[Rest, tuple]:
        """The state after a callback took the oldest request, and the events."""
        request, rest = state.requests[0], state.requests[1:]
        events = (self.event(program, "?", "serve"), self.event(program, "!", "request"))
        return self.with_served(state._replace(requests=rest), program, request), events

    def is_found(self, state: Rest, i: int) -> bool:
        """Whether a look finds something for a client: over its queue, whosever the answers."""
        return bool(state.clients[i][0])

    def takes_others(self, state: Rest, i: int) -> Rest | None:
        """The state after a client's turn in a round in which it takes no answer of its own; None
        if it takes one, or there is nothing."""
        answers, stands = state.clients[i]
        if not self.clients[i].looked_at or not answers or self.has_answer(state, i):
            return None
        return self.with_client(state, i, answers[1:] if self.one_by_one else (), stands)

    def has_answer(self, state: Rest, i: int) -> bool:
        """Whether there is something for the callback of a client."""
        answers = state.clients[i][0]
        if self.clients[i].looked_at and self.one_by_one:
            return answers[:1] not in ((), (STRANGER,))
        return bool(self.own_answers(answers))

    def received_by(self, state: Rest, i: int, program: int) -> tuple[Rest, tuple]:
        """The state after a client's callback took its oldest own answer, and the events."""
        answers, over = state.clients[i]
        answers = self.own_answers(answers)
        events = [self.event(program, "?", "receive")]
        if self.clients[i].has_code:
            events.append(self.event(program, "!", "answer"))
        if self.clients[i].hands_over and answers[0] != NOBODY:
            over = over | {answers[0]}
        return self.with_client(state, i, answers[1:], over), tuple(events)
