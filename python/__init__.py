"""Learns models of running systems and checks programs against them: Maide from Python.

    import maide

    class Switch:                                  # any object with reset() and step(input)
        inputs = ["press"]
        def reset(self): self.is_on = False
        def step(self, given):
            self.is_on = not self.is_on
            return "on" if self.is_on else "off"

    learned = maide.learn(Switch())
    learned.model                                  # a picture, in a notebook
    learned = maide.learn("cyclonedds", history="keep_last", depth=1)
    maide.check("system.yaml").verdict

The options of learn(), check(), replay(), compare() and test() are those of the commands of the same
names (`maide learn --help`), as keywords: `max_experiments=1000` is `--max-experiments 1000`.
`as_="mealy"` is `--as mealy`. Times are in seconds.

Errors are of the classes Error, UsageError (a ValueError) and SystemFailed. What an object's step()
raises is raised again. Ctrl-C raises Interrupted, which is a KeyboardInterrupt and has what was
learned until then.
"""
from __future__ import annotations

import dataclasses
import json
import os
import queue
import tempfile
import threading
from pathlib import Path
from typing import Any, Callable, Dict, Hashable, Iterable, List, Mapping, Optional, Sequence, Tuple, Union

from . import _core
from ._core import Error, SystemFailed, UsageError

__version__: str = _core.version
__all__ = ["Error", "Interrupted", "Learned", "Model", "Result", "System", "SystemFailed",
           "UsageError", "check", "command", "compare", "learn", "replay", "test"]

Progress = Callable[[Dict[str, Any]], object]
PathLike = Union[str, "os.PathLike[str]"]


class Interrupted(KeyboardInterrupt):
    """Ctrl-C. `learned` is what learn() had until then, or None; `result` what the command says."""

    def __init__(self, result: "Result", learned: Optional["Learned"] = None):
        super().__init__("interrupted; what was learned until then is in `learned`")
        self.result = result
        self.learned = learned


class Result(Dict[str, Any]):
    """What a command answers: the object of its --json, its members as attributes, too.

    `status` is the exit status of the command: 0 it holds, they agree, done; 1 violated, they
    differ; 3 inconclusive.
    """

    status: int

    def __init__(self, status: int, members: Mapping[str, Any]):
        super().__init__(members)
        self.__dict__["status"] = status

    @property
    def ok(self) -> bool:
        """Whether the status is 0."""
        return bool(self.__dict__["status"] == 0)

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"the result has no {name!r}; it has {', '.join(self)}") from None


# ---- Models ----


class Model:
    """A Mealy machine, or an interface automaton, whose inputs and outputs are steps of their own.

    States are numbers from 0. In a notebook a model is a picture, if Graphviz is there and the model
    has at most 150 states.
    """

    def __init__(self, core: _core.Model):
        self._core = core
        about = core.describe()
        self.initial: int = about["initial"]
        self.inputs: List[str] = about["inputs"]
        self.outputs: List[str] = about["outputs"]
        self.origin: Dict[str, str] = about["origin"]
        self._size: int = about["states"]
        self._table: Optional[Dict[Tuple[int, str], Tuple[str, int]]] = None

    @staticmethod
    def read(path: PathLike) -> "Model":
        """The model in a file (.dot, .gv or .aut). Raises UsageError, with the place in the file."""
        return Model(_core.Model.read(os.fspath(path)))

    @staticmethod
    def parse(dot: str) -> "Model":
        """The model of a text in DOT."""
        return Model(_core.Model.parse(dot, "<text>"))

    @staticmethod
    def mealy(transitions: Iterable[Tuple[Hashable, object, object, Hashable]],
              initial: Hashable) -> "Model":
        """The Mealy machine of transitions (source, input, output, target).

        States may be anything hashable; inputs and outputs are named by str(), None is "quiet".
        Raises UsageError unless there is one transition for each state and input.
        """
        numbers: Dict[Hashable, int] = {initial: 0}
        inputs: Dict[str, None] = {}
        rows: Dict[Tuple[int, str], Tuple[str, int]] = {}
        for source, given, output, target in transitions:
            row = (numbers.setdefault(source, len(numbers)), str(given))
            inputs[str(given)] = None
            if row in rows:
                raise UsageError(f"state {source!r} has two transitions for input {given!r}")
            rows[row] = ("quiet" if output is None or output == "" else str(output),
                         numbers.setdefault(target, len(numbers)))
        table = [(source, given, output, target) for (source, given), (output, target) in rows.items()]
        return Model(_core.Model.make(len(numbers), 0, list(inputs), table))

    @property
    def kind(self) -> str:
        """"mealy", or "ia" for an interface automaton."""
        return "ia" if self._core.is_automaton() else "mealy"

    def __len__(self) -> int:
        return self._size

    def __repr__(self) -> str:
        kind = "interface automaton" if self.kind == "ia" else "Mealy machine"
        return f"<maide.Model: {kind}, {len(self)} states, {len(self.inputs)} inputs>"

    @property
    def transitions(self) -> List[Tuple[Any, ...]]:
        """(source, input, output, target) of a Mealy machine; (source, action, target) of an
        interface automaton, whose actions are "?input" and "!output"."""
        return self._core.transitions()

    def run(self, word: Sequence[object], state: Optional[int] = None) -> List[str]:
        """The outputs of a deterministic Mealy machine to the inputs of a word, from a state or the
        initial one. Raises UsageError for an input that it does not have."""
        if self._table is None:
            if self.kind == "ia":
                raise UsageError("an interface automaton has no outputs to a word; to_mealy() has")
            self._table = {(row[0], row[1]): (row[2], row[3]) for row in self.transitions}
        state = self.initial if state is None else state
        outputs = []
        for given in word:
            step = self._table.get((state, str(given)))
            if step is None:
                raise UsageError(f"no input {given!r}; the inputs are {', '.join(self.inputs)}")
            outputs.append(step[0])
            state = step[1]
        return outputs

    def to_mealy(self) -> "Model":
        """The Mealy machine of an interface automaton: a step is an input and all that comes until
        the system rests. Another machine is itself."""
        return Model(self._core.to_mealy())

    def dot(self) -> str:
        """The model's file."""
        return self.export("dot")

    def save(self, path: PathLike) -> None:
        """Writes the model's file. Its name ends in .dot."""
        Path(path).write_text(self.dot(), encoding="utf-8")

    def export(self, format: str, name: str = "Model") -> str:
        """The model in a format of `maide export --to`: "mealy", "tikz", "aut", "promela", "smv",
        "mcrl2", "cpp" (of a class with this name)."""
        if format == "tikz":
            return self._core.picture("tikz")
        core = self._core.to_mealy() if format == "mealy" else self._core
        return core.export(format, name)

    def svg(self) -> Optional[str]:
        """The picture, by Graphviz; None without Graphviz, and for a model too large to be seen."""
        return self._core.picture("svg") or None

    _repr_svg_ = svg

    def to_networkx(self) -> Any:
        """A networkx.MultiDiGraph: edges have `input` and `output`, or `action`, and a `label`; the
        graph has `initial`."""
        import networkx  # type: ignore  # only who wants a graph needs it

        graph = networkx.MultiDiGraph(initial=self.initial, origin=dict(self.origin))
        graph.add_nodes_from(range(len(self)))
        for row in self.transitions:
            if len(row) == 3:
                graph.add_edge(row[0], row[2], action=row[1], label=row[1])
            else:
                graph.add_edge(row[0], row[3], input=row[1], output=row[2],
                               label=f"{row[1]} / {row[2]}")
        return graph

    @staticmethod
    def from_networkx(graph: Any, initial: Optional[Hashable] = None) -> "Model":
        """The Mealy machine of a directed graph whose edges have `input` and `output`. The initial
        state is given, or graph.graph["initial"]."""
        start = graph.graph.get("initial") if initial is None else initial
        if start is None:
            raise UsageError("the graph does not say which node is initial: initial=NODE")
        rows = []
        for source, target, data in graph.edges(data=True):
            if "input" not in data or "output" not in data:
                raise UsageError(f"the edge from {source!r} to {target!r} lacks `input` or `output`")
            rows.append((source, data["input"], data["output"], target))
        return Model.mealy(rows, start)

    def to_aalpy(self) -> Any:
        """AALpy's MealyMachine. Needs AALpy; export("mealy") is a text that AALpy reads."""
        from aalpy.automata import MealyMachine, MealyState  # type: ignore

        machine = self.to_mealy()
        states = [MealyState(f"s{number}") for number in range(len(machine))]
        for source, given, output, target in machine.transitions:
            states[source].transitions[given] = states[target]
            states[source].output_fun[given] = output
        return MealyMachine(states[machine.initial], states)

    @staticmethod
    def from_aalpy(machine: Any) -> "Model":
        """The model of AALpy's MealyMachine, or of anything that is built like one: `states`, an
        `initial_state`, and in each state `transitions` and `output_fun`, by input."""
        rows = []
        for state in machine.states:
            for given, target in state.transitions.items():
                rows.append((id(state), given, state.output_fun[given], id(target)))
        return Model.mealy(rows, id(machine.initial_state))


@dataclasses.dataclass
class Learned:
    """What learn() found out. `statistics` has all that `maide learn --json` tells."""

    model: Optional[Model]  # None: the run ended before the first hypothesis
    problem: str  # why the run ended early, one line; "": it did not
    weak: bool  # parts of the system may be missing from the model
    strength: Dict[str, Any]  # what the tests establish, in numbers
    guarantee: str  # the same in words
    algorithm: str
    output_queries: int  # asked by the learner
    equivalence_queries: int
    words: int  # run on the system, by learner and tests
    symbols: int  # inputs given to the system
    seconds: float
    statistics: Dict[str, Any]

    @property
    def complete(self) -> bool:
        """Whether the run came to its end."""
        return not self.problem

    def _repr_svg_(self) -> Optional[str]:
        return self.model.svg() if self.model is not None else None


# ---- Commands ----


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (list, tuple)):
        return ",".join(_text(one) for one in value)
    return str(os.fspath(value)) if isinstance(value, os.PathLike) else str(value)


class _Call:
    """A command line that is put together; models become files for as long as it is there."""

    def __init__(self, name: str):
        self.name = name
        self.options = _core.command_options(name)
        self.arguments: List[str] = []
        self.files: Optional[tempfile.TemporaryDirectory[str]] = None

    def __enter__(self) -> "_Call":
        return self

    def __exit__(self, *ignored: object) -> None:
        if self.files is not None:
            self.files.cleanup()

    def file_of(self, model: object) -> str:
        if not isinstance(model, Model):
            return _text(model)
        if self.files is None:
            self.files = tempfile.TemporaryDirectory(prefix="maide-")
        path = Path(self.files.name) / f"model{len(list(Path(self.files.name).iterdir()))}.dot"
        model.save(path)
        return str(path)

    def add_option(self, name: str, value: object) -> None:
        if value is None or (value is False and not self.options.get(name, True)):
            return
        if not self.options.get(name, True):
            self.arguments.append(f"--{name}")
            return
        for one in value if isinstance(value, (list, tuple)) else [value]:
            self.arguments += [f"--{name}", self.file_of(one)]

    def add(self, keywords: Mapping[str, object], of_system: Optional[Dict[str, object]]) -> None:
        """Options of the command; what is none of them is the system's, where there is one."""
        for key, value in keywords.items():
            name = key.rstrip("_").replace("_", "-")
            if of_system is not None and name not in self.options:
                of_system[name] = value
            else:
                self.add_option(name, value)

    def run(self, progress: Optional[Progress] = None,
            system: Optional[_core.ObjectSystem] = None) -> Tuple[Result, Any]:
        status, text, thrown = _core.run_command(self.name, self.arguments, progress, system)
        return Result(status, json.loads(text) if text else {}), thrown


def _error_of(result: Result) -> Error:
    kind = {2: UsageError, 4: SystemFailed}.get(result.__dict__["status"], Error)
    return kind(result.get("error", "nothing was found out"))


def _give(result: Result, thrown: Any) -> Result:
    if isinstance(thrown, KeyboardInterrupt):
        raise Interrupted(result) from thrown
    if thrown is not None:
        raise thrown
    if "error" in result and len(result) <= 3:  # schema, error, status: nothing was found out
        raise _error_of(result)
    return result


def command(name: str, *arguments: object, progress: Optional[Progress] = None,
            **options: object) -> Result:
    """Any command: command("doctor"), command("export", "via.dot", to="smv")."""
    with _Call(name) as call:
        call.arguments += [call.file_of(one) for one in arguments]
        call.add(options, None)
        return _give(*call.run(progress))


def check(system: PathLike, *, progress: Optional[Progress] = None, **options: object) -> Result:
    """Whether the programs of a system file deadlock or break a property.

    `verdict` is "holds", "violated" or "inconclusive"; `properties` has one entry each. Costs memory
    and time for each reachable state: some 5 bytes, a million states a second.
    """
    return command("check", system, progress=progress, **options)


def replay(system: PathLike, trace: Optional[PathLike] = None, *,
           progress: Optional[Progress] = None, **options: object) -> Result:
    """Whether the real middleware does what a trace says (check(..., trace=FILE) writes it), or, with
    random=N, what the models say in N random runs."""
    return command("replay", system, *([] if trace is None else [trace]), progress=progress, **options)


def compare(a: Union[Model, PathLike], b: Union[Model, PathLike], **options: object) -> Result:
    """Whether two models are the same; if not, a shortest word that tells them apart, and all
    `differences`. `status` is 1 for a contradiction, with strict=True also for what one model knows
    and the other never tried. html=FILE draws both in one picture."""
    return command("compare", a, b, progress=None, **options)


def _alphabet(system: Any, inputs: Optional[Iterable[object]]) -> List[object]:
    if inputs is None:
        inputs = getattr(system, "inputs", None)
        inputs = inputs() if callable(inputs) else inputs
    if inputs is None:
        raise TypeError("the object's inputs are not known: inputs=[...], or an attribute `inputs`")
    return list(inputs)


class _Worker:
    """A thread that makes one call at a time."""

    def __init__(self) -> None:
        self.calls: "queue.SimpleQueue[Optional[Callable[[], Any]]]" = queue.SimpleQueue()
        self.results: "queue.SimpleQueue[Tuple[bool, Any]]" = queue.SimpleQueue()
        threading.Thread(target=self._run, name="maide step", daemon=True).start()

    def _run(self) -> None:
        for call in iter(self.calls.get, None):
            try:
                self.results.put((True, call()))
            except BaseException as error:  # it is raised again, where the call was asked for
                self.results.put((False, error))

    def make(self, call: Callable[[], Any], seconds: Optional[float]) -> Any:
        """What the call returns. Raises what it raises, or queue.Empty after so many seconds."""
        self.calls.put(call)
        is_returned, value = self.results.get(timeout=seconds)
        if is_returned:
            return value
        raise value


class _TimedSystem:
    """A system whose step() may take so many seconds. One that takes longer answers "hang", as all
    inputs behind it do; its thread is left alone, and the next word has a new one."""

    def __init__(self, system: Any, seconds: float):
        if hasattr(system, "query_many"):
            raise UsageError("step_time= goes with reset() and step(), not with query_many()")
        if not seconds > 0:
            raise UsageError(f"step_time= is a positive number of seconds, not {seconds}")
        self._system = system
        self._seconds = seconds
        self._worker: Optional[_Worker] = None

    def reset(self) -> None:
        if self._worker is None:
            self._worker = _Worker()
        self._worker.make(self._system.reset, None)

    def step(self, given: Any) -> Any:
        if self._worker is None:
            return "hang"
        try:
            return self._worker.make(lambda: self._system.step(given), self._seconds)
        except queue.Empty:
            self._end()
            return "hang"

    def _end(self) -> None:
        if self._worker is not None:
            self._worker.calls.put(None)
            self._worker = None

    __del__ = _end


def _object_system(system: Any, inputs: Optional[Iterable[object]], reference: Optional[Model],
                   step_time: Optional[float]) -> _core.ObjectSystem:
    kind = type(system)
    name = f"python:{kind.__module__}.{kind.__qualname__}"
    known = None if reference is None else reference.to_mealy()._core
    alphabet = _alphabet(system, inputs)
    if step_time is not None:
        system = _TimedSystem(system, step_time)
    return _core.ObjectSystem(system, alphabet, name, known)


def _run_on_system(call: _Call, system: Any, inputs: Optional[Iterable[object]],
                   reference: Optional[Model], progress: Optional[Progress],
                   step_time: Optional[float],
                   keywords: Mapping[str, object]) -> Tuple[Result, Any]:
    """Runs a command whose system is a name with options, or an object."""
    if system is not None and not isinstance(system, (str, os.PathLike)):
        made = _object_system(system, inputs, reference, step_time)
        call.arguments.append(made.text)
        call.add(keywords, None)
        return call.run(progress, made)
    if reference is not None:
        raise UsageError("reference= goes with an object")
    if step_time is not None:
        raise UsageError("step_time= goes with an object")
    of_system: Dict[str, object] = {}
    if inputs is not None:
        of_system["inputs"] = inputs if isinstance(inputs, str) else list(inputs)
    call.add(keywords, of_system)
    if system is not None:
        call.arguments += [_text(system), *(f"{key}={_text(value)}" for key, value in of_system.items())]
    elif of_system:
        raise UsageError(f"no option {next(iter(of_system))!r} (see 'maide {call.name} --help')")
    return call.run(progress)


def learn(system: Any, *, inputs: Optional[Iterable[object]] = None,
          reference: Optional[Model] = None, progress: Optional[Progress] = None,
          step_time: Optional[float] = None, **options: object) -> Learned:
    """Learns a model of a running system.

    system    a name, as `maide learn` takes it ("cyclonedds", "sim:model.dot", "tcp://robot:5000"),
              whose options are keywords; or an object with reset() and step(input), which returns
              the output; or one with query_many(words), which returns the outputs of each word
    inputs    of an object: what it takes; default: its attribute `inputs`. They may be anything
              hashable, as outputs may. The model names both by str(); None is no output ("quiet")
    reference of an object: the machine that it is, for eq="perfect"
    progress  called at most ten times a second, with phase, states, words, symbols, done, total
    step_time of an object: how many seconds step() may take. One that takes longer answers "hang",
              and so do all inputs behind it in that word
    options   algorithm=, eq=, seed=, cache=, max_experiments=, time=, strength=, effort=, as_=,
              start_from= (a file or a Model), error_output=, confirm=, ...

    The object must answer a word in the same way whenever it is asked, after reset(). It is called
    on this thread; with step_time= on another one. There a step() that hangs is left behind, so
    reset() must not wait for it. What it raises is raised again, and a system that fails raises SystemFailed; the
    exception's `learned` is what was learned. A limit (time=) and a system that stays
    nondeterministic are no exceptions: Learned.problem tells of them.

    Costs the words of the learner and, most of them, of the tests (docs/testing.md): at most 20,000
    words and a million symbols a test of a hypothesis, `effort` times that. A symbol costs at most
    2 microseconds beside step() itself.
    """
    with _Call("learn") as call:
        result, thrown = _run_on_system(call, system, inputs, reference, progress, step_time, options)
        learned = _read_learned(result)
    if isinstance(thrown, KeyboardInterrupt):
        raise Interrupted(result, learned) from thrown
    failure = thrown
    if failure is None and learned is not None and result.__dict__["status"] in (0, 3):
        return learned
    if failure is None:
        failure = _error_of(result)
    try:
        failure.learned = learned
    except AttributeError:  # a class with slots
        pass
    raise failure


def _read_learned(result: Result) -> Optional[Learned]:
    if "experiments" not in result:
        return None
    model = None
    if "dot" in result:
        model = Model.parse(result["dot"])
    elif result.get("model"):
        model = Model.read(result["model"])
    strength = result.get("strength") or {}
    return Learned(model=model, problem=result.get("error", ""), weak=strength.get("weak", True),
                   strength=strength, guarantee=result["guarantee"], algorithm=result["algorithm"],
                   output_queries=result["output_queries"],
                   equivalence_queries=result["equivalence_queries"],
                   words=result["experiments"], symbols=result["symbols"],
                   seconds=result["seconds"], statistics=dict(result))


def test(model: Union[Model, PathLike], system: Any = None, *,
         inputs: Optional[Iterable[object]] = None, progress: Optional[Progress] = None,
         step_time: Optional[float] = None, **options: object) -> Result:
    """Whether a running system, a name or an object as in learn(), does what a model says.

    Without a system it is the one that the model names. `verdict` is "conforms", "differs" or "not
    finished"; `failures` has the shortest words. Options: max_tests=, time=, seed=, junit=, ...
    """
    with _Call("test") as call:
        call.arguments.append(call.file_of(model))
        return _give(*_run_on_system(call, system, inputs, None, progress, step_time, options))


class System:
    """A system of Maide's that answers words: a wrapper's, or a simulated model.

        with maide.System("zeromq", conflate=True) as system:
            system.query(["write", "read"])          # ["quiet", "message"]
            system.query_many(words)                 # several at once, on jobs=N systems

    Every word begins after a reset. An output is what comes until the system rests, several joined by
    commas. Raises UsageError for an unknown input, SystemFailed if the system fails.
    """

    def __init__(self, name: str, *, jobs: int = 0, **options: object):
        self._core = _core.System(name, [f"{key.rstrip('_')}={_text(value)}"
                                         for key, value in options.items()], jobs)
        self.name: str = self._core.name
        self.inputs: List[str] = self._core.inputs
        self.options: Dict[str, str] = self._core.options
        self.versions: Dict[str, str] = self._core.versions

    def query(self, word: Sequence[str]) -> List[str]:
        """The outputs to a word, one for each input."""
        return self.query_many([word])[0]

    def query_many(self, words: Sequence[Sequence[str]]) -> List[List[str]]:
        """The outputs to each word. One call costs one round trip, whatever the number of words."""
        return self._core.query_many([list(word) for word in words])

    def close(self) -> None:
        """Ends the system's processes."""
        self._core.close()

    def __enter__(self) -> "System":
        return self

    def __exit__(self, *ignored: object) -> None:
        self.close()


def _tell_where_wrappers_are() -> None:
    """Beside this package, where it was built or installed."""
    for folder in Path(__file__).resolve().parents:
        for place in (folder / "libexec" / "maide", folder / "bin"):
            if any(place.glob("maide-wrap-*")):
                _core.look_for_wrappers_in(str(place))
                return


_tell_where_wrappers_are()
