"""commit_cost.py on a small build by ninja, whose compiler does nothing, and its history."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
NINJA = """
rule compile
  command = cp $in $out && echo "$out: $in {top}/$header" > $out.d
  depfile = $out.d
  deps = gcc
build near.o: compile {top}/near.cpp
  header = shared.hpp
build far.o: compile {top}/far.cpp
  header = shared.hpp
build test.o: compile {top}/tests/test.cpp
  header = tests/test.hpp
"""
SOURCES = {"near.o": "near.cpp", "far.o": "far.cpp", "test.o": "tests/test.cpp"}


class CommitCost(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.top = pathlib.Path(folder.name).resolve()
        self.build = self.top / "build"
        self.build.mkdir()
        (self.top / "tests").mkdir()
        (self.top / ".gitignore").write_text("build\n")
        (self.build / "build.ninja").write_text(NINJA.format(top=self.top))
        commands = [
            {
                "directory": str(self.build),
                "command": f"/bin/true -o {made} -c {self.top / source}",
                "file": str(self.top / source),
            }
            for made, source in SOURCES.items()
        ]
        (self.build / "compile_commands.json").write_text(json.dumps(commands))
        self.git("init", "-q")

    def git(self, *words):
        who = ["-c", "user.name=x", "-c", "user.email=x@example.org"]
        subprocess.run(["git", *who, *words], cwd=self.top, check=True)

    def commit(self, *names):
        for name in names:
            with open(self.top / name, "a", encoding="utf-8") as file:
                file.write("a line that is long enough to be known again\n" * 5)
        self.git("add", "-A")
        self.git("commit", "-q", "-m", "change")

    def run_tool(self, *words):
        command = [sys.executable, HERE / "commit_cost.py", "--build", self.build]
        command += ["--top", self.top, *words]
        return subprocess.run(command, capture_output=True, text=True)

    def units(self, commits):
        subprocess.run(["ninja", "-C", self.build], check=True, capture_output=True)
        done = self.run_tool("--commits", str(commits), "--worst", "1")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.said = done.stdout
        return done.stdout.split(" commits: ")[1].split(" units")[0]

    def test_counts_what_the_median_commit_reaches(self):
        self.commit(*SOURCES.values(), "tests/test.hpp", "old.hpp")
        self.git("mv", "old.hpp", "shared.hpp")
        self.git("commit", "-q", "-m", "move")
        self.commit("near.cpp")
        self.commit("README")  # no code
        self.commit("shared.hpp")
        self.assertEqual(self.units(1), "2")
        self.assertIn("programs: 2 units", self.said)
        self.assertIn("tests: 1 units", self.said)
        self.assertIn("2 units by 1 commits to shared.hpp", self.said)
        self.commit("tests/test.cpp")
        self.assertEqual(self.units(3), "1")  # 1, 2, 1: the page counts for nothing
        self.assertEqual(self.units(5), "2")  # and 2 by the move, 3 by the first

    def test_knows_a_file_by_its_name_of_today(self):
        self.commit(*SOURCES.values(), "tests/test.hpp", "old.hpp")
        self.commit("old.hpp")
        self.git("mv", "old.hpp", "shared.hpp")
        self.git("commit", "-q", "-m", "move")
        self.assertEqual(self.units(2), "2")

    def test_a_build_folder_without_a_build_is_refused(self):
        self.commit(*SOURCES.values())
        done = self.run_tool()
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing has been built", done.stdout)


if __name__ == "__main__":
    unittest.main()
