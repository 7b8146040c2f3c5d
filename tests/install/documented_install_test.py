#!/usr/bin/env python3
"""Whether what README.md and deploy/README.md say to install dyncal works.

    documented_install_test.py --build BUILD --cmake CMAKE

The commands are read from the pages and run, in a copy of deploy/ beside a build folder that holds
of BUILD only what those commands have built: `cmake --build ... --target` of deploy/build.sh is
answered by putting there the files that build.ninja says these targets need (hard links: nothing
is compiled), `cmake --install` is the real one. So a file to be installed that no target of
deploy/build.sh makes is missing here as it is after a fresh clone, although BUILD has everything.

What a command makes without naming it to ninja (the manual pages of subcommands) belongs to the
named files of its folder. Packages are not installed, and the demo prints its help only.
"""

import argparse
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
SMALL = 1 << 20  # bytes: copied, since an installation may write into such files
# A fresh clone is installed without the tests having been built and run.
NOT_NEEDED = ("tests/run.sh", "dyncal ")


def fail(sentence):
    sys.exit(sentence)


def documented_commands(page):
    """Of the block that ends in an installation."""
    for block in re.findall(r"^```sh\n(.*?)^```", (TOP / page).read_text(), re.M | re.S):
        if "cmake --install" in block:
            lines = [line.split("#")[0].strip() for line in block.splitlines()]
            return [
                line.removeprefix("sudo ")
                for line in lines
                if line and not line.startswith(NOT_NEEDED)
            ]
    fail(f"{page} does not say how to install")


class Build:
    """The build that has everything, and who makes what in it."""

    def __init__(self, folder):
        self.folder = folder
        self.outputs, self.needed = set(), {}  # of an output: all that its command makes, and takes
        text = (folder / "build.ninja").read_text().replace("$\n", "")
        for statement in re.findall(r"^build (.*)$", text, re.M):
            made, _, taken = statement.partition(": ")
            outputs = self.paths(made)
            inputs = self.paths(taken)[1:] + outputs  # without the rule
            for output in outputs:
                self.needed[output] = inputs
            if not taken.startswith("phony"):
                self.outputs.update(outputs)
        self.folders = {}  # of outputs: which are in it
        for output in self.outputs:
            if not output.startswith("CMakeFiles/") and (folder / output).is_file():
                self.folders.setdefault(str(pathlib.Path(output).parent), set()).add(output)

    def paths(self, text):
        """Relative to the build; cmake names what commands make twice, absolute as well."""
        words = re.sub(r"(?<!\$) \|\|? ", " ", text).split()
        return [
            word.replace("${cmake_ninja_workdir}", "").removeprefix(f"{self.folder}/")
            for word in words
            if word not in ("|", "||")
        ]

    def made_by(self, targets):
        """Everything that these targets need."""
        made, open_ones = set(), list(targets)
        while open_ones:
            name = open_ones.pop()
            if name not in made:
                made.add(name)
                open_ones += self.needed.get(name, [])
        return made

    def is_there(self, path, made):
        """Whether a file of the build is there when only `made` was built."""
        if path in self.outputs:
            return path in made
        for folder in pathlib.Path(path).parents:
            named = self.folders.get(str(folder))
            if named and str(folder) != ".":
                return named <= made
        return True  # written when the build was configured

    def installed(self):
        """Scripts of the installation, and the files of the build that they name."""
        scripts, named = [], set()
        wanted = [self.folder / "cmake_install.cmake"]
        for script in wanted:
            text = script.read_text()
            scripts.append(script)
            for found in re.findall(rf'"{re.escape(str(self.folder))}/([^"]+)"', text):
                path = self.folder / found
                if path.name == "cmake_install.cmake":
                    wanted.append(path)
                elif path.is_dir():
                    named |= {p for p in path.rglob("*") if p.is_file()}
                elif path.is_file():
                    named.add(path)
        return scripts, {str(path.relative_to(self.folder)) for path in named}


def put(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.exists():
        return
    if source.stat().st_size < SMALL:
        shutil.copy2(source, target)
    else:
        os.link(source, target)


def prepare(build, top):
    """deploy/ and a build folder that has been configured."""
    for name in ["build.sh", "demo.sh"]:
        put(TOP / "deploy" / name, top / "deploy" / name)
    packages = top / "deploy/install-packages.sh"
    packages.write_text("#!/bin/sh\nexit 0\n")
    packages.chmod(0o755)
    view = top / "build"
    for name in ["build.ninja", "CMakeCache.txt"]:
        put(build.folder / name, view / name)
    scripts, named = build.installed()
    for script in scripts:
        target = view / script.relative_to(build.folder)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(script.read_text().replace(f"{build.folder}/", f"{view}/"))
    for path in named:
        if build.is_there(path, set()):
            put(build.folder / path, view / path)


def answer_cmake(words, build, top, cmake):
    """What stands for cmake in the commands."""
    if "--install" in words:
        at = words.index("--install")
        prefix = [] if "--prefix" in words else ["--prefix", str(top / "prefix")]
        done = subprocess.run([cmake, *words[: at + 2], *prefix, *words[at + 2 :]], check=False)
        return done.returncode
    if "--build" in words:
        targets = words[words.index("--target") + 1 :]
        made = build.made_by(targets)
        _, named = build.installed()
        for path in sorted(named):
            if build.is_there(path, made):
                put(build.folder / path, top / "build" / path)
        print(f"built: {' '.join(targets)}")
        return 0
    fail(f"cmake {' '.join(words)} was not expected")
    return 1


def check(page, options):
    """Runs the commands of a page."""
    commands = documented_commands(page)
    if not any("cmake --install" in command for command in commands) or len(commands) < 2:
        fail(f"{page}: {commands}")
    # Hard links need the same file system.
    with tempfile.TemporaryDirectory(dir=options.build, prefix="documented-install-") as folder:
        top = pathlib.Path(folder)
        prepare(Build(options.build), top)
        program = top / "bin/cmake"
        program.parent.mkdir()
        words = [sys.executable, __file__, "--build", options.build, "--cmake", options.cmake]
        words += ["--top", top, "--answer"]
        program.write_text("#!/bin/sh\nexec " + shlex.join(map(str, words)) + ' "$@"\n')
        program.chmod(0o755)
        path = f"{program.parent}:{os.environ['PATH']}"
        for command in commands:
            asked = command + (" --help" if command.startswith("deploy/demo.sh") else "")
            done = subprocess.run(
                ["bash", "-ec", asked],
                cwd=top,
                env={**os.environ, "PATH": path},
                capture_output=True,
                text=True,
                check=False,
            )
            if done.returncode != 0:
                fail(f"{page}: `{command}` fails, rc {done.returncode}: {done.stderr[-600:]}")
        installed = {str(p.relative_to(top / "prefix")) for p in (top / "prefix").rglob("*")}
        for wanted in [
            "bin/dyncal",
            "bin/dyncal-recorder",
            "share/man/man1/dyncal-run.1",
            "share/man/man1/dyncal-recorder.1",
            "share/bash-completion/completions/dyncal",
            "share/zsh/site-functions/_dyncal",
            "share/fish/vendor_completions.d/dyncal.fish",
            "lib/systemd/system/dyncal-acs@.service",
        ]:
            if wanted not in installed:
                fail(f"{page}: {wanted} was not installed")
        has_library = any(name.endswith("libdyncal_analysis.a") for name in installed)
        programs_only = any("--component programs" in command for command in commands)
        if has_library == programs_only:
            fail(f"{page}: libraries have to come without --component programs, and only then")
        print(f"{page}: {' ; '.join(commands)}: {len(installed)} files and folders")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, required=True)
    parser.add_argument("--cmake", required=True)
    parser.add_argument("--top", type=pathlib.Path)
    parser.add_argument("--answer", nargs=argparse.REMAINDER)
    options = parser.parse_args()
    if options.top:
        sys.exit(answer_cmake(options.answer, Build(options.build), options.top, options.cmake))
    for page in ["README.md", "deploy/README.md"]:
        check(page, options)


if __name__ == "__main__":
    main()
