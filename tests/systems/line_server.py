"""A server with sessions for tests of wrappers: it speaks lines, as FTP does.

    line_server.py [--gap MS] [--late-first MS] [--late-others MS] [--silent] [--udp] [--tls FILE]
                   [--binary] [--banner TEXT] [--port PORT]

It prints "listening on HOST:PORT" and serves until its standard input ends. A session wants USER,
then PASS, before it answers LIST, with several lines; QUIT ends it. STORE wants a second line. COUNT
counts over all sessions until FORGET: what a wrapper has to reset.

--gap: each answer is written in two parts, so far apart. --late-first, --late-others: the greeting
of the first connection, of the others, comes so late. --silent: no greeting. --tls: with this
certificate and key. --binary: four bytes of length before each request and answer, not lines.
"""
import argparse
import socketserver
import ssl
import struct
import sys
import threading
import time

parser = argparse.ArgumentParser()
for number in ("--gap", "--late-first", "--late-others", "--port"):
    parser.add_argument(number, type=int, default=0)
for flag in ("--silent", "--udp", "--binary"):
    parser.add_argument(flag, action="store_true")
parser.add_argument("--tls")
parser.add_argument("--banner", default="at your service")
options = parser.parse_args()

shared = {"connections": 0, "count": 0}


class Session:
    def __init__(self):
        self.user = self.is_in = self.is_storing = self.is_over = False

    def answer(self, line):
        """The lines of the answer."""
        if self.is_storing:
            self.is_storing = False
            return ["250 stored"]
        word = line.split()[0] if line.split() else ""
        if word == "USER":
            self.user, self.is_in = True, False
            return ["331 password, please"]
        if word == "PASS":
            self.user, self.is_in = False, self.user
            return ["230 in" if self.is_in else "503 who are you?"]
        if word == "LIST":
            return ["226-a file", "226 done"] if self.is_in else ["530 not logged in"]
        if word == "STORE":
            self.is_storing = True
            return []
        if word == "COUNT":
            shared["count"] = min(shared["count"] + 1, 2)
            return ["250.%d" % shared["count"]]
        if word == "FORGET":
            shared["count"] = 0
            return ["250.0"]
        if word == "HUSH":
            return []
        if word == "QUIT":
            self.is_over = True
            return ["221 bye"]
        return ["500 what?"]


class Stream(socketserver.StreamRequestHandler):
    def setup(self):
        if options.tls:
            context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            context.load_cert_chain(options.tls)
            self.request = context.wrap_socket(self.request, server_side=True)
        super().setup()

    def say(self, lines):
        answer = "".join(line + "\r\n" for line in lines).encode()
        if options.binary and lines:
            answer = struct.pack(">I", len(answer)) + answer
        middle = len(answer) // 2 if options.gap else 0
        for part in (answer[:middle], answer[middle:]):
            if part:
                self.wfile.write(part)
                time.sleep(options.gap / 1000 if part is not answer[middle:] else 0)

    def hear(self):
        if not options.binary:
            return self.rfile.readline()
        head = self.rfile.read(4)
        return self.rfile.read(struct.unpack(">I", head)[0]) if len(head) == 4 else b""

    def handle(self):
        try:
            self.serve()
        except (ConnectionError, ssl.SSLError):
            pass  # the wrapper has gone

    def serve(self):
        shared["connections"] += 1
        late = options.late_first if shared["connections"] == 1 else options.late_others
        time.sleep(late / 1000)
        if not options.silent:
            self.say(["220-welcome", "220 " + options.banner])
        session = Session()
        while not session.is_over:
            line = self.hear()
            if not line:
                break
            self.say(session.answer(line.decode()))


class Datagrams(socketserver.DatagramRequestHandler):
    sessions = {}

    def handle(self):
        session = self.sessions.setdefault(self.client_address, Session())
        answer = session.answer(self.packet.decode())
        if answer:
            self.wfile.write("".join(line + "\r\n" for line in answer).encode())

    def finish(self):
        if self.wfile.getvalue():
            super().finish()


kind = socketserver.ThreadingUDPServer if options.udp else socketserver.ThreadingTCPServer
kind.allow_reuse_address = kind.daemon_threads = True
with kind(("127.0.0.1", options.port), Datagrams if options.udp else Stream) as server:
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print("listening on 127.0.0.1:%d" % server.server_address[1], flush=True)
    sys.stdin.read()
