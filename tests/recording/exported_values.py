"""Compares the exports of one recording with each other, bit for bit:

    exported_values.py FILE.h5 FILE.npz FOLDER ROWS.mcap

h5py, numpy, the csv module and a walk through the MCAP file read them. Prints how many samples and
values were compared; fails with the first that differs.
"""

import csv
import json
import pathlib
import struct
import sys

import h5py
import numpy as np

import walk


def bits(values):
    """Of floating-point numbers, all NaN being one."""
    values = np.ascontiguousarray(values, dtype=np.float64)
    return np.where(np.isnan(values), np.nan, values).view(np.uint64)


def hdf5_channels(group):
    """The values of each channel by its name."""
    channels = {}
    for dataset in group.values():
        if "Channel" in dataset.attrs:
            for row, name in enumerate(dataset.attrs["Channel"]):
                channels[name.decode() if isinstance(name, bytes) else name] = dataset[row]
    return channels


def csv_columns(path):
    with open(path, newline="", encoding="utf-8") as stream:
        rows = csv.reader(stream)
        names = [name.split(" [")[0] for name in next(rows)]
        columns = list(zip(*rows))
    return dict(zip(names, columns))


def compare_source(name, rows, group, columns, messages):
    values = 0
    if "Absolutetime" in group:
        assert np.array_equal(rows["t_ns"], group["Absolutetime"][0].astype(np.int64)), name
        assert np.array_equal(rows["sample_number"], group["Sample_number"][0]), name
        assert np.array_equal(rows["stamp_flags"], group["Stamp_flags"][0]), name
        assert np.array_equal(rows["session"], group["Session"][0]), name
        assert int(rows["lost_before"].sum()) == int(group.attrs["Lost_samples"]), name
    assert np.array_equal(rows["t_ns"], np.array(columns["t_ns"], dtype=np.int64)), name
    assert len(messages) == len(rows), name
    for channel, column in hdf5_channels(group).items():
        expected = bits(rows[channel])
        assert np.array_equal(bits(column), expected), (name, channel, "HDF5")
        assert np.array_equal(bits(list(map(float, columns[channel]))), expected), (name, channel)
        place = rows.dtype.names.index(channel)
        by_rows = [struct.unpack_from("<d", data, 4 + 8 * place)[0] for data in messages]
        assert np.array_equal(bits(by_rows), expected), (name, channel, "MCAP")
        values += len(expected)
    return values


def main(hdf5, npz, folder, mcap):
    arrays = np.load(npz)
    contents = json.loads(bytes(arrays["contents_json"]))
    messages = {}
    for topic, data in walk.messages(mcap):
        messages.setdefault(topic, []).append(data)
    samples = values = 0
    with h5py.File(hdf5) as file:
        for source in contents["sources"]:
            name = source["name"]
            place = "RAWDATA" if name in file["RAWDATA"] else "TRIGGERED"
            rows = arrays[name]
            assert len(rows) == source["samples"] > 0, name
            columns = csv_columns(pathlib.Path(folder) / f"{name}.csv")
            values += compare_source(name, rows, file[place][name], columns, messages[name])
            samples += len(rows)
    print(json.dumps({"samples": samples, "values": values}))


if __name__ == "__main__":
    main(*sys.argv[1:])
