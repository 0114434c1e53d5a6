#!/usr/bin/env python3
"""A wrapper for a server over TCP, UDP or TLS: FTP, SMTP, POP3, Redis, a robot's console.

    maide learn 'exec:python3 lines_wrapper.py' -o server.dot

Each input is a line that is sent; the output is what the answer begins with. Every word has a
connection of its own. What differs from server to server stands first. `maide new wrapper --tcp
HOST:PORT` writes this file with your server's address and lines. It needs Python alone.

An answer may come in pieces, so silence ends it. How long a silence, the wrapper measures when it
starts. Where a later answer needs more, the word is played again with more, and nobody sees the
first try. Where an answer is as some before were, there is no wait within a word: if it was not
whole, the rest is in an answer behind it, which then is as none before, and the word is played again
with all waits. An answer that tells its own end need not be waited for: see is_whole.
"""
import collections
import json
import re
import socket
import ssl
import struct
import sys
import time

# ---- Yours to change ----

SERVER = "127.0.0.1:2121"
TRANSPORT = "tcp"  # or "udp", "tls"
# Input -> the line that is sent; "\n" in it begins a further line.
INPUTS = {"HELP": "HELP", "NOOP": "NOOP", "QUIT": "QUIT"}
# Sent when a word begins, so that no word sees what an earlier one left: "FLUSHALL" of Redis.
RESET = []
LINE_END = "\r\n"


def name(answer):
    """What the model calls an answer: its first word. Nothing that is another one in each run may be
    in it (times, lengths, numbers of sessions), or the model has a state for each."""
    words = answer.split()
    if words and re.fullmatch(r"[*$]\d+", words[0]):
        return words[0][0]  # Redis: "$5" and "*2" are lengths
    return re.sub(r"[^\w.:!?*$/+-]", "_", words[0]) if words else "empty"


def as_lines(text):
    """The bytes of a request."""
    return (text + "\n").replace("\n", LINE_END).encode()


def with_length(text):
    """The same where a length of four bytes goes first."""
    return struct.pack(">I", len(text.encode())) + text.encode()


def by_silence(answer):
    """Whether an answer, as bytes, is whole. None: silence decides. True: do not wait for more, which
    is quicker. False: more comes for certain, as behind "220-" of FTP and SMTP."""
    last = answer.rstrip(b"\r\n").rpartition(b"\n")[2]
    return False if re.match(rb"\d{3}-", last) else None


def by_code(answer):
    """FTP, SMTP: a line "220 ..." is the last one. Not for a server that answers a request twice."""
    last = answer.rpartition(b"\n")[0].rpartition(b"\n")[2]
    return answer.endswith(b"\n") and re.match(rb"\d{3}( |\r|$)", last) is not None


def by_redis(answer):
    """Redis: a line, and behind "$5" five bytes and a line's end, behind "*2" two such answers."""
    wanted, place = 1, 0
    while wanted > 0:
        end = answer.find(b"\r\n", place)
        if end < 0:
            return False
        kind, number, place = answer[place:place + 1], answer[place + 1:end], end + 2
        wanted -= 1
        if kind == b"$" and int(number) >= 0:
            place += int(number) + 2
        elif kind == b"*":
            wanted += max(int(number), 0)
    return len(answer) >= place


def by_length(answer):
    """Four bytes, the highest first, say how many bytes follow."""
    return len(answer) >= 4 and len(answer) >= 4 + struct.unpack(">I", answer[:4])[0]


request = as_lines
is_whole = by_silence

# ---- The wrapper ----


# Outputs of these names have a meaning of their own.
RESERVED = {"quiet", "delta", "refused", "unexplored", "absorbed", "+", "crash", "hang"}


class Again(Exception):
    """An answer may have been believed whole too early: the word must be played again."""


class Failure(Exception):
    """What the user has to know, and to change."""


class Waits:
    """How long a silence ends an answer, in seconds: `patience` before its first byte, `settle` behind
    that. Each is a multiple of the longest silence that was seen at its place, and grows with it."""

    def __init__(self, options):
        self.patience = int(options["patience"]) / 1000
        self.settle = int(options["settle"]) / 1000
        self.greeting = int(options["greeting"]) / 1000  # for the first byte of a greeting
        self.most_patience = max(self.patience, 10.0)
        self.most_settle = max(self.settle, self.patience)
        self.known = Known()
        self.is_quick, self.in_vain = True, 0  # known answers are not waited for
        self.greets = None  # whether the server speaks first
        self.is_measuring = True

    def first(self):
        return max(self.patience, self.greeting) if self.is_measuring else self.patience

    def more(self):
        return self.most_settle / 2 if self.is_measuring else self.settle

    def saw(self, silence, is_first):
        """Something came after a silence. If a little more would have been too much, throws Again."""
        if is_first and 3 * silence > self.patience < self.most_patience:
            self.patience = min(3 * silence, self.most_patience)
        elif not is_first and 4 * silence > self.settle < self.most_settle:
            self.settle = min(4 * silence, self.most_settle)
        else:
            return
        if not self.is_measuring:
            raise Again

    def played_again(self, was_quick):
        """If quick words are mostly in vain, because each answer is another one, all are slow."""
        self.in_vain += was_quick
        self.is_quick = self.in_vain < 100

    def came_late(self):
        """Something came when all had been silent for long enough."""
        if self.settle >= self.most_settle:
            return False
        self.settle = min(2 * self.settle, self.most_settle)
        return True


class Known:
    """The answers that were heard with all waits, for each input; numbers count as equal."""

    ENOUGH = 3  # so often an answer must have been whole

    def __init__(self):
        self.whole = collections.Counter()
        self.begun = set()  # what was only the beginning of an answer

    @staticmethod
    def key(line, answer):
        return line, re.sub(rb"\d+", b"0", answer) if answer.endswith(b"\n") else answer

    def heard(self, line, pieces, closed):
        answer = b""
        for place, piece in enumerate(pieces):
            answer += piece
            if closed or place + 1 < len(pieces):
                self.begun.add(self.key(line, answer))
        self.whole[self.key(line, answer), closed] += 1

    def has(self, line, answer, closed):
        return self.whole[self.key(line, answer), closed] >= self.ENOUGH

    def ends(self, line, answer):
        return self.key(line, answer) not in self.begun and self.has(line, answer, False)


def open_socket(address):
    if TRANSPORT == "udp":
        family, kind, _, _, place = socket.getaddrinfo(*address, type=socket.SOCK_DGRAM)[0]
        opened = socket.socket(family, kind)
        opened.connect(place)
        return opened
    opened = socket.create_connection(address, timeout=10)
    opened.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    if TRANSPORT == "tls":
        context = ssl.create_default_context()
        context.check_hostname, context.verify_mode = False, ssl.CERT_NONE  # whoever signed it
        opened = context.wrap_socket(opened, server_hostname=address[0])
    return opened


class Connection:
    """A connection of one word. `closed` once the server has ended it."""

    def __init__(self, address, waits):
        self.waits = waits
        self.early = 0  # how many answers were not waited for
        self.closed = False
        self.is_silent = True  # nothing was sent yet
        self.acknowledges = TRANSPORT != "udp" and hasattr(socket, "TCP_QUICKACK")
        self.socket = open_socket(address)

    def close(self):
        self.socket.close()

    def receive(self, limit):
        """What came: None if nothing did for so many seconds, nothing more (b"") once it is closed."""
        self.socket.settimeout(limit)
        try:
            if self.acknowledges:
                # Else a server that writes twice waits 40 ms for the acknowledgement of the first.
                self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1)
            piece = self.socket.recv(65536)
        except (socket.timeout, BlockingIOError, ssl.SSLWantReadError):
            return None
        except OSError:
            piece = b""
            self.closed = True
        self.closed = self.closed or (piece == b"" and TRANSPORT != "udp")
        return piece

    def hear(self, limit, line=None, known=None):
        """The answer: what comes until there is a silence; before its first byte, of `limit` seconds.
        Also how long the last silence was. Where the answer to the line is `known`, it is not waited
        for."""
        pieces, last, is_sure, silence = [], time.monotonic(), True, 0
        while not self.closed:
            piece = self.receive(limit)
            silence = time.monotonic() - last
            if piece is None:
                break
            last += silence
            if not pieces or not is_sure:
                self.waits.saw(silence, not pieces)
            if piece or not self.closed:
                pieces.append(piece)
            answer, silence = b"".join(pieces), 0
            whole = is_whole(answer) if answer else None
            if whole:
                return answer, 0
            if known and not self.closed and known.ends(line, answer):
                self.early += 1
                return answer, 0
            is_sure = whole is False
            limit = self.waits.first() if is_sure else self.waits.more()
        answer = b"".join(pieces)
        if line is not None:
            if self.early and not self.waits.known.has(line, answer, self.closed):
                raise Again
            if not self.early:
                self.waits.known.heard(line, pieces, self.closed)
        return answer, silence

    def greet(self, known=None):
        """Hears the greeting, if the server greets, and forgets what words before have left."""
        if self.waits.greets:
            if not self.hear(self.waits.greeting, "", known)[0]:
                raise Failure("the server greets, but did not for %d ms: raise greeting="
                              % (1000 * self.waits.greeting))
            if self.closed:
                raise ConnectionError("the server ended the connection after its greeting")
        for line in RESET:
            self.send(line)
            self.hear(self.waits.first(), line, known)

    def send(self, line):
        late = None if self.closed else self.receive(0)
        if late:
            if self.is_silent and not self.waits.greets:
                raise Failure("the server greets on some connections and not on others, or later "
                              "than %d ms: raise greeting=" % (1000 * self.waits.greeting))
            if not self.waits.is_measuring:
                if self.waits.came_late():
                    raise Again
                raise Failure("behind a whole answer came %r: raise patience= and settle=, or "
                              "mend is_whole" % late[:40])
        self.is_silent = False
        try:
            self.socket.settimeout(10)
            self.socket.sendall(request(line))
        except OSError:
            self.closed = True

    def step(self, line, known=None):
        """The outputs: the answer, and `closed` if the server ends the connection."""
        if self.closed:
            return {"events": ["closed"]}
        start = time.monotonic()
        self.send(line)
        answer, silence = self.hear(self.waits.first(), line, known)
        called = name(answer.decode(errors="replace"))
        events = [called + "_" * (called in RESERVED)] * (answer != b"")
        return {"events": events + ["closed"] * self.closed,
                "us": int(1e6 * (time.monotonic() - start)), "settling_us": int(1e6 * silence)}


def hear_greetings(address, waits):
    """What each of three connections hears first, at once: a server that greets late or that looks up
    the client's name is slow on each. Who has heard nothing, while another has, asks once more."""
    three, until = [], time.monotonic() + waits.greeting
    try:
        for _ in range(3):
            three.append(Connection(address, waits))
            if TRANSPORT == "udp" or waits.greeting == 0:
                break  # it only answers
    except OSError:
        if not three:
            raise  # else: one at a time, it says
    heard = []
    for one in three:
        heard.append(one.hear(max(until - time.monotonic(), 0))[0] if waits.greeting else b"")
        one.close()
    for place, greeting in enumerate(heard):
        if any(heard) and not greeting:
            one = Connection(address, waits)
            heard[place] = one.hear(waits.greeting)[0]
            one.close()
    return heard


def find_version(greetings):
    """What the greetings have in common, without what time and chance put in: so Maide notices that a
    cache is of another server."""
    changing = (r"<[^>]*>|\d{4}-\d\d-\d\d\S*|\d{1,2}:\d\d(:\d\d)?|(?<!\S)[+-]\d{4}\b|\b20\d\d\b|\d{5,}|"
                r"\b(Mon|Tue|Wed|Thu|Fri|Sat|Sun)\w*,?|\d* ?\b(Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|"
                r"Oct|Nov|Dec)\w*( +\d{1,2}\b)?|\b(?=\w*\d)[0-9a-fA-F]{8,}\b")
    texts = [re.sub(changing, "#", one.decode(errors="replace")).split() for one in greetings]
    common = [words[0] if len(set(words)) == 1 else "#" for words in zip(*texts)]
    return re.sub(r"[^ -~]", "_", " ".join(common))[:100]


def begin(address, waits):
    """Meets the server: whether it greets, how it answers. Returns its greetings."""
    heard = hear_greetings(address, waits)
    if any(heard) and not all(heard):
        raise Failure("the server greets on some connections and not on others, or later than "
                      "%d ms: raise greeting=" % (1000 * waits.greeting))
    waits.greets = all(heard)
    until = time.monotonic() + 20
    for names in (list(INPUTS), list(INPUTS)[::-1]):
        connection = None
        for given in names:
            if connection is None or connection.closed:
                if connection:
                    connection.close()
                connection = Connection(address, waits)
                connection.greet()
            if time.monotonic() < until:
                connection.send(INPUTS[given])
                answer = connection.hear(waits.first(), INPUTS[given])[0]
                if TRANSPORT == "udp" and connection.closed and not answer:
                    raise ConnectionError("nobody listens")
        if connection:
            connection.close()
    waits.is_measuring = False
    return heard


def play(word, address, waits):
    """The steps of a word, played again where a wait was too short or no connection was to be had."""
    lines = [INPUTS[given] for given in word]
    failures = 0
    for tries in range(20):
        known = waits.known if waits.is_quick and tries == 0 else None
        connection = None
        try:
            connection = Connection(address, waits)
            connection.greet(known)
            # No next input finds what comes late at the end, so the last answer is waited for.
            steps = [connection.step(line, known) for line in lines[:-1]]
            steps += [connection.step(line) for line in lines[-1:]]
            if lines and not connection.closed and not connection.early:
                if connection.receive(waits.settle) and waits.came_late():
                    raise Again
            return steps
        except Again:
            waits.played_again(connection and connection.early > 0)
        except OSError:
            failures += 1
            if failures > 5:
                raise
            time.sleep(0.1 * 2 ** failures)
        finally:
            if connection:
                connection.close()
    raise Failure("the server answers more slowly each time: give patience= and settle=")


OPTIONS = [("server", None, SERVER, "where the server listens, HOST:PORT"),
           ("patience", 60000, "500", "milliseconds after which a server that says nothing has nothing "
            "to say, at least"),
           ("settle", 60000, "20", "milliseconds of silence behind which an answer is whole, at least"),
           ("greeting", 60000, "2000", "milliseconds in which a server that speaks first does so; 0: "
            "it never does"),
           ("version", None, "", "which server it is; the default is its greeting")]


def say(**message):
    print(json.dumps(message), flush=True)


def configure(given):
    """Answers with what there is to learn. Returns address and waits."""
    options = {key: default for key, _, default, _ in OPTIONS}
    options.update(given)
    host, _, port = options["server"].rpartition(":")
    address, waits = (host.strip("[]"), int(port)), Waits(options)
    greetings = begin(address, waits)
    version = options.pop("version") or find_version(greetings)
    say(type="info", inputs=list(INPUTS), open_outputs=True, options=options,
        versions={"server": version} if version else {})
    return address, waits


def main():
    say(type="hello", protocol=1, name="lines", options=[
        {"key": key, "default": default, "help": help} if most is None else
        {"key": key, "kind": "integer", "default": default, "least": 0, "most": most, "help": help}
        for key, most, default, help in OPTIONS])
    system = ()
    for line in sys.stdin:
        message = json.loads(line)
        try:
            if message["type"] == "configure":
                system = configure(message["options"])
            elif message["type"] == "run":
                say(type="answer", id=message["id"], steps=play(message["word"], *system))
            elif message["type"] == "bye":
                break
        except (OSError, Failure) as error:
            where = {**{"server": SERVER}, **message.get("options", {})}["server"]
            if message["type"] == "run":
                say(type="error", code="system", id=message["id"], message=str(error))
                continue
            text = str(error) if isinstance(error, Failure) else f"no connection to {where}: {error}"
            say(type="error", code="system", message=text)
            break


if __name__ == "__main__":
    main()
