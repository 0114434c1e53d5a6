#!/usr/bin/env python3
"""Runs a program on a terminal of its own.

    on_terminal.py TYPED PROGRAM ARGUMENT...

Types TYPED, a line whenever the program asks with "> ", and then Ctrl-D. Prints what the terminal shows, and ends with
the program's exit status.
"""
import os
import pty
import re
import sys

lines = re.findall(r"[^\n\x03]*(?:\n|\x03)", sys.argv[1]) + ["\x04"]
child, terminal = pty.fork()
if child == 0:
    os.execv(sys.argv[2], sys.argv[2:])
shown = b""
asked = 0
while True:
    try:
        piece = os.read(terminal, 65536)
    except OSError:  # the program has ended
        break
    if not piece:
        break
    shown += piece
    while lines and shown.count(b"\n> ", asked) > 0:
        asked = shown.index(b"\n> ", asked) + 3
        os.write(terminal, lines.pop(0).encode())
sys.stdout.write(shown.decode().replace("\r\n", "\n"))
sys.stdout.flush()
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
