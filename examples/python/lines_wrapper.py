#!/usr/bin/env python3
"""A wrapper for a server that speaks lines of text over TCP: FTP, SMTP, POP3, Redis, a robot's console.

    maide learn 'exec:python3 lines_wrapper.py' -o server.dot

Each input is a line that is sent; the output is what the answer begins with. Every word has a
connection of its own. What differs from server to server stands first. `maide new wrapper --tcp
HOST:PORT` writes this file with your server's address and lines. It needs Python alone.
"""
import json
import re
import socket
import sys

# ---- Yours to change ----

SERVER = "127.0.0.1:2121"
# Input -> the line that is sent.
INPUTS = {"HELP": "HELP", "NOOP": "NOOP", "QUIT": "QUIT"}
# Sent when a word begins, so that no word sees what an earlier one left: "FLUSHALL" of Redis.
RESET = []
LINE_END = "\r\n"


def name(answer):
    """What the model calls an answer: its first word. Nothing that is another one in each run may be
    in it (times, lengths, numbers of sessions), or the model has a state for each."""
    words = answer.split()
    return re.sub(r"[^\w.:!?*$/+-]", "_", words[0]) if words else "empty"


def is_whole(answer):
    """Whether nothing more will come: the last line is ended, and does not say that it goes on, as
    "220-" does in FTP."""
    lines = answer.split("\n")
    return len(lines) > 1 and lines[-1] == "" and not re.match(r"\d{3}-", lines[-2])


# ---- The wrapper ----


class Connection:
    """A connection of one word. `closed` once the server has ended it."""

    greets = None  # whether the server speaks first; the first connection waits for that

    def __init__(self, address, patience):
        self.patience = patience
        self.closed = False
        self.socket = socket.create_connection(address, timeout=10)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if Connection.greets is not False:
            Connection.greets = self.hear() != ""
        for line in RESET:
            self.send(line)
            self.hear()

    def hear(self):
        """The answer; as much of it as came, if the server then said nothing for so many seconds."""
        answer = b""
        self.socket.settimeout(self.patience)
        try:
            while not is_whole(answer.decode(errors="replace")):
                piece = self.socket.recv(65536)
                if not piece:
                    self.closed = True
                    break
                answer += piece
        except socket.timeout:
            pass
        except ConnectionError:
            self.closed = True
        return answer.decode(errors="replace")

    def send(self, line):
        try:
            self.socket.sendall((line + LINE_END).encode())
        except ConnectionError:
            self.closed = True

    def step(self, line):
        """The outputs: the answer, and `closed` if the server ends the connection."""
        if self.closed:
            return ["closed"]
        self.send(line)
        answer = self.hear()
        return [name(answer)] * (answer != "") + ["closed"] * self.closed


def say(**message):
    print(json.dumps(message), flush=True)


def main():
    say(type="hello", protocol=1, name="lines", options=[
        {"key": "server", "default": SERVER, "help": "where the server listens, HOST:PORT"},
        {"key": "patience", "kind": "integer", "default": "500", "least": 1, "most": 60000,
         "help": "milliseconds after which a server that says nothing has nothing to say"}])
    connection = address = patience = None
    for line in sys.stdin:
        message = json.loads(line)
        if message["type"] == "configure":
            options = {"server": SERVER, "patience": "500", **message["options"]}
            host, _, port = options["server"].rpartition(":")
            address, patience = (host.strip("[]"), int(port)), int(options["patience"]) / 1000
            try:
                Connection(address, patience).socket.close()
            except OSError as error:
                say(type="error", code="system",
                    message=f"no connection to {options['server']}: {error}")
                break
            say(type="info", inputs=list(INPUTS), open_outputs=True, options=options)
        elif message["type"] == "run":
            try:
                connection = Connection(address, patience)
            except OSError as error:
                say(type="error", code="system", id=message["id"], message=str(error))
                continue
            steps = [{"events": connection.step(INPUTS[given])} for given in message["word"]]
            connection.socket.close()
            say(type="answer", id=message["id"], steps=steps)
        elif message["type"] == "bye":
            break


main()
