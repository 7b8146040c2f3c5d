#!/usr/bin/env python3
"""No block does nothing but hand on an error; DYNCAL_TRY (analysis/base/failure.hpp) does that.

A block that says, undoes or adds something is none, nor one with a comment why it is there.
"""

import re

from tree import TOP, conclude, tracked

FOLDERS = ("analysis", "drivers", "services", "tests")
CODE = (".cpp", ".hpp")
MACRO = "analysis/base/failure.hpp"
FORWARDING = re.compile(
    r"""\bif\s*\( (?:[^;]*;)? \s* !\s*(?P<outcome>\*?\w+)\s*\)\s*
        \{\s* return\s+ (?:::)?(?:dyncal::)?fail\(
        (?:std::move\()? \*?(?P<handed_on>\w+)\)? (?:\.|->)error\(\)\)?\);\s* \}(?!\s*else\b)""",
    re.X,
)


def blocks(text):
    """Number of the line and name of the outcome of each block that only forwards."""
    for found in FORWARDING.finditer(text):
        if found["outcome"].lstrip("*") == found["handed_on"]:
            yield text.count("\n", 0, found.start()) + 1, found["handed_on"]


def main():
    example = "if (auto read = f(a, {1});\n !read) {\n return fail(read.error());\n}"
    if list(blocks(example)) != [(1, "read")]:
        raise SystemExit("a block that forwards is not found: the check would pass on anything")
    paths = [path for path in tracked(*FOLDERS) if path.suffix in CODE and str(path) != MACRO]
    findings = [
        f"{path}:{line}: the error of {name} is only handed on: DYNCAL_TRY does that"
        for path in paths
        for line, name in blocks((TOP / path).read_text())
    ]
    conclude(findings, f"blocks in {len(paths)} files only hand on an error")


if __name__ == "__main__":
    main()
