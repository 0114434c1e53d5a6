"""Small systems of programs with several open requests.

    calls.py [--maide PROGRAM] [--write FOLDER]

As cases.py. States, transitions and verdicts were derived by hand.
"""

from __future__ import annotations

import sys

from cases import HANGS, RUNS, Case, main, threads

CALL = """
models: {{m: {{use: mutex}}}}
topics: {{go: {{writers: client, readers: server, use: queue, with: {{depth: 1}}}}}}
services: {{s: {{server: server, clients: [client], with: {{depth: {depth}}}{delivery}}}}}
programs:
  server: "{server}"
  client: "{client}"
"""
ONCE = "s.serve -> request; s.answer;"
FOR_EVER = f"loop {{ idle {ONCE} }}"
RECEIVES = "s.receive -> answer;"
TRIES = "s.send; select { on s.receive -> answer { stop; } timeout 100 { } } "
GETS = {**RUNS, "got": "holds"}
NEVER = {**HANGS, "got": "violated", "never": "holds"}
ENDS = {"got": '"F client@end"', "never": '"G !client@end"'}


def call(name: str, server: str, client: str, verdicts: dict, sizes: list | None = None,
         depth: int = 10, delivery: str = "", **own: str) -> Case:
    """A program that serves, and one that asks."""
    text = CALL.format(server=server, client=client, depth=depth, delivery=delivery)
    asked = {key: ENDS[key] for key in verdicts if key in ENDS}
    return Case(name, text, verdicts, {**asked, **own}, sizes)


# The first of two requests is pushed out before the server looks.
LATE_SERVER = f"go.read -> message; {ONCE}"
TWICE = "s.send; s.send; go.write; "

COUNTS = """
services: {{s: {{server: server, clients: [client]{delivery}}}}}
variables: "var served: 0..2;"
programs:
  server: "loop {{ idle s.serve -> request; served = served + 1; s.answer; }}"
  client: "{client}"
"""


def counts(name: str, client: str, verdict: str, delivery: str = "") -> Case:
    """Whether the server has served two requests before the client is at its end."""
    text = COUNTS.format(client=client, delivery=delivery)
    return Case(name, text, {**RUNS, "two": verdict}, {"two": '"G (client@end -> served == 2)"'})


OUT_OF_ORDER = """
services: {{s: {{server: n, clients: [client]}}}}
executors: {{e: {executor}}}
programs: {{client: "{client}"}}
nodes:
  n:
    executor: e
    groups: {{free: reentrant}}
    callbacks: {{find: {{serves: s, group: free, do: "s.answer;"}}}}
"""

TWO_CLIENTS = """
services: {s: {server: server, clients: [a, b]}}
programs:
  server: "loop { idle s.serve -> request; s.answer; }"
  a: "s.send; s.send; s.receive -> answer; s.receive -> answer;"
  b: "s.send; wait s -> answer;"
"""

CASES = [
    # Before the write three places of the client beside two of the server (it may read before);
    # then two, waiting or not, beside six. What is answered is not what is waited for.
    call("a request that is pushed out is not completed by the next", LATE_SERVER,
         TWICE + RECEIVES, NEVER, [(18, 25)], depth=1),
    # The same six, six with the client waiting, and the end.
    call("the last request is waited for", LATE_SERVER, TWICE + "wait s -> answer;", GETS,
         [(13, 15)], depth=1),
    call("both requests fit", LATE_SERVER, TWICE + RECEIVES, GETS, depth=2),
    # Waiting for the last gives the other up, whose answer is thrown away.
    call("after the last no other is there", FOR_EVER,
         f"s.send; s.send; wait s -> answer; {RECEIVES}", NEVER),
    call("a receive in two halves", FOR_EVER, f"s.send; s.send; s.receive; wait s -> answer; "
         f"{RECEIVES}", GETS),
    call("a receive without a request", FOR_EVER, RECEIVES, NEVER),
    call("no arm without a request", FOR_EVER, f"select {{ on {RECEIVES[:-1]} {{ @got stop; }} "
         "timeout 5 { } }", {**RUNS, "got": "holds"}, got='"G !client@got"'),
    # The first is answered, and no other.
    call("a time-out gives nothing up", ONCE, TRIES + RECEIVES, GETS),
    call("a request after a time-out gives the first one up", ONCE, TRIES + f"s.send; {RECEIVES}",
         {**HANGS, "got": "violated"}),
    call("the same, late", ONCE, TRIES + f"s.send; {RECEIVES}", {**HANGS, "got": "violated"},
         delivery=", delivery: late"),
    call("'otherwise' gives nothing up", ONCE, TRIES.replace("timeout 100", "otherwise")
         + f"s.send; {RECEIVES}", GETS),
    call("another arm gives nothing up", ONCE, "s.send; select { on s.receive -> answer { stop; } "
         f"on m.lock {{ }} timeout 9 {{ stop; }} }} s.send; {RECEIVES}", GETS),
    call("a time-out of who waits for the last gives nothing up", ONCE, "s.send; select { "
         f"on s!answer {{ stop; }} timeout 9 {{ }} }} s.send; {RECEIVES}", GETS),
    # What answers the second stays in the queue, where the arm for the first cannot be taken.
    call("an arm for the oldest request alone", LATE_SERVER, TWICE + "select { "
         "on s.receive -> answer { @early stop; } timeout 9 { } } wait s -> answer;",
         {**GETS, "early": "holds"}, depth=1, early='"G !client@early"'),
    counts("two requests, and the answer to the first", f"s.send; s.send; {RECEIVES}", "violated"),
    counts("two requests, and both answers", f"s.send; s.send; {RECEIVES} {RECEIVES}", "holds"),
    counts("two requests, and the answer to the last", "s.send; s.send; wait s -> answer;",
           "holds"),
    counts("a request twice, for it came too late", "s.send; select { on s.receive -> answer "
           "{ s.send; } timeout 9 { s.send; } } s.receive -> answer;", "holds"),
    counts("the same, and late", "s.send; select { on s.receive -> answer { s.send; } timeout 9 "
           "{ s.send; } } s.receive -> answer;", "holds", ", delivery: late"),
    # The answer to the second may come first, and is kept.
    Case("answers out of order", OUT_OF_ORDER.format(
        executor=threads(2), client=f"s.send; s.send; {RECEIVES} {RECEIVES}"),
         {**RUNS, "got": "holds"}, {"got": ENDS["got"]}),
    Case("the last one's answer first", OUT_OF_ORDER.format(
        executor=threads(2), client=f"s.send; s.send; wait s -> answer; {RECEIVES}"),
         {**HANGS, "never": "holds"}, {"never": ENDS["never"]}),
    Case("two clients' answers", TWO_CLIENTS, {**RUNS, "a": "holds", "b": "holds"},
         {"a": '"F a@end"', "b": '"F b@end"'}),
]  # fmt: skip


if __name__ == "__main__":
    sys.exit(main(CASES))
