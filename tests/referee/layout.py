"""Random systems laid out by `maide format`: nothing changes but blanks.

    layout.py --maide PROGRAM --seed S --count N

Makes N systems of each kind of generate.py. A second layout changes nothing, and each component's
graph of states (`maide export --to aut`) is the same as before; graphs that take long are left out.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from generate import KINDS


def run(arguments: list[str], seconds: float | None = None) -> subprocess.CompletedProcess:
    """Runs a program and keeps what it says."""
    return subprocess.run(
        arguments, capture_output=True, text=True, check=False, timeout=seconds
    )


def graphs(maide: str, path: Path) -> list[str] | None:
    """The graph of states of each component, or why there is none, without the place.

    None if that takes long."""
    checked = run([maide, "check", "--json", "--property", "deadlock", "--time", "10", str(path)])
    try:
        components = json.loads(checked.stdout)["components"]
    except (json.JSONDecodeError, KeyError):
        return [checked.stderr.split("(/")[0]]
    written = []
    for component in components:
        program = component["programs"][0]
        try:
            result = run([maide, "export", str(path), "--to", "aut", "--component", program], 10)
        except subprocess.TimeoutExpired:
            return None
        written.append(result.stdout if result.returncode == 0 else result.stderr.split("(/")[0])
    return written


def main() -> int:
    """Compares all systems; tells the first that differ."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--maide", required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=10)
    options = parser.parse_args()
    here = Path(__file__).parent
    wrong = []
    laid_out = 0
    compared = 0
    with tempfile.TemporaryDirectory() as folder:
        for kind in KINDS:
            arguments = [sys.executable, "-B", str(here / "generate.py"), "--seed",
                         str(options.seed), "--count", str(options.count), "--only", kind,
                         folder]  # fmt: skip
            subprocess.run(arguments, check=True)
        files = sorted(Path(folder).glob("*/system.yaml"))
        for path in files:
            before = graphs(options.maide, path)
            result = run([options.maide, "format", str(path)])
            again = run([options.maide, "format", "--check", str(path)])
            laid_out += 1 if result.stdout else 0
            if result.returncode != 0 or again.returncode != 0:
                wrong.append(f"{path.parent.name}: {result.stderr}{again.stdout}{again.stderr}")
                continue
            after = graphs(options.maide, path)
            if before is None or after is None:
                continue
            compared += 1
            if after != before:
                wrong.append(f"{path.parent.name}: another system\n{path.read_text()}")
    print(f"{len(files)} systems, {laid_out} of them laid out anew, {len(wrong)} wrong")
    print(f"the graphs of {compared} compared")
    print("\n".join(wrong[:3]))
    is_whole = laid_out > 0 and compared > 0 and len(files) == options.count * len(KINDS)
    return 0 if is_whole and not wrong else 1


if __name__ == "__main__":
    sys.exit(main())
