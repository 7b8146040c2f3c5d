#!/usr/bin/env python3
"""What programs draw on a terminal: dyncal watch in a window of 80x24 while eight benches are on
the bus, each line within the window and nothing scrolled; colours where they are wanted, and none
on a pipe; new-bench by questions."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from programs import FOLDER, expect, run
from terminal import ROWS, Screen, Terminal

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

DOMAIN = str(own_dds_domain())
BENCHES = 8


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
    answers = ["asked-1", "analogue", "socket", "none", "ch2", "host:5026", "ref", "", "10 12.5"]
    answers += ["2.5", "4"]
    terminal.read_until(lambda text: "Name of the bench: " in text)
    for number, answer in enumerate(answers):
        terminal.read_until(
            lambda text, number=number: text.count("]: ") + text.count("later): ") >= number
        )
        terminal.write(answer + "\n")
    terminal.read_until(lambda text: "is written" in text)
    expect(terminal.process.wait(30) == 0, terminal.text)
    written = (folder / "asked-1.toml").read_text()
    expect('"12.5"' in written and '"acs/ch2"' in written, written)

    before = sorted(folder.iterdir())
    terminal = Terminal("new-bench", cwd=folder)
    terminal.write("asked-1\n")
    terminal.read_until(lambda text: "is there already" in text)
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
