#!/usr/bin/env python3
"""Manual pages: one for every program and command, without a warning of groff or man, with what
--help has."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from programs import PROGRAMS, commands_of, environment, expect, output_of


def rendered(page):
    """The page as man shows it, which must not warn."""
    done = subprocess.run(
        ["man", "--warnings", "-E", "UTF-8", "-l", str(page)],
        capture_output=True,
        text=True,
        timeout=120,
        env=environment(MANWIDTH="80", MANPAGER="cat", PAGER="cat"),
    )
    expect(done.returncode == 0 and not done.stderr, f"{page.name}: {done.stderr}")
    checked = subprocess.run(
        ["groff", "-man", "-Tutf8", "-ww", "-z", str(page)], capture_output=True, text=True
    )
    expect(not checked.stderr, f"{page.name}: {checked.stderr}")
    return re.sub(r".\x08|\x1b\[[0-9;]*m", "", done.stdout)


def options_of_help(text):
    return set(re.findall(r"^ +(?:-\w,)?(--[a-z][a-z0-9-]*)", text, re.M))


def main():
    if not shutil.which("man") or not shutil.which("groff"):
        print("SKIPPED: there is no man or groff here")
        sys.exit(77)
    pages = 0
    with tempfile.TemporaryDirectory() as name:
        for program in PROGRAMS:
            folder = pathlib.Path(name) / program
            output_of(program, "--write-man", folder)
            all_words = [[], *commands_of(program)]
            written = {page.name for page in folder.iterdir()}
            wanted = {"-".join([program, *words]) + ".1" for words in all_words}
            expect(written == wanted, f"{program}: {written ^ wanted}")
            for words in all_words:
                text = rendered(folder / ("-".join([program, *words]) + ".1"))
                flat = re.sub(r"\u2010\n\s+", "", text)  # words that were hyphenated
                for heading in ["NAME", "SYNOPSIS", "DESCRIPTION", "EXIT STATUS"]:
                    expect(f"\n{heading}\n" in text, f"{program} {words}: no {heading}")
                for option in options_of_help(output_of(program, *words, "--help")):
                    expect(option in flat, f"{program} {words}: {option} is not in its page")
                pages += 1
    expect(pages > 30, f"only {pages} pages")
    print(f"{pages} pages")


main()
