"""The messages in Python are those of the IDL: contract_test.py EVERY_TOPIC FOLDER

EVERY_TOPIC writes a recording of drawn messages of every topic, encoded by dyncal. Decoded and
encoded again by the public cyclonedds package with the types of the wheel they are the same bytes,
and what reads recordings without DDS finds the same members.
"""

import dataclasses
import enum
import pathlib
import subprocess
import sys
import unittest

import numpy as np
from mcap.reader import make_reader

from dyncal import cdr, dds
from dyncal.dds import types

HEADER_BYTES = 4


def plain(value):
    """As cdr.decode has it."""
    if isinstance(value, enum.Enum):
        return value.name
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value)]
        return {name: plain(getattr(value, name)) for name in names}
    return [plain(one) for one in value] if isinstance(value, list) else value


def same(one, other):
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(other, np.ndarray):
        may_be_nan = other.dtype.kind == "f"
        return np.array_equal(np.asarray(one, other.dtype), other, equal_nan=may_be_nan)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other or (one != one and other != other)


class Contract(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        FOLDER.mkdir(parents=True, exist_ok=True)
        recording = FOLDER / "every-topic.mcap"
        recording.unlink(missing_ok=True)
        subprocess.run([EVERY_TOPIC, recording], check=True)
        with recording.open("rb") as stream:
            cls.messages = [
                (channel.topic.rpartition("/")[2], schema.name, message.data)
                for schema, channel, message in make_reader(stream).iter_messages()
            ]

    def test_every_message_is_the_same_bytes_again(self):
        topics = set()
        for topic, name, data in self.messages:
            message = getattr(types, name.rpartition("::")[2]).deserialize(data)
            again = bytes(message.serialize())
            known, ours = data[HEADER_BYTES:], again[HEADER_BYTES:]
            longer, shorter = max(known, ours, key=len), min(known, ours, key=len)
            self.assertEqual(longer[: len(shorter)], shorter, name)
            self.assertLess(len(longer) - len(shorter), 4, name)  # padding alone
            topics.add(topic)
        self.assertGreaterEqual(topics, set(dds.TOPICS) - {"RecorderStatus"})

    def test_members_are_read_without_dds(self):
        for _, name, data in self.messages:
            message = getattr(types, name.rpartition("::")[2]).deserialize(data)
            self.assertTrue(same(plain(message), cdr.decode(name, data)), name)

    def test_a_message_that_is_cut_is_refused(self):
        from dyncal import Error

        for _, name, data in self.messages[:200]:
            for length in range(HEADER_BYTES, len(data) - 8, 7):
                with self.assertRaises(Error):
                    cdr.decode(name, data[:length])

    def test_topics_have_the_types_of_the_contract(self):
        found = {(topic, name.rpartition("::")[2]) for topic, name, _ in self.messages}
        for topic, name in found:
            if topic in dds.TOPICS:
                self.assertEqual(dds.TOPICS[topic][0].__name__, name)


if __name__ == "__main__":
    EVERY_TOPIC, FOLDER = map(pathlib.Path, sys.argv[1:3])
    unittest.main(argv=sys.argv[:1])
