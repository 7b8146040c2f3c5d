"""What the programs say of themselves: the text of `--help`, of each program and each command."""

import pathlib
import re
import subprocess


def programs(folder):
    names = sorted(path.name for path in pathlib.Path(folder).glob("dyncal*") if not path.suffix)
    if "dyncal" not in names:
        raise RuntimeError(f"{folder}: no dyncal is here")
    return names


def help_of(folder, words):
    program = pathlib.Path(folder) / words[0]
    done = subprocess.run(
        [program, *words[1:], "--help"], capture_output=True, text=True, check=True
    )
    # As it was called, without the folder.
    return done.stdout.replace(str(program), words[0]).strip("\n") + "\n"


def options_part(text):
    """Without the description above."""
    return text.partition("\nUsage: ")[2]


def commands_in(text):
    part = re.search(r"^Subcommands:\n((?:  .*\n?)+)", text, re.M)
    return re.findall(r"^  ([a-z][a-z-]*)\b", part[1], re.M) if part else []


def all_help(folder, program):
    """{"dyncal run": text}: of the program and all its commands."""
    texts = {}
    waiting = [[program]]
    while waiting:
        words = waiting.pop(0)
        texts[" ".join(words)] = text = help_of(folder, words)
        waiting += [[*words, command] for command in commands_in(text)]
    return texts
