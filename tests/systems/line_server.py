"""A server with sessions for tests of wrappers: it speaks lines, as FTP does.

    line_server.py

It prints "listening on HOST:PORT" and serves until its standard input ends. A session wants USER,
then PASS, before it answers LIST, with several lines; QUIT ends it. COUNT counts over all sessions
until FORGET: what a wrapper has to reset.
"""
import socketserver
import sys
import threading


class Session(socketserver.StreamRequestHandler):
    def say(self, *lines):
        self.wfile.write("".join(line + "\r\n" for line in lines).encode())

    def handle(self):
        try:
            self.serve()
        except ConnectionError:
            pass  # the wrapper has gone

    def serve(self):
        self.say("220-welcome", "220 at your service")
        user = is_in = False
        for line in self.rfile:
            word = line.split()[0].decode() if line.split() else ""
            if word == "USER":
                user, is_in = True, False
                self.say("331 password, please")
            elif word == "PASS":
                self.say("230 in" if user else "503 who are you?")
                user, is_in = False, user
            elif word == "LIST":
                if is_in:
                    self.say("226-a file", "226 done")
                else:
                    self.say("530 not logged in")
            elif word == "COUNT":
                self.server.count = min(self.server.count + 1, 2)
                self.say(f"250.{self.server.count}")
            elif word == "FORGET":
                self.server.count = 0
                self.say("250.0")
            elif word == "HUSH":
                pass
            elif word == "QUIT":
                self.say("221 bye")
                return
            else:
                self.say("500 what?")


class Server(socketserver.ThreadingTCPServer):
    allow_reuse_address = daemon_threads = True
    count = 0


with Server(("127.0.0.1", 0), Session) as server:
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print("listening on 127.0.0.1:%d" % server.server_address[1], flush=True)
    sys.stdin.read()
