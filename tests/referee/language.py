"""The language of system files: tokens, expressions, statements and formulas.

It parses text into plain nodes; names are resolved later.

An expression is a tuple:  ("num", v)  ("name", n)  ("index", n, [e])  ("un", op, e)
("bin", op, a, b)  ("there", n, [e]). Formulas add ("event", program, model, sign, name, values),
("label", program, l) and ("field", program, variable).  A reference to a model or program is
(name, [index expressions]).
"""

import re


class Refused(Exception):
    """The system file is unusable: exit status 2."""


TOKEN = re.compile(
    r"""\s+|//[^\n]*|\#[^\n]*
    |(?P<number>\d+)
    |(?P<name>[A-Za-z_]\w*)
    |"(?P<quoted>(?:[^"\\]|\\.)*)"
    |(?P<op><->|->|<>|\[\]|\.\.|&&|\|\||==|!=|<=|>=|[-+*/%<>!=(){}\[\];:,.@])""",
    re.VERBOSE,
)

KEYWORDS = set(
    "loop repeat if else switch wait skip stop for while break continue return call var atomic "
    "select on when otherwise timeout idle any fair".split()
)


# Statements of one word and a name; elsewhere these words are names.
NAMING = {"offer", "withdraw", "run", "join", "kill", "restart"}


def tokenize(text):
    """Tokens as (kind, value, line); the last one has the kind 'end'."""
    tokens, position, line = [], 0, 1
    while position < len(text):
        match = TOKEN.match(text, position)
        if not match:
            raise Refused(f"unexpected character {text[position]!r} in line {line}")
        kind = match.lastgroup
        if kind:
            value = match.group(kind)
            if kind == "number":
                value = int(value)
            elif kind == "quoted":
                value = value.replace('\\"', '"').replace("\\\\", "\\")
            tokens.append((kind, value, line))
        line += match.group(0).count("\n")
        position = match.end()
    tokens.append(("end", "", line))
    return tokens


class Statement:
    """A statement: its kind, its place in the text, and the fields of that kind."""

    def __init__(self, kind, place, **fields):
        self.kind = kind
        self.place = place  # (text it stands in, number of its first token): its identity
        self.__dict__.update(fields)


class Parser:
    def __init__(self, text, origin):
        self.tokens = tokenize(text)
        self.origin = origin
        self.at = 0

    # --- tokens

    def peek(self, ahead=0):
        return self.tokens[min(self.at + ahead, len(self.tokens) - 1)]

    def sees(self, *values, ahead=0):
        kind, value, _ = self.peek(ahead)
        return kind in ("op", "name") and value in values

    def accept(self, value):
        if self.sees(value):
            self.at += 1
            return True
        return False

    def expect(self, value):
        if not self.accept(value):
            self.fail(f"'{value}'")

    def fail(self, wanted):
        _, value, line = self.peek()
        raise Refused(f"{self.origin}: expected {wanted}, not {value!r} (line {line})")

    def name(self):
        kind, value, _ = self.peek()
        if kind not in ("name", "quoted"):
            self.fail("a name")
        self.at += 1
        return value

    def end(self):
        if self.peek()[0] != "end":
            self.fail("the end")

    # --- expressions

    LEVELS = [("||",), ("&&",), ("==", "!="), ("<", "<=", ">", ">="), ("+", "-"), ("*", "/", "%")]

    def expression(self, level=0):
        if level == len(self.LEVELS):
            return self.unary()
        left = self.expression(level + 1)
        while self.peek()[0] == "op" and self.sees(*self.LEVELS[level]):
            op = self.peek()[1]
            self.at += 1
            left = ("bin", op, left, self.expression(level + 1))
        return left

    def unary(self):
        for op in "!", "-":
            if self.accept(op):
                return ("un", op, self.unary())
        return self.primary()

    def primary(self):
        kind, value, _ = self.peek()
        if self.accept("("):
            inner = self.expression()
            self.expect(")")
            return inner
        if kind == "number":
            self.at += 1
            return ("num", value)
        if kind == "quoted":
            self.at += 1
            return ("name", value)
        if kind == "name" and value in ("true", "false"):
            self.at += 1
            return ("num", value == "true")
        if kind == "name" and value not in KEYWORDS:
            self.at += 1
            indices = self.indices()
            if self.sees(".") and self.sees("there", ahead=1):
                self.at += 2
                return ("there", value, indices)
            return ("index", value, indices) if indices else ("name", value)
        self.fail("an expression")

    def indices(self):
        if not self.accept("["):
            return []
        found = [self.expression()]
        while self.accept(","):
            found.append(self.expression())
        self.expect("]")
        return found

    def reference(self):
        return (self.name(), self.indices())

    # --- statements

    def program(self):
        body = []
        while self.peek()[0] != "end":
            body.append(self.statement())
        if not body:
            raise Refused(f"{self.origin}: no statement")
        return body

    def block(self):
        self.expect("{")
        body = []
        while not self.accept("}"):
            body.append(self.statement())
        return body

    def here(self):
        return (self.origin, self.at)

    def statement(self):
        place = self.here()
        if self.accept("@"):
            label = self.name()
            return Statement("label", place, label=label, body=self.statement())
        if self.accept("idle"):
            body = self.statement()
            target = body
            while target.kind == "label":
                target = target.body
            if target.kind not in ("give", "wait", "select", "switch", "sleep"):
                self.fail("a statement that waits, behind 'idle',")
            target.idle = True
            return body
        kind, value, _ = self.peek()
        # A word before `.` names a model or what is used like one, even a keyword.
        if kind == "name" and value in KEYWORDS and not self.sees(".", ahead=1):
            self.at += 1
            return getattr(self, "parse_" + value, self.misplaced)(place)
        if kind == "name" and value in NAMING and self.peek(1)[0] in ("name", "quoted"):
            self.at += 1
            target = self.reference()
            self.expect(";")
            return Statement(value, place, target=target)
        if self.sees("unknown") and self.sees(";", ahead=1):
            self.at += 2
            return Statement("unknown", place)
        if self.sees("end") and self.sees(";", ahead=1):
            self.at += 2
            return Statement("quit", place)
        if self.sees("spin") and (self.sees(";", ahead=1) or self.peek(1)[0] == "name"):
            self.at += 1
            return self.parse_spin(place)
        name, indices = self.reference()
        if self.sees("."):
            given = self.given((name, indices))
            if given["input"] == "wait" and self.accept("timeout"):
                self.expression()
                model = given["model"]
                return Statement("sleep", place, model=model, body=self.block(), idle=False)
            pattern = self.pattern() if self.accept("->") else None
            self.expect(";")
            return Statement("give", place, **given, pattern=pattern, idle=False)
        self.expect("=")
        return self.assignment(place, (name, indices))

    def parse_spin(self, place):
        """Behind `spin`."""
        if self.accept(";"):
            return self.spin(place, "forever")
        mode = self.name()
        if mode in ("some", "all"):
            limit = None if self.sees(";") else self.expression()
            self.expect(";")
            return self.spin(place, mode, limit=limit)
        model = pattern = None
        if mode == "until":
            model = self.reference()
            self.expect("->")
            pattern = self.pattern()
            if pattern != ("answer", None):
                self.fail("'answer', behind 'spin until',")
        elif mode != "once":
            self.fail("'once', 'until', 'some' or 'all', behind 'spin',")
        late = None
        if self.accept("timeout"):
            self.expression()
            late = self.block()
        else:
            self.expect(";")
        return self.spin(place, mode, model=model, pattern=pattern, late=late)

    @staticmethod
    def spin(place, mode, **fields):
        known = {"model": None, "pattern": None, "limit": None, "late": None, **fields}
        return Statement("spin", place, mode=mode, **known)

    def misplaced(self, place):
        self.at -= 1
        self.fail("a statement")

    def given(self, model):
        """`.input` or `.input(values)` behind a reference to a model."""
        self.expect(".")
        return {"model": model, "input": self.name(), "arguments": self.arguments()}

    def arguments(self):
        if not self.accept("("):
            return []
        found = [self.expression()]
        while self.accept(","):
            found.append(self.expression())
        self.expect(")")
        return found

    def pattern(self):
        """An output: (name, None), or (name, [("var", x) or an expression])."""
        name = self.name()
        if not self.accept("("):
            return (name, None)
        values = []
        while True:
            values.append(("var", self.name()) if self.accept("var") else self.expression())
            if not self.accept(","):
                break
        self.expect(")")
        return (name, values)

    def arms(self):
        """Arms `output { ... }` behind an open brace, to the closing one."""
        arms = []
        while not self.accept("}"):
            place = self.here()
            pattern = self.pattern()
            arms.append((pattern, self.block(), place))
        return arms

    def assignment(self, place, target):
        if self.accept("any"):
            return self.choice(place, target)
        value = self.expression()
        self.expect(";")
        return Statement("assign", place, target=target, value=value)

    def choice(self, place, target):
        fair = self.accept("fair")
        low = self.expression()
        self.expect("..")
        high = self.expression()
        self.expect(";")
        return Statement("any", place, target=target, low=low, high=high, fair=fair)

    def parse_loop(self, place):
        return Statement("loop", place, body=self.block())

    def parse_repeat(self, place):
        count = self.expression()
        return Statement("repeat", place, count=count, body=self.block())

    def parse_while(self, place):
        self.expect("(")
        condition = self.expression()
        self.expect(")")
        return Statement("while", place, condition=condition, body=self.block())

    def parse_for(self, place):
        name = self.name()
        self.expect("in")
        low = self.expression()
        self.expect("..")
        high = self.expression()
        return Statement("for", place, name=name, low=low, high=high, body=self.block())

    def parse_if(self, place):
        fair = self.accept("fair")
        condition = None
        if fair or self.sees("*"):
            self.expect("*")
        else:
            self.expect("(")
            condition = self.expression()
            self.expect(")")
        body, other = self.block(), []
        if self.accept("else"):
            if self.sees("if"):
                inner = self.here()
                self.at += 1
                other = [self.parse_if(inner)]
            else:
                other = self.block()
        return Statement("if", place, condition=condition, fair=fair, body=body, other=other)

    def parse_switch(self, place):
        given = self.given(self.reference())
        self.expect("{")
        arms = self.arms()
        if not arms:
            self.fail("an arm of the 'switch', before")
        names = [repr(pattern) for pattern, _, _ in arms]
        if len(set(names)) < len(names):
            self.fail("each arm once, before")
        return Statement("switch", place, **given, arms=arms, idle=False)

    def parse_wait(self, place):
        model = self.reference()
        self.expect("->")
        pattern = self.pattern()
        self.expect(";")
        return Statement("wait", place, model=model, pattern=pattern, idle=False)

    def simple(self, kind, place):
        self.expect(";")
        return Statement(kind, place)

    def parse_skip(self, place):
        return self.simple("skip", place)

    def parse_stop(self, place):
        return self.simple("stop", place)

    def parse_break(self, place):
        return self.simple("break", place)

    def parse_continue(self, place):
        return self.simple("continue", place)

    def parse_return(self, place):
        return self.simple("return", place)

    def parse_call(self, place):
        procedure = self.name()
        self.expect("(")
        arguments = []
        if not self.accept(")"):
            arguments.append(self.expression())
            while self.accept(","):
                arguments.append(self.expression())
            self.expect(")")
        self.expect(";")
        return Statement("call", place, procedure=procedure, arguments=arguments)

    def parse_var(self, place):
        name = self.name()
        ranges = self.index_ranges()
        self.expect(":")
        kind = self.type()
        value = choice = None
        if self.accept("="):
            if self.accept("any"):
                choice = self.choice(place, (name, []))
            else:
                value = self.expression()
                self.expect(";")
        else:
            self.expect(";")
        fields = {"name": name, "ranges": ranges, "type": kind, "value": value, "choice": choice}
        return Statement("var", place, **fields)

    def type(self):
        if self.accept("bool"):
            return ("bool",)
        if self.accept("{"):
            words = [self.name()]
            while self.accept(","):
                words.append(self.name())
            self.expect("}")
            return ("words", words)
        low = self.expression(4)
        self.expect("..")
        return ("range", low, self.expression(4))

    def index_ranges(self):
        """`[i in LOW..HIGH, ...]` as [(name, low, high)]."""
        if not self.accept("["):
            return []
        ranges = []
        while True:
            name = self.name()
            self.expect("in")
            low = self.expression()
            self.expect("..")
            ranges.append((name, low, self.expression()))
            if not self.accept(","):
                break
        self.expect("]")
        return ranges

    def parse_atomic(self, place):
        return Statement("atomic", place, condition=None, body=self.block())

    def parse_when(self, place):
        self.expect("(")
        condition = self.expression()
        self.expect(")")
        self.expect("atomic")
        return Statement("atomic", place, condition=condition, body=self.block())

    def parse_select(self, place):
        self.expect("{")
        arms, other, times_out = [], None, False
        while not self.accept("}"):
            arm_place = self.here()
            if self.sees("otherwise", "timeout"):
                if other is not None:
                    self.fail("one 'otherwise' or 'timeout'")
                times_out = not self.accept("otherwise")
                if times_out:
                    self.expect("timeout")
                    self.expression()
                other = self.block()
                continue
            arms.append(self.select_arm(arm_place))
        fields = {"arms": arms, "other": other, "times_out": times_out}
        return Statement("select", place, **fields, idle=False)

    def select_arm(self, place):
        arm = Statement("arm", place, guard=None, model=None, input=None, outputs=None, body=None)
        if self.accept("when"):
            self.expect("(")
            arm.guard = self.expression()
            self.expect(")")
            if not self.sees("on"):
                arm.body = self.block()
                return arm
        self.expect("on")
        arm.model = self.reference()
        if self.accept("!"):
            arm.outputs = [(self.pattern(), self.block(), place)]
            return arm
        self.expect(".")
        arm.input = self.name()
        arm.arguments = self.arguments()
        if self.accept("->"):
            arm.outputs = [(self.pattern(), self.block(), place)]
            return arm
        if self.opens_arms():
            self.expect("{")
            arm.outputs = self.arms()
        else:
            arm.body = self.block()
        return arm

    def opens_arms(self):
        """Whether `output {` or `output(values) {` stands behind the brace that comes next."""
        kind, value, _ = self.peek(1)
        if kind != "quoted" and (kind != "name" or value in KEYWORDS):
            return False
        ahead = 2
        if self.sees("(", ahead=2):
            depth = 0
            while self.peek(ahead)[0] != "end":
                depth += self.sees("(", ahead=ahead) - self.sees(")", ahead=ahead)
                ahead += 1
                if depth == 0:
                    break
        return self.sees("{", ahead=ahead)


def parse_program(text, origin):
    parser = Parser(text, origin)
    return parser.program()


def parse_declarations(text, origin):
    """`var` declarations alone, as under `variables:`."""
    body = parse_program(text, origin)
    for statement in body:
        if statement.kind != "var":
            raise Refused(f"{origin}: only declarations of variables stand here")
    return body


def parse_header(text, origin):
    """`name` or `name[i in LOW..HIGH]` as (name, ranges)."""
    parser = Parser(text, origin)
    name = parser.name()
    ranges = parser.index_ranges()
    parser.end()
    return name, ranges


def parse_reference(text, origin):
    parser = Parser(text, origin)
    reference = parser.reference()
    parser.end()
    return reference


def parse_expression(text, origin):
    parser = Parser(str(text), origin)
    expression = parser.expression()
    parser.end()
    return expression
