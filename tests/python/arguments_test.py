"""Arrays are taken as they are, or refused with a sentence; errors have a code."""

import pickle
import threading
import unittest

import drawn_records
import numpy as np

import dyncal


class Arguments(unittest.TestCase):
    def setUp(self):
        self.record = drawn_records.Record(0)
        self.t = self.record.stamps_ns
        self.y = next(iter(self.record.channels.values()))

    def refused(self, *words, frequency="80", t=None, y=None):
        with self.assertRaises(dyncal.Error) as caught:
            dyncal.fit_sine(frequency, self.t if t is None else t, self.y if y is None else y)
        self.assertEqual(caught.exception.code, "invalid_argument")
        for word in words:
            self.assertIn(word, str(caught.exception))

    def test_refuses_what_it_would_have_to_convert(self):
        self.refused("stamps_ns", "float64", "int64", t=self.t.astype(float))
        self.refused("stamps_ns", "list", t=list(self.t))
        self.refused("stamps_ns", "int32", t=np.arange(len(self.t), dtype=np.int32))
        self.refused("channels", "float32", "float64", y=self.y.astype(np.float32))
        self.refused("channels", "not contiguous", y=np.repeat(self.y, 2)[::2])
        self.refused("channels", "2 dimensions", y=np.stack([self.y, self.y]))
        self.refused("channels[1]", "float32", y=[self.y, self.y.astype(np.float32)])
        self.refused("channel 'b'", "int64", y={"a": self.y, "b": self.t})
        self.refused("80 Hz", frequency="80 Hz")
        self.refused("frequency", frequency=[80])

    def test_errors_of_the_library_keep_code_and_sentence(self):
        cases = {
            "too_few_samples": (self.t[:3], self.y[:3]),
            "stamps_not_increasing": (np.sort(self.t)[::-1].copy(), self.y),
            "not_finite": (self.t, np.full(len(self.t), np.nan)),
            "no_excitation": (self.t, np.random.default_rng(1).standard_normal(len(self.t))),
        }
        for code, (t, y) in cases.items():
            with self.subTest(code), self.assertRaises(dyncal.Error) as caught:
                dyncal.fit_sine(self.record.frequency, t, y)
            self.assertEqual(caught.exception.code, code)
            self.assertGreater(len(str(caught.exception)), 10)
        for hz in (0.0, -1.0, float("inf"), float("nan"), "1e9"):
            with self.subTest(hz), self.assertRaises(dyncal.Error) as caught:
                dyncal.fit_sine(hz, self.t, self.y)
            self.assertEqual(caught.exception.code, "frequency_out_of_range")
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((again.code, str(again)), (caught.exception.code, str(caught.exception)))

    def test_takes_arrays_without_a_copy(self):
        channel = dyncal.Channel("z", self.y)
        self.assertIs(channel.values, self.y)
        read_only = self.y.copy()
        read_only.setflags(write=False)
        fit = dyncal.fit_sine(self.record.frequency, self.t, read_only)
        self.assertEqual(fit.rss, dyncal.fit_sine(self.record.frequency, self.t, self.y).rss)

    def test_reads_the_memory_that_it_is_given(self):
        """A value that is changed in place changes the next fit of the same array."""
        y = self.y.copy()
        before = dyncal.fit_sine(self.record.frequency, self.t, y).rss
        y[len(y) // 2] += 1000.0
        self.assertGreater(dyncal.fit_sine(self.record.frequency, self.t, y).rss, before)

    def test_keeps_no_reference_to_arrays_after_a_call(self):
        import sys

        before = sys.getrefcount(self.y), sys.getrefcount(self.t)
        for _ in range(100):
            dyncal.fit_sine(self.record.frequency, self.t, [self.y])
        self.assertEqual((sys.getrefcount(self.y), sys.getrefcount(self.t)), before)

    def test_threads_get_the_same(self):
        found = []
        fit = lambda: found.append(dyncal.fit_sine(self.record.frequency, self.t, self.y).rss)
        threads = [threading.Thread(target=fit) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(found), 8)
        self.assertEqual(len(set(found)), 1)

    def test_every_public_name_says_what_it_is_for(self):
        functions = [getattr(dyncal, name) for name in dir(dyncal) if not name.startswith("_")]
        functions = [one for one in functions if callable(one) and not isinstance(one, type)]
        self.assertGreater(len(functions), 20)
        for function in functions:
            if getattr(function, "__module__", "").startswith("dyncal"):
                self.assertTrue(function.__doc__, function)


if __name__ == "__main__":
    unittest.main()
