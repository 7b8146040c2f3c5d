"""What the checks of style share: the files of the tree, and how a check ends."""

import pathlib
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
CODE = (".cpp", ".hpp", ".c", ".h")


def tracked(*folders):
    """Paths of all files that git knows, or would add, below the folders; relative to the top."""
    listed = subprocess.run(
        [
            "git",
            "-c",
            "safe.directory=*",
            "ls-files",
            "-z",
            "--cached",
            "--others",
            "--exclude-standard",
            "--",
            *folders,
        ],
        cwd=TOP,
        capture_output=True,
        text=True,
    )
    if listed.returncode != 0:
        print("skipped: not a git checkout")
        sys.exit(77)
    paths = sorted(set(map(pathlib.PurePosixPath, filter(None, listed.stdout.split("\0")))))
    paths = [path for path in paths if (TOP / path).is_file() and not (TOP / path).is_symlink()]
    if not paths:
        sys.exit("no file found: the check would pass on nothing")
    return paths


def conclude(findings, what):
    """Prints one line a finding and ends: with 1 if there was one."""
    print(*findings, sep="\n")
    print(f"{len(findings)} {what}")
    sys.exit(1 if findings else 0)
