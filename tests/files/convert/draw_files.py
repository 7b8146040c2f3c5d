"""Draws files of each format with its public library, and what they hold."""

import random
import struct

import numpy as np
import obspy
import pyarrow
import pyarrow.parquet
import pyuff
import xdf_bytes

START_NS = 1_700_000_000_000_037_000


class Expected:
    """A series as it must be read: channels {name: (unit, values)}."""

    def __init__(self, group, stamps_ns, numbers, channels, untrusted=0):
        self.group, self.channels, self.untrusted = group, channels, untrusted
        self.stamps_ns = np.asarray(stamps_ns, dtype=np.int64)
        self.numbers = np.asarray(numbers, dtype=np.int64)


def drawn_values(rng, dtype, count):
    if np.issubdtype(dtype, np.integer):
        limits = np.iinfo(dtype)
        top = min(limits.max, 2**53)
        return rng.integers(max(limits.min, -top), top, count, dtype=dtype)
    return (rng.standard_normal(count) * 10.0 ** rng.integers(-6, 6)).astype(dtype)


def uff_set(draw, rng, name, count, rate_hz):
    is_binary = draw.random() < 0.5
    is_double = is_binary or draw.random() < 0.5  # in binary the library writes nothing else
    values = drawn_values(rng, np.float64 if is_double else np.float32, count).astype(np.float64)
    data = pyuff.prepare_58(
        binary=int(is_binary), func_type=1, rsp_node=draw.randint(1, 99), rsp_dir=3,
        ref_dir=3, ref_node=1, ver_num=1, load_case_id=0, orddenom_spec_data_type=0,
        ordinate_spec_data_type=12, abscissa_spec_data_type=17, z_axis_spec_data_type=0,
        data=values, x=np.arange(count) / rate_hz, id1=name,
        rsp_ent_name="NONE", ref_ent_name="NONE", abscissa_spacing=1, abscissa_min=0.0,
        abscissa_inc=1.0 / rate_hz, num_pts=count, ord_data_type=4 if is_double else 2,
        ordinate_axis_units_lab=draw.choice(["m/s^2", "V"]))
    return data


def draw_uff(path, seed):
    draw, rng = random.Random(seed), np.random.default_rng(seed)
    count, rate_hz = draw.randint(10, 3000), draw.choice([1000, 2000, 12800, 51200])
    sets = [uff_set(draw, rng, f"point {i}", count, rate_hz) for i in range(draw.randint(1, 3))]
    path.unlink(missing_ok=True)
    for one in sets:  # "overwrite" would lose what comes before numbers in binary
        pyuff.UFF(str(path)).write_sets(one, mode="add", force_double=False)
    read = pyuff.UFF(str(path)).read_sets()
    read = read if isinstance(read, list) else [read]
    stamps = np.round(np.arange(count) * (1e9 / rate_hz)).astype(np.int64)
    channels = {f"point_{i}": (one["ordinate_axis_units_lab"].strip(), one["data"])
                for i, one in enumerate(read)}
    return [Expected("uff58", stamps, np.arange(count), channels)], ["--rate", str(rate_hz)]


def draw_miniseed(path, seed):
    """Segments of records with gaps between them; of some the timing quality is poor."""
    draw, rng = random.Random(seed), np.random.default_rng(seed)
    rate_hz = draw.choice([1, 20, 100, 200, 500])
    dtype = draw.choice([np.int32, np.float32, np.float64])
    names = ["HNX", "HNY"][: draw.randint(1, 2)]
    interval_ns, first = 10**9 // rate_hz, 0
    numbers, stamps, segments = [], [], {name: [] for name in names}
    poor = 0
    content = b""
    for _ in range(draw.randint(1, 4)):
        count = draw.randint(3, 2000)
        start_ns = START_NS + first * interval_ns
        quality = draw.choice([0, 1, 77, 100])
        for name in names:
            values = drawn_values(rng, dtype, count) % 2**20 if dtype == np.int32 else \
                drawn_values(rng, dtype, count)
            segments[name].append(values)
            content += records(values, name, start_ns, rate_hz, quality, draw.choice([256, 512]))
        poor += count if quality == 0 else 0
        numbers.append(np.arange(first, first + count))
        stamps.append(START_NS + np.arange(first, first + count) * interval_ns)
        first += count + draw.choice([0, 1, 7, 100000])
    path.write_bytes(content)
    channels = {name.lower(): ("", np.concatenate(segments[name])) for name in names}
    stamps, numbers = np.concatenate(stamps), np.concatenate(numbers)
    return [Expected("XX.DRAWN.00", stamps, numbers, channels, poor)], []


def records(values, channel, start_ns, rate_hz, quality, length):
    """Bytes of a segment, with its timing quality in every record."""
    import io  # pylint: disable=import-outside-toplevel
    trace = obspy.Trace(values, {"network": "XX", "station": "DRAWN", "location": "00",
                                 "channel": channel, "sampling_rate": rate_hz,
                                 "starttime": obspy.UTCDateTime(ns=start_ns)})
    # 37 us of START_NS make the library write blockette 1001, which holds the quality.
    written = io.BytesIO()
    obspy.Stream([trace]).write(written, format="MSEED", reclen=length, byteorder=">")
    whole = bytearray(written.getvalue())
    return b"".join(with_quality(bytes(whole[i : i + length]), quality)
                    for i in range(0, len(whole), length))


def with_quality(record, quality):
    """In its blockette 1001."""
    changed = bytearray(record)
    at = struct.unpack_from(">H", record, 46)[0]
    while at:
        kind, following = struct.unpack_from(">HH", record, at)
        if kind == 1001:
            changed[at + 4] = quality
            return bytes(changed)
        at = following
    raise ValueError("has no blockette 1001")


def draw_parquet(path, seed):
    draw, rng = random.Random(seed), np.random.default_rng(seed)
    count = draw.randint(1, 5000)
    numbers = np.cumsum(rng.choice([1, 1, 1, 1, 9], count)) if draw.random() < 0.5 else None
    stamps = START_NS + np.cumsum(rng.integers(10**5, 2 * 10**6, count))
    is_typed = draw.random() < 0.5
    time = pyarrow.array(stamps, pyarrow.timestamp("ns", tz="UTC")) if is_typed else stamps
    fields, arrays, channels = [], [], {}
    for i, dtype in enumerate(draw.sample([np.float64, np.float32, np.int16, np.int64], 3)):
        values = drawn_values(rng, dtype, count)
        mask = rng.random(count) < draw.choice([0.0, 0.2])
        array = pyarrow.array(values, mask=mask)
        fields.append(pyarrow.field(f"c{i} [V]" if i else "c0", array.type,
                                    metadata=None if i else {"unit": "m/s^2"}))
        arrays.append(array)
        channels[f"c{i}"] = ("V" if i else "m/s^2",
                             np.where(mask, np.nan, values.astype(np.float64)))
    fields.append(pyarrow.field("time" if is_typed else "t_ns", pyarrow.array(time).type))
    arrays.append(pyarrow.array(time))
    fields.append(pyarrow.field("remark", pyarrow.string()))
    arrays.append(pyarrow.array(["x"] * count))
    if numbers is not None:
        fields.append(pyarrow.field("sample_number", pyarrow.int64()))
        arrays.append(pyarrow.array(numbers))
    table = pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields))
    pyarrow.parquet.write_table(table, path)
    numbers = np.arange(count) if numbers is None else numbers
    return [Expected(path.stem, stamps, numbers, channels)], []


def drawn_stream(draw, rng, number, name):
    """A regular stream that is sent in pieces, each late by its way, with samples lost."""
    rate_hz, kind = draw.choice([100, 500, 1000]), draw.choice(list(xdf_bytes.FORMATS))
    dtype = np.dtype(xdf_bytes.FORMATS[kind])
    labels = [(f"a{i}", "V") for i in range(draw.randint(1, 3))]
    count = draw.randint(3, 8) * rate_hz
    numbers = np.arange(count)
    for _ in range(draw.randint(0, 2)):
        begin = draw.randint(rate_hz, len(numbers) - rate_hz)
        numbers = np.concatenate([numbers[:begin], numbers[begin + draw.randint(5, rate_hz):]])
    origin, ppm = draw.uniform(1e3, 1e5), draw.uniform(-50, 50)
    values = np.stack([drawn_values(rng, dtype, len(numbers)) for _ in labels], axis=1)
    content = xdf_bytes.header_chunk(number, name, labels, rate_hz, kind)
    at = 0
    while at < len(numbers):
        size = draw.randint(1, 32)
        part = numbers[at : at + size]
        # Of a piece without a gap in it; all its stamps are late alike.
        breaks = np.flatnonzero(np.diff(part) > 1)
        part = part[: breaks[0] + 1] if len(breaks) else part
        late = rng.exponential(0.04 / rate_hz)
        stamps = origin + part / rate_hz * (1 + 1e-6 * ppm) + late
        rows = values[at : at + len(part)].tolist()
        content += xdf_bytes.samples_chunk(number, kind, stamps, rows)
        at += len(part)
    for i in range(10):
        content += xdf_bytes.offset_chunk(number, origin + 0.5 * i, 12.5 + rng.normal(0, 2e-5))
    return content + xdf_bytes.footer_chunk(number, len(numbers)), labels, values, numbers


def draw_xdf(path, seed):
    import pyxdf  # pylint: disable=import-outside-toplevel
    draw, rng = random.Random(seed), np.random.default_rng(seed)
    chunks, drawn = b"", []
    for number in range(1, draw.randint(1, 3) + 1):
        content, *what = drawn_stream(draw, rng, number, f"stream {number}")
        chunks += content
        drawn.append(what)
    words = xdf_bytes.header_chunk(99, "words", [("w", "")], 0, "string")
    words += xdf_bytes.samples_chunk(99, "string", [1.0], [["begin"]])
    path.write_bytes(xdf_bytes.file_bytes(chunks + words + xdf_bytes.footer_chunk(99, 1)))
    streams, _ = pyxdf.load_xdf(str(path), dejitter_timestamps=False)
    expected = []
    for stream, (labels, values, numbers) in zip(streams, drawn):
        channels = {label: (unit, values[:, i].astype(np.float64))
                    for i, (label, unit) in enumerate(labels)}
        stamps = np.round(stream["time_stamps"] * 1e9).astype(np.int64)
        expected.append(Expected(stream["info"]["name"][0], stamps, numbers, channels))
    return expected, []


DRAW = {"uff": draw_uff, "mseed": draw_miniseed, "parquet": draw_parquet, "xdf": draw_xdf}
