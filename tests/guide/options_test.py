#!/usr/bin/env python3
"""Holds what the guide says of commands against the programs: every program and command is in
options.md and none is made up; every option that a page names, in its command lines and in its
text, is one that the command has.

    options_test.py --bin FOLDER [--fix]

--fix adds what is missing to the table, with the words of --help, and removes what is gone.
"""

import argparse
import re
import subprocess
import sys

import pages

sys.path.append(str(pages.GUIDE / "html"))
import command_help  # noqa: E402

OPTIONAL = {"dyncal-web"}  # not built where a library is missing
# Programs that pip installs, by module: options.md has those of the build.
OF_PIP = {
    "dyncal-bridge": (pages.TOP / "deploy/python/bridge", "dyncal_bridge.options"),
    "dyncal-convert": (pages.TOP / "deploy/python/convert", "dyncal_convert.command"),
}
PAGE = pages.GUIDE / "options.md"
# A program or command, then its words up to what ends a command line.
CALL = re.compile(r"\b(dyncal(?:-[a-z-]+)?)((?: +[^\s|;&<>`]+)*)")


def options_of(folder, module):
    """Of a program of Python that uses argparse."""
    told = subprocess.run(
        [sys.executable, "-c", f"import {module} as program; program.arguments().print_help()"],
        cwd=folder, capture_output=True, text=True, check=True,
    )  # fmt: skip
    return re.findall(r"(?<!\S)(--[a-z-]+)", told.stdout.partition("options:")[2])


class Commands:
    def __init__(self, folder):
        self.options = {}
        self.descriptions = {}
        for name in command_help.programs(folder):
            for command, text in command_help.all_help(folder, name).items():
                options = command_help.options_part(text)
                self.options[command] = set(re.findall(r"(?<!\S)(--[a-z-]+)", options))
                self.descriptions[command] = text.strip().splitlines()[0]
        self.of_pip = {name: set(options_of(*where)) for name, where in OF_PIP.items()}
        self.options.update(self.of_pip)

    def named_by(self, words):
        """The longest command that the words begin with, and its options."""
        for length in range(len(words), 0, -1):
            command = " ".join(words[:length])
            if command in self.options:
                return command
        return None

    def problem(self, program, rest):
        words = [program, *rest.split()]
        command = self.named_by(words)
        if command is None:
            return f"there is no program '{program}'"
        following = words[len(command.split()) :]
        commands = {c.split()[1] for c in self.options if c.startswith("dyncal ")}
        if command == "dyncal" and following and re.fullmatch("[a-z]+", following[0]):
            if following[0] not in commands:
                return f"there is no command '{following[0]}'"
        for word in following:
            option = re.match(r"--[a-z-]+", word)
            if option and option[0] not in self.options[command] | {"--help"}:
                return f"'{command}' has no option {option[0]}"
        return None


def texts_of(page):
    """Command lines of a page: of its blocks, and in its text."""
    for block in pages.blocks_of(page):
        if block.language in ("sh", "setup"):
            yield from block.text.replace("\\\n", " ").splitlines()
    prose = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", pages.prose_of(page))
    yield from (" ".join(code.split()) for code in re.findall(r"`(dyncal[^`]*)`", prose))


def fix(commands, missing, gone):
    lines = PAGE.read_text().splitlines(keepends=True)
    rows_gone = tuple(f"| `{command}` |" for command in gone)
    lines = [line for line in lines if not line.startswith(rows_gone)]
    last = max(i for i, line in enumerate(lines) if line.startswith("| `dyncal"))
    new = [f"| `{c}` | {commands.descriptions[c]} |\n" for c in sorted(missing)]
    PAGE.write_text("".join(lines[: last + 1] + new + lines[last + 1 :]))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--fix", action="store_true")
    options = parser.parse_args()
    commands = Commands(options.bin)
    wrong = []

    listed = {
        pages.code_in(row["command"])[0]
        for row in pages.rows_of(PAGE.read_text())
        if "command" in row
    }
    ends = {
        command
        for command in commands.options
        if command != "dyncal" and not any(c.startswith(f"{command} ") for c in commands.options)
    } - set(commands.of_pip)
    gone = listed - ends - OPTIONAL
    if options.fix:
        fix(commands, ends - listed, gone)
        return
    wrong += [f"options.md does not list '{command}'" for command in sorted(ends - listed)]
    wrong += [f"options.md lists '{command}', which is gone" for command in sorted(gone)]

    calls = 0
    for page in pages.all_pages():
        for text in texts_of(page):
            for program, rest in CALL.findall(text):
                calls += 1
                problem = commands.problem(program, rest)
                if problem:
                    wrong.append(f"{page.name}: {text.strip()}: {problem}")
    options = sum(map(len, commands.options.values()))
    if len(ends) < 25 or calls < 100 or not all(commands.of_pip.values()):
        wrong.append(f"only {len(ends)} commands, {calls} calls")
    print("\n".join(wrong) or f"{len(ends)} commands, {options} options, {calls} calls")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
