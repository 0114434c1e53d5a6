"""Explores what `maide export SYSTEM --to mcrl2` writes, state by state, and prints for each file
the number of states, of transitions and of states without any: "states 12 steps 30 dead 1".

    explore_mcrl2.py FILE...

Reads only that part of mCRL2: one sort of constants, processes that are sums of `action . Process`,
and init allow(..., comm(..., parallel processes)). Whatever else there is, is an error. By mCRL2's
semantics: parallel processes do actions alone or together; `comm` turns parts with equal arguments
into one action; what `allow` does not name cannot happen.
"""

import itertools
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
        parts_of_it, result = re.fullmatch(r"(\w+(?: \| \w+)+) -> (\w+)", meeting).groups()
        meetings[tuple(parts_of_it.split(" | "))] = result
    every_part = [part for parts_of_it in meetings for part in parts_of_it]
    if len(set(every_part)) != len(every_part):
        sys.exit("a part of two actions")
    initial = tuple((allow[3] or allow[4]).split(" || "))
    for summands in processes.values():
        if any(target not in processes for _, _, target in summands):
            sys.exit("an unknown process")
    return processes, set(filter(None, allow[1].split(", "))), meetings, initial


def successors(state, processes, allowed, meetings):
    offers = {}
    for at, process in enumerate(state):
        for action, argument, target in processes[process]:
            offers.setdefault(action, []).append((at, argument, target))
            if action in allowed:
                yield action, argument, state[:at] + (target,) + state[at + 1:]
    for parts, result in meetings.items():
        if result not in allowed or any(part not in offers for part in parts):
            continue
        for chosen in itertools.product(*(offers[part] for part in parts)):
            argument = chosen[0][1]
            if len({at for at, _, _ in chosen}) < len(chosen):
                continue
            if any(other != argument for _, other, _ in chosen):
                continue
            following = list(state)
            for at, _, target in chosen:
                following[at] = target
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
