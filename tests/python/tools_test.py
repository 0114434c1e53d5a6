"""Commands whose work is done by a program of its own: the result and the errors come through."""
import unittest
from pathlib import Path

import maide

MODELS = Path(__file__).resolve().parents[1] / "models"


class Tools(unittest.TestCase):
    def test_result_comes_through(self):
        result = maide.command("bench", MODELS, algorithm="rs", max_experiments=3)
        self.assertEqual(result.status, 3)  # so few words are not enough
        self.assertTrue(result["runs"])
        self.assertNotIn("error", result)

    def test_error_comes_through(self):
        with self.assertRaisesRegex(maide.UsageError, "there is no such folder"):
            maide.command("bench", MODELS / "nothing")


if __name__ == "__main__":
    unittest.main()
