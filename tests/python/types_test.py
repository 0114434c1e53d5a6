"""The package's types, as mypy sees them: of the package itself, and of programs that use it."""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import maide

PACKAGES = pathlib.Path(maide.__file__).parent.parent
RIGHT = """
import maide

class Switch:
    inputs = ["press"]
    is_on = False
    def reset(self) -> None:
        self.is_on = False
    def step(self, given: str) -> str:
        self.is_on = not self.is_on
        return "on" if self.is_on else "off"

learned: maide.Learned = maide.learn(Switch(), eq="w", seed=1)
if learned.model is not None:
    outputs: list[str] = learned.model.run(["press", "press"])
status: int = maide.check("system.yaml", time=10).status
with maide.System("port", kind="strict") as system:
    answers: list[list[str]] = system.query_many([["write", "read"]])
"""


@unittest.skipUnless(shutil.which("mypy"), "skipped: no mypy")
class Types(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cache = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.cache.cleanup)

    def mypy(self, *arguments):
        return subprocess.run(["mypy", "--strict", "--cache-dir", self.cache.name, *arguments],
                              env={"MYPYPATH": str(PACKAGES), "PATH": "/usr/bin:/bin"},
                              capture_output=True, text=True)

    def of_program(self, text):
        with tempfile.NamedTemporaryFile("w", suffix=".py") as file:
            file.write(text)
            file.flush()
            return self.mypy(file.name)

    def test_of_the_package_are_sound(self):
        result = self.mypy("-p", "maide")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_a_program_is_checked(self):
        result = self.of_program(RIGHT)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_a_wrong_program_is_refused(self):
        for right, wrong in [("list[str] = learned", "list[int] = learned"),
                             ("status: int", "status: maide.Model"),
                             ('["press", "press"])', '["press"], state="off")'),
                             ("if learned.model is not None:", "if True:")]:
            self.assertIn(right, RIGHT)
            result = self.of_program(RIGHT.replace(right, wrong))
            self.assertEqual(result.returncode, 1, wrong + result.stdout)


if __name__ == "__main__":
    unittest.main()
