"""Formulas of a system file: their text, their atoms, and what these mean in a state."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from expressions import Mistake, Scope, Variable, evaluate, members
from graph import Component, State
from language import Parser, Refused
from ltl import FALSE, TRUE, Formula, negated
from services import Service
from system import System
from use import Topic

ON_THE_WAY = {"request_arrives", "answer_arrives", "request_lost", "answer_lost"}
BOOLEAN = {"&&", "||", "->", "<->"}
COMPARISONS = {"==", "!=", "<", "<=", ">", ">="}


class FormulaParser(Parser):
    """Binary operators from the weakest; F, G, X and ! reach as far as a comparison."""

    def formula(self, level: int = 0) -> tuple:
        if level == 0:
            left = self.formula(1)
            while self.accept("<->"):
                left = ("bin", "<->", left, self.formula(1))
            return left
        if level == 1:
            left = self.formula(2)
            return ("bin", "->", left, self.formula(1)) if self.accept("->") else left
        if level in (2, 3):
            op = "||" if level == 2 else "&&"
            left = self.formula(level + 1)
            while self.accept(op):
                left = ("bin", op, left, self.formula(level + 1))
            return left
        left = self.temporal()
        if self.peek()[0] == "name" and self.sees("U", "R", "W"):
            op = self.peek()[1]
            self.at += 1
            return ("bin", op, left, self.formula(4))
        return left

    def temporal(self) -> tuple:
        for token, op in (("!", "!"), ("[]", "G"), ("<>", "F")):
            if self.accept(token):
                return ("un", op, self.temporal())
        if self.peek()[0] == "name" and self.sees("F", "G", "X"):
            if not self.sees(".", "@", ":", "==", "!=", ahead=1):
                op = self.peek()[1]
                self.at += 1
                return ("un", op, self.temporal())
        return self.comparison(2)

    def comparison(self, level: int) -> tuple:
        """Comparisons and arithmetic, with atoms of formulas as their leaves."""
        if level == len(self.LEVELS):
            if self.accept("-"):
                return ("un", "-", self.comparison(level))
            return self.atom()
        left = self.comparison(level + 1)
        while self.peek()[0] == "op" and self.sees(*self.LEVELS[level]):
            op = self.peek()[1]
            self.at += 1
            left = ("bin", op, left, self.comparison(level + 1))
        return left

    def atom(self) -> tuple:
        kind, value, _ = self.peek()
        if self.accept("("):
            inner = self.formula()
            self.expect(")")
            return inner
        if kind == "number":
            self.at += 1
            return ("num", value)
        if kind == "name" and value in ("true", "false"):
            self.at += 1
            return ("num", value == "true")
        reference = self.reference()
        program = None
        if self.sees(".") and self.sees("@", ":", ahead=2):  # a node's callback
            self.accept(".")
            reference = (f"{reference[0]}.{self.name()}", reference[1])
        if self.accept(":"):
            program, reference = reference, self.reference()
        if self.accept("@"):
            return ("label", reference, self.name())
        if self.accept("!"):
            return ("event", program, reference, "!", self.name(), self.values())
        if self.accept("."):
            name = self.name()
            if self.sees("("):
                return ("event", program, reference, "?", name, self.values())
            indices = self.indices()
            if indices:
                return ("field", reference, name, indices)
            return ("dot", program, reference, name)
        if program is not None:
            self.fail("an event")
        name, indices = reference
        return ("index", name, indices) if indices else ("name", name)

    def values(self) -> list | None:
        """The values of an event; None if it does not name them."""
        return self.arguments() if self.sees("(") else None


def parse_formula(text: str, origin: str) -> tuple[list, tuple]:
    """A formula as (quantified ranges, body)."""
    parser = FormulaParser(str(text), origin)
    ranges = []
    while parser.peek()[0] == "name" and parser.sees("forall"):
        parser.at += 1
        while True:
            name = parser.name()
            parser.expect("in")
            low = parser.expression(4)
            parser.expect("..")
            ranges.append((name, low, parser.expression(4)))
            if not parser.accept(","):
                break
        parser.expect(":")
    body = parser.formula()
    parser.end()
    return ranges, body


@dataclass(frozen=True)
class Label:
    """Whether a program, or one of a node's copies of callbacks, is before a label, or ended."""

    programs: frozenset[int]
    label: str


@dataclass(frozen=True)
class Event:
    """Whether the last step was this one."""

    programs: frozenset[int] | None
    use: str
    readers: frozenset[int] | None
    sign: str
    name: str
    values: tuple | None

    def matches(self, event: tuple) -> bool:
        """Whether it is that event."""
        program, use, readers, sign, action = event
        return bool(
            (self.programs is None or program in self.programs)
            and use == self.use
            and sign == self.sign
            and action[0] == self.name
            and self.values in (None, action[1])
            and readers != ()  # a write that no reader's model was given
            and (self.readers is None or readers is not None and self.readers & set(readers))
        )


@dataclass(frozen=True)
class Comparison:
    """Whether an expression over variables holds; its leaves are ("local", program, name, [i])."""

    expression: Any


class Formulas:
    """Resolves one formula, in one instance of its quantifiers."""

    def __init__(self, system: System, scope: Scope) -> None:
        self.system = system
        self.scope = scope
        self.atoms: list[Any] = []
        self.programs: set[int] = set()

    def number(self, atom: Any) -> Formula:
        """The formula that is this atom."""
        for n, other in enumerate(self.atoms):
            if type(other) is type(atom) and other == atom:
                return ("atom", n)
        self.atoms.append(atom)
        return ("atom", len(self.atoms) - 1)

    def node(self, reference: tuple) -> Any:
        """The node that a reference names, or None."""
        name, indices = reference
        index = tuple(self.scope.constant(i) for i in indices)
        return self.system.node_of.get((name.split(".")[0], index), (None,))[0]

    def labelled(self, reference: tuple, label: str) -> frozenset[int]:
        """The programs that a reference names and that have a label; all, where none has it."""
        noted = set(self.programs)
        found = self.program(reference)
        having = frozenset(n for n in found if label in self.system.programs[n].labels)
        self.programs = noted | (having or found)
        return having or found

    def program(self, reference: tuple) -> frozenset[int]:
        """The programs that a reference names: one, or the copies of a node or of a callback."""
        name, indices = reference
        index = tuple(self.scope.constant(i) for i in indices)
        found = frozenset(
            number
            for number, text in enumerate(self.system.texts)
            if text.name == name and text.index == index
        )
        node = self.node(reference)
        if node is not None:
            callback = name.partition(".")[2]
            found = frozenset(
                n for c in node.codes() if callback in ("", c.name) for n in c.numbers
            )
        if not found:
            raise Refused(f"no program {name}{list(index)}")
        self.programs |= found
        return found

    def use(self, reference: tuple, event: str) -> tuple[str, frozenset[int] | None]:
        """The model or topic that a reference names, and the readers, if it names some."""
        name, indices = reference
        meaning = self.scope.find(name)
        if meaning is None or meaning[0] != "model":
            raise Refused(f"no model {name}")
        arity = len(self.system.model_ranges(name))
        reader = None
        if len(indices) == arity + 1:
            text = indices[-1]
            reader = self.program((text[1], text[2] if text[0] == "index" else []))
            indices = indices[:-1]
        index = tuple(self.scope.constant(i) for i in indices[:arity])
        number = self.system.numbers.get((name, index))
        if number is None:
            raise Refused(f"no model {name}{list(index)}")
        for program, used in enumerate(self.system.models_of):
            if number in used:
                self.programs.add(program)
        use = self.system.uses[number]
        if reader is not None:
            if isinstance(use, Service) and event in ON_THE_WAY:
                place = use.client_of
            elif isinstance(use, Topic):
                place = use.reader_of
            else:
                raise Refused(f"{use.name} has no readers")
            reader = frozenset(place[p] for p in reader if p in place)
            if not reader:
                raise Refused(f"no reader of {use.name}")
        return use.name, reader

    def event(
        self, program: tuple | None, reference: tuple, sign: str, name: str, values: Any
    ) -> Formula:
        """The atom of an event."""
        use, reader = self.use(reference, name)
        own = None if program is None else self.program(program)
        known = None if values is None else tuple(self.scope.constant(v) for v in values)
        return self.number(Event(own, use, reader, sign, name, known))

    def is_model(self, reference: tuple) -> bool:
        """Whether a reference names a model or topic."""
        meaning = self.scope.find(reference[0])
        return meaning is not None and meaning[0] == "model"

    def is_presence(self, node: tuple) -> bool:
        """Whether this is `service.there`."""
        _, program, (name, indices), word = node
        if program is not None or word != "there" or not self.is_model((name, indices)):
            return False
        resolved = [self.scope.resolve(i) for i in indices]
        return self.system.is_service((name, resolved))

    def resolve(self, node: tuple) -> Formula:
        """A formula of the text, in negation normal form."""
        kind = node[0]
        if kind == "num" and isinstance(node[1], bool):
            return TRUE if node[1] else FALSE
        if kind == "un" and node[1] != "-":
            inner = self.resolve(node[2])
            if node[1] == "!":
                return negated(inner)
            return {
                "X": ("X", inner),
                "F": ("U", TRUE, inner),
                "G": ("R", FALSE, inner),
            }[node[1]]
        if kind == "bin" and node[1] in BOOLEAN | {"U", "R", "W"}:
            left, right = self.resolve(node[2]), self.resolve(node[3])
            if node[1] == "->":
                return ("or", negated(left), right)
            if node[1] == "<->":
                both = ("and", left, right)
                return ("or", both, ("and", negated(left), negated(right)))
            if node[1] == "W":
                return ("R", right, ("or", left, right))
            return ({"&&": "and", "||": "or"}.get(node[1], node[1]), left, right)
        if kind == "label":
            if node[2] == "end" and self.node(node[1]) is not None:
                raise Refused("a node has no end")
            return self.number(Label(self.labelled(node[1], node[2]), node[2]))
        if kind == "event":
            return self.event(node[1], node[2], node[3], node[4], node[5])
        if kind == "dot" and self.is_model(node[2]) and not self.is_presence(node):
            return self.event(node[1], node[2], "?", node[3], None)
        leaf = self.leaf(node)
        if leaf[0] == "value" and isinstance(leaf[1], bool):  # a service that is always there
            return TRUE if leaf[1] else FALSE
        return self.number(Comparison(leaf))

    def leaf(self, node: tuple) -> tuple:
        """An expression over variables of programs and of the file."""
        kind = node[0]
        if kind == "un":
            return ("un", node[1], self.leaf(node[2]))
        if kind == "bin":
            return ("bin", node[1], self.leaf(node[2]), self.leaf(node[3]))
        if kind == "dot" and self.is_presence(node):
            resolved = self.scope.resolve(("there", *node[2]))
            if resolved[0] == "value":
                return resolved
            self.use(node[2], node[3])
            return ("global", resolved[1], ())
        if kind == "dot":
            return self.field(node[2], node[3], ())
        if kind == "field":
            return self.field(node[1], node[2], tuple(self.leaf(i) for i in node[3]))
        if kind == "num":
            return ("value", node[1])
        name = node[1]
        meaning = self.scope.find(name)
        if meaning is not None and meaning[0] == "variable":
            indices = tuple(self.leaf(i) for i in (node[2] if kind == "index" else ()))
            self.programs.update(meaning[1].users)
            return ("global", meaning[1], indices)
        return self.scope.resolve(node)

    def field(self, reference: tuple, name: str, indices: tuple) -> tuple:
        """A variable of a program or of a node."""
        node = self.node(reference)
        if node is None:
            return ("local", next(iter(self.program(reference))), name, indices)
        for variable in node.variables:
            if variable.name == name:
                self.programs |= variable.users
                return ("global", variable, indices)
        raise Refused(f"node {node.full_name} has no variable {name}")


class Letter:
    """The values of atoms in a state that was reached with these events."""

    def __init__(self, system: System, component: Component, state: State, events: tuple) -> None:
        self.system = system
        self.component = component
        self.state = state
        self.events = events

    def holds(self, atom: Any) -> bool:
        """Whether the atom holds."""
        if isinstance(atom, Event):
            return any(atom.matches(event) for event in self.events)
        if isinstance(atom, Label):
            return any(self.is_before(number, atom.label) for number in atom.programs)
        try:
            return bool(self.value(atom.expression))
        except (Mistake, LookupError):
            return False

    def is_before(self, number: int, label: str) -> bool:
        """Whether a program is before a label, or at its end."""
        program, control = self.at(number)
        if not isinstance(control[0], int):
            return False
        return label in control[1] or label == "end" and program.has_ended(control)

    def at(self, number: int) -> tuple:
        """A program and its control state."""
        at = self.component.numbers.index(number)
        return self.component.programs[at], self.state.controls[at]

    def value(self, node: tuple) -> Any:
        """The value of an expression; LookupError if a variable is not in scope."""
        kind = node[0]
        if kind == "bin" or kind == "un":
            parts = [("value", self.value(part)) for part in node[2:]]
            return evaluate((kind, node[1], *parts), lambda variable: None)
        if kind == "value":
            return node[1]
        position = [self.value(i) for i in node[2 if kind == "global" else 3]]
        if kind == "global":
            variable = node[1]
            if variable.shared or variable.stays:
                whole = self.system.shared_values(self.state.world)[variable]
            elif not variable.users:
                whole = variable.initial
            else:
                program, control = self.at(next(iter(variable.users)))
                whole = program.value(control, variable)
        else:
            program, control = self.at(node[1])
            variable = self.local(program, control, node[2])
            whole = program.value(control, variable)
        if whole is None:
            raise LookupError("not in scope")
        return variable.read(whole, position)

    @staticmethod
    def local(program: Any, control: tuple, name: str) -> Variable:
        """The variable of this name that is in scope."""
        scope = program.nodes[control[0]].scope if isinstance(control[0], int) else ()
        for variable in reversed(scope):
            if variable.name == name:
                return variable
        raise LookupError(name)


def instances(system: System, ranges: list) -> Iterable[Scope]:
    """The scopes of all instances of a quantified formula."""
    for index in members(system.file.ranges(ranges)):
        scope = Scope(system.file)
        for (name, _, _), value in zip(ranges, index):
            scope.names[name] = ("value", value)
        yield scope
