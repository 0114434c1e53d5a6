"""Random services, executors and nodes."""

from __future__ import annotations

from dataclasses import dataclass, field
import random

from random_models import Known, Place
from random_texts import TextMaker

SERVER = {"serve": {"request"}, "answer": set()}
CLIENT = {"send": set(), "receive": {"answer"}}


@dataclass
class Callback:
    """A callback of a random node."""

    name: str
    head: str  # `takes: "t0.read"` and the like
    group: str | None
    serves: str | None = None
    outcomes: list[str] = field(default_factory=list)  # if its code is one for each output
    value: str | None = None  # the variable that it binds


@dataclass
class Node:
    """A random node."""

    name: str
    size: int = 0  # of an array
    callbacks: list[Callback] = field(default_factory=list)
    writes: list[str] = field(default_factory=list)  # statements
    asks: list[str] = field(default_factory=list)  # the services of which it is a client
    own_code: set[str] = field(default_factory=set)
    numbers: list[tuple] = field(default_factory=list)
    groups: dict[str, str] = field(default_factory=dict)

    def member(self, rng: random.Random) -> str:
        """A member of the array, or the node."""
        return f"{self.name}[{rng.randrange(self.size)}]" if self.size else self.name


class NodeMaker(TextMaker):
    """Makes services and nodes."""

    def delivery(self, name: str) -> str:
        """What an entry says of its wires."""
        return ""

    def process(self) -> list[str]:
        """A key of a program or executor that says in which process it is."""
        return []

    def of_middleware(self, lines: list[str]) -> list[str]:
        """A model's file that says what it is of."""
        return lines

    # --- services between programs

    def make_services(self, names: list[str]) -> list[str]:
        """Services, as lines, whose servers and clients are among the programs."""
        lines = ["services:"]
        for _ in range(1 if self.chance(0.7) else 2):
            name = self.new("f")
            server = self.rng.choice(names)
            others = [n for n in names if n != server] or names
            clients = self.rng.sample(others, self.rng.randint(1, len(others)))
            if self.chance(0.1) and server not in clients:
                clients.append(server)
            lines.append(self.service_line(name, server, clients))
            self.note_service(name, server, clients)
        return lines

    def service_line(self, name: str, server: str, clients: list[str]) -> str:
        """The entry of a service."""
        rmw = self.rng.choice(["", "", ", rmw: fastrtps", ", rmw: cyclonedds"])
        depth = f", with: {{depth: {self.rng.randint(1, 2)}{rmw}}}"
        depth += self.delivery(name)
        return f"  {name}: {{server: {server}, clients: [{', '.join(clients)}]{depth}}}"

    def note_service(self, name: str, server: str, clients: list[str]) -> None:
        """Notes what programs may do with a service."""
        known = Known(name, "", ["serve", "answer"], ["request"], SERVER)
        self.topics_of.setdefault(server, []).append(known)
        for client in clients:
            known = Known(name, "", ["send", "receive"], ["answer"], CLIENT)
            self.topics_of.setdefault(client, []).append(known)
        self.clients_of[name] = clients
        self.atoms += [f"{name}.{i}" for i in ("send", "serve", "answer", "receive")]
        self.atoms += [f"{name}!request", f"{name}!answer"]

    def open_requests(self, service: str, label: str = "") -> list[str]:
        """What a program does that has several requests open, or gives some up."""
        rng = self.rng
        lines = [f"{service}.send;"]
        for _ in range(rng.choice([2, 2, 3, 3, 4])):
            other = rng.choice(["timeout 9", "timeout 9", "otherwise"])
            arm = f"{service}.receive -> answer" if self.chance(0.8) else f"{service}!answer"
            inner = rng.choice(["", f" {service}.send; ", " stop; "])
            behind = rng.choice(["", f" {service}.send; "])
            lines += rng.choice([
                [f"{service}.send;"],
                [f"{service}.send;"],
                [f"select {{ on {arm} {{{inner}}} {other} {{{behind}}} }}"],
                [f"select {{ on {arm} {{{inner}}} {other} {{{behind}}} }}"],
                [f"{service}.receive -> answer;"],
                [f"wait {service} -> answer;"],
            ])  # fmt: skip
        if self.chance(0.05):
            lines.append(f"{service}.receive;")
        at = rng.randrange(1, len(lines))
        lines[at] = f"{label}{lines[at]}"
        if self.chance(0.7):
            lines.append(f"{service}.receive -> answer;")
        return lines

    def exchange(self, known: Known, place: Place) -> list[str]:
        """A call or a served request, as a program writes it; with more or less of it."""
        rng = self.rng
        label = self.new("l")
        idle = "idle " if self.chance(0.5) else ""
        if "serve" in known.inputs:
            lines = [f"@{label} {idle}{known.name}.serve -> request;", f"{known.name}.answer;"]
            if self.chance(0.25):
                lines.insert(0, f"{known.name}.serve -> request;")
        else:
            lines = [f"{known.name}.send;", f"@{label} {known.name}.receive -> answer;"]
            if self.chance(0.25):
                lines.insert(0, f"{known.name}.send;")
            if self.chance(0.3):
                lines = self.open_requests(known.name, f"@{label} ")
            elif self.chance(0.2):
                lines[-1] = f"{known.name}.receive;"
                lines.append(f"@{label} wait {known.name} -> answer;")
        if self.chance(0.1):
            lines.pop(rng.randrange(len(lines)))
        if any(f"@{label} " in line for line in lines):
            self.labels.append(label)
        if self.chance(0.2) and place.depth > 0:
            lines += self.block(Place(**{**place.__dict__, "depth": 0}), 1, 1)
        return lines

    def stepping(self, place: Place) -> list[str]:
        known = [k for k in self.usable if k.follows in (SERVER, CLIENT)]
        if known and self.chance(0.6):
            return self.exchange(self.rng.choice(known), place)
        return super().stepping(place)

    def plain_round(self) -> list[str]:
        """What a server, client, writer or reader does, without mistakes."""
        known = self.rng.choice(self.usable)
        label = self.new("l")
        other = [] if self.chance(0.8) else self.plain_round()
        lines = self.plain_lines(known, label, other)
        if any(f"@{label} " in line for line in lines):
            self.labels.append(label)
        return lines

    def plain_lines(self, known: Known, label: str, other: list[str]) -> list[str]:
        """What it does with one service or model, and in between something else."""
        if "serve" in known.inputs:
            idle = "idle " if self.chance(0.8) else ""
            serve = f"@{label} {idle}{known.name}.serve -> request;"
            return [serve, *other, f"{known.name}.answer;"]
        if "send" in known.inputs:
            receive = f"@{label} {known.name}.receive -> answer;"
            if self.chance(0.3):
                return [*self.open_requests(known.name, f"@{label} "), *other]
            if self.chance(0.2):
                receive = f"select {{ on {known.name}.receive -> answer {{ }} timeout 9 {{ }} }}"
            return [f"{known.name}.send;", *other, receive]
        if "lock" in known.inputs:
            return [f"@{label} {known.name}.lock;", *other, f"{known.name}.unlock;"]
        if "read" in known.inputs and ("write" not in known.inputs or self.chance(0.5)):
            idle = "idle " if self.chance(0.7) else ""
            return [f"@{label} {idle}{known.name}.read -> message;", *other]
        given = self.input_text(known, self.rng.choice(known.inputs), known.name, Place(0))
        return [f"@{label} {given};", *other]

    def plain_program(self) -> list[str]:
        """A program that mostly goes on for ever, at each end at which it stands."""
        lines = []
        for known in self.usable:
            saved, self.usable = self.usable, [known]
            if "lock" not in known.inputs or self.chance(0.3):
                lines += self.plain_round()
            self.usable = saved
        if len(lines) < 2 or self.chance(0.3):
            lines += self.plain_round()
        if self.chance(0.25):
            return [f"repeat {self.rng.randint(1, 3)} {{", *lines, "}"]
        return ["loop {", *lines, "}"] if self.chance(0.9) else lines

    # --- nodes

    def make_nodes(self, programs: list[str]) -> list[str]:
        """Executors, nodes, topics and services between them and the programs, as lines."""
        rng = self.rng
        executors = {}
        for _ in range(rng.randint(1, 2)):
            name = self.new("e")
            executors[name] = rng.choice(
                ["{kind: single}", "{kind: single, order: any}", "{kind: single, order: rounds}",
                 "{kind: single, order: rounds}", "{kind: multi, threads: 2}",
                 "{kind: multi, threads: 2}", "{kind: multi, threads: 2}",
                 "{kind: multi, threads: 3}"]
            )  # fmt: skip
        # Looks that find answers to others are rare by chance alone.
        self.shares_clients = self.chance(0.3)
        if self.shares_clients:
            executors[self.new("e")] = "{kind: single, order: rounds}"
        self.nodes = [Node(self.new("n")) for _ in range(rng.randint(1, 2))]
        chosen = {}
        for node in self.nodes:
            chosen[node.name] = rng.choice([*executors, *executors, None])
            if self.shares_clients and self.chance(0.8):
                chosen[node.name] = list(executors)[-1]
            node.size = 2 if self.chance(0.1) else 0
            for kind in ("exclusive", "reentrant"):
                if self.chance(0.6):
                    node.groups[self.new("g")] = kind
        models = self.models_between()
        topics = self.topics_between(programs)
        services = self.services_between(programs)
        for node in self.nodes:
            if self.chance(0.35) or not node.callbacks and not node.asks:
                head = f"timer: {rng.randint(1, 9)}"
                node.callbacks.append(Callback(self.new("b"), head, self.group(node)))
            rng.shuffle(node.callbacks)
        lines = models + (topics if len(topics) > 1 else [])
        lines += services if len(services) > 1 else []
        lines.append("executors:")
        for name, text in executors.items():
            keys = "".join(f", {key}" for key in self.process())
            lines.append(f"  {name}: {text[:-1]}{keys}}}")
        lines.append("nodes:")
        for node in self.nodes:
            lines += self.node_lines(node, chosen[node.name])
        return lines

    def group(self, node: Node) -> str | None:
        """A group of the node, or its own."""
        return self.rng.choice([None, *node.groups])

    def topics_between(self, programs: list[str]) -> list[str]:
        """Topics, most of them with queues, as lines."""
        rng = self.rng
        lines = ["topics:"]
        names = programs + [node.name for node in self.nodes]
        for _ in range(rng.randint(0, 2) if self.chance(0.3) else 1):
            name = self.new("t")
            writers = rng.sample(names, 1 if self.chance(0.7) else 2) if len(names) > 1 else names
            readers = rng.sample(names, rng.randint(1, min(2, len(names))))
            known, source = self.topic_model(name)
            lines.append(
                f"  {name}: {{writers: [{', '.join(writers)}], readers: [{', '.join(readers)}], "
                f"{source}{self.delivery(name)}}}"
            )
            for node in self.nodes:
                if node.name in readers:
                    for _ in range(2 if self.chance(0.12) else 1):
                        self.add_subscription(node, known)
                if node.name in writers:
                    node.writes += self.writing(known)
            for program in programs:
                self.note_ends(program, known, program in writers, program in readers)
            self.atoms += [f"{name}.write", f"{name}!message"]
            for reader in readers:
                members = [node.member(rng) for node in self.nodes if node.name == reader]
                self.atoms.append(f"{name}[{(members or [reader])[0]}]!message")
        return lines

    def note_ends(self, program: str, known: Known, writes: bool, reads: bool) -> None:
        """Notes what a program may do with a topic."""
        inputs = ["write"] * writes + [i for i in known.inputs if i != "write"] * reads
        outputs = [o for o in known.outputs if o == "written"] * writes
        outputs += [o for o in known.outputs if o != "written"] * reads
        if inputs:
            mine = Known(known.name, "", inputs, outputs, known.follows, valued=known.valued)
            self.topics_of.setdefault(program, []).append(mine)

    def topic_model(self, name: str) -> tuple[Known, str]:
        """The model of a topic's readers, and what the file says of it."""
        rng = self.rng
        if self.chance(0.75):
            kind = rng.choice(["size", "depth", "depth"])
            known = self.port_known(name, "", False, False)
            if self.chance(0.25):
                known.valued = ["0", "1"]
            source = f"use: queue, with: {{{kind}: {1 if self.chance(0.75) else 2}}}"
            return known, source
        written, tryread = self.chance(0.5), self.chance(0.5)
        at_bound = rng.choice(["unexplored", "absorbs", "refuses"])
        self.write(name, self.of_middleware(self.port_lines(1, written, tryread, at_bound)))
        source = f"file: {name}.dot"
        if at_bound == "unexplored":
            source += f", when_unexplored: {rng.choice(['stop', 'wait', 'drop'])}"
        return self.port_known(name, "", written, tryread), source

    def writing(self, known: Known) -> list[str]:
        """Statements that write to a topic."""
        if known.valued:
            return [f"{known.name}.write({value});" for value in known.valued]
        if "written" in known.outputs:
            return [f"{known.name}.write -> written;", f"{known.name}.write;",
                    f"switch {known.name}.write {{ written {{ }} quiet {{ }} }}"]  # fmt: skip
        return [f"{known.name}.write;"]

    def add_subscription(self, node: Node, known: Known) -> None:
        """A callback that takes from a topic, or a model."""
        callback = Callback(self.new("b"), "", self.group(node))
        given = self.rng.choice([i for i in known.inputs if i != "write" and known.follows[i]])
        follows = sorted(known.follows[given])
        form = self.rng.random()
        if known.valued and form < 0.6:
            callback.value = self.new("r")
            callback.head = f'takes: "{known.name}.{given} -> message(var {callback.value})"'
        elif form < 0.35 and len(follows) == 1 or form < 0.05:
            callback.head = f'takes: "{known.name}.{given} -> {follows[0]}"'
        else:
            callback.head = f"takes: {known.name}.{given}"
            if form > 0.7:
                callback.outcomes = follows if self.chance(0.95) else follows[:1]
        node.callbacks.append(callback)

    def models_between(self) -> list[str]:
        """Models that callbacks and programs use, as lines."""
        lines = []
        roll = self.rng.random()
        name = self.new("m")
        if roll < 0.25:
            inputs = ["lock", "unlock"]
            known = Known(name, "{use: mutex}", inputs, [], {i: set() for i in inputs})
        elif roll < 0.35:
            known = self.built_in(name)
        elif roll < 0.5:
            known = self.random_model(name)
        else:
            return []
        self.models.append(known)
        lines.append(f"  {name}: {known.entry}")
        takers = [i for i in known.inputs if i != "write" and known.follows[i]]
        node = self.rng.choice(self.nodes)
        if takers and self.chance(0.7):
            self.add_subscription(node, known)
        elif known.outputs and "read" not in known.inputs:
            output = self.rng.choice(known.outputs)
            callback = Callback(self.new("b"), f'takes: "{name}!{output}"', self.group(node))
            node.callbacks.append(callback)
        for other in self.nodes:
            if known.inputs != ["lock", "unlock"] and self.chance(0.6):
                other.writes += [f"{name}.{i};" for i in known.inputs if i != "read"]
        return ["models:", *lines]

    def services_between(self, programs: list[str]) -> list[str]:
        """Services whose ends are programs and nodes, as lines."""
        rng = self.rng
        lines = ["services:"]
        names = programs + [node.name for node in self.nodes] * 2
        for _ in range(1 if self.shares_clients else rng.choice([0, 1, 1, 1, 2])):
            name = self.new("f")
            server = rng.choice(names)
            if any(node.name == server and node.size for node in self.nodes):
                server = programs[0]
            others = sorted(set(names) - {server})
            count = 2 if self.shares_clients or self.chance(0.3) else 1
            clients = rng.sample(others, min(count, len(others)))
            node_of = {node.name: node for node in self.nodes}
            if server in node_of and self.chance(0.3) and server not in clients:
                clients.append(server)  # it calls itself
            lines.append(self.service_line(name, server, clients))
            self.note_service(name, server, clients)
            for client in clients:
                if client in node_of:
                    node_of[client].asks.append(name)
            if server in node_of:
                node = node_of[server]
                group = self.group(node)
                callback = Callback(self.new("b"), f"serves: {name}", group, serves=name)
                node.callbacks.append(callback)
        return lines

    def node_lines(self, node: Node, executor: str | None) -> list[str]:
        """The entry of a node."""
        lines = [f"  {node.name}[i in 0..{node.size - 1}]:" if node.size else f"  {node.name}:"]
        if executor is not None:
            lines.append(f"    executor: {executor}")
        if node.groups:
            groups = ", ".join(f"{name}: {kind}" for name, kind in node.groups.items())
            lines.append(f"    groups: {{{groups}}}")
        if self.chance(0.5):
            node.numbers = [(self.new("s"), 0, 1) for _ in range(1 if self.chance(0.8) else 2)]
            text = " ".join(f"var {name}: 0..{high};" for name, _, high in node.numbers)
            lines.append(f'    variables: "{text}"')
            member = node.member(self.rng)
            self.atoms += [f"{member}.{name} == 1" for name, _, _ in node.numbers]
        entries = []
        for service in node.asks:
            group = self.group(node)
            if self.chance(0.15):
                node.own_code.add(service)
                inner = f"group: {group}, " if group else ""
                code = " ".join(self.code(node, None, 1))
                entries.append(f"      {service}: {{{inner}do: \"{code}\"}}")
            elif group:
                entries.append(f"      {service}: {group}")
        if entries:
            lines += ["    clients:", *entries]
        lines.append("    callbacks:" if node.callbacks else "    callbacks: {}")
        for callback in node.callbacks:
            lines.append(f"      {callback.name}:")
            lines.append(f"        {callback.head}")
            if callback.group:
                lines.append(f"        group: {callback.group}")
            if callback.outcomes:
                lines.append("        do:")
                for output in callback.outcomes:
                    code = self.code(node, callback, self.rng.randint(1, 2))
                    lines.append(f"          {output}: |")
                    lines += [f"            {line}" for line in code]
            else:
                code = self.code(node, callback, self.rng.randint(1, 3))
                lines += ["        do: |", *(f"          {line}" for line in code)]
        return lines

    def code(self, node: Node, callback: Callback | None, count: int) -> list[str]:
        """The code of a callback."""
        lines = []
        if callback is not None and callback.serves and self.chance(0.4):
            lines.append(f"{callback.serves}.answer;")
        for _ in range(count):
            lines += self.action(node, callback, 1)
        if callback is not None and callback.serves and len(lines) <= count and self.chance(0.9):
            if not any(line.endswith(f"{callback.serves}.answer;") for line in lines):
                lines.append(f"{callback.serves}.answer;")
        return lines

    def labelled(self, node: Node, callback: Callback | None, line: str) -> str:
        """The statement with a label before it."""
        if callback is None:
            return line
        label = self.new("l")
        self.atoms.append(f"{node.member(self.rng)}@{label}")
        if self.chance(0.6) and not node.size:
            self.atoms.append(f"{node.name}.{callback.name}@{label}")
        return f"@{label} {line}"

    def action(self, node: Node, callback: Callback | None, depth: int) -> list[str]:
        """A few statements of a callback."""
        rng = self.rng
        waits = [s for s in node.asks if s not in node.own_code]
        options = ["skip", "label"]
        options += ["write"] * 2 * bool(node.writes) + ["send"] * bool(node.asks)
        options += ["call"] * 6 * bool(waits) + ["select"] * 2 * bool(waits)
        options += ["mutex"] * any("lock" in known.inputs for known in self.models)
        options += ["value"] * 3 * bool(callback is not None and callback.value)
        options += ["assign"] * 3 * bool(node.numbers + self.shared_numbers)
        options += (["if", "choose", "local"] + ["test"] * bool(node.numbers)) * (depth > 0)
        options += ["return"] * self.chance(0.1)
        kind = rng.choice(options)
        if kind == "label":
            return [self.labelled(node, callback, "skip;")]
        if kind == "write":
            line = rng.choice(node.writes)
            return [self.labelled(node, callback, line) if self.chance(0.4) else line]
        if kind == "send":
            return [f"{rng.choice(node.asks)}.send;"]
        if kind == "call":
            service = rng.choice(waits)
            sends = [f"{service}.send;"] * (2 if self.chance(0.1) else 1)
            return [*sends, self.labelled(node, callback, f"wait {service} -> answer;")]
        if kind == "select":
            service = rng.choice(waits)
            other = rng.choice(["timeout 5", "otherwise"])
            inner = " ".join(self.action(node, callback, 0))
            sends = [f"{service}.send;"] * self.chance(0.8)
            return [*sends, f"select {{ on {service}!answer {{ }} {other} {{ {inner} }} }}"]
        if kind == "value":
            inner = " ".join(self.action(node, callback, 0))
            return [f"if ({callback.value} == {rng.randint(0, 1)}) {{ {inner} }}"]
        if kind == "mutex":
            model = next(known for known in self.models if "lock" in known.inputs)
            take, give = model.inputs
            inner = self.action(node, callback, 0) if self.chance(0.5) else []
            lines = [f"{model.name}.{take};", *inner, f"{model.name}.{give};"]
            if self.chance(0.1):
                lines.pop(rng.randrange(len(lines)))
            return lines
        if kind == "assign":
            name, _, high = rng.choice(node.numbers * 2 + self.shared_numbers)
            mod = high + 1 if self.chance(0.93) else high + 2
            line = rng.choice([f"{name} = ({name} + 1) % {mod};", f"{name} = {high};",
                               f"{name} = 0;"])  # fmt: skip
            return [f"atomic {{ {line} }}" if self.chance(0.15) else line]
        if kind in ("if", "test", "choose"):
            test = "*"
            if kind == "choose" and self.chance(0.5):
                test = "fair *"
            if kind == "test":
                name, _, high = rng.choice(node.numbers)
                test = f"({name} == {rng.randint(0, high)})"
            inner = " ".join(self.action(node, callback, 0))
            other = " ".join(self.action(node, callback, 0)) if self.chance(0.5) else ""
            return [f"if {test} {{ {inner} }}" + (f" else {{ {other} }}" if other else "")]
        if kind == "local":
            name = self.new("v")
            inner = " ".join(self.action(node, callback, 0))
            choice = f"var {name}: 0..1; {name} = any 0..1;"
            return [choice, f"if ({name} == 1) {{ {inner} }}"]
        return ["return;" if kind == "return" else "skip;"]

    def node_system(self, programs: list[str]) -> list[str]:
        """What stands in the file before the programs."""
        lines = []
        if self.chance(0.3):
            variable = (self.new("s"), 0, 1)
            self.shared_numbers.append(variable)
            lines.append(f'variables: "var {variable[0]}: 0..1;"')
            self.atoms.append(f"{variable[0]} == 1")
        lines += self.make_nodes(programs)
        if not self.clients_of and self.chance(0.25):
            self.has["die"] = True
        return lines
