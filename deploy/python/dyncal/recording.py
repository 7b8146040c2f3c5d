"""Recordings (.mcap of a run folder or of dyncal-recorder) as numpy arrays, pandas and xarray.

Every block is taken in the order of its number, blocks that came twice once. Stamps are whole
nanoseconds in the time base of their source, exact; lost samples stay visible as gaps of
`sample_number`, a restart as another `session`; NaN was not measured. Needs the `mcap` package:
pip install dyncal[recording].
"""

from __future__ import annotations

import dataclasses
import os
import pathlib
from typing import TYPE_CHECKING, Any

import numpy
import numpy.typing

from .cdr import decode
from .errors import Error

if TYPE_CHECKING:
    import pandas
    import xarray

SAMPLES = ("DauSamples", "AcsSamples", "CanSamples")
DESCRIPTION = "SourceDescription"


@dataclasses.dataclass
class Source:
    """What one instrument recorded.

    sample_number: uint64 (n,); session: uint64 (n,); stamps_ns: int64 (n,), in `time_base`;
    flags: uint8 (n,), not 0: the stamp is not trusted (idl/README.md); values: float64 (channels,
    n), in `units`: a row is contiguous, as fit_sine wants it. description: SourceDescription.
    """

    bench: str
    name: str
    sample_number: numpy.typing.NDArray[numpy.uint64]
    session: numpy.typing.NDArray[numpy.uint64]
    stamps_ns: numpy.typing.NDArray[numpy.int64]
    flags: numpy.typing.NDArray[numpy.uint8]
    values: numpy.typing.NDArray[numpy.float64]
    description: dict[str, Any]

    @property
    def channels(self) -> list[str]:
        return [channel["name"] for channel in self.description["channels"]]

    @property
    def units(self) -> list[str]:
        """D-SI, a channel each."""
        return [channel["unit"] for channel in self.description["channels"]]

    @property
    def time_base(self) -> str:
        """"TIME_BASE_LOCAL" or "TIME_BASE_UTC"."""
        return str(self.description["time_base"])

    def __getitem__(self, channel: str) -> numpy.typing.NDArray[numpy.float64]:
        if channel not in self.channels:
            raise Error(
                "invalid_argument",
                f"{self.name} has no channel '{channel}'; it has {', '.join(self.channels)}",
            )
        row: numpy.typing.NDArray[numpy.float64] = self.values[self.channels.index(channel)]
        return row

    def to_pandas(self) -> pandas.DataFrame:
        """A row a sample: sample_number, session, stamps_ns, flags, and the channels."""
        import pandas

        columns: dict[str, Any] = {
            "sample_number": self.sample_number,
            "session": self.session,
            "stamps_ns": self.stamps_ns,
            "flags": self.flags,
        }
        return pandas.DataFrame(columns | dict(zip(self.channels, self.values)))

    def to_xarray(self) -> xarray.Dataset:
        """Channels over `sample`; stamps, numbers, sessions and flags are coordinates."""
        import xarray

        variables: dict[str, Any] = {
            name: ("sample", row, {"units": unit})
            for name, unit, row in zip(self.channels, self.units, self.values)
        }
        coordinates: dict[str, Any] = {
            "stamps_ns": ("sample", self.stamps_ns, {"time_base": self.time_base}),
            "sample_number": ("sample", self.sample_number),
            "session": ("sample", self.session),
            "flags": ("sample", self.flags),
        }
        return xarray.Dataset(
            variables, coordinates, {"bench": self.bench, "source": self.name}
        )


@dataclasses.dataclass
class Recording:
    """sources: by "bench/source". messages: how many of each topic the file has."""

    sources: dict[str, Source]
    messages: dict[str, int]

    def source(self, name: str) -> Source:
        """By "bench/source", or by "source" where only one bench has it. Raises Error."""
        found = [key for key in self.sources if name in (key, key.partition("/")[2])]
        if len(found) != 1:
            raise Error(
                "invalid_argument",
                f"{len(found)} sources are '{name}'; there are {', '.join(self.sources)}",
            )
        return self.sources[found[0]]


def read_recording(path: str | os.PathLike[str]) -> Recording:
    """All samples of a recording; a folder stands for the recording.mcap in it.

    Raises Error (bad_file), ImportError without the `mcap` package.
    """
    from mcap.exceptions import McapError
    from mcap.reader import make_reader

    file = pathlib.Path(path)
    file = file / "recording.mcap" if file.is_dir() else file
    blocks: dict[str, dict[tuple[int, int], dict[str, Any]]] = {}
    descriptions: dict[str, dict[str, Any]] = {}
    counts: dict[str, int] = {}
    try:
        with file.open("rb") as stream:
            reader = make_reader(stream, validate_crcs=True)
            for schema, channel, message in reader.iter_messages(log_time_order=False):
                topic = channel.topic.rpartition("/")[2]
                counts[topic] = counts.get(topic, 0) + 1
                if schema is None or topic not in (*SAMPLES, DESCRIPTION):
                    continue
                content = decode(schema.name, message.data)
                key = f"{content['bench']}/{content['source']}"
                if topic == DESCRIPTION:
                    descriptions[key] = content
                elif content["sample_count"]:
                    number = content["session"], content["block"]
                    blocks.setdefault(key, {}).setdefault(number, content)
    except (OSError, McapError) as error:
        raise Error("bad_file", f"{file}: cannot be read as a recording: {error}") from None
    sources = {
        key: _joined(file, key, list(found.values()), descriptions.get(key))
        for key, found in sorted(blocks.items())
    }
    return Recording(sources, counts)


def _joined(
    file: pathlib.Path, key: str, blocks: list[dict[str, Any]], description: dict[str, Any] | None
) -> Source:
    if description is None:
        raise Error("bad_file", f"{file}: {key} has samples, but no description of its channels")
    # Sessions in the order in which they came, the blocks of one by their numbers.
    sessions = list(dict.fromkeys(block["session"] for block in blocks))
    blocks.sort(key=lambda block: (sessions.index(block["session"]), block["block"]))
    width = len(description["channels"])
    for block in blocks:
        if block["channel_count"] != width or len(block["values"]) != width * block["sample_count"]:
            raise Error(
                "bad_file",
                f"{file}: block {block['block']} of {key} has not the {width} channels of its "
                "description",
            )
    counts = [block["sample_count"] for block in blocks]
    bench, _, name = key.partition("/")
    return Source(
        bench,
        name,
        numpy.concatenate(
            [
                numpy.arange(count, dtype=numpy.uint64) + numpy.uint64(block["first_sample"])
                for block, count in zip(blocks, counts)
            ]
        ),
        numpy.repeat(numpy.array([block["session"] for block in blocks], numpy.uint64), counts),
        numpy.concatenate([_stamps(block) for block in blocks]),
        numpy.concatenate(
            [
                (
                    block["stamp_flags"].astype(numpy.uint8)
                    if len(block["stamp_flags"])
                    else numpy.zeros(count, numpy.uint8)
                )
                for block, count in zip(blocks, counts)
            ]
        ),
        numpy.ascontiguousarray(
            numpy.concatenate([block["values"].reshape(width, -1) for block in blocks], axis=1),
            numpy.float64,
        ),
        description,
    )


def _stamps(block: dict[str, Any]) -> numpy.typing.NDArray[numpy.int64]:
    stamps: numpy.typing.NDArray[numpy.int64]
    if len(block["stamps_ns"]):
        stamps = block["stamps_ns"].astype(numpy.int64)
        return stamps
    # Exact, halves rounded up (idl/README.md, SampleBlock): the first in integers of any size, the
    # others from its remainder.
    over, under = block["interval_numerator_ns"], block["interval_denominator"]
    count = block["sample_count"]
    whole, rest = divmod(2 * block["first_sample"] * over + under, 2 * under)
    first = block["origin_ns"] + whole
    if 2 * (count * over + under) < 2**62:
        stamps = first + (rest + 2 * over * numpy.arange(count, dtype=numpy.int64)) // (2 * under)
        return stamps
    return numpy.array(
        [first + (rest + 2 * over * i) // (2 * under) for i in range(count)], numpy.int64
    )
