"""On the network: live_test.py PROGRAMS FOLDER

A stream of dyncal.acs at 20 kS/s loses nothing into a real dyncal-acs; the programs of
deploy/guide/python.md do what the page says; a recording in Python is what `dyncal export` writes.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import time
import unittest

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(TOP / "tests"))
from dds_domain import own_dds_domain  # noqa: E402

os.environ["DYNCAL_DOMAIN"] = str(own_dds_domain())
import page  # noqa: E402

import dyncal  # noqa: E402
from dyncal import dds  # noqa: E402
from dyncal.acs import Channel, Stream  # noqa: E402

PATIENCE_S = 120
RATE = 20_000
CHANNELS = [
    Channel("reference", "Acceleration", r"\metre\second\tothe{-2}", -50, 50),
    Channel("sync", "Voltage", r"\volt", -10, 10),
]


class Live(unittest.TestCase):
    def send_seconds(self, stream, seconds):
        """At the rate of a card, in blocks of 20 ms; how many samples."""
        sent, begin = 0, time.monotonic()
        while sent < seconds * RATE:
            n = np.arange(sent, sent + RATE // 50)
            block = np.stack([n.astype(float), -n.astype(float)], axis=1)
            time.sleep(max(0.0, begin + sent / RATE - time.monotonic()))  # the card's clock
            stream.send(block)
            sent += len(n)
        return sent

    def test_a_stream_loses_nothing(self):
        reader = dds.Reader("AcsSamples", bench="card", late=True)
        with Stream(0, "Card", "17", RATE, CHANNELS, host="127.0.0.1") as stream:
            (FOLDER / "card.toml").write_text(page.BENCH.format(port=stream.port))
            with page.running(FOLDER, PROGRAMS / "dyncal-acs", FOLDER / "card.toml"):
                self.assertTrue(stream.wait_for_receiver(PATIENCE_S))
                self.assertTrue(reader.wait_for_writers(timeout_s=PATIENCE_S))
                sent = self.send_seconds(stream, 6)
                stream.close(PATIENCE_S)
                blocks = []
                for block in reader.messages(timeout_s=10):
                    blocks.append(block)
                    if block.end_of_stream:
                        break
        self.assertEqual(stream.lost, 0)
        numbers = [block.block for block in blocks]  # empty ones came before the reader
        self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(blocks))))
        values = np.concatenate(
            [np.reshape(block.values, (2, -1)) for block in blocks if block.sample_count], axis=1
        )
        self.assertEqual(values.shape, (2, sent))
        np.testing.assert_array_equal(values[0], np.arange(sent))
        np.testing.assert_array_equal(values[1], -np.arange(sent))
        self.assertTrue(blocks[-1].end_of_stream)

    def test_a_receiver_that_does_not_read_costs_whole_blocks(self):
        import socket

        with Stream(0, "Card", "17", RATE, CHANNELS, host="127.0.0.1", buffer_s=0.5) as stream:
            with socket.create_connection(("127.0.0.1", stream.port)):
                self.assertTrue(stream.wait_for_receiver(PATIENCE_S))
                block = np.zeros((RATE, 2))
                deadline = time.monotonic() + PATIENCE_S
                while not stream.lost and time.monotonic() < deadline:
                    stream.send(block[: RATE // 10])
                self.assertGreater(stream.lost, 0)

    def test_the_programs_of_the_page_make_an_acs_and_read_its_samples(self):
        programs = page.programs()
        for name in ("card.py", "results.py"):
            self.assertLessEqual(page.lines_of_code(programs[name]), 15, name)
            (FOLDER / name).write_text(programs[name])
        port = 20000 + os.getpid() % 12000
        (FOLDER / "page.toml").write_text(page.BENCH.format(port=port))
        reader = dds.Reader("AcsSamples", bench="card", late=False)
        with page.running(FOLDER, sys.executable, FOLDER / "card.py", port):
            with page.running(FOLDER, PROGRAMS / "dyncal-acs", FOLDER / "page.toml"):
                got = 0
                for block in reader.messages(timeout_s=PATIENCE_S):
                    got += block.sample_count
                    if got > 20_000:
                        break
        self.assertGreater(got, 20_000)

    def test_the_programs_of_the_page_read_results_and_recordings(self):
        demo = FOLDER / "demo"
        shutil.rmtree(demo, ignore_errors=True)
        (FOLDER / "results.py").write_text(page.programs()["results.py"])
        recordings = FOLDER / "recordings"
        shutil.rmtree(recordings, ignore_errors=True)
        domain = os.environ["DYNCAL_DOMAIN"]
        words = ["--folder", recordings, "--domain", domain, "--runs-only"]
        with page.running(FOLDER, PROGRAMS / "dyncal-recorder", *words):
            with subprocess.Popen(
                [sys.executable, FOLDER / "results.py", "*"], stdout=subprocess.PIPE, text=True
            ) as shown:
                words = ["--preset", "mpu9250-ptb", "--repetitions", "1", "--duration", "0.5"]
                words += ["--domain", domain, "--output", str(demo)]
                done = subprocess.run(
                    [PROGRAMS / "dyncal", "demo", *words], capture_output=True, check=False
                )
                self.assertIn(done.returncode, (0, 1), done.stderr)
                printed = shown.communicate(timeout=PATIENCE_S)[0].splitlines()
        result = dyncal.read_result(next(demo.rglob("result.json")))
        stated = {
            f"{row.channel} {row.frequency_text_hz} {row.magnitude} {row.phase_rad}"
            for row in result.points().itertuples()
        }
        self.assertGreater(len(stated), 17)
        self.assertEqual(stated - set(printed), set())
        self.check_recording(sorted(recordings.glob("*/*.mcap"))[0])

    def check_recording(self, path):
        exported = FOLDER / "recording.npz"
        exported.unlink(missing_ok=True)
        subprocess.run(
            [PROGRAMS / "dyncal", "export", path, "--output", exported],
            check=True,
            capture_output=True,
        )
        recording = dyncal.read_recording(path)
        with np.load(exported) as tables:
            self.assertGreaterEqual(len(tables.files), 3)
            for name in set(tables.files) - {"contents_json"}:
                table, source = tables[name], recording.source(name)
                np.testing.assert_array_equal(table["sample_number"], source.sample_number)
                np.testing.assert_array_equal(table["t_ns"], source.stamps_ns)
                for channel in source.channels:
                    np.testing.assert_array_equal(table[channel], source[channel])
                self.assertEqual(len(source.to_pandas()), len(table))
                self.assertEqual(source.to_xarray().sizes["sample"], len(table))


if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
