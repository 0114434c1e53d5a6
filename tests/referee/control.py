"""The control of a program: its text, inlined and unrolled, as a graph of nodes.

Silent nodes cost no step: assign, enter, branch, jump, label. At all others control stands still
until a step. A node is one place of the text in one copy: a round of a `repeat`, a value of the
index of a `for`, a call of a procedure. Between two steps a program is in a control state
(node, labels that hold, values of the variables in scope, a value kept for a write).
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from expressions import (
    Expression,
    Scope,
    Variable,
    declared,
    evaluate,
    is_constant,
    members,
    reads_shared,
    services_named,
    variables_of,
)
from language import Refused, Statement
from locks import Condition
from wires import refuse_arms

MOST_FOUND, MOST_RUN = 12, 100  # callbacks of a `spin some` and `spin all`
SILENT = {"assign", "enter", "branch", "jump", "label"}


class Node:
    """A node of a program's control; what its fields are depends on its kind."""

    def __init__(self, kind: str, frame: Frame, place: Any = None, **fields: Any) -> None:
        self.kind = kind
        self.scope: tuple[Variable, ...] = frame.visible
        self.place = place
        self.idle = False
        self.number = -1
        self.next: Any = None
        self.__dict__.update(fields)

    def successors(self) -> list[Node]:
        """The nodes to which control may go from here."""
        if self.kind == "branch" or self.kind == "read_branch":
            if self.kind == "branch" and self.condition[0] == "value":
                return [self.yes if self.condition[1] else self.no]
            return [self.yes, self.no]
        if self.kind == "choose":
            return list(self.outcomes)
        if self.kind == "start":
            return [arm for _, arm in self.arms]
        if self.kind == "take":
            return [arm for _, arm in self.arms] + ([self.quiet] if self.quiet else [])
        if self.kind == "select":
            found = [self.other] if self.other else []
            for arm in self.arms:
                found += [arm.next] if arm.outputs is None else [n for _, n in arm.outputs]
            return found
        if self.kind in ("wake", "spin", "misspin") and self.late is not None:
            return [self.next, self.late]
        return [] if self.kind in ("end", "finish", "unknown", "quit") else [self.next]


@dataclass
class Arm:
    """An arm of a select: outputs is None where it waits for none."""

    number: int
    guard: Expression | None
    model: tuple | None
    input: str | None
    arguments: list[Expression]
    outputs: list[tuple[tuple, Node]] | None
    next: Node | None


@dataclass
class Frame:
    """Where a statement stands: its names, the variables in scope, and where control leaves to."""

    scope: Scope
    visible: tuple[Variable, ...]
    stop: Node | None = None
    leave: Node | None = None
    around: Node | None = None
    back: Node | None = None
    calls: tuple[str, ...] = field(default_factory=tuple)


def innermost(statement: Statement) -> Statement:
    """The statement behind its labels."""
    while statement.kind == "label":
        statement = statement.body
    return statement


def pattern_names(pattern: tuple | None) -> list[str]:
    """The variables that a pattern declares."""
    if pattern is None or pattern[1] is None:
        return []
    return [item[1] for item in pattern[1] if item[0] == "var"]


class Compiler:
    """Makes the control of one program; notes the models and variables that its text names."""

    def __init__(self, system: Any, program: int, file: Scope) -> None:
        self.system = system
        self.program = program
        self.file = file
        self.models: set[tuple[str, tuple]] = set()
        self.nodes: list[Node] = []
        self.pools: set[int] = set()  # the threads that it asks or waits for, whom it kills
        self.code: Any = None  # of a node, where it is no program

    def compile(self, body: list[Statement], scope: Scope, outside: tuple[Variable, ...]) -> Node:
        """The first node of a program; `outside` are variables of the file that it alone uses."""
        end = Node("end", Frame(scope, outside))
        inner, own = self.declare(body, Frame(scope, outside, stop=end, back=end))
        end.scope = inner.visible
        first = self.sequence(body, inner, own, end)
        self.number(first)
        self.number(end)  # it is kept even where the text never comes to it
        if self.system.knows_shared:
            self.refuse_idle_loops()
        return first

    def compile_callback(self, text: Any, outside: tuple[Variable, ...]) -> Node:
        """The node at which a callback, or other code of a node, waits to be started; its code ends
        before `finish`."""
        frame = Frame(text.scope, outside)
        when = None if text.when is None else self.expression(frame, text.when)
        start = Node("start", frame, (text.full_name(), 0), model=None, input=None, when=when)
        self.code = text
        end = Node("finish", frame)
        inner = replace(frame, stop=end, back=end)
        if text.kind == "takes":
            taken = text.what
            start.model = self.model(frame, taken["model"])
            name = start.model[0]
            if not all(is_constant(index) for index in start.model[1]):
                raise Refused(f"{text.full_name()}: what it takes has an index that changes")
            start.input = taken["input"]
            start.arguments = tuple(frame.scope.constant(a) for a in taken["arguments"])
            if start.input is not None:
                self.system.check_input(self.program, start.model, start.input)
                start.has_outputs = self.system.has_outputs(name, start.input)
        elif text.kind in ("serves", "client"):
            start.model = self.system.service_number(text)
        start.arms = [self.outcome(*arm, start.model, inner, end) for arm in text.arms]
        self.number(start)
        self.number(end)
        if self.system.knows_shared:
            self.refuse_idle_loops()
        return start

    def outcome(
        self, pattern: tuple | None, body: list, model: tuple, frame: Frame, end: Node
    ) -> tuple:
        """(what may come, resolved, the first node of its code); without a pattern, anything."""
        own = [Variable(name, None) for name in pattern_names(pattern)]
        inner = self.with_variables(replace(frame, scope=Scope(frame.scope)), own)
        first = self.block(body, inner, end)
        if pattern is None:
            return (None, None), first
        self.system.check_output(self.program, model, pattern[0])
        if pattern[1] is not None:
            self.system.expects_values.add(model[0])
        return self.pattern(inner, pattern), first

    def refuse_reading(self, model: str, name: str, is_input: bool) -> None:
        """Refuses what a callback may receive through its executor alone."""
        if self.code is not None and self.system.is_received(model, name, is_input):
            raise Refused(f"a callback gets {name} of {model} through its executor: 'takes'")

    def number(self, first: Node) -> None:
        """Numbers the nodes and keeps them, for control states."""
        waiting = [first]
        while waiting:
            node = waiting.pop()
            if node.number < 0:
                node.number = len(self.nodes)
                self.nodes.append(node)
                waiting += node.successors()

    def refuse_idle_loops(self) -> None:
        """Refuses control that goes round without a step whatever the values are."""
        good = {node for node in self.nodes if node.kind not in SILENT}
        before: dict[Node, list[Node]] = {}
        for node in self.nodes:
            if node.kind in SILENT:
                for after in node.successors():
                    before.setdefault(after, []).append(node)
        waiting = list(good)
        while waiting:
            for node in before.get(waiting.pop(), []):
                if node not in good:
                    good.add(node)
                    waiting.append(node)
        if len(good) < len(self.nodes):
            raise Refused("control goes round without a step")

    # --- names

    def expression(self, frame: Frame, expression: Expression) -> Expression:
        """A resolved expression, whose variables are noted."""
        resolved = frame.scope.resolve(expression)
        for variable in variables_of(resolved):
            variable.users.add(self.program)
        for reference in services_named(expression):
            self.system.name_presence(self.system.meant(self.model(frame, reference)))
        return resolved

    def local(self, frame: Frame, expression: Expression) -> Expression:
        """A resolved expression that names no shared variable."""
        resolved = self.expression(frame, expression)
        if reads_shared(resolved):
            raise Refused("a shared variable stands in assignments and conditions alone")
        return resolved

    def model(self, frame: Frame, reference: tuple) -> tuple[str, list[Expression]]:
        """(name, indices) of what a statement uses as a model."""
        name, indices = reference
        meaning = frame.scope.find(name)
        if meaning is None or meaning[0] != "model":
            raise Refused(f"{name} is no model")
        resolved = [self.local(frame, index) for index in indices] or meaning[2]
        ranges = self.system.model_ranges(meaning[1])
        if len(ranges) != len(resolved):
            raise Refused(f"{name} has {len(ranges)} indices")
        for member in members(ranges):
            constants = [i[1] == at for i, at in zip(resolved, member) if i[0] == "value"]
            if all(constants):
                self.models.add((meaning[1], member))
        return (meaning[1], resolved)

    def pattern(self, frame: Frame, pattern: tuple) -> tuple[str, list | None]:
        """(name, None) or (name, [("bind", variable) or ("match", expression)])."""
        name, items = pattern
        if items is None:
            return (name, None)
        found: list = []
        for item in items:
            if item[0] == "var":
                found.append(("bind", frame.scope.find(item[1])[1]))
                continue
            resolved = self.local(frame, item)
            if resolved[0] == "variable" and not resolved[2]:
                found.append(("bind", resolved[1]))
            else:
                found.append(("match", resolved))
        return (name, found)

    # --- statements

    def declare(self, body: list[Statement], frame: Frame) -> tuple[Frame, list[Variable]]:
        """The frame inside of a block, and the variables that the block declares."""
        inner = replace(frame, scope=Scope(frame.scope))
        own: list[Variable] = []
        for statement in map(innermost, body):
            if statement.kind == "var":
                own.append(declared(inner.scope, statement))
            elif statement.kind in ("give", "wait"):
                own += [Variable(name, None) for name in pattern_names(statement.pattern)]
        return self.with_variables(inner, own), own

    def with_variables(self, frame: Frame, variables: list[Variable]) -> Frame:
        """The frame with more variables in its scope."""
        for variable in variables:
            if variable.name in frame.scope.names:
                raise Refused(f"{variable.name} is declared twice")
            frame.scope.names[variable.name] = ("variable", variable)
        return replace(frame, visible=frame.visible + tuple(variables))

    def sequence(
        self, body: list[Statement], inner: Frame, own: list[Variable], after: Node
    ) -> Node:
        """The first node of a block whose variables are declared."""
        for statement in reversed(body):
            after = self.statement(statement, inner, after)
        return Node("enter", inner, variables=tuple(own), next=after) if own else after

    def block(self, body: list[Statement], frame: Frame, after: Node) -> Node:
        """The first node of a block."""
        inner, own = self.declare(body, frame)
        return self.sequence(body, inner, own, after)

    def statement(self, statement: Statement, frame: Frame, after: Node) -> Node:
        """The first node of a statement, behind which control goes on at `after`."""
        if self.code is not None and getattr(statement, "idle", False):
            waits = statement.kind == "sleep" or getattr(statement, "input", None) == "wait"
            is_condition = waits and self.condition(frame, statement.model) is not None
            if self.code.kind != "thread" or not is_condition:
                raise Refused("a callback does not rest")
        return getattr(self, "compile_" + statement.kind)(statement, frame, after)

    def compile_label(self, statement: Statement, frame: Frame, after: Node) -> Node:
        inner = self.statement(statement.body, frame, after)
        return Node("label", frame, label=statement.label, next=inner)

    def compile_skip(self, statement: Statement, frame: Frame, after: Node) -> Node:
        return after

    def compile_stop(self, statement: Statement, frame: Frame, after: Node) -> Node:
        return frame.stop

    def compile_return(self, statement: Statement, frame: Frame, after: Node) -> Node:
        return frame.back

    def compile_break(self, statement: Statement, frame: Frame, after: Node) -> Node:
        if frame.leave is None:
            raise Refused("break outside of a loop")
        return frame.leave

    def compile_continue(self, statement: Statement, frame: Frame, after: Node) -> Node:
        if frame.around is None:
            raise Refused("continue outside of a loop")
        return frame.around

    def compile_loop(self, statement: Statement, frame: Frame, after: Node) -> Node:
        head = Node("jump", frame, statement.place)
        head.next = self.block(statement.body, replace(frame, leave=after, around=head), head)
        return head

    def compile_repeat(self, statement: Statement, frame: Frame, after: Node) -> Node:
        count = frame.scope.constant(statement.count)
        first = after
        for _ in range(count):
            first = self.block(statement.body, replace(frame, leave=after, around=first), first)
        if count == 0:  # what it names is used, though never reached
            self.block(statement.body, replace(frame, leave=after, around=after), after)
        return first

    def compile_while(self, statement: Statement, frame: Frame, after: Node) -> Node:
        head = Node("jump", frame, statement.place)
        body = self.block(statement.body, replace(frame, leave=after, around=head), head)
        head.next = self.branch(statement.condition, frame, body, after, statement.place)
        return head

    def compile_for(self, statement: Statement, frame: Frame, after: Node) -> Node:
        low, high = frame.scope.constant(statement.low), frame.scope.constant(statement.high)
        first = after
        for value in range(high, low - 1, -1):
            scope = Scope(frame.scope)
            scope.names[statement.name] = ("value", value)
            inner = replace(frame, scope=scope, leave=after, around=first)
            first = self.block(statement.body, inner, first)
        return first

    def branch(
        self, condition: Expression, frame: Frame, yes: Node, no: Node, place: Any
    ) -> Node:
        """A condition: silent, or a step if it reads shared variables."""
        resolved = self.expression(frame, condition)
        kind = "read_branch" if reads_shared(resolved) else "branch"
        return Node(kind, frame, place, condition=resolved, yes=yes, no=no)

    def compile_if(self, statement: Statement, frame: Frame, after: Node) -> Node:
        yes = self.block(statement.body, frame, after)
        no = self.block(statement.other, frame, after)
        if statement.condition is not None:
            return self.branch(statement.condition, frame, yes, no, statement.place)
        return Node("choose", frame, statement.place, outcomes=(yes, no), fair=statement.fair)

    def compile_var(self, statement: Statement, frame: Frame, after: Node) -> Node:
        if statement.choice is not None:
            return self.compile_any(statement.choice, frame, after)
        variable = frame.scope.find(statement.name)[1]
        if statement.value is None:
            return after
        for member in reversed(members(variable.indices)):
            inner = frame
            if variable.indices:
                scope = Scope(frame.scope)
                for (name, _, _), value in zip(statement.ranges, member):
                    scope.names[name] = ("value", value)
                inner = replace(frame, scope=scope)
            target = [("value", value) for value in member]
            after = self.assign(variable, target, statement.value, inner, after, statement.place)
        return after

    def target(self, frame: Frame, target: tuple) -> tuple[Variable, list[Expression]]:
        """The variable, and the indices of its member, that a statement sets."""
        name, indices = target
        resolved = self.expression(frame, ("index", name, indices) if indices else ("name", name))
        if resolved[0] != "variable":
            raise Refused(f"{name} is no variable")
        if any(reads_shared(index) for index in resolved[2]):
            raise Refused("a shared variable is no index")
        return resolved[1], resolved[2]

    def compile_assign(self, statement: Statement, frame: Frame, after: Node) -> Node:
        variable, indices = self.target(frame, statement.target)
        return self.assign(variable, indices, statement.value, frame, after, statement.place)

    def assign(
        self,
        variable: Variable,
        indices: list,
        value: Expression,
        frame: Frame,
        after: Node,
        place: Any,
    ) -> Node:
        """Silent, or a step to read and a step to write shared variables."""
        resolved = self.expression(frame, value)
        fields = {"variable": variable, "indices": indices, "next": after}
        if not variable.shared:
            kind = "read_assign" if reads_shared(resolved) else "assign"
            return Node(kind, frame, place, value=resolved, **fields)
        if not reads_shared(resolved):
            return Node("write", frame, place, value=resolved, **fields)
        write = Node("write", frame, place, value=None, **fields)
        return Node("read_keep", frame, place, value=resolved, next=write)

    def compile_any(self, statement: Statement, frame: Frame, after: Node) -> Node:
        variable, indices = self.target(frame, statement.target)
        fields = {"variable": variable, "indices": indices}
        if variable.shared:
            after = Node("write", frame, statement.place, value=None, next=after, **fields)
        bounds = {
            "low": self.local(frame, statement.low),
            "high": self.local(frame, statement.high),
        }
        return Node(
            "any", frame, statement.place, fair=statement.fair, next=after, **bounds, **fields
        )

    def compile_atomic(self, statement: Statement, frame: Frame, after: Node) -> Node:
        body = self.atomic_body(statement.body, frame)
        condition = statement.condition
        if condition is not None:
            condition = self.expression(frame, condition)
        return Node("atomic", frame, statement.place, condition=condition, body=body, next=after)

    def atomic_body(self, body: list[Statement], frame: Frame) -> list[tuple]:
        """The statements of an `atomic`, resolved."""
        found: list[tuple] = []
        for statement in body:
            if statement.kind == "assign":
                variable, indices = self.target(frame, statement.target)
                value = self.expression(frame, statement.value)
                found.append(("assign", variable, indices, value))
            elif statement.kind == "if" and statement.condition is not None:
                condition = self.expression(frame, statement.condition)
                yes = self.atomic_body(statement.body, frame)
                no = self.atomic_body(statement.other, frame)
                found.append(("if", condition, yes, no))
            elif statement.kind == "for":
                low = frame.scope.constant(statement.low)
                high = frame.scope.constant(statement.high)
                for value in range(low, high + 1):
                    scope = Scope(frame.scope)
                    scope.names[statement.name] = ("value", value)
                    found += self.atomic_body(statement.body, replace(frame, scope=scope))
            else:
                raise Refused("an atomic has assignments, 'if' and 'for' alone")
        return found

    def compile_call(self, statement: Statement, frame: Frame, after: Node) -> Node:
        name = statement.procedure
        if name not in self.system.procedures:
            raise Refused(f"no procedure {name}")
        if name in frame.calls:
            raise Refused(f"procedure {name} calls itself")
        parameters, body = self.system.procedures[name]
        if len(parameters) != len(statement.arguments):
            raise Refused(f"procedure {name} takes {len(parameters)} arguments")
        scope = Scope(self.file)
        for parameter, argument in zip(parameters, statement.arguments):
            scope.names[parameter] = self.argument(frame, argument)
        calls = frame.calls + (name,)
        inner = Frame(scope, frame.visible, stop=frame.stop, back=after, calls=calls)
        return self.block(body, inner, after)

    def argument(self, frame: Frame, argument: Expression) -> tuple:
        """What a parameter means: a constant, a model or a variable."""
        if argument[0] in ("name", "index"):
            indices = argument[2] if argument[0] == "index" else []
            meaning = frame.scope.find(argument[1])
            if meaning is not None and meaning[0] == "model" and not meaning[2]:
                return ("model", meaning[1], [self.local(frame, index) for index in indices])
            if meaning is not None and not indices:
                return meaning
        resolved = self.expression(frame, argument)
        if not is_constant(resolved):
            raise Refused("an argument is a constant, a model or a variable")
        return ("value", evaluate(resolved, lambda variable: None))

    def given(self, statement: Any, frame: Frame) -> dict[str, Any]:
        """The fields of a node that gives an input."""
        model = self.model(frame, statement.model)
        self.system.check_input(self.program, model, statement.input)
        self.refuse_reading(model[0], statement.input, True)
        arguments = [self.local(frame, argument) for argument in statement.arguments]
        if arguments:
            self.system.gives_values.add(model[0])
        return {"model": model, "input": statement.input, "arguments": arguments}

    def checked(self, frame: Frame, model: tuple, pattern: tuple) -> tuple:
        """A resolved pattern of an output that this program may take from the model."""
        self.system.check_output(self.program, model, pattern[0])
        self.refuse_reading(model[0], pattern[0], False)
        if pattern[1] is not None:
            self.system.expects_values.add(model[0])
        return self.pattern(frame, pattern)

    def condition(self, frame: Frame, reference: tuple) -> Condition | None:
        """The condition that a reference names, which is used with its mutex; None if it names
        something else."""
        name, indices = self.model(frame, reference)
        meant = self.system.meant((name, indices))
        if len(meant) != 1 or not isinstance(meant[0], Condition):
            return None
        self.models.add(self.system.key_of(meant[0].mutex))
        return meant[0]

    def compile_sleep(self, statement: Statement, frame: Frame, after: Node) -> Node:
        condition = self.condition(frame, statement.model)
        if condition is None:
            raise Refused(f"{statement.model[0]} is no condition")
        late = Node("retake", frame, condition=condition)
        late.next = self.block(statement.body, frame, after)
        return self.sleep(condition, statement, frame, after, late)

    def sleep(
        self,
        condition: Condition,
        statement: Statement,
        frame: Frame,
        after: Node,
        late: Node | None,
    ) -> Node:
        """A node at which control begins to wait at a condition; `late` is that of its time-out."""
        wake = Node("wake", frame, condition=condition, next=after, late=late)
        node = Node("sleep", frame, statement.place, condition=condition, next=wake)
        wake.idle = node.idle = statement.idle
        return node

    def compile_give(self, statement: Statement, frame: Frame, after: Node) -> Node:
        condition = self.condition(frame, statement.model)
        if condition is not None:
            name = statement.input
            if name not in condition.inputs or statement.arguments or statement.pattern is not None:
                raise Refused(f"{condition.name} has no {name} like this")
            if name == "wait":
                return self.sleep(condition, statement, frame, after, None)
            if statement.idle:
                raise Refused(f"{condition.name}: no rest at {name}")
            model = (condition.name, [])
            fields = {"model": model, "input": name, "arguments": [], "next": after}
            return Node("give", frame, statement.place, **fields)
        given = self.given(statement, frame)
        if statement.pattern is not None:
            arms = [(self.checked(frame, given["model"], statement.pattern), after)]
            after = self.take(given["model"], arms, None, statement, frame)
        node = Node("give", frame, statement.place, next=after, **given)
        node.idle = statement.idle
        return node

    def take(
        self, model: tuple, arms: list, quiet: Node | None, statement: Statement, frame: Frame
    ) -> Node:
        """A node at which control waits for an output."""
        node = Node("take", frame, statement.place, model=model, arms=arms, quiet=quiet)
        node.idle = statement.idle
        return node

    def sent_to(self, frame: Frame, reference: tuple, pattern: tuple) -> tuple[tuple, tuple]:
        """A reference and an output: `image[logger]!arrived` is an output of image."""
        name, indices = reference
        meaning = frame.scope.find(name)
        if pattern != ("arrived", None) or meaning is None or meaning[0] != "model":
            return reference, pattern
        if self.system.model_ranges(meaning[1]) or meaning[2] or len(indices) != 1:
            return reference, pattern
        if indices[0][0] != "name":
            return reference, pattern
        return (name, []), (f"arrived[{indices[0][1]}]", None)

    def compile_wait(self, statement: Statement, frame: Frame, after: Node) -> Node:
        reference, pattern = self.sent_to(frame, statement.model, statement.pattern)
        model = self.model(frame, reference)
        if pattern == ("there", None) and self.system.is_service(model):
            self.system.name_presence(self.system.meant(model))
            node = Node("present", frame, statement.place, model=model, next=after)
            node.idle = statement.idle
            return node
        arms = [(self.checked(frame, model, pattern), after)]
        return self.take(model, arms, None, statement, frame)

    def compile_offer(self, statement: Statement, frame: Frame, after: Node) -> Node:
        model = self.model(frame, statement.target)
        self.system.check_offer(self.program, model, is_offer=True)
        return Node("offer", frame, statement.place, model=model, next=after)

    def compile_withdraw(self, statement: Statement, frame: Frame, after: Node) -> Node:
        model = self.model(frame, statement.target)
        self.system.check_offer(self.program, model, is_offer=False)
        return Node("withdraw", frame, statement.place, model=model, next=after)

    def pool(self, statement: Statement) -> Any:
        """The threads of this code's node that a statement names."""
        name, indices = statement.target
        pools = {} if self.code is None else {p.text.name: p for p in self.code.node.pools}
        if name not in pools or indices:
            raise Refused(f"{name} is no thread of a node that stands around this")
        self.pools.add(pools[name].use)
        return pools[name]

    def compile_run(self, statement: Statement, frame: Frame, after: Node) -> Node:
        pool = self.pool(statement)
        pool.is_run = True
        return Node("run", frame, statement.place, pool=pool, next=after)

    def compile_join(self, statement: Statement, frame: Frame, after: Node) -> Node:
        pool = self.pool(statement)
        return Node("join", frame, statement.place, pool=pool, next=after)

    def compile_unknown(self, statement: Statement, frame: Frame, after: Node) -> Node:
        return Node("unknown", frame, statement.place)

    def compile_kill(self, statement: Statement, frame: Frame, after: Node) -> Node:
        name, indices = statement.target
        index = tuple(frame.scope.constant(i) for i in indices)
        process = self.system.process_named(name, index)
        self.pools.add(process.use)
        restarts = statement.kind == "restart"
        fields = {"process": process, "restarts": restarts, "next": after}
        return Node("kill", frame, statement.place, **fields)

    compile_restart = compile_kill

    def compile_quit(self, statement: Statement, frame: Frame, after: Node) -> Node:
        process = self.system.process_at(self.program)
        return Node("quit", frame, statement.place, process=process)

    def compile_spin(self, statement: Statement, frame: Frame, after: Node) -> Node:
        if self.code is None:
            raise Refused("a program does not spin: 'main' of an executor does")
        executor, mode = self.code.node.executor, statement.mode
        is_spinner = self.code.kind in ("start", "main")
        if is_spinner and executor.rounds and mode in ("once", "until"):
            raise Refused(f"executor {executor.name}: 'spin {mode}' has no rounds")
        spun = executor.callbacks if self.code.kind == "main" else self.code.node.callbacks
        if is_spinner and mode in ("some", "all") and len(spun) > MOST_FOUND:
            raise Refused(f"'spin {mode}' has at most {MOST_FOUND} callbacks")
        limit = None if statement.limit is None else frame.scope.constant(statement.limit)
        if limit is not None and not 1 <= limit <= MOST_RUN:
            raise Refused(f"'spin {mode}' runs 1 to {MOST_RUN} callbacks")
        model = None
        if statement.model is not None:
            model = self.model(frame, statement.model)
            if not self.system.is_service(model):
                raise Refused(f"{model[0]} is no service")
            self.checked(frame, model, statement.pattern)
        late = None if statement.late is None else self.block(statement.late, frame, after)
        fields = {"mode": mode, "limit": limit, "model": model, "late": late, "next": after}
        kind = "spin" if is_spinner else "misspin"
        return Node(kind, frame, statement.place, **fields)

    def arms(self, arms: list, model: tuple, frame: Frame, after: Node) -> list:
        """Patterns and first nodes of arms `output { ... }`."""
        found = []
        for pattern, body, _ in arms:
            own = [Variable(name, None) for name in pattern_names(pattern)]
            inner = self.with_variables(replace(frame, scope=Scope(frame.scope)), own)
            first = self.block(body, inner, after)
            found.append((self.checked(inner, model, pattern), first))
        return found

    def compile_switch(self, statement: Statement, frame: Frame, after: Node) -> Node:
        given = self.given(statement, frame)
        quiet = None
        outputs = []
        for arm in statement.arms:
            if arm[0] == ("quiet", None):
                quiet = self.block(arm[1], frame, after)
            else:
                outputs.append(arm)
        arms = self.arms(outputs, given["model"], frame, after)
        take = self.take(given["model"], arms, quiet, statement, frame)
        take.input = statement.input
        node = Node("give", frame, statement.place, next=take, **given)
        node.idle = statement.idle
        return node

    def compile_select(self, statement: Statement, frame: Frame, after: Node) -> Node:
        arms = []
        for number, arm in enumerate(statement.arms):
            guard = None if arm.guard is None else self.expression(frame, arm.guard)
            if arm.model is None:
                first = self.block(arm.body, frame, after)
                arms.append(Arm(number, guard, None, None, [], None, first))
                continue
            reference, patterns = arm.model, arm.outputs
            if arm.input is None:
                ((pattern, body, place),) = patterns
                reference, pattern = self.sent_to(frame, reference, pattern)
                patterns = [(pattern, body, place)]
            model = self.model(frame, reference)
            arguments: list = []
            if arm.input is not None:
                self.system.check_input(self.program, model, arm.input)
                self.refuse_reading(model[0], arm.input, True)
                for use in self.system.meant(model):
                    refuse_arms(use, self.program, arm.input)
                arguments = [self.local(frame, argument) for argument in arm.arguments]
                if arguments:
                    self.system.gives_values.add(model[0])
            if patterns is None:
                first, outputs = self.block(arm.body, frame, after), None
            else:
                first, outputs = None, self.arms(patterns, model, frame, after)
            arms.append(Arm(number, guard, model, arm.input, arguments, outputs, first))
        other = None if statement.other is None else self.block(statement.other, frame, after)
        times_out = statement.times_out
        node = Node("select", frame, statement.place, arms=arms, other=other, times_out=times_out)
        node.idle = statement.idle
        return node

