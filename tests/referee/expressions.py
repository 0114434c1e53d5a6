"""Variables and expressions: names are resolved once, values are computed in every state.

A resolved expression is a tuple: ("value", v), ("variable", Variable, [index expressions]),
("un", op, e) or ("bin", op, a, b). Values are integers, truth values, and words (strings).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
import itertools
from typing import Any

from language import Refused

Value = int | bool | str
Expression = tuple


class Mistake(Exception):
    """What the property `error` is about: the program cannot go on."""


@dataclass(eq=False)
class Variable:
    """A variable, local to one program or shared; an array's value is the tuple of its members."""

    name: str
    kind: tuple | None  # ("range", low, high), ("bool",), ("words", [...]), None: any value
    indices: list[range] = field(default_factory=list)
    shared: bool = False
    stays: bool = False  # local to callbacks that never run together, kept between their runs
    users: set[int] = field(default_factory=set)
    initial: Any = None

    def least(self) -> Value | None:
        """The value that one member has unless another is given."""
        if self.kind is None:
            return None
        if self.kind[0] == "range":
            return self.kind[1]
        return False if self.kind[0] == "bool" else self.kind[1][0]

    def check(self, value: Value) -> Value:
        """The value, if one member may have it."""
        if self.kind is None:
            return value
        if self.kind[0] == "range":
            fits = not isinstance(value, (bool, str)) and self.kind[1] <= value <= self.kind[2]
        elif self.kind[0] == "bool":
            fits = isinstance(value, bool)
        else:
            fits = value in self.kind[1]
        if not fits:
            raise Mistake(f"{self.name} cannot be {value}")
        return value

    def place(self, position: list[Value]) -> int:
        """Which member of the tuple stands at these indices."""
        number = 0
        for value, allowed in zip(position, self.indices):
            if value not in allowed:
                raise Mistake(f"{self.name} has no index {value}")
            number = number * len(allowed) + allowed.index(value)
        return number

    def read(self, whole: Any, position: list[Value]) -> Value:
        """The value of a member, or of a variable that is no array."""
        return whole[self.place(position)] if self.indices else whole

    def written(self, whole: Any, position: list[Value], value: Value) -> Any:
        """The whole value after a member got this value."""
        self.check(value)
        if not self.indices:
            return value
        at = self.place(position)
        return whole[:at] + (value,) + whole[at + 1 :]

    def all_least(self) -> Any:
        """The whole value that it has unless another is given."""
        if not self.indices:
            return self.least()
        members = 1
        for allowed in self.indices:
            members *= len(allowed)
        return (self.least(),) * members


@dataclass(eq=False)
class Presence(Variable):
    """Whether a service is there, which is read like a shared variable."""

    use: int = -1  # the number of the service
    offered: bool = False  # whether an `offer` names it: it is not there at first
    withdrawn: bool = False  # whether a `withdraw` names it
    mortal: bool = False  # whether its server may die
    named: bool = False  # whether the file asks for it

    def is_watched(self) -> bool:
        """Whether the file asks whether it is there, or offers it, and its server may die."""
        return self.mortal and (self.named or self.offered)


def there_name(name: str, index: tuple) -> str:
    """What a scope calls a service's presence; no text can."""
    return f"{name}{list(index)}.there"


def services_named(expression: Expression) -> Iterable[tuple[str, list]]:
    """The services whose presence an expression of the text names, as references."""
    if expression[0] == "there":
        yield expression[1:]
    for part in expression[1:]:
        for inner in part if isinstance(part, list) else [part]:
            if isinstance(inner, tuple):
                yield from services_named(inner)


def divide(a: int, b: int) -> int:
    """Division as in C++: towards zero."""
    if b == 0:
        raise Mistake("division by zero")
    quotient = abs(a) // abs(b)
    return quotient if (a < 0) == (b < 0) else -quotient


ARITHMETIC: dict[str, Callable[[Any, Any], Value]] = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": divide,
    "%": lambda a, b: a - b * divide(a, b),
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
}

Values = Callable[[Variable], Any]


def evaluate(expression: Expression, values: Values) -> Value:
    """The value of a resolved expression; `values` gives the whole value of a variable."""
    kind = expression[0]
    if kind == "value":
        return expression[1]
    if kind == "variable":
        _, variable, indices = expression
        return variable.read(values(variable), [evaluate(i, values) for i in indices])
    if kind == "un":
        inner = evaluate(expression[2], values)
        return (not inner) if expression[1] == "!" else -inner
    _, op, left, right = expression
    if op == "&&":
        return bool(evaluate(left, values) and evaluate(right, values))
    if op == "||":
        return bool(evaluate(left, values) or evaluate(right, values))
    return ARITHMETIC[op](evaluate(left, values), evaluate(right, values))


def variables_of(expression: Expression) -> Iterable[Variable]:
    """All variables that a resolved expression names."""
    kind = expression[0]
    if kind == "variable":
        yield expression[1]
        for index in expression[2]:
            yield from variables_of(index)
    elif kind == "un":
        yield from variables_of(expression[2])
    elif kind == "bin":
        yield from variables_of(expression[2])
        yield from variables_of(expression[3])


def reads_shared(expression: Expression) -> bool:
    """Whether a resolved expression names a shared variable."""
    return any(variable.shared for variable in variables_of(expression))


def is_constant(expression: Expression) -> bool:
    """Whether a resolved expression has the same value in all states."""
    return not any(True for _ in variables_of(expression))


class Scope:
    """What names mean at some place of a text.

    A meaning is ("value", v), ("variable", Variable), ("model", name, [index expressions]).
    """

    def __init__(self, outer: Scope | None = None, words: set[str] | None = None) -> None:
        self.outer = outer
        self.names: dict[str, tuple] = {}
        self.words: set[str] = words if words is not None else (outer.words if outer else set())

    def find(self, name: str) -> tuple | None:
        """The meaning of a name, or None."""
        if name in self.names:
            return self.names[name]
        return self.outer.find(name) if self.outer else None

    def resolve(self, expression: Expression) -> Expression:
        """An expression of the text with its names replaced by what they mean."""
        kind = expression[0]
        if kind == "num":
            return ("value", expression[1])
        if kind == "un":
            return fold(("un", expression[1], self.resolve(expression[2])))
        if kind == "bin":
            left, right = self.resolve(expression[2]), self.resolve(expression[3])
            return fold(("bin", expression[1], left, right))
        if kind == "there":
            return self.presence(expression[1], expression[2])
        name = expression[1]
        indices = [self.resolve(i) for i in expression[2]] if kind == "index" else []
        meaning = self.find(name)
        if meaning is None:
            if not indices and name in self.words:
                return ("value", name)
            raise Refused(f"unknown name {name}")
        if meaning[0] == "value" and not indices:
            return meaning
        if meaning[0] == "variable" and len(meaning[1].indices) == len(indices):
            return ("variable", meaning[1], indices)
        raise Refused(f"{name} is not used like this in an expression")

    def presence(self, name: str, indices: list[Expression]) -> Expression:
        """Whether a service is there: true where nothing changes that."""
        meaning = self.find(name)
        if meaning is None or meaning[0] != "model":
            raise Refused(f"{name} is no service")
        resolved = [self.resolve(i) for i in indices] or meaning[2]
        if not all(is_constant(i) for i in resolved):
            raise Refused(f"{name}.there has an index that changes")
        index = tuple(evaluate(i, lambda variable: None) for i in resolved)
        found = self.find(there_name(meaning[1], index))
        if found is None:
            raise Refused(f"{name} is no service")
        changes = found[1].offered or found[1].is_watched()
        return ("variable", found[1], []) if changes else ("value", True)

    def constant(self, expression: Expression) -> Value:
        """The value of an expression of constants alone."""
        resolved = self.resolve(expression)
        if not is_constant(resolved):
            raise Refused("only constants may stand here")
        try:
            return evaluate(resolved, lambda variable: None)
        except Mistake as mistake:
            raise Refused(str(mistake)) from mistake

    def ranges(self, ranges: list[tuple[str, Expression, Expression]]) -> list[range]:
        """The values of indices, `[i in LOW..HIGH, ...]`."""
        return [range(self.constant(low), self.constant(high) + 1) for _, low, high in ranges]


def fold(expression: Expression) -> Expression:
    """The value in place of an expression of constants, unless computing it fails."""
    if is_constant(expression):
        try:
            return ("value", evaluate(expression, lambda variable: None))
        except Mistake:
            return expression
    return expression


def members(ranges: list[range]) -> list[tuple[int, ...]]:
    """All indices of an array, in order."""
    return list(itertools.product(*ranges))


def declared(scope: Scope, statement: Any) -> Variable:
    """The variable that a `var` statement declares."""
    kind = statement.type
    if kind[0] == "range":
        kind = ("range", scope.constant(kind[1]), scope.constant(kind[2]))
    return Variable(statement.name, kind, scope.ranges(statement.ranges))


def words_in(body: Iterable[Any]) -> Iterable[str]:
    """All words that types in this text list."""
    for statement in body:
        if statement.kind == "var" and statement.type[0] == "words":
            yield from statement.type[1]
        for inner in blocks_of(statement):
            yield from words_in(inner)


def blocks_of(statement: Any) -> Iterable[list]:
    """The blocks directly inside a statement."""
    if statement.kind == "label":
        yield [statement.body]
    elif statement.kind in ("loop", "repeat", "while", "for", "atomic", "sleep"):
        yield statement.body
    elif statement.kind == "if":
        yield statement.body
        yield statement.other
    elif statement.kind == "switch":
        yield from (block for _, block, _ in statement.arms)
    elif statement.kind == "select":
        for arm in statement.arms:
            if arm.body is not None:
                yield arm.body
            yield from (block for _, block, _ in arm.outputs or [])
        if statement.other is not None:
            yield statement.other
