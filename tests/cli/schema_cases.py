"""The command lines of check_schemas.py: every command, and the branches of what each prints.

A case is an exit status and a command line of maide, as a shell reads it; behind `!` stands a shell's line that
prepares the next ones. Cases run in one folder in this order, so later ones read what earlier ones wrote. {models},
{examples}, {tests} and {bin} stand for folders of the project.
"""
import json
import shutil
import subprocess

FILES = {
    "holds.yaml": """
models: {via: {file: "{models}/strict-3.dot"}, sync: {file: "{models}/buffered.dot"}}
programs:
  p: via.write;
  q: via.read -> message;
properties: {done: F q@end, end: {possible: q@end}}
""",
    "violated.yaml": """
models:
  via: {learn: port, with: {kind: buffered}}
  sync: {learn: port, with: {kind: buffered}}
programs:
  planner: |
    var n: 0..3;
    loop { repeat 2 { via.write; n = (n + 1) % 4; } sync.read -> message; }
  controller: |
    var heard: bool;
    loop { repeat 2 { via.read -> message; heard = true; } sync.write; }
""",
    "robot.cpp": """#include <rclcpp/rclcpp.hpp>
struct A : rclcpp::Node { A() : Node("a") {} };
""",
    "holes.cpp": """#include <rclcpp/rclcpp.hpp>
struct A : rclcpp::Node { A() : Node("a") { vendor::look_at(this); } };
""",
    "counted.yaml": """
constants: {n: 1}
programs: {a: "repeat n { skip; }"}
properties: {never: "G !a@end"}
""",
    "filled.yaml": """
models: {q: {use: queue, with: {depth: 1}}}
programs: {a: "q.write; q.write;", b: "q.read -> message; q.read -> message;"}
properties: {sometimes: {possible: a@end}, never: {possible: "a@end && !a@end"}}
""",
    "never.yaml": """
models: {via: {file: "{models}/buffered.dot"}}
programs:
  p: loop { via.write; via.read -> message; }
properties: {done: F p@end, again: F p@end}
""",
    "lossy.dot": """digraph g {
  inputs="write,read"; outputs="message,null";
  actors="writer: ?write; reader: ?read !message !null"; sul="sim:lossy.dot";
  __start0 -> a; a -> b [label="?write"]; b -> c [label="?read"]; b -> d [label="?read"];
  c -> e [label="!message"]; d -> e [label="!null"];
}
""",
    "lossy.yaml": """
models: {via: {file: lossy.dot}}
programs:
  p: |
    via.write;
    switch via.read { message { stop; } null { via.read; } }
""",
    "queued.yaml": """
models:
  via: {learn: port, with: {kind: buffered}}
  m: {use: queue, with: {size: 1}}
programs:
  p: via.write; m.read -> message;
  q: via.read -> message;
""",
    "refined.yaml": """
models:
  via: {learn: port, with: {kind: strict, size: 3}, learning: {eq: random-words, max-tests: 0}}
programs:
  planner: repeat 3 { via.write; }
  controller: repeat 3 { via.read -> message; }
""",
    "one.dot": 'digraph { inputs="x"; s0; s0 -> s1 [label="x / 0"]; s1 -> s0 [label="x / 1"]; }',
    "changed.dot": 'digraph { inputs="x"; s0; s0 -> s1 [label="x / 0"]; s1 -> s0 [label="x / 3"]; }',
    "two.dot": 'digraph { inputs="x,y"; s0; s0 -> s1 [label="x / 0"]; s1 -> s0 [label="x / 2"];'
               ' s0 -> s0 [label="y / 0"]; s1 -> s1 [label="y / 0"]; }',
    "coin.dot": 'digraph { s0; s0 -> s0 [label="look / heads"]; s0 -> s0 [label="look / tails"]; }',
    "loaded.dot": 'digraph { s0; s0 -> s0 [label="look / heads"]; }',
    "dfa.dot": 'digraph { s0 [shape=doublecircle]; s1; s0 -> s1 [label="x"]; s1 -> s0 [label="x"]; }',
    "other-dfa.dot": 'digraph { s0; s1 [shape=doublecircle]; s0 -> s1 [label="x"]; s1 -> s0 [label="x"]; }',
    "bench/good.dot": 'digraph { s0; s0 -> s1 [label="x/0"]; s1 -> s0 [label="x/1"]; }',
    # Of the name and size of a model for which other tools have published figures.
    "bench/coffeemachine.dot": "digraph { " + " ".join(
        f's{state} -> s{(state + (name == "a")) % 6} [label="{name} / {state}"];'
        for state in range(6) for name in "abcd") + " }",
    "tested/DropBear.dot": "digraph { " + " ".join(
        f's{state} -> s{(state + (name == "a")) % 17} [label="{name} / {state}"];'
        for state in range(17) for name in "abcdefghijklm") + " }",
    "unreadable/good.dot": 'digraph { s0; s0 -> s1 [label="x/0"]; s1 -> s0 [label="x/1"]; }',
    "unreadable/bad.dot": "digraph {",
    "log": "\n".join(json.dumps(trace) for trace in
                     ([["write", "quiet"], ["read", "message"]], [["read", "quiet"], ["read", "refused"]])),
    "wrong-log": json.dumps([["write", "quiet"], ["read", "lie"]]),
    "wired.yaml": """
models: {wire: {use: queue, with: {size: 1}}, box: {use: queue, with: {size: 1}}}
programs:
  planner: box.read -> message;
  camera: wire.write;
properties: {lost: "G !planner@end"}
""",
    "untidy.yaml": "models: {via: {file: one.dot}}\nprograms: {p: via.x;}\n",
    # The wrapper of the reference port, which dies once, whatever it is asked.
    "dying.py": """
import os, subprocess, sys, threading
port = subprocess.Popen(["{bin}/maide-wrap-port"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
def pass_on():
    for line in port.stdout:
        sys.stdout.buffer.write(line)
        sys.stdout.buffer.flush()
threading.Thread(target=pass_on, daemon=True).start()
for number, line in enumerate(sys.stdin.buffer):
    if number == 20 and not os.path.exists("died"):
        open("died", "w").close()
        port.kill()
        os._exit(1)
    port.stdin.write(line)
    port.stdin.flush()
port.stdin.close()
port.wait()
""",
    "graph.json": json.dumps({
        "rmw": "rmw_cyclonedds_cpp", "settled": True, "nodes": [{"name": "/a", "process": "1"}],
        "topics": [{"name": "/t", **{ends: [{
            "node": "/a", "type": "std_msgs/msg/UInt64", "reliability": "reliable", "durability": "volatile",
            "history": "keep_last", "depth": 3, "deadline": 0.5, "liveliness": "automatic", "lease": 2.0}]
            for ends in ("publishers", "subscriptions")}}],
        "services": [{"name": "/s", "type": "std_srvs/srv/Trigger", "servers": ["/a"], "clients": ["/a"], "depth": 10}],
        "actions": []}),
    # A second answer to the first word of a cache.
    "lie.py": """
import sqlite3, sys
cache = sqlite3.connect(sys.argv[1])
inputs, outputs = cache.execute("SELECT inputs, outputs FROM words WHERE length(inputs) > 1").fetchone()
lie = bytes([1 - outputs[0]]) + outputs[1:]
cache.execute("INSERT INTO words (inputs, outputs) VALUES (?, ?)", (inputs + bytes(40), lie + bytes(40)))
cache.commit()
""",
}

CASES = r"""
0 learn port kind=strict size=2 -o port.dot --cache port.cache
0 learn port kind=strict size=3 -o larger.dot
0 learn sim:{models}/strict-3.dot --eq perfect --as mealy
0 learn sim:{models}/strict-3.dot --translation av -o av.dot
0 learn sim:{models}/strict-2.dot --start-from {models}/strict-3.dot -o started.dot
0 learn sim:{models}/strict-2.dot --start-from {models} -o known.dot
3 learn sim:{models}/strict-2.dot --start-from {models} --max-experiments 3
0 learn sim:{models}/strict-6.dot --eq random-words --max-tests 3 -o weak.dot
3 learn sim:{models}/strict-6.dot --eq random-words --max-tests 3 --strength random=5000
3 learn sim:{models}/strict-6.dot --max-experiments 20
3 learn sim:{models}/nondeterministic/lossy.dot
0 learn sim:{models}/nondeterministic/lossy.dot --algorithm nstar -o nondeterministic.dot
0 learn exec:{bin}/fragile_wrapper --eq random-words --max-tests 50 -o lamp.dot
0 learn 'exec:{python} dying.py' kind=strict size=1 --jobs 1 -o dying.dot
3 learn sim:tested/DropBear.dot --strength extra-states=9
0 learn --from-traces log
0 learn --from-traces log -o passive.dot
0 learn sim:{models}/strict-2.dot --from-traces wrong-log
0 learn port --list-options
0 learn sim:one.dot --cache one.cache -o learned-one.dot
2 learn prot
4 learn exec:/bin/false
0 extract robot.cpp --assume ok,exceptions,read
3 extract robot.cpp
2 extract robot.yaml
0 check robot.cpp --assume ok,exceptions,read
3 extract holes.cpp --assume ok,exceptions,read
3 check holes.cpp
0 check holds.yaml
1 check violated.yaml --trace trace.json --suggest
1 check violated.yaml --engine native --property deadlock
1 check never.yaml --suggest
0 check {examples}/architectures/pipeline-mended.yaml
1 check {examples}/architectures/notice.yaml
0 check {examples}/architectures/notice-mended.yaml
0 check {examples}/architectures/hundred-robots.yaml
3 check {examples}/case-study-2/nonblocking-drop.yaml --time 0.001 --engine native
0 check refined.yaml --engine native --property deadlock --refine
1 check lossy.yaml --trace lossy.json
1 check queued.yaml --property deadlock --trace queued.json
1 check counted.yaml --set n=3 --junit counted.xml --trace counted.json
2 check counted.yaml --set k=3
1 check counted.yaml --every n=1..3
1 check filled.yaml --every q.depth
2 check counted.yaml --every k
2 check nowhere.yaml
0 simulate violated.yaml --seed 3
0 simulate counted.yaml --set n=3 --steps 1
2 simulate nowhere.yaml
0 replay violated.yaml trace.json --rounds 2
0 replay violated.yaml --random 2 --steps 20
3 replay lossy.yaml lossy.json --rounds 40
3 replay queued.yaml queued.json
2 replay violated.yaml
0 compare port.dot port.dot
0 compare port.dot larger.dot --html page.html
1 compare port.dot larger.dot --strict
1 compare {models}/buffered.dot {models}/strict-3.dot
0 compare one.dot one.dot
1 compare one.dot two.dot --html two.html
0 compare one.dot sim:one.dot
1 compare dfa.dot other-dfa.dot
0 compare coin.dot coin.dot
1 compare coin.dot loaded.dot --html coin.html
1 compare nondeterministic.dot {models}/buffered-tryread.dot
0 compare port.dot port kind=strict size=3
2 compare port.dot
0 test port.dot --junit passed.xml
1 test {models}/strict-2.dot sim:{models}/buffered.dot --junit failed.xml --html failed.html
3 test {models}/strict-6.dot sim:{models}/strict-6.dot --max-tests 1 --junit unfinished.xml
1 test one.dot sim:two.dot --junit inputs.xml
2 test one.dot
0 export port.dot --to promela
0 export port.dot --to aut --lossy -o port.aut
0 export {examples}/case-study-1/buffered.yaml --to promela
0 export {examples}/case-study-1/buffered.yaml --to promela -o buffered.pml
2 export port.dot --to nothing
1 format --check untidy.yaml
0 format untidy.yaml
2 format nowhere.yaml
2 format --nonsense
2 format untidy.yaml nowhere.yaml
0 view port.dot -o port.html
0 view holds.yaml -o holds.html
0 view trace.json -o trace.svg
0 view holds.yaml --stage names
0 view violated.yaml --stage models -o models.json
0 view models.json --stage system -o system.json
0 view system.json --stage tree
1 check system.json
! {bin}/maide view wired.yaml --stage system | {python} {tests}/cli/add_nobody.py >nobody.json
1 check nobody.json --trace nobody-trace.json
0 simulate nobody.json
0 view nobody.json -o nobody.html
2 view port.aut.gz
0 reproduce table1 --system port
0 reproduce interrupt --system port
2 reproduce table9
0 cache show port.cache
0 cache merge one.cache one.cache -o merged.cache
0 cache check port.cache --system 'port kind=strict size=2'
! cp port.cache wrong.cache && {python} lie.py wrong.cache
! cp port.cache torn.cache && truncate --size=-4096 torn.cache
1 cache merge port.cache wrong.cache -o none.cache
0 cache show wrong.cache
1 cache check port.cache wrong.cache
2 cache check port.cache torn.cache
! cp changed.dot one.dot
1 cache check one.cache --system sim:one.dot
2 cache look port.cache
0 bench bench --algorithm lsharp
0 bench tested --algorithm lsharp --eq hads
2 bench unreadable --algorithm lsharp --csv bench.csv
3 bench tested --algorithm lsharp --time 0.001
2 bench nowhere
0 init first.yaml --system port
2 init first.yaml
0 new wrapper --tcp 127.0.0.1:6379 --input 'GET a'
0 new wrapper --tcp 127.0.0.1:6379 --input 'GET a' --cpp -o server.cpp
2 new wrapper
0 ros2 import --graph {tests}/systems/ros2-graph.json
0 ros2 import --graph graph.json
2 ros2 import --graph nowhere.json
0 completion bash
2 completion tcsh
0 manual check
! mkdir man
0 manual --all -o man
2 manual --all
0 doctor
1 doctor ros2 {tests}/systems/ros2-graph.json
2 doctor corba
"""

# What no case prints, with all that is in it, and why. `#1` is the first kind of result in a schema.
CTRL_C = "printed after Ctrl-C alone"
NOT_PRINTED = {
    "check#1.error": CTRL_C, "check#1.status": CTRL_C,
    "check#2.error": CTRL_C, "check#2.status": CTRL_C,
    "replay#1.error": CTRL_C, "replay#1.status": CTRL_C,
    "simulate#1.error": CTRL_C, "simulate#1.status": CTRL_C,
    "bench#1.error": CTRL_C, "bench#1.status": CTRL_C,
    "check#1.properties[].internal_error": "printed after an error of Maide's own",
    "bench#1.peer_means[]": "needs 41 models that are not in the tree",
    "test#1.unsteady[]": "needs an answer that is wrong each time it is asked again at once, and right later",
    "reproduce#2": "takes minutes; tests/case_studies runs it",
    **{"reproduce#3.systems[].from_expected." + member: "needs YARP" for member in ("word", "here", "expected")},
}


def has_known_cppcheck():
    """Whether `maide extract` has a front end here."""
    if shutil.which("cppcheck") is None:
        return False
    return "2.10" in subprocess.run(["cppcheck", "--version"], capture_output=True, text=True).stdout


if not has_known_cppcheck():
    CASES = "\n".join(line for line in CASES.splitlines() if ".cpp" not in line)
    NOT_PRINTED["extract#1"] = NOT_PRINTED["check#1.extracted"] = "needs cppcheck 2.10"
