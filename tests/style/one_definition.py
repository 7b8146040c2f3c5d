#!/usr/bin/env python3
"""Of each name of a type there is one in its namespace (the language's one definition rule).

Two types of one name in two headers compile as long as no file includes both. Then the linker
keeps one of their destructors for objects of both, and a program frees what it never had. Neither
compiler nor linker says so.
"""

import collections
import re

from tree import CODE, TOP, conclude, tracked

FOLDERS = ("analysis", "drivers", "idl", "services", "tests")
NO_CODE = re.compile(
    r"""//[^\n]* | /\*.*?\*/ | R"(\w*)\(.*?\)\1" | "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])'""",
    re.S | re.X,
)
OPENING = re.compile(
    r"""\bnamespace \s* (?P<namespace>(?:inline\s+|[\w:])*) \s* \{
      | \b(?:struct|class|enum|union) \s+ (?P<type>\w+) \s* (?:final\s*)? (?::(?!:)[^;{()]*)? \{
      | \{ | \}""",
    re.X,
)


def types_of(text):
    """Full names of the types defined outside functions, types and nameless namespaces."""
    open_braces = []
    for found in OPENING.finditer(NO_CODE.sub(" ", text)):
        namespace, name = found["namespace"], found["type"]
        if found[0] == "}":
            open_braces = open_braces[:-1]
            continue
        if name and all(open_braces):
            yield "::".join([*open_braces, name])
        open_braces.append(namespace)


def main():
    paths = [path for path in tracked(*FOLDERS) if path.suffix in CODE]
    files = collections.defaultdict(set)
    for path in paths:
        for name in types_of((TOP / path).read_text()):
            files[name].add(str(path))
    if not files:
        raise SystemExit("no type found: the check would pass on nothing")
    # Test programs are linked from some of these files each.
    findings = [
        f"{name} is defined in {', '.join(sorted(places))}: give one of them another name"
        for name, places in sorted(files.items())
        if len(places) > 1 and any(not place.startswith("tests/") for place in places)
    ]
    conclude(findings, f"names of {len(files)} types stand for two")


if __name__ == "__main__":
    main()
