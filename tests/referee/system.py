"""A system file: its models, topics, variables and programs, and the components they make."""

from __future__ import annotations

import os
from typing import Any

import yaml

from control import Compiler
from expressions import Mistake, Scope, Value, Variable, declared, evaluate, members, words_in
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
from machine import Program
from models import Automaton, Model, Queue, model_of
from use import End, Instance, Topic, end_of

KEYS = {"constants", "models", "topics", "procedures", "variables", "programs", "properties"}


def member_name(name: str, index: tuple) -> str:
    """`fork[3]`, or the name alone."""
    return f"{name}[{','.join(map(str, index))}]" if index else name


class System:
    """All of a system file but its properties, which `properties` keeps as they stand there."""

    def __init__(self, path: str) -> None:
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
        self.texts = self.read_programs()
        self.procedures = self.read_procedures()
        self.variables = self.read_variables()
        self.uses: list[Instance | Topic] = []
        self.numbers: dict[tuple[str, tuple], int] = {}
        self.array_ranges: dict[str, list[range]] = {}
        self.weak: list[str] = []
        self.read_models()
        self.read_topics()
        self.collect_words()
        self.given: set[tuple[int, str, str]] = set()
        self.expects_values: set[str] = set()
        self.gives_values: set[str] = set()
        self.shared: list[Variable] = []
        self.knows_shared = False
        self.compile()  # tells which variables are shared
        self.shared = [v for v in self.variables if len(v.users) > 1]
        for variable in self.shared:
            variable.shared = True
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

    def read_programs(self) -> list[tuple[str, tuple, Scope, list[Statement], bool]]:
        """(name, index, scope, text, whether it may die) of each program."""
        found = []
        for header, text in (self.document.get("programs") or {}).items():
            may_die = False
            if isinstance(text, dict):
                may_die, text = text.get("may_die", False), text["do"]
            name, array = self.array(header)
            body = parse_program(text, f"program {name}")
            for index, scope in array:
                found.append((name, index, scope, body, may_die))
            self.add_name(name, ("program", name))
        if not found:
            raise Refused("no programs")
        return found

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
            self.file.words.update(words_in([statement]))
            variable = declared(self.file, statement)
            whole = variable.all_least()
            if statement.value is not None:
                for index in members(variable.indices):
                    scope = Scope(self.file)
                    for (name, _, _), value in zip(statement.ranges, index):
                        scope.names[name] = ("value", value)
                    try:
                        value = scope.constant(statement.value)
                        whole = variable.written(whole, list(index), value)
                    except Mistake as mistake:
                        raise Refused(str(mistake)) from mistake
            variable.initial = whole
            self.add_name(variable.name, ("variable", variable))
            found.append(variable)
        return found

    def program_numbers(self, names: Any, scope: Scope) -> list[int]:
        """The programs that a list of names means; the name of an array means all members."""
        found = []
        for text in [names] if isinstance(names, str) else names:
            name, indices = parse_reference(text, text)
            index = tuple(scope.constant(i) for i in indices)
            matching = [
                number
                for number, (other, at, *_) in enumerate(self.texts)
                if other == name and (not indices or at == index)
            ]
            if not matching:
                raise Refused(f"no program {text}")
            found += matching
        return found

    def add_use(self, name: str, index: tuple, use: Instance | Topic) -> None:
        """Gives a model or topic its number."""
        self.numbers[(name, index)] = len(self.uses)
        self.uses.append(use)

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
                model = self.model_at(name, description, scope)
                ends: dict[int, dict] = {}
                mortal: list[End] = []
                given = description.get("ends") or {}
                for actor, names in sorted(given.items()):
                    numbers = self.program_numbers(names, scope)
                    for k, program in enumerate(numbers):
                        if self.texts[program][4]:
                            others = set(given) - {actor}
                            mortal.append(end_of(model, program, actor, k, len(numbers), others))
                        own = ends.setdefault(program, {})
                        for action in model.input_names | model.output_names:
                            if model.actor(action) == actor:
                                own[action] = action if k == 0 else f"{action}{k + 1}"
                full = member_name(name, index)
                self.add_use(name, index, Instance(full, model, policy, ends, mortal))

    def read_topics(self) -> None:
        """Reads the topics."""
        mortal = {number for number, text in enumerate(self.texts) if text[4]}
        for header, description in (self.document.get("topics") or {}).items():
            name, array = self.declare_array(header)
            for index, scope in array:
                writers = set(self.program_numbers(description["writers"], scope))
                readers = self.program_numbers(description["readers"], scope)
                own = {}
                for reader, options in (description.get("readers_with") or {}).items():
                    for number in self.program_numbers(reader, scope):
                        own[number] = options
                models = []
                for reader in readers:
                    options = {**(description.get("with") or {}), **own.get(reader, {})}
                    models.append(self.model_at(name, {**description, "with": options}, scope))
                policy = description.get("when_unexplored", "stop")
                one = description.get("deliver") == "one"
                full = member_name(name, index)
                self.add_use(
                    name, index, Topic(full, models, writers, readers, policy, one, mortal)
                )

    def collect_words(self) -> None:
        """Notes the words that types and models list."""
        for _, _, _, body, _ in self.texts:
            self.file.words.update(words_in(body))
        for _, body in self.procedures.values():
            self.file.words.update(words_in(body))
        for use in self.uses:
            models = use.models if isinstance(use, Topic) else [use.model]
            for model in models:
                if isinstance(model, Automaton):
                    self.file.words.update(model.words)

    # --- what the compiler and the programs ask

    def model_ranges(self, name: str) -> list[range]:
        """The index ranges of an array of models; none for a single one."""
        return self.array_ranges[name]

    def model_number(self, name: str, index: tuple) -> int:
        """The number of a model; a mistake if the index is outside of the array."""
        number = self.numbers.get((name, index))
        if number is None:
            raise Mistake(f"{name} has no index {index}")
        return number

    def check_input(self, program: int, name: str, given: str) -> None:
        """Refuses an input that these models do not have."""
        for (base, _), number in self.numbers.items():
            if base == name:
                self.uses[number].check_input(program, given)
        self.given.add((program, name, given))

    def check_output(self, program: int, name: str, output: str) -> None:
        """Refuses an output that these models do not have."""
        for (base, _), number in self.numbers.items():
            if base == name:
                self.uses[number].check_output(program, output)

    def compile(self) -> list[Program]:
        """All programs; which of the file's variables are shared must be known."""
        found = []
        self.models_of: list[set[int]] = []
        for number, (name, index, scope, body, may_die) in enumerate(self.texts):
            outside = tuple(v for v in self.variables if v.users == {number})
            compiler = Compiler(self, number, self.file)
            first = compiler.compile(body, scope, outside)
            full = member_name(name, index)
            found.append(Program(self, number, full, compiler.nodes, first, may_die))
            used = {self.numbers[key] for key in compiler.models}
            if may_die:  # what its death changes, named in its text or not
                used |= {k for k, use in enumerate(self.uses) if number in use.standing}
            self.models_of.append(used)
        return found

    def refuse_values_that_nobody_gives(self) -> None:
        """Refuses an output with values of a queue to which only bare messages are written."""
        for (name, _), number in self.numbers.items():
            use = self.uses[number]
            models = use.models if isinstance(use, Topic) else [use.model]
            if name in self.expects_values - self.gives_values:
                if all(isinstance(model, Queue) for model in models):
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
            join([p for p in range(len(group)) if use in self.models_of[p]])
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
                models = use.models if isinstance(use, Topic) else [use.model]
                if base == name and any(given in model.hidden_returns for model in models):
                    return True
        return False


def evaluated(expression: tuple, values: Any) -> Value | None:
    """The value of an expression of a formula; None where a variable is out of scope."""
    try:
        return evaluate(expression, values)
    except (Mistake, TypeError, KeyError):
        return None
