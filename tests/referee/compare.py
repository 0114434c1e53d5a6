"""Compares Maide with the referee, and shrinks the systems on which they differ.

    compare.py --maide PATH [--seed S --count N --only KIND ...] [--spin] [--keep FOLDER] [FILES ...]

Components, their counts (without reductions) and all verdicts (with each reduction) are compared.
With --spin, so are SPIN's counts and verdicts on what Maide exports, wherever SPIN has the words. A
system on which the two differ is kept, as it was made and shrunk, with what differs in `why.txt`.
Exit status 1: some differ.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

import yaml

from deliveries import ACKNOWLEDGED
from generate import AHEAD, KINDS, generate
from language import Refused
from referee import judge
from system import System
from wires import Boxes

WORDS = ["acknowledged", "arrived", "defaults", "disconnect", "returns", "stream"]
REDUCTIONS = ["none", "calls", "order", "full"]


class Comparison:
    """Compares one Maide with the referee."""

    def __init__(
        self, maide: str, max_states: int, old: bool, skip: list[str], spin: bool = False
    ) -> None:
        self.maide = maide
        self.spin = spin
        self.told = {"verdicts": 0, "components": 0, "wordless": 0}  # by SPIN, or not
        self.max_states = max_states
        self.old = old  # a Maide that knows no components
        self.skip = set(skip)
        # Of systems with wires: states at once, of Maide, with wires everywhere.
        self.sizes: list[tuple[int, int, int]] | None = None

    def ask(self, path: Path, *options: str) -> dict:
        """Maide's answer; {"error"} if it refuses the file or the property."""
        command = [self.maide, "check", str(path), "--json", *options]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=3600, check=False, cwd=path.parent
            )
        except subprocess.TimeoutExpired:
            return {"broken": "takes more than 600 s"}
        if done.returncode == 2:
            return {"error": done.stderr.strip()}
        try:
            answer = json.loads(done.stdout)
        except json.JSONDecodeError:
            return {"broken": f"exit {done.returncode}: {done.stderr.strip()[:500]}"}
        if done.returncode == 5 or "properties" not in answer:
            return {"broken": f"exit {done.returncode}: {done.stderr.strip()[:500]}"}
        return answer

    @staticmethod
    def verdicts(answer: dict) -> dict[str, str]:
        """The verdict on each property; the worst one on the instances of a `forall`."""
        order = ["holds", "inconclusive", "violated"]
        found: dict[str, str] = {}
        for entry in answer["properties"]:
            name = entry["name"].split("[")[0].split(" ")[0]
            found[name] = max(found.get(name, "holds"), entry["verdict"], key=order.index)
        return found

    @staticmethod
    def goes_round(answer: dict, name: str) -> bool:
        """Whether Maide did not look what code that may go round for ever keeps from starting."""
        return any(
            entry["name"] == name and "may go round for ever" in str(entry.get("reason"))
            for entry in answer["properties"]
        )

    def counts(self, path: Path, mine: dict) -> dict[tuple, tuple[int, int]]:
        """The states and transitions of each component; those of one without a violation are all.

        A search stops at a violation, so each component gets a property that always holds."""
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
        # A death is found out only where the file asks for it: such properties stay.
        own = document["properties"] = {
            name: text
            for name, text in (document.get("properties") or {}).items()
            if ".there" in str(text)
        }
        for number, component in enumerate(mine["components"]):
            atom = atom_of(document, component)
            if atom is not None:
                own[f"count{number}"] = {"always": f"!{atom} || {atom}"}
        trial = path.parent / "count.yaml"
        write(document, trial)
        answer = self.ask(trial, "--reduction", "none")
        trial.unlink()
        found = {}
        for entry in answer["properties"]:
            if re.fullmatch("count[0-9]+", entry["name"]):
                parts = tuple(mine["components"][int(entry["name"][5:])]["parts"])
                found[parts] = (entry["states"], entry["transitions"])
        return found

    def differences(self, path: Path) -> list[tuple[str, str]]:
        """(kind, sentence) of each difference; none also where the referee gives up."""
        at_once = is_at_once(path)
        is_counted = at_once and not has_lives(path)
        mine = judge(str(path), self.max_states)
        if "too_large" in mine:
            return []
        found = []
        for reduction in REDUCTIONS:
            theirs = self.ask(path, "--reduction", reduction)
            if "broken" in theirs:
                return [("broken", f"Maide, reduction {reduction}: {theirs['broken']}")]
            if "error" in mine or "error" in theirs:
                unbuilt = "not built" in theirs.get("error", "")
                if ("error" in mine) != ("error" in theirs) and not unbuilt:
                    why = mine.get("error") or theirs.get("error").replace("maide: ", "")
                    words = " ".join(w for w in why.split("\n")[0].split()[:6] if w.isalpha())
                    found.append(
                        (
                            f"refused {words}",
                            f"referee: {mine.get('error')}; Maide: {theirs.get('error')}",
                        )
                    )
                return found
            if reduction == "none" and self.sizes is not None and not at_once:
                self.note_sizes(path, mine, theirs)
            if reduction == "none" and is_counted:  # wires that change nothing may be left out
                found += self.count_differences(path, mine, theirs)
            verdicts = self.verdicts(theirs)
            for name, entry in mine["properties"].items():
                if name in self.skip or name not in verdicts:
                    continue
                if self.old and name == "deadlock" and len(mine["components"]) > 1:
                    continue
                # What Maide does not look for: it may not know it, or doubt it where who spins goes on.
                known = entry.get("unless_starved")
                doubts = known == "holds" and (
                    entry["verdict"] == "violated" or self.goes_round(theirs, name)
                )
                if verdicts[name] not in (entry["verdict"], known, doubts and "inconclusive"):
                    kind = name if name in ("deadlock", "stuck", "error") else "property"
                    found.append(
                        (
                            f"{kind} {entry['verdict']} {verdicts[name]} {reduction}",
                            f"{name}: referee {entry['verdict']}, Maide {verdicts[name]} "
                            f"(reduction {reduction})",
                        )
                    )
        return found + (self.spin_differences(path, mine) if self.spin else [])

    def note_sizes(self, path: Path, mine: dict, theirs: dict) -> None:
        """Notes how many states a system has, where Maide had to look at all of them."""
        at_once = judge(str(path), self.max_states, True)
        deadlock = [entry for entry in theirs["properties"] if entry["name"] == "deadlock"]
        if "components" not in at_once or deadlock[0]["verdict"] != "holds":
            return
        before, everywhere = (
            sum(component["states"] for component in report["components"])
            for report in (at_once, mine)
        )
        if before < everywhere:
            self.sizes.append((before, deadlock[0]["states"], everywhere))

    def told_sizes(self) -> str:
        """The median, nine of ten, and the worst of them."""
        lines = [f"states of {len(self.sizes)} systems with wires, at once, Maide, everywhere:"]
        for name, at in (("median", 0.5), ("90 %", 0.9), ("worst", 1)):
            columns = [sorted(column) for column in zip(*self.sizes)]
            picked = [column[min(int(at * len(column)), len(column) - 1)] for column in columns]
            lines.append(f"  {name}: {', '.join(map(str, picked))}")
        return "\n".join(lines)

    def spin_differences(self, path: Path, mine: dict) -> list[tuple[str, str]]:
        """The same, of SPIN."""
        found = []
        for name, entry in mine["properties"].items():
            if name == "stuck":
                continue
            theirs = self.ask(path, "--engine", "spin", "--property", name)
            if "broken" in theirs:
                return [("broken", f"Maide with SPIN, {name}: {theirs['broken']}")]
            if "error" in theirs:
                if "the engine spin" not in theirs["error"]:
                    return [("refused by SPIN", f"{name}: {theirs['error']}")]
                self.told["wordless"] += 1
                continue
            verdict = self.verdicts(theirs).get(name, "holds")
            self.told["verdicts"] += 1
            if (name, verdict, entry["verdict"]) == ("error", "holds", "inconclusive"):
                continue  # no program has one, wherever runs are cut
            if verdict != entry["verdict"]:
                kind = name if name in ("deadlock", "error") else "property"
                found.append(
                    (
                        f"{kind} {entry['verdict']} {verdict} spin",
                        f"{name}: referee {entry['verdict']}, SPIN {verdict}",
                    )
                )
            if name == "deadlock" and verdict != "violated" and is_at_once(path):
                found += self.spin_count_differences(mine, theirs)
        return found

    def spin_count_differences(self, mine: dict, theirs: dict) -> list[tuple[str, str]]:
        """Differences in states. The export may have equal steps twice."""
        own = {tuple(e["programs"]): e["states"] for e in mine["components"]}
        other = {
            tuple(sorted(name.replace(" ", "") for name in e["programs"])): e["states"]
            for e in theirs["components"]
        }
        self.told["components"] += len(own)
        return [] if own == other else [("SPIN's counts", f"referee {own}, SPIN {other}")]

    def count_differences(self, path: Path, mine: dict, theirs: dict) -> list[tuple[str, str]]:
        """Differences in components and their counts."""
        own = {tuple(e["parts"]): (e["states"], e["transitions"]) for e in mine["components"]}
        if self.old and len(own) > 1:
            return []
        if "components" in theirs:
            mine_named = sorted(tuple(e["programs"]) for e in mine["components"])
            names = sorted(
                tuple(sorted(name.replace(" ", "") for name in entry["programs"]))
                for entry in theirs["components"]
            )
            if names != mine_named:
                return [("components", f"referee {mine_named}, Maide {names}")]
        other = self.counts(path, mine)
        own = {parts: counts for parts, counts in own.items() if parts in other}
        if own != other:
            return [("counts", f"referee {own}, Maide {other}")]
        return []


def is_at_once(path: Path) -> bool:
    """Whether nothing is ever on its way, and a system's states are compared, too."""
    try:
        return not any(hasattr(use, "arrivals") for use in System(str(path)).uses)
    except Refused:
        return True


def has_lives(path: Path) -> bool:
    """Whether processes begin anew, are killed or end, or die with several programs: Maide takes
    several steps where the referee takes one."""
    try:
        return any(one.is_mortal and one.initial is not None for one in System(str(path)).processes)
    except Refused:
        return False


def words_of(path: Path) -> set[str]:
    """What of messages on their way a system uses, for --without."""
    text = path.read_text(encoding="utf-8")
    try:
        system = System(str(path))
    except Refused:
        returns = {"returns"} if "written" in text else set()
        return {word for word in WORDS if word in text} | returns
    found = {word for word in WORDS if f"{word}: " in text or f"-> {word};" in text}
    connections = [
        entry
        for section in ("topics", "services")
        for entry in (system.document.get(section) or {}).values()
    ]
    if system.nodes and not all("delivery" in entry for entry in connections):
        found.add("defaults")  # what is not said where there are nodes
    for entry in (system.document.get("services") or {}).values():
        if entry.get("delivery") == ACKNOWLEDGED:
            found.add("acknowledged")
    for use in system.uses:
        if any(wire.delivery == ACKNOWLEDGED for wire in getattr(use, "wires", [])):
            found.add("acknowledged")
        if isinstance(use, Boxes):
            if any(use.has_returns(i) for i in range(len(use.models))):
                found.add("returns")
            if any("disconnect" in model.input_names for model in use.models):
                found.add("disconnect")
    return found


def atom_of(document: dict, component: dict) -> str | None:
    """An atom of a component, None if none is found."""
    nodes = (document.get("nodes") or {}).items()
    entries = {header.split("[")[0]: entry for header, entry in nodes}
    for name in component["programs"]:
        if name.split("[")[0] not in entries:
            return f"{name}@end"
    for name in component["parts"]:
        node, _, own = name.rpartition(".")
        entry = entries[node.split("[")[0]]
        codes = {**(entry.get("callbacks") or {}), **(entry.get("threads") or {})}
        if isinstance(entry.get("clients"), dict):
            codes.update(entry["clients"])
        mains = (document.get("executors") or {}).get(entry.get("executor")) or {}
        code = codes.get(own, entry.get(own, mains.get(own, "")))
        label = re.search(r"@(\w+) ", str(code))
        if label:
            return f"{name}@{label.group(1)}"
    return None


class Literal(str):
    """A text that is written as a block in YAML."""


yaml.SafeDumper.add_representer(
    Literal, lambda dumper, text: dumper.represent_scalar("tag:yaml.org,2002:str", text, style="|")
)


def smaller_texts(text: str) -> Iterable[str]:
    """A program's text with a statement left out, or a block's braces."""
    lines = text.splitlines()
    for at in range(len(lines)):
        depth = 0
        for end in range(at, len(lines)):
            depth += lines[end].count("{") - lines[end].count("}")
            if depth < 0:
                break
            if depth == 0:
                yield "\n".join(lines[:at] + lines[end + 1 :])
                if end > at:
                    yield "\n".join(lines[:at] + lines[at + 1 : end] + lines[end + 1 :])
                if not lines[end].rstrip().endswith("{"):
                    break
        if lines[at].lstrip().startswith("@"):
            bare = lines[at].lstrip().split(" ", 1)[1]
            yield "\n".join(lines[:at] + [bare] + lines[at + 1 :])


def smaller(document: dict) -> Iterable[dict]:
    """The document with something left out."""
    sections = ("properties", "programs", "nodes", "models", "topics", "services", "executors",
                "procedures")  # fmt: skip
    for section in sections:
        for name in document.get(section) or {}:
            rest = {k: v for k, v in document[section].items() if k != name}
            copy = {**document, section: rest}
            if not rest:
                del copy[section]
            yield copy
    for section in ("programs", "procedures"):
        for name, text in (document.get(section) or {}).items():
            inner = text["do"] if isinstance(text, dict) else text
            if isinstance(text, dict):
                yield {**document, section: {**document[section], name: inner}}
            for less in smaller_texts(inner):
                if less.strip():
                    value = {**text, "do": less} if isinstance(text, dict) else less
                    yield {**document, section: {**document[section], name: value}}
    for name, node in (document.get("nodes") or {}).items():
        for less in smaller_nodes(node):
            yield {**document, "nodes": {**document["nodes"], name: less}}
    for section in ("topics", "services"):
        for name, entry in (document.get(section) or {}).items():
            for less in smaller_connections(entry):
                yield {**document, section: {**document[section], name: less}}
    for section in ("executors", "programs"):
        for name, entry in (document.get(section) or {}).items():
            for key in ("may_die", "may_restart", "process", "main"):
                if isinstance(entry, dict) and key in entry:
                    less = {k: v for k, v in entry.items() if k != key}
                    yield {**document, section: {**document[section], name: less}}
    for name, entry in (document.get("executors") or {}).items():
        for less in smaller_texts(entry.get("main", "").replace("} else", "}\nelse")):
            if less.strip():
                less_entry = {**entry, "main": less}
                yield {**document, "executors": {**document["executors"], name: less_entry}}
    if "variables" in document:
        yield {k: v for k, v in document.items() if k != "variables"}
    for name, entry in (document.get("models") or {}).items():
        for key in ("when_unexplored", "ends", "with" if entry.get("use") == "mutex" else ""):
            if key in entry:
                less = {k: v for k, v in entry.items() if k != key}
                yield {**document, "models": {**document["models"], name: less}}


def smaller_connections(entry: dict) -> Iterable[dict]:
    """A topic or service with a word or an end left out."""
    for key in ("delivery", "loses", "stream", "deliver", "readers_with", "when_unexplored"):
        if key in entry:
            yield {k: v for k, v in entry.items() if k != key}
    options = entry.get("with") or {}
    for key in ("pub-depth", "pub-history", "reliability"):
        if key in options:
            yield {**entry, "with": {k: v for k, v in options.items() if k != key}}
    for key in ("writers", "readers", "clients"):
        ends = entry.get(key)
        if isinstance(ends, list) and len(ends) > 1:
            for end in ends:
                yield {**entry, key: [other for other in ends if other != end]}


def smaller_nodes(node: dict) -> Iterable[dict]:
    """The node with something left out."""
    for key in ("executor", "groups", "clients", "variables", "start", "threads"):
        if key in node:
            yield {k: v for k, v in node.items() if k != key}
    for less in smaller_texts(node.get("start", "").replace("} else", "}\nelse")):
        if less.strip():
            yield {**node, "start": less}
    threads = node.get("threads") or {}
    for name, entry in threads.items():
        yield {**node, "threads": {k: v for k, v in threads.items() if k != name}}
        code = entry["do"] if isinstance(entry, dict) else entry
        shorter = [less for less in smaller_texts(code) if less.strip()]
        shorter += ["skip;"] * (code.strip() != "skip;") + [code] * isinstance(entry, dict)
        for less in shorter:
            if isinstance(entry, dict) and less != code:
                less = {**entry, "do": less}
            yield {**node, "threads": {**threads, name: less}}
    for section in ("clients", "callbacks"):
        entries = node.get(section) or {}
        for name, entry in entries.items():
            yield {**node, section: {k: v for k, v in entries.items() if k != name}}
            if not isinstance(entry, dict):
                continue
            smaller_entries = [
                {k: v for k, v in entry.items() if k != key} for key in ("group", "when")
            ]
            code = entry.get("do", "")
            if isinstance(code, str):
                texts = smaller_texts(code.replace("} else", "}\nelse"))
                smaller_entries += [{**entry, "do": less} for less in texts if less.strip()]
                smaller_entries += [{**entry, "do": "skip;"}] * (code.strip() != "skip;")
            else:
                for output, text in code.items():
                    smaller_entries.append({**entry, "do": text})
            for less in smaller_entries:
                if less != entry:
                    yield {**node, section: {**entries, name: less}}


def write(document: dict, path: Path) -> None:
    """Writes a system's file, with programs as blocks."""

    def as_block(value: object) -> object:
        if isinstance(value, dict):
            return {k: as_block(v) for k, v in value.items()}
        return Literal(value + "\n") if isinstance(value, str) and "\n" in value.strip() else value

    text = yaml.safe_dump(as_block(document), sort_keys=False, width=1000)
    path.write_text(text, encoding="utf-8")


def shrink(comparison: Comparison, path: Path, kind: str) -> None:
    """Makes the system smaller while it shows a difference of this kind."""
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    progress = True
    while progress:
        progress = False
        for less in smaller(document):
            trial = path.parent / "trial.yaml"
            write(less, trial)
            try:
                same = any(k == kind for k, _ in comparison.differences(trial))
            except (RecursionError, KeyError):
                same = False
            trial.unlink()
            if same:
                document, progress = less, True
                break
    write(document, path)


def main() -> int:
    """Compares."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--maide", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--only", choices=KINDS + AHEAD, nargs="*", default=[])
    parser.add_argument("--max-states", type=int, default=5000)
    parser.add_argument("--spin", action="store_true", help="compare SPIN's answers, too")
    parser.add_argument("--states", action="store_true", help="tell how many states wires cost")
    parser.add_argument("--old", action="store_true", help="a Maide without components")
    parser.add_argument("--skip", nargs="*", default=[], help="properties that are not compared")
    parser.add_argument("--without", nargs="*", default=[], choices=WORDS, help="not those systems")
    parser.add_argument("--keep", type=Path, default=Path("differences"))
    parser.add_argument("files", nargs="*", type=Path)
    options = parser.parse_args()
    comparison = Comparison(
        options.maide, options.max_states, options.old, options.skip, options.spin
    )
    comparison.sizes = [] if options.states else None
    differing = compared = left_out = 0
    with tempfile.TemporaryDirectory() as folder:
        paths: list[Path] = [path.absolute() for path in options.files]
        for kind in options.only:
            for number in range(options.first, options.first + options.count):
                paths.append(generate(kind, options.seed, number, Path(folder)))
        for path in paths:
            if options.without and words_of(path) & set(options.without):
                left_out += 1
                continue
            compared += 1
            found = comparison.differences(path)
            if not found:
                continue
            differing += 1
            name = path.parent.name if path.name == "system.yaml" else path.stem
            print(f"{name}: {found[0][1]}", flush=True)
            kept = options.keep / name
            if kept.exists():
                shutil.rmtree(kept)
            kept.mkdir(parents=True)
            for beside in path.parent.iterdir():  # its models
                if beside.is_file():
                    shutil.copy(beside, kept)
            if path.name != "system.yaml":
                (kept / path.name).rename(kept / "system.yaml")
            shutil.copy(kept / "system.yaml", kept / "made.yaml")
            if path.is_relative_to(folder):
                shrink(comparison, kept / "system.yaml", found[0][0])
            again = comparison.differences(kept / "system.yaml")
            text = "\n".join(sentence for _, sentence in again)
            (kept / "why.txt").write_text(text + "\n", encoding="utf-8")
    print(f"{compared} compared, {differing} differ" + f", {left_out} left out" * bool(left_out))
    if comparison.sizes:
        print(comparison.told_sizes())
    if options.spin:
        told = comparison.told
        print(
            f"SPIN: {told['verdicts']} verdicts, the counts of {told['components']} components; "
            f"no words for {told['wordless']} properties"
        )
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
