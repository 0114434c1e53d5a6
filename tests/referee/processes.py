"""Processes: what dies in one step, and begins anew.

A process is what has one `process:` name, or an executor with all its nodes, or a program. All of
it dies, or begins anew, in one step: the control of its programs and what stands in the state of
the others for it. The variables, models and topics that it alone uses are as at first from its
death on. One that dies by itself alone, for ever, leaves them as they are.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import Any, NamedTuple

from language import Refused, Statement
from locks import Condition, Mutex
from machine import Program, Step, World
from nodes import Executor, Pool
from services import Service
from turns import DEAD, ENDED
from use import Instance, Topic

MOST_LIVES = 100
KILLS = ("kill", "restart")


class Life(NamedTuple):
    """The state of a process."""

    is_dead: bool = False
    left: int = 0  # how often it begins anew by itself
    is_wanted: bool = False  # it begins anew, as somebody said


class Process:
    """A process; its state is a `Life`, or None where it makes no difference."""

    models: list = []
    weak = False
    standing: set = set()

    def __init__(self, system: Any, key: Any) -> None:
        self.system = system
        self.key = key
        self.may_die = False
        self.most = 0  # how often it begins anew by itself
        self.is_named = False  # a statement kills it, or lets it begin anew
        self.is_restarted = False
        self.ends_itself = False
        self.programs: list[int] = []
        self.executors: list[Executor] = []
        self.use = -1  # its number among the models

    # --- what the file says of it

    def add(self, may_die: bool, may_restart: Any) -> None:
        """Notes what stands at one of its programs or executors."""
        self.may_die |= may_die
        if may_restart is None or may_restart is False:
            return
        most = 1 if may_restart is True else may_restart
        if not isinstance(most, int) or not 1 <= most <= MOST_LIVES:
            raise Refused(f"may_restart: {may_restart}")
        self.most = max(self.most, most)

    def check(self) -> None:
        """Refuses what begins anew and never dies."""
        if self.most and not self.is_mortal:
            raise Refused("'may_restart' stands beside 'may_die', or where something is killed")

    @property
    def is_mortal(self) -> bool:
        """Whether it dies on some run."""
        return self.may_die or self.is_named or self.ends_itself

    def may_begin_anew(self, life: Life | None) -> bool:
        """Whether it may have another life behind this one."""
        return self.is_restarted or life is not None and life.left > 0

    @property
    def initial(self) -> Life | None:
        """It lives."""
        is_alone = len(self.programs) + len(self.executors) == 1
        is_told = self.most or self.is_named or self.ends_itself
        has_threads = any(
            one.threads > 1 or any(node.pools for node in one.nodes) for one in self.executors
        )
        return Life(left=self.most) if not is_alone or is_told or has_threads else None

    def died(self, state: Any, programs: frozenset[int]) -> tuple[list, bool]:
        """Its death is told below."""
        return [state], False

    # --- what belongs to it

    @cached_property
    def members(self) -> frozenset[int]:
        """All its programs, those of its nodes among them."""
        return frozenset(self.programs).union(*(one.numbers() for one in self.executors))

    @cached_property
    def own_variables(self) -> list[int]:
        """Which of the variables in the state it alone uses."""
        shared = self.system.shared
        return [k for k, v in enumerate(shared) if v.users and v.users <= self.members]

    @cached_property
    def own_models(self) -> list[int]:
        """The models and topics that it alone uses."""
        found = []
        for k in self.system.numbers.values():
            use = self.system.uses[k]
            if isinstance(use, (Instance, Mutex, Condition, Topic)):
                users = {p for p, used in enumerate(self.system.models_of) if k in used}
                if users and users | set(use.standing) <= self.members:
                    found.append(k)
        return found

    @cached_property
    def parts(self) -> list[int]:
        """The executors and pools among the models."""
        found = []
        for k, use in enumerate(self.system.uses):
            is_own = isinstance(use, Executor) and use in self.executors
            if is_own or isinstance(use, Pool) and use.text.node.executor in self.executors:
                found.append(k)
        return found

    # --- steps of nobody

    def steps(self, numbers: list[int], controls: tuple, world: World) -> Iterator[Step]:
        """Its death, where it may die at any time, or that it begins anew."""
        life = world[0][self.use]
        if life is not None and life.is_dead:
            if life.is_wanted or life.left:
                yield self.new_life(numbers, controls, world)
            return
        if not self.may_die or life is None and self.has_ended(numbers, controls, world):
            return
        who = ("process", self.use)
        ways, cut = self.after_death(numbers, controls, world, "dies")
        for after, world_after in ways:
            also = self.changed(numbers, after)
            yield Step(who, ("dies",), None, world_after, also=also, death=True)
        if cut:
            yield Step(who, ("dies",), cut=True, death=True)

    def changed(self, numbers: list[int], controls: tuple) -> tuple:
        """The new control of its programs."""
        return tuple((n, control) for n, control in zip(numbers, controls) if n in self.members)

    def has_ended(self, numbers: list[int], controls: tuple, world: World) -> bool:
        """Whether its program, or what runs on its executor, has ended."""
        turns = [world[0][executor.use] for executor in self.executors if executor.use >= 0]
        return all(turn.running == DEAD or turn.spin == ENDED for turn in turns) and all(
            self.system.programs[n].has_ended(control)
            for n, control in zip(numbers, controls)
            if n in self.programs
        )

    def after_death(
        self, numbers: list[int], controls: tuple, world: World, how: str
    ) -> tuple[list[tuple[tuple, World]], bool]:
        """([(the control of all programs, the world) after its death], whether the run is cut)."""
        system = self.system
        life = world[0][self.use]
        ways, cut = [], False
        for k, (use, state) in enumerate(zip(system.uses, world[0])):
            after, is_cut = [use.initial], False
            if life is None and isinstance(use, Mutex):
                after = [state]  # whoever held it
            elif life is None and isinstance(use, Condition) and k in self.own_models:
                after = [use.left_alone(state)]
            elif life is None or k not in self.own_models:
                after, is_cut = use.died(state, self.members)
            if how == "quit" and isinstance(use, Service) and use.server & self.members:
                after = [use.away(one) for one in after]
            ways.append(after)
            cut |= is_cut
        is_over = not self.may_begin_anew(life)
        controls = tuple(
            system.programs[n].dead(control, world, life is not None, is_over)
            if n in self.members
            else control
            for n, control in zip(numbers, controls)
        )
        shared = list(world[1])
        if life is not None:
            life = Life(True, life.left, how == "restarted")
            for k in self.own_variables:
                shared[k] = system.shared[k].initial
        found = []
        for models in itertools.product(*ways):
            after_it = (tuple(models), tuple(shared))
            found.append((controls, Program.with_model(after_it, self.use, life)))
        return found, cut

    def new_life(self, numbers: list[int], controls: tuple, world: World) -> Step:
        """The step in which it begins anew."""
        system = self.system
        for k, use in enumerate(system.uses):
            state = world[0][k]
            if k in self.parts:
                state = use.initial
            elif k in self.own_models:
                continue
            elif isinstance(use, Service):
                state = use.reborn(state, self.members, use.is_there(use.initial))
            elif hasattr(use, "reborn"):
                state = use.reborn(state, self.members)
            world = Program.with_model(world, k, state)
        life = world[0][self.use]
        left = life.left if life.is_wanted else life.left - 1
        world = Program.with_model(world, self.use, Life(left=left))
        after = []
        for n, control in zip(numbers, controls):
            if n in self.members:
                control, world = system.programs[n].begun(world)
            after.append(control)
        also = self.changed(numbers, tuple(after))
        return Step(("anew", self.use), ("anew",), None, world, also=also)

    def in_step(
        self, numbers: list[int], controls: tuple, at: int, step: Step
    ) -> Iterator[Step]:
        """The steps that are this one of a program with the death of this process in it."""
        controls = controls[:at] + (step.control,) + controls[at + 1 :]
        ways, cut = self.after_death(numbers, controls, step.world, step.death_of[1])
        for after, world in ways:
            also = self.changed(numbers, after)
            yield Step(step.program, step.label, after[at], world, also=also)
        if cut:
            yield Step(step.program, step.label, cut=True)


def processes_of(system: Any) -> list[Process]:
    """The processes of a system."""
    found: dict[Any, Process] = {}
    for executor in system.executors:
        key = ("named", executor.process) if executor.process else executor
        process = found.setdefault(key, Process(system, key))
        process.executors.append(executor)
        process.add(executor.may_die, executor.may_restart)
    for number, text in enumerate(system.texts):
        if text.callback is None and text.executor is None:
            key = ("named", text.process) if text.process else number
            process = found.setdefault(key, Process(system, key))
            process.programs.append(number)
            process.add(text.may_die, text.may_restart)
    note_statements(system, found)
    for process in found.values():
        process.check()
    return list(found.values())


def note_statements(system: Any, processes: dict[Any, Process]) -> None:
    """Notes whom the statements of all code, and of the procedures that it calls, name."""
    for number, text in enumerate(system.texts):
        own = next((p for p in processes.values() if number in p.members), None)
        for statement in statements_in(text.body, system.procedures, set()):
            if statement.kind == "quit" and own is not None:
                own.ends_itself = True
            elif statement.kind in KILLS:
                for process in meant(system, processes.values(), statement.target[0], None):
                    process.is_named = True
                    process.is_restarted |= statement.kind == "restart"


def statements_in(value: Any, procedures: dict, called: set) -> Iterator[Statement]:
    """All statements in a text, and in the procedures that it calls."""
    if isinstance(value, (list, tuple)):
        for one in value:
            yield from statements_in(one, procedures, called)
    if not isinstance(value, Statement):
        return
    yield value
    if value.kind == "call" and value.procedure not in called and value.procedure in procedures:
        called.add(value.procedure)
        yield from statements_in(procedures[value.procedure][1], procedures, called)
    for one in vars(value).values():
        yield from statements_in(one, procedures, called)


def meant(
    system: Any, processes: Iterable[Process], name: str, index: tuple | None
) -> list[Process]:
    """The processes that a name means: of a program, with an index one of its array; of an executor
    of the file; of a `process:`."""
    programs = {n for n, text in enumerate(system.texts)
                if text.name == name and index in (None, text.index)}  # fmt: skip
    found = [process for process in processes if programs & set(process.programs)]
    if not found and not index:
        found = [
            process
            for process in processes
            if any(one.name == name and one.is_of_file for one in process.executors)
        ]
    if not found and not index:
        found = [process for process in processes if process.key == ("named", name)]
    return found
