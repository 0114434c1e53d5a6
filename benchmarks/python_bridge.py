#!/usr/bin/env python3
"""What it costs to learn an object of Python's instead of a machine in C++.

    PYTHONPATH=build/release/python benchmarks/python_bridge.py MODEL.dot [--eq METHOD] [--rounds N]

The machine is learned three times over with the same words: simulated in C++ ("sim:MODEL.dot"), as
an object of Python's that looks each step up in a dictionary, and that object is stepped by Python
alone through as many symbols. What the second costs beyond the other two is the bridge. Times are
of the processor, in seconds, the least of the rounds.
"""
import argparse
import time

import maide


class Machine:
    """A Mealy machine as a table: about the cheapest step() that there is."""

    def __init__(self, model):
        self.inputs = model.inputs
        self.initial = model.initial
        self.table = {}
        for source, given, output, target in model.transitions:
            self.table.setdefault(source, {})[given] = (output, target)
        self.symbols = self.resets = 0

    def reset(self):
        self.state = self.initial
        self.resets += 1

    def step(self, given):
        self.symbols += 1
        output, self.state = self.table[self.state][given]
        return output


def cpu_of(work):
    start = time.process_time()
    result = work()
    return time.process_time() - start, result


def step_alone(machine, symbols, resets):
    """The object's own work: the calls that the bridge makes, by Python."""
    word = (machine.inputs * (symbols // max(resets, 1) // len(machine.inputs) + 1))
    length = max(symbols // max(resets, 1), 1)
    for _ in range(max(resets, 1)):
        machine.reset()
        for given in word[:length]:
            machine.step(given)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model")
    parser.add_argument("--eq", default="perfect")
    parser.add_argument("--algorithm", default="lsharp")
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    model = maide.Model.read(arguments.model).to_mealy()
    options = {"algorithm": arguments.algorithm, "eq": arguments.eq, "confirm": "no"}
    cpp, python, alone = [], [], []
    for _ in range(arguments.rounds):
        seconds, learned = cpu_of(lambda: maide.learn("sim:" + arguments.model, **options))
        cpp.append(seconds)
        machine = Machine(model)
        seconds, other = cpu_of(lambda: maide.learn(machine, reference=model, **options))
        python.append(seconds)
        assert len(other.model) == len(learned.model) == len(model), "another machine was learned"
        assert (other.words, other.symbols) == (learned.words, learned.symbols), "by other words"
        seconds, _ = cpu_of(lambda: step_alone(Machine(model), other.symbols, other.words))
        alone.append(seconds)
    bridge = min(python) - min(cpp) - min(alone)
    print(f"{arguments.model}: {len(model)} states, {other.words} words, {other.symbols} symbols"
          f" ({arguments.algorithm}, {arguments.eq})")
    print(f"  in C++               {min(cpp):8.3f} s")
    print(f"  a Python object      {min(python):8.3f} s")
    print(f"  its step() alone     {min(alone):8.3f} s")
    for name, seconds in (("all but step()", min(python) - min(alone)), ("the bridge", bridge)):
        print(f"  {name:<20} {seconds:8.3f} s, {1e6 * seconds / max(other.symbols, 1):.2f} us a symbol")


if __name__ == "__main__":
    main()
