#!/usr/bin/env python3
"""No line of code or Markdown is longer than 100 columns, but for what cannot be broken:

- a row of a Markdown table, and what a program prints (a fenced block without a language),
- a line in which one word (a URL, a path, data as text) is longer than 60 columns,
- a line of a raw string of C++, R"(...)", whose line breaks would be part of the text.
"""

import re

from tree import CODE, TOP, conclude, tracked

LIMIT = 100
LONG_WORD = 60
CHECKED = (*CODE, ".md", ".py", ".sh", ".cmake", ".idl", ".toml", ".proto", ".in", ".conf")


def is_checked(path):
    return path.suffix in CHECKED or path.name == "CMakeLists.txt"


def may_be_long(path, line, in_raw_string):
    if path.suffix == ".md" and line.lstrip().startswith("|"):
        return True
    if in_raw_string or 'R"' in line:
        return True
    return any(len(word) > LONG_WORD for word in line.split())


def long_lines(path):
    raw_end = None
    fence = None
    for number, line in enumerate((TOP / path).read_text().splitlines(), 1):
        if path.suffix == ".md" and line.startswith("```"):
            fence = line[3:].strip() if fence is None else None
        elif len(line) > LIMIT and fence != "" and not may_be_long(path, line, raw_end is not None):
            yield f"{path}:{number}: {len(line)} columns"
        if path.suffix in CODE:
            opened = re.search(r'R"(\w*)\(', line) if raw_end is None else None
            if opened:
                raw_end = f'){opened[1]}"'
                line = line[opened.end() :]
            if raw_end is not None and raw_end in line:
                raw_end = None


def main():
    paths = [path for path in tracked() if is_checked(path)]
    findings = [finding for path in paths for finding in long_lines(path)]
    conclude(findings, f"lines of {len(paths)} files are longer than {LIMIT} columns")


if __name__ == "__main__":
    main()
