"""A terminal of 80x24 for tests of what programs draw on one."""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time

from programs import FOLDER, environment, expect

ROWS, COLUMNS = 24, 80


class Terminal:
    """A program on a pseudo-terminal, and what it wrote."""

    def __init__(self, *arguments, **more):
        self.master, slave = pty.openpty()
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
        self.process = subprocess.Popen(
            [FOLDER / "dyncal", *map(str, arguments)],
            stdin=slave,
            stdout=slave,
            stderr=slave,
            start_new_session=True,
            preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0),  # Ctrl-C reaches it
            env=environment(TERM="xterm", **more.pop("env", {})),
            **more,
        )
        os.close(slave)
        self.text = ""

    def read_until(self, done, seconds=60):
        until = time.monotonic() + seconds
        while not done(self.text) and time.monotonic() < until:
            if select.select([self.master], [], [], 0.2)[0]:
                try:
                    self.text += os.read(self.master, 65536).decode("utf-8", "replace")
                except OSError:
                    break
        expect(done(self.text), f"this did not come: {self.text[-2000:]!r}")

    def read_to_the_end(self, seconds=300):
        """The exit status; all that was written is in `text`."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if select.select([self.master], [], [], 0.2)[0]:
                try:
                    self.text += os.read(self.master, 65536).decode("utf-8", "replace")
                except OSError:  # the program has closed its side
                    return self.process.wait(30)
        self.process.kill()
        expect(False, f"did not end: {self.text[-2000:]!r}")

    def write(self, text):
        os.write(self.master, text.encode())

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(30)
        finally:
            os.close(self.master)


class Screen:
    """A window that remembers whether anything wrapped or scrolled."""

    def __init__(self):
        self.rows = [[" "] * COLUMNS for _ in range(ROWS)]
        self.row = self.column = 0
        self.faults = []

    def feed(self, text):
        pattern = r"\x1b\[([0-9;]*)([A-Za-z])|(\r)|(\n)|([^\x1b])"
        for match in re.finditer(pattern, text, re.S):
            number, letter, back, down, plain = match.groups()
            if letter == "H":
                self.row = self.column = 0
            elif letter == "K":
                self.rows[self.row][self.column :] = [" "] * (COLUMNS - self.column)
            elif letter == "J":
                first = 0 if number == "2" else self.row + 1
                for row in range(first, ROWS):
                    self.rows[row] = [" "] * COLUMNS
            elif back:
                self.column = 0
            elif down:
                self.row += 1
                if self.row >= ROWS:
                    self.faults.append("scrolled")
                    self.row = ROWS - 1
            elif plain:
                if self.column >= COLUMNS:
                    self.faults.append("wrapped")
                    self.column = 0
                self.rows[self.row][self.column] = plain
                self.column += 1

    def lines(self):
        return ["".join(row).rstrip() for row in self.rows]
