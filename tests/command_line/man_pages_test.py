#!/usr/bin/env python3
"""Manual pages: one for every program and command, without a warning of groff or man, with what
--help has."""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from programs import FOLDER, PROGRAMS, SOURCE, commands_of, environment, expect, output_of


def expect_no_warning(page, text):
    """But of words that are too long for a full line."""
    told = [line for line in text.splitlines() if line and "cannot adjust line" not in line]
    expect(not told, f"{page.name}: {told}")


def rendered(page):
    """The page as man shows it, which must not warn."""
    done = subprocess.run(
        ["man", "--warnings", "-E", "UTF-8", "-l", str(page)],
        capture_output=True,
        text=True,
        timeout=120,
        env=environment(MANWIDTH="80", MANPAGER="cat", PAGER="cat"),
    )
    expect(done.returncode == 0, f"{page.name}: {done.stderr}")
    expect_no_warning(page, done.stderr)
    checked = subprocess.run(
        ["groff", "-man", "-Tutf8", "-ww", "-z", str(page)], capture_output=True, text=True
    )
    expect_no_warning(page, checked.stderr)
    return re.sub(r".\x08|\x1b\[[0-9;]*m", "", done.stdout)


def options_of_help(text):
    return set(re.findall(r"^ +(?:-\w,)?(--[a-z][a-z0-9-]*)", text, re.M))


def main():
    if not all(map(shutil.which, ["man", "groff", "help2man"])):
        print("SKIPPED: there is no man, groff or help2man here")
        sys.exit(77)
    pages = 0
    with tempfile.TemporaryDirectory() as name:
        for program in PROGRAMS:
            folder = pathlib.Path(name) / program
            script = SOURCE / "deploy" / "cmake" / "write-man-pages.sh"
            subprocess.run([script, FOLDER / program, folder], check=True, timeout=300)
            all_words = [[], *commands_of(program)]
            written = {page.name for page in folder.iterdir()}
            wanted = {"-".join([program, *words]) + ".1" for words in all_words}
            expect(written == wanted, f"{program}: {written ^ wanted}")
            for words in all_words:
                text = rendered(folder / ("-".join([program, *words]) + ".1"))
                flat = re.sub(r"\u2010\n\s+", "", text)  # words that were hyphenated
                for heading in ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS"]:
                    expect(f"\n{heading}\n" in text, f"{program} {words}: no {heading}")
                named = "[-\u2010]".join("-".join([program, *words]).split("-"))
                expect(re.search(f"NAME\n +{named} ", text), f"{program} {words}: another name")
                for option in options_of_help(output_of(program, *words, "--help")):
                    expect(option in flat, f"{program} {words}: {option} is not in its page")
                pages += 1
    expect(pages > 30, f"only {pages} pages")
    print(f"{pages} pages")


main()
