"""A recorded series, whatever file it comes from, and what may be wrong with one.

Stamps are int64 nanoseconds since 1970 (UTC, or a clock of their own that may begin at 0), of every
sample. Sample numbers rise; where samples are missing they leave a gap, which dyncal counts as lost
and fits across by the stamps. A value that is missing by itself is NaN.
"""

import dataclasses
import importlib
import types
from typing import Any

import numpy as np
import numpy.typing as npt

# Bits of Stamp_flags that dyncal knows (drivers/sample_block.hpp): such a stamp is counted, and its
# sample takes no part in results.
STAMP_NOT_TRUSTED = 1 << 5

Stamps = npt.NDArray[np.int64]
Values = npt.NDArray[Any]


class ConversionError(Exception):
    """One sentence: file, place, what is wrong, what to do."""


@dataclasses.dataclass
class Channel:
    name: str
    values: Values
    unit: str = ""


@dataclasses.dataclass
class Series:
    """Channels whose samples have been taken at the same instants."""

    name: str
    stamps_ns: Stamps
    sample_numbers: npt.NDArray[np.uint64]
    channels: list[Channel]
    u_stamp_ns: int = 0  # standard uncertainty of its stamps; 0: not known
    stamp_flags: npt.NDArray[np.uint8] | None = None
    device: str = ""
    is_utc: bool = False
    # What the file says of its stamps, kept as it is beside the samples: {name: (unit, numbers)}
    quality: dict[str, tuple[str, Values]] = dataclasses.field(default_factory=dict)

    @property
    def lost(self) -> int:
        """Samples that are missing between the first and the last."""
        if len(self.sample_numbers) == 0:
            return 0
        span = int(self.sample_numbers[-1]) - int(self.sample_numbers[0]) + 1
        return span - len(self.sample_numbers)


@dataclasses.dataclass
class Conversion:
    """All series of a file, and sentences on what was left out or is to be known of it."""

    series: list[Series] = dataclasses.field(default_factory=list)
    notes: list[str] = dataclasses.field(default_factory=list)


def library(name: str, extra: str) -> types.ModuleType:
    """A library that only one format needs."""
    try:
        return importlib.import_module(name)
    except ImportError as missing:
        raise ConversionError(
            f"the Python library {name.partition('.')[0]} is missing: "
            f"pip install 'dyncal-convert[{extra}]', or pip install {name.partition('.')[0]}"
        ) from missing


def regular_stamps(start_ns: int, interval_s: float, count: int) -> Stamps:
    """start + i * interval, rounded to ns once."""
    steps = np.round(np.arange(count, dtype=np.float64) * (interval_s * 1e9))
    return start_ns + steps.astype(np.int64)


def grouped(series: list[Series]) -> list[Series]:
    """Joins those of one instrument whose samples have the same instants, numbers and flags."""
    joined: list[Series] = []
    for one in series:
        for other in joined:
            if is_of_same_instants(one, other):
                other.channels += one.channels
                other.quality.update(one.quality)
                break
        else:
            joined.append(one)
    return joined


def is_of_same_instants(one: Series, other: Series) -> bool:
    def equal(a: npt.NDArray[Any] | None, b: npt.NDArray[Any] | None) -> bool:
        return (a is None and b is None) or (
            a is not None and b is not None and np.array_equal(a, b)
        )

    return (
        one.device == other.device
        and one.u_stamp_ns == other.u_stamp_ns
        and equal(one.stamps_ns, other.stamps_ns)
        and equal(one.sample_numbers, other.sample_numbers)
        and equal(one.stamp_flags, other.stamp_flags)
    )


def unique(name: str, taken: set[str]) -> str:
    """The name, with a number behind it where it is taken; taken from then on."""
    candidate, number = name, 1
    while candidate in taken:
        number += 1
        candidate = f"{name}_{number}"
    taken.add(candidate)
    return candidate
