"""Runs `maide extract` on small programs that are apt to be read wrongly, and looks whether something is lost in silence.

    programs.py MAIDE [NAMES]      # all programs of the folder beside this file, or those of these names

A program begins with `==== NAME`; `NAME.part2` is a second source of it. Comments at its top say what it is about, what
must be in the file (`want: REGEX`), and what must not be there (`not: REGEX`). It is right if that is so, or if the exit
status says that something is missing; where a comment says `exact`, a hole is wrong, too. Exit status 1: one is wrong, 77:
there is no cppcheck that is known.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

ARGUMENTS = ["--assume", "ok,exceptions,read", "--closed", "--executor", "single"]
HEAD = """#include <rclcpp/rclcpp.hpp>
using namespace std::chrono_literals;
using Int = std_msgs::msg::Int32;
using Trigger = std_srvs::srv::Trigger;
"""


def read_programs():
    """The texts by name."""
    programs = {}
    for file in sorted((Path(__file__).resolve().parent / "programs").glob("*.txt")):
        for text in re.split(r"^==== ", file.read_text(), flags=re.MULTILINE)[1:]:
            name, _, code = text.partition("\n")
            programs[name] = code
    return programs


def expectation(code):
    """The comments at the top: key and value of each."""
    lines = []
    for line in code.splitlines():
        found = re.match(r"//\s*(want|not|exact)\b:?\s*(.*)", line)
        if found:
            lines.append((found[1], found[2].strip()))
        elif not line.startswith("//"):
            break
    return lines


def judge(maide, name, programs, folder):
    """What is wrong; nothing if it is right."""
    sources = []
    for part in (name, name + ".part2"):
        if part in programs:
            sources.append(folder / (part + ".cpp"))
            sources[-1].write_text(HEAD + programs[part])
    system = folder / "robot.yaml"
    system.unlink(missing_ok=True)
    run = subprocess.run([maide, "extract", *map(str, sources), *ARGUMENTS, "-o", str(system)], text=True,
                         capture_output=True, timeout=120, check=False)
    expected = expectation(programs[name])
    if run.returncode not in (0, 3):
        return f"exit status {run.returncode}: {run.stderr.strip()}"
    if run.returncode == 3:
        is_exact = any(key == "exact" for key, _ in expected)
        return f"a hole in a plain program: {run.stdout.strip()}" if is_exact else ""
    written = system.read_text()
    wrong = [f"{key} {value}" for key, value in expected
             if key != "exact" and bool(re.search(value, written)) != (key == "want")]
    return "; ".join(wrong) + "\n" + written if wrong else ""


def main():
    """Runs them all."""
    maide, *names = sys.argv[1:]
    try:
        version = subprocess.run(["cppcheck", "--version"], text=True, capture_output=True, check=False).stdout
    except FileNotFoundError:
        version = ""
    if "2.10" not in version:
        print("skipped: no cppcheck 2.10")
        return 77
    programs = read_programs()
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in names or [name for name in programs if not name.endswith(".part2")]:
            if wrong := judge(maide, name, programs, Path(folder)):
                failed += 1
                print(f"{name}: {wrong}")
    print(f"{len(programs)} sources, {failed} programs wrong")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
