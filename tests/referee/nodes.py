"""Nodes and executors: what they are in the file, and the programs that they stand for.

Each copy of a callback is a program that stands at its start until it is started. An executor with
rounds is a program, too, which looks, and takes a client's turn if its answers are to others. Which
callbacks run, and what is left of the last look, is the state of the executor, among those of the
models (turns.py). The copies of threads are programs like callbacks; which of them are asked or run
is the state of a pool. Start code and that of `main:` are programs, too (spinning.py).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

from control import Node
from deliveries import AT_ONCE
from expressions import Mistake, Scope, Variable, evaluate
from language import Parser, Refused, parse_expression, parse_program
from machine import Control, Program, Step, World
from turns import (
    DEAD,
    ENDED,
    ERRED,
    LOOK,
    NOBODY,
    USUAL,
    Turn,
    is_answered,
    is_looking,
    is_spun,
    passed,
    statement_of,
    with_one_less,
    with_one_more,
)

KINDS = ("timer", "takes", "serves", "client")  # in this order in a round


@dataclass(eq=False)
class CallbackText:
    """A callback, start code, the code of `main:` or a thread, as the file says it, in one node of
    an array."""

    node: NodeText
    name: str
    kind: str  # one of KINDS, "start", "main" or "thread"
    what: Any  # the input or output that it takes; the service's (name, indices)
    arms: list  # [(pattern or None, statements)]
    group: tuple[str, bool]  # its name, and whether it is exclusive
    scope: Scope
    numbers: list[int] = field(default_factory=list)  # its copies, as programs
    has_code: bool = False  # of a client: it takes the answers, and hands none over
    when: Any = None  # the expression that must be true where it starts
    come: Variable | None = None  # of a timer that comes once: whether it has come

    def full_name(self) -> str:
        """`detector.on_image`."""
        return f"{self.node.full_name}.{self.name}"


@dataclass(eq=False)
class NodeText:
    """A node, one of an array perhaps."""

    name: str
    index: tuple
    full_name: str
    executor: Executor
    scope: Scope
    callbacks: list[CallbackText] = field(default_factory=list)
    variables: list[Variable] = field(default_factory=list)
    start: CallbackText | None = None
    main: CallbackText | None = None  # of its executor, whose first node it is
    pools: list[Pool] = field(default_factory=list)

    def codes(self) -> list[CallbackText]:
        """All its code."""
        starts = [self.start] if self.start is not None else []
        mains = [self.main] if self.main is not None else []
        return self.callbacks + starts + [pool.text for pool in self.pools] + mains

    def numbers(self) -> frozenset[int]:
        """The programs that it stands for."""
        return frozenset(n for code in self.codes() for n in code.numbers)


class Pool:
    """The copies of a thread; the state says of each whether it is asked or runs."""

    models: list = []
    weak = False
    standing: set = set()

    def __init__(self, text: CallbackText, count: int) -> None:
        self.text = text
        self.count = count
        self.is_run = False  # whether a `run` names it: else it is asked at the begin
        self.use = -1  # its number among the models

    @property
    def initial(self) -> tuple:
        """At first all are free, or asked."""
        return (not self.is_run,) * self.count

    def with_one_more(self, busy: tuple) -> tuple | None:
        """The state after the first free copy was asked; None if there is none."""
        if all(busy):
            return None
        return self.with_copy(busy, busy.index(False), True)

    @staticmethod
    def with_copy(busy: tuple, copy: int, is_busy: bool) -> tuple:
        """The state with another value for one copy."""
        return busy[:copy] + (is_busy,) + busy[copy + 1 :]

    def died(self, state: tuple, programs: frozenset[int]) -> tuple[list, bool]:
        """The state after these died: no copy runs any more."""
        return [(False,) * self.count if self.text.numbers[0] in programs else state], False


class Executor:
    """An executor, at which the start code of its first node, or `main:`, runs at first."""

    models: list = []
    weak = False
    standing: set = set()

    def __init__(self, name: str, threads: int, rounds: bool) -> None:
        self.name = name
        self.threads = threads
        self.rounds = rounds
        self.process: str | None = None
        self.may_die = False
        self.may_restart: Any = None
        self.callbacks: list[CallbackText] = []  # in the order of a round
        self.main: str | None = None  # the code in place of the endless loop
        self.starts: list[int] = []  # the programs of start code in their order, then of `main:`
        self.use = -1  # its number among the models
        self.nodes: list[NodeText] = []
        self.is_of_file = False  # else it is one node's

    def numbers(self) -> frozenset[int]:
        """All programs that stand for its nodes."""
        return frozenset().union(*(node.numbers() for node in self.nodes))

    @property
    def initial(self) -> Turn:
        """No callback runs, and nothing was looked at."""
        return Turn(tuple(self.starts[:1]), (), NOBODY if self.starts else USUAL)

    def died(self, state: Turn, programs: frozenset[int]) -> tuple[list, bool]:
        """The state after these died: no turn comes any more. Where `main:` runs it cannot be told
        from one that ended."""
        if not self.numbers() & programs:
            return [state], False
        left = () if state.left == LOOK else state.left
        over = (), left, ENDED
        return [Turn(*over) if self.main is not None else Turn(DEAD, state.left, NOBODY)], False


def executor_of(name: str, description: dict, number: Any) -> Executor:
    """The executor that an entry of the file describes."""
    kind = description.get("kind", "single")
    keys = {"kind", "threads", "order", "process", "may_die", "may_restart", "main"}
    if not set(description) <= keys or kind not in ("single", "multi"):
        raise Refused(f"executor {name}: {description}")
    order = description.get("order", "any")
    if order not in ("any", "rounds") or kind == "multi" and "order" in description:
        raise Refused(f"executor {name}: order {order}")
    if (kind == "multi") != ("threads" in description):
        raise Refused(f"executor {name}: threads stand at 'multi', and only there")
    threads = number(description["threads"]) if kind == "multi" else 1
    if threads < 1:
        raise Refused(f"executor {name}: {threads} threads")
    executor = Executor(name, threads, order == "rounds")
    executor.is_of_file = True
    executor.process = description.get("process")
    executor.may_die = description.get("may_die", False)
    executor.may_restart = description.get("may_restart")
    executor.main = description.get("main")
    if executor.main is not None and threads > 1:
        raise Refused(f"executor {name}: 'main' stands at one of one thread")
    return executor


def parse_taken(text: str, origin: str) -> dict:
    """What a callback takes: `m.input`, `m.input -> output` or `m!output`."""
    parser = Parser(text, origin)
    model = parser.reference()
    if parser.accept("!"):
        taken = {"model": model, "input": None, "arguments": [], "pattern": parser.pattern()}
    else:
        taken = parser.given(model)
        taken["pattern"] = parser.pattern() if parser.accept("->") else None
    parser.end()
    return taken


def parse_pattern(text: str, origin: str) -> tuple:
    """An output with what it binds."""
    parser = Parser(str(text), origin)
    pattern = parser.pattern()
    parser.end()
    return pattern


def callback_of(node: NodeText, name: str, description: dict, groups: dict) -> CallbackText:
    """The callback that an entry of a node describes."""
    origin = f"callback {node.name}.{name}"
    kinds = [kind for kind in KINDS if kind in description]
    if len(kinds) != 1 or not set(description) <= {kinds[0], "group", "do", "when"}:
        raise Refused(f"{origin}: it takes, serves or has a timer")
    kind = kinds[0]
    if kind == "client" and "when" in description:
        raise Refused(f"{origin}: no 'when' at a client")
    group = group_of(description.get("group"), groups, origin)
    what, pattern = description[kind], None
    if kind == "takes":
        what = parse_taken(what, origin)
        pattern = what["pattern"]
    elif kind == "serves":
        what = Parser(what, origin).reference()
    if "do" not in description:
        raise Refused(f"{origin}: no 'do'")
    code = description["do"]
    if isinstance(code, dict):
        if kind != "takes" or pattern is not None:
            raise Refused(f"{origin}: only what it takes can have outcomes")
        arms = [
            (parse_pattern(output, origin), parse_program(text, f"{origin} {output}"))
            for output, text in code.items()
        ]
    else:
        arms = [(pattern, parse_program(code, origin))]
    callback = CallbackText(node, name, kind, what, arms, group, Scope(node.scope))
    if "when" in description:
        text = description["when"]
        text = str(text).lower() if isinstance(text, bool) else text
        callback.when = parse_expression(text, f"{origin}, when")
    if kind == "timer" and str(what).split()[:1] == ["once"]:
        callback.come = Variable(f"{origin} has come", ("bool",), stays=True, initial=False)
    return callback


def start_of(node: NodeText, text: str, kind: str = "start") -> CallbackText:
    """The start code of a node, or the code of its executor's `main:`."""
    arms = [(None, parse_program(text, f"callback {node.name}.{kind}"))]
    return CallbackText(node, kind, kind, None, arms, ("", True), Scope(node.scope))


def pool_of(node: NodeText, name: str, description: Any, number: Any) -> Pool:
    """The copies of a thread that an entry of a node describes."""
    origin = f"callback {node.name}.{name}"
    count = 1
    if isinstance(description, dict):
        if not set(description) <= {"count", "do"} or "do" not in description:
            raise Refused(f"{origin}: {description}")
        count, description = number(description.get("count", 1)), description["do"]
    if count < 1:
        raise Refused(f"{origin}: {count} copies")
    arms = [(None, parse_program(description, origin))]
    text = CallbackText(node, name, "thread", None, arms, ("", False), Scope(node.scope))
    return Pool(text, count)


def group_of(name: str | None, groups: dict, origin: str) -> tuple[str, bool]:
    """The group, and whether it is exclusive; a node has one of its own."""
    if name is None:
        return ("", True)
    if name not in groups or groups[name] not in ("exclusive", "reentrant"):
        raise Refused(f"{origin}: no group {name}")
    return (name, groups[name] == "exclusive")


def can_run_together(one: CallbackText | None, other: CallbackText | None) -> bool:
    """Whether two programs, copies of callbacks where given, can run at the same time."""
    if one is None or other is None or one.node.executor is not other.node.executor:
        return True
    if one is other and len(one.numbers) == 1:
        return False
    if "thread" in (one.kind, other.kind):
        return True
    if {"start", "main"} & {one.kind, other.kind}:  # on several threads it is a program of its own
        return one.node.executor.threads > 1 and one.kind != other.kind
    same_group = one.node is other.node and one.group == other.group and one.group[1]
    return one.node.executor.threads > 1 and not same_group


class NodeProgram(Program):
    """Code of a node: it is started, runs and ends."""

    def __init__(
        self, system: Any, number: int, text: CallbackText, nodes: list[Node], first: Node
    ) -> None:
        super().__init__(system, number, text.node.full_name, nodes, first)
        self.text = text
        self.part = text.full_name()
        self.executor = text.node.executor
        self.stays = tuple(v for v in self.end.scope if v.stays)

    # --- variables that stay between runs

    def values_at(self, node: Node, control: Control, world: World) -> dict:
        values = super().values_at(node, control, world)
        for variable in self.stays:
            values[variable] = world[1][self.system.shared.index(variable)]
        return values

    def settled(self, control: Control, world: World) -> tuple[Control, World]:
        if control[0] == "error":
            return control, self.without_locals(world)
        scope, values, kept = self.nodes[control[0]].scope, list(control[2]), list(world[1])
        for variable in self.stays:
            at = scope.index(variable)
            kept[self.system.shared.index(variable)] = values[at]
            values[at] = None
        return (*control[:2], tuple(values), *control[3:]), (world[0], tuple(kept))

    def mistake(
        self, label: tuple, place: Any, why: Any, world: World, **more: Any
    ) -> Step:
        return super().mistake(label, place, why, self.without_locals(world), **more)

    def without_locals(self, world: World) -> World:
        """The world without what an error drops: the local variables of all callbacks that run in
        turn with this one, and what is left of the last look. An error in a thread drops its own
        variables alone."""
        kept = list(world[1])
        for at, variable in enumerate(self.system.shared):
            users = [self.system.texts[n].callback for n in variable.users]
            if variable.stays and not can_run_together(users[0], self.text):
                kept[at] = None
        if self.text.kind == "thread":
            return (world[0], tuple(kept))
        turn = world[0][self.executor.use]._replace(left=(), spin=ERRED)
        return self.with_model((world[0], tuple(kept)), self.executor.use, turn)

    def start(self) -> Control:
        """It stands at its start."""
        return (self.first.number, frozenset(), (None,) * len(self.first.scope), None)

    def dead(self, control: Control, world: World, has_lives: bool, is_over: bool) -> Control:
        """The control state after its process died."""
        return self.start()

    def rests(self, control: Control) -> bool:
        """Whether a copy that has started may stand here for ever."""
        return super().rests(control) or control[0] == self.first.number

    def released(self, world: World) -> World:
        """The world after a run ended: nobody waits for what it asked for."""
        for number, use in enumerate(self.system.uses):
            if hasattr(use, "forgotten"):
                state = use.forgotten(world[0][number], self.number)
                world = self.with_model(world, number, state)
        return world


class Thread(NodeProgram):
    """A copy of a thread."""

    @cached_property
    def pool(self) -> Pool:
        """The copies."""
        return next(pool for pool in self.text.node.pools if pool.text is self.text)

    def steps_start(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        if not world[0][self.pool.use][self.text.numbers.index(self.number)]:
            return []
        return [self.step(("start",), node.arms[0][1], values, world)]

    def steps_finish(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        world = self.released(world)
        copy = self.text.numbers.index(self.number)
        busy = self.pool.with_copy(world[0][self.pool.use], copy, False)
        world = self.with_model(world, self.pool.use, busy)
        return [self.step(("end",), self.first, values, world)]


class Callback(NodeProgram):
    """A copy of a callback."""

    def __init__(
        self, system: Any, number: int, text: CallbackText, nodes: list[Node], first: Node
    ) -> None:
        super().__init__(system, number, text, nodes, first)
        self.first_of_callback = number == text.numbers[0]

    # --- the start and the end

    def takes(self, world: World) -> tuple[list, bool]:
        """What there is for it: [(output or None, model's number, its state, events)], cut."""
        kind, models = self.text.kind, world[0]
        if self.is_over(world):
            return [], False
        if kind == "timer":
            return [] if self.has_come(world) else [(None, None, None, ())], False
        if kind == "takes":
            number = self.model(self.first.model, lambda v: None)
            use, state = self.system.uses[number], models[number]
            if self.first.input is None:
                due = use.due(state, self.number)
                due = [one for one in due if self.matched(self.first.arms, one[0], {})]
                return [(out, number, after, (event,)) for out, after, event in due], False
            given = (self.first.input, self.first.arguments)
            if not self.first.has_outputs:
                after_all, cut = use.give(state, self.number, given)
                return [(None, number, after, (event,)) for after, event in after_all], bool(cut)
            picked, cut = use.pick(state, self.number, given)
            return [(out, number, after, events) for out, after, events in picked], bool(cut)
        number = self.first.model
        service, state = self.system.uses[number], models[number]
        if kind == "serves":
            if not service.has_request(state):
                return [], False
            return [(None, number, *service.served_by(state, self.number))], False
        i = service.client_of[self.number]
        if not service.has_answer(state, i):
            return [], False
        return [(None, number, *service.received_by(state, i, self.number))], False

    def is_over(self, world: World) -> bool:
        """Whether it can never start any more: its executor is dead, what ran on it has ended, or
        the start code of another node spins for ever."""
        turn = world[0][self.executor.use]
        if turn.running == DEAD or turn.spin == ENDED:
            return True
        statement = statement_of(self.system, turn)
        is_for_ever = statement is not None and statement.mode == "forever"
        return is_for_ever and not is_spun(self.system, turn, self.text)

    def has_come(self, world: World) -> bool:
        """Whether it is a timer that comes once, and has come."""
        come = self.text.come
        return come is not None and world[1][self.system.shared.index(come)]

    def may_start(self, world: World) -> bool:
        """Whether its `when` is true; one that fails is found out by the start."""
        if self.first.when is None:
            return True
        values = self.values_at(self.first, self.start(), world)
        try:
            return bool(evaluate(self.first.when, self.reader(values, world)))
        except Mistake:
            return True

    def has_something(self, world: World) -> bool:
        """Whether there is something for it that it may take."""
        return self.is_found_there(world) and self.may_start(world)

    def is_found_there(self, world: World) -> bool:
        """Whether there is something for it."""
        found, cut = self.takes(world)
        return bool(found) or cut

    def is_found(self, world: World) -> bool:
        """Whether a look finds it: a client by any answer, whosever it is."""
        if self.text.kind != "client":
            return self.is_found_there(world)
        if self.is_over(world):
            return False
        service = self.system.uses[self.first.model]
        return service.is_found(world[0][self.first.model], service.client_of[self.number])

    def after_start(self, world: World) -> World | None:
        """The world after it got a thread; None if it cannot start."""
        executor = self.executor
        turn = world[0][executor.use]
        running, left, _ = turn
        if not is_spun(self.system, turn, self.text) or is_answered(self.system, turn, world):
            return None
        if len(running) >= (executor.threads if turn.spin == USUAL else 1) or left == LOOK:
            return None
        if next(n for n in self.text.numbers if n not in running) != self.number:
            return None
        if self.text.group[1]:
            for other in running:
                text = self.system.texts[other].callback
                if text.node is self.text.node and text.group == self.text.group:
                    return None
        if isinstance(left, Looking):
            return None
        if executor.rounds:
            at = next_of(self.system, left, world)
            if at is None or left[at] != self.text.numbers[0]:
                return None
            left = left[at + 1 :]
        elif is_looking(statement_of(self.system, turn)):
            if self.text.numbers[0] not in left:
                return None
            left = tuple(number for number in left if number != self.text.numbers[0])
        turn = with_one_more(self.system, turn, self.number, left)
        world = self.with_model(world, executor.use, turn)
        if self.text.come is None:
            return world
        return (world[0], self.stored(world[1], self.text.come, [], True))

    def steps_start(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        running = world[0][self.executor.use].running
        if all(n in running for n in self.text.numbers):
            return []
        started = self.after_start(world)
        if started is None or not self.may_start(world):
            return []
        ways, cut = self.takes(world)
        if node.when is not None and (ways or cut):
            try:
                evaluate(node.when, self.reader(values, world))
            except Mistake as mistake:
                return [self.mistake(("start",), node.place, mistake, started)]
        found = []
        for output, number, state, events in ways:
            after = started if number is None else self.with_model(started, number, state)
            label = ("start", output)
            if output is None:
                found.append(self.step(label, node.arms[0][1], values, after, events=events))
                continue
            step = self.took(label, node.place, node.arms, output, values, after, events=events)
            if step is None:
                why = f"no arm for {output}"
                step = self.mistake(label, node.place, why, after, events=events)
            found.append(step)
        return found + self.cuts(("start",), cut)

    def steps_finish(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        if self.keeps_a_lock(world):
            return self.cuts(("end",), True)
        use = self.executor.use
        turn = with_one_less(self.system, world[0][use], self.number)
        world = self.released(self.with_model(world, use, turn))
        return [self.step(("end",), self.first, values, world)]

    def keeps_a_lock(self, world: World) -> bool:
        """Whether it holds a recursive mutex on several threads, of which nobody knows which runs
        the next callback."""
        return self.executor.threads > 1 and any(
            hasattr(use, "is_kept_by") and use.is_kept_by(state, self.number)
            for use, state in zip(self.system.uses, world[0])
        )


def next_of(system: Any, left: tuple, world: World) -> int | None:
    """Which of what a look found is started next: the first that has something and may start."""
    for at, number in enumerate(left):
        program = system.programs[number]
        if program.is_found(world) and program.may_start(world):
            return at
    return None


class Looking(NamedTuple):
    """In place of what is left of a look: it goes on."""

    asked: int  # for how many it has asked
    found: tuple


class AtExecutor:
    """What happens at an executor besides the code of its callbacks, as a program."""

    first_of_callback = False
    part = None

    def __init__(self, system: Any, number: int, executor: Executor) -> None:
        self.system = system
        self.number = number
        self.name = None
        self.executor = executor

    def start(self) -> Control:
        """It is always at the same place."""
        return ("awaits",)

    def begun(self, world: World) -> tuple[Control, World]:
        """The control state at first, and the world."""
        return self.start(), world

    def dead(self, control: Control, world: World, has_lives: bool, is_over: bool) -> Control:
        """The control state after its process died."""
        return control

    def called(self, control: Control, world: World) -> tuple[Control, World]:
        """It makes no calls."""
        return control, world

    def rests(self, control: Control) -> bool:
        """It need not happen."""
        return True


class Look(AtExecutor):
    """An executor that looks."""

    def steps(self, control: Control, world: World) -> list[Step]:
        """A look, for each set of timers that may be due."""
        turn = world[0][self.executor.use]
        left = turn.left
        if turn.running or turn.spin in (NOBODY, ENDED, ERRED) or left == LOOK:
            return []
        if isinstance(left, Looking):
            return [self.asked(control, world, left.asked, left.found, ("asks",))]
        statement = statement_of(self.system, turn)
        at = next_of(self.system, left, world)
        if at is not None:
            behind = passed(statement, turn._replace(left=left[at + 1 :]).moved())
            return self.turn_for_nobody(control, world, left[at], behind)
        if is_looking(statement):
            return []
        there = [c for c in self.executor.callbacks if self.is_there(c, world)]
        timers = [c for c in there if c.kind == "timer"]
        found = []
        for due in itertools.product((False, True), repeat=len(timers)):
            is_due = dict(zip(timers, due))
            seen = tuple(c.numbers[0] for c in there if is_due.get(c, True))
            if not seen:
                continue
            if self.one_by_one:
                first = tuple(c.numbers[0] for c in timers if is_due[c])
                label = ("look", due)
                found.append(self.asked(control, world, 0, first, label, arm=label))
                continue
            after = Program.with_model(world, self.executor.use, turn._replace(left=seen).moved())
            found.append(Step(self.number, ("look", due), control, after, arm=("look", due)))
        return found

    @cached_property
    def one_by_one(self) -> list[CallbackText]:
        """In which order a look asks for one after the other; none where it asks for all at once."""
        order = []
        is_fast_dds = is_late = False
        for kind in ("takes", "client", "serves"):
            for callback in self.executor.callbacks:
                if callback.kind != kind:
                    continue
                order.append(callback)
                program = self.system.programs[callback.numbers[0]]
                number = program.model(program.first.model, lambda v: None) if kind == "takes" else (
                    program.first.model
                )  # fmt: skip
                use = self.system.uses[number]
                wires = getattr(use, "wires", [])
                if kind == "takes":
                    box = use.reader_of[program.number] if hasattr(use, "reader_of") else 0
                    models = getattr(use, "models", None) or [use.model]
                    words = models[box].sul.split()
                    is_fast_dds |= words[:1] == ["ros2"] and "rmw=fastrtps" in words
                    wires = [wire for wire in wires if wire.box == box]
                else:
                    is_fast_dds |= use.one_by_one
                is_late |= any(wire.delivery != AT_ONCE for wire in wires)
        return order if is_fast_dds and is_late else []

    def asked(
        self, control: Control, world: World, number: int, found: tuple, label: tuple, **more: Any
    ) -> Step:
        """The step in which a look asks for one more."""
        callback = self.one_by_one[number]
        if self.is_there(callback, world):
            found = (*found, callback.numbers[0])
        turn = world[0][self.executor.use]
        state: Any = Looking(number + 1, found)
        if number + 1 == len(self.one_by_one):
            order = [c.numbers[0] for c in self.executor.callbacks]
            state = tuple(sorted(found, key=order.index))
        after = Program.with_model(world, self.executor.use, turn._replace(left=state).moved())
        return Step(self.number, label, control, after, **more)

    def turn_for_nobody(
        self, control: Control, world: World, number: int, behind: Turn
    ) -> list[Step]:
        """The turn of a client whose answers are to others: it takes them, and nothing runs."""
        program = self.system.programs[number]
        if program.text.kind != "client":
            return []
        use = program.first.model
        service = self.system.uses[use]
        state = service.takes_others(world[0][use], service.client_of[number])
        if state is None:
            return []
        after = Program.with_model(world, use, state)
        after = Program.with_model(after, self.executor.use, behind)
        return [Step(self.number, ("discard", number), control, after)]

    def is_there(self, callback: CallbackText, world: World) -> bool:
        """Whether there is something for a callback that has turns."""
        if not is_spun(self.system, world[0][self.executor.use], callback):
            return False
        return self.system.programs[callback.numbers[0]].is_found(world)
