"""What the bridge hands to its plugs. Plain data that is not changed any more; any thread."""

from __future__ import annotations

import dataclasses
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

Kind = Literal["state", "source", "point", "transfer_function"]
Members = dict[str, Any]  # as JSON has them: what is not known or not a number is None


class BridgeError(Exception):
    """One sentence: what, where, what to do about it."""


@dataclasses.dataclass(frozen=True)
class Document:
    """JSON of one thing of a bench, which takes the place of the one before of the same name.

    name: of the kind "source" the source, of "point" channel, step and repetition, of
    "transfer_function" the channel; empty of "state". run: that it belongs to; empty of a source.
    time_ns: when it was written, UTC by the clock of the computer that wrote it.
    """

    kind: Kind
    bench: str
    name: tuple[str, ...]
    run: str
    members: Members
    time_ns: int

    @property
    def key(self) -> tuple[str, ...]:
        return (self.kind, self.bench, *self.name)


@dataclasses.dataclass(frozen=True)
class NewRun:
    """Results of earlier runs of this bench do not count any more."""

    bench: str
    run: str

    @property
    def key(self) -> tuple[str, ...]:
        return ("new run", self.bench)


@dataclasses.dataclass(frozen=True)
class ChannelSamples:
    """Samples of one channel, decimated: one row for each `step` samples of the source.

    values: the first sample of each step; minima and maxima: over the samples of the step that
    came in the same block. NaN is not measured. times_ns: UTC of the rows, for showing alone.
    """

    bench: str
    source: str
    channel: str
    unit: str
    session: int
    step: int
    numbers: npt.NDArray[np.uint64]  # of the first sample of each step, in the session
    stamps_ns: npt.NDArray[np.int64]  # in the time base of the source
    times_ns: npt.NDArray[np.int64]
    values: npt.NDArray[np.float64]
    minima: npt.NDArray[np.float64]
    maxima: npt.NDArray[np.float64]


Item = Document | NewRun | ChannelSamples
