#!/usr/bin/env python3
"""Gives a system what no system file can say: a wire, its arrival, which is nobody's, and origins of statements.

    maide view --stage system FILE | add_nobody.py >DUMP

The file has a queue `wire`, whose message comes into the queue `box` by itself, and a program first that was made
from lines 7 and 8 of node.cpp.
"""
import json
import sys

WIRE = 5  # ModelInstance::Source
GIVE = 0  # ModelUse::Kind


def hash_text(text):
    value = 14695981039346656037
    for byte in text.encode():
        value = (value ^ byte) * 1099511628211 % 2**64
    return f"{value:016x}"


dump = json.load(sys.stdin)
system = dump["system"]
numbers = {model["name"]: number for number, model in enumerate(system["models"])}
wire = system["models"][numbers["wire"]]
wire["source"] = WIRE
wire["state_texts"] = ["" if state == wire["automaton"]["initial"] else "an image"
                       for state in range(len(wire["automaton"]["states"]))]
uses = [[GIVE, numbers[name], system["models"][numbers[name]]["automaton"]["inputs"].index(action)]
        for name, action in (("wire", "read"), ("box", "write"))]
system["nobodys_groups"] = ["", "an image arrives"]
system["nobodys_actions"] = [{
    "what": {"role": 0, "uses": uses, "events": uses, "text": "an image arrives", "fair": 1, "callback": None,
             "awaits_anybody": False},
    "counts_for_deadlock": True, "is_shown": True, "lost": "the image before", "origin": None,
    "position": {"file": system["file"], "line": 1, "column": 1}}]
program = system["programs"][0]
program["origins"] = [{"file": "", "line": 0, "column": 0}, {"file": "node.cpp", "line": 7, "column": 5},
                      {"file": "node.cpp", "line": 8, "column": 0}]
for number, edge in enumerate(program["edges"]):
    edge[6] = 1 + number % 2
del dump["sum"]
dump["sum"] = hash_text(json.dumps(dump, sort_keys=True, separators=(",", ":"), ensure_ascii=False))
json.dump(dump, sys.stdout)
