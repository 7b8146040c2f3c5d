"""dyncal-recorder is killed at random instants while four benches publish.

killed_recorder_test.py PROGRAMS PUBLISHER FOLDER; DYNCAL_KILLS: how often (default 3).
"""

import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import threading
import time
import unittest

import public_reader
import walk

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

PATIENCE_S = 60
KILLS = int(os.environ.get("DYNCAL_KILLS", "3"))


class Acknowledged:
    """What recorders have said that they have stored, by file."""

    def __init__(self, stream):
        self.stored = {}
        self.lock = threading.Lock()
        threading.Thread(target=self.read, args=(stream,), daemon=True).start()

    def read(self, stream):
        with stream:
            self.read_lines(stream)

    def read_lines(self, stream):
        for line in stream:
            found = re.match(r"stored (\d+) (\d+) (.*)$", line)
            if found:
                with self.lock:
                    self.stored[found[3]] = int(found[1])

    def below(self, folder):
        with self.lock:
            return {
                path: count for path, count in self.stored.items() if path.startswith(str(folder))
            }


class KilledRecorder(unittest.TestCase):
    def setUp(self):
        self.programs, self.publisher, self.folder = map(pathlib.Path, ARGUMENTS)
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.domain = str(own_dds_domain())

    def recorder(self, folder, log):
        return subprocess.Popen(
            [
                str(self.programs / "dyncal-recorder"),
                *("--folder", str(folder), "--domain", self.domain, "--dds", "cyclonedds"),
            ],
            stderr=log,
        )

    def wait_for(self, condition, what):
        deadline = time.monotonic() + PATIENCE_S
        while not condition():
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.01)

    def test_every_file_opens_and_has_what_was_acknowledged(self):
        python = public_reader.interpreter(self.folder.parent)
        if python is None:
            print("SKIPPED IN PART: PyPI mcap cannot be had; files are checked by walk.py alone")
        publisher = subprocess.Popen(
            [str(self.publisher), self.domain, "cyclonedds"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(publisher.wait)
        self.addCleanup(publisher.stdin.close)
        acknowledged = Acknowledged(publisher.stdout)
        draw = random.Random(os.environ.get("DYNCAL_SEED", "12"))
        files = messages = 0
        for kill in range(KILLS):
            folder = self.folder / str(kill)
            with open(self.folder / f"{kill}.log", "w", encoding="utf-8") as log:
                recorder = self.recorder(folder, log)
                self.wait_for(
                    lambda folder=folder: len(
                        [n for n in acknowledged.below(folder).values() if n > 0]
                    )
                    == 4,
                    f"kill {kill}: four benches are recorded",
                )
                time.sleep(draw.uniform(0.0, 1.5))
                recorder.kill()
                recorder.wait()
            time.sleep(0.1)  # what was acknowledged is on its way
            stored = acknowledged.below(folder)
            paths = sorted(folder.glob("*/*.mcap"))
            self.assertEqual(len(paths), 4)
            counts = [walk.walk(path) for path in paths]
            if python:
                self.assertEqual(public_reader.count_messages(python, paths), counts)
            for path, count in zip(paths, counts):
                self.assertGreater(stored[str(path)], 0)
                self.assertGreaterEqual(count, stored[str(path)], path)
            files += len(paths)
            messages += sum(counts)
            shutil.rmtree(folder)
        print(f"{KILLS} kills: {files} files open, with {messages} messages, none missing")


if __name__ == "__main__":
    ARGUMENTS = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1])
