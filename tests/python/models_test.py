"""maide.Model: files, networkx, AALpy's machines, pictures; check, replay, compare and test."""
import shutil
import tempfile
import textwrap
import unittest
from pathlib import Path

import maide

try:
    import networkx
except ImportError:
    networkx = None

ROOT = Path(__file__).resolve().parents[2]
MODELS = ROOT / "tests" / "models"


def switch():
    return maide.Model.mealy([("off", "press", "on", "on"), ("on", "press", None, "off")], "off")


class Models(unittest.TestCase):
    def test_are_made_of_transitions(self):
        model = switch()
        self.assertEqual((len(model), model.inputs, model.kind), (2, ["press"], "mealy"))
        self.assertEqual(model.run(["press", "press", "press"]), ["on", "quiet", "on"])
        self.assertEqual(model.run(["press"], state=1), ["quiet"])
        self.assertEqual(model.transitions, [(0, "press", "on", 1), (1, "press", "quiet", 0)])
        with self.assertRaisesRegex(ValueError, "no input 'pull'"):
            model.run(["pull"])

    def test_must_be_complete_and_deterministic(self):
        with self.assertRaisesRegex(maide.UsageError, "each state and input"):
            maide.Model.mealy([(0, "a", 1, 1)], 0)
        with self.assertRaisesRegex(maide.UsageError, "two transitions"):
            maide.Model.mealy([(0, "a", 1, 0), (0, "a", 2, 0)], 0)

    def test_come_back_from_their_files(self):
        automaton = maide.Model.read(MODELS / "strict-2.dot")
        self.assertEqual((len(automaton), automaton.kind), (6, "ia"))
        self.assertIn((automaton.initial, "?write"), [row[:2] for row in automaton.transitions])
        self.assertEqual(maide.Model.parse(automaton.dot()).dot(), automaton.dot())
        with self.assertRaisesRegex(maide.UsageError, "to_mealy"):
            automaton.run(["write"])
        machine = automaton.to_mealy()
        self.assertEqual(machine.run(["write", "read", "read"]), ["quiet", "message", "quiet"])
        with self.assertRaisesRegex(ValueError, "<text>:1"):
            maide.Model.parse("digraph {")
        with tempfile.TemporaryDirectory() as folder:
            switch().save(Path(folder) / "switch.dot")
            self.assertTrue(maide.compare(Path(folder) / "switch.dot", switch()).same)

    def test_are_exported(self):
        self.assertIn('[label="press/on"]', switch().export("mealy"))
        self.assertIn("write/", maide.Model.read(MODELS / "strict-2.dot").export("mealy"))
        self.assertIn("class Switch", switch().export("cpp", "Switch"))
        with self.assertRaisesRegex(ValueError, "unknown format"):
            switch().export("png")

    @unittest.skipUnless(shutil.which("dot"), "needs Graphviz")
    def test_are_pictures(self):
        self.assertTrue(switch()._repr_svg_().startswith("<svg"))
        self.assertIn("\\begin{tikzpicture}", switch().export("tikz"))
        large = maide.Model.mealy([(n, "a", n, (n + 1) % 500) for n in range(500)], 0)
        self.assertIsNone(large._repr_svg_())

    @unittest.skipUnless(networkx, "needs python3-networkx")
    def test_are_graphs_and_come_back(self):
        machine = maide.Model.read(MODELS / "strict-3.dot").to_mealy()
        graph = machine.to_networkx()
        self.assertEqual(graph.number_of_nodes(), len(machine))
        self.assertEqual(graph.number_of_edges(), len(machine.transitions))
        self.assertTrue(networkx.is_strongly_connected(graph))
        self.assertTrue(maide.compare(maide.Model.from_networkx(graph), machine).same)
        automaton = maide.Model.read(MODELS / "strict-3.dot").to_networkx()
        self.assertIn("!message", {data["action"] for *_, data in automaton.edges(data=True)})
        with self.assertRaisesRegex(ValueError, "lacks `input`"):
            maide.Model.from_networkx(automaton)
        with self.assertRaisesRegex(ValueError, "initial"):
            maide.Model.from_networkx(networkx.MultiDiGraph())

    def test_come_from_machines_as_aalpy_builds_them(self):
        class State:
            def __init__(self):
                self.transitions = {}
                self.output_fun = {}

        class Machine:
            pass

        off, on = State(), State()
        off.transitions["press"], off.output_fun["press"] = on, "on"
        on.transitions["press"], on.output_fun["press"] = off, None
        machine = Machine()
        machine.initial_state, machine.states = off, [on, off]
        self.assertTrue(maide.compare(maide.Model.from_aalpy(machine), switch()).same)

    def test_go_to_aalpy_where_it_is(self):
        try:
            import aalpy  # noqa: F401
        except ImportError:
            self.skipTest("needs AALpy, which Debian does not have")
        machine = maide.Model.read(MODELS / "strict-3.dot").to_aalpy()
        word = ["write", "write", "read", "read", "read"]
        self.assertEqual(machine.execute_sequence(machine.initial_state, word),
                         maide.Model.read(MODELS / "strict-3.dot").to_mealy().run(word))
        self.assertTrue(maide.compare(maide.Model.from_aalpy(machine),
                                      maide.Model.read(MODELS / "strict-3.dot")).same)


class Commands(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.system = Path(self.folder.name) / "system.yaml"
        self.system.write_text(textwrap.dedent("""\
            models:
              via: {learn: port, with: {kind: buffered}}
            programs:
              planner: "repeat 3 { via.write; }"
              controller: "repeat 3 { via.read -> message; }"
            """))

    def test_check_and_replay(self):
        trace = Path(self.folder.name) / "deadlock.json"
        checked = maide.check(self.system, property="deadlock", trace=trace)
        self.assertEqual((checked.verdict, checked.status, checked.ok), ("violated", 1, False))
        self.assertEqual(checked.properties[0]["name"], "deadlock")
        replayed = maide.replay(self.system, trace, rounds=3)
        self.assertEqual((replayed.verdict, replayed.runs), ("followed", 3))
        with self.assertRaisesRegex(AttributeError, "has no 'colour'"):
            checked.colour
        with self.assertRaises(maide.UsageError):
            maide.check(self.system, engine="abacus")
        with self.assertRaises(maide.UsageError):
            maide.check(Path(self.folder.name) / "nothing.yaml")

    def test_compare(self):
        result = maide.compare(MODELS / "strict-1.dot", maide.Model.read(MODELS / "strict-2.dot"))
        self.assertFalse(result.same)
        self.assertEqual(result.status, 0)  # one knows what the other never tried
        self.assertEqual([one["word"] for one in result.differences], [["?write"]])
        result = maide.compare(MODELS / "strict-1.dot", MODELS / "strict-2.dot", strict=True)
        self.assertEqual(result.status, 1)

    def test_test_of_a_name_and_of_an_object(self):
        result = maide.test(MODELS / "strict-1.dot", "port", kind="strict", size=1, max_tests=100)
        self.assertEqual(result.failures, [])
        result = maide.test(MODELS / "strict-2.dot", "port", kind="strict", size=1)
        self.assertEqual((result.verdict, result.status), ("differs", 1))

        class Switch:
            inputs = ["press"]

            def reset(self):
                self.n = 0

            def step(self, given):
                self.n += 1
                return "on" if self.n % 2 else None if self.n < 4 else "dim"

        result = maide.test(switch(), Switch())
        self.assertEqual(result.failures[0]["word"], ["press"] * 4)
        self.assertEqual(result.failures[0]["seen"], "dim")

    def test_any_command(self):
        self.assertIn("port", {one["name"] for one in maide.command("doctor").findings})
        with self.assertRaisesRegex(ValueError, "unknown command"):
            maide.command("paint")


if __name__ == "__main__":
    unittest.main()
