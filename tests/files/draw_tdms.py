"""Draws TDMS files and what the public library (PyPI npTDMS) reads in them: runs in its Python.

    draw_tdms.py FOLDER COUNT SEED [FILE...]

Writes COUNT files with the library's own writer, and expected.json of these and of the files that
are named: of every channel with numbers its values, in a file of float64, its unit, its start and
interval. Scalings are applied to float64, as dyncal does; the library keeps float32 there.
"""

import json
import pathlib
import random
import sys

import nptdms
import numpy as np
from nptdms import types
from nptdms.base_segment import RawChannelDataChunk

UNIX_EPOCH_S = 2082844800
NUMBERS = [np.int8, np.int16, np.int32, np.int64, np.uint8, np.uint16, np.uint32, np.uint64,
           np.float32, np.float64, np.bool_, np.complex64, np.complex128]
NAMES = ["reference", "sync", "a'b", "''", "Spannung µV", "x y", "Dev1_ai0", "z"]


def drawn_values(rng, dtype, count):
    if dtype == np.bool_:
        return rng.integers(0, 2, count).astype(bool)
    if np.issubdtype(dtype, np.integer):
        limits = np.iinfo(dtype)
        return rng.integers(limits.min, limits.max, count, dtype=dtype, endpoint=True)
    if np.issubdtype(dtype, np.complexfloating):
        return (rng.standard_normal(count) + 1j * rng.standard_normal(count)).astype(dtype)
    return (rng.standard_normal(count) * 10.0 ** rng.integers(-9, 9)).astype(dtype)


def drawn_scaling(draw):
    """Properties of a chain of scalings."""
    properties = {}
    scales = draw.randint(1, 3)
    properties["NI_Number_Of_Scales"] = types.Uint32(scales)
    if draw.random() < 0.8:
        properties["NI_Scaling_Status"] = draw.choice(["unscaled", "unscaled", "scaled"])
    for scale in range(scales):
        kind = draw.choice(["Linear", "Polynomial"])
        begin = f"NI_Scale[{scale}]_"
        properties[begin + "Scale_Type"] = kind
        source = scale - 1 if scale and draw.random() < 0.8 else 0xFFFFFFFF
        properties[f"{begin}{kind}_Input_Source"] = types.Uint32(source)
        if kind == "Linear":
            properties[begin + "Linear_Slope"] = draw.uniform(-2, 2)
            properties[begin + "Linear_Y_Intercept"] = draw.uniform(-2, 2)
        else:
            size = draw.randint(0, 5)
            properties[begin + "Polynomial_Coefficients_Size"] = types.Uint32(size)
            for i in range(size):
                properties[f"{begin}Polynomial_Coefficients[{i}]"] = draw.uniform(-1, 1)
    return properties


def drawn_waveform(draw):
    properties = {}
    if draw.random() < 0.7:
        properties["wf_increment"] = draw.choice([1 / 51200, 1e-3, 1.0, draw.uniform(1e-6, 10.0)])
    if draw.random() < 0.6:
        properties["wf_start_time"] = np.datetime64(draw.randrange(-10**15, 4 * 10**15), "us")
    if draw.random() < 0.3:
        properties["wf_start_offset"] = draw.uniform(-10, 10)
    if draw.random() < 0.6:
        properties["unit_string"] = draw.choice(["V", "m/s^2", "µm"])
    if draw.random() < 0.2:
        properties["flag"] = True
        properties["count"] = draw.randrange(-(2**40), 2**40)
    return properties


def drawn_channels(draw, rng):
    """[(group, name, function that draws values, properties)]"""
    channels = {}
    for _ in range(draw.randint(1, 5)):
        group, name = draw.choice(["g", "Run'1"]), draw.choice(NAMES)
        kind = draw.random()
        if kind < 0.1:
            drawn = lambda count: ["text " * draw.randint(0, 3) for _ in range(count or 1)]
        elif kind < 0.2:
            drawn = lambda count: np.arange(count).astype("datetime64[us]")
        else:
            dtype = draw.choice(NUMBERS)
            drawn = lambda count, dtype=dtype: drawn_values(rng, dtype, count)
        properties = drawn_waveform(draw)
        is_real = kind >= 0.2 and not np.issubdtype(dtype, np.complexfloating)
        if is_real and dtype != np.bool_ and draw.random() < 0.4:
            properties.update(drawn_scaling(draw))
        channels[group, name] = (drawn, properties)
    return [(*names, *what) for names, what in channels.items()]


def draw_file(path, seed):
    draw, rng = random.Random(seed), np.random.default_rng(seed)
    channels = drawn_channels(draw, rng)
    same_length = draw.random() < 0.5
    has_complex = any(np.iscomplexobj(drawn(1)) for _, _, drawn, _ in channels)
    with nptdms.TdmsWriter(path, version=draw.choice([4712, 4713])) as writer:
        for segment in range(draw.randint(1, 5)):
            objects = []
            if draw.random() < 0.5:
                objects.append(nptdms.RootObject({"name": "drawn"}))
                is_scaled = not has_complex and draw.random() < 0.1
                group_scaling = drawn_scaling(draw) if is_scaled else {}
                objects.append(nptdms.GroupObject("g", group_scaling))
            length = draw.randint(0, 6000)
            for group, name, drawn, properties in channels:
                if not same_length and segment and draw.random() < 0.3:
                    continue
                count = length if same_length else draw.randint(0, 3000)
                stated = properties if segment == 0 or draw.random() < 0.3 else {}
                objects.append(nptdms.ChannelObject(group, name, drawn(count), stated))
            draw.shuffle(objects)
            writer.write_segment(objects)


def start_ns(properties):
    time = properties.get("wf_start_time")
    offset = round(properties.get("wf_start_offset", 0.0) * 1e9)
    if time is None:
        return offset
    seconds = time.seconds - UNIX_EPOCH_S
    return seconds * 10**9 + ((time.second_fractions * 10**9 + 2**63) >> 64) + offset


def as_float64(raw):
    """Raw values of a channel, for scalings."""
    if raw.data is not None:
        return RawChannelDataChunk.channel_data(raw.data.astype(np.float64))
    return RawChannelDataChunk.scaler_data(
        {scaler: data.astype(np.float64) for scaler, data in raw.scaler_data.items()})


def values_of(channel):
    """Channels of float64: one, or two of complex numbers."""
    if channel._scaling is not None:  # pylint: disable=protected-access
        raw = channel._raw_data  # pylint: disable=protected-access
        scaled = channel._scaling.scale(as_float64(_chunk(raw)))
        return [scaled]
    data = channel[:]
    if np.iscomplexobj(data):
        return [data.real.astype(np.float64), data.imag.astype(np.float64)]
    return [data.astype(np.float64)]


def _chunk(raw):
    if raw.scaler_data:
        return RawChannelDataChunk.scaler_data(raw.scaler_data)
    return RawChannelDataChunk.channel_data(raw.data)


def expected(path, folder):
    found = []
    with nptdms.TdmsFile.read(path, raw_timestamps=True) as file:
        for group in file.groups():
            for channel in group.channels():
                is_number = channel.data_type not in (types.String, types.TimeStamp, None)
                if not is_number or len(channel) == 0:
                    continue
                output = folder / f"{path.stem}.{len(found)}.values"
                np.concatenate(values_of(channel)).tofile(output)
                found.append({"group": group.name, "name": channel.name, "count": len(channel),
                              "values": str(output),
                              "unit": channel.properties.get("unit_string", ""),
                              "increment": channel.properties.get("wf_increment"),
                              "start_ns": start_ns(channel.properties)})
    return {"path": str(path), "channels": found}


def main():
    folder, count, seed = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    paths = [pathlib.Path(path) for path in sys.argv[4:]]
    for i in range(count):
        paths.append(folder / f"drawn_{i}.tdms")
        draw_file(paths[-1], seed + i)
    everything = [expected(path, folder) for path in paths]
    (folder / "expected.json").write_text(json.dumps(everything))


if __name__ == "__main__":
    main()
