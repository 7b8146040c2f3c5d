"""Messages of dyncal as they are stored in recordings: XCDR1 (plain CDR), little or big endian.

Sequences of numbers come as numpy arrays that look into the message, without a copy where they are
aligned in it. `decode` raises Error (bad_file) on what is not a whole message.
"""

from __future__ import annotations

import re
import struct
from typing import Any

import numpy

from .errors import Error
from .members import ENUMS, STRUCTS

HEADER_BYTES = 4
NUMBERS = {
    "boolean": "?",
    "octet": "u1",
    "long": "i4",
    "unsigned long": "u4",
    "long long": "i8",
    "unsigned long long": "u8",
    "double": "f8",
}
SEQUENCE = re.compile(r"sequence<(.+)>")


class Reading:
    """A payload, and how far it has been read."""

    def __init__(self, payload: bytes) -> None:
        self.data = memoryview(payload)[HEADER_BYTES:]
        self.order = "<" if payload[1] & 1 else ">"
        self.place = 0

    def numbers(self, kind: str, count: int) -> Any:
        """As many of an IDL type, (count,), without a copy. Raises ValueError at the end."""
        form = numpy.dtype(self.order + NUMBERS[kind])
        if not count:
            return numpy.empty(0, form)
        self.place += -self.place % form.itemsize
        taken = numpy.frombuffer(self.data, form, count, self.place)
        self.place += count * form.itemsize
        return taken

    def number(self, kind: str) -> Any:
        """One of an IDL type."""
        return self.numbers(kind, 1)[0].item()

    def text(self) -> str:
        """A string of IDL. Raises ValueError where it is cut."""
        length = self.number("unsigned long")
        raw = bytes(self.data[self.place : self.place + length])
        if len(raw) != length or not raw.endswith(b"\0"):
            raise ValueError("a text is cut off")
        self.place += length
        return raw[:-1].decode()

    def value(self, kind: str) -> Any:
        """Of any type of the contract: number, text, enum as its word, list, dict."""
        if kind in NUMBERS:
            return self.number(kind)
        if kind.startswith("string"):
            return self.text()
        if kind in ENUMS:
            return ENUMS[kind][self.number("unsigned long")]
        if found := SEQUENCE.fullmatch(kind):
            count = self.number("unsigned long")
            if found[1] in NUMBERS:
                return self.numbers(found[1], count)
            return [self.value(found[1]) for _ in range(count)]
        return {name: self.value(member) for name, member in STRUCTS[kind]}


def decode(struct_name: str, payload: bytes) -> dict[str, Any]:
    """The members of a message by name; enums as their words."""
    name = struct_name.rpartition("::")[2]
    if name not in STRUCTS:
        raise Error("bad_file", f"there is no message '{struct_name}'")
    try:
        message: dict[str, Any] = Reading(payload).value(name)
        return message
    except (ValueError, IndexError, UnicodeDecodeError, struct.error) as error:
        raise Error("bad_file", f"a message {name} is not whole: {error}") from None
