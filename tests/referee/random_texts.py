"""The text of programs of random systems."""

from __future__ import annotations

from random_models import Known, ModelMaker, Place, settable

INDENT = "  "


class TextMaker(ModelMaker):
    """Makes the statements of programs."""

    # --- expressions

    def number(self, place: Place, shared: bool = False, depth: int = 1) -> str:
        """An expression that is a small number."""
        rng = self.rng
        names = [n for n, _, _ in place.numbers + place.indices]
        if shared:
            names += [n for n, _, _ in self.shared_numbers]
        if names and self.chance(0.65):
            name = rng.choice(names)
            if depth and self.chance(0.3):
                return f"({name} + {rng.randint(1, 2)}) % {rng.randint(2, 3)}"
            return name
        return str(rng.randint(0, 2))

    def fitting(self, variable: tuple, place: Place, shared: bool = False) -> str:
        """An expression whose value a variable can have; with errors, one that may not fit."""
        name, low, high = variable
        inner = self.number(place, shared)
        size = high - low + 1
        if self.has["errors"] and self.chance(0.3):
            return self.rng.choice(
                [f"{name} + 1", f"{inner} + 1", f"{inner} / {self.number(place, shared)}"]
            )
        if self.chance(0.4):
            return f"{low} + ({name} - {low} + 1) % {size}"
        if low == 0:
            return f"({inner}) % {size}"
        return f"{low} + ({inner}) % {size}"

    def condition(self, place: Place, shared: bool = False) -> str:
        """An expression that is true or false."""
        rng = self.rng
        truths = list(place.truths) + (self.shared_truths if shared else [])
        if truths and self.chance(0.35):
            return rng.choice(["", "!"]) + rng.choice(truths)
        op = rng.choice(["==", "!=", "<", "<=", ">", ">="])
        simple = f"{self.number(place, shared)} {op} {self.number(place, shared, 0)}"
        if self.chance(0.2):
            return f"{simple} {rng.choice(['&&', '||'])} {self.condition(place, shared)}"
        return simple

    # --- statements

    def model(self, place: Place, models: list[Known]) -> tuple[Known, str]:
        """A model, and how it is named here."""
        known = self.rng.choice(models)
        if not known.size:
            return known, known.name
        fits = [n for n, low, high in place.indices if low >= 0 and high < known.size]
        locals_ = [n for n, low, high in place.numbers if low >= 0]
        roll = self.rng.random()
        if fits and roll < 0.4:
            index = self.rng.choice(fits)
        elif fits and roll < 0.5:
            index = f"({self.rng.choice(fits)} + 1) % {known.size}"
        elif locals_ and roll < 0.75:
            index = f"{self.rng.choice(locals_)} % {known.size}"
            if self.has["errors"] and self.chance(0.3):
                index = self.rng.choice(locals_)
        else:
            index = str(self.rng.randrange(known.size))
        return known, f"{known.name}[{index}]"

    def value_for(self, known: Known, place: Place) -> str:
        """A value to write."""
        if known.valued[0] == "0":
            fits = [n for n, low, high in place.numbers if low >= 0 and high < len(known.valued)]
            if fits and self.chance(0.6):
                return self.rng.choice(fits)
        return self.rng.choice(known.valued)

    def input_text(self, known: Known, name: str, text: str, place: Place) -> str:
        """`m.x` or `m.write(v)`."""
        if known.valued and name == "write":
            return f"{text}.{name}({self.value_for(known, place)})"
        return f"{text}.{name}"

    def output_text(self, known: Known, output: str, place: Place) -> tuple[str, tuple]:
        """An output's pattern, and the variables that it declares, (name, low, high)."""
        if not known.valued or output != "message":
            return output, ()
        roll = self.rng.random()
        if roll < 0.25:
            return output, ()
        if roll < 0.4:
            return f"{output}({self.rng.choice(known.valued)})", ()
        if known.valued[0] == "0":
            high = len(known.valued) - 1
            fits = [n for n, low, top in settable(place) if low <= 0 and top >= high]
            if self.has["errors"]:
                fits = [n for n, _, _ in settable(place)]
            if fits and roll < 0.7:
                return f"{output}({self.rng.choice(fits)})", ()
            name = self.new("r")
            return f"{output}(var {name})", ((name, 0, high),)
        return f"{output}(var {self.new('r')})", ()

    def models_for(self, place: Place) -> list[Known]:
        """The models that this program may use."""
        return self.usable

    def stepping(self, place: Place) -> list[str]:
        """A statement that surely makes a step before control goes on."""
        known, text = self.model(place, self.usable)
        name = self.rng.choice(known.inputs)
        given = self.input_text(known, name, text, place)
        if known.outputs and self.chance(0.45):
            return self.switch(known, text, name, place)
        follows = sorted(known.follows[name])
        if follows and self.chance(0.8):
            output, own = self.output_text(known, self.rng.choice(follows), place)
            self.declared += own
            return [f"{given} -> {output};"]
        return [f"{given};"]

    def switch(self, known: Known, text: str, name: str, place: Place) -> list[str]:
        """A switch."""
        given = self.input_text(known, name, text, place)
        outputs = [o for o in known.outputs if self.chance(0.85)]
        follows = known.follows[name]
        arms = []
        for output in outputs:
            if known.valued and output == "message":
                pattern, own = self.output_text(known, output, place)
            else:
                pattern, own = output, ()
            inner = Place(**{**place.__dict__, "numbers": place.numbers + own})
            arms.append((pattern, inner))
        lines = [f"switch {given} {{"]
        for pattern, inner in arms:
            lines += self.arm(pattern, inner)
        if not outputs or self.chance(0.75) or not follows:
            lines += self.arm("quiet", place)
        return lines + ["}"]

    def arm(self, pattern: str, place: Place) -> list[str]:
        """`pattern { ... }`."""
        if self.chance(0.4) or place.depth <= 0:
            return [f"{INDENT}{pattern} {{ }}"]
        body = self.block(Place(**{**place.__dict__, "depth": place.depth - 1}), 1)
        return [f"{INDENT}{pattern} {{", *(INDENT * 2 + line for line in body), INDENT + "}"]

    def select(self, place: Place) -> list[str]:
        """A select."""
        lines = []
        inputs: set[str] = set()
        for _ in range(self.rng.randint(1, 3)):
            guard = ""
            guarded = self.shared_numbers or self.shared_truths or place.numbers or place.truths
            if guarded and self.chance(0.4):
                guard = f"when ({self.condition(place, shared=True)}) "
            if guard and self.chance(0.3):
                lines += self.arm(guard.strip(), place)
                continue
            known, text = self.model(place, self.usable)
            if known.outputs and self.chance(0.35):
                output = self.rng.choice(known.outputs)
                if f"{text}!{output}" in inputs:
                    continue
                inputs.add(f"{text}!{output}")
                pattern = output
                lines += self.arm(f"{guard}on {text}!{pattern}", place)
                continue
            name = self.rng.choice(known.inputs)
            if f"{known.name}.{name}" in inputs:
                continue
            inputs.add(f"{known.name}.{name}")
            given = self.input_text(known, name, text, place)
            follows = sorted(known.follows[name])
            if not follows:
                lines += self.arm(f"{guard}on {given}", place)
            elif len(follows) == 1 and self.chance(0.6):
                lines += self.arm(f"{guard}on {given} -> {follows[0]}", place)
            else:
                if self.has["errors"] and len(follows) > 1 and self.chance(0.5):
                    follows = follows[1:]
                lines.append(f"{INDENT}{guard}on {given} {{")
                for output in follows:
                    lines += [INDENT + line for line in self.arm(output, place)]
                lines.append(INDENT + "}")
        if not lines or self.chance(0.4):
            other = self.rng.choice(["otherwise", "timeout 10"])
            lines += self.arm(other, place)
        idle = "idle " if self.chance(0.15) else ""
        return [f"{idle}select {{", *lines, "}"]

    def assignment(self, place: Place) -> list[str]:
        """An assignment, or an `atomic` of some."""
        rng = self.rng
        truths = list(place.truths)
        if self.has["shared"] and self.shared_numbers + self.shared_truths and self.chance(0.6):
            lines = []
            for _ in range(2 if self.chance(0.3) else 1):
                if self.shared_truths and (not self.shared_numbers or self.chance(0.3)):
                    name = rng.choice(self.shared_truths)
                    value = rng.choice(["true", "false", "!" + name])
                    lines.append(f"{name} = {value};")
                else:
                    variable = rng.choice(self.shared_numbers)
                    reads = self.chance(0.5)
                    value = self.fitting(variable, place, shared=reads)
                    if not reads and variable[0] in value:
                        value = str(rng.randint(variable[1], variable[2]))
                    lines.append(f"{variable[0]} = {value};")
            if self.chance(0.35):
                if self.chance(0.4):
                    test = self.condition(place, shared=True)
                    lines = [f"if ({test}) {{ {' '.join(lines)} }}"]
                if self.chance(0.15):
                    lines = [f"for round in 1..2 {{ {' '.join(lines)} }}"]
                guard = ""
                if self.chance(0.3):
                    guard = f"when ({self.condition(place, shared=True)}) "
                return [f"{guard}atomic {{ {' '.join(lines)} }}"]
            return lines
        if truths and (not settable(place) or self.chance(0.3)):
            shared = bool(self.has["shared"] and self.chance(0.3))
            return [f"{rng.choice(truths)} = {self.condition(place, shared)};"]
        if settable(place):
            variable = rng.choice(settable(place))
            if self.chance(0.35):
                fair = "fair " if self.chance(0.4) else ""
                return [f"{variable[0]} = any {fair}{variable[1]}..{variable[2]};"]
            shared = bool(self.has["shared"] and self.chance(0.4))
            return [f"{variable[0]} = {self.fitting(variable, place, shared)};"]
        return self.stepping(place)

    def block(self, place: Place, least: int = 1, most: int = 3) -> list[str]:
        """Some statements."""
        lines: list[str] = []
        outer = self.declared
        self.declared = ()
        for _ in range(self.rng.randint(least, most)):
            lines += self.statement(place)
            place.numbers += self.declared
            self.declared = ()
        self.declared = outer
        return lines

    def nested(self, head: str, place: Place, body: list[str] | None = None) -> list[str]:
        """`head { ... }`."""
        inner = Place(**{**place.__dict__, "depth": place.depth - 1})
        body = self.block(inner) if body is None else body
        return [f"{head} {{", *(INDENT + line for line in body), "}"]

    def round(self, place: Place) -> list[str]:
        """The body of a loop, which makes a step in every round."""
        inner = Place(**{**place.__dict__, "depth": place.depth - 1, "loops": place.loops + 1})
        saved, self.declared = self.declared, ()
        lines = [] if self.has["errors"] and self.chance(0.1) else self.stepping(inner)
        inner.numbers += self.declared
        self.declared = saved
        return lines + self.block(inner)

    def statement(self, place: Place) -> list[str]:
        """A random statement."""
        rng = self.rng
        options = ["step"] * 6 + ["label"] * 2 + ["skip", "wait"]
        if place.depth > 0:
            options += ["if", "if", "repeat", "loop"]
            if self.has["variables"] or self.has["shared"]:
                options += ["while", "when"] * 2
            if self.has["variables"]:
                options += ["for"]
            if self.has["select"]:
                options += ["select"] * 5
        options += ["stop"] if self.chance(0.2) else []
        if self.has["variables"] or self.has["shared"]:
            options += ["assign"] * 4
        if place.loops and (self.has["variables"] or self.has["shared"]):
            options += ["leave"]
        if self.procedures and not place.in_procedure:
            options += ["call"] * 2
        kind = rng.choice(options)
        if kind == "label" and not place.in_procedure:
            label = self.new("l")
            lines = self.stepping(place)
            self.labels.append(label)
            return [f"@{label} {lines[0]}", *lines[1:]]
        if kind == "skip":
            return ["skip;"]
        if kind == "wait":
            known, text = self.model(place, self.usable)
            if known.outputs:
                idle = "idle " if self.has["select"] and self.chance(0.3) else ""
                output, own = self.output_text(known, rng.choice(known.outputs), place)
                self.declared += own
                return [f"{idle}wait {text} -> {output};"]
        if kind == "if":
            fair = "fair " if self.kind != "section5" and self.chance(0.3) else ""
            return self.nested(f"if {fair}*", place) + self.otherwise(place)
        if kind == "when":
            shared = bool(self.has["shared"] and self.chance(0.6))
            head = f"if ({self.condition(place, shared)})"
            return self.nested(head, place) + self.otherwise(place)
        if kind == "repeat":
            inner = Place(**{**place.__dict__, "loops": place.loops + 1})
            return self.nested(f"repeat {rng.randint(0, 3)}", inner)
        if kind == "loop":
            return self.nested("loop", place, self.round(place))
        if kind == "while":
            shared = bool(self.has["shared"] and self.chance(0.6))
            head = f"while ({self.condition(place, shared)})"
            return self.nested(head, place, self.round(place))
        if kind == "for":
            name = self.new("i")
            high = rng.randint(0, 2)
            inner = Place(**{**place.__dict__, "indices": place.indices + ((name, 0, high),)})
            inner.loops += 1
            return self.nested(f"for {name} in 0..{high}", inner)
        if kind == "select":
            return self.select(place)
        if kind == "stop":
            return [rng.choice(["stop;", "return;"]) if self.kind != "section5" else "stop;"]
        if kind == "leave":
            test = self.condition(place, bool(self.has["shared"] and self.chance(0.3)))
            return [f"if ({test}) {{ {rng.choice(['break', 'continue', 'break'])}; }}"]
        if kind == "assign":
            return self.assignment(place)
        if kind == "call":
            return self.call(place)
        return self.stepping(place)

    def otherwise(self, place: Place) -> list[str]:
        """An `else`, perhaps."""
        if self.chance(0.5):
            return []
        return self.nested("else", place)

    def call(self, place: Place) -> list[str]:
        """A call of a procedure."""
        name, parameters = self.rng.choice(self.procedures)
        arguments = []
        for parameter in parameters:
            if parameter.startswith("n"):
                arguments.append(str(self.rng.randint(0, 2)))
            elif settable(place):
                arguments.append(self.rng.choice(settable(place))[0])
            else:
                return ["skip;"]
        return [f"call {name}({', '.join(arguments)});"]

    def declarations(self, place: Place) -> list[str]:
        """Local variables at the begin of a program."""
        lines = []
        for _ in range(self.rng.randint(1, 2)):
            if self.chance(0.25):
                name = self.new("f")
                lines.append(f"var {name}: bool;")
                place.truths += (name,)
            else:
                low = self.rng.choice([0, 0, 0, 1])
                variable = (self.new("v"), low, low + self.rng.randint(1, 2))
                value = f" = {self.rng.randint(low, variable[2])}" if self.chance(0.4) else ""
                lines.append(f"var {variable[0]}: {low}..{variable[2]}{value};")
                place.numbers += (variable,)
        return lines

    def make_procedures(self) -> list[str]:
        """Procedures of the file, as lines."""
        self.procedures: list[tuple[str, list[str]]] = []
        if not self.has["procedures"] or self.chance(0.3):
            return []
        lines = ["procedures:"]
        name = self.new("go")
        parameters = self.rng.choice([["n0"], ["w0"], ["n0", "w0"], []])
        place = Place(1, in_procedure=True)
        if "w0" in parameters:
            place.numbers += (("w0", 0, 1),)
        self.declared = ()
        known, text = self.model(place, self.usable)
        body = [f"{text}.{self.rng.choice(known.inputs)};"] if not known.valued else ["skip;"]
        if "n0" in parameters:
            body = ["repeat n0 {", *(INDENT + line for line in body), "}"]
        if "w0" in parameters:
            body.append(self.rng.choice(["w0 = any 0..1;", "w0 = 1;", "w0 = (w0 + 1) % 2;"]))
        if self.chance(0.4):
            body.append(f"if ({self.condition(place)}) {{ return; }}")
            body += self.stepping(place)
        self.procedures.append((name, parameters))
        lines.append(f"  {name}({', '.join(parameters)}): |")
        return lines + [f"    {line}" for line in body]
