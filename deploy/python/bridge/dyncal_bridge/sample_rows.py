"""Decimates the samples of a source to rows that people look at.

A row stands for `step` samples in turn, those of the numbers k * step to (k + 1) * step - 1: it has
the first of them and their minimum and maximum, so that what lies between the rows is not hidden:
the first values alone would show a sine above half of their rate as a slower one. A row of which a
sample is missing is left out. step = ceil(rate / max_rate_hz), where the rate is the nominal one,
or that of the stamps of the first block where there is none. One thread.
"""

from __future__ import annotations

import dataclasses
import math
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from dyncal_bridge.document import ChannelSamples

MAX_STEP = 1_000_000  # of samples that are kept for a row


def stamps_of(block: Any) -> npt.NDArray[np.int64]:
    """Stamps of the samples of a SampleBlock by idl/README.md: its own, or of a regular clock."""
    if len(block.stamps_ns):
        return np.asarray(block.stamps_ns, np.int64)
    over, under = block.interval_numerator_ns, max(block.interval_denominator, 1)
    whole, rest = divmod(2 * block.first_sample * over + under, 2 * under)
    first = block.origin_ns + whole
    count = block.sample_count
    return np.array([first + (rest + 2 * over * i) // (2 * under) for i in range(count)], np.int64)


@dataclasses.dataclass
class Samples:
    """Consecutive samples of all channels of a source; values: (channels, samples)."""

    session: int
    first: int
    stamps_ns: npt.NDArray[np.int64]
    times_ns: npt.NDArray[np.int64]
    values: npt.NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.stamps_ns)

    def between(self, begin: int, end: int) -> Samples:
        return Samples(
            self.session,
            self.first + begin,
            self.stamps_ns[begin:end],
            self.times_ns[begin:end],
            self.values[:, begin:end],
        )

    def followed_by(self, other: Samples) -> Samples | None:
        """Both in one; None where the other does not follow."""
        follows = self.session == other.session and self.first + len(self) == other.first
        if not follows or len(self.values) != len(other.values):
            return None
        return Samples(
            self.session,
            self.first,
            np.concatenate([self.stamps_ns, other.stamps_ns]),
            np.concatenate([self.times_ns, other.times_ns]),
            np.concatenate([self.values, other.values], axis=1),
        )


def samples_of(block: Any, is_utc: bool) -> Samples | None:
    """Of a SampleBlock; None of an empty one, or where its sizes contradict each other.

    Times are the stamps where those are UTC, else when the block arrived, less the way to its last
    sample by the stamps: good to see which belong together, for nothing else.
    """
    count, width = block.sample_count, block.channel_count
    stamped = len(block.stamps_ns) == count or block.interval_denominator > 0
    if not count or not stamped or len(block.values) != count * width:
        return None
    stamps = stamps_of(block)
    times = stamps if is_utc else stamps - stamps[-1] + block.received_utc_ns
    values = np.asarray(block.values, np.float64).reshape(width, count)
    return Samples(block.session, block.first_sample, stamps, times, values)


class Decimation:
    """Of one source for one plug."""

    def __init__(self, nominal_rate_hz: float, max_rate_hz: float) -> None:
        self._max_rate_hz = max_rate_hz
        self.step = self._step_at(nominal_rate_hz)
        self._rest: Samples | None = None

    def _step_at(self, rate_hz: float) -> int:
        """0: of a rate that is not known."""
        is_known = math.isfinite(rate_hz) and rate_hz > 0.0
        return min(math.ceil(rate_hz / self._max_rate_hz), MAX_STEP) if is_known else 0

    def rows(
        self, bench: str, source: str, channels: dict[int, tuple[str, str]], samples: Samples
    ) -> Iterator[ChannelSamples]:
        """Whole rows of the channels: {column: (name, unit)}."""
        if not self.step:
            span_ns = int(samples.stamps_ns[-1]) - int(samples.stamps_ns[0])
            self.step = self._step_at((len(samples) - 1) * 1e9 / span_ns if span_ns else 0.0)
            if not self.step:
                return
        joined = self._rest.followed_by(samples) if self._rest else None
        if joined is None:
            joined = samples.between(-samples.first % self.step, len(samples))
        count = len(joined) // self.step
        self._rest = joined.between(count * self.step, len(joined))
        if not count:
            return
        whole = joined.between(0, count * self.step)
        numbers = np.uint64(whole.first) + np.arange(count, dtype=np.uint64) * np.uint64(self.step)
        for column, (channel, unit) in channels.items():
            if column >= len(whole.values):
                continue
            parts = whole.values[column].reshape(count, self.step)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", RuntimeWarning)  # a row of NaN stays NaN
                minima, maxima = np.nanmin(parts, axis=1), np.nanmax(parts, axis=1)
            yield ChannelSamples(
                bench,
                source,
                channel,
                unit,
                whole.session,
                self.step,
                numbers,
                whole.stamps_ns[:: self.step],
                whole.times_ns[:: self.step],
                parts[:, 0].copy(),
                minima,
                maxima,
            )
