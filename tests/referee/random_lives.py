"""Random small systems whose processes die, are killed, end, and begin anew."""

from __future__ import annotations

from random_presence import Part
from random_spins import SpinMaker

KINDS = ["single", "single", "single, order: rounds", "multi, threads: 2"]


class LifeMaker(SpinMaker):
    """Makes systems of processes that have several lives."""

    targets: list[str] = []  # whom `kill` and `restart` may name
    own: dict[str, tuple[str, str]] = {}  # of a part (name, kind) of a model of its process alone

    def life_system(self) -> str:
        """The system's file."""
        rng = self.rng
        self.code_name = ""
        self.services: list[str] = []
        self.offered: set[str] = set()
        self.does_offer: set[str] = set()
        self.mortal: list[str] = []
        self.rounds = False
        self.has_mutex = self.chance(0.15)
        counts = [(0, 2), (0, 3), (1, 1), (1, 1), (1, 2), (2, 0), (2, 1)]
        node_count, program_count = rng.choice(counts)
        nodes = [Part(self.new("n"), True) for _ in range(node_count)]
        programs = [Part(self.new("p"), False) for _ in range(program_count)]
        executors = [self.new("e") for _ in range(min(node_count, rng.choice([1, 2])))]
        for node in nodes:
            node.executor = rng.choice(executors)
        executors = [name for name in executors if any(n.executor == name for n in nodes)]
        parts = nodes + programs
        rng.shuffle(parts)
        keys = self.life_keys(executors + [program.name for program in programs])
        for part in parts:
            part.may_die = bool(keys[part.executor or part.name])
        lines = self.life_models(parts, keys)
        lines += self.presence_services(parts) if self.chance(0.8) else []
        lines += self.presence_topics(parts)
        for part in parts:
            if part.may_die:
                self.mortal += part.serves
        if self.chance(0.3):
            name = self.new("v")
            lines.append(f'variables: "var {name}: 0..1;"')
            self.atoms.append(f"{name} == 1")
            some = rng.sample(parts, rng.randint(1, len(parts)))
            for part in some:
                part.numbers.append(name)
        texts = self.life_nodes(nodes, executors, keys)
        if programs:
            texts.append("programs:")
        self.code_name = ""
        for program in programs:
            code = self.presence_program(program)
            if self.chance(0.3):
                code += self.life_action(program)
            if self.chance(0.25):
                code = self.with_variable(program, code)
            own = keys[program.name]
            if own:
                texts += [f"  {program.name}:", *(f"    {key}" for key in own)]
                texts += self.entry_of("    do", code)
            else:
                texts += self.entry_of(f"  {program.name}", code)
        for service in self.services:
            self.atoms += [f"{service}.there"] * 2
            self.atoms += [f"{service}.send", f"{service}!request", f"{service}!answer"]
        self.atoms = [atom for atom in self.atoms if self.is_there(atom, "\n".join(texts))]
        return "\n".join(lines + texts + self.properties()) + "\n"

    def life_models(self, parts: list[Part], keys: dict) -> list[str]:
        """Models, as lines: one for all, and one that a part, or two of one process, have alone."""
        rng, self.own = self.rng, {}
        entries = ["m: {use: mutex}"] * self.has_mutex
        if self.chance(0.4):
            first = rng.choice(parts)
            joined = [p for p in parts if "process: one" in keys[p.executor or p.name]]
            users = joined if first in joined else [first]
            options = ["mutex", "mutex", "semaphore", "condition"]
            options += ["queue"] * 3 * (not any(part.is_node for part in users))
            kind, name = rng.choice(options), self.new("o")
            self.own = {part.name: (name, kind) for part in users}
            entries += {
                "mutex": [f"{name}: {{use: mutex}}"],
                "semaphore": [f"{name}: {{use: semaphore, with: {{count: 1}}}}"],
                "queue": [f"{name}: {{use: queue, with: {{{rng.choice(['size', 'depth'])}: 1}}}}"],
                "condition": [f"k{name}: {{use: mutex}}",
                              f"{name}: {{use: condition, with: {{mutex: k{name}}}}}"],
            }[kind]  # fmt: skip
        return [f"models: {{{', '.join(entries)}}}"] if entries else []

    def own_action(self, part: Part) -> list[str]:
        """A few statements with a model that is its process' own."""
        name, kind = self.own[part.name]
        between = [self.marked(part, "skip;")]
        if self.chance(0.25):
            between = self.life_action(part)
        if kind == "queue":
            return self.rng.choice([
                [f"{name}.write;"], [self.marked(part, f"{name}.read -> message;")],
                [f"{name}.write;", *between, f"{name}.read -> message;"],
            ])  # fmt: skip
        if kind == "condition":
            wakes = self.rng.choice(["notify_one", "notify_all"])
            return self.rng.choice([
                [f"k{name}.lock;", self.marked(part, f"{name}.wait;"), f"k{name}.unlock;"],
                [f"{name}.{wakes};"],
            ])  # fmt: skip
        takes, gives = {"mutex": ("lock", "unlock"), "semaphore": ("acquire", "release")}[kind]
        return [self.marked(part, f"{name}.{takes};"), *between, f"{name}.{gives};"]

    def life_keys(self, names: list[str]) -> dict[str, list[str]]:
        """What stands at each program and executor of its process."""
        rng = self.rng
        keys: dict[str, list[str]] = {name: [] for name in names}
        self.targets = list(names)
        if len(names) > 1 and self.chance(0.35):
            for name in rng.sample(names, 2):
                keys[name].append("process: one")
            self.targets.append("one")
        if self.chance(0.7):
            name = rng.choice(names)
            keys[name].append("may_die: true")
            if self.chance(0.6):
                lives = rng.choice(["true", "true", "true", "1", "2", "2", "4"])
                keys[name].append(f"may_restart: {lives}")
        return keys

    def life_nodes(self, nodes: list[Part], executors: list[str], keys: dict) -> list[str]:
        """The executors and nodes, as lines."""
        rng = self.rng
        texts: list[str] = []
        for node in nodes:
            texts += self.presence_node(node)
        lines = ["executors:"] if nodes else []
        for name in executors:
            kind = rng.choice(KINDS)
            own = [f"kind: {kind}".split(", ")[0], *kind.split(", ")[1:], *keys[name]]
            lines += [f"  {name}:", *(f"    {key}" for key in own)]
            if kind == "single" and self.chance(0.2):
                first = next(node for node in nodes if node.executor == name)
                code = [*self.presence_code(first, "main", 1), *self.spinning()]
                lines += self.entry_of("    main", code)
        return lines + (["nodes:", *texts] if nodes else [])

    def with_variable(self, program: Part, code: list[str]) -> list[str]:
        """The code with a variable of its own, which changes somewhere."""
        name = self.new("v")
        first = self.rng.choice(["", " = true"])
        self.atoms += [f"{program.name}.{name} == {value}" for value in ("true", "false")]
        starts = [at for at, line in enumerate(code) if line.endswith(";")]
        where = self.rng.choice(starts or [0])
        changes = [f"{name} = !{name};"] * (where < len(code))
        return [f"var {name}: bool{first};", *code[:where], *changes, *code[where:]]

    def spinning(self) -> list[str]:
        """How `main:` goes on."""
        options = [["spin;"], ["spin;"], ["spin once;"], ["loop {", "spin some;", "}"]]
        return self.rng.choice(options)

    def life_action(self, part: Part) -> list[str]:
        """A statement with which a process ends, or begins anew."""
        if self.chance(0.25):
            return [self.marked(part, "end;")]
        target = self.rng.choice(self.targets)
        own = {part.name, part.executor}
        if target in own and self.chance(0.6):
            target = self.rng.choice(self.targets)
        return [self.marked(part, f"{self.rng.choice(['kill', 'restart', 'restart'])} {target};")]

    def presence_action(self, part: Part, depth: int) -> list[str]:
        """A few statements of a node's code or of a program."""
        if self.kind != "lives":
            return super().presence_action(part, depth)
        if self.chance(0.2):
            return self.life_action(part)
        if part.name in self.own and self.chance(0.4):
            return self.own_action(part)
        if not self.services:
            return self.plain_action(part)
        return super().presence_action(part, depth)

    def plain_action(self, part: Part) -> list[str]:
        """The same where there is no service."""
        options = [[self.marked(part, "skip;")]]
        options += [[f"{topic}.write;"] for topic in part.writes] * 3
        options += [[f"{flag} = {self.rng.choice(['true', 'false'])};"] for flag in part.flags] * 2
        options += [[f"{name} = ({name} + 1) % 2;"] for name in part.numbers] * 2
        options += [["m.lock;", self.marked(part, "skip;"), "m.unlock;"]] * self.has_mutex
        options += [[f"run {name};"] for name in part.threads if name != self.code_name]
        return self.rng.choice(options)

    def presence_condition(self, part: Part) -> str:
        """An expression that is true or false."""
        if self.kind == "lives" and not self.services + part.flags + part.numbers:
            return "true"
        return super().presence_condition(part)
