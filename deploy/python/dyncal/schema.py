"""A JSON value held against a JSON Schema (2020-12), by the same rules and in the same words as the
programs: services/views/report/json_schema.hpp."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

TYPES = {
    "integer": "a whole number",
    "number": "a number",
    "string": "a text",
    "boolean": "true or false",
    "array": "a list",
    "object": "an object",
    "null": "null",
}
MAX_EXACT = 2.0**53
MAX_SHOWN = 60  # bytes
MAX_PATTERN = 4096
BOUNDS: dict[str, tuple[str, Callable[[float, float], bool]]] = {
    "minimum": ("at least", lambda number, limit: number < limit),
    "maximum": ("at most", lambda number, limit: number > limit),
    "exclusiveMinimum": ("above", lambda number, limit: number <= limit),
    "exclusiveMaximum": ("below", lambda number, limit: number >= limit),
}


class Deviation(Exception):
    """Its place grows from the inside out."""

    def __init__(self, what: str, place: str = "") -> None:
        super().__init__(what)
        self.what, self.place = what, place

    def within(self, name: str) -> Deviation:
        joins = not self.place or self.place.startswith("[")
        return Deviation(self.what, name + ("" if joins else ".") + self.place)


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_of_type(value: Any, name: str) -> bool:
    if name == "integer":
        if isinstance(value, float):
            return abs(value) <= MAX_EXACT and value == int(value)
        return is_number(value)
    if name == "number":
        return is_number(value)
    kinds: dict[str, Any] = {"string": str, "boolean": bool, "array": list, "object": dict}
    return value is None if name == "null" else isinstance(value, kinds[name])


def kind_of(value: Any) -> str:
    if is_number(value):
        return TYPES["number"]
    for name in ("string", "boolean", "array", "object"):
        if is_of_type(value, name):
            return TYPES[name]
    return TYPES["null"]


def shown(value: Any) -> str:
    """As it stands there, if it is short."""
    if isinstance(value, (dict, list)):
        return kind_of(value)
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text.encode()) <= MAX_SHOWN else "too long a text"


def listed(one_or_more: Any) -> list[Any]:
    return one_or_more if isinstance(one_or_more, list) else [one_or_more]


def same(one: Any, other: Any) -> bool:
    """True is not 1."""
    return isinstance(one, bool) == isinstance(other, bool) and bool(one == other)


class Check:
    def __init__(self, root: dict[str, Any]) -> None:
        self.root = root

    def check(self, schema: dict[str, Any], value: Any) -> None:
        """Raises the first deviation, in the alphabetical order of the schema's words."""
        for word, rule in sorted(schema.items()):
            if isinstance(value, dict):
                self.check_object(word, rule, schema, value)
            elif isinstance(value, list):
                self.check_list(word, rule, value)
            else:
                self.check_scalar(word, rule, value)
            self.check_any(word, rule, value)
        if "if" in schema:
            self.check_condition(schema, value)

    def check_any(self, word: str, rule: Any, value: Any) -> None:
        if word == "$ref":
            self.check(self.root["$defs"][rule.rpartition("/")[2]], value)
        elif word == "type" and not any(is_of_type(value, name) for name in listed(rule)):
            found = shown(value) if is_number(value) else kind_of(value)
            wanted = " or ".join(TYPES[name] for name in listed(rule))
            raise Deviation(f"is {found}, not {wanted}")
        elif word in ("enum", "const") and not any(same(value, one) for one in listed(rule)):
            known = ", ".join(shown(one) for one in listed(rule))
            raise Deviation(
                f"is {shown(value)}, which this version does not know; it knows {known}"
            )

    def check_scalar(self, word: str, rule: Any, value: Any) -> None:
        if word == "pattern" and isinstance(value, str):
            if len(value.encode()) > MAX_PATTERN or not re.search(rule, value):
                raise Deviation(f"is {shown(value)}, which has not the form {rule}")
        elif word in BOUNDS and is_number(value):
            bound, is_beyond = BOUNDS[word]
            if is_beyond(value, rule):
                raise Deviation(f"is {shown(value)}, but must be {bound} {json.dumps(rule)}")

    def check_list(self, word: str, rule: Any, value: list[Any]) -> None:
        if (word == "minItems" and len(value) < rule) or (word == "maxItems" and len(value) > rule):
            raise Deviation(f"has {len(value)} entries, not {rule}")
        if word == "items":
            for number, item in enumerate(value):
                try:
                    self.check(rule, item)
                except Deviation as found:
                    raise found.within(f"[{number}]") from None

    def check_object(
        self, word: str, rule: Any, schema: dict[str, Any], value: dict[str, Any]
    ) -> None:
        if word == "required":
            for name in rule:
                if name not in value:
                    raise Deviation("is missing", name)
        if word not in ("properties", "additionalProperties"):
            return
        described = schema.get("properties", {})
        for key, member in sorted(value.items()):
            if (key in described) == (word == "properties"):
                try:
                    self.check(rule[key] if word == "properties" else rule, member)
                except Deviation as found:
                    raise found.within(key) from None

    def check_condition(self, schema: dict[str, Any], value: Any) -> None:
        try:
            self.check(schema["if"], value)
            branch = "then"
        except Deviation:
            branch = "else"
        if branch in schema:
            self.check(schema[branch], value)


def deviation_from(schema: dict[str, Any], value: Any) -> str | None:
    """The first deviation as a sentence that begins with its place."""
    try:
        Check(schema).check(schema, value)
    except Deviation as found:
        return f"{found.place or 'the whole'} {found.what}"
    return None
