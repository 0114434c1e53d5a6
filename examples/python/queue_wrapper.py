#!/usr/bin/env python3
"""A wrapper without Maide's library: a bounded queue.Queue of Python, learned over its protocol.

    maide learn 'exec:python3 queue_wrapper.py' size=3

The protocol is one JSON object a line; docs/protocol.md describes it. Calls that never block need no
threads: `put` says ok or full, `get` says item or empty.
"""
import json
import platform
import queue
import sys

INPUTS = {"put": ["ok", "full"], "get": ["item", "empty"]}


def send(**message):
    print(json.dumps(message), flush=True)


def give(system, name):
    """Makes one real call; what it did is the output."""
    try:
        if name == "put":
            system.put_nowait("a message")
            return "ok"
        system.get_nowait()
        return "item"
    except queue.Full:
        return "full"
    except queue.Empty:
        return "empty"


send(type="hello", protocol=1, name="queue", versions={"python": platform.python_version()},
     options=[{"key": "size", "kind": "integer", "default": "2", "least": 1, "most": 100,
               "help": "how many messages the queue holds"}])
size = 2
for line in sys.stdin:
    message = json.loads(line)
    if message["type"] == "configure":
        size = message["options"].get("size", "2")  # checked against the hello
        send(type="info", inputs=list(INPUTS), outputs=sum(INPUTS.values(), []),
             options={"size": size})
    elif message["type"] == "run":
        system = queue.Queue(maxsize=int(size))
        send(type="answer", id=message["id"],
             steps=[{"events": [give(system, name)]} for name in message["word"]])
    elif message["type"] == "bye":
        break
