"""Records drawn from a seed, DYNCAL_PYTHON_SEED or 1: a sine of a drawn frequency with irregular
stamps and noise, sometimes with a second line, a drift or rounded values."""

import os

import numpy as np

SEED = int(os.environ.get("DYNCAL_PYTHON_SEED", "1"))
COUNT = int(os.environ.get("DYNCAL_PYTHON_DRAWS", "40"))


class Record:
    def __init__(self, number):
        rng = np.random.default_rng((SEED, number))
        self.frequency = f"{rng.uniform(5, 400):.{rng.integers(0, 5)}f}"
        rate_hz = float(self.frequency) * rng.uniform(4, 60)
        samples = int(rng.integers(200, 20_000))
        steps = rng.normal(1e9 / rate_hz, rng.choice([0.0, 1e-4, 5e-3]) * 1e9 / rate_hz, samples)
        begin = int(rng.integers(0, 1_800_000_000)) * 1_000_000_000
        self.stamps_ns = begin + np.cumsum(np.maximum(steps, 1.0)).round().astype(np.int64)
        phase = 2 * np.pi * float(self.frequency) * (self.stamps_ns - begin) * 1e-9
        self.channels = {}
        for name in ("x", "y", "z")[: rng.integers(1, 4)]:
            values = rng.uniform(0.1, 100) * np.sin(phase + rng.uniform(-3, 3)) + rng.normal()
            values += rng.choice([1e-6, 1e-3, 0.05]) * rng.standard_normal(samples)
            if rng.random() < 0.3:
                values = np.round(values, 3)
            self.channels[name] = np.ascontiguousarray(values)

    def save(self, path):
        columns = [("t_ns", "<i8"), *((name, "<f8") for name in self.channels)]
        table = np.empty(len(self.stamps_ns), columns)
        table["t_ns"] = self.stamps_ns
        for name, values in self.channels.items():
            table[name] = values
        np.save(path, table)


def records():
    return [Record(number) for number in range(COUNT)]
