"""Random small systems for the comparison of Maide with the referee.

    generate.py --seed S --count N --only KIND FOLDER

Each system is a folder FOLDER/KIND-S-K with `system.yaml` and the DOT files of its models.
"""

from __future__ import annotations

import argparse
import random
import re
from pathlib import Path

from random_models import Known, Place
from random_lives import LifeMaker

KINDS = [
    "section5", "variables", "shared", "select", "arrays", "error", "values", "topics",
    "components", "builtins", "mixed", "death", "services", "nodes", "wires",
]  # fmt: skip


# Kinds of what Maide does not know yet: the comparison makes them where it is asked to.
AHEAD = ["presence", "calls", "locks", "spins", "lives"]

# What else a system of the kind `wires` may be, for the rest of them.
WIRED = ["topics", "services", "nodes", "nodes", "death", "builtins"]


class Generator(LifeMaker):
    """Makes one system."""

    # --- properties

    def atom(self) -> str:
        """An atom of a formula."""
        if self.atoms and self.chance(0.85):
            return self.rng.choice(self.atoms)
        return "true"

    def formula(self, depth: int) -> str:
        """A formula."""
        if depth == 0 or self.chance(0.1):
            return self.atom()
        op = self.rng.choice(["F", "G", "X", "!", "&&", "||", "->", "U", "R", "W", "G F", "F G"])
        if self.kind == "lives" and op == "X":  # which one step there is in several programs
            op = "G"
        if op in ("F", "G", "X", "!", "G F", "F G"):
            return f"{op} ({self.formula(depth - 1)})"
        return f"(({self.formula(depth - 1)}) {op} ({self.formula(depth - 1)}))"

    def properties(self) -> list[str]:
        """Some properties, as lines."""
        lines = ["properties:"]
        most = 8 if self.kind == "lives" else 4
        for number in range(self.rng.randint(1, most)):
            roll = self.rng.random()
            fairness = self.rng.choice(["none", "weak", "strong"])
            formula = self.formula(self.rng.randint(1, 3))
            if roll < 0.2:
                expression = f"{self.atom()} -> !({self.atom()})"
                lines.append(f'  q{number}: {{always: "{expression}"}}')
            elif roll < 0.35:
                lines.append(f'  q{number}: {{possible: "{self.atom()} && !({self.atom()})"}}')
            else:
                lines.append(f'  q{number}: {{ltl: "{formula}", fairness: {fairness}}}')
        return lines

    # --- the whole

    def program(self, name: str, place: Place) -> list[str]:
        """The text of a program."""
        self.labels = []
        self.declared = ()
        lines = self.declarations(place) if self.has["variables"] else []
        own = place.numbers
        if self.kind in ("services", "nodes") and self.chance(0.65):
            lines = self.plain_program()
            self.atoms += [f"{name}@{label}" for label in self.labels] + [f"{name}@end"]
            return lines
        if any(known.valued and known.valued[0] == "go" for known in self.usable):
            lines.append(f"var {self.new('w')}: {{go, halt}};")
        if self.chance(0.7):
            body = self.nested("loop", place, self.round(place))
        else:
            body = self.block(place, 1, 4)
        self.atoms += [f"{name}@{label}" for label in self.labels] + [f"{name}@end"]
        self.atoms += [f"{name}.{v} == {self.rng.randint(low, high)}" for v, low, high in own]
        return lines + body

    def make_shared(self) -> list[str]:
        """Variables of the file, as lines."""
        if not self.has["shared"]:
            return []
        parts = []
        for _ in range(self.rng.randint(1, 2)):
            if self.chance(0.3):
                name = self.new("s")
                self.shared_truths.append(name)
                parts.append(f"var {name}: bool;")
                self.atoms.append(name)
            else:
                variable = (self.new("s"), 0, self.rng.randint(1, 2))
                self.shared_numbers.append(variable)
                parts.append(f"var {variable[0]}: 0..{variable[2]};")
                self.atoms.append(f"{variable[0]} == {self.rng.randint(0, variable[2])}")
        return [f'variables: "{" ".join(parts)}"']

    def make_topics(self, names: list[str]) -> list[str]:
        """Topics, as lines, whose writers and readers are among the programs."""
        lines = ["topics:"]
        for _ in range(self.rng.randint(1, 2)):
            name = self.new("t")
            readers = self.rng.sample(names, self.rng.randint(1, len(names)))
            writers = self.rng.sample(names, self.rng.randint(1, min(2, len(names))))
            options = ""
            if self.chance(0.5):
                kind = self.rng.choice(["size", "depth"])
                source = f"use: queue, with: {{{kind}: {self.rng.randint(1, 2)}}}"
                known = self.port_known(name, "", False, False)
                if self.is_wired:
                    source = f"use: queue, with: {{{self.depths()}}}"
                    known = self.port_known(name, "", False, self.chance(0.5))
                if self.has["values"] and self.chance(0.5):
                    known.valued = ["0", "1"]
            else:
                written, tryread = self.chance(0.4), self.chance(0.4)
                at_bound = self.rng.choice(["unexplored", "absorbs", "refuses"])
                size = self.rng.randint(1, 2)
                lines_of_port = self.port_lines(size, written, tryread, at_bound)
                self.write(name, self.of_middleware(lines_of_port))
                source = f"file: {name}.dot"
                known = self.port_known(name, "", written, tryread)
                if at_bound == "unexplored":
                    options = f", when_unexplored: {self.rng.choice(['stop', 'wait', 'drop'])}"
                if not written and self.chance(0.25):
                    options += ", deliver: one"
            options += self.delivery(name)
            lines.append(
                f"  {name}: {{writers: [{', '.join(writers)}], readers: [{', '.join(readers)}], "
                f"{source}{options}}}"
            )
            for program in names:
                inputs, outputs = [], []
                if program in writers:
                    inputs.append("write")
                    outputs += [o for o in known.outputs if o == "written"]
                if program in readers:
                    inputs += [i for i in known.inputs if i != "write"]
                    outputs += [o for o in known.outputs if o != "written"]
                if inputs:
                    mine = Known(name, "", inputs, outputs, known.follows, valued=known.valued)
                    self.topics_of.setdefault(program, []).append(mine)
            self.atoms += [f"{name}.write", f"{name}!message"]
            self.atoms += [f"{name}[{reader}]!message" for reader in readers]
        return lines

    def give_ends(self, names: list[str]) -> None:
        """Says which programs stand at the ends of models."""
        for known in self.models:
            if "write" not in known.inputs or self.chance(0.2):
                continue
            writer, reader = self.rng.sample(names, 2)
            roles = [f"writer: {writer}", f"reader: {reader}"]
            if self.chance(0.2):
                roles.remove(self.rng.choice(roles))
            known.entry = f"{known.entry[:-1]}, ends: {{{', '.join(roles)}}}}}"

    def system(self) -> str:
        """The system's file."""
        rng = self.rng
        self.procedures = []
        self.topics_of: dict[str, list[Known]] = {}
        self.declared: tuple = ()
        self.clients_of: dict[str, list[str]] = {}
        count = rng.randint(2, 3) if self.kind != "components" else rng.randint(2, 4)
        if self.kind == "nodes":
            count = rng.randint(1, 2)
        names = [f"p{k}" for k in range(count)]
        topics = self.make_topics(names) if self.has["topics"] else []
        if self.kind == "services":
            topics = self.make_services(names)
        nodes = self.node_system(names) if self.kind == "nodes" else []
        if self.kind == "services" and self.chance(0.3):
            self.make_models(1)
        elif self.kind not in ("topics", "services", "nodes"):
            self.make_models(rng.randint(1, 2) if self.kind != "components" else 3)
        if self.kind == "death":
            self.give_ends(names)
        for known in self.models:
            if "write" in known.inputs and self.is_wired:
                known.entry = f"{known.entry[:-1]}{self.delivery(known.name)}}}"
        for known in self.models:
            suffix = f"[{rng.randrange(known.size)}]" if known.size else ""
            for name in known.inputs:
                self.atoms.append(f"{known.name}{suffix}.{name}")
            self.atoms += [f"{known.name}{suffix}!{output}" for output in known.outputs]
        shared = self.make_shared()
        self.usable = self.models
        procedures = self.make_procedures() if self.models else []
        programs = ["programs:"]
        for name in names:
            self.usable = self.models + self.topics_of.get(name, [])
            if self.kind == "components":
                self.usable = rng.sample(self.models, rng.randint(1, 2))
                if self.chance(0.5):
                    saved = self.has["shared"]
                    self.has["shared"] = False
                    programs += self.entry(name, 0)
                    self.has["shared"] = saved
                    continue
            if not self.usable:
                programs += [f"  {name}: skip;"]
                continue
            size = rng.randint(2, 3) if self.has["arrays"] and self.chance(0.4) else 0
            if name in self.topics_of:
                size = 0
            if self.kind == "services" and self.is_client_alone(name) and self.chance(0.3):
                size = 2
            programs += self.entry(name, size)
        programs += self.writers(programs)
        lines = []
        if nodes:
            return "\n".join(nodes + programs + self.properties()) + "\n"
        if self.models:
            lines.append("models:")
            for known in self.models:
                suffix = f"[k in 0..{known.size - 1}]" if known.size else ""
                lines.append(f"  {known.name}{suffix}: {known.entry}")
        lines += topics if len(topics) > 1 else []
        lines += shared + procedures + programs + self.properties()
        return "\n".join(lines) + "\n"

    def is_client_alone(self, name: str) -> bool:
        """Whether a program is at no service's server end, so that it may be an array."""
        return all("serve" not in known.inputs for known in self.topics_of.get(name, []))

    def writers(self, programs: list[str]) -> list[str]:
        """Programs that write values to the models to which none of the others does."""
        text, lines = "\n".join(programs), []
        for known in self.models:
            if not known.valued or re.search(rf"\b{known.name}(\[[^]]*\])?\.write\(", text):
                continue
            member = "[0]" if known.size else ""
            words = "" if known.valued[0] == "0" else "var w0: {go, halt}; "
            write = f"{known.name}{member}.write({known.valued[0]});"
            lines.append(f'  {self.new("w")}: "{words}{write}"')
        return lines

    def entry(self, name: str, size: int) -> list[str]:
        """A program's entry, as lines."""
        place = Place(2)
        head, shown = name, name
        if size:
            index = self.new("k")
            place.indices = ((index, 0, size - 1),)
            head = f"{name}[{index} in 0..{size - 1}]"
            shown = f"{name}[{self.rng.randrange(size)}]"
        body = self.program(shown, place)
        keys = self.process()
        if self.has["die"] and self.chance(0.6 if self.kind in ("death", "topics") else 0.4):
            keys.append("may_die: true")
        if keys:
            lines = [f"  {head}:", *(f"    {key}" for key in keys), "    do: |"]
            return lines + [f"      {line}" for line in body]
        return [f"  {head}: |", *(f"    {line}" for line in body)]


def awaits_null_in_vain(text: str) -> bool:
    """Whether a system has an arm for `null` beside a queue that nobody tries: it is refused."""
    queues = re.findall(r"^  (\w+): \{writers.* use: queue", text, re.MULTILINE)
    is_awaited = re.search(r"-> null;|null \{", text) is not None
    return is_awaited and any(f"{queue}.tryread" not in text for queue in queues)


def generate(kind: str, seed: int, number: int, folder: Path) -> Path:
    """Writes one system; gives its file."""
    own = folder / f"{kind}-{seed}-{number}"
    own.mkdir(parents=True, exist_ok=True)
    rng = random.Random(f"{kind} {seed} {number}")
    is_wired = kind == "wires"
    if is_wired and rng.random() < 0.35:
        kind = rng.choice(WIRED)
    text = ""
    while not text or is_wired and awaits_null_in_vain(text):
        generator = Generator(rng, kind, own)
        generator.is_wired = is_wired or kind in ("presence", "spins", "lives") and rng.random() < 0.2
        if kind == "presence":
            text = generator.presence_system()
        elif kind == "calls":
            text = generator.call_system()
        elif kind == "locks":
            text = generator.lock_system()
        elif kind == "spins":
            text = generator.spin_system()
        elif kind == "lives":
            text = generator.life_system()
        else:
            text = generator.race_system() if kind == "wires" else generator.system()
    path = own / "system.yaml"
    path.write_text(text, encoding="utf-8")
    return path


def main() -> None:
    """Writes systems."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--only", choices=KINDS + AHEAD, default="section5")
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()
    for number in range(options.count):
        print(generate(options.only, options.seed, number, options.folder))


if __name__ == "__main__":
    main()
