#!/usr/bin/env python3
"""Does what a page of the guide says, in a folder of its own: writes its files, runs its command
lines in one shell, and holds what they print against what the page shows.

    run_page.py PAGE --bin FOLDER --reader READ_TABLES [--keep] [--show] [--write]

--write puts what was printed in the place of what the page shows, and the figures that were made in
the place of its pictures (pictures.py).

Ports of 127.0.0.1 are replaced by free ones, and DYNCAL_DOMAIN names a DDS domain that no other
test has. What a page starts and leaves running is ended. Every file that is there in the end must
be one that deploy/guide/files.md lists, or one that the page itself names.
"""

import argparse
import fnmatch
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import tomllib

import expected_output
import pages
import pictures
import readers
import toml_text

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))
from dds_domain import reserve, reserve_dds_domain  # noqa: E402

SECONDS_PER_BLOCK = 200
ADDRESS = re.compile(r"127\.0\.0\.1:(\d{4,5})\b")
SKIPPED = 77


class Failure(Exception):
    pass


def free_port():
    """For TCP and UDP, below those that the kernel hands out."""
    for i in range(5000):
        port = 20000 + (7919 * os.getpid() + 61 * i) % 12000
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp, socket.socket() as tcp:
            try:
                tcp.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                udp.bind(("127.0.0.1", port))
                tcp.bind(("127.0.0.1", port))
            except OSError:
                continue
        held = reserve(f"guide-port-{port}")
        if held:
            return port, held
    raise Failure("no port is free")


class Shell:
    """One shell for the whole page, so that folders, variables and jobs last."""

    def __init__(self, folder, environment):
        self.folder = folder
        self.bookkeeping = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-guide-shell-"))
        self.blocks = 0
        self.process = subprocess.Popen(
            ["bash", "--norc", "--noprofile", "-s"],
            cwd=folder,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )
        self.say(f"trap 'echo \"$? $BASH_COMMAND\" >> {self.bookkeeping}/failed' ERR\n")

    def say(self, text):
        self.process.stdin.write(text)
        self.process.stdin.flush()

    def current_folder(self):
        return pathlib.Path(f"/proc/{self.process.pid}/cwd").resolve()

    def run(self, text):
        """What was printed, errors before and after the rest, and status and command of each that
        failed: a program that prints to files does not keep the order of the two."""
        self.blocks += 1
        printed = self.bookkeeping / f"{self.blocks}.printed"
        errors = self.bookkeeping / f"{self.blocks}.errors"
        ended = self.bookkeeping / f"{self.blocks}.ended"
        self.say(f"exec > {printed} 2> {errors}\n{{\n{text}}} < /dev/null\ntouch {ended}\n")
        deadline = time.monotonic() + SECONDS_PER_BLOCK
        while not ended.exists():
            if self.process.poll() is not None:
                raise Failure(f"the shell has ended: {errors.read_text()}")
            if time.monotonic() > deadline:
                raise Failure(f"not done after {SECONDS_PER_BLOCK} s: {errors.read_text()}")
            time.sleep(0.02)  # between looks at a file that the shell makes
        failures = self.bookkeeping / "failed"
        failed = failures.read_text().splitlines() if failures.exists() else []
        failures.unlink(missing_ok=True)
        both = printed.read_text(), errors.read_text()
        return both[0] + both[1], both[1] + both[0], failed

    def end(self):
        """Everything that was started in it."""
        for asked in (signal.SIGTERM, signal.SIGKILL):
            try:
                os.killpg(self.process.pid, asked)
            except ProcessLookupError:
                break
            for _ in range(250):
                self.process.poll()
                try:
                    os.killpg(self.process.pid, 0)
                except ProcessLookupError:
                    break
                time.sleep(0.02)
        self.process.stdin.close()
        self.process.wait()
        shutil.rmtree(self.bookkeeping)


class Page:
    def __init__(self, path, folder, options):
        self.path = path
        self.folder = folder
        self.reader = options.reader.resolve()
        self.shows = options.show
        self.writes = options.write
        self.ports = {}
        self.held = []
        self.counts = dict.fromkeys(("commands", "outputs", "files", "pictures"), 0)
        domain, held = reserve_dds_domain()
        self.held.append(held)
        self.shell = Shell(
            folder,
            {
                "PATH": f"{options.bin.resolve()}:/usr/bin:/bin:/usr/sbin:/sbin",
                "HOME": str(folder),
                "LC_ALL": "C.UTF-8",
                "TZ": "UTC",
                "DYNCAL_DOMAIN": str(domain),
                "EXAMPLES": str(pages.EXAMPLES),
                **{k: v for k, v in os.environ.items() if k.endswith("SAN_OPTIONS")},
            },
        )

    def with_own_ports(self, text):
        def own(found):
            if found[1] not in self.ports:
                port, held = free_port()
                self.ports[found[1]] = str(port)
                self.held.append(held)
            return f"127.0.0.1:{self.ports[found[1]]}"

        return ADDRESS.sub(own, text)

    def with_ports_of_page(self, text):
        for of_page, own in self.ports.items():
            text = re.sub(rf"\b{own}\b", of_page, text)
        return text.replace(str(self.folder), "/home/you")

    def follow(self):
        blocks = pages.blocks_of(self.path)
        for block, after in zip(blocks, [*blocks[1:], None]):
            shown = after if after and after.language == "text" else None
            try:
                if block.language in ("sh", "setup"):
                    self.run(block, shown)
                elif block.language not in ("text", ""):
                    self.write(block)
            except Failure as failure:
                raise Failure(f"{block.where}: {failure}") from None
        if self.counts["commands"]:
            self.check_files()
        self.look_at_pictures()

    def look_at_pictures(self):
        for picture, pattern in pictures.NAMED.findall(self.path.read_text()):
            shown = (self.path.parent / picture).resolve()
            made = list(self.shell.current_folder().glob(pattern))
            if len(made) != 1:
                raise Failure(f"{len(made)} files are {pattern}, which {shown.name} is made of")
            if self.writes:
                shutil.copy(made[0], shown)
            elif problem := pictures.difference(shown, made[0]):
                raise Failure(f"{shown.name} has aged, make it with --write: {problem}")
            self.counts["pictures"] += 1

    def run(self, block, shown):
        *orders, failed = self.shell.run(self.with_own_ports(block.text))
        orders = [self.with_ports_of_page(printed) for printed in orders]
        printed = orders[0]
        if self.shows:
            print(f"{block.where}:\n{printed}")
        expected = expected_statuses(shown)
        if [line.split()[0] for line in failed] not in expected:
            logs = "".join(
                f"\n--- {path.name}:\n{path.read_text()}"
                for path in self.shell.current_folder().glob("*.log")
            )
            raise Failure(f"failed: {failed}, expected: {expected}\n{printed}{logs}")
        self.counts["commands"] += command_lines(block.text) if block.language == "sh" else 0
        if shown and self.writes:
            self.put(shown.text, expected_output.brought_up_to_date(shown.text, printed))
        elif shown:
            differences = [expected_output.first_difference(shown.text, one) for one in orders]
            if all(differences):
                raise Failure(f"the page shows: {differences[0]}\n--- printed:\n{printed}")
            self.counts["outputs"] += 1

    def put(self, shown, printed):
        text = self.path.read_text()
        if text.count(shown) != 1:
            raise Failure(f"the page shows this more than once: {shown}")
        self.path.write_text(text.replace(shown, printed))

    def write(self, block):
        if not block.words:
            raise Failure(f"a block of {block.language} without the name of its file")
        name = block.words[-1]
        text = self.with_own_ports(block.text)
        folder = self.shell.current_folder()
        path = folder / name
        if block.words[0] == "in":
            if not path.exists():  # one of the example laboratory, to be read and no more
                copy_examples(folder)
            tables = toml_text.put_into(tomllib.loads(path.read_text()), tomllib.loads(text))
            text = toml_text.to_toml(tables)
        elif f"`{name}`" not in pages.prose_of(self.path):
            raise Failure(f"the page does not tell a reader that this is `{name}`")
        path.write_text(text)
        self.counts["files"] += 1
        if path.suffix == ".toml":
            reader = readers.reader_of(tomllib.loads(text))
            problem = readers.ask(self.reader, [(reader, text, path)])[0]["problem"]
            if problem:
                raise Failure(f"refused: {problem}")

    def check_files(self):
        listed = [
            name
            for row in pages.rows_of((pages.GUIDE / "files.md").read_text())
            for name in pages.code_in(row.get("file", ""))
        ]
        named = self.path.read_text() + " ".join(path.name for path in pages.EXAMPLES.rglob("*.*"))
        current = self.shell.current_folder()
        for path in self.folder.rglob("*"):
            inside = path.is_relative_to(current)
            name = str(path.relative_to(current if inside else self.folder))
            known = any(fnmatch.fnmatch(name, pattern) for pattern in listed)
            if path.is_file() and not known and path.name not in named:
                raise Failure(f"{name}: neither files.md nor the page names this file")


def copy_examples(folder):
    for example in pages.EXAMPLES.glob("*.*"):
        if not (folder / example.name).exists():
            shutil.copy(example, folder)


def expected_statuses(shown):
    """Of the commands that fail: of one, or of none."""
    said = re.search(r"status=([\d,]+)", " ".join(shown.words)) if shown else None
    return [[] if one == "0" else [one] for one in said[1].split(",")] if said else [[]]


def command_lines(text):
    joined = re.sub("'[^']*'", "", text.replace("\\\n", " "))
    return sum(1 for line in joined.splitlines() if line.strip() and not line.startswith("#"))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("page")
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    parser.add_argument("--reader", required=True, type=pathlib.Path)
    parser.add_argument("--keep", action="store_true", help="leave the folder")
    parser.add_argument("--show", action="store_true", help="print what the commands print")
    parser.add_argument("--write", action="store_true", help="bring the page up to date")
    options = parser.parse_args()
    path = pages.GUIDE / options.page
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-guide-"))
    page = Page(path, folder, options)
    try:
        page.follow()
    except Failure as failure:
        sys.exit(f"{failure}")
    finally:
        page.shell.end()
        if options.keep:
            print(f"kept: {folder}")
        else:
            shutil.rmtree(folder)
    if not page.counts["commands"] and not page.counts["files"]:
        sys.exit(f"{path}: no command line and no file: what was tested?")
    print(", ".join(f"{count} {what}" for what, count in page.counts.items()))


if __name__ == "__main__":
    main()
