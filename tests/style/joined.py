#!/usr/bin/env python3
"""Sources that the preset "programs" compiles as one (deploy/cmake/JoinedSources.cmake) do not
touch each other.

    joined.py --build BUILD [--all]

No source mentions what a source before it declares in an unnamed namespace: it could take that for
another thing of the name. And those that are joined with a changed source compile, unless they are
more than 20; with DYNCAL_TIDY=quarter in the environment a quarter of all too, which the commit
draws; with --all everything. The preset is configured in BUILD/joined.
"""

import argparse
import concurrent.futures
import functools
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys

from tidy import PRECOMPILED, changed, drawn_by_commit
from tree import TOP, conclude, tracked

MANY = 20
LEAST = 100  # units that there are at least: less would be a preset that joins nothing, or all
NO_CODE = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"', re.S)
UNNAMED = re.compile(r"^namespace \{\n(.*?)^\}", re.S | re.M)
DECLARED = re.compile(
    r"^(?!namespace|using namespace|using [\w:]+::)[A-Za-z][^\n;(){}\[\]=]*", re.M
)
ELSEWHERE = re.compile(r"(?:\.|->|::)\s*[A-Za-z_]\w*")  # members, and names with their namespace


@functools.cache
def code(path):
    return NO_CODE.sub(" ", re.sub(r"^ *#include [^\n]*", "", path.read_text(), flags=re.M))


@functools.cache
def unnamed(path):
    """What a source declares in unnamed namespaces, where each declaration begins at column 0."""
    names = set()
    for body in UNNAMED.findall(code(path)):
        for declaration in DECLARED.findall(body):
            names |= set(re.findall(r"\W(\w+) *$", declaration))
    return frozenset(names)


@functools.cache
def mentioned(path):
    return frozenset(re.findall(r"[A-Za-z_]\w*", ELSEWHERE.sub(" ", code(path))))


def touches(sources):
    """Where a source that is joined to others mentions what they declare for themselves."""
    declared = {}
    for source in sources:
        for name in sorted(mentioned(source) & declared.keys()):
            where = os.path.relpath(source, TOP)
            yield f"{where}: '{name}' is also in an unnamed namespace of {declared[name]}"
        declared.update(dict.fromkeys(unnamed(source), os.path.relpath(source, TOP)))


def compile_errors(command, build, joined):
    """Of a joined unit, without what is precompiled; made sources are those of the build."""
    *words, unit = shlex.split(PRECOMPILED.sub("", command))
    words = [word.replace(str(joined), str(build)) for word in words]
    words[words.index("-o") + 1] = os.devnull
    words += ["-fsyntax-only", unit]
    done = subprocess.run(words, cwd=build, capture_output=True, text=True)
    return [line for line in done.stderr.splitlines() if ": error: " in line] or (
        [done.stderr] if done.returncode != 0 else []
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--all", action="store_true")
    options = parser.parse_args()
    build = options.build.resolve()
    joined = build / "joined"
    configured = subprocess.run(
        ["cmake", "--preset", "programs", "-B", joined],
        cwd=TOP,
        capture_output=True,
        text=True,
        env={**os.environ, "CCACHE_DISABLE": "1"},
    )
    if configured.returncode != 0:
        sys.exit(f"the preset does not configure: {configured.stderr}")

    sources = [str(path) for path in tracked("analysis", "drivers", "services")]
    new = {TOP / name for name in changed([name for name in sources if name.endswith(".cpp")])}
    findings = []
    joined_units, chosen = [], []
    units = json.loads((joined / "compile_commands.json").read_text())
    for unit in units:
        if "/joined/" in os.path.relpath(unit["file"], joined):
            text = pathlib.Path(unit["file"]).read_text()
            parts = [pathlib.Path(name) for name in re.findall(r'^#include "(/.*?)"', text, re.M)]
            findings += touches(parts)
            joined_units.append(unit["command"])
            if new & set(parts):
                chosen.append(unit["command"])
    if len(units) < LEAST or 2 * len(units) > len(sources):
        findings.append(f"{len(sources)} files are compiled in {len(units)} units")
    of_changes = chosen if len(chosen) <= MANY else []
    chosen = joined_units if options.all else {*of_changes, *drawn_by_commit(joined_units)}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for errors in pool.map(lambda one: compile_errors(one, build, joined), chosen):
            findings += errors
    print(f"{len(chosen)} units compiled")
    conclude(findings, f"findings in {len(units)} units")


if __name__ == "__main__":
    main()
