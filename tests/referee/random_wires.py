"""Random systems in which messages race: what is sent first may arrive last."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from random_nodes import NodeMaker

# What comes when there is nothing.
OTHER = "(?:null|otherwise|timeout [0-9])"
SYSTEMS = [
    "ros2 kind=topic depth=1 history=keep_last reliability=reliable rmw=cyclonedds",
    "ros2 kind=topic depth=2 history=keep_last pub-depth=both rmw=fastrtps",
    "cyclonedds depth=1 history=keep_last reliability=best_effort",
    "fastdds depth=1 history=keep_all reliability=reliable",
    "yarp carrier=tcp kind=strict size=1",
    "yarp carrier=tcp kind=port",
    "zeromq sndhwm=1",
]
WORDS = ["late", "late", "at_once", "acknowledged"]


@dataclass
class Ends:
    """What a program does with connections: their names, with what may be done there."""

    writes: list[str] = field(default_factory=list)
    reads: list[str] = field(default_factory=list)
    serves: list[str] = field(default_factory=list)
    asks: list[str] = field(default_factory=list)


class WireMaker(NodeMaker):
    """Makes systems of topics and services whose wires matter."""

    is_strict = False  # whether the queue that is made refuses what is too much
    is_wired = False  # whether connections of all kinds of systems say how they deliver

    # --- what an entry says of its wires

    def depths(self) -> str:
        """The options of a queue, its writer's among them."""
        rng = self.rng
        self.is_strict = self.chance(0.12)
        if self.is_strict:
            return f"size: {rng.randint(1, 3)}"
        text = f"depth: {rng.randint(1, 3)}"
        roll = rng.random()
        if roll < 0.5:
            text += f", pub-depth: {rng.randint(1, 3)}"
        elif roll < 0.62:
            text += ", pub-history: keep_all"
        return text

    def delivery(self, name: str) -> str:
        """Words of an entry: its delivery, whether it loses, its stream."""
        if not self.is_wired:
            return ", delivery: at_once"
        words = ""
        if self.is_strict and self.chance(0.7):  # else it is at once
            words += ", delivery: late"
            self.is_strict = False
        elif self.chance(0.25) or self.kind == "nodes":
            said = "late" if self.kind == "nodes" and self.chance(0.7) else self.rng.choice(WORDS)
            words += f", delivery: {said}"
            self.is_late[name] = said == "late"
        if self.chance(0.1):
            words += ", loses: true"
        if self.chance(0.15):
            words += f", stream: {self.rng.choice(['one', 'two'])}"
        return words

    def process(self) -> list[str]:
        """A key of a program or executor that says in which process it is."""
        return ["process: one"] if self.is_wired and self.chance(0.1) else []

    def of_middleware(self, lines: list[str]) -> list[str]:
        """A model's file that says what it is of."""
        if not self.is_wired or self.chance(0.5):
            return lines
        sul = self.rng.choice(SYSTEMS)
        return [*lines[:1], f'  sul="{sul}";', *lines[1:]]

    # --- a system of programs that race

    def race_system(self) -> str:
        """The system's file."""
        rng = self.rng
        if self.chance(0.6):
            return self.chain_system()
        names = [f"p{k}" for k in range(rng.choice([2, 2, 3, 3, 3, 4]))]
        ends = {name: Ends() for name in names}
        self.valued: set[str] = set()
        self.is_late: dict[str, bool] = {}
        self.readers_of: dict[str, list[str]] = {}
        self.mutex = self.chance(0.12)
        self.shares = self.chance(0.1)
        lines = ["models: {m: {use: mutex}}"] if self.mutex else []
        lines += self.race_topics(names, ends) + self.race_services(names, ends)
        if self.shares:
            lines.append('variables: "var flag: 0..1;"')
            self.atoms.append("flag == 1")
        lines.append("programs:")
        for name in names:
            lines += self.race_program(name, ends[name])
        return "\n".join(lines + self.race_properties(lines)) + "\n"

    # --- a system in which one tells the next, and some look whether all is there

    def chain_system(self) -> str:
        """The system's file."""
        rng = self.rng
        self.valued = set()
        names = [f"p{k}" for k in range(rng.choice([2, 2, 2, 3, 3]))]
        body: dict[str, list[list[str]]] = {name: [] for name in names}
        topics, services = ["topics:"], ["services:"]
        looks: dict[str, list[list[str]]] = {name: [] for name in names}
        data: dict[str, list[list[str]]] = {name: [] for name in names}
        self.judged = len(names) < 3 and self.chance(0.25)
        for _ in range(rng.choice([1, 1, 1, 2])):
            topics.append(self.chain_data(names, data, looks))
        if self.judged:
            told = ", ".join(names)
            topics.append(f"  v: {{writers: [{told}], readers: o, use: queue, with: {{depth: 2}}}}")
        for name in names:
            body[name] = data[name]
        likely = 0.4 if self.chance(0.25) else 0.9
        for one, other in zip(names, names[1:]):
            if not self.chance(likely):
                continue
            go = self.new("g")
            self.is_late[go] = True
            if self.chance(0.3):
                services.append(f"  {go}: {{server: {one}, clients: [{other}]{self.delivery(go)}}}")
                body[one] = [[f"{go}.serve -> request;"], *body[one], [f"{go}.answer;"]]
                body[other].insert(0, [f"{go}.send;", f"{go}.receive -> answer;"])
                self.atoms += [f"{go}!answer_arrives"] * self.is_late[go]
                continue
            depth = rng.choice([1, 1, 2])
            options = f"use: queue, with: {{depth: {depth}}}{self.delivery(go)}"
            topics.append(f"  {go}: {{writers: {one}, readers: {other}, {options}}}")
            body[one].append([f"{go}.write;"])
            body[other].insert(0, [f"{go}.read -> message;"])
        lines = (topics if len(topics) > 1 else []) + (services if len(services) > 1 else [])
        lines.append("programs:")
        for name in names:
            parts = body[name] + looks[name]
            if len(parts) > 1 and self.chance(0.2):
                at = rng.randrange(len(parts) - 1)
                parts[at], parts[at + 1] = parts[at + 1], parts[at]
            lines += self.chain_program(name, [line for part in parts for line in part])
        if self.judged:
            lines.append('  o: "idle v.read -> message; idle v.read -> message; @both skip;"')
            self.places += ["o@end", "o@both"]
            self.misses.append("o@both")
        return "\n".join(lines + self.race_properties(lines)) + "\n"

    def chain_data(self, names: list[str], data: dict, looks: dict) -> str:
        """A topic of which somebody writes first and somebody looks later; its line."""
        rng = self.rng
        topic = self.new("t")
        self.is_late[topic] = True
        reader = rng.choice(names[1:]) if self.chance(0.85) else names[0]
        others = [name for name in names if name != reader]
        if reader != names[0] and self.chance(0.85):
            others = names[: names.index(reader)]
        writers = rng.sample(others, min(len(others), 2 if self.chance(0.5) else 1))
        readers = [reader]
        others = [name for name in names if name != reader]
        rest = [name for name in others if name not in writers]
        if rest and self.chance(0.4):
            readers += rest[:1]
        if len(writers) > 1 and self.chance(0.6) or self.chance(0.15):
            self.valued.add(topic)
        count = 0
        once = len(writers) > 1 and self.chance(0.5)
        for number, name in enumerate(sorted(writers), 1):
            for again in range(1 if once else rng.choice([1, 1, 2, 2, 3])):
                value = 1 + (number + again + 1) % 2 if len(writers) == 1 else number
                given = f"({value})" if topic in self.valued else ""
                data[name].append([f"{topic}.write{given};"])
                count += 1
        for name in readers:
            looks[name].append(self.chain_look(topic, count))
        self.atoms += [f"{topic}.write", f"{topic}!message", f"{topic}!null"]
        options = self.depths()
        words = self.delivery(topic) if self.is_strict or self.chance(0.3) else ""
        if self.is_late[topic] and self.chance(0.3):
            self.atoms.append(f"{topic}!arrives")
        return (f"  {topic}: {{writers: [{', '.join(writers)}], readers: [{', '.join(readers)}], "
                f"use: queue, with: {{{options}}}{words}}}")  # fmt: skip

    def chain_look(self, topic: str, count: int) -> list[str]:
        """How a reader looks whether all that so many writes sent is there."""
        rng = self.rng
        message = "message(x)" if topic in self.valued else "message"
        miss = f"{self.label()} skip;"
        if self.judged and self.chance(0.8):
            miss = "v.write;"
        rest = f" loop {{ idle {topic}.read -> message; }}" if self.chance(0.3) else ""
        roll = rng.random()
        if topic in self.valued and roll < 0.6:
            late = 2 if self.chance(0.7) else 1
            lines = [f"{topic}.read -> message(x); if (x == {late}) {{ {miss} }}"]
            return [f"{topic}.read -> {message};"] * rng.choice([0, 0, 1]) + lines
        if roll < 0.3:
            count = max(1, count + rng.choice([-2, -1, -1, 0, 0]))
            return [f"{topic}.read -> {message};"] * count + [f"{self.label()} skip;"]
        if roll < 0.8:
            lines = [f"switch {topic}.tryread {{ {message} {{ }} null {{ {miss}{rest} }} }}"]
        else:
            other = rng.choice(["otherwise", "timeout 5"])
            lines = [f"select {{ on {topic}.read -> {message} {{ }} {other} {{ {miss}{rest} }} }}"]
        if self.chance(0.25):
            lines += [f"{topic}.read -> {message};"] * rng.choice([1, 2])
            lines.append(f"{self.label()} skip;")
        return lines

    def chain_program(self, name: str, lines: list[str]) -> list[str]:
        """A program's entry, as lines."""
        body = "\n".join(lines or ["skip;"])
        if "message(x)" in body:
            body = "var x: 0..2;\n" + body
        labels = list(dict.fromkeys(re.findall(r"@(l[0-9]+) ", body)))
        places = [f"{name}@{label}" for label in labels]
        self.misses += places
        self.places += [*places, f"{name}@end"]
        self.atoms += [*places, f"{name}@end"]
        if self.chance(0.1):
            body = "loop {\n" + body + "\n}" if "var x" not in body else body
        head = [f"  {name}: |"]
        keys = ["may_die: true"] * self.may_die(body, 0.06) + self.process()
        if keys:
            head = [f"  {name}:", *(f"    {key}" for key in keys), "    do: |"]
        indent = " " * (len(head[-1]) - len(head[-1].lstrip()) + 2)
        return head + [indent + line for line in body.split("\n")]

    # --- a system of ends that are used at random

    def race_topics(self, names: list[str], ends: dict[str, Ends]) -> list[str]:
        """Topics, as lines."""
        rng = self.rng
        lines = ["topics:"]
        for _ in range(rng.choice([1, 2, 2, 2, 3])):
            name = self.new("t")
            writers = rng.sample(names, 2 if self.chance(0.35) else 1)
            others = [n for n in names if n not in writers] or names
            readers = rng.sample(others, min(len(others), 2 if self.chance(0.3) else 1))
            if self.chance(0.05):
                readers = rng.sample(names, 1)
            options = f"use: queue, with: {{{self.depths()}}}"
            if len(readers) > 1 and self.chance(0.1):
                options += ", deliver: one"
            if self.chance(0.15):
                own = f"{{depth: {rng.randint(1, 3)}}}"
                options += f", readers_with: {{{readers[0]}: {own}}}"
                options = options.replace("size: ", "depth: ")
            if self.chance(0.2):
                self.valued.add(name)
            self.is_late[name] = True
            self.readers_of[name] = readers
            options += self.delivery(name)
            lines.append(
                f"  {name}: {{writers: [{', '.join(writers)}], readers: [{', '.join(readers)}], "
                f"{options}}}"
            )
            for program in writers:
                ends[program].writes.append(name)
            for program in readers:
                ends[program].reads.append(name)
            self.atoms += [f"{name}.write", f"{name}!message", f"{name}!null"]
            if self.is_late[name]:
                self.atoms += [f"{name}!arrives", f"{name}[{readers[0]}]!arrives"]
                self.atoms += [f"{name}!lost"] * self.chance(0.3)
        return lines

    def race_services(self, names: list[str], ends: dict[str, Ends]) -> list[str]:
        """Perhaps a service, as lines."""
        if not self.chance(0.4):
            return []
        name = self.new("f")
        server, *others = self.rng.sample(names, len(names))
        clients = others[: 2 if self.chance(0.3) else 1]
        depth = f", with: {{depth: {self.rng.randint(1, 2)}}}" if self.chance(0.6) else ""
        self.is_late[name] = True
        words = self.delivery(name)
        ends[server].serves.append(name)
        for client in clients:
            ends[client].asks.append(name)
        self.atoms += [f"{name}.send", f"{name}!request", f"{name}.answer", f"{name}!answer"]
        if self.is_late[name]:
            self.atoms += [f"{name}!request_arrives", f"{name}!answer_arrives"]
            self.atoms.append(f"{name}[{clients[0]}]!answer_arrives")
        return ["services:", f"  {name}: {{server: {server}, clients: [{', '.join(clients)}]"
                f"{depth}{words}}}"]  # fmt: skip

    def race_program(self, name: str, ends: Ends) -> list[str]:
        """A program's entry, as lines."""
        self.labels = []
        chains = self.chance(0.6)  # it waits for others, tells others, and then looks
        writes, looks = [], []
        for topic in ends.writes:
            writes += [self.race_write(topic) for _ in range(self.rng.choice([1, 1, 2, 2, 3]))]
        for topic in ends.reads:
            looks += [self.race_read(topic) for _ in range(self.rng.choice([1, 1, 2]))]
        parts = [self.race_serve(service) for service in ends.serves]
        parts += [self.race_ask(service) for service in ends.asks]
        if chains and ends.reads:
            waits = ends.reads if len(ends.reads) == 1 else self.rng.sample(ends.reads, 1)
            topic = waits[0]
            looks = [look for look in looks if topic not in look[0]]
            message = "message(x)" if topic in self.valued else "message"
            parts.insert(0, [f"{topic}.read -> {message};"])
        parts += writes + looks
        if self.mutex and self.chance(0.5):
            parts.append(["m.lock;", "m.unlock;"])
        if self.shares and self.chance(0.6):
            label = self.label()
            parts.append(["flag = 1;"] if self.chance(0.5) else
                         [f"if (flag == 1) {{ {label} skip; }}"])  # fmt: skip
        if not chains:
            self.rng.shuffle(parts)
        most = self.rng.choice([3, 4, 5])
        lines = [line for part in parts[:most] for line in part]
        lines = lines or ["skip;"]
        roll = self.rng.random()
        if roll < 0.15:
            lines = ["loop {", *lines, "}"]
        elif roll < 0.22:
            lines = ["repeat 2 {", *lines, "}"]
        if self.valued and any(topic in self.valued for topic in ends.reads):
            lines.insert(0, "var x: 0..2;")
        body = "\n".join(lines)
        places = [f"{name}@{label}" for label in self.labels if f"@{label} " in body]
        self.misses += [p for p in places if re.search(rf"{OTHER} \{{ {p[len(name):]} ", body)]
        self.atoms += [*places, f"{name}@end"]
        self.places += [*places, f"{name}@end"]
        head = [f"  {name}: |"]
        may_die = self.may_die(body, 0.08) and not ends.serves + ends.asks
        keys = ["may_die: true"] * may_die + self.process()
        if keys:
            head = [f"  {name}:", *(f"    {key}" for key in keys), "    do: |"]
        indent = " " * (len(head[-1]) - len(head[-1].lstrip()) + 2)
        return head + [indent + line for line in body.split("\n")]

    def may_die(self, body: str, probability: float) -> bool:
        """Whether a program of this text may die: not at the end of a service."""
        is_at_service = re.search(r"\.(send|receive|serve|answer)\b", body)
        return self.chance(probability) and not is_at_service

    def label(self) -> str:
        """A label for a statement."""
        label = self.new("l")
        self.labels.append(label)
        return f"@{label}"

    def awaited(self, topic: str) -> str:
        """A topic, or one of its readers."""
        reader = self.rng.choice(self.readers_of[topic])
        return f"{topic}[{reader}]" if self.chance(0.3) else topic

    def race_write(self, topic: str) -> list[str]:
        """A write, and perhaps waiting until it has arrived."""
        value = f"({self.rng.randint(1, 2)})" if topic in self.valued else ""
        write = f"{topic}.write{value};"
        roll = self.rng.random()
        if roll < 0.06:
            return [write, f"{self.label()} wait {self.awaited(topic)} -> arrived;"]
        if roll < 0.08:
            other = self.rng.choice(["otherwise", "timeout 5"])
            arm = f"on {self.awaited(topic)}!arrived {{ }}"
            return [write, f"select {{ {arm} {other} {{ {self.label()} skip; }} }}"]
        if roll < 0.14 and self.is_late[topic]:
            return [f"select {{ on {topic}.write{value} {{ }} otherwise {{ }} }}"]
        return [f"{self.label()} {write}"] if roll < 0.3 else [write]

    def race_read(self, topic: str) -> list[str]:
        """A read, or a look."""
        rng = self.rng
        message = "message(x)" if topic in self.valued else "message"
        test = f" if (x == {rng.randint(1, 2)}) {{ {self.label()} skip; }}"
        test = test if topic in self.valued and self.chance(0.8) else ""
        roll = rng.random()
        if roll < 0.4:
            idle = rng.choice(["idle ", ""])
            return [f"{idle}{topic}.read -> {message};{test}"]
        if roll < 0.75:
            rest = f" loop {{ idle {topic}.read -> message; }}" if self.chance(0.3) else ""
            found = f"{self.label()} skip;" if self.chance(0.4) else ""
            return [f"switch {topic}.tryread {{ {message} {{{test} {found}}} "
                    f"null {{ {self.label()} skip;{rest} }} }}"]  # fmt: skip
        other = rng.choice(["otherwise", "otherwise", "timeout 5"])
        if roll < 0.8:
            return [f"select {{ on {topic}.tryread {{ {message} {{ }} "
                    f"null {{ {self.label()} skip; }} }} }}"]  # fmt: skip
        return [f"select {{ on {topic}.read -> {message} {{{test} }} "
                f"{other} {{ {self.label()} skip; }} }}"]  # fmt: skip

    def race_serve(self, service: str) -> list[str]:
        """A served request."""
        idle = "idle " if self.chance(0.7) else ""
        return [f"{idle}{service}.serve -> request;", f"{service}.answer;"]

    def race_ask(self, service: str) -> list[str]:
        """A call."""
        roll = self.rng.random()
        if self.chance(0.35):
            return self.open_requests(service, f"{self.label()} ")
        if roll < 0.2:
            return [f"{service}.send;", f"select {{ on {service}.receive -> answer {{ }} "
                    f"timeout 9 {{ {self.label()} skip; }} }}"]  # fmt: skip
        if roll < 0.3:
            return [f"{service}.send;"]
        return [f"{service}.send;", f"{self.label()} {service}.receive -> answer;"]

    def race_properties(self, system: list[str]) -> list[str]:
        """Properties over one side and both, as lines."""
        rng = self.rng
        text = "\n".join(system)  # a queue that nobody tries has no null
        untried = [a for a in self.atoms if a.endswith("!null") and f"{a[:-5]}.tryread" not in text]
        self.atoms = [atom for atom in self.atoms if atom not in untried]
        lines = ["properties:"]
        of_each: dict[str, str] = {}  # a place of each program at which it found nothing
        for place in rng.sample(self.misses, len(self.misses)):
            of_each.setdefault(place.split("@")[0], place)
        if len(of_each) > 1 and self.chance(0.7):
            lines.append(f'  all: {{always: "!({" && ".join(of_each.values())})"}}')
        for place in rng.sample(self.misses, min(3, len(self.misses))):
            lines.append(f'  never_{place.replace("@", "_")}: "G !{place}"')
        for number in range(rng.randint(1, 3)):
            one, other = rng.choice(self.places), rng.choice(self.places)
            fairness = rng.choice(["none", "weak", "weak", "strong"])
            roll = rng.random()
            if self.misses and roll < 0.45:
                one = rng.choice(self.misses)
                other = rng.choice(self.misses + self.places[-2:])
            if roll < 0.3:
                lines.append(f'  q{number}: {{always: "!({one} && {other})"}}')
                continue
            formula = f"G !{one}" if roll < 0.45 else f"F {one}"
            if roll >= 0.55:
                formula = self.race_formula(2)
            lines.append(f'  q{number}: {{ltl: "{formula}", fairness: {fairness}}}')
        return lines

    def race_formula(self, depth: int) -> str:
        """A formula, mostly without X."""
        atom = self.rng.choice(self.atoms + self.places)
        if depth == 0 or self.chance(0.1):
            return atom
        op = self.rng.choice(["F", "G", "!", "&&", "||", "->", "U", "R", "W", "G F", "F G"])
        if self.chance(0.03):
            op = "X"
        if op in ("F", "G", "X", "!", "G F", "F G"):
            return f"{op} ({self.race_formula(depth - 1)})"
        return f"(({self.race_formula(depth - 1)}) {op} ({self.race_formula(depth - 1)}))"
