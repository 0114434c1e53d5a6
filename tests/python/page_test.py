"""The code of docs/python.md, run from top to bottom, and its server against a real one."""
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import maide

ROOT = Path(__file__).resolve().parents[2]


class Page(unittest.TestCase):
    def test_runs_as_it_stands(self):
        blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text("utf-8"), re.S)
        self.assertGreaterEqual(len(blocks), 5)
        names = {}
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for number, block in enumerate(blocks):
                    exec(compile(block, f"docs/python.md, block {number + 1}", "exec"), names)
            finally:
                os.chdir(before)
        server = subprocess.Popen([sys.executable, ROOT / "tests/systems/line_server.py"], text=True,
                                  stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        try:
            host, _, port = server.stdout.readline().split()[-1].rpartition(":")
            model = maide.learn(names["Server"]((host, int(port))), effort=1).model
        finally:
            server.communicate("")
        self.assertEqual(model.run(["PASS x", "USER anonymous", "PASS x", "LIST", "QUIT", "LIST"]),
                         ["503", "331", "230", "226", "221", "closed"])


if __name__ == "__main__":
    unittest.main()
