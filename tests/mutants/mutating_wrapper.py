#!/usr/bin/env python3
"""A wrapper that stands before another one and makes a mutant of its system.

    mutating_wrapper.py KIND TRIGGER MODEL PROGRAM [ARGS]

The inputs that Maide gives are passed on to PROGRAM, a wrapper of a real middleware, but for the
place where TRIGGER says that the mistake happens. There KIND happens:

  lose-write   the write returns, and its message is lost
  lose-read    one message more is taken out before the read, and nobody sees it
  twice-write  the message is written twice
  twice-read   the read gives the message and leaves it where it is
  later        the write takes effect behind the input that follows it
  block        the write never returns

TRIGGER is `nth:N` (the N-th such input of a word), `kept:K` (whenever K messages are kept), or
`after:INPUT,...` (whenever the inputs before are these). Inputs that are refused do not count. What the real system does with the changed
word is asked of the real system. Where it stands, as far as the trigger wants to know, is read off
MODEL, an interface automaton of that system (DOT). `predict()` does all of it with the model alone.
"""
import json
import re
import subprocess
import sys
import threading

EDGE = re.compile(r'^\s*(\w+) -> (\w+)(?: \[label="([?!])([^"]*)".*\])?;')


class Model:
    """An interface automaton, played as a Mealy machine: an input and all outputs behind it."""

    def __init__(self, path):
        self.inputs, self.outputs, self.unexplored, self.actor = {}, {}, {}, {}
        self.order = []
        for line in open(path, encoding="utf-8"):
            actors = re.match(r'\s*actors="(.*)";', line)
            if actors:
                for part in actors[1].split(";"):
                    name, actions = part.split(":")
                    for action in actions.split():
                        self.actor[action] = name.strip()
                        self.order.append(action)
            marked = re.match(r'\s*(\w+) \[.*unexplored="([^"]*)"', line)
            if marked:
                self.unexplored[marked[1]] = set(marked[2].split(","))
            edge = EDGE.match(line)
            if not edge:
                continue
            if edge[3] is None:
                self.initial = edge[2]
            elif edge[3] == "?":
                self.inputs.setdefault(edge[1], {})[edge[4]] = edge[2]
            else:
                self.outputs.setdefault(edge[1], {})[edge[4]] = edge[2]

    def step(self, state, name):
        """(status, events, next state)."""
        target = self.inputs.get(state, {}).get(name)
        if target is None:
            known = name in self.unexplored.get(state, ())
            return ("unexplored" if known else "refused"), [], state
        events = []
        while target in self.outputs:
            event = min(self.outputs[target], key=lambda output: self.order.index("!" + output))
            events.append([self.actor["!" + event], event])
            target = self.outputs[target][event]
        return "taken", events, target


def is_message(event):
    return event[1] in ("message", "next", "gap") or event[1].startswith("message(")


class Mutant:
    """Plans how a word is passed on: for each input the place of what is passed on for it, the
    places of what is passed on besides, and what is answered without asking."""

    def __init__(self, kind, trigger, model, observes_written):
        self.kind, self.model, self.observes_written = kind, model, observes_written
        what, _, self.value = trigger.partition(":")
        self.what = what
        self.side = "read" if kind.endswith("read") else "write"

    def happens(self, name, taken, count, kept):
        if name != self.side:
            return False
        if self.what == "nth":
            return count == int(self.value)
        if self.what == "kept":
            return kept == int(self.value)
        before = self.value.split(",")
        return taken[-len(before):] == before

    def plan(self, word):
        passed, steps = [], []
        state, kept, count = self.model.initial, 0, 0
        late = blocked = False
        taken = []  # a refused input reaches no system, so none can remember it
        writer = self.model.actor.get("?write", "writer")

        def give(name):
            nonlocal state, kept
            status, events, state = self.model.step(state, name)
            passed.append(name)
            if status == "taken" and name == "write":
                kept += 1
            kept -= sum(is_message(event) for event in events)
            kept = max(kept, 0)
            return len(passed) - 1

        for name in word:
            can = self.model.step(state, name)[0] == "taken"
            count += can and name == self.side
            now = can and not blocked and self.happens(name, taken, count, kept)
            own = {"main": None, "more": [], "events": [], "status": None}
            returns = [[writer, "written"]] if self.observes_written else []
            if blocked and self.model.actor.get("?" + name) == writer:
                own["status"] = "refused"
                can = False
            elif now and self.kind == "lose-write":
                own["events"] = returns
            elif now and self.kind == "twice-read" and kept > 0:
                # As the read would answer, and the message stays.
                own["events"] = self.model.step(state, name)[1]
            elif now and self.kind == "block":
                blocked = True
            elif now and self.kind == "later" and not late:
                own["events"] = returns
                late = True
                taken.append(name)
                steps.append(own)
                continue
            else:
                if now and self.kind == "lose-read" and kept > 1:
                    give(name)
                own["main"] = give(name)
                if now and self.kind == "twice-write":
                    own["more"].append(give(name))
            if late and can and own["status"] is None:
                late = False
                own["more"].append(give("write"))
            if can:
                taken.append(name)
            own["blocked"] = [writer] if blocked else []
            steps.append(own)
        return passed, steps

    def answer(self, steps, given):
        """The steps of an answer, made of those that the real system gave."""
        result, waiting = [], []  # the actors that are in a call of the real system
        for own in steps:
            main = [given[i] for i in [own["main"]] if i is not None and i < len(given)]
            more = [given[i] for i in own["more"] if i < len(given)]  # nobody sees these return
            events = own["events"] + [event for step in main for event in step["events"]]
            events += [event for step in more for event in step["events"] if event[1] != "written"]
            step = {"events": events, "us": sum(one.get("us", 0) for one in main + more)}
            for one in (main + more)[-1:]:
                waiting = one.get("busy", [])
            step["busy"] = sorted(set(waiting + own.get("blocked", [])))
            status = own["status"] or next(
                (one["status"] for one in main if one.get("status")), None)
            if status:
                step["status"] = status
            result.append(step)
        return result

    def predict(self, word):
        """What the mutant answers, by the model alone: for each input its status and events."""
        passed, steps = self.plan(word)
        given, state = [], self.model.initial
        for name in passed:
            status, events, state = self.model.step(state, name)
            given.append({"events": events, **({} if status == "taken" else {"status": status})})
        return [(step.get("status", "taken"), sorted(event[1] for event in step["events"]))
                for step in self.answer(steps, given)]


def main():
    kind, trigger, path, *command = sys.argv[1:]
    system = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    model = Model(path)
    mutant = Mutant(kind, trigger, model, "!written" in model.actor)
    plans = {}

    def pass_on():
        for line in sys.stdin:
            message = json.loads(line)
            if message["type"] == "run":
                message["word"], plan = mutant.plan(message["word"])
                plans[message["id"]] = plan
            system.stdin.write(json.dumps(message) + "\n")
            system.stdin.flush()
        system.stdin.close()

    threading.Thread(target=pass_on, daemon=True).start()
    for line in system.stdout:
        message = json.loads(line)
        if message["type"] == "hello":
            message["features"] = []  # words alone
            message["versions"]["mutant"] = kind + " " + trigger
        elif message["type"] == "answer":
            message["steps"] = mutant.answer(plans.pop(message["id"]), message["steps"])
        print(json.dumps(message), flush=True)
    return system.wait()


if __name__ == "__main__":
    sys.exit(main())
