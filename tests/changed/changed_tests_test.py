"""changed_tests.py on a small build by ninja: two libraries, their tests, a program."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
# "Compiling" copies; a source that says "broken" cannot be compiled.
NINJA = """
cmake_ninja_workdir = {build}/
rule compile
  command = ! grep -q broken $in && cp $in $out && echo "$out: $in {top}/$header" > $out.d
  depfile = $out.d
  deps = gcc
rule link
  command = cat $in > $out
build near.o: compile {top}/near.c
  header = near.h
build near$ test.o | ${{cmake_ninja_workdir}}near.note: compile {top}/near_test.c
  header = near.h
build libnear.a: link near.o
build far.o: compile {top}/far.c || libnear.a
  header = far.h
build libfar.a: link far.o || libnear.a
build bin/near_test: link near$ test.o | libnear.a || libfar.a
build bin/far_test: link libfar.a
build sub/sub.o: compile {top}/sub/sub.c
  header = far.h
build bin/dyncal-sub: link sub/sub.o
"""
CTEST = """
add_test(near "{build}/bin/near_test")
add_test(far "{build}/bin/far_test")
add_test(script "python3" "{top}/scripts/look_test.py")
add_test(whole "python3" "{top}/other/whole_test.py" "{build}/bin")
add_test(page "python3" "{top}/other/page_test.py" "tutorial.md")
add_test(style "true")
set_tests_properties(style PROPERTIES LABELS style)
"""
FILES = ("near.c", "near_test.c", "near.h", "far.c", "far.h", "sub/sub.c", "sub/CMakeLists.txt")
FILES += ("scripts/look_test.py", "scripts/shared.py", "other/whole_test.py", "other/page_test.py")
FILES += ("guide/tutorial.md", "LICENSE")


class ChangedTests(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.top = pathlib.Path(folder.name).resolve()
        self.build = self.top / "build"
        (self.build / "bin").mkdir(parents=True)
        places = {"top": self.top, "build": self.build}
        (self.build / "build.ninja").write_text(NINJA.format(**places))
        (self.build / "CTestTestfile.cmake").write_text(CTEST.format(**places))
        (self.top / ".gitignore").write_text("build\n")
        for name in FILES:
            (self.top / name).parent.mkdir(exist_ok=True)
            (self.top / name).write_text("")
        self.git("init", "-q")
        self.git("add", "-A")
        self.git("commit", "-q", "-m", "first")

    def git(self, *words):
        who = ["-c", "user.name=x", "-c", "user.email=x@example.org"]
        subprocess.run(["git", *who, *words], cwd=self.top, check=True)

    def built(self):
        subprocess.run(["ninja", "-C", self.build], check=True, capture_output=True)

    def run_tool(self, *words):
        command = [sys.executable, HERE / "changed_tests.py", "--build", self.build]
        command += ["--top", self.top, "--base", "HEAD", *words]
        return subprocess.run(command, capture_output=True, text=True)

    def chosen(self, *changed, text="new"):
        for name in changed:
            (self.top / name).write_text(text)
        done = self.run_tool()
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.said = done.stdout
        return set(done.stdout.splitlines()) & {"near", "far", "script", "whole", "page", "style"}

    def test_a_header_reaches_those_that_include_it_and_nobody_else(self):
        self.built()
        self.assertEqual(self.chosen("near.h"), {"near", "style"})
        self.assertIn("1 files changed, 1 programs", self.said)

    def test_what_is_only_made_before_is_not_reached(self):
        self.built()
        self.assertEqual(self.chosen("near.c"), {"near", "style"})

    def test_a_program_reaches_tests_of_whole_programs(self):
        self.built()
        self.assertEqual(self.chosen("sub/sub.c"), {"whole", "style"})

    def test_a_header_reaches_through_two_libraries(self):
        self.built()
        self.assertEqual(self.chosen("far.h"), {"far", "whole", "style"})

    def test_a_cmake_file_reaches_what_its_folder_makes(self):
        self.built()
        self.assertEqual(self.chosen("sub/CMakeLists.txt"), {"whole", "style"})

    def test_a_script_reaches_tests_of_its_folder(self):
        self.built()
        self.assertEqual(self.chosen("scripts/shared.py"), {"script", "style"})

    def test_a_page_reaches_the_test_that_is_given_it(self):
        self.built()
        self.assertEqual(self.chosen("guide/tutorial.md"), {"page", "style"})

    def test_nothing_changed_chooses_style_alone(self):
        self.built()
        self.assertEqual(self.chosen(), {"style"})

    def test_names_what_no_test_reads(self):
        self.built()
        self.assertEqual(self.chosen("LICENSE", "near.c"), {"near", "style"})
        self.assertIn("no test is known to read LICENSE", self.said)
        self.assertNotIn("read near.c", self.said)

    def test_a_new_file_counts(self):
        self.built()
        self.assertEqual(self.chosen("scripts/new.py"), {"script", "style"})

    def test_builds_what_is_reached_alone(self):
        self.built()
        (self.top / "sub/sub.c").write_text("broken")
        self.git("commit", "-q", "-a", "-m", "broken elsewhere")
        self.chosen("near.c", text="newer")
        self.assertEqual((self.build / "libnear.a").read_text(), "newer")
        self.assertEqual((self.build / "bin/dyncal-sub").read_text(), "")

    def test_fails_where_what_is_reached_does_not_build(self):
        self.built()
        (self.top / "near.c").write_text("broken")
        done = self.run_tool()
        self.assertEqual(done.returncode, 1)
        self.assertNotIn("chosen", done.stdout)

    def test_a_build_folder_without_a_build_is_refused(self):
        done = self.run_tool()
        self.assertEqual(done.returncode, 2)
        self.assertIn("nothing has been built", done.stdout)

    def test_ctest_runs_what_was_chosen(self):
        self.built()
        (self.top / "scripts/shared.py").write_text("new")
        numbers = self.build / "chosen"
        self.assertEqual(self.run_tool("--chosen", numbers).returncode, 0)
        ran = subprocess.run(
            ["ctest", "--test-dir", self.build, "-I", numbers], capture_output=True, text=True
        ).stdout
        self.assertIn("script ..", ran)
        self.assertIn("style ..", ran)
        self.assertIn("out of 2", ran)


if __name__ == "__main__":
    unittest.main()
