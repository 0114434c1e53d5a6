"""A system file: its models, topics, variables and programs, and the components they make."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from typing import Any, NamedTuple

import yaml

from control import Compiler
from deliveries import AT_ONCE, Origin, Wire, acknowledged_by_one, delivery_of, kept, loses
from expressions import (
    Mistake,
    Presence,
    Scope,
    Value,
    Variable,
    declared,
    members,
    there_name,
    words_in,
)
from language import (
    Parser,
    Refused,
    Statement,
    parse_declarations,
    parse_expression,
    parse_header,
    parse_program,
    parse_reference,
)
from locks import Condition, Mutex
from machine import Program
from models import Automaton, Model, Queue, model_of
from processes import Process, meant, processes_of
from nodes import (
    Callback,
    CallbackText,
    Executor,
    Look,
    NodeText,
    Pool,
    Thread,
    can_run_together,
)
from read_nodes import (
    add_client_callbacks,
    add_services,
    callbacks_at,
    check_serving,
    number_callbacks,
    read_node_variables,
    read_nodes,
    service_members,
)
from services import Service
from spinning import Start
from use import End, Instance, Topic, end_of
from wires import ModelOnWires, Stream, TopicOnWires, writing_inputs

KEYS = {
    "constants", "models", "topics", "services", "procedures", "variables", "programs",
    "executors", "nodes", "properties",
}  # fmt: skip


class Text(NamedTuple):
    """What moves: a program; a copy of a callback; an executor that looks."""

    name: str | None
    index: tuple
    scope: Scope
    body: list[Statement]
    may_die: bool = False
    may_restart: Any = None
    process: str | None = None
    callback: CallbackText | None = None
    executor: Executor | None = None


def member_name(name: str, index: tuple) -> str:
    """`fork[3]`, or the name alone."""
    return f"{name}[{','.join(map(str, index))}]" if index else name


class System:
    """All of a system file but its properties, which `properties` keeps as they stand there."""

    def __init__(self, path: str, at_once: bool = False) -> None:
        """With `at_once`, everything arrives in the step in which it is sent."""
        self.at_once = at_once
        with open(path, encoding="utf-8") as file:
            try:
                self.document = yaml.safe_load(file) or {}
            except yaml.YAMLError as error:
                raise Refused(str(error)) from error
        if not isinstance(self.document, dict) or not set(self.document) <= KEYS:
            raise Refused("unknown keys")
        self.folder = os.path.dirname(os.path.abspath(path))
        self.file = Scope(words=set())
        for name, value in (self.document.get("constants") or {}).items():
            self.add_name(name, ("value", self.number(value, self.file)))
        self.array_ranges: dict[str, list[range]] = {}
        self.array_programs: set[str] = set()
        self.texts = self.read_programs()
        self.executors: list[Executor] = []
        self.node_of: dict[tuple[str, tuple], tuple[NodeText, dict, dict]] = {}
        self.nodes = read_nodes(self)
        services = service_members(self)
        add_client_callbacks(self, services)
        self.add_copies()
        if not self.texts:
            raise Refused("no programs")
        self.procedures = self.read_procedures()
        self.processes = processes_of(self)
        self.variables = self.read_variables()
        read_node_variables(self)
        self.uses: list[Instance | Topic | Service | Executor | Pool] = []
        self.presences: list[Presence] = []
        self.numbers: dict[tuple[str, tuple], int] = {}
        self.weak: list[str] = []
        self.read_models()
        self.read_topics()
        add_services(self, services)
        self.add_streams()
        check_serving(self)
        for text in self.texts:
            executor = text.callback.node.executor if text.callback else None
            if executor is not None and executor.use < 0:
                executor.use = len(self.uses)
                self.uses.append(executor)
        for pool in (pool for node in self.nodes for pool in node.pools):
            pool.use = len(self.uses)
            self.uses.append(pool)
        for process in self.processes:
            process.use = len(self.uses)
            self.uses.append(process)
        self.collect_words()
        self.given: set[tuple[int, str, str]] = set()
        self.expects_values: set[str] = set()
        self.gives_values: set[str] = set()
        self.shared: list[Variable] = []
        self.knows_shared = False
        self.note_presences()
        self.compile()  # tells which variables are shared, and which services are offered
        for presence in self.presences:
            service = self.uses[presence.use]
            service.watch(presence.is_watched())
            if presence.offered:
                service.initial = service.withdrawn(service.initial)
            elif presence.withdrawn:
                raise Refused(f"{service.name} is withdrawn, and nobody offers it")
        for variable in self.variables:
            variable.shared = self.is_shared(variable)
            of_callbacks = any(self.texts[n].callback for n in variable.users)
            variable.stays = of_callbacks and not variable.shared
        self.shared = [v for v in self.variables if v.shared or v.stays]
        self.shared += [c.come for n in self.nodes for c in n.callbacks if c.come is not None]
        self.knows_shared = True
        self.programs = self.compile()
        self.refuse_values_that_nobody_gives()
        self.components = self.find_components()
        self.properties = self.document.get("properties") or {}

    def add_name(self, name: str, meaning: tuple) -> None:
        """Gives a name of the file its meaning."""
        if name in self.file.names:
            raise Refused(f"{name} is there twice")
        self.file.names[name] = meaning

    @staticmethod
    def number(value: Any, scope: Scope) -> Value:
        """The value of a constant, or of an expression in a string."""
        if isinstance(value, (int, bool)):
            return value
        return scope.constant(parse_expression(value, "a constant"))

    def array(self, header: str) -> tuple[str, list[tuple[tuple, Scope]]]:
        """The name of an array or single thing, and its indices with what they mean in its text."""
        name, ranges = parse_header(header, header)
        found = []
        self_ranges = self.file.ranges(ranges)
        for index in members(self_ranges):
            scope = Scope(self.file)
            for (parameter, _, _), value in zip(ranges, index):
                scope.names[parameter] = ("value", value)
            found.append((index, scope))
        return name, found

    def read_programs(self) -> list[Text]:
        """The programs of the file."""
        found = []
        for header, text in (self.document.get("programs") or {}).items():
            may_die, may_restart, process = False, None, None
            if isinstance(text, dict):
                if not set(text) <= {"may_die", "may_restart", "process", "do"}:
                    raise Refused(f"program {header}: unknown keys")
                may_die, process = text.get("may_die", False), text.get("process")
                may_restart = text.get("may_restart")
                text = text["do"]
            name, array = self.array(header)
            body = parse_program(text, f"program {name}")
            for index, scope in array:
                found.append(Text(name, index, scope, body, may_die, may_restart, process))
            if array[0][0]:
                self.array_programs.add(name)
            self.add_name(name, ("program", name))
        return found

    def add_copies(self) -> None:
        """Adds the copies of callbacks, start code and threads to what moves, and the executors
        that look."""
        number_callbacks(self, len(self.texts))
        executors: dict[Executor, None] = {}
        for node in self.nodes:
            executors[node.executor] = None
            for callback in node.codes():
                body = [statement for _, arm in callback.arms for statement in arm]
                copy = Text(None, (), callback.scope, body, callback=callback)
                self.texts += [copy] * len(callback.numbers)
        for executor in executors:
            if executor.rounds:
                self.texts.append(Text(None, (), self.file, [], executor=executor))

    def is_shared(self, variable: Variable) -> bool:
        """Whether two programs that can run at the same time use it."""
        users = sorted(variable.users)
        return any(
            can_run_together(self.texts[one].callback, self.texts[other].callback)
            for one in users
            for other in users
            if one < other
        )

    def read_procedures(self) -> dict[str, tuple[list[str], list[Statement]]]:
        """The parameters and the text of each procedure."""
        found = {}
        for header, text in (self.document.get("procedures") or {}).items():
            parser = Parser(header, header)
            name, parameters = parser.name(), []
            parser.expect("(")
            while not parser.accept(")"):
                parameters.append(parser.name())
                parser.accept(",")
            found[name] = (parameters, parse_program(text, f"procedure {name}"))
        return found

    def read_variables(self) -> list[Variable]:
        """The variables of the file, with their values at first."""
        found = []
        text = self.document.get("variables")
        for statement in parse_declarations(text, "variables") if text else []:
            variable = self.variable_of(statement, self.file)
            self.add_name(variable.name, ("variable", variable))
            found.append(variable)
        return found

    def variable_of(self, statement: Statement, outer: Scope) -> Variable:
        """The variable that is declared outside of programs, with its value at first."""
        self.file.words.update(words_in([statement]))
        variable = declared(outer, statement)
        whole = variable.all_least()
        if statement.value is not None:
            for index in members(variable.indices):
                scope = Scope(outer)
                for (name, _, _), value in zip(statement.ranges, index):
                    scope.names[name] = ("value", value)
                try:
                    value = scope.constant(statement.value)
                    whole = variable.written(whole, list(index), value)
                except Mistake as mistake:
                    raise Refused(str(mistake)) from mistake
        variable.initial = whole
        return variable

    def program_numbers(self, names: Any, scope: Scope) -> list[int]:
        """The programs that a list of names means; the name of an array means all members."""
        found = []
        for text in [names] if isinstance(names, str) else names:
            name, indices = parse_reference(text, text)
            index = tuple(scope.constant(i) for i in indices)
            matching = [
                number
                for number, text_of in enumerate(self.texts)
                if text_of.name == name and (not indices or text_of.index == index)
            ]
            if not matching:
                raise Refused(f"no program {text}")
            found += matching
        return found

    def programs_or(
        self,
        of_nodes: Callable[[str, list[CallbackText]], list[frozenset[int]]],
        names: Any,
        scope: Scope,
    ) -> list[frozenset[int]]:
        """The ends that a list names: of each program one, of nodes what `of_nodes` says."""
        found = []
        for text in [names] if isinstance(names, str) else names:
            callbacks = callbacks_at(self, text, scope)
            if callbacks is None:
                found += [frozenset([n]) for n in self.program_numbers(text, scope)]
            else:
                found += of_nodes(text, callbacks)
        return found

    def ends(self, names: Any, scope: Scope) -> list[frozenset[int]]:
        """The programs at each end that a list names: a node is one end."""

        def of_nodes(text: str, callbacks: list[CallbackText]) -> list[frozenset[int]]:
            return [
                frozenset(n for c in callbacks if c.node is node for n in c.numbers)
                for node in dict.fromkeys(c.node for c in callbacks)
            ]

        return self.programs_or(of_nodes, names, scope)

    def readers(self, names: Any, scope: Scope, topic: str, index: tuple) -> list[frozenset[int]]:
        """The readers of a topic: of a node, each callback that takes from it."""

        def of_nodes(text: str, callbacks: list[CallbackText]) -> list[frozenset[int]]:
            taking = [c for c in callbacks if self.takes_from(c, topic, index)]
            if not taking:
                raise Refused(f"{text} takes nothing from {topic}")
            return [frozenset(c.numbers) for c in taking]

        return self.programs_or(of_nodes, names, scope)

    @staticmethod
    def takes_from(callback: CallbackText, topic: str, index: tuple) -> bool:
        """Whether a callback is a subscription of this topic."""
        if callback.kind != "takes":
            return False
        name, indices = callback.what["model"]
        return name == topic and tuple(callback.scope.constant(i) for i in indices) == index

    def add_use(self, name: str, index: tuple, use: Instance | Topic | Service) -> None:
        """Gives a model or topic its number."""
        number = self.numbers[(name, index)] = len(self.uses)
        self.uses.append(use)
        if isinstance(use, Service):
            presence = Presence(f"{use.name}.there", ("bool",), shared=True, use=number)
            self.presences.append(presence)
            self.file.names[there_name(name, index)] = ("variable", presence)

    def model_at(self, name: str, description: dict, scope: Scope) -> Model:
        """The model that an entry of the file describes."""
        model = model_of(description, self.folder, lambda value: self.number(value, scope))
        if model.weak and description.get("when_weak") != "accept":
            self.weak.append(name)
        return model

    def declare_array(self, header: str) -> tuple[str, list[tuple[tuple, Scope]]]:
        """Declares a model or topic, or an array of them."""
        name, array = self.array(header)
        self.array_ranges[name] = self.file.ranges(parse_header(header, header)[1])
        self.add_name(name, ("model", name, []))
        return name, array

    def read_models(self) -> None:
        """Reads the models."""
        for header, description in (self.document.get("models") or {}).items():
            name, array = self.declare_array(header)
            policy = description.get("when_unexplored", "stop")
            for index, scope in array:
                if self.add_lock(name, index, description):
                    continue
                model = self.model_at(name, description, scope)
                ends: dict[int, dict] = {}
                mortal: list[End] = []
                given = description.get("ends") or {}
                for actor, names in sorted(given.items()):
                    numbers = self.ends(names, scope)
                    for k, end in enumerate(numbers):
                        if self.is_mortal(min(end)):
                            others = set(given) - {actor}
                            mortal.append(end_of(model, min(end), actor, k, len(numbers), others))
                    for k, program in ((k, p) for k, end in enumerate(numbers) for p in end):
                        own = ends.setdefault(program, {})
                        for action in model.input_names | model.output_names:
                            if model.actor(action) == actor:
                                own[action] = action if k == 0 else f"{action}{k + 1}"
                full = member_name(name, index)
                arguments = (full, model, policy, ends, mortal)
                entries = self.entries([frozenset([n]) for n in range(len(self.texts))])
                wires = self.wires_of(description, model, entries)
                if all(w.delivery == AT_ONCE for w in wires):
                    self.add_use(name, index, Instance(*arguments))
                    continue
                entry_of = {p: e for e, programs in enumerate(entries) for p in programs}
                self.add_use(name, index, ModelOnWires(*arguments, wires, entry_of))
        for condition in (use for use in self.uses if isinstance(use, Condition)):
            condition.mutex = self.numbers.get((condition.mutex, ()), -1)
            if condition.mutex < 0 or not isinstance(self.uses[condition.mutex], Mutex):
                raise Refused(f"{condition.name}: no mutex of this name")

    def add_lock(self, name: str, index: tuple, description: dict) -> bool:
        """Gives a mutex or condition its number; whether it is one."""
        kind, options = description.get("use"), description.get("with") or {}
        if kind == "mutex":
            if not set(options) <= {"recursive"}:
                raise Refused(f"{name}: {options}")
            threads = None
            if options.get("recursive", False):
                threads = [self.thread_of(n) for n in range(len(self.texts))]
            self.add_use(name, index, Mutex(member_name(name, index), threads))
            return True
        if kind == "condition":
            if index or set(options) != {"mutex"}:
                raise Refused(f"{name}: {options}")
            self.add_use(name, index, Condition(name, options["mutex"]))
            return True
        return False

    def thread_of(self, program: int) -> Any:
        """What stands for the thread that runs a program: all code but threads that runs in turn on
        one executor, or in an exclusive group, is on one."""
        callback = self.texts[program].callback
        if callback is None or callback.kind == "thread":
            return program
        executor = callback.node.executor
        if executor.threads == 1:
            return executor
        if callback.kind == "start":
            return ("start", executor)
        name, is_exclusive = callback.group
        return (callback.node, name) if is_exclusive else program

    def read_topics(self) -> None:
        """Reads the topics."""
        mortal = {number for number in range(len(self.texts)) if self.is_mortal(number)}
        for header, description in (self.document.get("topics") or {}).items():
            name, array = self.declare_array(header)
            for index, scope in array:
                entries = self.entries(self.ends(description["writers"], scope))
                writers = {p for end in entries for p in end}
                readers = self.readers(description["readers"], scope, name, index)
                own: dict[frozenset, dict] = {}
                for reader, options in (description.get("readers_with") or {}).items():
                    for end in self.readers(reader, scope, name, index):
                        own[end] = options
                models = []
                for end in readers:
                    options = {**(description.get("with") or {}), **own.get(end, {})}
                    models.append(self.model_at(name, {**description, "with": options}, scope))
                policy = description.get("when_unexplored", "stop")
                one = description.get("deliver") == "one"
                full = member_name(name, index)
                arguments = (full, models, writers, readers, policy, one, mortal, len(entries))
                wires = [
                    self.wire(description, own.get(reader, {}), model, entries, e, reader, i)
                    for e in range(len(entries))
                    for i, (reader, model) in enumerate(zip(readers, models))
                ]
                if len(readers) == 1:
                    wires = [acknowledged_by_one(w) for w in wires]
                if all(w.delivery == AT_ONCE for w in wires):
                    use = Topic(*arguments)
                else:
                    entry_of = {p: e for e, programs in enumerate(entries) for p in programs}
                    use = TopicOnWires(*arguments, wires=wires, entry_of=entry_of)
                use.reader_names = [self.name_of(min(end)) for end in readers]
                self.add_use(name, index, use)

    def name_of(self, program: int) -> str:
        """What the file calls a program; of a callback its node's name."""
        text = self.texts[program]
        if text.callback is not None:
            return text.callback.node.full_name
        return member_name(text.name, text.index)

    # --- processes

    def process_at(self, number: int) -> Process:
        """The process of a program, or of a node's code."""
        return next(process for process in self.processes if number in process.members)

    def process_named(self, name: str, index: tuple) -> Process:
        """The process that a statement names."""
        if name in self.array_programs and not index:
            raise Refused(f"{name} is an array of programs")
        found = meant(self, self.processes, name, index)
        if len(found) != 1:
            raise Refused(f"{name} is no executor, program or process")
        return found[0]

    def is_mortal(self, number: int) -> bool:
        """Whether a program may die, or its process is killed."""
        return any(number in one.members for one in self.processes if one.is_mortal)

    # --- wires

    def entries(self, ends: list[frozenset[int]]) -> list[frozenset[int]]:
        """The entries of writers: a node with all its callbacks is one."""
        found: dict[Any, frozenset[int]] = {}
        for end in ends:
            callback = self.texts[min(end)].callback
            node = callback.node if callback is not None else min(end)
            found[node] = found.get(node, frozenset()) | end
        return list(found.values())

    def process_of(self, programs: frozenset[int]) -> Any:
        """The process of an end."""
        number = min(programs)
        is_look = self.texts[number].executor is not None
        return number if is_look else self.process_at(number).key

    def wires_of(self, description: dict, model: Model, entries: list) -> list[Wire]:
        """The wires of a model that stands by itself."""
        if not writing_inputs(model):
            return [Wire(0, 0, None, AT_ONCE)]
        return [
            acknowledged_by_one(self.wire(description, {}, model, entries, e, None, 0))
            for e in range(len(entries))
        ]

    def wire(
        self,
        description: dict,
        own: dict,
        model: Model | None,
        entries: list,
        entry: int,
        reader: frozenset[int] | None,
        box: int,
        sender: frozenset[int] | None = None,
    ) -> Wire:
        """The one function that makes a wire; without a model it is a service's."""
        sender = entries[entry] if sender is None else sender
        origin = Origin(description, model.sul if model is not None else "")
        here = self.process_of(sender)
        there = None if reader is None else self.process_of(reader)
        has_node = reader is not None and any(
            self.texts[min(end)].callback is not None for end in (sender, reader)
        )
        is_connection = reader is not None
        delivery = delivery_of(
            description, origin, here == there, is_connection, has_node
        )
        keep = kept(origin, model is None, lambda v: self.number(v, self.file))
        stream = description.get("stream", "mqtt" if origin.name == "mqtt" else None)
        if self.at_once:
            delivery = AT_ONCE
        if stream is not None and delivery != AT_ONCE:
            stream = (stream, here, there)
        return Wire(entry, box, keep, delivery, loses(description, origin, own), stream)

    def add_streams(self) -> None:
        """Adds the streams, each an order of several wires."""
        found: dict[tuple, list[tuple[int, int]]] = {}
        for number, use in enumerate(self.uses):
            for k, wire in enumerate(getattr(use, "wires", [])):
                if wire.stream is not None and wire.delivery != AT_ONCE:
                    found.setdefault(wire.stream, []).append((number, k))
        self.stream_members = list(found.values())
        for members_of_stream in self.stream_members:
            self.uses.append(Stream(members_of_stream, self.uses))

    def collect_words(self) -> None:
        """Notes the words that types and models list."""
        for text in self.texts:
            self.file.words.update(words_in(text.body))
        for _, body in self.procedures.values():
            self.file.words.update(words_in(body))
        for use in self.uses:
            for model in models_of(use):
                if isinstance(model, Automaton):
                    self.file.words.update(model.words)

    # --- what the compiler and the programs ask

    def model_ranges(self, name: str) -> list[range]:
        """The index ranges of an array of models; none for a single one."""
        return self.array_ranges[name]

    def key_of(self, number: int) -> tuple[str, tuple]:
        """The name and the indices of a model."""
        return next(key for key, other in self.numbers.items() if other == number)

    def model_number(self, name: str, index: tuple) -> int:
        """The number of a model; a mistake if the index is outside of the array."""
        number = self.numbers.get((name, index))
        if number is None:
            raise Mistake(f"{name} has no index {index}")
        return number

    def meant(self, model: tuple) -> list[Any]:
        """What a name with indices may mean: all members, where an index is a variable."""
        name, indices = model
        return [
            self.uses[number]
            for (base, index), number in self.numbers.items()
            if base == name
            and all(i[0] != "value" or i[1] == at for i, at in zip(indices, index))
        ]

    def check_input(self, program: int, model: tuple, given: str) -> None:
        """Refuses an input that these models do not have."""
        for use in self.meant(model):
            use.check_input(program, given)
        self.given.add((program, model[0], given))

    def check_output(self, program: int, model: tuple, output: str) -> None:
        """Refuses an output that these models do not have."""
        for use in self.meant(model):
            use.check_output(program, output)

    def is_service(self, model: tuple) -> bool:
        """Whether a name means a service, or an array of them."""
        return all(isinstance(use, Service) for use in self.meant(model))

    def check_offer(self, program: int, model: tuple, is_offer: bool) -> None:
        """Refuses an `offer` or `withdraw` of what is no service of this program; notes it."""
        for use in self.meant(model):
            if not isinstance(use, Service) or program not in use.server:
                raise Refused(f"{use.name} is no service of this program or node")
            for presence in self.presences:
                if self.uses[presence.use] is use:
                    presence.offered |= is_offer
                    presence.withdrawn |= not is_offer

    def note_presences(self) -> None:
        """Notes which servers may die, and for which services a property asks."""
        properties = str(self.document.get("properties") or {})
        for presence in self.presences:
            service = self.uses[presence.use]
            presence.mortal = any(map(self.is_mortal, service.server))
            base = re.escape(service.name.partition("[")[0])
            presence.named = bool(re.search(rf"\b{base}(\[[^\]]*\])?\.there\b", properties))

    def name_presence(self, services: list) -> None:
        """Notes that the file asks whether these services are there."""
        for presence in self.presences:
            presence.named |= any(self.uses[presence.use] is service for service in services)

    def shared_values(self, world: tuple) -> dict[Variable, Any]:
        """The values of shared variables, and which services are there."""
        found = dict(zip(self.shared, world[1]))
        for presence in self.presences:
            found[presence] = self.uses[presence.use].is_there(world[0][presence.use])
        return found

    def compile(self) -> list[Program]:
        """All programs; which of the file's variables are shared must be known."""
        found = []
        self.models_of: list[set[int]] = []
        for number, text in enumerate(self.texts):
            if text.executor is not None:
                found.append(Look(self, number, text.executor))
                self.models_of.append({text.executor.use})
                continue
            compiler = Compiler(self, number, self.file)
            if text.callback is not None:
                outside = tuple(v for v in self.variables if v.stays and number in v.users)
                first = compiler.compile_callback(text.callback, outside)
                kinds = {"start": Start, "main": Start, "thread": Thread}
                kind = kinds.get(text.callback.kind, Callback)
                found.append(kind(self, number, text.callback, compiler.nodes, first))
                self.models_of.append(self.used_by(text.callback, compiler))
                continue
            outside = tuple(v for v in self.variables if v.users == {number})
            first = compiler.compile(text.body, text.scope, outside)
            full = member_name(text.name, text.index)
            found.append(Program(self, number, full, compiler.nodes, first))
            used = {self.numbers[key] for key in compiler.models} | compiler.pools
            self.models_of.append(used)
        for process in self.processes:
            if process.is_mortal:
                for number in process.members:  # what its death changes, named in its text or not
                    used = {k for k, use in enumerate(self.uses) if number in use.standing}
                    self.models_of[number] |= used | {process.use}
        return found

    def used_by(self, callback: CallbackText, compiler: Compiler) -> set[int]:
        """The models that a callback uses, its executor and its node's services among them; a
        thread uses what it names, as a program."""
        used = {self.numbers[key] for key in compiler.models} | compiler.pools
        if callback.kind == "thread":
            return used | {pool.use for pool in callback.node.pools if pool.text is callback}
        used.add(callback.node.executor.use)
        for k, use in enumerate(self.uses):
            if isinstance(use, Service) and callback.numbers[0] in use.standing:
                used.add(k)
        return used

    def has_outputs(self, name: str, given: str) -> bool:
        """Whether outputs of the same actor as this input are there."""
        for (base, _), number in self.numbers.items():
            if base == name:
                if isinstance(self.uses[number], Mutex):
                    return given == "trylock"
                for model in models_of(self.uses[number]):
                    if any(model.same_actor(given, output) for output in model.output_names):
                        return True
        return False

    def service_number(self, callback: CallbackText) -> int:
        """The service of a callback that serves, or gets answers."""
        return self.numbers[callback.what]

    def is_received(self, name: str, action: str, is_input: bool) -> bool:
        """Whether an input or output is one with which programs receive something."""
        for (base, _), number in self.numbers.items():
            if base != name:
                continue
            use = self.uses[number]
            if action.startswith("arrived") and not is_input:
                return False
            if isinstance(use, Topic):
                return not use.of_writer(action)
            if isinstance(use, Service):
                return action in ("receive", "serve") if is_input else action == "request"
        return is_input and action in ("read", "receive", "serve")

    def refuse_values_that_nobody_gives(self) -> None:
        """Refuses an output with values of a queue to which only bare messages are written."""
        for (name, _), number in self.numbers.items():
            use = self.uses[number]
            models = models_of(use)
            if name in self.expects_values - self.gives_values:
                if models and all(isinstance(model, Queue) for model in models):
                    raise Refused(f"{name} has no message with values")

    def find_components(self) -> list[list[int]]:
        """The programs, by component: those that share a model, a topic or a variable."""
        group = list(range(len(self.programs)))

        def join(numbers: list[int]) -> None:
            for other in numbers[1:]:
                old, new = group[other], group[numbers[0]]
                for i, value in enumerate(group):
                    if value == old:
                        group[i] = new

        for use in range(len(self.uses)):
            join([p for p, used in enumerate(self.models_of) if use in used])
        for stream in self.stream_members:  # one order is one component
            uses = {use for use, _ in stream}
            join([p for p, used in enumerate(self.models_of) if used & uses])
        for variable in self.shared:
            join(sorted(variable.users))
        return [[p for p in range(len(group)) if group[p] == g] for g in sorted(set(group))]

    def rests_on_hidden_return(self, programs: list[int]) -> bool:
        """Whether a program gives an input whose return is hidden, or whose model is weak."""
        for program, name, given in self.given:
            if program not in programs:
                continue
            if name in self.weak:
                return True
            for (base, _), number in self.numbers.items():
                use = self.uses[number]
                hidden = [given in model.hidden_returns for model in models_of(use)]
                if base == name and any(hidden):
                    return True
        return False


def models_of(use: Any) -> list[Model]:
    """The models that stand in a file or are built in."""
    return [use.model] if isinstance(use, Instance) else use.models

