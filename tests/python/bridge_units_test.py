"""The parts of dyncal-bridge by themselves: bridge_units_test.py FOLDER

Queues drop by their policy and count; settings that make no sense are refused with a sentence; rows
of samples are what their definition says, for drawn blocks with gaps; of several runs the newest
counts, and what falls silent is said to have; nothing grows beyond its bound.
"""

import os
import pathlib
import random
import subprocess
import sys
import threading
import unittest

import numpy as np

TOP = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = TOP / "deploy/python/bridge"
sys.path.insert(0, str(PACKAGE))
from dyncal.dds import types  # noqa: E402
from dyncal_bridge import bench_view, plug  # noqa: E402
from dyncal_bridge.bounded_queue import BoundedQueue  # noqa: E402
from dyncal_bridge.command import RevokedCertificates  # noqa: E402
from dyncal_bridge.document import Document, NewRun  # noqa: E402
from dyncal_bridge.sample_rows import Decimation, samples_of  # noqa: E402

SEED = int(os.environ.get("DYNCAL_PYTHON_SEED", "1"))
REFUSED = {
    "": "has none of the tables",
    "benches = 3\n[mqtt]": "benches: is 3, not a list of texts",
    'benches = ["a*"]\n[mqtt]': "'a*' is no name of a bench",
    "[mqqt]": "mqqt: there is no such key; there are benches, foxglove, mqtt, opcua",
    "mqtt = 3": "mqtt: is 3, not a table",
    "[foxglove]\nport = 3": "foxglove.port: there is no such key; there are listen, max_rate_hz",
    '[foxglove]\nlisten = "everywhere"': "foxglove.listen: is 'everywhere', not an address",
    '[foxglove]\nlisten = "127.0.0.1:70000"': "foxglove.listen: is '127.0.0.1:70000', not an",
    "[foxglove]\nmax_rate_hz = 0": "foxglove.max_rate_hz: is 0, not a rate from 0.001",
    "[foxglove]\nmax_rate_hz = nan": "foxglove.max_rate_hz: is nan, not a rate",
    "[foxglove]\nmax_rate_hz = true": "foxglove.max_rate_hz: is True, not a rate",
    '[foxglove]\ntls_key = "nothing.pem"': "nothing.pem cannot be read: No such file",
    '[foxglove]\ntls_key = "some.pem"': "foxglove.tls_key: needs tls_certificate as well",
    '[mqtt]\ntopic = "a/#"': "mqtt.topic: is 'a/#', but no topic may",
    '[mqtt]\ntopic = ""': "mqtt.topic: is '', but no topic may",
    '[mqtt]\nsamples = ["acc-1/dau"]': "mqtt.samples: 'acc-1/dau' is not BENCH/SOURCE/CHANNEL",
    '[mqtt]\npassword_file = "some.pem"': "mqtt.password_file: needs user as well",
    "[opcua]\nmax_clients = 0": "opcua.max_clients: is 0, not a whole number from 1",
    "[opcua": "is not TOML",
}


def check(*words, **variables):
    return subprocess.run(
        [sys.executable, "-B", "-m", "dyncal_bridge", *map(str, words)],
        env={**os.environ, "PYTHONPATH": str(PACKAGE), **variables},
        capture_output=True,
        text=True,
        check=False,
    )


class Queues(unittest.TestCase):
    def test_a_newer_document_takes_the_place_of_one_that_waits(self):
        queue = BoundedQueue(3, 3)
        for key, item in (("a", 1), ("b", 2), ("a", 3)):
            queue.put_document(key, item)
        self.assertEqual([queue.take(0), queue.take(0), queue.take(0)], [3, 2, None])
        self.assertEqual(queue.counts.replaced_documents, 1)
        self.assertEqual(queue.counts.dropped_documents, 0)
        self.assertEqual(queue.counts.taken, 2)

    def test_the_oldest_are_dropped_and_counted(self):
        queue = BoundedQueue(10, 5)
        for i in range(1000):
            queue.put_document(i, i)
            queue.put_samples(-i)
            self.assertLessEqual(len(queue), 15)
        self.assertEqual(queue.counts.dropped_documents, 990)
        self.assertEqual(queue.counts.dropped_samples, 995)
        left = [queue.take(0) for _ in range(15)]
        self.assertEqual(left, [*range(990, 1000), *range(-995, -1000, -1)])

    def test_who_puts_never_waits_for_who_does_not_take(self):
        queue, took = BoundedQueue(100, 100), []
        putting = threading.Thread(
            target=lambda: [queue.put_samples(i) for i in range(100_000)], daemon=True
        )
        putting.start()
        putting.join(60)
        self.assertFalse(putting.is_alive())
        self.assertEqual(queue.counts.dropped_samples, 99_900)
        waiting = threading.Thread(target=lambda: took.append(BoundedQueue(1, 1).take(0.05)))
        waiting.start()
        waiting.join(10)
        self.assertEqual(took, [None])

    def test_closing_wakes_who_waits(self):
        queue, took = BoundedQueue(1, 1), []
        waiting = threading.Thread(target=lambda: took.append(queue.take(600)))
        waiting.start()
        queue.close()
        waiting.join(10)
        self.assertEqual(took, [None])

    def test_what_waits_of_an_earlier_run_is_not_served(self):
        served = []

        class Slow(plug.Plug):
            def open(self):
                pass

            def close(self):
                pass

            def serve(self, item):
                served.append(item)
                if isinstance(item, Document) and item.run == "second":
                    self.stop()

        slow = Slow("slow", 1.0)
        old = Document("point", "b", ("c", "1", "1"), "first", {}, 0)
        new = Document("point", "b", ("c", "2", "1"), "second", {}, 0)
        for item in (NewRun("b", "first"), old, NewRun("b", "second"), new):
            slow.offer(item)
        slow.start()
        self.assertTrue(slow.join(20))
        self.assertEqual(served, [NewRun("b", "second"), new])


class SettingsFiles(unittest.TestCase):
    def test_what_makes_no_sense_is_refused_with_a_sentence(self):
        (FOLDER / "some.pem").write_text("")
        file = FOLDER / "refused.toml"
        sys.path.insert(0, str(PACKAGE))
        from dyncal_bridge.document import BridgeError
        from dyncal_bridge.settings import read_settings

        for text, sentence in REFUSED.items():
            with self.subTest(text):
                file.write_text(text)
                with self.assertRaises(BridgeError) as refused:
                    read_settings(file)
                self.assertIn(sentence, str(refused.exception))
                self.assertTrue(str(refused.exception).startswith(str(file)))

    def test_the_program_ends_with_2_and_one_line(self):
        file = FOLDER / "settings.toml"
        file.write_text("[foxglove]\n")
        cases = {
            (file, "--security", "folder"): "comes without the plug-ins of DDS Security",
            (file, "--domain", "233"): "'233' is no DDS domain",
            (FOLDER / "none.toml",): "none.toml: cannot be read: No such file",
            (file, "--no-such-option"): "--no-such-option",
        }
        for words, sentence in cases.items():
            with self.subTest(words):
                done = check(*words)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(sentence, done.stderr)
                self.assertNotIn("Traceback", done.stderr)
        secured = check(file, DYNCAL_SECURITY="folder")
        self.assertEqual(secured.returncode, 2, secured.stderr)
        self.assertIn("--security folder", secured.stderr)

    def test_settings_are_looked_at(self):
        file = FOLDER / "good.toml"
        file.write_text("[foxglove]\n[mqtt]\n[opcua]\n")
        done = check(file, "--check", "--dds", "fastdds")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("hands on to foxglove, mqtt, opcua", done.stdout)


class Revoked(unittest.TestCase):
    """Only another whole list counts, and only when it stays."""

    def list_of(self, text):
        return f"-----BEGIN X509 CRL-----\n{text}\n-----END X509 CRL-----\n"

    def test_what_counts_as_another_list(self):
        folder = FOLDER / "revoked"
        folder.mkdir(exist_ok=True)
        file = folder / "revoked.pem"
        first, second = self.list_of("first"), self.list_of("second")
        file.write_text(first)
        revoked = RevokedCertificates(str(folder))
        for text in (first, second[:-9], "", first):  # copied again, half copied, emptied
            file.write_text(text)
            self.assertEqual([revoked.have_changed() for _ in range(3)], [False] * 3, text)
        file.unlink()
        self.assertFalse(revoked.have_changed() or revoked.have_changed())
        file.write_text(second)
        self.assertEqual([revoked.have_changed() for _ in range(3)], [False, True, True])

    def test_nothing_is_looked_at_where_nothing_is_secured(self):
        revoked = RevokedCertificates("")
        self.assertFalse(revoked.have_changed() or revoked.have_changed())


class Rows(unittest.TestCase):
    def block(self, first, values, session=1):
        count = values.shape[1]
        return types.SampleBlock(
            bench="b",
            source="s",
            session=session,
            first_sample=first,
            sample_count=count,
            channel_count=len(values),
            origin_ns=5,
            interval_numerator_ns=10_000_007,
            interval_denominator=3,
            values=values.ravel().tolist(),
            received_utc_ns=10**18,
        )

    def test_drawn_blocks_with_gaps_become_whole_rows(self):
        draw = random.Random(SEED)
        for _ in range(50):
            step, rows, expected, first = draw.randint(1, 40), [], [], draw.randint(0, 10**11)
            decimation = Decimation(float(step) * 100, 100.0)
            self.assertEqual(decimation.step, step)
            present = {}
            for _ in range(30):
                values = np.array([[draw.gauss(0, 1) for _ in range(draw.randint(1, 60))]])
                first += draw.choice([0, 0, 0, 0, draw.randint(1, 100)])  # lost
                present |= dict(zip(range(first, first + values.shape[1]), values[0]))
                samples = samples_of(self.block(first, values), is_utc=False)
                rows += decimation.rows("b", "s", {0: ("c", "V")}, samples)
                first += values.shape[1]
            for at in range(min(present) // step, max(present) // step + 1):
                whole = [present.get(n) for n in range(at * step, (at + 1) * step)]
                if None not in whole:
                    expected.append((at * step, whole[0], min(whole), max(whole)))
            found = [
                one
                for row in rows
                for one in zip(row.numbers, row.values, row.minima, row.maxima)
            ]
            self.assertGreater(len(expected), 0)
            self.assertEqual(found, expected)

    def test_a_rate_that_is_not_stated_is_that_of_the_stamps(self):
        samples = samples_of(self.block(0, np.zeros((1, 31))), is_utc=True)  # every 3.3 ms
        decimation = Decimation(0.0, 100.0)
        rows = list(decimation.rows("b", "s", {0: ("c", "V")}, samples))
        self.assertEqual((decimation.step, len(rows[0].numbers)), (3, 10))

    def test_stamps_of_a_regular_clock_are_exact(self):
        first = 3 * 10**11 + 1
        samples = samples_of(self.block(first, np.zeros((2, 5))), is_utc=True)
        expected = [5 + (2 * n * 10_000_007 + 3) // 6 for n in range(first, first + 5)]
        self.assertEqual(samples.stamps_ns.tolist(), expected)
        self.assertEqual(samples.times_ns.tolist(), expected)

    def test_what_was_not_measured_hides_nothing(self):
        values = np.array([[np.nan, 2.0, np.nan, np.nan]])
        samples = samples_of(self.block(0, values), is_utc=True)
        (row,) = Decimation(200.0, 100.0).rows("b", "s", {0: ("c", "V")}, samples)
        np.testing.assert_array_equal(row.values, [np.nan, np.nan])
        np.testing.assert_array_equal(row.minima, [2.0, np.nan])

    def test_sizes_that_contradict_each_other_are_left_out(self):
        for change in ({"sample_count": 4}, {"channel_count": 3}, {"interval_denominator": 0}):
            block = self.block(0, np.zeros((2, 5)))
            for name, value in change.items():
                setattr(block, name, value)
            self.assertIsNone(samples_of(block, is_utc=True), change)


class View(unittest.TestCase):
    def result(self, run, step=1, bench="b", **more):
        return types.CalibrationResult(
            bench=bench, run=run, channel="dau/z", step=step, repetition=1, frequency_hz=40.0,
            valid=True, **more
        )

    def take(self, view, topic, message, time_ns, now_s=0.0):
        return list(view.take(topic, message, time_ns, now_s))

    def test_of_several_runs_the_newest_counts(self):
        view = bench_view.BenchView()
        first = self.take(view, "CalibrationResult", self.result("one"), 1000)
        self.assertEqual(first[0], NewRun("b", "one"))
        planned = types.Measurement(bench="b", run="two", planned_utc_ns=2000)
        self.assertEqual(self.take(view, "Measurement", planned, 3000)[0], NewRun("b", "two"))
        self.assertEqual(self.take(view, "CalibrationResult", self.result("one"), 1500), [])
        self.assertEqual(view.left_out.of_earlier_runs, 1)
        late = self.take(view, "CalibrationResult", self.result("two"), 2500)
        self.assertEqual([one.kind for one in late], ["point", "state"])
        self.assertEqual(late[1].members["points"], 1)

    def test_a_later_excitation_of_a_step_counts(self):
        view = bench_view.BenchView()
        self.take(view, "CalibrationResult", self.result("one", attempt=2, magnitude=2.0), 1)
        earlier = self.result("one", attempt=1, magnitude=1.0)
        self.assertEqual(self.take(view, "CalibrationResult", earlier, 2), [])

    def test_means_have_the_flags_of_their_points(self):
        view = bench_view.BenchView()
        self.take(view, "CalibrationResult",
                  self.result("one", flags=["5 lost"], flag_names=["samples_lost"]), 1)
        mean = types.TransferFunction(
            bench="b", run="one", channel="dau/z", flags=["w"], flag_names=["whole"],
            points=[types.TransferPoint(frequency_hz=40.0), types.TransferPoint(frequency_hz=41.0)],
        )
        (document,) = self.take(view, "TransferFunction", mean, 2)
        rows = document.members["transfer_function"]
        self.assertEqual([row["flag_names"] for row in rows],
                         [["samples_lost", "whole"], ["whole"]])

    def test_what_falls_silent_is_said_to_have(self):
        view = bench_view.BenchView()
        status = types.SourceStatus(
            bench="b", source="dau", state=types.SourceState.SOURCE_RUNNING
        )
        running = types.Measurement(
            bench="b", run="one", state=types.MeasurementState.MEASUREMENT_RUNNING
        )
        self.take(view, "SourceStatus", status, 1, 100.0)
        self.take(view, "Measurement", running, 1, 100.0)
        self.assertEqual(list(view.tick(102.0, 2)), [])
        (gone,) = view.tick(104.0, 2)
        self.assertEqual(gone.members["state"], "gone")
        (silent,) = view.tick(111.0, 2)
        self.assertEqual(silent.members["state"], "silent")
        self.assertEqual(list(view.tick(112.0, 2)), [])
        (again,) = self.take(view, "SourceStatus", status, 3, 113.0)
        self.assertEqual(again.members["state"], "running")
        back = self.take(view, "Measurement", running, 3, 113.0)
        self.assertEqual(back[-1].members["state"], "running")

    def test_foreign_names_take_no_more_than_the_bound(self):
        view = bench_view.BenchView()
        for i in range(200):
            self.take(view, "CalibrationResult", self.result("r", bench=f"bench-{i}"), 1)
            for topic in ("SourceDescription", "SourceStatus"):
                one = getattr(types, topic)(bench="bench-1", source=f"source-{i}")
                self.take(view, topic, one, 1)
        for step in range(20_000):
            self.take(view, "CalibrationResult", self.result("r", step, bench="bench-2"), 1)
        self.assertEqual(len(view.benches), bench_view.MAX_BENCHES)
        self.assertEqual(len(view.benches["bench-1"].sources), bench_view.MAX_SOURCES)
        points = sum(len(bench.points) for bench in view.benches.values())
        self.assertEqual(points, bench_view.MAX_POINTS)
        self.assertEqual(view.left_out.beyond_limits, 136 + 2 * 168 + 20_000 + 64 - 16_384 - 1)


if __name__ == "__main__":
    FOLDER = pathlib.Path(sys.argv[1]).resolve()
    FOLDER.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
