#!/usr/bin/env python3
"""Every C and C++ file is laid out as clang-format 14 with .clang-format lays it out.

format.py [--fix]
"""

import shutil
import subprocess
import sys

from tree import CODE, TOP, conclude, tracked


def main():
    program = shutil.which("clang-format-14")
    if program is None:
        print("skipped: no clang-format-14 (Debian: clang-format-14); other versions differ")
        sys.exit(77)
    paths = [str(path) for path in tracked() if path.suffix in CODE]
    if "--fix" in sys.argv:
        subprocess.run([program, "-i", *paths], cwd=TOP, check=True)
        return
    done = subprocess.run(
        [program, "--dry-run", "-Werror", "-ferror-limit=1", *paths],
        cwd=TOP,
        capture_output=True,
        text=True,
    )
    findings = sorted(
        {
            ":".join(line.split(":")[:2])
            for line in done.stderr.splitlines()
            if "[-Wclang-format-violations]" in line
        }
    )
    if done.returncode != 0 and not findings:
        sys.exit(done.stderr)
    conclude(findings, f"of {len(paths)} files: tests/style/format.py --fix")


if __name__ == "__main__":
    main()
