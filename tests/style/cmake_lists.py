#!/usr/bin/env python3
"""Lists of sources in CMake files have one source a line, in alphabetical order.

    cmake_lists.py [--fix]

A list of one or two names may stand on the line of its command; lists that contain variables are
left to their author. --fix also breaks lines of other commands that are too long, before keywords.
"""

import re
import sys

from tree import TOP, conclude, tracked

LIMIT = 100
COMMAND = re.compile(
    r"^( *)(add_library|add_executable|target_sources|dyncal_test|dyncal_benchmark)\(([^()]*)\)",
    re.M,
)
LONG = re.compile(r"^( *)(\w+)\(((?:[^()\"#]|\"[^\"]*\")*)\)", re.M)
KEYWORDS = re.compile(
    r"(PUBLIC|PRIVATE|INTERFACE|SOURCES|LIBRARIES|PROPERTIES|COMMAND|DEPENDS"
    r"|OUTPUT|COMMENT|LABELS|TIMEOUT|RUN_SERIAL|SKIP_RETURN_CODE|VERBATIM"
    r"|SKIP_REGULAR_EXPRESSION|NAME)$"
)
SOURCE = re.compile(r"[\w./-]+\.(cpp|c)$")


def laid_out(call):
    """The call as it should be; the same if it is one that this check leaves alone."""
    indent, command, text = call[1], call[2], call[3]
    words = text.split()
    sources = [word for word in words if SOURCE.match(word)]
    if "#" in text or "$" in text or '"' in text or len(sources) < 1:
        return call[0]
    first = words.index(sources[0])
    if words[first : first + len(sources)] != sources:
        return call[0]
    head, tail = words[:first], words[first + len(sources) :]
    if len(set(sources)) != len(sources):
        return call[0]
    sources = sorted(sources)
    flat = f"{indent}{command}({' '.join(head + sources + tail)})"
    if len(sources) <= 2 and len(flat) <= LIMIT:
        return flat
    inner = indent + "  "
    if head[-1] == "SOURCES":
        lines = [f"{indent}{command}({' '.join(head[:-1])}", f"{inner}SOURCES"]
        lines += [f"{inner}  {source}" for source in sources]
    else:
        lines = [f"{indent}{command}({' '.join(head)}"]
        lines += [f"{inner}{source}" for source in sources]
    if tail:
        lines.append(f"{inner}{' '.join(tail)})")
        return "\n".join(lines)
    return "\n".join(lines) + f"\n{indent})"


def broken(call):
    """The call with its lines broken, if one of them is too long."""
    if all(len(line) <= LIMIT for line in call[0].split("\n")):
        return call[0]
    indent = call[1]
    words = re.findall(r'(?:[^\s"]|"[^"]*")+', call[3])
    lines = [f"{indent}{call[2]}({words[0]}"]
    for word in words[1:]:
        if KEYWORDS.match(word):
            lines.append(f"{indent}  {word}")
        elif len(lines[-1]) + len(word) + 2 > LIMIT:
            lines.append(f"{indent}    {word}")
        else:
            lines[-1] += f" {word}"
    return "\n".join(lines) + ")"


def main():
    paths = [path for path in tracked() if path.name == "CMakeLists.txt" or path.suffix == ".cmake"]
    findings = []
    for path in paths:
        text = (TOP / path).read_text()
        fixed = COMMAND.sub(laid_out, text)
        if fixed != text:
            findings.append(str(path))
        if "--fix" in sys.argv:
            (TOP / path).write_text(LONG.sub(broken, fixed))
    conclude(findings, f"of {len(paths)} CMake files: tests/style/cmake_lists.py --fix")


if __name__ == "__main__":
    main()
