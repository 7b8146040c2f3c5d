"""TOML of a dictionary, and tables put into tables: the standard library only reads it."""

import datetime
import json
import re


def key_text(key):
    return key if re.fullmatch(r"[\w-]+", key, re.ASCII) else json.dumps(key)


def value_text(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return "[" + ", ".join(map(value_text, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key_text(k)} = {value_text(v)}" for k, v in value.items()) + "}"
    if isinstance(value, datetime.date):
        return value.isoformat()
    return repr(value)


def to_toml(tables):
    """The first level as tables, what is deeper inline."""
    keys = {k: v for k, v in tables.items() if not isinstance(v, dict)}
    lines = [f"{key_text(key)} = {value_text(value)}" for key, value in keys.items()]
    for name, table in tables.items():
        if name not in keys:
            lines.append(f"[{key_text(name)}]")
            lines += [f"{key_text(key)} = {value_text(value)}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def put_into(tables, fragment):
    """A table that names another driver or kind replaces the one that is there."""
    for key, value in fragment.items():
        old = tables.get(key)
        both = isinstance(value, dict) and isinstance(old, dict)
        if both and not value.keys() & {"driver", "kind"}:
            put_into(old, value)
        else:
            tables[key] = value
    return tables
