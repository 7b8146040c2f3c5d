"""JSON schemas of the documents for viewers of Foxglove's protocol.

Points and means have those of the result file, without what the viewers do not know: references,
"or null", patterns. Plain functions, any thread.
"""

from __future__ import annotations

import functools
import importlib.resources
import json
from typing import Any

Schema = dict[str, Any]
NUMBER: Schema = {"type": "number"}
TEXT: Schema = {"type": "string"}
WHOLE: Schema = {"type": "integer"}
TRUTH: Schema = {"type": "boolean"}


def described(title: str, properties: dict[str, Schema], description: str = "") -> Schema:
    schema: Schema = {"title": title, "type": "object", "properties": properties}
    return schema | ({"description": description} if description else {})


def plain(schema: Schema, whole: Schema) -> Schema:
    """Type, description, items and members alone."""
    if "$ref" in schema:
        named = whole["$defs"][schema["$ref"].rpartition("/")[2]]
        return plain(named | {key: schema[key] for key in schema if key != "$ref"}, whole)
    kinds = schema.get("type", "string")
    kind = kinds if isinstance(kinds, str) else next(one for one in kinds if one != "null")
    simple: Schema = {"type": kind}
    if "description" in schema:
        simple["description"] = schema["description"]
    if kind == "array":
        simple["items"] = plain(schema.get("items", TEXT), whole)
    if kind == "object":
        members = schema.get("properties", {})
        simple["properties"] = {name: plain(one, whole) for name, one in members.items()}
    return simple


@functools.cache
def result_schema() -> Schema:
    file = importlib.resources.files("dyncal").joinpath("result.schema.json")
    schema: Schema = json.loads(file.read_text())
    return schema


def rows_of_result(name: str) -> dict[str, Schema]:
    """The members of a row of `points`, `transfer_function` or `group_delay`."""
    whole = result_schema()
    return {
        member: plain(schema, whole)
        for member, schema in whole["properties"][name]["items"]["properties"].items()
        if member not in ("budget", "signals", "source_samples", "fit", "monte_carlo")
    }


def schema_of(kind: str) -> Schema:
    """kind: of a Document, or "samples"."""
    names = {"bench": TEXT, "run": TEXT}
    if kind == "point":
        return described("dyncal.Point", names | {"provisional": TRUTH} | rows_of_result("points"))
    if kind == "transfer_function":
        rows = {"type": "object", "properties": rows_of_result("transfer_function")}
        delay = {"type": "object", "properties": rows_of_result("group_delay")}
        texts = dict.fromkeys(("channel", "method", "unit", "group_delay_problem"), TEXT)
        lists = dict.fromkeys(("flags", "flag_names"), {"type": "array", "items": TEXT})
        means = {"transfer_function": {"type": "array", "items": rows}, "group_delay": delay}
        return described("dyncal.TransferFunction", names | texts | {"lost": WHOLE} | lists | means)
    if kind == "source":
        texts = dict.fromkeys(("source", "kind", "device", "serial", "state", "message"), TEXT)
        numbers = dict.fromkeys(("nominal_rate_hz", "rate_hz", "buffer_fill"), NUMBER)
        counts = ("received", "lost_in_device", "lost_in_transit", "duplicates", "rejected")
        wholes = dict.fromkeys((*counts, "stamps_not_trusted", "dropped_in_service"), WHOLE)
        return described("dyncal.Source", {"bench": TEXT} | texts | numbers | wholes)
    if kind == "state":
        texts = dict.fromkeys(("state", "message", "method", "excitation"), TEXT)
        analysis = ("analysis_arm", "analysis_health", "analysis_message", "frequency_text_hz")
        wholes = dict.fromkeys(("points", "planned_steps", "step", "repetition"), WHOLE)
        more = dict.fromkeys(analysis, TEXT) | {"level_m_s2": NUMBER}
        return described("dyncal.BenchState", names | texts | wholes | more)
    values = {name: NUMBER | {"description": what} for name, what in SAMPLE_MEMBERS.items()}
    return described("dyncal.Sample", {"number": WHOLE, "step": WHOLE} | values)


SAMPLE_MEMBERS = {
    "value": "the first sample of the row, in the channel's unit",
    "minimum": "of all samples of the row",
    "maximum": "of all samples of the row",
}
