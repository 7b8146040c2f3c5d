"""What the tests of the command line have in common: the programs, and how to run them."""

import os
import pathlib
import subprocess
import sys

PROGRAMS = [
    "dyncal",
    "dyncal-acs",
    "dyncal-analysis",
    "dyncal-can",
    "dyncal-dau",
    "dyncal-dso",
    "dyncal-guard",
    "dyncal-recorder",
    "dyncal-virtual-bench",
]
FOLDER = pathlib.Path(sys.argv[1])
SOURCE = pathlib.Path(sys.argv[2])


def expect(condition, sentence):
    if not condition:
        sys.exit(sentence)


def run(program, *arguments, **more):
    """The finished process of a program of the build, with its outputs as text."""
    return subprocess.run(
        [FOLDER / program, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=300,
        **more,
    )


def output_of(program, *arguments):
    done = run(program, *arguments)
    expect(done.returncode == 0, f"{program} {arguments}: {done.stderr}")
    return done.stdout


def commands_of(program):
    """The commands of a program, each as a list of words."""
    lines = output_of(program, "--print-commands").splitlines()
    return [line.split("\t")[0].split()[1:] for line in lines[1:]]


# What a sanitizer is to pass over: without it, it reports on the terminal.
SANITIZERS = ("ASAN_OPTIONS", "LSAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS")


def environment(**more):
    kept = {name: os.environ[name] for name in ("PATH", "HOME", *SANITIZERS) if name in os.environ}
    return {**kept, "LC_ALL": "C.UTF-8", "PATH": f"{FOLDER}:{kept['PATH']}", **more}
