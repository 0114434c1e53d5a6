"""maide.check() against the command line: what one says of a system file, both say. That the library
for C++ says it, too, is tested in tests/cli/check_library_test.cpp."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import maide

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

# What is violated needs an order of callbacks that rclcpp's executors do not take.
DOUBTFUL = """
topics:
  a: {writers: w, readers: n, delivery: at_once, use: queue, with: {depth: 1}}
  b: {writers: w, readers: n, delivery: at_once, use: queue, with: {depth: 1}}
programs:
  w: "a.write; b.write;"
nodes:
  n:
    variables: "var seen: bool; var bad: 0..1;"
    callbacks:
      on_a: {takes: a.read, do: "seen = true;"}
      on_b: {takes: b.read, do: "if (!seen) { bad = bad + 2; }"}
"""


def timeless(result):
    """Without what differs from run to run."""
    result = json.loads(json.dumps(result))
    for entry in result["properties"]:
        for key in ("seconds", "peak_bytes", "bytes_per_state"):
            del entry[key]
    return result


class Check(unittest.TestCase):
    def check(self, path):
        result = maide.check(path)
        printed = subprocess.run([os.environ["MAIDE_PROGRAM"], "check", str(path), "--json"],
                                 capture_output=True, text=True)
        self.assertEqual(timeless(result), timeless(json.loads(printed.stdout)))
        self.assertEqual(result.status, printed.returncode)
        return result

    def test_says_what_the_command_line_says(self):
        for name in ("case-study-1/buffered.yaml", "case-study-1/beyond-the-bound.yaml",
                     "architectures/cell.yaml"):
            self.check(EXAMPLES / name)

    def test_says_what_is_doubtful(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "doubtful.yaml"
            path.write_text(DOUBTFUL, encoding="utf-8")
            result = self.check(path)
        self.assertEqual(result.verdict, "violated")
        self.assertEqual(len(result.doubts), 1)
        self.assertIn("no run was found in which executors pick", result.doubts[0])


if __name__ == "__main__":
    unittest.main()
