"""What programs do: the steps of one program in a state of its component.

A world is (states of the models, values of the shared variables), each a tuple. A control state is
(number of the node, labels that hold, values of the variables in scope, the value kept for a
write), or ("error", place, sentence) for a program that made a mistake.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from control import SILENT, Arm, Node
from expressions import Mistake, Variable, evaluate

World = tuple[tuple, tuple]
Control = tuple
DEAD = "dead"  # kept while a program's process is dead, and may begin anew
CALLING = "calling"  # kept while a program stands in a call that an arrival ends


def is_error(control: Control) -> bool:
    """Whether the program made a mistake."""
    return control[0] == "error"


@dataclass
class Step:
    """A step of a program: its name, what it leads to, and what fairness and formulas look at.

    Of an arrival the program is the wire; a loss is no progress, as a death, nor is to wake at a
    condition that nobody notified."""

    program: Any
    label: tuple
    control: Control | None = None
    world: World | None = None
    events: tuple = ()
    also: tuple = ()  # (program, control) of others that go on in this step
    arm: Any = None  # (place, number) of an arm of a select
    choice: Any = None  # (place, outcome) of a fair choice
    cut: bool = False
    death: bool = False
    carries: tuple = ()  # who spins, and leaves its statement where a callback ends
    death_of: Any = None  # (a process, how), where it dies in this step


class Program:
    """A program, compiled, that moves in the worlds of a system."""

    first_of_callback = False  # whether it is the first copy of a callback

    def __init__(
        self, system: Any, number: int, name: str, nodes: list[Node], first: Node
    ) -> None:
        self.system = system
        self.number = number
        self.name = name
        self.part: str | None = name  # of a node: what the file calls this code
        self.nodes = nodes
        self.first = first
        self.end = next(node for node in nodes if node.kind in ("end", "finish"))
        self.labels = {node.label for node in nodes if node.kind == "label"}
        self.can_err = True

    # --- between steps

    def begun(self, world: World) -> tuple[Control, World]:
        """The control state at first, and the world after what was done on the way there."""
        return self.start(), world

    def start(self) -> Control:
        """The control state at first."""
        return self.arrive(self.first, self.at_first())

    def at_first(self) -> dict[Variable, Any]:
        """The values of the variables of the file that it alone uses."""
        return {v: v.initial for v in self.system.variables if v.users == {self.number}}

    def arrive(self, node: Node, values: dict[Variable, Any], kept: Any = None) -> Control:
        """Where control comes to stand, from this node on."""
        labels = set()
        seen = set()
        values = dict(values)
        try:
            while node.kind in SILENT:
                here = (node.number, tuple(values.get(v) for v in node.scope))
                if here in seen:
                    raise Mistake("control goes round without a step")
                seen.add(here)
                if node.kind == "label":
                    labels.add(node.label)
                elif node.kind == "enter":
                    for variable in node.variables:
                        values[variable] = variable.all_least()
                elif node.kind == "assign":
                    self.assign(node, evaluate(node.value, values.__getitem__), values)
                elif node.kind == "branch":
                    node = node.yes if evaluate(node.condition, values.__getitem__) else node.no
                    continue
                node = node.next
            self.look(node, values)
        except Mistake as mistake:
            return ("error", node.place, str(mistake))
        return (
            node.number,
            frozenset(labels),
            tuple(values.get(v) for v in node.scope),
            kept,
        )

    @staticmethod
    def assign(node: Node, value: Any, values: dict[Variable, Any]) -> None:
        """Sets a local variable, or a member of it."""
        position = [evaluate(index, values.__getitem__) for index in node.indices]
        whole = values.get(node.variable)
        values[node.variable] = node.variable.written(whole, position, value)

    def look(self, node: Node, values: dict[Variable, Any]) -> None:
        """Evaluates what is evaluated when control arrives, for the mistakes in it."""
        read = values.__getitem__
        if node.kind in ("give", "take", "present", "offer", "withdraw"):
            self.model(node.model, read)
            for argument in getattr(node, "arguments", []):
                evaluate(argument, read)
        elif node.kind == "spin" and node.model is not None:
            self.model(node.model, read)
        elif node.kind == "select":
            for arm in node.arms:
                if arm.model is not None and self.is_local_and_holds(arm, read):
                    self.model(arm.model, read)
                    for argument in arm.arguments:
                        evaluate(argument, read)
        elif node.kind == "any":
            evaluate(node.low, read)
            evaluate(node.high, read)

    @staticmethod
    def is_local_and_holds(arm: Arm, read: Any) -> bool:
        """Whether the guard holds as soon as control is there."""
        try:
            return arm.guard is None or bool(evaluate(arm.guard, read))
        except KeyError:  # it reads a shared variable
            return False

    def model(self, reference: tuple, read: Any) -> int:
        """The number of the model that a statement uses."""
        name, indices = reference
        return self.system.model_number(name, tuple(evaluate(i, read) for i in indices))

    def has_ended(self, control: Control) -> bool:
        """Whether the program is at its end."""
        is_over = not is_error(control) and self.nodes[control[0]].kind == "end"
        return is_over and control[3] != DEAD

    def rests(self, control: Control) -> bool:
        """Whether the program may stand here for ever."""
        if is_error(control):
            return False
        node = self.nodes[control[0]]
        return node.kind == "end" or node.idle

    def value(self, control: Control, variable: Variable) -> Any:
        """The value of a local variable, None if it is not in scope."""
        if is_error(control):
            return None
        scope = self.nodes[control[0]].scope
        return control[2][scope.index(variable)] if variable in scope else None

    # --- steps

    def values_at(self, node: Node, control: Control, world: World) -> dict:
        """The values of the variables in scope."""
        return dict(zip(node.scope, control[2]))

    def settled(self, control: Control, world: World) -> tuple[Control, World]:
        """Where control comes to stand, and the world with what is kept there."""
        return control, world

    def steps(self, control: Control, world: World) -> list[Step]:
        """All steps that the program can make."""
        if is_error(control):
            return []
        node = self.nodes[control[0]]
        if node.kind == "end":
            return []
        values = self.values_at(node, control, world)
        if control[3] == CALLING:
            return self.returned(control, world)
        return getattr(self, "steps_" + node.kind)(node, control, values, world)

    def dead(self, control: Control, world: World, has_lives: bool, is_over: bool) -> Control:
        """The control state after its process died: it stands at its end, but has not ended unless
        it is over for ever. Where a process has lives, what the file declares for it alone is as
        at first then, and what its text declares is in no scope."""
        is_failed = is_error(control)  # behind its own `kill`, which it does not come to
        values = self.at_first()
        if not has_lives and not is_failed:
            values = self.values_at(self.nodes[control[0]], control, world)
        kept = tuple(values.get(v) for v in self.end.scope)
        return (self.end.number, frozenset(), kept, None if is_over else DEAD)

    def step(
        self, label: tuple, node: Node, values: dict, world: World, kept: Any = None, **more: Any
    ) -> Step:
        """A step after which control goes on at the node."""
        control, world = self.settled(self.arrive(node, values, kept), world)
        return Step(self.number, label, control, world, **more)

    def mistake(
        self, label: tuple, place: Any, why: Mistake | str, world: World, **more: Any
    ) -> Step:
        """A step into an error."""
        return Step(self.number, label, ("error", place, str(why)), world, **more)

    def reader(self, values: dict, world: World) -> Any:
        """What gives the values of local and shared variables."""
        shared = self.system.shared_values(world)
        return lambda v: shared[v] if v.shared else values[v]

    @staticmethod
    def with_model(world: World, number: int, state: Any) -> World:
        """The world with another state of one model."""
        models, shared = world
        return (models[:number] + (state,) + models[number + 1 :], shared)

    def steps_give(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        read = values.__getitem__
        number = self.model(node.model, read)
        action = (node.input, tuple(evaluate(a, read) for a in node.arguments))
        why = self.error_in(number, action, world)
        if why is not None:
            return [self.mistake((number, "?", action), node.place, why, world)]
        after, cut = self.system.uses[number].give(world[0][number], self.number, action)
        found = [
            self.gave((number, "?", action, event[2]), node, values,
                      self.with_model(world, number, state), number, events=(event,))
            for state, event in after
        ]
        return found + self.cuts((number, "?", action), cut)

    def error_in(self, number: int, action: tuple, world: World) -> str | None:
        """Why an input is an error of the program; None if it is none."""
        use = self.system.uses[number]
        has_errors = hasattr(use, "mistake")
        return use.mistake(world[0][number], self.number, action) if has_errors else None

    def steps_sleep(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        condition, lock = node.condition, node.condition.mutex
        number = self.system.uses.index(condition)
        label = (number, "?", ("wait", ()))
        try:
            given_back = self.system.uses[lock].given_back(world[0][lock], self.number)
        except Mistake as mistake:
            return [self.mistake(label, node.place, mistake, world)]
        if given_back is None:
            return []
        waiting = condition.with_waiting(world[0][number], self.number)
        after = self.with_model(self.with_model(world, number, waiting), lock, given_back)
        unlocks = self.system.uses[lock].event(self.number, "unlock")
        events = (condition.event(self.number, "wait"), unlocks)
        return [self.step(label, node.next, values, after, events=events)]

    def steps_wake(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        """It wakes as it was notified, or by itself, which is no progress; or its time is over."""
        number = self.system.uses.index(node.condition)
        is_notified = dict(world[0][number])[self.number]
        woken = node.condition.without(world[0][number], self.number)
        world = self.with_model(world, number, woken)
        found = self.taken_again(node, values, world, ("wakes", is_notified), not is_notified)
        if node.late is not None and not is_notified:
            found.append(self.step(("timeout",), node.late, values, world))
        return found

    def steps_retake(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        return self.taken_again(node, values, world, ("retakes",), False)

    def taken_again(
        self, node: Node, values: dict, world: World, label: tuple, by_itself: bool
    ) -> list[Step]:
        """The step in which the mutex of a condition is taken again."""
        lock = node.condition.mutex
        taken = self.system.uses[lock].taken_again(world[0][lock], self.number)
        if taken is None:
            return []
        after = self.with_model(world, lock, taken)
        events = (self.system.uses[lock].event(self.number, "lock"),)
        return [self.step(label, node.next, values, after, events=events, death=by_itself)]

    def gave(
        self, label: tuple, node: Node, values: dict, world: World, number: int, **more: Any
    ) -> Step:
        """A step after which control goes on, or stands in the call until all readers have it."""
        use = self.system.uses[number]
        if not hasattr(use, "is_calling") or not use.is_calling(world[0][number], self.number):
            return self.step(label, node.next, values, world, **more)
        kept = tuple(values.get(v) for v in node.scope)
        control, world = self.settled((node.number, frozenset(), kept, CALLING), world)
        return Step(self.number, label, control, world, **more)

    def returned(self, control: Control, world: World) -> list[Step]:
        """The step with which a call ends whose last readers died."""
        after, world_after = self.called(control, world)
        return [] if after == control else [Step(self.number, ("returns",), after, world_after)]

    def called(self, control: Control, world: World) -> tuple[Control, World]:
        """Where control comes to stand if its call ended with what arrived."""
        if control[3:] != (CALLING,):
            return control, world
        node = self.nodes[control[0]]
        values = self.values_at(node, control, world)
        number = self.model(node.model, values.__getitem__)
        if self.system.uses[number].is_calling(world[0][number], self.number):
            return control, world
        return self.settled(self.arrive(node.next, values), world)

    def cuts(self, label: tuple, cut: Any, **more: Any) -> list[Step]:
        """The steps that leave what was learned: one, or one for each model that is given it."""
        by = cut if isinstance(cut, tuple) else (None,) if cut else ()
        return [Step(self.number, (*label, one), cut=True, **more) for one in by]

    def matched(self, arms: list, action: tuple, values: dict) -> tuple[Node, list] | None:
        """The arm that an output belongs to, and what it sets: (variable, value)."""
        for (name, items), node in arms:
            if name is not None and name != action[0]:  # a callback may take whatever comes
                continue
            if items is None:
                return node, []
            if len(items) != len(action[1]):
                continue
            bound = []
            for (how, what), value in zip(items, action[1]):
                if how == "bind":
                    bound.append((what, value))
                elif evaluate(what, values.__getitem__) != value:
                    break
            else:
                return node, bound
        return None

    def took(
        self,
        label: tuple,
        place: Any,
        arms: list,
        action: tuple,
        values: dict,
        world: World,
        **more: Any,
    ) -> Step | None:
        """The step that takes this output, or None if no arm is for it."""
        match = self.matched(arms, action, values)
        if match is None:
            return None
        node, bound = match
        values = dict(values)
        try:
            for variable, value in bound:
                values[variable] = variable.check(value)
        except Mistake as mistake:
            return self.mistake(label, place, mistake, world, **more)
        return self.step(label, node, values, world, **more)

    def steps_take(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        number = self.model(node.model, values.__getitem__)
        use, state = self.system.uses[number], world[0][number]
        found = []
        for action, after, event in use.due(state, self.number):
            step = self.took((number, "!", action), node.place, node.arms, action, values,
                             self.with_model(world, number, after), events=(event,))
            if step is not None:
                found.append(step)
        if node.quiet is not None and use.quiet(state, self.number, node.input, True):
            found.append(self.step((number, "quiet"), node.quiet, values, world))
        return found

    def steps_present(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        number = self.model(node.model, values.__getitem__)
        if not self.system.uses[number].is_there(world[0][number]):
            return []
        return [self.step((number, "there"), node.next, values, world)]

    def steps_offer(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        number = self.model(node.model, values.__getitem__)
        state = self.system.uses[number].offered(world[0][number])
        after = self.with_model(world, number, state)
        return [self.step((number, "offer"), node.next, values, after)]

    def steps_withdraw(
        self, node: Node, control: Control, values: dict, world: World
    ) -> list[Step]:
        number = self.model(node.model, values.__getitem__)
        state = self.system.uses[number].withdrawn(world[0][number])
        after = self.with_model(world, number, state)
        return [self.step((number, "withdraw"), node.next, values, after)]

    def steps_run(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        pool = node.pool
        label = (pool.use, "run")
        busy = pool.with_one_more(world[0][pool.use])
        if busy is None:
            why = f"no copy of {pool.text.full_name()} is free"
            return [self.mistake(label, node.place, why, world)]
        return [self.step(label, node.next, values, self.with_model(world, pool.use, busy))]

    def steps_join(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        if any(world[0][node.pool.use]):
            return []
        return [self.step((node.pool.use, "join"), node.next, values, world)]

    def steps_misspin(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        why = "the node has been added to an executor already"
        return [self.mistake(("spin",), node.place, why, world)]

    def steps_kill(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        process = node.process
        label = (process.use, "restart" if node.restarts else "kill")
        life = world[0][process.use]
        if not life.is_dead:
            step = self.step(label, node.next, values, world)
            step.death_of = (process, "restarted" if node.restarts else "killed")
            return [step]
        if node.restarts:
            world = self.with_model(world, process.use, life._replace(is_wanted=True))
        return [self.step(label, node.next, values, world)]

    def steps_quit(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        return [Step(self.number, ("quit",), control, world, death_of=(node.process, "quit"))]

    def steps_unknown(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        return self.cuts(("unknown",), True)

    def steps_choose(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        return [
            self.step(("if", outcome), after, values, world,
                      choice=(node.place, outcome) if node.fair else None)
            for outcome, after in enumerate(node.outcomes)
        ]

    def steps_any(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        read = values.__getitem__
        low, high = evaluate(node.low, read), evaluate(node.high, read)
        found = []
        for value in range(low, high + 1):
            label = ("any", value)
            choice = (node.place, value) if node.fair else None
            if node.variable.shared:
                found.append(self.step(label, node.next, values, world, value, choice=choice))
                continue
            after = dict(values)
            try:
                self.assign(node, value, after)
            except Mistake as mistake:
                found.append(self.mistake(label, node.place, mistake, world, choice=choice))
                continue
            found.append(self.step(label, node.next, after, world, choice=choice))
        return found

    def steps_read_branch(
        self, node: Node, control: Control, values: dict, world: World
    ) -> list[Step]:
        try:
            holds = evaluate(node.condition, self.reader(values, world))
        except Mistake as mistake:
            return [self.mistake(("read",), node.place, mistake, world)]
        return [self.step(("read",), node.yes if holds else node.no, values, world)]

    def steps_read_assign(
        self, node: Node, control: Control, values: dict, world: World
    ) -> list[Step]:
        after = dict(values)
        try:
            self.assign(node, evaluate(node.value, self.reader(values, world)), after)
        except Mistake as mistake:
            return [self.mistake(("read",), node.place, mistake, world)]
        return [self.step(("read",), node.next, after, world)]

    def steps_read_keep(
        self, node: Node, control: Control, values: dict, world: World
    ) -> list[Step]:
        try:
            kept = evaluate(node.value, self.reader(values, world))
        except Mistake as mistake:
            return [self.mistake(("read",), node.place, mistake, world)]
        return [self.step(("read",), node.next, values, world, kept)]

    def steps_write(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        read = values.__getitem__
        try:
            value = control[3] if node.value is None else evaluate(node.value, read)
            position = [evaluate(index, read) for index in node.indices]
            shared = self.stored(world[1], node.variable, position, value)
        except Mistake as mistake:
            return [self.mistake(("write",), node.place, mistake, world)]
        return [self.step(("write",), node.next, values, (world[0], shared))]

    def stored(self, shared: tuple, variable: Variable, position: list, value: Any) -> tuple:
        """The shared values after one was written."""
        at = self.system.shared.index(variable)
        whole = variable.written(shared[at], position, value)
        return shared[:at] + (whole,) + shared[at + 1 :]

    def steps_atomic(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        values = dict(values)
        try:
            if node.condition is not None:
                if not evaluate(node.condition, self.reader(values, world)):
                    return []
            after = self.run(node.body, values, world)
        except Mistake as mistake:
            return [self.mistake(("atomic",), node.place, mistake, world)]
        return [self.step(("atomic",), node.next, values, after)]

    def run(self, body: list[tuple], values: dict, world: World) -> World:
        """The world after the statements of an `atomic`; local values change in place."""
        for statement in body:
            read = self.reader(values, world)
            if statement[0] == "if":
                _, condition, yes, no = statement
                world = self.run(yes if evaluate(condition, read) else no, values, world)
                continue
            _, variable, indices, expression = statement
            value = evaluate(expression, read)
            position = [evaluate(index, read) for index in indices]
            if variable.shared:
                world = (world[0], self.stored(world[1], variable, position, value))
            else:
                values[variable] = variable.written(values[variable], position, value)
        return world

    def steps_select(self, node: Node, control: Control, values: dict, world: World) -> list[Step]:
        read = self.reader(values, world)
        found: list[Step] = []
        something_due = False
        for arm in node.arms:
            mark = (node.place, arm.number)
            try:
                if arm.guard is not None and not evaluate(arm.guard, read):
                    continue
                number = None if arm.model is None else self.model(arm.model, values.__getitem__)
                arguments = tuple(evaluate(a, values.__getitem__) for a in arm.arguments)
            except Mistake as mistake:
                found.append(self.mistake(("arm", arm.number), mark, mistake, world, arm=mark))
                continue
            if number is None:
                found.append(self.step(("arm", arm.number), arm.next, values, world, arm=mark))
                continue
            found += self.steps_arm(arm, mark, number, (arm.input, arguments), values, world)
            name = arm.input if arm.input is not None else arm.outputs[0][0][0]
            use, is_input = self.system.uses[number], arm.input is not None
            if not use.quiet(world[0][number], self.number, name, is_input):
                something_due = True
        if node.other is not None and not found and not something_due:
            after = self.timed_out(node, values, world) if node.times_out else world
            found.append(self.step(("otherwise",), node.other, values, after))
        return found

    def timed_out(self, node: Node, values: dict, world: World) -> World:
        """The world after the time-out of a `select`: requests to the services for whose answers it
        waited are overdue, whether the arm's guard held or not."""
        for arm in node.arms:
            if arm.input != "receive":
                continue
            try:
                number = self.model(arm.model, values.__getitem__)
            except Mistake:  # behind a guard that does not hold
                continue
            use = self.system.uses[number]
            if hasattr(use, "timed_out"):
                world = self.with_model(world, number, use.timed_out(world[0][number], self.number))
        return world

    def steps_arm(
        self, arm: Arm, mark: tuple, number: int, given: tuple, values: dict, world: World
    ) -> list[Step]:
        """The steps of an arm `on` a model."""
        use, state = self.system.uses[number], world[0][number]
        found: list[Step] = []
        if arm.input is None:
            for action, after, event in use.due(state, self.number):
                step = self.took(("arm", arm.number, action), mark, arm.outputs, action, values,
                                 self.with_model(world, number, after), events=(event,), arm=mark)
                if step is not None:
                    found.append(step)
            return found
        label = ("arm", arm.number, given)
        why = self.error_in(number, given, world)
        if why is not None:
            return [self.mistake(label, mark, why, world, arm=mark)]
        if arm.outputs is None:
            after_all, cut = use.give(state, self.number, given)
            for after, event in after_all:
                found.append(self.step((*label, event[2]), arm.next, values,
                                       self.with_model(world, number, after),
                                       events=(event,), arm=mark))
        else:
            picked, cut = use.pick(state, self.number, given)
            for action, after, events in picked:
                world_after = self.with_model(world, number, after)
                step = self.took((*label, action), mark, arm.outputs, action, values, world_after,
                                 events=events, arm=mark)
                if step is None:
                    why = f"no arm for {action}"
                    step = self.mistake((*label, action), mark, why, world_after,
                                        events=events, arm=mark)
                found.append(step)
        return found + self.cuts(label, cut, arm=mark)
