"""Explores what `maide export SYSTEM --to mcrl2` writes, state by state, and prints for each file
the number of states, of transitions and of states without any: "states 12 steps 30 dead 1".

    explore_mcrl2.py FILE...

Reads only that part of mCRL2: one sort of constants, processes that are sums of `action . Process`,
and init allow(..., comm(..., parallel processes)). Whatever else there is, is an error. By mCRL2's
semantics: parallel processes do actions alone or together; `comm` turns two halves with equal
arguments into one action; what `allow` does not name cannot happen.
"""

import re
import sys


def read(path):
    text = re.sub(r"%[^\n]*", "", open(path, encoding="utf-8").read())
    parts = re.fullmatch(r"\s*sort Program = struct ([\w |]+);\s*(?:act (.*?))?proc\n(.*)init (.*);\s*",
                         text, re.S)
    if not parts:
        sys.exit("not understood")
    programs = parts[1].split(" | ")
    actions = set()
    for line in filter(None, (line.strip() for line in (parts[2] or "").split(";"))):
        actions |= set(re.fullmatch(r"(.*) : Program", line)[1].split(", "))
    processes = {}
    for line in filter(None, (line.strip() for line in parts[3].split(";"))):
        name, body = line.split(" = ", 1)
        if name in processes or name in actions or name in programs:
            sys.exit(f"{name} means two things")
        summands = []
        for summand in [] if body == "delta" else body.split(" + "):
            own = re.fullmatch(r"(\w+)\((\w+)\) \. (\w+)", summand)
            any_program = re.fullmatch(r"\(sum p: Program \. (\w+)\(p\)\) \. (\w+)", summand)
            if own and own[2] in programs:
                summands.append((own[1], own[2], own[3]))
            elif any_program:
                summands += [(any_program[1], program, any_program[2]) for program in programs]
            else:
                sys.exit(f"not understood: {summand}")
            if summands[-1][0] not in actions:
                sys.exit(f"{summands[-1][0]} is no action")
        processes[name] = summands
    allow = re.fullmatch(r"allow\(\{(.*?)\},\s*(?:comm\(\{(.*?)\},\s*(.*)\)|(.*))\)", parts[4], re.S)
    meetings = {}
    for meeting in filter(None, (allow[2] or "").split(", ")):
        left, right, result = re.fullmatch(r"(\w+) \| (\w+) -> (\w+)", meeting).groups()
        meetings[frozenset((left, right))] = result
    initial = tuple((allow[3] or allow[4]).split(" || "))
    for summands in processes.values():
        if any(target not in processes for _, _, target in summands):
            sys.exit("an unknown process")
    return processes, set(filter(None, allow[1].split(", "))), meetings, initial


def successors(state, processes, allowed, meetings):
    for at, process in enumerate(state):
        for action, argument, target in processes[process]:
            if action in allowed:
                yield action, argument, state[:at] + (target,) + state[at + 1:]
            for other in range(at + 1, len(state)):
                for second, second_argument, second_target in processes[state[other]]:
                    result = meetings.get(frozenset((action, second)))
                    if result in allowed and argument == second_argument:
                        following = list(state)
                        following[at], following[other] = target, second_target
                        yield result, argument, tuple(following)


def explore(path):
    processes, allowed, meetings, initial = read(path)
    seen, open_states, steps, dead = {initial}, [initial], 0, 0
    while open_states:
        state = open_states.pop()
        transitions = set(successors(state, processes, allowed, meetings))
        steps += len(transitions)
        dead += not transitions
        for _, _, following in transitions - {None}:
            if following not in seen:
                seen.add(following)
                open_states.append(following)
    print(f"states {len(seen)} steps {steps} dead {dead}")


for argument in sys.argv[1:]:
    explore(argument)
