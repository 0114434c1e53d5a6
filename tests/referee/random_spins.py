"""Random small systems whose start code, or the code of `main:`, gives the callbacks of an executor
their turns."""

from __future__ import annotations

import re

from random_calls import CallMaker
from random_presence import Part


class SpinMaker(CallMaker):
    """Makes systems that spin."""

    def spin_system(self) -> str:
        """The system's file."""
        rng = self.rng
        self.code_name = ""
        self.services: list[str] = []
        self.offered: set[str] = set()
        self.does_offer: set[str] = set()
        self.mortal: list[str] = []
        self.has_mutex = self.chance(0.2)
        self.has_misspin = self.chance(0.06)
        self.rounds = self.chance(0.35)
        has_main = self.chance(0.85)
        executor = self.new("e")
        nodes = [Part(self.new("n"), True, executor=executor)]
        if self.chance(0.3):
            nodes.append(Part(self.new("n"), True, executor=executor))
        others = [Part(self.new("p"), False) for _ in range(rng.choice([0, 1, 1, 1]))]
        if self.chance(0.2):
            others.append(Part(self.new("n"), True))
        parts = nodes + others
        lines = ["models: {m: {use: mutex}}"] if self.has_mutex else []
        lines += self.spin_services(nodes, others) + self.spin_topics(parts)
        texts: list[str] = []
        for node in [part for part in parts if part.is_node]:
            texts += self.presence_node(node)
        order = ", order: rounds" if self.rounds else ""
        kind = f"kind: single{order}"
        if not has_main and not self.rounds and self.chance(0.3):
            kind = "kind: multi, threads: 2"
        lines += ["executors:", f"  {executor}:", *(f"    {key}" for key in kind.split(", "))]
        if has_main:
            lines += self.entry_of("    main", self.spin_main(nodes[0]))
        lines += ["nodes:", *texts]
        programs = [part for part in parts if not part.is_node]
        if programs:
            lines.append("programs:")
        self.code_name = ""
        for program in programs:
            lines += self.entry_of(f"  {program.name}", self.presence_program(program))
        for service in self.services:
            self.atoms += [f"{service}.send", f"{service}!request", f"{service}!answer"]
        text = "\n".join(lines)
        self.atoms = [atom for atom in self.atoms if self.is_there(atom, text)]
        return "\n".join(lines + self.properties()) + "\n"

    def spin_services(self, nodes: list[Part], others: list[Part]) -> list[str]:
        """Services, as lines, of which nodes that are spun are clients."""
        rng = self.rng
        lines = ["services:"] if self.chance(0.8) else []
        for _ in range(rng.choice([1, 1, 1, 2]) if lines else 0):
            name = self.new("f")
            server = rng.choice(others * 3 + nodes)
            client = nodes[0] if self.chance(0.8) else rng.choice(nodes)
            clients = [client]
            more = [part for part in nodes + others if part is not client]
            if more and self.chance(0.2):
                clients.append(rng.choice(more))
            server.serves.append(name)
            for part in clients:
                part.asks.append(name)
            self.services.append(name)
            if self.chance(0.15):
                self.offered.add(name)
            lines.append(self.service_line(name, server.name, [part.name for part in clients]))
        return lines

    def spin_topics(self, parts: list[Part]) -> list[str]:
        """Topics, as lines, of which nodes that are spun are readers."""
        rng = self.rng
        lines = ["topics:"] if self.chance(0.55) else []
        for _ in range(rng.choice([1, 1, 2]) if lines else 0):
            name = self.new("t")
            writer = rng.choice(parts)
            reader = parts[0] if self.chance(0.7) else rng.choice(parts)
            writer.writes.append(name)
            reader.reads.append(name)
            self.atoms += [f"{name}.write", f"{name}!message"]
            options = f"{rng.choice(['size', 'depth', 'depth'])}: {rng.choice([1, 1, 2])}"
            entry = f"use: queue, with: {{{options}}}{self.delivery(name)}"
            ends = f"writers: [{writer.name}], readers: [{reader.name}]"
            lines.append(f"  {name}: {{{ends}, {entry}}}")
        return lines

    # --- code

    def presence_clients(self, node: Part) -> list[str]:
        """What the entry of a node says of its clients, who may wait all the same."""
        lines = super().presence_clients(node)
        if self.kind == "spins" and self.chance(0.8):
            node.hears.clear()
        return lines

    def presence_condition(self, node: Part) -> str:
        """An expression that is true or false."""
        if self.kind == "spins" and not self.services + node.flags + node.numbers:
            return "true"
        return super().presence_condition(node)

    def presence_action(self, part: Part, depth: int) -> list[str]:
        """A few statements of a node's code or of a program."""
        if self.kind != "spins":
            return super().presence_action(part, depth)
        if self.code_name in ("start", "main") and self.chance(0.65):
            return self.spin_action(part, depth)
        if self.has_misspin and part.is_node and self.chance(0.15):
            return [self.rng.choice(["spin;", "spin some;", "spin all 2;"])]
        if not self.services:
            options = [self.marked(part, "skip;")]
            options += [f"{topic}.write;" for topic in part.writes] * 3
            value = self.rng.choice(["true", "false"])
            options += [f"{flag} = {value};" for flag in part.flags] * 2
            return [self.rng.choice(options)]
        return super().presence_action(part, depth)

    def spin_main(self, node: Part) -> list[str]:
        """The code of `main:`."""
        rng = self.rng
        self.code_name = "main"
        lines = []
        if self.chance(0.2):
            lines.append("var k: 0..2;")
        for _ in range(rng.choice([1, 1, 2, 2, 3])):
            lines += self.presence_action(node, 1)
        if not any("spin" in line for line in lines):
            lines += self.spin_action(node, 1)
        if lines[0].startswith("var"):
            where = rng.randrange(1, len(lines) + 1)
            if "{" not in "".join(lines):
                lines.insert(where, "k = (k + 1) % 3;")
        if self.chance(0.25) and self.surely_spins(lines):
            first = 1 if lines[0].startswith("var") else 0
            lines = [*lines[:first], "loop {", *lines[first:], "}"]
        elif self.chance(0.3):
            lines.append(self.marked(node, "spin;"))
        elif self.chance(0.5):
            label = self.new("l")
            self.atoms += [f"{node.name}.main@{label}"] * 3
            lines.append(f"@{label} skip;")
        return lines

    @staticmethod
    def surely_spins(lines: list[str]) -> bool:
        """Whether it spins in no block, and without a time limit, so that it may go round for ever:
        Maide does not look what other code keeps from starting."""
        depth = 0
        for line in lines:
            if depth == 0 and re.match(r"(@\w+ )?spin ", line) and "timeout" not in line:
                return True
            depth += line.count("{") - line.count("}")
        return False

    def spin_action(self, part: Part, depth: int) -> list[str]:
        """A statement that spins, or several."""
        rng = self.rng
        rounds = self.rounds and part.executor is not None
        options = ["some"] * 3 + ["all"] * 3 + ["forever"] * self.chance(0.15)
        if not rounds:
            options += ["once"] * 2 + ["until"] * 6 * bool(part.asks)
        options += ["wait"] * bool(part.asks)
        options += ["while"] * 2 * (depth > 0)
        kind = rng.choice(options)
        if kind == "forever":
            return [self.marked(part, "spin;")]
        if kind in ("some", "all"):
            limit = f" {rng.choice([1, 1, 2, 3])}" if self.chance(0.35) else ""
            return [self.marked(part, f"spin {kind}{limit};")]
        if kind == "while":
            is_known = part.flags + part.numbers + self.services
            test = self.presence_condition(part) if is_known else "*"
            inner = [rng.choice(["spin some;", "spin all 1;", "spin some 1;"])]
            if not rounds and self.chance(0.5):
                inner = ["spin once;"]
            if test == "*":
                return ["loop {", *inner, "if * { break; }", "}"]
            return [f"while ({test}) {{", *inner, "}"]
        if kind == "wait":
            service = rng.choice(part.asks)
            spins = "spin some;" if rounds or self.chance(0.5) else "spin once;"
            take = rng.choice([f"wait {service} -> answer;",
                               f"select {{ on {service}!answer {{ }} timeout 5 {{ }} }}"])
            return [f"{service}.send;", spins, self.marked(part, take)]
        late = ";"
        if self.chance(0.4):
            inner = " ".join(self.presence_action(part, 0)) if depth and self.chance(0.5) else ""
            late = f" timeout 5 {{ {inner} }}"
        if kind == "once":
            return [self.marked(part, f"spin once{late}")]
        service = rng.choice(part.asks)
        send = [f"{service}.send;"] * (0 if self.chance(0.08) else 2 if self.chance(0.1) else 1)
        return [*send, self.marked(part, f"spin until {service} -> answer{late}")]
