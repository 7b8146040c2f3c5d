#!/usr/bin/env python3
"""Holds what programs link against what they may link. Reads the link lists of a build made with
Ninja.

    link_lists.py --build BUILD
"""

import argparse
import pathlib
import re
import sys

# The analysis evaluates benches that it has never heard of: no bench file, no device.
REFUSED = {
    "dyncal-analysis": ["services/bench/", "drivers/", "tomlplusplus", "libdyncal_bench_program"],
}
# Descriptors of files, which whatever reads one has.
NO_DRIVER = "drivers/link/libdyncal_link.a"
# What must be there, so that an empty list is not taken for a short one.
EXPECTED = {
    "dyncal-analysis": ["services/evaluation/", "services/daemon/program/", "analysis/"],
}


def link_list(ninja, program):
    found = re.search(rf"^build (?:\S+/)?{program}: (.*(?:\n  .*)*)", ninja, re.M)
    return found[1].split() if found else []


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    build = parser.parse_args().build
    path = build / "build.ninja"
    if not path.exists():
        print(f"skipped: {build} was not made with Ninja")
        sys.exit(77)
    ninja = path.read_text()
    wrong = []
    for program, refused in REFUSED.items():
        linked = link_list(ninja, program)
        for part in EXPECTED[program]:
            if not any(part in file for file in linked):
                wrong.append(f"{program}: nothing of {part} in its link list of {len(linked)}")
        for part in refused:
            wrong += [
                f"{program} links {file}"
                for file in linked
                if part in file and not file.endswith(NO_DRIVER)
            ]
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
