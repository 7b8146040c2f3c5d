#!/usr/bin/env python3
"""Every program links with the whole of each of its libraries.

    whole_libraries.py --build BUILD

Where sources are compiled alone, a program takes of a library those objects alone that it calls,
and so does not notice that another object calls what no library of the program has. Where they are
joined (deploy/cmake/JoinedSources.cmake), or where another program calls more, it does not link.
Skipped where the libraries have not been built.
"""

import argparse
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

from tree import conclude


def link_command(build, program):
    listed = subprocess.run(
        ["ninja", "-C", build, "-t", "commands", "-s", program], capture_output=True, text=True
    ).stdout
    lines = [line for line in listed.splitlines() if f" -o {program} " in line]
    return shlex.split(lines[-1].split("&&")[1]) if lines else None


def whole(words, output):
    """The command with each of our libraries once and whole."""
    command = []
    for word in words:
        if not word.endswith(".a") or word.startswith("/"):
            command.append(word)
        elif word not in command:
            command += ["-Wl,--whole-archive", word, "-Wl,--no-whole-archive"]
    command[command.index("-o") + 1] = output
    return command


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", type=pathlib.Path, required=True)
    build = parser.parse_args().build
    ninja = (build / "build.ninja").read_text() if (build / "build.ninja").exists() else ""
    programs = re.findall(r"^build (bin/dyncal[\w-]*): CXX_EXECUTABLE_LINKER", ninja, re.M)
    commands = {program: link_command(build, program) for program in programs}
    if not programs or any(
        not (build / word).exists()
        for words in commands.values()
        for word in words or ["no command"]
        if word.endswith((".a", ".o"))
    ):
        print("skipped: the programs have not been built here, or not with Ninja")
        sys.exit(77)
    findings = []
    with tempfile.TemporaryDirectory() as folder:
        for program, words in commands.items():
            command = whole(words, f"{folder}/program")
            done = subprocess.run(command, cwd=build, capture_output=True, text=True)
            if done.returncode != 0:
                findings.append(f"{program}: {done.stderr.strip()[:500]}")
    conclude(findings, f"of {len(programs)} programs do not link with the whole of their libraries")


if __name__ == "__main__":
    main()
