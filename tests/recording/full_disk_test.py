"""A small disk fills up under dyncal-recorder: it ends in order, or keeps what it had.

full_disk_test.py PROGRAMS PUBLISHER FOLDER; needs the right to mount a tmpfs, else it is skipped.
"""

import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

import walk
from killed_recorder_test import Acknowledged

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import own_dds_domain  # noqa: E402

PATIENCE_S = 60
DISK_MB = 24
MB_PER_S = 12


class FullDisk(unittest.TestCase):
    def setUp(self):
        self.programs, self.publisher, self.folder = map(pathlib.Path, ARGUMENTS)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.disk = self.folder / "disk"
        subprocess.run(["umount", str(self.disk)], capture_output=True, check=False)
        shutil.rmtree(self.disk, ignore_errors=True)
        self.disk.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_MB}m", "tmpfs", str(self.disk)]
        if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
            self.skipTest("SKIPPED: no right to mount a small tmpfs: run it as root")
        self.addCleanup(subprocess.run, ["umount", str(self.disk)], check=False)
        self.domain = str(own_dds_domain())

    def fill(self, min_free_mb, ended):
        """Records until `ended` stands in the log. Returns acknowledged counts and the log."""
        publisher = subprocess.Popen(
            [str(self.publisher), self.domain, "cyclonedds", str(MB_PER_S)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(publisher.wait)
        self.addCleanup(publisher.stdin.close)
        acknowledged = Acknowledged(publisher.stdout)
        log = self.folder / "recorder.log"
        with open(log, "w", encoding="utf-8") as stream:
            recorder = subprocess.Popen(
                [
                    str(self.programs / "dyncal-recorder"),
                    *("--folder", str(self.disk), "--domain", self.domain, "--dds", "cyclonedds"),
                    *("--min-free-mb", str(min_free_mb), "--bench", "bench-1"),
                ],
                stderr=stream,
            )
            deadline = time.monotonic() + PATIENCE_S
            while ended not in log.read_text("utf-8"):
                self.assertLess(time.monotonic(), deadline, log.read_text("utf-8"))
                self.assertIsNone(recorder.poll(), "it goes on, and says what it cannot store")
                time.sleep(0.05)
            time.sleep(1.5)  # another status
            recorder.send_signal(signal.SIGTERM)
            recorder.wait(PATIENCE_S)
        return acknowledged.below(self.disk), log.read_text("utf-8")

    def check(self, stored):
        paths = sorted(self.disk.glob("*/*.mcap"))
        self.assertEqual(len(paths), 1)
        count = walk.walk(paths[0])
        self.assertGreater(count, 10)
        self.assertGreaterEqual(count, stored[str(paths[0])])
        return paths[0]

    def test_ends_in_order_when_the_disk_is_nearly_full(self):
        stored, log = self.fill(8, "nearly full")
        path = self.check(stored)
        self.assertIn("not stored", log)
        self.assertGreater(
            int.from_bytes(path.read_bytes()[-28:-20], "little"), 0, "it has an index"
        )

    def test_keeps_what_it_had_when_there_is_no_room_at_all(self):
        stored, _ = self.fill(0, "cannot be written (No space left on device)")
        self.check(stored)


if __name__ == "__main__":
    ARGUMENTS = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1])
