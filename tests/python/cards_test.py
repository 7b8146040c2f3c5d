"""The programs of deploy/guide/python.md for vendors' SDKs, into a real dyncal-acs:
cards_test.py PROGRAMS FOLDER

openDAQ with its simulator, an LSL stream, a libiio context over the network. Each is skipped with a
line where its package or its library cannot be had.
"""

import importlib
import os
import pathlib
import socket
import sys
import threading
import time
import unittest

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(TOP / "tests"))
from dds_domain import own_dds_domain  # noqa: E402

os.environ["DYNCAL_DOMAIN"] = str(own_dds_domain())
import page  # noqa: E402
from emulated_iiod import SCALES, EmulatedIiod  # noqa: E402

import dyncal  # noqa: E402
from dyncal import dds  # noqa: E402

LINES = 11
RATE = 20_000
SAMPLES = 2 * RATE
PATIENCE_S = 120
SKIPPED = []


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


class Cards(unittest.TestCase):
    def needs(self, package):
        try:
            importlib.import_module(package)
        except Exception as error:  # the library under it has errors of its own
            SKIPPED.append(package)
            print(f"SKIPPED: {package} cannot be used: {error}")
            self.skipTest(str(error))

    def recorded(self, name, *words):
        """Description, stamps in s and values (channel, sample) of a program's ACS."""
        program, port = page.programs()[name], free_port()
        self.assertLessEqual(page.lines_of_code(program), LINES, name)
        (FOLDER / name).write_text(program)
        (FOLDER / "card.toml").write_text(page.BENCH.format(port=port))
        told = dds.Reader("SourceDescription", bench="card")
        reader = dds.Reader("AcsSamples", bench="card", late=False)
        blocks, count = [], 0
        with page.running(FOLDER, sys.executable, FOLDER / name, port, *words):
            with page.running(FOLDER, PROGRAMS / "dyncal-acs", FOLDER / "card.toml"):
                for block in reader.messages(timeout_s=PATIENCE_S):
                    if block.sample_count:
                        blocks.append(block)
                        count += block.sample_count
                    if count >= SAMPLES:
                        break
                description = next(told.messages(timeout_s=PATIENCE_S))
        self.assertGreaterEqual(count, SAMPLES)
        for one, following in zip(blocks, blocks[1:]):
            self.assertEqual(following.first_sample, one.first_sample + one.sample_count, "gap")
        values = np.concatenate([np.reshape(one.values, (2, -1)) for one in blocks], axis=1)
        return description, np.arange(count) / RATE, values

    def test_opendaq(self):
        self.needs("opendaq")
        description, t, values = self.recorded("opendaq_card.py")
        self.assertEqual((description.device, description.serial), ("RefDev0", "DevSer0"))
        for fit in dyncal.fit_record((t * 1e9).astype(np.int64), list(values)).fits:
            self.assertAlmostEqual(fit.amplitude, 5.0, delta=1e-3)  # of the simulator, 10 Hz

    def test_lsl(self):
        self.needs("pylsl")
        import pylsl

        outlet = pylsl.StreamOutlet(
            pylsl.StreamInfo(f"Amplifier {os.getpid()}", "EEG", 2, RATE, "double64", "uid17")
        )
        ended = threading.Event()

        def push():
            first, begin = 0, time.monotonic()
            while not ended.is_set():
                n = np.arange(first, first + RATE // 50, dtype=float)
                outlet.push_chunk(np.column_stack([n, -n]))
                first += len(n)
                ended.wait(max(0.0, begin + first / RATE - time.monotonic()))

        pushing = threading.Thread(target=push)
        pushing.start()
        try:
            description, _, values = self.recorded("lsl_card.py", f"Amplifier {os.getpid()}")
        finally:
            ended.set()
            pushing.join()
        self.assertEqual(description.serial, "uid17")
        np.testing.assert_array_equal(np.diff(values[0]), 1.0)
        np.testing.assert_array_equal(values[1], -values[0])

    def test_libiio(self):
        self.needs("iio")

        def block_of(first, count):
            n = np.arange(first, first + count, dtype=np.int32) % 4_000_000
            return np.column_stack([n, -n])

        with EmulatedIiod(RATE, block_of) as context:
            description, _, values = self.recorded("iio_card.py", context)
        scale = float(SCALES["voltage1"])
        self.assertEqual(description.device, "adc")
        self.assertEqual([one.resolution for one in description.channels], [scale, scale])
        counts = values[0] / scale
        np.testing.assert_allclose(np.diff(counts), 1.0, atol=1e-6)
        np.testing.assert_array_equal(values[1], -values[0])


if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    done = unittest.main(argv=sys.argv[:1], exit=False).result
    sys.exit(1 if not done.wasSuccessful() else 77 if len(SKIPPED) == 3 else 0)
