"""MiniSEED 2 (library: obspy), record by record.

The stamp of a sample is the start of its record and its place there, as the digitiser sent it. A
record that begins half an interval or more after the one before it has ended leaves a gap of the
sample numbers; one that begins as much before is an overlap, which is refused. A record whose time
tag the digitiser calls questionable, or whose timing quality is below the limit, has stamps that
are not trusted. Starts and timing qualities of all records are kept.
"""

import dataclasses
import io
import pathlib
from typing import Any

import numpy as np

from dyncal_convert.series import (
    STAMP_NOT_TRUSTED,
    Channel,
    Conversion,
    ConversionError,
    Series,
    grouped,
    library,
    regular_stamps,
)

TIME_TAG_QUESTIONABLE = 1 << 7  # of the data quality flags
MOST_OF_RECORD = 1 << 16  # bytes that hold every blockette of a header
MULTIPLE = 128  # the shortest record, in bytes
NO_QUALITY = -1


@dataclasses.dataclass
class Record:
    offset: int
    start_ns: int
    rate_hz: float
    values: Any
    quality_percent: int  # NO_QUALITY: not stated
    is_questionable: bool

    @property
    def interval_ns(self) -> float:
        return 1e9 / self.rate_hz


def header_of(content: bytes, offset: int, path: pathlib.Path) -> dict[str, Any]:
    util = library("obspy.io.mseed.util", "mseed")
    piece = content[offset : offset + MOST_OF_RECORD]
    piece = piece[: len(piece) // MULTIPLE * MULTIPLE]
    place = f"{path}: record at byte {offset}"
    if len(piece) < MULTIPLE:
        raise ConversionError(f"{place}: has {len(content) - offset} bytes: the file is cut")
    if piece[6:7] not in b"DRQM":
        raise ConversionError(f"{place}: is no record of MiniSEED 2")
    try:
        header: dict[str, Any] = util.get_record_information(io.BytesIO(piece))
    except Exception as problem:
        raise ConversionError(f"{place}: is no record of MiniSEED 2: {problem}") from problem
    length = int(header["record_length"])
    if len(content) - offset < length:
        raise ConversionError(
            f"{place}: states {length} bytes and has {len(content) - offset}: the file is cut"
        )
    return header


def record_of(content: bytes, offset: int, header: dict[str, Any], path: pathlib.Path) -> Record:
    obspy = library("obspy", "mseed")
    place = f"{path}: record at byte {offset}"
    piece = content[offset : offset + int(header["record_length"])]
    try:
        stream = obspy.read(io.BytesIO(piece), format="MSEED")
    except Exception as problem:
        raise ConversionError(f"{place}: cannot be decoded: {problem}") from problem
    count = int(header["npts"])
    if len(stream) != 1 or len(stream[0].data) != count:
        raise ConversionError(f"{place}: does not hold the {count} samples that it states")
    return Record(
        offset,
        int(stream[0].stats.starttime.ns),
        float(header["samp_rate"]),
        stream[0].data,
        int(header.get("timing_quality", NO_QUALITY)),
        bool(int(header["data_quality_flags"]) & TIME_TAG_QUESTIONABLE),
    )


def records_of(content: bytes, path: pathlib.Path) -> dict[tuple[str, str], list[Record]]:
    """By station and channel."""
    found: dict[tuple[str, str], list[Record]] = {}
    offset = 0
    while offset < len(content):
        header = header_of(content, offset, path)
        if int(header["npts"]) > 0 and float(header["samp_rate"]) > 0.0:
            station = ".".join(header[key] for key in ("network", "station", "location"))
            of_channel = found.setdefault((station, header["channel"]), [])
            of_channel.append(record_of(content, offset, header, path))
        offset += int(header["record_length"])
    return found


def numbers_of(records: list[Record], place: str) -> list[int]:
    """The number of each record's first sample."""
    numbers = [0]
    for before, after in zip(records, records[1:]):
        if after.rate_hz != before.rate_hz:
            raise ConversionError(
                f"{place}: the record at byte {after.offset} has {after.rate_hz} Hz, those before "
                f"it {before.rate_hz} Hz: convert them one by one"
            )
        expected_ns = before.start_ns + len(before.values) * before.interval_ns
        late = (after.start_ns - expected_ns) / before.interval_ns
        if late <= -0.5:
            raise ConversionError(
                f"{place}: the record at byte {after.offset} begins {-late:.3g} samples before the "
                f"one at byte {before.offset} has ended: take overlaps out of the file first"
            )
        lost = int(np.floor(late + 0.5))
        numbers.append(numbers[-1] + len(before.values) + lost)
    return numbers


def series_of(
    station: str, channel: str, records: list[Record], least_percent: int, path: pathlib.Path
) -> Series:
    records.sort(key=lambda record: record.start_ns)
    numbers = numbers_of(records, f"{path}: {station}.{channel}")
    stamps, samples, flags = [], [], []
    for record, first in zip(records, numbers):
        count = len(record.values)
        stamps.append(regular_stamps(record.start_ns, 1.0 / record.rate_hz, count))
        samples.append(np.arange(first, first + count, dtype=np.uint64))
        is_poor = NO_QUALITY < record.quality_percent < least_percent or record.is_questionable
        flags.append(np.full(count, STAMP_NOT_TRUSTED if is_poor else 0, dtype=np.uint8))
    starts = np.array([record.start_ns for record in records], dtype=np.int64)
    qualities = np.array([record.quality_percent for record in records], dtype=np.int16)
    return Series(
        name=station,
        stamps_ns=np.concatenate(stamps),
        sample_numbers=np.concatenate(samples),
        channels=[Channel(channel, np.concatenate([record.values for record in records]))],
        stamp_flags=np.concatenate(flags),
        device=station,
        is_utc=True,
        quality={
            f"{channel}_record_start": ("\\nano\\second", starts),
            f"{channel}_timing_quality": ("\\percent", qualities),
        },
    )


def read(path: pathlib.Path, least_percent: int) -> Conversion:
    library("obspy", "mseed")
    try:
        content = path.read_bytes()
    except OSError as problem:
        raise ConversionError(f"{path}: cannot be read: {problem.strerror}") from problem
    found = records_of(content, path)
    series = [
        series_of(station, channel, records, least_percent, path)
        for (station, channel), records in sorted(found.items())
    ]
    result = Conversion(series=grouped(series))
    result.notes += [
        f"{path}: {one.name} has no units in MiniSEED: its values are counts, state units or scale "
        f"in the bench file"
        for one in result.series
    ]
    return result
