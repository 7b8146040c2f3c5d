#!/usr/bin/env python3
"""Holds the guide's table of flags against the code: every flag is there, none is made up, and what
it means, what to do, whether the step is repeated and whether it forbids a certificate is what
dyncal itself says.

    flags_test.py READ_TABLES [--fix]

--fix writes the table anew.
"""

import re
import sys

import pages
import readers

PAGE = pages.GUIDE / "flags.md"
TITLE = """\
| flag | meaning, and what to do | repeated | certificate |
|---|---|---|---|
"""


def table_of(flags):
    rows = []
    for flag in flags:
        said = f"*{flag['sentence']}*: " if flag["sentence"] else ""
        certificate = "refused" if flag["forbids"] else "stated"
        rows.append(
            f"| `{flag['name']}` | {said}{flag['explanation']} | "
            f"{'yes' if flag['repeated'] else 'no'} | {certificate}: {flag['reason']} |\n"
        )
    return TITLE + "".join(rows)


def main():
    flags = readers.flags(sys.argv[1])
    text = PAGE.read_text()
    shown = re.search(r"^\| flag \|.*\n(?:\|.*\n)+", text, re.M)
    if len(flags) < 20 or not shown:
        sys.exit(f"{len(flags)} flags in the code, and a table in {PAGE}: {bool(shown)}")
    if shown[0] == table_of(flags):
        print(f"{len(flags)} flags")
    elif "--fix" in sys.argv:
        PAGE.write_text(text.replace(shown[0], table_of(flags)))
    else:
        old, new = shown[0].splitlines(), table_of(flags).splitlines()
        print(f"{PAGE.name} differs from the code (--fix writes it anew):")
        print("\n".join([f"- {line}" for line in old if line not in new]))
        sys.exit("\n".join(f"+ {line}" for line in new if line not in old))


if __name__ == "__main__":
    main()
