"""Random small systems of programs that have several requests open, and of servers that answer
some, late, or out of order."""

from __future__ import annotations

from random_locks import LockMaker


class CallMaker(LockMaker):
    """Makes systems of clients that do not wait for each answer."""

    def call_system(self) -> str:
        """The system's file."""
        rng = self.rng
        service, go = self.new("f"), self.new("g")
        clients = [self.new("p") for _ in range(1 if self.chance(0.75) else 2)]
        server = self.new("s")
        is_node = self.chance(0.3)
        is_told = not is_node and self.chance(0.4)
        offers = not is_node and self.chance(0.15)
        words = ["at_once", "at_once", "late"]
        entry = f"server: {server}, clients: [{', '.join(clients)}]"
        entry += f", with: {{depth: {rng.choice([1, 1, 2, 2, 3])}}}, delivery: {rng.choice(words)}"
        lines = ["services:", f"  {service}: {{{entry}}}"]
        if is_told:
            ends = f"writers: [{', '.join(clients)}], readers: {server}"
            lines += ["topics:", f"  {go}: {{{ends}, use: queue, with: {{depth: 1}}, "
                      "delivery: at_once}"]  # fmt: skip
        self.atoms += [f"{service}!{event}" for event in ("request", "answer")]
        self.atoms += [f"{service}.{event}" for event in ("send", "answer", "receive")]
        if is_node:
            callback = f"{{serves: {service}, group: r, do: \"{service}.answer;\"}}"
            lines += ["executors: {e: {kind: multi, threads: 2}}", "nodes:", f"  {server}:",
                      "    executor: e", "    groups: {r: reentrant}",
                      f"    callbacks: {{b: {callback}}}"]  # fmt: skip
        lines.append("programs:")
        if not is_node:
            code = self.call_server(service, go if is_told else None)
            code = [f"offer {service};", *code] if offers else code
            lines += self.call_program(server, code, 0.15)
        for client in clients:
            code = []
            for line in self.open_requests(service):
                label = self.new("l")
                self.atoms.append(f"{client}@{label}")
                code.append(f"@{label} {line}")
            if is_told:
                for _ in range(rng.choice([1, 1, 2])):
                    code.insert(rng.randrange(1, len(code) + 1), f"{go}.write;")
            if offers and self.chance(0.5):
                code.insert(rng.randrange(1, len(code) + 1), f"wait {service} -> there;")
            if self.chance(0.2):
                code = ["loop {", *code, "}"]
            lines += self.call_program(client, code, 0.05)
        return "\n".join(lines + self.properties()) + "\n"

    def call_program(self, name: str, code: list[str], dies: float) -> list[str]:
        """A program's entry, as lines."""
        self.atoms += [f"{name}@end"] * 2
        if self.chance(dies):
            return [f"  {name}:", "    may_die: true", *self.entry_of("    do", code)]
        return self.entry_of(f"  {name}", code)

    def call_server(self, service: str, go: str | None) -> list[str]:
        """The text of a server, which is told when to begin perhaps."""
        rng = self.rng
        idle = "idle " if self.chance(0.8) else ""
        serve, answer = f"{idle}{service}.serve -> request;", f"{service}.answer;"
        told = [f"{idle}{go}.read -> message;"] if go is not None else []
        kind = rng.choice(["loop", "loop", "loop", "some", "some", "leaves", "chooses"])
        if kind == "some":
            return told + [serve, answer] * rng.choice([1, 1, 2, 3])
        if kind == "leaves":  # the first of two is never answered
            return [*told, serve, serve, answer, "loop {", serve, answer, "}"]
        if kind == "chooses":
            return [*told, "loop {", serve, f"if * {{ {answer} }}", "}"]
        inner = told if self.chance(0.4) else []
        return [*(told if not inner else []), "loop {", *inner, serve, answer, "}"]
