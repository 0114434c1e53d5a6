"""maide.learn(): objects of Python and systems by name, errors, limits, Ctrl-C, caches, progress."""
import os
import signal
import tempfile
import threading
import traceback
import unittest
from pathlib import Path

import maide

MODELS = Path(__file__).resolve().parents[1] / "models"


class Queue:
    """Keeps at most `size` messages."""

    inputs = ["put", "get"]

    def __init__(self, size=2):
        self.size = size
        self.resets = 0

    def reset(self):
        self.count = 0
        self.resets += 1

    def step(self, given):
        if given == "put":
            if self.count == self.size:
                return "full"
            self.count += 1
            return "ok"
        if self.count == 0:
            return "empty"
        self.count -= 1
        return "item"


class Batches:
    """The same, asked by words."""

    inputs = Queue.inputs

    def __init__(self):
        self.queue = Queue()
        self.batches = []

    def query_many(self, words):
        self.batches.append(len(words))
        answers = []
        for word in words:
            self.queue.reset()
            answers.append([self.queue.step(given) for given in word])
        return answers


class Stalling:
    """A lock that its holder asks for again, and then waits for ever."""

    inputs = ["lock", "unlock"]
    raises = None

    def reset(self):
        self.lock = threading.Lock()

    def step(self, given):
        if given == "lock":
            self.lock.acquire()
            return "ok"
        if not self.lock.locked():
            if self.raises is not None:
                raise self.raises
            return "free"
        self.lock.release()
        return "ok"


class StepTime(unittest.TestCase):
    def test_what_blocks_hangs_until_the_next_word(self):
        learned = maide.learn(Stalling(), step_time=0.05, eq="w:extra-states=1")
        self.assertTrue(learned.complete)
        self.assertEqual(learned.model.run(["unlock", "lock", "unlock", "lock", "lock", "unlock"]),
                         ["free", "ok", "ok", "ok", "hang", "hang"])
        self.assertEqual(len(learned.model), 3)

    def test_what_is_raised_is_raised_again(self):
        system = Stalling()
        system.raises = LookupError("nobody has it")
        with self.assertRaisesRegex(LookupError, "nobody has it"):
            maide.learn(system, step_time=5)

    def test_it_goes_with_step_alone(self):
        with self.assertRaisesRegex(maide.UsageError, "not with query_many"):
            maide.learn(Batches(), step_time=1)
        with self.assertRaisesRegex(maide.UsageError, "goes with an object"):
            maide.learn("sim:" + str(MODELS / "port.dot"), step_time=1)
        with self.assertRaisesRegex(maide.UsageError, "positive number of seconds"):
            maide.learn(Queue(), step_time=0)


class Objects(unittest.TestCase):
    def test_is_learned(self):
        queue = Queue(3)
        learned = maide.learn(queue)
        self.assertTrue(learned.complete)
        self.assertFalse(learned.weak)
        self.assertEqual(len(learned.model), 4)
        self.assertEqual(learned.model.kind, "mealy")
        self.assertEqual(learned.model.run(["get", "put", "put", "put", "put", "get"]),
                         ["empty", "ok", "ok", "ok", "full", "item"])
        self.assertGreaterEqual(queue.resets, learned.words)
        self.assertEqual(learned.strength["weak"], False)
        self.assertEqual(learned.model.origin["sul"], "python:learn_test.Queue")

    def test_takes_any_hashable_inputs_and_outputs(self):
        class Counter:
            def reset(self):
                self.n = 0

            def step(self, given):
                self.n = (self.n + given[0]) % 3
                return None if self.n == 0 else self.n

        learned = maide.learn(Counter(), inputs=[(1, "up"), (2, "down")])
        self.assertEqual(learned.model.inputs, ["(1, 'up')", "(2, 'down')"])
        self.assertEqual(learned.model.run([(1, "up"), (1, "up"), (1, "up")]), ["1", "2", "quiet"])

    def test_outputs_need_no_hash(self):
        class Lists(Queue):
            def step(self, given):
                return [super().step(given)]

        self.assertEqual(maide.learn(Lists()).model.run(["put"]), ["['ok']"])

    def test_what_it_refuses_may_change_it(self):
        class Door:
            inputs = ["knock", "open"]

            def reset(self):
                self.knocks = 0

            def step(self, given):
                if given == "knock":
                    self.knocks = (self.knocks + 1) % 3
                return "refused" if self.knocks < 2 else "welcome"

        model = maide.learn(Door()).model
        self.assertEqual(model.run(["open", "knock", "knock", "open"]),
                         ["refused", "refused", "welcome", "welcome"])
        self.assertEqual(maide.test(model, Door()).verdict, "conforms")

    def test_is_asked_in_batches_where_it_can_be(self):
        batches = Batches()
        learned = maide.learn(batches, algorithm="lsharp", seed=3)
        self.assertEqual(learned.algorithm, "lsharp-sepseq")  # asks words alone
        self.assertEqual(len(learned.model), 3)
        self.assertGreater(max(batches.batches), 10)

    def test_wrong_answers_of_batches_are_named(self):
        batches = Batches()
        batches.query_many = lambda words: [["ok"]] * len(words)
        with self.assertRaisesRegex(maide.UsageError, "outputs to a word of"):
            maide.learn(batches)
        batches.query_many = lambda words: []
        with self.assertRaisesRegex(maide.UsageError, "answered 0"):
            maide.learn(batches)

    def test_every_algorithm_and_seed_gives_the_same_model(self):
        expected = maide.learn(Queue()).model
        for algorithm in ("lstar", "ttt", "kv", "adt"):
            model = maide.learn(Queue(), algorithm=algorithm, seed=7, eq="wp,random-w").model
            self.assertTrue(maide.compare(model, expected).same, algorithm)

    def test_what_a_step_raises_is_raised_again(self):
        class Broken(Queue):
            def step(self, given):
                if self.count == 1 and given == "get":
                    raise RuntimeError("the valve is stuck")
                return super().step(given)

        try:  # assertRaises() would throw the traceback away
            maide.learn(Broken())
            self.fail("nothing was raised")
        except RuntimeError as error:
            self.assertEqual(str(error), "the valve is stuck")
            self.assertEqual(traceback.extract_tb(error.__traceback__)[-1].name, "step")
            self.assertTrue(hasattr(error, "learned"))

    def test_what_is_no_system_is_told(self):
        with self.assertRaises(TypeError):
            maide.learn(object())
        with self.assertRaises(AttributeError):
            maide.learn(object(), inputs=["a"])
        with self.assertRaisesRegex(ValueError, "twice"):
            maide.learn(Queue(), inputs=["put", "put"])
        with self.assertRaisesRegex(ValueError, "unknown option '--algorithmus'"):
            maide.learn(Queue(), algorithmus="lstar")
        with self.assertRaisesRegex(ValueError, "--algorithm: 'best' is none of"):
            maide.learn(Queue(), algorithm="best")

    def test_contradictions_are_nondeterminism(self):
        class Coin(Queue):
            n = 0

            def step(self, given):
                self.n += 1
                return "heads" if self.n * 7919 % 101 < 50 else "tails"

        learned = maide.learn(Coin())
        self.assertFalse(learned.complete)
        self.assertIn("nondeterministic", learned.problem)

    def test_limits_keep_what_was_learned(self):
        learned = maide.learn(Queue(5), max_experiments=20)
        self.assertFalse(learned.complete)
        self.assertLessEqual(learned.words, 20)
        self.assertIsNotNone(learned.model)

    def test_a_cache_saves_every_word(self):
        with tempfile.TemporaryDirectory() as folder:
            cache = Path(folder) / "queue.cache"
            first = maide.learn(Queue(), cache=cache)
            queue = Queue()
            again = maide.learn(queue, cache=cache)
            self.assertGreater(first.words, 0)
            self.assertEqual((again.words, queue.resets), (5, 5))  # a sample: is it the same system?
            with self.assertRaises(maide.Error):  # it is another system's
                maide.learn(Batches(), cache=cache)

    def test_starts_from_an_earlier_model_and_knows_a_reference(self):
        old = maide.learn(Queue(4)).model
        fresh = maide.learn(Queue(4), reference=old, eq="perfect")
        self.assertTrue(maide.compare(fresh.model, old).same)
        seeded = maide.learn(Queue(4), start_from=old, reference=old, eq="perfect")
        self.assertLessEqual(seeded.equivalence_queries, fresh.equivalence_queries)
        self.assertEqual(seeded.equivalence_queries, 1)

    def test_progress_is_told(self):
        seen = []
        maide.learn(Queue(8), progress=seen.append, effort=2)
        self.assertTrue(seen)
        self.assertTrue({"phase", "states", "words", "symbols"} <= set(seen[-1]))

    def test_what_progress_raises_ends_the_run(self):
        def stop(_):
            raise LookupError("enough")

        with self.assertRaisesRegex(LookupError, "enough"):
            maide.learn(Queue(8), progress=stop)

    def test_ctrl_c_keeps_what_was_learned(self):
        class Slow(Queue):
            def reset(self):
                super().reset()
                if self.resets == 60:
                    signal.raise_signal(signal.SIGINT)

        with self.assertRaises(maide.Interrupted) as caught:
            maide.learn(Slow(6))
        self.assertIsInstance(caught.exception, KeyboardInterrupt)
        self.assertGreaterEqual(len(caught.exception.learned.model), 2)

    def test_runs_on_the_calling_thread_and_on_several(self):
        threads = set()

        class Watched(Queue):
            def step(self, given):
                threads.add(threading.get_ident())
                return super().step(given)

        maide.learn(Watched())
        self.assertEqual(threads, {threading.get_ident()})
        results = []
        workers = [threading.Thread(target=lambda n=n: results.append(len(maide.learn(Queue(n)).model)))
                   for n in (1, 2, 3)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.assertEqual(sorted(results), [2, 3, 4])


class Systems(unittest.TestCase):
    def test_are_learned_by_name_with_options_as_keywords(self):
        learned = maide.learn("port", kind="strict", size=2)
        self.assertEqual(learned.model.kind, "ia")
        self.assertTrue(maide.compare(learned.model, MODELS / "strict-2.dot").same)
        machine = maide.learn("port", kind="strict", size=2, as_="mealy").model
        self.assertEqual(machine.kind, "mealy")
        listed = maide.learn("port", inputs=["write", "read", "tryread"])
        self.assertIn("tryread", listed.model.inputs)

    def test_unknown_ones_are_errors(self):
        with self.assertRaisesRegex(maide.UsageError, "corba"):
            maide.learn("corba")
        with self.assertRaisesRegex(ValueError, "dpeth"):
            maide.learn("port", dpeth=3)
        with self.assertRaises(maide.SystemFailed):
            maide.learn("exec:/nonexistent/wrapper")

    def test_ctrl_c_while_a_system_works(self):
        has_states = threading.Event()

        def interrupt():
            has_states.wait()
            os.kill(os.getpid(), signal.SIGINT)

        def watch(progress):
            if progress["states"] >= 2:
                has_states.set()

        thread = threading.Thread(target=interrupt)
        thread.start()
        with self.assertRaises(maide.Interrupted) as caught:
            maide.learn("port", kind="strict", size=60, inputs="write,read,tryread", effort=50,
                        progress=watch)
        thread.join()
        self.assertIsNotNone(caught.exception.learned.model)
        self.assertEqual(caught.exception.result.status, 3)

    def test_answer_words(self):
        with maide.System("port", kind="strict", size=1) as system:
            self.assertEqual(system.inputs, ["write", "read"])
            self.assertEqual(system.options["size"], "1")
            self.assertEqual(system.query(["write", "read"]), ["quiet", "message"])
            self.assertEqual(system.query_many([["read", "write"], []]),
                             [["quiet", "message"], []])
            with self.assertRaisesRegex(ValueError, "unknown input 'wirte'"):
                system.query(["wirte"])
        with self.assertRaises(ValueError):
            system.query(["write"])


if __name__ == "__main__":
    unittest.main()
