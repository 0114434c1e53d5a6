"""Explores what `maide export SYSTEM --to smv` writes, state by state, and prints for each file the
number of states and of steps, and whether each INVARSPEC holds: "states 12 steps 30 invariant true".

    explore_smv.py FILE...

Reads only that part of SMV: modules of one variable each, DEFINE, one TRANS, instances with the
argument `step`. Whatever else there is, is an error. By NuSMV's manual: a transition satisfies the
TRANS of all instances; of a `case` the first branch counts whose condition is true.
"""

import re
import sys


class Module:
    def __init__(self):
        self.range = self.initial = self.trans = None
        self.define, self.instances, self.steps, self.invariants = {}, {}, None, []


def python_of(text, prefix, names):
    """An expression over `now`, `then` (values by variable) and `step`, as Python."""
    text = re.sub(r"next\((\w+)\)", lambda match: f"then['{prefix}{match[1]}']", text)
    tokens = re.findall(r"then\['[\w.]+'\]|[A-Za-z][\w.]*|\d+|:=|\.\.|[(){},&|!=:;]", text)
    if "".join(tokens) != re.sub(r"\s", "", text):
        sys.exit(f"not understood: {text}")
    position = 0

    def peek():
        return tokens[position] if position < len(tokens) else ""

    def take(expected=None):
        nonlocal position
        token = peek()
        if expected is not None and token != expected:
            sys.exit(f"expected {expected}, not {token} in {text}")
        position += 1
        return token

    def atom():
        token = take()
        if token == "(":
            inner = disjunction()
            take(")")
            return f"({inner})"
        if token == "!":
            return f"(not {atom()})"
        if token == "case":
            branches = "False"
            pairs = []
            while peek() != "esac":
                condition = disjunction()
                take(":")
                pairs.append((condition, disjunction()))
                take(";")
            take("esac")
            for condition, value in reversed(pairs):
                branches = f"(({value}) if ({condition}) else {branches})"
            return branches
        if token in ("TRUE", "FALSE"):
            return token.capitalize()
        if token.isdigit() or token.startswith("then["):
            return token
        return names(token)

    def comparison():
        left = atom()
        if peek() == "=":
            take()
            return f"({left} == {atom()})"
        if peek() == "in":
            take()
            take("{")
            values = [atom()]
            while peek() == ",":
                take()
                values.append(atom())
            take("}")
            return f"({left} in ({', '.join(values)},))"
        return left

    def conjunction():
        parts = [comparison()]
        while peek() == "&":
            take()
            parts.append(comparison())
        return "(" + " and ".join(parts) + ")"

    def disjunction():
        parts = [conjunction()]
        while peek() == "|":
            take()
            parts.append(conjunction())
        return "(" + " or ".join(parts) + ")"

    result = disjunction()
    if position != len(tokens):
        sys.exit(f"too much in {text}")
    return result


def read(path):
    text = re.sub(r"--[^\n]*", "", open(path, encoding="utf-8").read())
    modules = {}
    for part in re.split(r"\bMODULE\b", text)[1:]:
        name, rest = re.match(r"\s*(\w+)(?:\(step\))?\s(.*)", part, re.S).groups()
        module = modules[name] = Module()
        sections = re.split(r"^(IVAR|VAR|ASSIGN|DEFINE|TRANS|INVARSPEC)\b", rest, flags=re.M)
        if sections[0].strip():
            sys.exit(f"not understood: {sections[0]}")
        for kind, body in zip(sections[1::2], sections[2::2]):
            if kind == "TRANS":
                module.trans = body.strip().removesuffix(";")
                continue
            for entry in filter(None, (entry.strip() for entry in body.split(";"))):
                if kind == "IVAR":
                    module.steps = re.fullmatch(r"step : \{(.*)\}", entry)[1].split(", ")
                elif kind == "VAR" and name == "main":
                    instance, of = re.fullmatch(r"(\w+) : (\w+)\(step\)", entry).groups()
                    module.instances[instance] = of
                elif kind == "VAR":
                    module.range = re.fullmatch(r"(\w+) : 0\.\.(\d+)", entry).groups()
                elif kind == "ASSIGN":
                    module.initial = re.fullmatch(r"init\((\w+)\) := (\d+)", entry).groups()
                elif kind == "DEFINE":
                    left, right = re.fullmatch(r"(\w+) := (.*)", entry, re.S).groups()
                    if left in module.define:
                        sys.exit(f"{left} is defined twice")
                    module.define[left] = right
                else:
                    module.invariants.append(entry)
    return modules


def compiled(modules):
    """Of each instance its variable, range, initial value and TRANS; main's TRANS; INVARSPECs."""
    main = modules["main"]
    steps = set(main.steps)

    def names_in(prefix, module):
        def names(token):
            if token == "step":
                return "step"
            if token in steps:
                if token in module.define or (module.range and token == module.range[0]):
                    sys.exit(f"{token} means two things")
                return repr(token)
            if "." in token:
                instance, name = token.split(".")
                inner = modules[main.instances[instance]]
                return names_in(instance + ".", inner)(name)
            if module.range and token == module.range[0]:
                return f"now['{prefix}{token}']"
            if token in module.define:
                return python_of(module.define[token], prefix, names)
            sys.exit(f"unknown name {token}")
        return names

    def function(text, prefix, module):
        return eval("lambda now, then, step: " + python_of(text, prefix, names_in(prefix, module)))

    instances = []
    for instance, of in main.instances.items():
        module = modules[of]
        if module.range[0] != module.initial[0]:
            sys.exit(f"{of} has no initial state")
        instances.append((f"{instance}.{module.range[0]}", int(module.range[1]) + 1,
                          int(module.initial[1]), function(module.trans, instance + ".", module)))
    return (instances, function(main.trans, "", main),
            [function(invariant, "", main) for invariant in main.invariants], main.steps)


def explore(path):
    instances, main, invariants, steps = compiled(read(path))
    initial = tuple(instance[2] for instance in instances)
    seen, open_states, count, hold = {initial}, [initial], 0, [True] * len(invariants)
    variables = [instance[0] for instance in instances]
    while open_states:
        state = open_states.pop()
        now = dict(zip(variables, state))
        hold = [held and invariant(now, None, None) for held, invariant in zip(hold, invariants)]
        successors = 0
        for step in steps:
            if not main(now, None, step):
                continue
            choices = [[value for value in range(size) if trans(now, {variable: value}, step)]
                       for variable, size, _, trans in instances]
            nexts = [()]
            for values in choices:
                nexts = [given + (value,) for given in nexts for value in values]
            successors += len(nexts)
            if step == "idle":
                if nexts != [state]:
                    sys.exit("idle changes something")
                continue
            count += len(nexts)
            for following in nexts:
                if following not in seen:
                    seen.add(following)
                    open_states.append(following)
        if successors == 0:
            sys.exit(f"no transition from {state}: the relation is not total")
    print(f"states {len(seen)} steps {count}",
          *(f"invariant {'true' if held else 'false'}" for held in hold))


for argument in sys.argv[1:]:
    explore(argument)
