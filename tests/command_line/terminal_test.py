#!/usr/bin/env python3
"""What programs draw on a terminal: dyncal watch in a window of 80x24 while eight benches are on
the bus, each line within the window and nothing scrolled; colours where they are wanted, and none
on a pipe; new-bench by questions."""

import fcntl
import json
import os
import pathlib
import pty
import re
import select
import signal
import struct
import subprocess
import tempfile
import termios
import time

from programs import FOLDER, environment, expect, run

DOMAIN = str(100 + os.getpid() % 100)
ROWS, COLUMNS = 24, 80
BENCHES = 8


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


def start_benches(folder):
    """Eight benches that play files, as sources on the bus."""
    rows = "".join(f"{i * 1000000},{i % 7},{i % 5}\n" for i in range(500))
    (folder / "acs.csv").write_text("t_ns,reference,sync\n" + rows)
    (folder / "dau.csv").write_text("t_ns,acceleration_z,sync\n" + rows)
    files = []
    for number in range(BENCHES):
        name = f"bench-with-a-long-name-{number}"
        options = ["--sensor", "file", "--sensor-file", "dau.csv", "--acs", "file"]
        options += ["--acs-file", "acs.csv", "--generator", "none"]
        done = run("dyncal", "new-bench", "--name", name, *options, cwd=folder)
        expect(done.returncode == 0, done.stderr)
        files.append(folder / f"{name}.toml")
    with open(folder / "acs.log", "w", encoding="utf-8") as log:
        return subprocess.Popen(
            [FOLDER / "dyncal-acs", *files, "--domain", DOMAIN], stdout=log, stderr=log
        )


def watch(env=None):
    terminal = Terminal("watch", "--domain", DOMAIN, env=env or {})
    try:
        seen = lambda text: text.count("\x1b[H") >= 3 and f"{BENCHES} benches" in text
        terminal.read_until(seen)
    finally:
        terminal.end()
    return terminal.text


def check_watch():
    text = watch()
    screen = Screen()
    screen.feed(text[: text.rindex("\x1b[J") + 3])
    expect(not screen.faults, f"{screen.faults}\n" + "\n".join(screen.lines()))
    shown = "\n".join(screen.lines())
    expect(shown.count("bench-with") == BENCHES, shown)
    expect(f"{BENCHES} benches" in shown, shown)
    print(f"watch: {sum(1 for line in screen.lines() if line)} of {ROWS} lines")
    plain = watch({"NO_COLOR": "1"})
    expect(not re.search(r"\x1b\[\d*m", plain), "NO_COLOR is set, but there are colours")


def check_pipes():
    done = run("dyncal", "watch", "--domain", DOMAIN, "--seconds", "6")
    expect("\x1b" not in done.stdout and "/dau: " in done.stdout, done.stdout)
    done = run("dyncal", "watch", "--domain", DOMAIN, "--seconds", "6", "--json")
    states = [json.loads(line) for line in done.stdout.splitlines()]
    expect(states and len(states[-1]["benches"]) == BENCHES, done.stdout[-500:])
    began = time.monotonic()
    done = run("dyncal", "list", "--domain", DOMAIN, "--json")
    took = time.monotonic() - began
    listed = json.loads(done.stdout)
    expect(len(listed["benches"]) == BENCHES, done.stdout[:500])
    text = run("dyncal", "list", "--domain", DOMAIN).stdout
    expect(text.count("\n  source dau") == BENCHES, text)
    print(f"list: {took:.1f} s")


def check_questions(folder):
    terminal = Terminal("new-bench", cwd=folder)
    answers = ["asked-1", "analogue", "socket", "none", "ch2", "host:5026", "ref", "10 12.5"]
    answers += ["2.5", "4"]
    terminal.read_until(lambda text: "Name of the bench: " in text)
    for number, answer in enumerate(answers):
        terminal.read_until(lambda text, number=number: text.count("]: ") >= number)
        terminal.write(answer + "\n")
    terminal.read_until(lambda text: "is written" in text)
    expect(terminal.process.wait(30) == 0, terminal.text)
    written = (folder / "asked-1.toml").read_text()
    expect('"12.5"' in written and '"acs/ch2"' in written, written)

    before = sorted(folder.iterdir())
    terminal = Terminal("new-bench", cwd=folder)
    terminal.write("asked-1\n")
    terminal.read_until(lambda text: "there is such a file already" in text)
    terminal.write("asked-2\ncan\n")
    terminal.read_until(lambda text: "Analogue system" in text)
    terminal.write("\x03")
    expect(terminal.process.wait(30) != 0, terminal.text)
    expect(sorted(folder.iterdir()) == before, "Ctrl-C has left a file")


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_questions(folder)
        service = start_benches(folder)
        try:
            check_watch()
            check_pipes()
        finally:
            service.terminate()
            service.wait(60)


main()
