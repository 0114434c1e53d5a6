"""Models of random systems, and what a random system has."""

from __future__ import annotations

from dataclasses import dataclass, field
import random
from pathlib import Path


@dataclass
class Known:
    """What the text of a program must know of a model: what may follow an input at once."""

    name: str
    entry: str
    inputs: list[str]
    outputs: list[str]
    follows: dict[str, set[str]]
    size: int = 0  # of an array
    valued: list[str] = field(default_factory=list)  # values of `write` and `message`


@dataclass
class Place:
    """Where a statement stands, as far as it matters to what may stand there."""

    depth: int
    loops: int = 0
    numbers: tuple = ()  # (name, low, high) of local variables in scope
    truths: tuple = ()
    indices: tuple = ()  # (name, low, high) of constants: indices of `for` and of the program
    in_procedure: bool = False


def settable(place: Place) -> list[tuple]:
    """The variables that may be assigned: those that outputs declare have no range of their own."""
    return [variable for variable in place.numbers if not variable[0].startswith("r")]


class ModelMaker:
    """Makes the models of one system."""

    def __init__(self, rng: random.Random, kind: str, folder: Path) -> None:
        self.rng = rng
        self.kind = kind
        self.folder = folder
        self.models: list[Known] = []
        self.shared_numbers: list[tuple] = []
        self.shared_truths: list[str] = []
        self.labels: list[str] = []
        self.atoms: list[str] = []
        self.places: list[str] = []  # where programs of systems that race may stand
        self.misses: list[str] = []  # where they found nothing
        self.is_late: dict[str, bool] = {}  # whether a connection has wires
        self.fresh = 0
        self.topic_roles: dict[str, tuple[str, list[str]]] = {}
        everything = kind == "mixed"
        self.has = {
            "variables": kind in ("variables", "arrays", "error", "values") or everything,
            "shared": kind in ("shared", "components") or everything,
            "select": kind in ("select", "topics", "builtins", "death", "services", "nodes")
            or everything,
            "arrays": kind == "arrays" or everything,
            "errors": kind == "error" or everything and rng.random() < 0.2,
            "values": kind == "values" or everything,
            "builtins": kind in ("builtins", "components", "values", "death") or everything,
            "topics": kind == "topics" or everything and rng.random() < 0.4,
            "procedures": kind in ("variables", "arrays") or everything,
            "die": rng.random() < {"mixed": 0.3, "topics": 0.5, "death": 1}.get(kind, 0),
        }

    def chance(self, probability: float) -> bool:
        """True with this probability."""
        return self.rng.random() < probability

    def new(self, prefix: str) -> str:
        """A name that is not used yet."""
        self.fresh += 1
        return f"{prefix}{self.fresh}"

    # --- models

    def random_model(self, name: str) -> Known:
        """A random interface automaton, in a file of its own."""
        rng = self.rng
        inputs = ["x", "y", "z"][: rng.randint(1, 3)]
        outputs = ["a", "b"][: rng.randint(1, 2)]
        actor = {n: rng.choice("PQ") for n in inputs + outputs}
        has_actors = self.chance(0.5)
        resting = [f"s{k}" for k in range(rng.randint(1, 4))]
        due = [f"d{k}" for k in range(rng.randint(1, 3))]
        edges, marks = [], {}
        after: dict[str, list[str]] = {}
        for state in due:
            for output in rng.sample(outputs, rng.randint(1, len(outputs))):
                target = rng.choice(due) if self.chance(0.15) else rng.choice(resting)
                edges.append((state, "!" + output, target))
                after.setdefault(state, []).append(output)
        follows: dict[str, set[str]] = {n: set() for n in inputs}
        bounded = self.chance(0.35)
        for state in resting:
            for name_in in inputs:
                if bounded and self.chance(0.2):
                    marks.setdefault(state, []).append(name_in)
                    continue
                if self.chance(0.15):
                    continue
                for _ in range(2 if self.chance(0.1) else 1):
                    target = rng.choice(due) if self.chance(0.45) else rng.choice(resting)
                    edges.append((state, "?" + name_in, target))
                    for output in after.get(target, []):
                        if not has_actors or actor[output] == actor[name_in]:
                            follows[name_in].add(output)
        lines = ["digraph g {", f'  inputs="{",".join(inputs)}";']
        lines.append(f'  outputs="{",".join(outputs)}";')
        if has_actors:
            parts = []
            for one in "PQ":
                words = ["?" + n for n in inputs if actor[n] == one]
                words += ["!" + n for n in outputs if actor[n] == one]
                if words:
                    parts.append(f"{one}: {' '.join(words)}")
            lines.append(f'  actors="{"; ".join(parts)}";')
        lines.append('  __start0 [label="" shape="none"];')
        for state in resting + due:
            mark = f' unexplored="{",".join(marks[state])}"' if state in marks else ""
            lines.append(f'  {state} [label="{state}"{mark}];')
        lines.append("  __start0 -> s0;")
        for left, label, right in dict.fromkeys(edges):
            lines.append(f'  {left} -> {right} [label="{label}"];')
        self.write(name, lines + ["}"])
        policy = ""
        if marks and self.chance(0.6):
            policy = f", when_unexplored: {rng.choice(['stop', 'wait', 'drop'])}"
        return Known(name, f"{{file: {name}.dot{policy}}}", inputs, outputs, follows)

    def write(self, name: str, lines: list[str]) -> None:
        """Writes a model's file."""
        (self.folder / f"{name}.dot").write_text("\n".join(lines) + "\n", encoding="utf-8")

    def port_lines(
        self, size: int, written: bool, tryread: bool, at_bound: str, disconnects: bool = False
    ) -> list[str]:
        """A strict port; its writes may return, its reads may be tried, it may be disconnected."""
        lines = ["digraph g {"]
        inputs = ["write", "read"] + (["tryread"] if tryread else [])
        outputs = ["message"] + (["written"] if written else []) + (["null"] if tryread else [])
        says = disconnects and self.chance(0.5)
        if disconnects:
            inputs.append("disconnect")
            outputs += ["cut"] if says else []
        lines.append(f'  inputs="{",".join(inputs)}";')
        lines.append(f'  outputs="{",".join(outputs)}";')
        writer = "?write" + (" !written" if written else "")
        reader = "?read !message" + (" ?tryread !null" if tryread else "")
        network = "?disconnect" + (" !cut" if says else "")
        if disconnects and self.chance(0.5):
            if self.chance(0.5):
                writer = f"{writer} {network}"
            else:
                reader = f"{reader} {network}"
            disconnects_by = ""
        else:
            disconnects_by = f"; network: {network}" if disconnects else ""
        lines.append(f'  actors="writer: {writer}; reader: {reader}{disconnects_by}";')
        lines.append('  __start0 [label="" shape="none"];')
        lines.append("  __start0 -> k0;")
        edges: list[tuple[str, str, str]] = []
        never = disconnects and at_bound == "unexplored" and self.chance(0.4)
        beyond = "write,disconnect" if never else "write"
        for k in range(size + 1):
            mark = f' [unexplored="{beyond}"]' if k == size and at_bound == "unexplored" else ""
            lines.append(f"  k{k}{mark};")
            if k < size or at_bound == "absorbs":
                up = min(k + 1, size)
                edges.append((f"k{k}", "?write", f"w{up}" if written else f"k{up}"))
                if written:
                    edges.append((f"w{up}", "!written", f"k{up}"))
            if k > 0:
                edges.append((f"k{k}", "?read", f"m{k - 1}"))
                edges.append((f"m{k - 1}", "!message", f"k{k - 1}"))
                if tryread:
                    edges.append((f"k{k}", "?tryread", f"m{k - 1}"))
        edges.append(("k0", "?read", "r"))
        if tryread:
            edges.append(("k0", "?tryread", "n"))
            edges.append(("n", "!null", "k0"))
        if written:  # the message and the return of the write that it wakes come in any order
            edges += [("r", "?write", "rw"), ("rw", "!written", "m0"), ("rw", "!message", "w0")]
            edges.append(("w0", "!written", "k0"))
        else:
            edges.append(("r", "?write", "m0"))
        edges.append(("m0", "!message", "k0"))
        if disconnects:
            edges += self.disconnections(size, written, says, never)
        for left, label, right in dict.fromkeys(edges):
            lines.append(f'  {left} -> {right} [label="{label}"];')
        return lines + ["}"]

    def disconnections(self, size: int, written: bool, says: bool, never: bool) -> list[tuple]:
        """The edges of `disconnect`, and those behind it: what is written is lost."""
        edges = []
        for at in [f"k{k}" for k in range(size + 1)] + ["r"]:
            if at == f"k{size}" and (never or self.chance(0.3)):
                continue  # it was never tried there, or is refused
            after = "dr" if at == "r" else "d"
            edges.append((at, "?disconnect", "c" + after if says else after))
        if says:
            edges += [("cd", "!cut", "d"), ("cdr", "!cut", "dr")]
        for at in ("d", "dr"):
            edges.append((at, "?write", "w" + at if written else at))
            if written:
                edges.append(("w" + at, "!written", at))
        return edges + [("d", "?read", "dr")]

    def port_model(self, name: str) -> Known:
        """A port, in a file of its own."""
        written, tryread = self.chance(0.3), self.chance(0.4)
        at_bound = self.rng.choice(["unexplored", "absorbs", "refuses"])
        disconnects = self.kind == "death" and self.chance(0.6)
        size = self.rng.randint(1, 2)
        self.write(name, self.port_lines(size, written, tryread, at_bound, disconnects))
        policy = ""
        if at_bound == "unexplored":
            policy = f", when_unexplored: {self.rng.choice(['stop', 'wait', 'wait', 'drop'])}"
        return self.port_known(name, f"{{file: {name}.dot{policy}}}", written, tryread)

    @staticmethod
    def port_known(name: str, entry: str, written: bool, tryread: bool) -> Known:
        """What is known of a port."""
        inputs = ["write", "read"] + (["tryread"] if tryread else [])
        outputs = ["message"] + (["written"] if written else []) + (["null"] if tryread else [])
        follows = {"write": {"written"} if written else set(), "read": {"message"}}
        if tryread:
            follows["tryread"] = {"message", "null"}
        return Known(name, entry, inputs, outputs, follows)

    def built_in(self, name: str) -> Known:
        """A built-in model."""
        kind = self.rng.choice(["mutex", "semaphore", "queue", "queue", "last"])
        if kind == "mutex":
            known = Known(name, "{use: mutex}", ["lock", "unlock"], [], {})
        elif kind == "semaphore":
            count = self.rng.randint(1, 2)
            entry = f"{{use: semaphore, with: {{count: {count}}}}}"
            known = Known(name, entry, ["acquire", "release"], [], {})
        else:
            option = "size" if kind == "queue" else "depth"
            entry = f"{{use: queue, with: {{{option}: {self.rng.randint(1, 2)}}}}}"
            follows = {"read": {"message"}, "write": set()}
            known = Known(name, entry, ["write", "read"], ["message"], follows)
            if self.has["values"] and self.chance(0.7):
                known.valued = self.rng.choice([["0", "1"], ["0", "1", "2"], ["go", "halt"]])
        for name_in in known.inputs:
            known.follows.setdefault(name_in, set())
        return known

    def make_models(self, count: int) -> None:
        """The models of the system."""
        for _ in range(count):
            name = self.new("m")
            if self.has["builtins"] and self.chance(0.3 if self.kind == "death" else 0.7):
                known = self.built_in(name)
            elif self.chance(0.9 if self.kind == "death" else 0.35):
                known = self.port_model(name)
            else:
                known = self.random_model(name)
            if self.has["arrays"] and self.chance(0.6):
                known.size = self.rng.randint(2, 3)
            self.models.append(known)
