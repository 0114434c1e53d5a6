"""Random systems in which something is late: SPIN and LTSmin decide what Maide exports of them.

    exports.py --maide PATH [--seed S --count N --least K] [--engines spin ltsmin] [--keep FOLDER]

Takes systems of the kind `wires` until N have something on its way and at most MOST_STATES, and more
of them until K have each of TRAITS. Each engine must come to the verdicts of Maide's own search without a reduction on
all properties for which it has words. Where no violation ends a search, it must count the same
states of each component. An engine that is not installed is left out, which is said. Exit status 1:
something differs; 77: no engine is there.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import yaml

from compare import WORDS, Comparison, atom_of, is_at_once, words_of, write
from generate import generate
from language import Refused
from referee import judge
from system import System

PROGRAMS = {"spin": ["spin", "cc"], "ltsmin": ["pins2lts-mc", "ltsmin-printtrace", "c++"]}
NO_WORDS = {name: f"the engine {name}" for name in PROGRAMS}  # how such a refusal is told
MOST_STATES = 5000  # of a system that is compared
COUNT = "counted"  # a property that always holds, so that a search visits all states


def traits_of(path: Path) -> set[str]:
    """What is in a system that its export has to say."""
    text = path.read_text(encoding="utf-8")
    system = System(str(path))
    wires = [wire for use in system.uses for wire in getattr(use, "wires", [])]
    found = {
        "deaths": "may_die: true" in text,
        "losses": any(wire.loses for wire in wires),
        "services": "services" in system.document,
        "values": "message(x)" in text,
        "streams": any(len(members) > 1 for members in system.stream_members),
        "nodes": "nodes" in system.document,
        "two writers": any(
            len({wire.entry for wire in wires if wire.box == box}) > 1
            for use in system.uses
            for wires in [getattr(use, "wires", [])]
            for box in {wire.box for wire in wires}
        ),
        "strict queues": "{size: " in text,
        "looks": "tryread" in text or "otherwise" in text,
    }
    return {name for name, is_there in found.items() if is_there}


TRAITS = ["deaths", "losses", "services", "values", "streams", "nodes", "two writers",
          "strict queues", "looks"]  # fmt: skip


class Exports(Comparison):
    """Compares the engines of one Maide with its own search."""

    def __init__(self, maide: str, engines: list[str]) -> None:
        super().__init__(maide, 0, False, [])
        self.engines = engines
        self.verdicts_of = dict.fromkeys(engines, 0)
        self.violated_of = dict.fromkeys(engines, 0)
        self.counts_of = dict.fromkeys(engines, 0)
        self.wordless_of = dict.fromkeys(engines, 0)
        self.states_of = dict.fromkeys(engines, 0)

    @staticmethod
    def of_property(answer: dict, name: str) -> tuple[str, int, str]:
        """The verdict, the states and the reason; of the instances of a `forall` together."""
        entries = [
            entry
            for entry in answer["properties"]
            if entry["name"].split("[")[0].split(" ")[0] == name
        ]
        order = ["holds", "inconclusive", "violated"]
        return (
            max((entry["verdict"] for entry in entries), key=order.index),
            sum(entry["states"] for entry in entries),
            " ".join(entry.get("reason", "") for entry in entries),
        )

    def differences(self, path: Path) -> list[tuple[str, str]]:
        """(kind, sentence) of each difference."""
        own = self.ask(path)
        if "error" in own or "broken" in own:
            return [("broken", f"Maide: {own.get('error') or own.get('broken')}")]
        found = []
        for engine in self.engines:
            for name in self.verdicts(own):
                found += self.differences_on(path, engine, own, name)
        if "ltsmin" in self.engines and self.of_property(own, "deadlock")[0] == "violated":
            found += self.whole_differences(path, own)
        return found

    def differences_on(
        self, path: Path, engine: str, own: dict, name: str
    ) -> list[tuple[str, str]]:
        """What an engine says otherwise of one property, or counts otherwise. SPIN counts the
        states of the system where it looks for a deadlock, and LTSmin wherever nothing ends the
        search."""
        theirs = self.ask(path, "--engine", engine, "--property", name)
        if "error" in theirs and NO_WORDS[engine] in theirs["error"]:
            self.wordless_of[engine] += 1
            return []
        if "error" in theirs or "broken" in theirs:
            why = theirs.get("error") or theirs.get("broken")
            return [(f"broken {engine}", f"{engine}, {name}: {why}")]
        verdict, states, _ = self.of_property(own, name)
        other, counted, reason = self.of_property(theirs, name)
        self.verdicts_of[engine] += 1
        self.violated_of[engine] += other == "violated"
        if other != verdict:
            why = f"{name}: Maide {verdict}, {engine} {other} {reason}"
            return [(f"verdict {engine} {verdict} {other}", why)]
        if verdict == "violated" or engine == "spin" and name != "deadlock":
            return []
        self.counts_of[engine] += 1
        self.states_of[engine] += counted
        if counted == states:
            return []
        return [(f"states {engine}", f"{name}: Maide {states} states, {engine} {counted}")]

    def whole_differences(self, path: Path, own: dict) -> list[tuple[str, str]]:
        """Differences in the states of each component, by a property that always holds."""
        document: Any = yaml.safe_load(path.read_text(encoding="utf-8"))
        atoms = [atom_of(document, component["programs"]) for component in own["components"]]
        document["properties"] = {
            f"{COUNT}{number}": {"always": f"!({atom}) || {atom}"}
            for number, atom in enumerate(atoms)
            if atom is not None
        }
        trial = path.parent / "count.yaml"
        write(document, trial)
        mine = self.ask(trial)
        found = []
        for name in document["properties"]:
            found += self.differences_on(trial, "ltsmin", mine, name)
        trial.unlink()
        return found


def choose(
    seed: int, count: int, least: int, without: set[str], folder: Path
) -> list[tuple[Path, set[str]]]:
    """Systems in which something is late, with what is in them."""
    chosen: list[tuple[Path, set[str]]] = []
    number = 0
    while True:
        having = Counter(trait for _, traits in chosen for trait in traits)
        lacking = {trait for trait in TRAITS if having[trait] < least}
        if len(chosen) >= count and not lacking:
            return chosen
        path = generate("wires", seed, number, folder)
        number += 1
        try:
            if is_at_once(path) or words_of(path) & without:
                continue
        except Refused:
            continue
        traits = traits_of(path)
        is_wanted = len(chosen) < count or traits & lacking
        if is_wanted and "components" in judge(str(path), MOST_STATES):
            chosen.append((path, traits))


def main() -> int:
    """Compares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maide", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--least", type=int, default=3, help="systems with each trait")
    parser.add_argument("--engines", nargs="*", choices=PROGRAMS, default=list(PROGRAMS))
    parser.add_argument("--without", nargs="*", default=[], choices=WORDS, help="not those systems")
    parser.add_argument("--keep", type=Path, default=Path("differences"))
    options = parser.parse_args()
    engines = []
    for engine in options.engines:
        missing = [name for name in PROGRAMS[engine] if shutil.which(name) is None]
        if missing:
            print(f"{engine} is left out: no {missing[0]}")
        else:
            engines.append(engine)
    if not engines:
        print("nothing compared")
        return 77
    comparison = Exports(options.maide, engines)
    differing = 0
    with tempfile.TemporaryDirectory() as folder:
        chosen = choose(
            options.seed, options.count, options.least, set(options.without), Path(folder)
        )
        for path, _ in chosen:
            found = comparison.differences(path)
            if not found:
                continue
            differing += 1
            name = path.parent.name
            for _, why in found:
                print(f"{name}: {why}", flush=True)
            shutil.copytree(path.parent, options.keep / name, dirs_exist_ok=True)
            text = "\n".join(why for _, why in found)
            (options.keep / name / "why.txt").write_text(text + "\n", encoding="utf-8")
    having = Counter(trait for _, traits in chosen for trait in traits)
    print(f"{len(chosen)} systems with something late compared, {differing} differ")
    print("of them with " + ", ".join(f"{trait} {having[trait]}" for trait in TRAITS))
    for engine in engines:
        print(
            f"{engine}: {comparison.verdicts_of[engine]} verdicts, "
            f"{comparison.violated_of[engine]} of them violated, the states of "
            f"{comparison.counts_of[engine]} searches, {comparison.states_of[engine]} in all; no "
            f"words for {comparison.wordless_of[engine]} properties"
        )
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
