"""Reads services, executors and nodes from a system file."""

from __future__ import annotations

from typing import Any

from deliveries import AT_ONCE, acknowledged_by_one
from expressions import Scope
from language import Parser, Refused, Statement, parse_declarations, parse_program
from nodes import (
    KINDS,
    CallbackText,
    Executor,
    NodeText,
    callback_of,
    executor_of,
    group_of,
    pool_of,
    start_of,
)
from services import Client, Service
from services_on_wires import SERVER, ServiceOnWires

NODE_KEYS = {"executor", "groups", "clients", "variables", "callbacks", "start", "threads"}


def parse_end(text: str) -> tuple[str, list, str | None]:
    """`name`, `name[i]` or `node.callback` as (name, indices, callback)."""
    parser = Parser(text, text)
    name, indices = parser.reference()
    callback = parser.name() if parser.accept(".") else None
    parser.end()
    return name, indices, callback


def nodes_at(system: Any, name: str, index: tuple | None) -> list[NodeText]:
    """The nodes of this name; without an index, all members of an array."""
    return [n for n in system.nodes if n.name == name and index in (None, n.index)]


def callbacks_at(system: Any, text: str, scope: Scope) -> list[CallbackText] | None:
    """The code of what an end names, callbacks and the rest; None if it is no node."""
    name, indices, callback = parse_end(text)
    index = tuple(scope.constant(i) for i in indices)
    nodes = nodes_at(system, name, index if indices else None)
    if not nodes:
        return None
    found = [c for n in nodes for c in n.codes() if callback in (None, c.name)]
    if not found:
        raise Refused(f"no callback {text}")
    return found


def read_executors(system: Any) -> dict[str, Executor]:
    """The executors of the file."""
    found = {}
    for name, description in (system.document.get("executors") or {}).items():
        number = lambda value: system.number(value, system.file)  # noqa: E731
        found[name] = executor_of(name, description, number)
        system.add_name(name, ("executor", name))
    return found


def read_nodes(system: Any) -> list[NodeText]:
    """The nodes of the file, whose callbacks have no numbers yet."""
    executors = read_executors(system)
    found = []
    for header, description in (system.document.get("nodes") or {}).items():
        if not set(description) <= NODE_KEYS:
            raise Refused(f"node {header}: unknown keys")
        name, array = system.array(header)
        system.add_name(name, ("node", name))
        for index, scope in array:
            full = f"{name}[{','.join(map(str, index))}]" if index else name
            executor = Executor(full, 1, False)
            if "executor" in description:
                if description["executor"] not in executors:
                    raise Refused(f"no executor {description['executor']}")
                executor = executors[description["executor"]]
            node = NodeText(name, index, full, executor, scope)
            groups = description.get("groups") or {}
            for own, text in (description.get("callbacks") or {}).items():
                node.callbacks.append(callback_of(node, own, text, groups))
            if "start" in description:
                node.start = start_of(node, description["start"])
            for own, text in (description.get("threads") or {}).items():
                number = lambda value, scope=scope: system.number(value, scope)  # noqa: E731
                node.pools.append(pool_of(node, own, text, number))
            executor.nodes.append(node)
            if executor.main is not None and len(executor.nodes) == 1:
                node.main = start_of(node, executor.main, "main")
            names = [code.name for code in node.codes()]
            if len(set(names)) < len(names):
                raise Refused(f"node {header}: two codes of one name")
            found.append(node)
            system.node_of[(name, index)] = (node, description, groups)
    system.executors = list(dict.fromkeys([*executors.values(), *(n.executor for n in found)]))
    for executor in executors.values():
        if executor.main is not None and not executor.nodes:
            raise Refused(f"executor {executor.name}: 'main', and no nodes")
    return found


def read_node_variables(system: Any) -> None:
    """The variables of the nodes."""
    for node, description, _ in system.node_of.values():
        text = description.get("variables")
        origin = f"variables of {node.name}"
        for statement in parse_declarations(text, origin) if text else []:
            variable = system.variable_of(statement, node.scope)
            if variable.name in node.scope.names:
                raise Refused(f"{variable.name} is there twice")
            node.scope.names[variable.name] = ("variable", variable)
            node.variables.append(variable)
            system.variables.append(variable)


def service_members(system: Any) -> list[tuple[str, tuple, Scope, dict]]:
    """(name, index, scope, description) of each service."""
    found = []
    for header, description in (system.document.get("services") or {}).items():
        keys = {"server", "clients", "with", "learn", "delivery", "loses", "stream"}
        if not set(description) <= keys:
            raise Refused(f"service {header}: unknown keys")
        name, array = system.declare_array(header)
        found += [(name, index, scope, description) for index, scope in array]
    return found


def listed(names: Any) -> list:
    """A list of names, or one name."""
    return [names] if isinstance(names, str) else list(names)


def add_client_callbacks(system: Any, services: list) -> None:
    """Gives the nodes a callback for each service that has them as clients."""
    for name, index, scope, description in services:
        for text in listed(description["clients"]):
            other, indices, callback = parse_end(text)
            at = tuple(scope.constant(i) for i in indices)
            if callback is not None and nodes_at(system, other, None):
                raise Refused(f"service {name}: a client is a program or a node")
            for node in nodes_at(system, other, at if indices else None):
                node.callbacks.append(client_callback(system, node, name, index))
    for node, description, _ in system.node_of.values():
        own = [c.what for c in node.callbacks if c.kind == "client"]
        for text in client_entries(description):
            if not any(entry_means(system, text, node, *what) for what in own):
                raise Refused(f"node {node.full_name} is no client of {text}")
        if not node.codes():
            raise Refused(f"node {node.full_name} has no callback")


def client_entries(description: dict) -> dict:
    """The entries under `clients` of a node."""
    entries = description.get("clients") or {}
    return entries if isinstance(entries, dict) else {name: None for name in listed(entries)}


def entry_means(system: Any, text: str, node: NodeText, name: str, index: tuple) -> bool:
    """Whether an entry under `clients` of a node means this service."""
    other, indices, _ = parse_end(text)
    at = tuple(node.scope.constant(i) for i in indices)
    return other == name and (not indices or at == index)


def client_callback(system: Any, node: NodeText, name: str, index: tuple) -> CallbackText:
    """The callback in which the answers of a service come."""
    _, description, groups = system.node_of[(node.name, node.index)]
    entry: Any = None
    for text, value in client_entries(description).items():
        if entry_means(system, text, node, name, index):
            entry = value
    full = f"{name}[{','.join(map(str, index))}]" if index else name
    if isinstance(entry, dict):
        if not set(entry) <= {"group", "do"}:
            raise Refused(f"client {full} of {node.full_name}: unknown keys")
        callback = callback_of(
            node, full, {"client": name, **entry, "do": entry.get("do", "skip;")}, groups
        )
        callback.has_code = "do" in entry
    else:
        callback = callback_of(node, full, {"client": name, "do": "skip;"}, groups)
        callback.group = group_of(entry, groups, full)
    callback.what = (name, index)
    return callback


def number_callbacks(system: Any, first: int) -> None:
    """Numbers the copies of all callbacks, start code and threads, as programs behind the
    others."""
    for node in system.nodes:
        for callback in node.callbacks:
            is_alone = callback.group[1] or callback.come is not None
            copies = 1 if is_alone else node.executor.threads
            callback.numbers = list(range(first, first + copies))
            first += copies
            if callback.kind == "serves":
                name, indices = callback.what
                callback.what = (name, tuple(callback.scope.constant(i) for i in indices))
            if callback.come is not None:
                callback.come.users = set(callback.numbers)
        if node.start is not None:
            node.start.numbers = [first]
            node.executor.starts.append(first)
            first += 1
        for pool in node.pools:
            pool.text.numbers = list(range(first, first + pool.count))
            first += pool.count
        if node.main is not None:
            node.main.numbers = [first]
            first += 1
    for node in system.nodes:
        if node.main is not None:  # behind the start code of all nodes
            node.executor.starts += node.main.numbers
    for kind in KINDS:
        for node in system.nodes:
            for callback in node.callbacks:
                if callback.kind == kind:
                    node.executor.callbacks.append(callback)


def add_services(system: Any, services: list) -> None:
    """Makes the services, whose ends have numbers."""
    for name, index, scope, description in services:
        options = description.get("with") or {}
        rmw = options.get("rmw", "cyclonedds")
        if not set(options) <= {"depth", "rmw"} or rmw not in ("cyclonedds", "fastrtps"):
            raise Refused(f"service {name}: {options}")
        depth = system.number(options.get("depth", 10), scope)
        servers = []
        for text in listed(description["server"]):
            callbacks = callbacks_at(system, text, scope)
            if callbacks is None:
                servers += [frozenset([n]) for n in system.program_numbers(text, scope)]
            else:
                nodes = dict.fromkeys(c.node for c in callbacks)
                servers += [node.numbers() for node in nodes]
        if len(servers) != 1:
            raise Refused(f"service {name}: one server")
        clients = []
        for text in listed(description["clients"]):
            callbacks = callbacks_at(system, text, scope)
            if callbacks is None:
                numbers = system.program_numbers(text, scope)
                clients += [Client(frozenset([n])) for n in numbers]
                continue
            for node in dict.fromkeys(c.node for c in callbacks):
                own = [c for c in node.callbacks if c.what == (name, index)]
                has_code = any(c.has_code for c in own if c.kind == "client")
                over = not has_code or waits_for(system, node, name)
                rounds = node.executor.rounds
                clients.append(Client(node.numbers(), True, over, rounds, has_code))
        if sum(len(c.programs) for c in clients) != len({p for c in clients for p in c.programs}):
            raise Refused(f"service {name}: a client is there twice")
        full = f"{name}[{','.join(map(str, index))}]" if index else name
        slots = slots_of(system, (name, index))
        arguments = (full, depth, servers[0], clients, slots, rmw == "fastrtps")
        to_server = [
            system.wire(description, {}, None, [], i, servers[0], 0, client.programs)
            for i, client in enumerate(clients)
        ]
        to_clients = [
            system.wire(description, {}, None, [], SERVER, client.programs, i, servers[0])
            for i, client in enumerate(clients)
        ]
        if len(clients) == 1:
            to_clients = [acknowledged_by_one(wire) for wire in to_clients]
        wires = [acknowledged_by_one(wire) for wire in to_server] + to_clients
        is_late = any(wire.delivery != AT_ONCE for wire in wires)
        service = ServiceOnWires(*arguments, wires) if is_late else Service(*arguments)
        system.add_use(name, index, service)


def waits_for(system: Any, node: NodeText, service: str) -> bool:
    """Whether code that may be this node's says that it waits for an answer of the service."""
    codes = [arm for code in node.codes() for _, arm in code.arms]
    if node.executor.main is not None:
        codes.append(parse_program(node.executor.main, "main"))
    if any(waits_in(body, {service}) for body in codes):
        return True
    bodies = system.procedures.values()
    return any(waits_in(body, {service, *parameters}) for parameters, body in bodies)


def waits_in(value: Any, names: set[str]) -> bool:
    """Whether a text has `wait s -> answer`, `on s!answer` or `spin until s -> answer`."""
    if isinstance(value, (list, tuple)):
        return any(waits_in(one, names) for one in value)
    if not isinstance(value, Statement):
        return False
    fields = vars(value)
    model = fields.get("model")
    if model is not None and model[0] in names:
        patterns = [fields.get("pattern"), *(arm[0] for arm in fields.get("outputs") or [])]
        is_answer = any(pattern is not None and pattern[0] == "answer" for pattern in patterns)
        if is_answer and fields.get("input") is None:
            return True
    return any(waits_in(one, names) for one in fields.values())


def slots_of(system: Any, service: tuple) -> tuple[int, ...]:
    """The copies of a server's callback, if it may run several times at once."""
    serving = [c for n in system.nodes for c in n.callbacks if c.kind == "serves"]
    serving = [c for c in serving if c.what == service]
    if len(serving) > 1:
        raise Refused(f"service {service[0]}: two callbacks")
    numbers = tuple(n for callback in serving for n in callback.numbers)
    return numbers if len(numbers) > 1 else ()


def check_serving(system: Any) -> None:
    """Refuses callbacks that serve what their node does not."""
    for node in system.nodes:
        for callback in node.callbacks:
            if callback.kind != "serves":
                continue
            number = system.numbers.get(callback.what)
            use = system.uses[number] if number is not None else None
            if not isinstance(use, Service) or callback.numbers[0] not in use.server:
                raise Refused(f"{callback.full_name()}: {node.name} is no server of that")
