"""Random small systems of nodes' start code, threads, timers that come once, `when`, and services
that are offered and withdrawn, and whose servers and clients die."""

from __future__ import annotations

from dataclasses import dataclass, field

from random_wires import WireMaker

EXECUTORS = [
    "{kind: single}", "{kind: single}", "{kind: single, order: rounds}",
    "{kind: single, order: rounds}", "{kind: multi, threads: 2}",
]  # fmt: skip
MORTAL = ["{kind: single, may_die: true}", "{kind: single, order: rounds, may_die: true}"]


@dataclass
class Part:
    """A node or a program of such a system, and what its code may do."""

    name: str
    is_node: bool
    serves: list[str] = field(default_factory=list)
    asks: list[str] = field(default_factory=list)
    hears: list[str] = field(default_factory=list)  # clients with code of their own
    writes: list[str] = field(default_factory=list)
    reads: list[str] = field(default_factory=list)
    flags: list[str] = field(default_factory=list)
    numbers: list[str] = field(default_factory=list)
    groups: list[str] = field(default_factory=list)
    threads: list[str] = field(default_factory=list)
    executor: str | None = None
    may_die: bool = False  # it, or its executor


class PresenceMaker(WireMaker):
    """Makes systems in which what is there changes."""

    def presence_system(self) -> str:
        """The system's file."""
        rng = self.rng
        self.code_name = ""
        self.services: list[str] = []
        self.offered: set[str] = set()  # services that some code may offer
        self.does_offer: set[str] = set()  # and those that some code surely does
        self.mortal: list[str] = []  # services whose server may die
        self.has_mutex = self.chance(0.15)
        nodes = [Part(self.new("n"), True) for _ in range(rng.choice([1, 1, 2, 2, 3]))]
        programs = [Part(self.new("p"), False) for _ in range(rng.choice([0, 1, 1, 2]))]
        parts = nodes + programs
        lines = ["models: {m: {use: mutex}}"] if self.has_mutex else []
        lines += self.presence_services(parts) + self.presence_topics(parts)
        if self.chance(0.25):
            name = self.new("v")
            lines.append(f'variables: "var {name}: 0..1;"')
            self.atoms.append(f"{name} == 1")
            for part in parts:
                part.numbers.append(name)
        executors = [self.new("e") for _ in range(rng.choice([1, 1, 2]))]
        for node in nodes:
            node.executor = rng.choice([*executors, *executors, None])
        self.choose_death(parts)
        lines.append("executors:")
        for name in executors:
            if any(node.may_die for node in nodes if node.executor == name):
                lines.append(f"  {name}: {rng.choice(MORTAL)}")
                continue
            keys = "".join(f", {key}" for key in self.process())
            lines.append(f"  {name}: {rng.choice(EXECUTORS)[:-1]}{keys}}}")
        lines.append("nodes:")
        for node in nodes:
            lines += self.presence_node(node)
        if programs:
            lines.append("programs:")
        for program in programs:
            code = self.presence_program(program)
            if program.may_die:
                lines += [f"  {program.name}:", "    may_die: true", *self.entry_of("    do", code)]
                continue
            lines += self.entry_of(f"  {program.name}", code)
        for service in self.services:
            self.atoms += [f"{service}.there"] * 2
            self.atoms += [f"{service}.send", f"{service}!request", f"{service}!answer"]
        return "\n".join(lines + self.properties()) + "\n"

    def choose_death(self, parts: list[Part]) -> None:
        """Lets a program or executor at an end of a service die, in one system of three."""
        ends = [part for part in parts if part.serves + part.asks]
        ends = [part for part in ends if part.executor is not None or not part.is_node]
        if not ends or not self.chance(0.35):
            return
        servers = [part for part in ends if part.serves]
        chosen = self.rng.choice(servers if servers and self.chance(0.6) else ends)
        for part in parts:
            if part is chosen or part.is_node and part.executor == chosen.executor is not None:
                part.may_die = True
                self.mortal += part.serves

    # --- connections

    def presence_services(self, parts: list[Part]) -> list[str]:
        """Services, as lines."""
        rng = self.rng
        lines = ["services:"]
        for _ in range(rng.choice([1, 1, 1, 2])):
            name = self.new("f")
            server = rng.choice(parts if self.chance(0.5) else parts[:1])
            others = [part for part in parts if part is not server]
            if self.chance(0.06) or not others:
                others = [server]  # it calls itself
            clients = rng.sample(others, min(len(others), 1 if self.chance(0.75) else 2))
            server.serves.append(name)
            for client in clients:
                client.asks.append(name)
            self.services.append(name)
            if self.chance(0.8):
                self.offered.add(name)
            ends = [client.name for client in clients]
            lines.append(self.service_line(name, server.name, ends))
        return lines

    def presence_topics(self, parts: list[Part]) -> list[str]:
        """A topic perhaps, as lines."""
        if self.chance(0.6):
            return []
        rng, name = self.rng, self.new("t")
        writer, reader = rng.choice(parts), rng.choice(parts)
        writer.writes.append(name)
        reader.reads.append(name)
        self.atoms += [f"{name}.write", f"{name}!message"]
        option = rng.choice(["size", "depth", "depth"])
        entry = f"use: queue, with: {{{option}: 1}}{self.delivery(name)}"
        ends = f"writers: [{writer.name}], readers: [{reader.name}]"
        return ["topics:", f"  {name}: {{{ends}, {entry}}}"]

    # --- nodes

    def presence_node(self, node: Part) -> list[str]:
        """The entry of a node."""
        rng = self.rng
        lines = [f"  {node.name}:"]
        if node.executor is not None:
            lines.append(f"    executor: {node.executor}")
        if self.chance(0.3):
            node.groups.append(self.new("g"))
            kind = "exclusive" if self.chance(0.7) else "reentrant"
            lines.append(f"    groups: {{{node.groups[0]}: {kind}}}")
        if self.chance(0.6):
            flag = self.new("v")
            node.flags.append(flag)
            text = f"var {flag}: bool;"
            if self.chance(0.25):
                node.numbers.append(self.new("v"))
                text += f" var {node.numbers[-1]}: 0..1;"
            lines.append(f'    variables: "{text}"')
            self.atoms.append(f"{node.name}.{flag}")
        if not node.may_die and self.chance(0.4):
            node.threads.append(self.new("w"))
        lines += self.presence_clients(node)
        if self.chance(0.6) or self.offers(node) and self.chance(0.5):
            lines += self.entry_of("    start", self.presence_code(node, "start", 1))
        lines += self.presence_callbacks(node)
        if node.threads:
            lines.append("    threads:")
        for thread in node.threads:
            code = self.presence_code(node, thread, rng.randint(1, 2))
            if self.chance(0.2):
                lines.append(f"      {thread}:")
                lines.append("        count: 2")
                lines += self.entry_of("        do", code)
            else:
                lines += self.entry_of(f"      {thread}", code)
        return lines

    def presence_clients(self, node: Part) -> list[str]:
        """What the entry of a node says of its clients."""
        entries = []
        for service in node.asks:
            if self.chance(0.2):
                node.hears.append(service)
                code = " ".join(self.presence_code(node, service, 1))
                entries.append(f"      {service}: {{do: \"{code}\"}}")
            elif node.groups and self.chance(0.6):
                entries.append(f"      {service}: {node.groups[0]}")
        return ["    clients:", *entries] if entries else []

    def presence_callbacks(self, node: Part) -> list[str]:
        """The callbacks of a node."""
        heads = [f"serves: {service}" for service in node.serves]
        heads += [f"takes: {topic}.read" for topic in node.reads]
        if self.chance(0.75) or not heads:
            heads.append("timer: once 1" if self.chance(0.8) else "timer: 1")
        lines = ["    callbacks:"]
        for head in heads:
            name = self.new("b")
            lines += [f"      {name}:", f"        {head}"]
            if node.groups and self.chance(0.5):
                lines.append(f"        group: {node.groups[0]}")
            if self.chance(0.3):
                lines.append(f'        when: "{self.presence_condition(node)}"')
            code = self.presence_code(node, name, self.rng.randint(1, 2))
            if head.startswith("serves") and self.chance(0.95):
                at = 0 if self.chance(0.6) else len(code)
                code.insert(at, f"{head.split()[1]}.answer;")
            lines += self.entry_of("        do", code)
        return lines

    @staticmethod
    def entry_of(key: str, code: list[str]) -> list[str]:
        """A key and its code, as lines."""
        indent = " " * (len(key) - len(key.lstrip()) + 2)
        return [f"{key}: |", *(indent + line for line in code)]

    # --- code

    def offers(self, part: Part) -> list[str]:
        """The services that this part offers somewhere."""
        return [service for service in part.serves if service in self.offered]

    def presence_condition(self, part: Part) -> str:
        """An expression that is true or false."""
        options = [f"{service}.there" for service in self.services for _ in range(2)]
        options += part.flags + [f"{name} == 1" for name in part.numbers]
        one = self.rng.choice(options)
        one = f"!({one})" if self.chance(0.3) else one
        if self.chance(0.12):
            return f"{one} {self.rng.choice(['&&', '||'])} {self.rng.choice(options)}"
        return one

    def presence_code(self, node: Part, where: str, count: int) -> list[str]:
        """The code of a callback, of a start or of a thread."""
        self.code_name = where
        lines = []
        offers = self.offers(node)
        if offers and self.chance(0.7 if where == "start" else 0.12):
            lines.append(self.offer(self.rng.choice(offers)))
        for _ in range(count):
            lines += self.presence_action(node, 1)
        if where == "start":
            lines += [f"run {thread};" for thread in node.threads if self.chance(0.3)]
        return lines

    def presence_action(self, part: Part, depth: int) -> list[str]:
        """A few statements of a node's code or of a program."""
        rng = self.rng
        waits = [s for s in part.asks if s not in part.hears]
        where = self.code_name
        options = ["label", "there", "there"] + ["read"] * (depth > 0)
        options += ["write"] * 3 * bool(part.writes) + ["send"] * bool(part.asks)
        options += ["call"] * 3 * bool(waits) + ["select"] * bool(waits)
        options += ["change"] * (3 if self.does_offer & set(part.serves) else bool(part.serves))
        options += ["set"] * 4 * bool(part.flags) + ["number"] * bool(part.numbers)
        options += ["run"] * 4 * bool(part.threads) + ["mutex"] * self.has_mutex
        options += ["choose", "when"] * (depth > 0)
        # Code of callbacks that may go round for ever: Maide does not look what it keeps from
        # starting.
        options += ["while"] * (depth > 0 and (not part.is_node or where in part.threads))
        kind = rng.choice(options)
        if self.chance(0.005):
            return ["unknown;"]
        if kind == "there":
            return [self.marked(part, f"wait {rng.choice(part.asks or self.services)} -> there;")]
        if kind == "write":
            return [f"{rng.choice(part.writes)}.write;"]
        if kind == "send":
            return [self.marked(part, f"{rng.choice(part.asks)}.send;")]
        if kind == "call":
            service = rng.choice(waits)
            take = f"wait {service} -> answer;"
            if not part.is_node:
                if self.chance(0.4):
                    return self.open_requests(service, self.marked(part, "skip;")[:-len("skip;")])
                take = f"{service}.receive -> answer;"
            return [f"{service}.send;", self.marked(part, take)]
        if kind == "select":
            service = rng.choice(waits)
            arm = f"on {service}!answer" if part.is_node else f"on {service}.receive -> answer"
            inner = " ".join(self.presence_action(part, 0))
            return [f"{service}.send;", f"select {{ {arm} {{ }} timeout 5 {{ {inner} }} }}"]
        if kind == "change":
            service = rng.choice(part.serves)
            line = f"withdraw {service};" if service in self.does_offer else "skip;"
            if service in self.offered and self.chance(0.5):
                line = self.offer(service)
            return [line] * (2 if self.chance(0.1) else 1)
        if kind == "set":
            flag = rng.choice(part.flags)
            return [f"{flag} = {rng.choice(['true', 'true', 'false', self.there()])};"]
        if kind == "number":
            name = rng.choice(part.numbers)
            line = rng.choice([f"{name} = 1;", f"{name} = ({name} + 1) % 2;"])
            return [f"atomic {{ {line} }}" if self.chance(0.2) else line]
        if kind == "run":
            thread = rng.choice(part.threads)
            if thread == where:
                return [f"join {thread};"] if self.chance(0.2) else ["skip;"]
            join = [self.marked(part, f"join {thread};")] if self.chance(0.4) else []
            return ([] if join and self.chance(0.3) else [f"run {thread};"]) + join
        if kind == "mutex":
            return ["m.lock;", *(self.presence_action(part, 0) if depth else []), "m.unlock;"]
        if kind in ("read", "choose"):
            test = "*" if kind == "choose" else f"({self.presence_condition(part)})"
            inner = " ".join(self.presence_action(part, 0))
            other = " ".join(self.presence_action(part, 0)) if self.chance(0.5) else ""
            return [f"if {test} {{ {inner} }}" + (f" else {{ {other} }}" if other else "")]
        if kind == "when":
            inner = " ".join(self.presence_action(part, 0))
            other = rng.choice(["timeout 5 { }", "otherwise { }", ""])
            return [f"select {{ when ({self.presence_condition(part)}) {{ {inner} }} {other} }}"]
        if kind == "while":
            service = rng.choice(self.services)
            if self.mortal and self.chance(0.6):
                return [f"while ({rng.choice(self.mortal)}.there) {{ skip; }}"]
            if service not in self.offered:
                return [self.marked(part, f"wait {service} -> there;")]
            inner = " ".join(self.presence_action(part, 0)) if self.chance(0.5) else "skip;"
            return [f"while (!{service}.there) {{ {inner} }}"]
        return [self.marked(part, "skip;")]

    def offer(self, service: str) -> str:
        """The statement that offers a service."""
        self.does_offer.add(service)
        return f"offer {service};"

    def there(self) -> str:
        """Whether some service is there."""
        return f"{self.rng.choice(self.services)}.there"

    def marked(self, part: Part, line: str) -> str:
        """The statement, with a label before it perhaps."""
        if line != "skip;" and self.chance(0.6):
            return line
        label = self.new("l")
        if part.is_node and self.code_name not in part.asks:
            self.atoms.append(f"{part.name}.{self.code_name}@{label}")
        self.atoms.append(f"{part.name}@{label}")
        return f"@{label} {line}"

    # --- programs

    def presence_program(self, program: Part) -> list[str]:
        """The text of a program: what it does at each of its ends, once or again and again."""
        rng = self.rng
        self.atoms.append(f"{program.name}@end")
        first, lines = [], []
        for service in program.serves:
            if service in self.offered and self.chance(0.8):
                first.append(self.offer(service))
            idle = "idle " if self.chance(0.8) else ""
            inner = self.presence_action(program, 0) if self.chance(0.3) else []
            lines += [f"{idle}{service}.serve -> request;", *inner, f"{service}.answer;"]
        for topic in program.reads:
            lines.append(f"{'idle ' if self.chance(0.7) else ''}{topic}.read -> message;")
        if not lines or self.chance(0.4):
            for _ in range(rng.randint(1, 2)):
                lines += self.presence_action(program, 1)
        if self.chance(0.25):
            first += self.presence_action(program, 0)
        needs_loop = program.serves or program.reads
        if self.chance(0.75 if needs_loop else 0.25):
            # Each round makes a step.
            return first + ["loop {", *lines, *([] if needs_loop else ["if * { break; }"]), "}"]
        return first + lines
