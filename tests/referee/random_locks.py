"""Random small systems of programs, and perhaps a node, that share mutexes, conditions, and what
these guard."""

from __future__ import annotations

import re

from random_presence import EXECUTORS, MORTAL, PresenceMaker


class LockMaker(PresenceMaker):
    """Makes systems of mutexes and conditions."""

    def lock_system(self) -> str:
        """The system's file."""
        rng = self.rng
        self.flags = [self.new("v") for _ in range(rng.choice([1, 1, 2]))]
        self.recursive: dict[str, bool] = {}
        self.conditions: dict[str, str] = {}  # with their mutexes
        self.threads: list[str] = []
        self.place = ""  # in formulas, of labels
        lines = ["models:"]
        for _ in range(rng.choice([1, 1, 1, 2])):
            name = self.new("m")
            self.recursive[name] = self.chance(0.45)
            options = ", with: {recursive: true}" if self.recursive[name] else ""
            lines.append(f"  {name}: {{use: mutex{options}}}")
            self.atoms += [f"{name}.lock", f"{name}.unlock"]
        for _ in range(rng.choice([0, 1, 1, 1, 2])):
            name, mutex = self.new("c"), rng.choice(list(self.recursive))
            self.conditions[name] = mutex
            lines.append(f"  {name}: {{use: condition, with: {{mutex: {mutex}}}}}")
            self.atoms += [f"{name}.wait", f"{name}.notify_one", f"{name}.notify_all"]
            self.atoms += [f"({name}.wait && {mutex}.unlock)"]
        lines.append(f'variables: "{" ".join(f"var {flag}: bool;" for flag in self.flags)}"')
        self.atoms += self.flags
        has_node = self.chance(0.35)
        count = rng.choice([0, 1, 1, 2]) if has_node else rng.choice([1, 2, 2, 2, 2, 3])
        lines += self.lock_node() if has_node else []
        lines += ["programs:"] if count else []
        for _ in range(count):
            name = self.new("p")
            self.place = name
            self.atoms += [f"{name}@end"] * 2
            code = self.lock_program()
            if self.chance(0.2):
                lines += [f"  {name}:", "    may_die: true", *self.entry_of("    do", code)]
            else:
                lines += self.entry_of(f"  {name}", code)
        text = "\n".join(lines)
        self.atoms += [f"{name}!{answer}" for name in self.recursive for answer in ("yes", "no")
                       if f"{name}.trylock" in text]  # fmt: skip
        self.atoms = [atom for atom in self.atoms if self.is_there(atom, text)]
        return "\n".join(lines + self.properties()) + "\n"

    @staticmethod
    def is_there(atom: str, text: str) -> bool:
        """Whether the label that an atom names is there: some were left out."""
        label = atom.partition("@")[2]
        return label in ("", "end") or f"@{label} " in text

    def entry_of(self, key: str, code: list[str]) -> list[str]:
        """A key and its code, a statement a line, which are easier to leave out."""
        if self.kind in ("locks", "spins"):
            code = re.findall(r"[^{};]*[{};]", " ".join(code))
        return super().entry_of(key, [line.strip() for line in code])

    def lock_node(self) -> list[str]:
        """A node on an executor, with callbacks and perhaps threads."""
        rng = self.rng
        node, executor = self.new("n"), self.new("e")
        has_threads = self.chance(0.4)
        may_die = not has_threads and self.chance(0.2)
        options = MORTAL if may_die else [*EXECUTORS, "{kind: multi, threads: 2}"]
        lines = [f"executors: {{{executor}: {rng.choice(options)}}}"]
        lines += ["nodes:", f"  {node}:", f"    executor: {executor}"]
        groups = [self.new("g")] if self.chance(0.6) else []
        for group in groups:
            kind = "exclusive" if self.chance(0.6) else "reentrant"
            lines.append(f"    groups: {{{group}: {kind}}}")
        self.threads = [self.new("w")] if has_threads else []
        if self.chance(0.25):
            self.place = f"{node}.start"
            runs = [f"run {thread};" for thread in self.threads if self.chance(0.4)]
            lines += self.entry_of("    start", [*self.lock_action(1), *runs])
        lines.append("    callbacks:")
        held = [name for name, is_recursive in self.recursive.items() if is_recursive]
        parted = rng.choice(held) if held and self.chance(0.4) else None
        for number in range(2 if parted else rng.choice([1, 1, 2])):
            name = self.new("b")
            self.place = f"{node}.{name}"
            code = self.lock_code(rng.choice([1, 1, 2]))
            if parted is not None:  # one locks, and the other unlocks
                code.insert(number, [f"{parted}.lock;", f"{parted}.unlock;"][number])
            if self.threads and self.chance(0.6):
                code.insert(0, f"run {rng.choice(self.threads)};")
                code += [f"join {self.threads[0]};"] * self.chance(0.3)
            lines += [f"      {name}:", f"        timer: {'once 1' if self.chance(0.8) else '1'}"]
            if groups and self.chance(0.5):
                lines.append(f"        group: {groups[0]}")
            if self.chance(0.2):
                lines.append(f'        when: "{self.lock_test()}"')
            lines += self.entry_of("        do", code)
        if self.threads:
            lines.append("    threads:")
        for name in self.threads:
            self.place = f"{node}.{name}"
            code = self.lock_code(rng.choice([1, 1, 2]))
            if self.chance(0.4):
                lines += [f"      {name}:", "        count: 2", *self.entry_of("        do", code)]
            else:
                lines += self.entry_of(f"      {name}", code)
        return lines

    def lock_program(self) -> list[str]:
        """The text of a program."""
        if self.chance(0.3):
            mutex = self.rng.choice(list(self.recursive))
            body = [f"{mutex}.lock;", *self.lock_inner(mutex, 0), f"{mutex}.unlock;"]
            body += self.lock_action(0) if self.chance(0.4) else []
            return ["loop {", *body, "}"]
        return self.lock_code(self.rng.choice([1, 1, 2, 2, 3]))

    def lock_code(self, count: int) -> list[str]:
        """Some statements."""
        return [line for _ in range(count) for line in self.lock_action(1)]

    def lock_test(self) -> str:
        """A condition."""
        flag = self.rng.choice(self.flags)
        return flag if self.chance(0.5) else f"!{flag}"

    def lock_mark(self) -> str:
        """A label, perhaps."""
        if self.chance(0.7):
            return ""
        label = self.new("l")
        self.atoms += [f"{self.place}@{label}"] * 2
        return f"@{label} "

    def lock_action(self, depth: int) -> list[str]:
        """What is done with a mutex, or with what it guards."""
        rng = self.rng
        mutex = rng.choice(list(self.recursive))
        options = ["section"] * 8 + ["try"] * 3 + ["arm"] * 2
        options += ["set", "skip"]
        options += ["notify"] * 2 * bool(self.conditions)
        options += ["choose", "test"] * (depth > 0)
        options += ["slip"] * self.chance(0.15)
        kind = rng.choice(options)
        mark = self.lock_mark()
        if kind == "section":
            first = f"{mutex}.lock;" if self.chance(0.9) else f"{mutex}.trylock -> yes;"
            return [f"{mark}{first}", *self.lock_inner(mutex, depth), f"{mutex}.unlock;"]
        if kind == "try":
            yes = " ".join([*self.lock_inner(mutex, 0), f"{mutex}.unlock;"])
            no = " ".join(self.lock_action(0)) if depth and self.chance(0.5) else ""
            if self.chance(0.1):
                no = "stop;"
            return [f"{mark}switch {mutex}.trylock {{ yes {{ {yes} }} no {{ {no} }} }}"]
        if kind == "arm":
            return [mark + self.lock_select(mutex, depth)]
        if kind == "notify":
            return [mark + self.lock_notify()]
        if kind == "set":
            return [mark + self.lock_set()]
        if kind in ("choose", "test"):
            test = "*" if kind == "choose" else f"({self.lock_test()})"
            inner = " ".join(self.lock_action(0))
            other = " ".join(self.lock_action(0)) if self.chance(0.4) else ""
            return [f"{mark}if {test} {{ {inner} }}" + (f" else {{ {other} }}" if other else "")]
        if kind == "slip":
            wait = [f"{name}.wait;" for name in self.conditions]
            return [mark + rng.choice([f"{mutex}.unlock;", f"{mutex}.lock;", *wait])]
        return [f"{mark}skip;"]

    def lock_select(self, mutex: str, depth: int) -> str:
        """A select of a mutex."""
        rng = self.rng
        inner = " ".join([*self.lock_inner(mutex, 0), f"{mutex}.unlock;"])
        guard = f"when ({self.lock_test()}) " if self.chance(0.25) else ""
        arm = rng.choice([
            f"{guard}on {mutex}.lock {{ {inner} }}",
            f"{guard}on {mutex}.trylock {{ yes {{ {inner} }} no {{ }} }}",
        ])  # fmt: skip
        if self.chance(0.1):
            arm = rng.choice([f"on {mutex}.trylock -> yes {{ {inner} }}",
                              f"on {mutex}.unlock {{ }}"])  # fmt: skip
        second = ""
        if self.chance(0.3):
            second = f" when ({self.lock_test()}) {{ {self.lock_set()} }}"
        behind = " ".join(self.lock_action(0)) if depth and self.chance(0.3) else ""
        other = rng.choice(["otherwise", "timeout 5", "timeout 5"])
        third = f" {other} {{ {behind} }}" if self.chance(0.7) else ""
        return f"select {{ {arm}{second}{third} }}"

    def lock_inner(self, mutex: str, depth: int) -> list[str]:
        """What is done while a mutex is held."""
        rng = self.rng
        mine = [name for name, other in self.conditions.items() if other == mutex]
        mine = mine or list(self.conditions) * self.chance(0.15)
        lines = []
        for _ in range(rng.choice([0, 1, 1, 1, 2])):
            options = ["set"] * 3 + ["skip"] + ["wait"] * 5 * bool(mine)
            options += ["notify"] * 2 * bool(self.conditions)
            options += ["again"] * (3 * self.recursive[mutex] + self.chance(0.05))
            options += ["other"] * (depth > 0)
            kind = rng.choice(options)
            mark = self.lock_mark()
            if kind == "set":
                lines.append(mark + self.lock_set())
            elif kind == "skip":
                lines.append(f"{mark}skip;")
            elif kind == "notify":
                lines.append(mark + self.lock_notify())
            elif kind == "wait":
                lines.append(mark + self.lock_wait(rng.choice(mine)))
            elif kind == "other":
                lines += self.lock_action(0)
            elif kind == "again":
                if self.chance(0.08):
                    return [*lines, f"{mark}repeat {rng.choice([7, 8])} {{ {mutex}.lock; }}"]
                inner = " ".join([self.lock_set()] * self.chance(0.4))
                if self.chance(0.25):
                    arms = f"yes {{ {inner} {mutex}.unlock; }} no {{ }}"
                    lines.append(f"{mark}switch {mutex}.trylock {{ {arms} }}")
                    continue
                wait = [self.lock_wait(rng.choice(mine))] if mine and self.chance(0.2) else []
                lines += [f"{mark}{mutex}.lock;", *wait, f"{mutex}.unlock;"]
        return lines

    def lock_set(self) -> str:
        """A statement that changes what is guarded."""
        flag = self.rng.choice(self.flags)
        return f"{flag} = {self.rng.choice(['true', 'true', 'false', f'!{flag}'])};"

    def lock_notify(self) -> str:
        """A notification."""
        name = self.rng.choice(list(self.conditions))
        return f"{name}.{self.rng.choice(['notify_one', 'notify_one', 'notify_all'])};"

    def lock_wait(self, condition: str) -> str:
        """A wait at a condition, for something most of the time."""
        is_thread = self.place.split(".")[-1] in self.threads
        may_loop = "." not in self.place or is_thread
        idle = "idle " if may_loop and self.chance(0.15) else ""
        wait = f"{idle}{condition}.wait;"
        if self.chance(0.3):
            late = self.rng.choice(["", "", self.lock_set(), f"{self.lock_mark()}skip;", "stop;"])
            wait = f"{idle}{condition}.wait timeout 5 {{ {late} }}"
        # Code of callbacks that may go round for ever: Maide does not look what it keeps from
        # starting.
        if self.chance(0.6):
            return f"{'while' if may_loop else 'if'} ({self.lock_test()}) {{ {wait} }}"
        return wait
