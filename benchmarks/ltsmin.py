#!/usr/bin/env python3
"""LTSmin's backends, SPIN and Maide side by side: every state of the same systems, without reduction.

    benchmarks/ltsmin.py [--maide MAIDE] [--limit SECONDS] SYSTEM.yaml ...

Each explores what `maide export` writes, one after the other, with tables that fit. A row says how
many states were counted, the processor time of all processes and the time by the clock, states a
second of processor time, and the peak of resident memory of the largest process, in all and by
state. Compiling is free. Fails if counts differ. A system must be one component without errors and
deaths, whose deadlock holds. Needs LTSmin on PATH; what else is missing is left out.
"""
import argparse
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time


class Run:
    """One command, run to its end: its output and what it cost."""

    def __init__(self, command, folder, limit):
        started = time.monotonic()
        with tempfile.TemporaryFile(mode="w+") as output:
            process = subprocess.Popen(command, cwd=folder, stdout=output,
                                       stderr=subprocess.STDOUT, start_new_session=True)
            watch = threading.Timer(limit, os.killpg, (process.pid, signal.SIGKILL))
            watch.start()
            _, self.status, usage = os.wait4(process.pid, 0)
            watch.cancel()
            process.returncode = self.status
            output.seek(0)
            self.text = output.read()
        self.clock = time.monotonic() - started
        self.seconds = usage.ru_utime + usage.ru_stime
        self.bytes = usage.ru_maxrss * 1024


def make(command, folder):
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)


def commands_for(states, cores):
    """A name and a command for each that is there."""
    bits = max(16, math.ceil(math.log2(states * 1.5)))
    for count in sorted({1, cores}):
        name = "pins2lts-mc, 1 core" if count == 1 else f"pins2lts-mc, {count} cores"
        yield name, ["pins2lts-mc", "--strategy=bfs", f"--procs={count}", f"-s{bits}",
                     "./system.so"]
    yield "pins2lts-seq", ["pins2lts-seq", "--strategy=bfs", "./system.so"]
    yield "pins2lts-dist, 2 ranks", ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2",
                                     "pins2lts-dist", "./system.so"]
    if shutil.which("pins2lts-sym"):
        # Without Sylvan it has one core and no such option.
        known = subprocess.run(["pins2lts-sym", "--help"], capture_output=True, text=True).stdout
        workers = ["--lace-workers=1"] if "lace-workers" in known else []
        yield "pins2lts-sym, 1 core", ["pins2lts-sym", *workers, "./system.so"]
    yield "SPIN", ["./pan", "-n", "-E", "-A", f"-m{max(10_000_000, 2 * states)}",
                   f"-w{bits}"]


def count(name, text):
    if name == "SPIN":
        found = re.search(r"([0-9.e+]+) states, stored", text)
        # One more: before the processes are started, in the form with channels.
        return round(float(found[1])) if found else None
    found = re.findall(r"(?:Explored|state space(?: has)?)(?: \d+ levels,?)? (\d+) states", text)
    return int(found[-1]) if found and "table full" not in text else None


def print_row(name, found, run):
    if found is None:
        last = (run.text.strip().splitlines() or ["nothing"])[-1]
        print(f"| {name} | not done in {run.clock:.0f} s; it said last: {last} | | | | | |",
              flush=True)
        return
    print(f"| {name} | {found:,} | {run.seconds:.2f} | {run.clock:.2f} | "
          f"{found / max(run.seconds, 0.01):,.0f} | {run.bytes / 1e6:.0f} | "
          f"{run.bytes / found:.1f} |", flush=True)


def explore(system, arguments):
    """Prints the rows of one system; whether all counts are the same."""
    with tempfile.TemporaryDirectory() as folder:
        base = Run([arguments.maide, "check", os.path.abspath(system), "--property", "deadlock",
                    "--json"], folder, arguments.limit)
        result = json.loads(base.text)["properties"][0]
        states = result["states"]
        print(f"\n| {os.path.basename(system)} | states | CPU s | clock s | states a CPU s | MB | "
              "bytes a state |\n|---|---|---|---|---|---|---|")
        print_row("Maide", states, base)
        same = True
        for form, name in (("pins", "system.cpp"), ("promela", "system.pml")):
            make([arguments.maide, "export", os.path.abspath(system), "--to", form, "-o", name],
                 folder)
        make(["c++", "-std=c++17", "-O2", "-shared", "-fPIC", "-o", "system.so", "system.cpp"],
             folder)
        if shutil.which("spin"):
            make(["spin", "-a", "system.pml"], folder)
            make(["cc", "-O2", "-w", "-DSAFETY", "-DNOREDUCE", "-DMEMLIM=100000", "-o", "pan",
                  "pan.c"], folder)
        for name, command in commands_for(states, arguments.cores):
            if name == "SPIN" and not shutil.which("spin"):
                continue
            if any(not shutil.which(word) for word in command
                   if word in ("mpirun", "pins2lts-dist")):
                continue
            run = Run(command, folder, arguments.limit)
            found = count(name, run.text)
            print_row(name, found, run)
            if found is not None:
                same = same and found - states in ((0, 1) if name == "SPIN" else (0,))
    return same


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("systems", nargs="+", metavar="SYSTEM.yaml")
    parser.add_argument("--maide", default="build/release/bin/maide")
    parser.add_argument("--cores", type=int, default=os.cpu_count())
    parser.add_argument("--limit", type=float, default=600, help="seconds for one run")
    arguments = parser.parse_args()
    arguments.maide = os.path.abspath(arguments.maide)
    if not shutil.which("pins2lts-mc"):
        sys.exit("skipped: no LTSmin")
    if not all([explore(system, arguments) for system in arguments.systems]):
        sys.exit("the counts differ")


if __name__ == "__main__":
    main()
