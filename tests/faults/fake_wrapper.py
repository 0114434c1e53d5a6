"""A wrapper that misbehaves in one chosen way: fake_wrapper.py FAULT [FILE].

Its system is a lamp with one input, `press`, which answers `on` and `off` in turn. Each function
below is a fault; what is not at fault is done right.
"""

import json
import os
import subprocess
import sys
import time

HELLO = {"type": "hello", "protocol": 1, "name": "lamp", "versions": {"lamp": "1"}, "features": []}
INFO = {"type": "info", "inputs": ["press"], "outputs": ["on", "off"]}


def send(message):
    sys.stdout.write(json.dumps(message) + "\n")
    sys.stdout.flush()


def send_text(text):
    sys.stdout.buffer.write(text if isinstance(text, bytes) else text.encode())
    sys.stdout.flush()


def answer(query):
    steps = [{"events": ["on" if i % 2 == 0 else "off"]} for i in range(len(query["word"]))]
    return {"type": "answer", "id": query["id"], "steps": steps}


def die(words):
    sys.stderr.write(words + "\n")
    sys.stderr.flush()
    os._exit(3)


def serve(on_run, hello=HELLO, info=INFO, on_end=lambda: None):
    send(hello)
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "configure":
            send(info)
        elif message["type"] == "run":
            on_run(message)
        elif message["type"] == "bye":
            break
    on_end()


def answer_with(change):
    """Serves, with every answer changed."""
    def on_run(query):
        message = answer(query)
        change(message)
        send(message)
    serve(on_run)


# ---- Before the first word ----

def no_hello():
    time.sleep(1000)


def garbage_hello():
    send_text("Segmentation fault? Not me!\n")
    time.sleep(1000)


def wrong_version():
    send({**HELLO, "protocol": 7})
    time.sleep(1000)


def info_first():
    send(INFO)
    time.sleep(1000)


def endless_line():
    while True:
        send_text("x" * 65536)


def dies_at_start():
    die("cannot find the middleware's daemon")


def dies_at_starts():
    """Before its hello, until as many starts as FILE has bytes are over; takes a byte for each."""
    with open(sys.argv[2], "r+") as file:
        left = file.read()
        file.seek(0)
        file.truncate(max(0, len(left) - 1))
    if left:
        os.kill(os.getpid(), 9)
    serve(lambda query: send(answer(query)))


def cut_hello():
    send_text('{"type": "hel')


def no_answer_to_options():
    send(HELLO)
    time.sleep(1000)


def rejects_options():
    send(HELLO)
    sys.stdin.readline()
    send({"type": "error", "code": "option", "message": "option color: no such color"})
    time.sleep(1000)


def cannot_configure():
    send(HELLO)
    sys.stdin.readline()
    send({"type": "error", "code": "system", "message": "no licence for the lamp"})
    time.sleep(1000)


def no_inputs():
    serve(None, info={**INFO, "inputs": []})


def input_of_nobody():
    serve(None, info={**INFO, "inputs": [{"name": "press", "actor": "ghost"}]})


def declares_quiet():
    serve(None, info={**INFO, "outputs": ["on", "quiet"]})


def declares_delta():
    serve(None, info={**INFO, "inputs": ["press", "Delta"]})


def inputs_of_a_wrong_type():
    serve(None, info={**INFO, "inputs": {"press": 1}})


# ---- In a word ----

def garbage_answer():
    serve(lambda query: send_text("42 is not an object? [\n"))


def number_answer():
    serve(lambda query: send_text("42\n"))


def binary_answer():
    serve(lambda query: send_text(b"\x00\xff\xfe\n"))


def deep_answer():
    serve(lambda query: send_text("[" * 1000000 + "\n"))


def cut_answer():
    def on_run(query):
        send_text('{"type": "answer", "id": 1, "ste')
        os._exit(0)
    serve(on_run)


def wrong_id():
    answer_with(lambda message: message.update(id=99))


def negative_id():
    answer_with(lambda message: message.update(id=-1))


def unknown_event():
    answer_with(lambda message: message["steps"].append({"events": ["boom"]}))


def unknown_actor():
    answer_with(lambda message: message["steps"][0].update(events=[["ghost", "on"]]))


def too_many_steps():
    answer_with(lambda message: message["steps"].append({"events": []}))


def too_few_steps():
    answer_with(lambda message: message["steps"].pop())


def unknown_status():
    answer_with(lambda message: message["steps"][0].update(status="bored"))


def unknown_type():
    answer_with(lambda message: message.update(type="question"))


def second_hello():
    serve(lambda query: send(HELLO))


def system_error():
    serve(lambda query: send({"type": "error", "code": "system", "message": "the bulb is\ngone",
                              "id": query["id"]}))


def hangs():
    serve(lambda query: time.sleep(1000), info={**INFO, "options": {"step-limit": "100"}})


def endless_limit():
    """Slow, and says that a step may take longer than there are milliseconds in 64 bits."""
    def on_run(query):
        time.sleep(0.2)
        send(answer(query))
    serve(on_run, info={**INFO, "options": {"step-limit": str(2**63 - 1)}})


def dies_in_word():
    serve(lambda query: die("first words\nbulb burst"))


def is_killed_in_word():
    serve(lambda query: os.kill(os.getpid(), 9))


def closes_output():
    def on_run(query):
        os.close(1)
        time.sleep(1000)
    serve(on_run)


def leaves_at_once():
    def on_run(query):
        send({"type": "leaving", "reason": "tired"})
        os._exit(0)
    serve(on_run)


def reserved_output():
    serve(lambda query: send({"type": "answer", "id": query["id"],
                              "steps": [{"events": ["refused"]} for _ in query["word"]]}),
          info={**INFO, "outputs": [], "open_outputs": True})


def too_many_events():
    answer_with(lambda message: message["steps"][0].update(events=["on"] * 1001))


def leaves_for_ever():
    def on_run(query):
        while True:
            send({"type": "leaving", "reason": "tired"})
    serve(on_run)


def dies_before_its_child():
    """The child holds the wrapper's output open, but is not the wrapper."""
    def on_run(query):
        subprocess.Popen(["sleep", "1000"])
        die("orphans!")
    serve(on_run)


# ---- Faults that are survived ----

def dies_once():
    """In its third word, if FILE is not there yet."""
    count = [0]

    def on_run(query):
        count[0] += 1
        if count[0] == 3 and not os.path.exists(sys.argv[2]):
            open(sys.argv[2], "w").close()
            die("once")
        send(answer(query))
    serve(on_run)


def leaves_after_each_word():
    def on_run(query):
        send(answer(query))
        send({"type": "leaving", "reason": "one word a day"})
        os._exit(0)
    serve(on_run)


def out_of_order():
    """Two answers at a time, the second first."""
    kept = []

    def on_run(query):
        kept.append(query)
        if len(kept) == 2:
            for late in reversed(kept):
                send(answer(late))
            kept.clear()
    serve(on_run)


def flood_of_errors():
    def on_run(query):
        sys.stderr.write("warning: the lamp is warm\n" * 20000)
        send(answer(query))
    serve(on_run)


def slow_bytes():
    def on_run(query):
        for letter in json.dumps(answer(query)) + "\n":
            send_text(letter)
    serve(on_run)


def new_outputs():
    def on_run(query):
        send({"type": "answer", "id": query["id"],
              "steps": [{"events": ["glow"]} for _ in query["word"]]})
    serve(on_run, info={**INFO, "outputs": [], "open_outputs": True})


def never_ends():
    """Ignores bye and the end of its input, and has a child; FILE gets both numbers."""
    child = subprocess.Popen(["sleep", "1000"], stdout=subprocess.DEVNULL)
    with open(sys.argv[2], "w") as file:
        file.write(f"{os.getpid()} {child.pid}\n")
    serve(lambda query: send(answer(query)), on_end=lambda: time.sleep(1000))


globals()[sys.argv[1]]()
