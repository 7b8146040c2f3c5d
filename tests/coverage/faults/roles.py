"""Channels in roles that they are not made for, and units that are right although unusual."""

import functools

from class_presets import SERIES, bench
from expected_row import VALUE, Row
from faults.fault import Fault
from judgement import COVERED_NO_FLAG, FLAGGED


class Exchanged(Fault):
    """Two roles have each other's channel."""

    def __init__(self, calibration, rng, first, second):
        super().__init__(calibration, rng)
        self.first, self.second = first, second

    def bench_tables(self, tables):
        method = dict(tables["method"])

        def channel(role):
            return method[role][0] if role == "dut" else method[role]

        def name(role, text):
            method[role] = [text] if role == "dut" else text

        first, second = channel(self.first), channel(self.second)
        name(self.first, second)
        name(self.second, first)
        return {**tables, "method": method}


class InUnits(Fault):
    """The bench file gives these units, in place of m/s^2 and V; none: it gives none at all."""

    def __init__(self, calibration, rng, motion="", sync=""):
        super().__init__(calibration, rng)
        self.units = {"m/s^2": motion, "V": sync}

    def bench_tables(self, tables):
        changed = {}
        for name, table in tables.items():
            if "units" in table:
                units = {channel: self.units[unit] for channel, unit in table["units"].items()}
                table = {key: value for key, value in table.items() if key != "units"}
                if any(units.values()):
                    table["units"] = units
            changed[name] = table
        return changed


def exchanged(*roles, **settings):
    return bench(settings, fault=functools.partial(Exchanged, first=roles[0], second=roles[1]))


CLASSES = {
    "reference and sync of the ACS exchanged": exchanged("reference", "sync_acs"),
    "series, reference and sync of the ACS exchanged": exchanged("reference", "sync_acs", **SERIES),
    "sensor and sync of the DAU exchanged": exchanged("dut", "sync_dau"),
    "series, a sensor in V as reference": bench(
        SERIES, fault=functools.partial(InUnits, motion="V", sync="V")
    ),
    "clean, velocities, and the current of the exciter as sync": bench(
        fault=functools.partial(InUnits, motion="m/s", sync=r"\ampere")
    ),
    "clean, no units": bench(fault=InUnits),
}

EXPECTED = [
    Row("reference and sync of the ACS exchanged", VALUE, FLAGGED),
    Row("series, reference and sync of the ACS exchanged", VALUE, FLAGGED),
    Row("sensor and sync of the DAU exchanged", VALUE, FLAGGED),
    Row("series, a sensor in V as reference", VALUE, FLAGGED),
    Row("clean, velocities, and the current of the exciter as sync", VALUE, COVERED_NO_FLAG),
    Row("clean, no units", VALUE, COVERED_NO_FLAG),
]
