#!/usr/bin/env python3
"""What messages on their way cost: each system with everything at once, and with wires.

    benchmarks/deliveries.py [--maide MAIDE] [--time SECONDS] FILE|FOLDER ...

Prints Markdown. Each property of each system file is checked by itself (`--property`): in a copy
that says `delivery: at_once` everywhere, and as the file is, with no reduction, `order` and `full`. A
row says the states and the seconds of all its properties. Systems in which nothing is late have one
sentence together. The folders are copied first, so nothing is written into them.

Exit status 1: a system in which nothing is late has other states than at once; a property has
another verdict with a reduction; one that is decided at once is not decided with wires; or
nothing was compared. A file with `learn:` for which a middleware is missing is left out, and said.
"""

from __future__ import annotations

import argparse
import copy
import json
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import yaml

LATE = "arrives some time later"  # how an assumption of a verdict says so
BUILT_IN = ["deadlock", "stuck"]
SECTIONS = {"topics", "services", "models"}


@dataclass
class Run:
    """One property, checked in one way."""

    verdict: str
    states: int
    seconds: float
    assumptions: list[str]


@dataclass
class Row:
    """One system: by way of checking, a run of each property."""

    name: str
    runs: dict[str, dict[str, Run]] = field(default_factory=dict)

    def states(self, way: str) -> int:
        """Of all properties."""
        return sum(run.states for run in self.runs[way].values())

    def seconds(self, way: str) -> float:
        """Of all properties."""
        return sum(run.seconds for run in self.runs[way].values())

    def is_late(self) -> bool:
        """Whether some verdict rests on messages that come later."""
        return any(LATE in line for run in self.runs["none"].values() for line in run.assumptions)

    def changes(self) -> list[str]:
        """The properties whose verdict is not that of at once."""
        return [
            f"`{name}` {before.verdict} -> {self.runs['none'][name].verdict}"
            for name, before in self.runs["at_once"].items()
            if before.verdict != self.runs["none"][name].verdict
        ]

    def mistakes(self) -> list[str]:
        """What must not be."""
        found = []
        for name, before in self.runs["at_once"].items():
            after = self.runs["none"][name]
            for way in ("order", "full"):
                other = self.runs[way][name]
                if "inconclusive" not in (other.verdict, after.verdict) and (
                    other.verdict != after.verdict
                ):
                    found.append(f"{name}: {after.verdict}, with {way} {other.verdict}")
            if before.verdict != "inconclusive" and after.verdict == "inconclusive":
                found.append(f"{name}: {before.verdict} at once, and not decided with wires")
            if not self.is_late() and (before.verdict, before.states) != (
                after.verdict,
                after.states,
            ):
                found.append(
                    f"{name}: nothing is late, {before.states} states at once, {after.states}"
                )
        return found


WAYS = {"at_once": "none", "none": "none", "order": "order", "full": "full"}


class Checker:
    """Checks systems with one Maide."""

    def __init__(self, maide: str, seconds: float) -> None:
        self.maide = maide
        self.limit = seconds

    def ask(self, path: Path, *options: str) -> dict | str:
        """Its answer, or why there is none."""
        done = subprocess.run(
            [self.maide, "check", str(path), "--json", "--time", f"{self.limit:g}", *options],
            capture_output=True, text=True, check=False, cwd=path.parent,
        )  # fmt: skip
        if not done.stdout.strip():
            return done.stderr.strip().split("\n")[0] or f"exit status {done.returncode}"
        answer = json.loads(done.stdout)
        if "properties" in answer:
            return answer
        error = answer.get("error", answer)
        return str(error.get("message", error) if isinstance(error, dict) else error)

    def run(self, path: Path, name: str, reduction: str) -> Run | str:
        """One property; of several instances, the worst of them."""
        answer = self.ask(path, "--property", name, "--reduction", reduction)
        if isinstance(answer, str):
            return answer
        found = [
            one for one in answer["properties"] if one["name"] == name or
            one["name"].startswith(f"{name}[")
        ]  # fmt: skip
        if not found:
            return f"no answer on {name}"
        order = ["holds", "inconclusive", "violated"]
        return Run(
            max((one["verdict"] for one in found), key=order.index),
            sum(one["states"] for one in found),
            sum(one["seconds"] for one in found),
            answer["assumptions"],
        )

    def row(self, name: str, path: Path) -> Row | str:
        """All properties of a system, in all ways; or why not."""
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
        at_once = path.parent / f"at-once-{path.name}"
        at_once.write_text(
            yaml.safe_dump(with_delivery(document), sort_keys=False, width=1000), encoding="utf-8"
        )
        row = Row(name)
        for way, reduction in WAYS.items():
            row.runs[way] = {}
            for name_of in [*BUILT_IN, *(document.get("properties") or {})]:
                base = name_of.split("[")[0]
                found = self.run(at_once if way == "at_once" else path, base, reduction)
                if isinstance(found, str):
                    return found
                row.runs[way][base] = found
        return row


def with_delivery(document: dict) -> dict:
    """The system with everything at once."""
    document = copy.deepcopy(document)
    for section in SECTIONS & document.keys():
        for entry in (document[section] or {}).values():
            if entry.get("use") not in ("mutex", "semaphore"):
                entry["delivery"] = "at_once"
                entry.pop("loses", None)
                entry.pop("stream", None)
    return document


def files_in(sources: list[Path], scratch: Path) -> list[tuple[str, Path]]:
    """The system files among copies of the sources, with a name for each."""
    found = []
    for number, source in enumerate(sources):
        root = source if source.is_dir() else source.parent
        own = scratch / str(number) / root.name
        shutil.copytree(root, own, ignore=shutil.ignore_patterns("maide-models", "build"))
        paths = sorted(own.rglob("*.yaml")) if source.is_dir() else [own / source.name]
        for path in paths:
            document = yaml.safe_load(path.read_text(encoding="utf-8"))
            if isinstance(document, dict) and {"programs", "nodes"} & document.keys():
                found.append((str(Path(root.name) / path.relative_to(own)), path))
    return found


def number(value: int) -> str:
    """1234567 as "1,234,567"."""
    return f"{value:,}"


def main() -> int:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maide", default="build/release/bin/maide")
    parser.add_argument("--time", type=float, default=600, help="seconds for each property")
    parser.add_argument("sources", nargs="+", type=Path)
    options = parser.parse_args()
    checker = Checker(str(Path(options.maide).resolve()), options.time)
    rows: list[Row] = []
    left_out: list[str] = []
    with tempfile.TemporaryDirectory() as scratch:
        for name, path in files_in([s.resolve() for s in options.sources], Path(scratch)):
            row = checker.row(name, path)
            if isinstance(row, str):
                missing = re.search(r"unknown system '(\w+)'", row)
                left_out.append(f"{name} ({missing.group(1) if missing else row})")
                print(f"left out: {left_out[-1]}", file=sys.stderr, flush=True)
                continue
            rows.append(row)
            print(f"{name}: {[row.states(way) for way in WAYS]}", file=sys.stderr, flush=True)
    print("| system | verdicts that change | states: at once | wires | `order` | `full` "
          "| seconds: at once | wires | `order` | `full` |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|---|---|")
    for row in rows:
        if not row.is_late():
            continue
        cells = [row.name, ", ".join(row.changes()) or "none"]
        cells += [number(row.states(way)) for way in WAYS]
        cells += [f"{row.seconds(way):.2f}" for way in WAYS]
        print("| " + " | ".join(cells) + " |")
    calm = [row for row in rows if not row.is_late()]
    wrong = [f"{row.name}: {mistake}" for row in rows for mistake in row.mistakes()]
    undecided = [
        f"{row.name} (`{name}`)"
        for row in rows
        for name, run in row.runs["none"].items()
        if run.verdict == "inconclusive"
    ]
    print(f"\nIn {len(calm)} more systems nothing is late: verdicts and states of every property are "
          f"those of at once, {number(sum(row.states('none') for row in calm))} states in all."
          if not any(row.mistakes() for row in calm) else "\nSystems with nothing late differ.")
    print(f"\nInconclusive at once and with wires: {len(undecided)}.\n")
    for name in undecided:
        print(f"- {name}")
    print(f"\nLeft out, for what they need is not here: {len(left_out)}.\n")
    for name in left_out:
        print(f"- {name}")
    for mistake in wrong:
        print(f"WRONG: {mistake}")
    return 1 if wrong or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
