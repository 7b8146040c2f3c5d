#!/usr/bin/env python3
"""A test writes below a folder that nothing else uses: tests run beside each other, and so do two
checkouts on one machine. A file in the common temporary folder has the process id in its name, or
lies in a folder that mkdtemp made (tests/temporary_folder.hpp)."""

from tree import CODE, TOP, conclude, tracked

COMMON = ("TempDir()", "temp_directory_path()")
OWN = ("getpid()", "XXXXXX")


def shared_folders(path):
    text = (TOP / path).read_text()
    if any(own in text for own in OWN):
        return
    for number, line in enumerate(text.splitlines(), 1):
        if any(folder in line for folder in COMMON):
            yield f"{path}:{number}: takes a folder that others use: tests/temporary_folder.hpp"


def main():
    paths = [path for path in tracked("tests") if path.suffix in CODE]
    findings = [finding for path in paths for finding in shared_folders(path)]
    conclude(findings, f"places in {len(paths)} files")


if __name__ == "__main__":
    main()
