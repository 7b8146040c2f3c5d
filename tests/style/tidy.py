#!/usr/bin/env python3
"""Runs clang-tidy 14 with .clang-tidy.

    tidy.py --build BUILD [--all] [--jobs N] [--checks CHECKS] [FILE...]

Without --all and files: what has changed since the branch left its upstream (on main without an
upstream: since the commit before), committed or not; a changed header is read through the source of
its name, else through one that includes it. --all: every source but those of tests. With
DYNCAL_TIDY=quarter in the environment a quarter of those too, which the commit draws.

More than 40 sources are held against the checks of CHEAP only: reading a source with all
checks takes four times as long.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from tree import TOP, tracked

CHEAP = (
    "-*,readability-identifier-naming,readability-function-size,"
    "readability-braces-around-statements,misc-definitions-in-headers,modernize-use-override"
)
MANY = 40
# Headers that the compiler of the build has compiled before: no other compiler can read them, and
# every source is to include what it uses.
PRECOMPILED = re.compile(r" (?:-Winvalid-pch|-fpch-preprocess|-include \S+cmake_pch\.hxx)(?= )")
FINDING = re.compile(r"^(.*?):(\d+):\d+: (?:error|warning): (.*) \[(.*?)[,\]]")


def git(*arguments):
    done = subprocess.run(
        ["git", "-c", "safe.directory=*", *arguments], cwd=TOP, capture_output=True, text=True
    )
    return done.stdout.strip() if done.returncode == 0 else None


def base_commit():
    head = git("rev-parse", "HEAD")
    for branch in ("@{upstream}", "origin/main", "main"):
        base = git("merge-base", "HEAD", branch)
        if base and base != head:
            return base
    return git("rev-parse", "HEAD~1") or head


def changed(sources):
    """Those sources through which every file is read that has changed."""
    base = base_commit()
    if base is None:
        print("skipped: not a git checkout")
        sys.exit(77)
    names = set((git("diff", "--name-only", base) or "").splitlines())
    names |= set((git("ls-files", "--others", "--exclude-standard") or "").splitlines())
    chosen = {name for name in names if name in sources}
    for header in sorted(name for name in names if name.endswith((".hpp", ".h"))):
        source = str(pathlib.PurePosixPath(header).with_suffix(".cpp"))
        if source in sources:
            chosen.add(source)
            continue
        users = (git("grep", "-l", "-F", f'#include "{header}"', "--", "*.cpp") or "").splitlines()
        chosen.update([user for user in users if user in sources][:1])
    return sorted(chosen)


def drawn_by_commit(items):
    """With DYNCAL_TIDY=quarter every fourth, from the first, second, third or fourth on: so that
    all are read in the course of some commits. Else none."""
    if os.environ.get("DYNCAL_TIDY") != "quarter":
        return []
    return items[int(git("rev-parse", "HEAD") or "0", 16) % 4 :: 4]


def findings_of(program, commands, checks, source):
    command = [program, "-p", str(commands), "--quiet", str(TOP / source)]
    if checks:
        command.append(f"--checks={checks}")
    done = subprocess.run(command, cwd=TOP, capture_output=True, text=True)
    found = set()
    size = ""  # of a function, which its notes tell in the lines after
    for line in done.stdout.splitlines():
        finding = FINDING.match(line)
        note = re.search(r": note: (.* \(threshold \d+\))", line)
        if finding:
            size = f"{os.path.relpath(finding[1], TOP)}:{finding[2]}: {finding[3]}"
            found.add(f"{size} [{finding[4]}]")
        elif note:
            found.add(f"{size}: {note[1]}")
    if done.returncode != 0 and not found:
        found.add(f"{source}: clang-tidy failed: {(done.stdout + done.stderr).strip()[-500:]}")
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--checks")
    parser.add_argument("files", nargs="*")
    options = parser.parse_args()
    program = shutil.which("clang-tidy-14")
    if program is None:
        print("skipped: no clang-tidy-14 (Debian: clang-tidy-14); other versions differ")
        sys.exit(77)

    commands = json.loads((options.build / "compile_commands.json").read_text())
    for command in commands:
        command["command"] = PRECOMPILED.sub("", command["command"])
    built = {os.path.relpath(command["file"], TOP) for command in commands}
    sources = [str(path) for path in tracked() if str(path) in built and path.suffix == ".cpp"]
    chosen = options.files
    if not chosen:
        programs = [source for source in sources if not source.startswith("tests/")]
        drawn = drawn_by_commit(programs)
        chosen = programs if options.all else sorted({*changed(sources), *drawn})
    checks = options.checks or (CHEAP if len(chosen) > MANY else None)

    findings = set()
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(
        options.jobs
    ) as pool:
        (pathlib.Path(folder) / "compile_commands.json").write_text(json.dumps(commands))
        for found in pool.map(lambda s: findings_of(program, folder, checks, s), chosen):
            for finding in sorted(found - findings):
                print(finding, flush=True)
            findings |= found
    print(f"{len(findings)} findings in {len(chosen)} sources", end="")
    print(", with the cheap checks" if checks == CHEAP else "")
    sys.exit(1 if findings else 0)


if __name__ == "__main__":
    main()
