#!/usr/bin/env python3
"""Builds what has changed, and names the tests that it reaches: tests/run.sh --changed.

    changed_tests.py --build BUILD [--base COMMIT] [--chosen FILE]

Changed is what differs from where the branch left its upstream (on main without an upstream: from
the commit before), committed or not. A test is chosen if

    its program, or a program or file that it is given, is made from something that changed;
    it is given the folder of all programs, and a program of dyncal is made from it;
    its script, or another file in the script's folder, changed;
    it looks at how the code is written.

Of a changed CMakeLists.txt all that its folder makes counts as changed. What no test is known to
read is named. --chosen: the tests' numbers, for 'ctest -I FILE'. Exit status 2: nothing has been
built here, so that nothing is known of headers.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "style"))

from build_graph import BuildGraph  # noqa: E402
from tidy import base_commit  # noqa: E402
from tree import TOP  # noqa: E402

SCRIPTS = (".py", ".sh")


def changed_files(top, base):
    git = ["git", "-c", "safe.directory=*", "-C", top]
    names = set()
    for words in (["diff", "--name-only", base], ["ls-files", "--others", "--exclude-standard"]):
        done = subprocess.run([*git, *words], capture_output=True, text=True, check=True)
        names |= set(done.stdout.splitlines())
    return {os.path.join(top, name) for name in names}


def seeds(graph, top, changed):
    found = set(changed)
    for name in changed:
        if os.path.basename(name) == "CMakeLists.txt":
            found |= graph.below(os.path.relpath(os.path.dirname(name), top))
    return found


class Choice:
    def __init__(self, graph, changed, reached):
        self.folder = graph.path("bin")
        self.reached = reached
        self.changed = changed
        self.programs = {name for name in reached if os.path.dirname(name) == self.folder}
        self.any_program = any(os.path.basename(one).startswith("dyncal") for one in self.programs)
        self.read = set()  # of the changed files: what some test reads

    def beside(self, script):
        """Changed files in the folder of a script, or below it."""
        top = os.path.dirname(script) + os.sep
        return {name for name in self.changed if name.startswith(top)}

    def takes(self, test):
        labels = next((p["value"] for p in test["properties"] if p["name"] == "LABELS"), [])
        if "style" in labels:
            return True
        chosen = False
        for word in test.get("command", []):
            if word == self.folder:
                chosen |= self.any_program
            elif word.endswith(SCRIPTS) and self.beside(word):
                self.read |= self.beside(word)
                chosen = True
            elif word in self.reached:
                self.read |= {word} & self.changed
                chosen = True
            elif os.sep not in word:  # a page by its name
                pages = {one for one in self.changed if os.path.basename(one) == word}
                self.read |= pages
                chosen |= bool(pages)
        return chosen


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", required=True)
    parser.add_argument("--base")
    parser.add_argument("--chosen", type=pathlib.Path)
    parser.add_argument("--top", default=str(TOP))
    options = parser.parse_args()

    changed = changed_files(options.top, options.base or base_commit())
    graph = BuildGraph(options.build)
    if graph.path("build.ninja") in graph.made:
        subprocess.run(["ninja", "-C", options.build, "build.ninja"], check=True)
        graph = BuildGraph(options.build)
    if not graph.has_built:
        print("nothing has been built here yet: run tests/run.sh without --changed once")
        sys.exit(2)
    reached = graph.reached(seeds(graph, options.top, changed))
    choice = Choice(graph, changed, reached)
    if choice.programs:
        programs = sorted(os.path.relpath(one, options.build) for one in choice.programs)
        done = subprocess.run(["ninja", "-C", options.build, *programs])
        if done.returncode != 0:
            sys.exit(1)

    listed = subprocess.run(
        ["ctest", "--test-dir", options.build, "--show-only=json-v1"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    tests = json.loads(listed)["tests"]
    chosen = {number: test for number, test in enumerate(tests, 1) if choice.takes(test)}
    for name in sorted(changed - choice.read):
        if not any(one in graph.users for one in seeds(graph, options.top, {name})):
            print(f"no test is known to read {os.path.relpath(name, options.top)}")
    print(
        f"{len(changed)} files changed, {len(choice.programs)} programs are made from them, "
        f"{len(chosen)} of {len(tests)} tests are chosen"
    )
    if options.chosen:
        options.chosen.write_text("0,0,0," + ",".join(map(str, chosen)) + "\n")
    else:
        print(*(test["name"] for test in chosen.values()), sep="\n")


if __name__ == "__main__":
    main()
