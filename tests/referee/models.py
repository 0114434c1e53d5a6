"""Models: interface automata from DOT files, and built-in ones.

A model gives `initial`; `steps(state, action)`, the states after an input; `outputs(state)`, what
is due as (action, next state); `unexplored(state, action)`; and `actor(name)`. An action is
(name, values), such as ("write", (3,)). What a program may do with a model is in use.py.
"""

from __future__ import annotations

import os
import re
from typing import Any

from language import Refused

Action = tuple[str, tuple]
State = Any

DOT_TOKEN = re.compile(
    r"""\s+|//[^\n]*|/\*.*?\*/|\#[^\n]*
    |"(?P<quoted>(?:[^"\\]|\\.)*)"|(?P<arrow>->|--)|(?P<op>[{}\[\]=;,])
    |(?P<word>[^\s{}\[\]=;,"]+?(?=->|[\s{}\[\]=;,"]|$))""",
    re.VERBOSE | re.DOTALL,
)

VALUED = re.compile(r"([^()]+)\((.*)\)\Z", re.DOTALL)


def action_of(text: str) -> Action:
    """`write(3)` is ("write", (3,)), `write` is ("write", ())."""
    match = VALUED.match(text)
    if not match:
        return (text, ())
    values: list = []
    for word in match.group(2).split(","):
        word = word.strip()
        if re.fullmatch(r"-?\d+", word):
            values.append(int(word))
        elif word in ("true", "false"):
            values.append(word == "true")
        else:
            values.append(word)
    return (match.group(1), tuple(values))


def split_names(text: str) -> list[str]:
    """Names separated by commas outside of brackets; those with separators are quoted."""
    names = []
    for match in re.finditer(r'\s*("(?:[^"\\]|\\.)*"|(?:[^,(]|\([^)]*\))+)\s*(?:,|$)', text):
        names.append(unquote(match.group(1)))
    return [name for name in names if name]


def unquote(name: str) -> str:
    """The name without the quotes around it."""
    name = name.strip()
    if name.startswith('"') and name.endswith('"') and len(name) > 1:
        return name[1:-1].replace('\\"', '"').replace("\\\\", "\\")
    return name


def tokens_of(path: str) -> list[tuple[str, str]]:
    """The tokens behind the first brace of a DOT file."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    tokens, position = [], 0
    while position < len(text):
        match = DOT_TOKEN.match(text, position)
        if not match:
            raise Refused(f"{path}: not DOT at character {position}")
        position = match.end()
        if match.lastgroup == "quoted":
            tokens.append(("id", match.group("quoted").replace('\\"', '"')))
        elif match.lastgroup == "word":
            tokens.append(("id", match.group("word")))
        elif match.lastgroup:
            tokens.append(("op", match.group(match.lastgroup)))
    while tokens and tokens[0] != ("op", "{"):
        tokens.pop(0)
    return tokens


def read_dot(path: str) -> tuple[dict, dict, list]:
    """Attributes of the graph and of its nodes, as mentioned, and edges (from, to, attributes)."""
    tokens = tokens_of(path)
    at = 1
    graph: dict[str, str] = {}
    nodes: dict[str, dict] = {}
    edges: list[tuple[str, str, dict]] = []

    def attributes(at: int) -> tuple[dict, int]:
        found = {}
        while tokens[at] == ("op", "["):
            at += 1
            while tokens[at] != ("op", "]"):
                if tokens[at][0] == "op":
                    at += 1
                    continue
                key = tokens[at][1]
                at += 1
                if tokens[at] == ("op", "="):
                    found[key] = tokens[at + 1][1]
                    at += 2
            at += 1
        return found, at

    while tokens[at] != ("op", "}"):
        kind, name = tokens[at]
        if kind == "op":
            at += 1
            continue
        if tokens[at + 1] == ("op", "="):
            graph[name] = tokens[at + 2][1]
            at += 3
            continue
        chain = [name]
        at += 1
        while tokens[at] == ("op", "->"):
            chain.append(tokens[at + 1][1])
            at += 2
        found, at = attributes(at)
        if len(chain) > 1:
            for left, right in zip(chain, chain[1:]):
                nodes.setdefault(left, {})
                nodes.setdefault(right, {})
                edges.append((left, right, found))
        elif name == "graph":
            graph.update(found)
        elif name not in ("node", "edge"):
            nodes.setdefault(name, {}).update(found)
    return graph, nodes, edges


class Model:
    """What is common to all models."""

    initial: State
    hidden_returns: set[str] = set()
    weak = False
    sul = ""  # what the file says it is of
    has_actors = False
    input_names: set[str] = set()
    output_names: set[str] = set()

    def steps(self, state: State, action: Action) -> list[State]:
        """The states after this input; none if it is not possible."""
        raise NotImplementedError

    def outputs(self, state: State) -> list[tuple[Action, State]]:
        """What is due, and the state after it was taken."""
        return []

    def unexplored(self, state: State, action: Action) -> bool:
        """Whether the input was never tried in this state."""
        return False

    def reaches(self, state: State, outputs: set[str], without: set[str]) -> bool:
        """Whether one of these outputs may come though none of these inputs is given."""
        return False

    def actor(self, name: str) -> str | None:
        """The actor of an input or output."""
        return None

    def same_actor(self, one: str, other: str) -> bool:
        """Whether two actions are of one actor; all are, where the model names none."""
        return not self.has_actors or self.actor(one) == self.actor(other)


class Automaton(Model):
    """An interface automaton from a DOT file, as plain tables."""

    def __init__(self, path: str) -> None:
        graph, nodes, edges = read_dot(path)
        numbers: dict[str, int] = {}
        start = None
        for node in nodes:
            if node != "__start0":
                numbers[node] = len(numbers)
        for left, right, _ in edges:
            if left == "__start0":
                start = right
        self.initial = numbers[start] if start else 0
        self.table: list[dict[Action, list[int]]] = [{} for _ in numbers]
        self.emits: list[list[tuple[Action, int]]] = [[] for _ in numbers]
        self.marks: list[set[Action]] = [set() for _ in numbers]
        inputs = {action_of(n) for n in split_names(graph.get("inputs", ""))}
        outputs = {action_of(n) for n in split_names(graph.get("outputs", ""))}
        for node, attributes in nodes.items():
            if node != "__start0":
                marks = {action_of(n) for n in split_names(attributes.get("unexplored", ""))}
                self.marks[numbers[node]] |= marks
                inputs |= marks
        for left, right, attributes in edges:
            if left == "__start0":
                continue
            label = attributes.get("label", "")
            action = action_of(unquote(label[1:]))
            source, target = numbers[left], numbers[right]
            if label.startswith("?"):
                inputs.add(action)
                if attributes.get("absorbed") == "true":
                    self.marks[source].add(action)
                elif target not in self.table[source].setdefault(action, []):
                    self.table[source][action].append(target)
            elif label.startswith("!"):
                outputs.add(action)
                if (action, target) not in self.emits[source]:
                    self.emits[source].append((action, target))
            else:
                raise Refused(f"{path}: label {label!r} is neither ?input nor !output")
        self.input_names = {name for name, _ in inputs}
        self.output_names = {name for name, _ in outputs}
        self.words = {v for _, values in inputs | outputs for v in values if isinstance(v, str)}
        self.actors: dict[str, str] = {}
        for part in graph.get("actors", "").split(";"):
            if ":" in part:
                actor, names = part.split(":", 1)
                for name in names.split():
                    self.actors[action_of(unquote(name[1:]))[0]] = actor.strip()
        self.has_actors = bool(self.actors)
        hidden = split_names(graph.get("hidden_returns", ""))
        self.hidden_returns = {action_of(name)[0] for name in hidden}
        self.weak = graph.get("strength", "").startswith("weak")
        self.sul = graph.get("sul", "")

    def steps(self, state: int, action: Action) -> list[int]:
        return self.table[state].get(action, [])

    def outputs(self, state: int) -> list[tuple[Action, int]]:
        return self.emits[state]

    def unexplored(self, state: int, action: Action) -> bool:
        return action in self.marks[state]

    def reaches(self, state: int, outputs: set[str], without: set[str]) -> bool:
        seen, waiting = {state}, [state]
        while waiting:
            at = waiting.pop()
            after = [t for (name, _), t in self.emits[at] if name not in outputs]
            if len(after) < len(self.emits[at]):
                return True
            for (name, _), targets in self.table[at].items():
                after += [] if name in without else targets
            for target in after:
                if target not in seen:
                    seen.add(target)
                    waiting.append(target)
        return False

    def actor(self, name: str) -> str | None:
        return self.actors.get(name)


class Semaphore(Model):
    """The state is how often it can still be acquired."""

    input_names = {"acquire", "release"}

    def __init__(self, count: int) -> None:
        self.initial = self.count = count

    def steps(self, state: int, action: Action) -> list[int]:
        if action == ("acquire", ()):
            return [state - 1] if state > 0 else []
        return [state + 1] if action == ("release", ()) and state < self.count else []


NULL = "null"  # what is due to a `tryread` of an empty queue


class Queue(Model):
    """The state is (values held, whether a read waits, the values due as a 1-tuple, NULL or
    None)."""

    input_names = {"write", "read", "tryread"}
    output_names = {"message", "null"}
    has_actors = True

    def __init__(self, size: int, drops_oldest: bool) -> None:
        self.size = size
        self.drops_oldest = drops_oldest
        self.initial = ((), False, None)

    def actor(self, name: str) -> str:
        return "writer" if name == "write" else "reader"

    def steps(self, state: tuple, action: Action) -> list[tuple]:
        held, waits, _ = state
        name, values = action
        if name == "read" and not values and not waits:
            return [(held[1:], False, (held[0],))] if held else [((), True, None)]
        if name == "tryread" and not values and not waits:
            return [(held[1:], False, (held[0],)) if held else ((), False, NULL)]
        if name == "write":
            if waits:
                return [((), False, (values,))]
            if len(held) < self.size:
                return [(held + (values,), False, None)]
            if self.drops_oldest:
                return [((held + (values,))[1:], False, None)]
        return []

    def reaches(self, state: tuple, outputs: set[str], without: set[str]) -> bool:
        held, waits, due = state
        if due is not None:
            return ("null" if due == NULL else "message") in outputs
        if not waits and "tryread" not in without and "null" in outputs:
            return True
        if "message" not in outputs:
            return False
        written = "write" not in without
        reads = not {"read", "tryread"} <= without
        return written if waits else reads and bool(held or written)

    def outputs(self, state: tuple) -> list[tuple[Action, tuple]]:
        held, _, due = state
        if due is None:
            return []
        action = ("null", ()) if due == NULL else ("message", due[0])
        return [(action, (held, False, None))]


def model_of(description: dict, folder: str, constant: Any) -> Model:
    """The model that an entry of `models` or a topic describes; `constant` evaluates numbers."""
    if "file" in description:
        path = os.path.join(folder, description["file"])
        if not os.path.exists(path):
            raise Refused(f"no file {path}")
        return Automaton(path)
    options = description.get("with") or {}
    kind = description.get("use")
    if kind == "semaphore":
        return Semaphore(constant(options["count"]))
    if kind == "queue":
        drops = "depth" in options
        return Queue(constant(options["depth" if drops else "size"]), drops)
    raise Refused(f"no model: {description}")
