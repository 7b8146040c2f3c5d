#!/usr/bin/env python3
"""Holds result files of dyncal, or files of `dyncal model`, against their schema.

    check_result.py SCHEMA RESULT.json...

Exit status 0: all agree; 1: one does not, each deviation on a line; 77: python3-jsonschema is not
installed, and nothing was checked.
"""

import json
import pathlib
import sys

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("RESULTS WERE NOT CHECKED against their schema: python3-jsonschema is not installed")
    sys.exit(77)

MAX_DEVIATIONS = 5  # of a file


def refuse_constant(name):
    raise ValueError(f"{name} is not JSON; a number that is none is null")


def strict(schema):
    """Readers ignore what a later version may have added; what this one writes is all described."""
    if isinstance(schema, list):
        return [strict(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    closed = {name: strict(one) for name, one in schema.items()}
    if isinstance(schema.get("type"), (str, list)) and "properties" in schema:
        closed.setdefault("additionalProperties", False)
    return closed


def deviations(schema, text):
    """Sentences on how a result deviates, each with its place."""
    try:
        result = json.loads(text, parse_constant=refuse_constant)
    except ValueError as error:
        return [str(error)]
    errors = Draft202012Validator(strict(schema)).iter_errors(result)
    found = [f"{error.json_path}: {error.message[:300]}" for error in errors]
    if not found and "flag_legend" in result:
        found += undeclared_flags(result)
    return found


def undeclared_flags(result):
    """A flag of a value must be explained in the file."""
    explained = {meaning["name"] for meaning in result["flag_legend"]}
    for place in ("points", "transfer_function", "channels", "sample_clock"):
        for i, one in enumerate(result[place]):
            if len(one["flags"]) != len(one["flag_names"]):
                yield f"$.{place}[{i}]: flags and flag_names are not of one length"
            for name in set(one["flag_names"]) - explained:
                yield f"$.{place}[{i}]: the flag {name} is not explained in $.flags"


def main(schema_path, *paths):
    schema = json.loads(pathlib.Path(schema_path).read_text())
    wrong = False
    for path in paths:
        for sentence in deviations(schema, pathlib.Path(path).read_text())[:MAX_DEVIATIONS]:
            wrong = True
            print(f"{path}: {sentence}")
    return 1 if wrong else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
