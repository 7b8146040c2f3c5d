"""Opens a recording in the format's own Python library, CRC checks on: public_reader.py FILE

Prints the number of messages. As a module: finds or installs the library.
"""

import os
import pathlib
import subprocess
import sys

READ = """
import sys
from mcap.reader import make_reader
for path in sys.argv[1:]:
    with open(path, "rb") as stream:
        count = 0
        for schema, channel, message in make_reader(stream, validate_crcs=True).iter_messages(
                log_time_order=False):
            count += 1
            assert schema.encoding == "omgidl" and channel.message_encoding == "cdr"
        print(count)
"""


def has_libraries(python, libraries):
    probe = [python, "-c", "; ".join(f"import {library}" for library in libraries)]
    try:
        return subprocess.run(probe, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def interpreter(folder, libraries=("mcap",), limit_s=120):
    """A Python that has the libraries; None where they cannot be had. `folder` may take them, for
    which pip has `limit_s`."""
    installed = pathlib.Path(folder) / f"{'-'.join(libraries)}-library"
    candidates = [os.environ.get("DYNCAL_MCAP_PYTHON"), sys.executable, installed / "bin/python3"]
    for python in candidates:
        if python and has_libraries(str(python), libraries):
            return str(python)
    steps = (
        [sys.executable, "-m", "venv", str(installed)],
        [str(installed / "bin/pip"), "install", "-q", "--timeout", "10", "--retries", "0"]
        + list(libraries),
    )
    for step in steps:
        try:
            done = subprocess.run(step, capture_output=True, check=False, timeout=limit_s)
        except (OSError, subprocess.TimeoutExpired):
            return None
        if done.returncode != 0:
            return None
    python = installed / "bin/python3"
    return str(python) if has_libraries(python, libraries) else None


def count_messages(python, paths):
    """Of each file, by the library's default reader. Raises with what it says."""
    done = subprocess.run(
        [python, "-c", READ, *map(str, paths)], capture_output=True, check=False, text=True
    )
    if done.returncode != 0:
        raise RuntimeError(f"{paths}: {done.stderr}")
    return [int(line) for line in done.stdout.split()]


if __name__ == "__main__":
    print(count_messages(sys.executable, sys.argv[1:]))
