"""The programs that deploy/guide/python.md shows, and how a test runs them."""

import contextlib
import pathlib
import re
import signal
import subprocess

TOP = pathlib.Path(__file__).resolve().parents[2]
BENCH = """
bench = "card"
[excitation]
frequencies_hz = ["80"]
level = 10.0
settling_s = 0.5
duration_s = 1.0
[sources.acs]
driver = "socket"
address = "127.0.0.1:{port}"
[method]
kind = "analogue"
reference = "acs/reference"
dut = ["acs/sync"]
"""


def programs():
    """Python programs of the page by their names."""
    text = (TOP / "deploy/guide/python.md").read_text()
    return dict(re.findall(r"```python (\w+\.py)\n(.*?)```", text, re.S))


def lines_of_code(text):
    return sum(bool(line.strip()) for line in text.splitlines())


@contextlib.contextmanager
def running(folder, *words, cwd=None):
    """A program for as long as the block lasts; what it prints is kept in the folder."""
    with open(folder / f"{pathlib.Path(words[0]).name}.log", "a", encoding="utf-8") as log:
        process = subprocess.Popen(list(map(str, words)), stdout=log, stderr=log, cwd=cwd)
        try:
            yield process
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
