"""XDF of LabRecorder, streams of the Lab Streaming Layer (library: pyxdf).

Stamps are brought to the recorder's clock by the clock offsets, as pyxdf does, and otherwise stay
as they came: they are not smoothed. Their standard uncertainty is the scatter of the offsets about
the line through them; the offsets themselves are kept. The recorder's clock is no UTC.

A stream of a nominal rate has a gap where the interval of two stamps is longer than 1.5 sample
intervals and those that follow stay late: a stamp alone may be late on its way. How many samples
are missing is by how much later the earliest of the next second are than those of the second
before, or since the last gap; that is right where a second has stamps that were not late.
"""

import pathlib
from typing import Any

import numpy as np
import numpy.typing as npt

from dyncal_convert.series import Channel, Conversion, ConversionError, Series, library, unique

WINDOW_S = 1.0
LEAST_WINDOW = 8  # samples
GAP_INTERVALS = 1.5
CERTAIN_GAP = 3.0  # samples, whatever the rate really is
STREAM_HEADER, STREAM_FOOTER = 2, 6


def check_chunks(path: pathlib.Path) -> None:
    """That every chunk is whole: the library passes over one that is not."""
    content = path.read_bytes()
    if content[:4] != b"XDF:":
        raise ConversionError(f"{path}: does not begin with XDF: it is no XDF file")
    at, headers, footers = 4, 0, 0
    while at < len(content):
        size = content[at]
        start = at + 1 + size
        if size not in (1, 4, 8):
            raise ConversionError(f"{path}: byte {at}: is no beginning of a chunk")
        length = int.from_bytes(content[at + 1 : start], "little")
        if start + length > len(content) or length < 2:
            raise ConversionError(f"{path}: the chunk at byte {at} is not whole: the file is cut")
        tag = int.from_bytes(content[start : start + 2], "little")
        headers, footers = headers + (tag == STREAM_HEADER), footers + (tag == STREAM_FOOTER)
        at = start + length
    if footers < headers:
        raise ConversionError(
            f"{path}: {headers - footers} of {headers} streams have no end: the file is cut"
        )


def text_of(info: dict[str, Any], key: str) -> str:
    values = info.get(key) or [""]
    return str(values[0] or "")


def described_channels(info: dict[str, Any], count: int) -> list[tuple[str, str]]:
    """Label and unit of each, as far as the stream says."""
    try:
        described = info["desc"][0]["channels"][0]["channel"]
    except (KeyError, IndexError, TypeError):
        described = []
    named = []
    for i in range(count):
        one = described[i] if i < len(described) and isinstance(described[i], dict) else {}
        named.append((text_of(one, "label") or f"channel_{i + 1}", text_of(one, "unit")))
    return named


def lost_by(
    stamps_s: npt.NDArray[np.float64], interval_s: float, window: int, least: float
) -> npt.NDArray[np.int64]:
    """How many samples are missing before each, where that is at least so many."""
    lost = np.zeros(len(stamps_s), dtype=np.int64)
    late_s = stamps_s - interval_s * np.arange(len(stamps_s))
    begin = 0  # behind the last gap
    for i in (np.flatnonzero(np.diff(stamps_s) > GAP_INTERVALS * interval_s) + 1).tolist():
        before = late_s[max(begin, i - window) : i]
        after = late_s[i : i + window]
        later = float(after.min() - before.min()) / interval_s
        if later >= least:
            lost[i] = round(later)
            begin = i
    return lost


def mean_interval(
    stamps_s: npt.NDArray[np.float64], lost: npt.NDArray[np.int64], window: int
) -> float | None:
    """The median of intervals over many samples, none of them across a gap."""
    slopes = []
    for part in np.split(stamps_s, np.flatnonzero(lost)):
        reach = min(window, len(part) // 2)
        if reach >= LEAST_WINDOW:
            slopes.append((part[reach:] - part[:-reach]) / reach)
    return float(np.median(np.concatenate(slopes))) if slopes else None


def lost_before(stamps_s: npt.NDArray[np.float64], nominal_hz: float) -> npt.NDArray[np.int64]:
    """How many samples are missing before each."""
    if len(stamps_s) < 2 or nominal_hz <= 0.0:
        return np.zeros(len(stamps_s), dtype=np.int64)
    window = max(LEAST_WINDOW, round(WINDOW_S * nominal_hz))
    large = lost_by(stamps_s, 1.0 / nominal_hz, window, CERTAIN_GAP)
    interval_s = mean_interval(stamps_s, large, window) or 1.0 / nominal_hz
    return lost_by(stamps_s, interval_s, window, 0.5)


def scatter_of_offsets(stream: dict[str, Any]) -> float:
    """Standard deviation about a line, s; NaN: not known."""
    times = np.asarray(stream["clock_times"], dtype=np.float64)
    offsets = np.asarray(stream["clock_values"], dtype=np.float64)
    if len(times) < 3:
        return float("nan")
    around = times - times.mean()
    line = np.polynomial.polynomial.polyfit(around, offsets, 1)
    residuals = offsets - np.polynomial.polynomial.polyval(around, line)
    return float(np.sqrt(np.sum(residuals**2) / (len(times) - 2)))


def series_of(stream: dict[str, Any], place: str, name: str, notes: list[str]) -> Series:
    info = stream["info"]
    values = np.asarray(stream["time_series"])
    stamps_s = np.asarray(stream["time_stamps"], dtype=np.float64)
    stated = text_of(stream.get("footer", {}).get("info", {}), "sample_count")
    if stated and int(stated) != len(stamps_s):
        raise ConversionError(f"{place}: states {stated} samples and holds {len(stamps_s)}")
    nominal_hz = float(text_of(info, "nominal_srate") or 0.0)
    numbers = np.arange(len(stamps_s)) + np.cumsum(lost_before(stamps_s, nominal_hz))
    scatter_s = scatter_of_offsets(stream)
    if not np.isfinite(scatter_s):
        notes.append(f"{place}: has fewer than three clock offsets: u of its stamps is not known")
    u_ns = max(1, round(1e9 * scatter_s)) if np.isfinite(scatter_s) else 0
    channels = [
        Channel(label, values[:, i], unit)
        for i, (label, unit) in enumerate(described_channels(info, values.shape[1]))
    ]
    return Series(
        name=name,
        stamps_ns=np.round(stamps_s * 1e9).astype(np.int64),
        sample_numbers=numbers.astype(np.uint64),
        channels=channels,
        u_stamp_ns=min(u_ns, 2**32 - 1),
        device=text_of(info, "source_id") or text_of(info, "name"),
        quality={
            "clock_offset_times": ("\\second", np.asarray(stream["clock_times"], np.float64)),
            "clock_offsets": ("\\second", np.asarray(stream["clock_values"], np.float64)),
        },
    )


def read(path: pathlib.Path) -> Conversion:
    pyxdf = library("pyxdf", "xdf")
    try:
        check_chunks(path)
        streams, _ = pyxdf.load_xdf(str(path), synchronize_clocks=True, dejitter_timestamps=False)
    except ConversionError:
        raise
    except Exception as problem:
        raise ConversionError(f"{path}: cannot be read as XDF: {problem}") from problem
    result = Conversion()
    taken: set[str] = set()
    for stream in streams:
        name = text_of(stream["info"], "name") or "stream"
        place = f"{path}: stream '{name}'"
        if text_of(stream["info"], "channel_format") == "string":
            result.notes.append(f"{place} is of texts and left out")
        elif len(stream["time_stamps"]) == 0:
            result.notes.append(f"{place} has no samples and is left out")
        else:
            result.series.append(series_of(stream, place, unique(name, taken), result.notes))
    return result
