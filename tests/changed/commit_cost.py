#!/usr/bin/env python3
"""What a commit costs those who build after it: the median of the processor time that it takes to
compile what a commit reaches.

    commit_cost.py --build BUILD [--commits N] [--sample N] [--seed N] [--worst N]

Of each of the last commits that changed code, the files that are still there, by their names of
today, and what is compiled from them by the headers that ninja has noted in this build. What a unit
costs is measured on a drawn sample, apart for tests and for everything else, without ccache; the
build must be up to date. --worst: names the headers that most units include. Exit status 2: nothing
has been built here.
"""

import argparse
import collections
import json
import os
import random
import resource
import shlex
import statistics
import subprocess
import sys

from build_graph import BuildGraph

TOP = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CODE = (".cpp", ".hpp", ".c", ".h", ".idl")


def code_commits(top, wanted):
    """Of each commit, newest first: the files that it changed, as they are called today."""
    done = subprocess.run(
        ["git", "-c", "safe.directory=*", "-C", top, "log", "--no-merges", "--name-status", "-M"]
        + ["--format=tformat:commit"],
        capture_output=True,
        text=True,
        check=True,
    )
    today = {}
    commits = []
    for commit in done.stdout.split("commit\n")[1:]:
        files = set()
        moved = {}
        for line in commit.split("\n"):
            _kind, *names = line.split("\t")
            if names and names[-1].endswith(CODE):
                files.add(today.get(names[-1], names[-1]))
            if len(names) == 2:
                moved[names[0]] = today.get(names[1], names[1])
        today.update(moved)
        if files:
            commits.append(files)
        if len(commits) == wanted:
            break
    return commits


def processor_seconds(entry):
    """Of compiling one unit as the build does, but for ccache and what it leaves behind."""
    words = shlex.split(entry["command"])
    words[words.index("-o") + 1] = os.devnull
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, cwd=entry["directory"], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Costs:
    """Mean seconds of a unit, of tests and of everything else, from a drawn sample."""

    def __init__(self, top, units, sample, seed):
        self.tests = os.path.join(top, "tests") + os.sep
        kinds = collections.defaultdict(list)
        for entry in units.values():
            kinds[self.kind(entry)].append(entry)
        draw = random.Random(seed)
        self.mean = {}
        for kind, entries in sorted(kinds.items()):
            drawn = draw.sample(entries, min(sample, len(entries)))
            seconds = [processor_seconds(entry) for entry in drawn]
            self.mean[kind] = statistics.mean(seconds)
            error = statistics.stdev(seconds) / len(seconds) ** 0.5 if len(seconds) > 1 else 0
            print(
                f"{kind}: {len(entries)} units of {self.mean[kind]:.2f} s "
                f"(+- {error:.2f} s, {len(drawn)} compiled)"
            )

    def kind(self, entry):
        return "tests" if entry["file"].startswith(self.tests) else "programs"

    def of(self, entries):
        return sum(self.mean[self.kind(entry)] for entry in entries)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--build", required=True)
    parser.add_argument("--commits", type=int, default=178)
    parser.add_argument("--sample", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--worst", type=int, default=0)
    parser.add_argument("--top", default=TOP)
    options = parser.parse_args()

    graph = BuildGraph(options.build)
    if not graph.has_built:
        print("nothing has been built here yet")
        sys.exit(2)
    with open(os.path.join(options.build, "compile_commands.json"), encoding="utf-8") as file:
        units = {}
        for entry in json.load(file):
            words = shlex.split(entry["command"])
            if "c++-header" not in words:  # no commit reaches what is precompiled
                units[graph.path(words[words.index("-o") + 1])] = entry

    def reached(names):
        made = graph.reached({os.path.join(options.top, name) for name in names})
        return [units[name] for name in made if name in units]

    commits = code_commits(options.top, options.commits)
    costs = Costs(options.top, units, options.sample, options.seed)
    numbers = [(len(entries), costs.of(entries)) for entries in map(reached, commits)]
    print(
        f"median of {len(numbers)} commits: {statistics.median(n for n, _ in numbers):.0f} units, "
        f"{statistics.median(seconds for _, seconds in numbers):.1f} s of processor"
    )
    touched = collections.Counter(name for files in commits for name in files)
    worst = sorted(
        ((len(reached({name})) * times, name, times) for name, times in touched.items()),
        reverse=True,
    )
    for weight, name, times in worst[: options.worst]:
        print(f"{weight:6} units by {times} commits to {name}")


if __name__ == "__main__":
    main()
