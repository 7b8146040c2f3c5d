#!/usr/bin/env python3
"""Every C and C++ file is laid out as clang-format 14 with .clang-format lays it out.

format.py [--fix]
"""

import filecmp
import pathlib
import shutil
import subprocess
import sys
import tempfile

from tree import CODE, TOP, conclude, tracked


def main():
    program = shutil.which("clang-format-14")
    if program is None:
        print("skipped: no clang-format-14 (Debian: clang-format-14); other versions differ")
        sys.exit(77)
    paths = [str(path) for path in tracked() if path.suffix in CODE]
    # In copies: clang-format touches files that it does not change, which would be compiled anew.
    # Not --dry-run: it refuses the comment behind an inline namespace, and changes nothing there.
    with tempfile.TemporaryDirectory(prefix="dyncal-format-") as folder:
        for path in [".clang-format", *paths]:
            copy = pathlib.Path(folder, path)
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(TOP / path, copy)
        subprocess.run([program, "-i", *paths], cwd=folder, check=True)
        findings = [
            path for path in paths if not filecmp.cmp(TOP / path, f"{folder}/{path}", shallow=False)
        ]
        if "--fix" in sys.argv:
            for path in findings:
                shutil.copyfile(f"{folder}/{path}", TOP / path)
            return
    conclude(findings, f"of {len(paths)} files: tests/style/format.py --fix")


if __name__ == "__main__":
    main()
