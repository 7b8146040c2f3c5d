#!/usr/bin/env python3
"""Installs a build into a temporary prefix and checks what is there. Builds nothing of dyncal and
needs no network.

    installed_prefix_test.py --build BUILD ... Files|Programs|Library|Packages|Uninstall

Files      every file is where it belongs, units start the programs of the prefix, no file names the
           source or the build tree, no header a DDS library
Programs   run from the prefix
Library    deploy/example-library by find_package and by pkg-config, all headers, the bus, the
           mathematics alone by add_subdirectory
Packages   every file that is installed is in one Debian package, and each of its lists finds some
Uninstall  removing what install_manifest.txt lists leaves no file
"""

import argparse
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
# Whoever includes dyncal's headers needs no DDS library for it, and learns of none.
DDS_LIBRARY = re.compile(
    r"fast[ _-]?(dds|rtps|cdr)|eprosima|cyclone|\bddsc|opendds|rti[ _-]?connext", re.IGNORECASE
)
PROGRAMS = [
    "dyncal",
    "dyncal-acs",
    "dyncal-analysis",
    "dyncal-can",
    "dyncal-dau",
    "dyncal-dso",
    "dyncal-guard",
    "dyncal-recorder",
    "dyncal-virtual-bench",
]


def programs(options):
    """dyncal-web is not built where cpp-httplib is missing."""
    has_web = (options.build / "bin" / "dyncal-web").exists()
    return PROGRAMS + ["dyncal-web"] * has_web


def run(*command, **more):
    """The output of a command that must succeed."""
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"failed: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def expect(condition, sentence):
    if not condition:
        sys.exit(sentence)


def install(options, prefix, component=None):
    """Returns the list of what was installed; leaves the build's own list as it was."""
    suffix = f"_{component}" if component else ""
    manifest = options.build / f"install_manifest{suffix}.txt"
    kept = manifest.read_bytes() if manifest.exists() else None
    chosen = ["--component", component] if component else []
    try:
        run(options.cmake, "--install", options.build, "--prefix", prefix, *chosen)
        return [pathlib.Path(line) for line in manifest.read_text().splitlines()]
    finally:
        manifest.unlink(missing_ok=True)
        if kept is not None:
            manifest.write_bytes(kept)


def files_below(folder):
    return sorted(p for p in folder.rglob("*") if p.is_file() or p.is_symlink())


def check_files(options, prefix):
    install(options, prefix)
    for name in programs(options):
        expect(os.access(prefix / "bin" / name, os.X_OK), f"bin/{name} is missing")
    for name in [
        "lib/sysctl.d/60-dyncal.conf",
        "include/dyncal/analysis/sine/sine_fit.hpp",
        "include/dyncal/method.hpp",
        "include/dyncal/sine.hpp",
        "include/dyncal/services/bus/bus.hpp",
        "include/dyncal/idl/bounded_string.hpp",
        "include/dyncal/idl/dyncal.h",
        "share/dyncal/idl/dyncal.idl",
        "share/doc/dyncal/LICENSE",
        "share/doc/dyncal/example-lab/documents/laboratory.toml",
        "share/man/man1/dyncal-run.1",
        "share/bash-completion/completions/dyncal",
        "share/zsh/site-functions/_dyncal",
        "share/fish/vendor_completions.d/dyncal.fish",
        *(f"share/man/man1/{name}.1" for name in PROGRAMS),
    ]:
        expect((prefix / name).is_file(), f"{name} is missing")

    guide = options.build / "share/doc/dyncal/guide"
    for page in files_below(guide) if guide.exists() else []:
        installed = prefix / "share/doc/dyncal/guide" / page.relative_to(guide)
        expect(installed.is_file(), f"{installed.relative_to(prefix)} is missing")

    units = files_below(prefix / "lib/systemd/system")
    expect(len(units) == 8, f"8 units expected, {len(units)} found")
    for unit in units:
        started = re.search(r"^ExecStart=(\S+)", unit.read_text(), re.M)
        expect(started, f"{unit} starts nothing")
        program = pathlib.Path(started[1])
        expect(
            program.parent == prefix / "bin" and program.name == unit.stem.rstrip("@"),
            f"{unit} starts {program}",
        )

    expect(not (prefix / "include/dyncal/analysis/sine/kernel").exists(), "the kernels are private")
    headers = files_below(prefix / "include")
    expect(
        all(p.is_relative_to(prefix / "include/dyncal") for p in headers),
        "a header is outside include/dyncal",
    )
    folders = (re.escape(str(folder).encode()) for folder in (TOP, options.build))
    tree = re.compile(rb"(?<![\w./-])(" + b"|".join(folders) + rb")/")  # not /etc/dyncal/
    for path in files_below(prefix):
        content = path.read_bytes()
        expect(
            not tree.search(content),
            f"{path} names a file of the source or build tree",
        )
    for header in headers:
        stray = re.search(r'#include "(?!dyncal/).*"', header.read_text())
        expect(not stray, f"{header}: {stray and stray[0]}")
        vendor = DDS_LIBRARY.search(header.read_text())
        expect(not vendor, f"{header} names a DDS library: {vendor and vendor[0]}")


def check_programs(options, prefix):
    install(options, prefix)
    for name in programs(options):
        printed = run(prefix / "bin" / name, "--version")
        expect(printed.startswith(f"dyncal {options.version}"), f"{name} --version: {printed}")
    data = prefix / "data.csv"
    data.write_text(
        "t_ns,a\n" + "".join(f"{i * 1000000},{(0, 1, 0, -1)[i % 4]}\n" for i in range(400))
    )
    printed = run(prefix / "bin/dyncal", "fit", data, "--frequency", "250", "--json")
    expect(re.search(r'"amplitude": *(1\.0|0\.99999)', printed), printed)


def compile_headers(options, prefix, folder):
    """The doors, and all headers of each part together, with warnings."""
    include = prefix / "include/dyncal"
    doors = [include / door for door in ("method.hpp", "sine.hpp")]
    parts = [(one, files_below(include / one)) for one in ("analysis", "services")]
    for part, headers in [("doors", doors), *parts]:
        expect(len(headers) >= (2 if headers == doors else 4), f"only {len(headers)} of {part}")
        source = folder / f"{part}.cpp"
        source.write_text(
            "".join(f"#include <{header.relative_to(prefix / 'include')}>\n" for header in headers)
        )
        command = [options.compiler, "-std=c++20", "-Wall", "-Wextra", "-Werror"]
        command += ["-I", prefix / "include", source]
        run(*command, "-fsyntax-only")
        vendor = DDS_LIBRARY.search(run(*command, "-M"))
        expect(not vendor, f"the headers of {part} include those of {vendor and vendor[0]}")


def check_library(options, prefix):
    if options.sanitize != "OFF":
        print("skipped: the libraries of this build need a sanitizer")
        sys.exit(77)
    install(options, prefix, "development")
    prefix = prefix.rename(prefix.with_name("moved"))  # package files hold no absolute path
    folder = prefix.parent
    compile_headers(options, prefix, folder)

    def build(source, program, *settings):
        where = folder / program
        run(
            options.cmake,
            "-G",
            "Ninja",
            "-S",
            source,
            "-B",
            where,
            f"-DCMAKE_CXX_COMPILER={options.compiler}",
            *settings,
        )
        run(options.cmake, "--build", where)
        return run(where / program)

    example = TOP / "deploy/example-library"
    printed = build(example, "fit_a_sine", f"-DCMAKE_PREFIX_PATH={prefix}")
    expect(printed == "amplitude 2.5\n", printed)

    environment = dict(os.environ, PKG_CONFIG_PATH=str(prefix / "lib/pkgconfig"))
    for package, source in [
        ("dyncal-analysis", example / "fit_a_sine.cpp"),
        ("dyncal-bus", TOP / "tests/install/bus/list_vendors.cpp"),
    ]:
        flags = run("pkg-config", "--cflags", "--libs", package, env=environment).split()
        run(options.compiler, "-std=c++20", source, *flags, "-o", folder / package)
        expect(run(folder / package), f"{package}: the program prints nothing")

    expect(
        "dds: "
        in build(TOP / "tests/install/bus", "list_vendors", f"-DCMAKE_PREFIX_PATH={prefix}"),
        "list_vendors prints nothing",
    )

    # Where Fast DDS is not installed. A whole build takes minutes: one source of the contract's.
    alone = folder / "alone"
    run(
        options.cmake,
        *("-G", "Ninja", "-S", TOP, "-B", alone, f"-DCMAKE_CXX_COMPILER={options.compiler}"),
        *("-DDYNCAL_FAST_DDS=OFF", "-DDYNCAL_BUILD_TESTS=OFF", "-DDYNCAL_PRECOMPILED_HEADERS=OFF"),
        "-DCMAKE_DISABLE_FIND_PACKAGE_fastrtps=TRUE",
    )
    built = "services/contract/CMakeFiles/dyncal_contract.dir/source_kind.cpp.o"
    run(options.cmake, "--build", alone, "--target", built)
    used = run("ninja", "-C", alone, "-t", "deps", built)
    expect("idl/dyncal.h" in used, f"{built} does not include the contract:\n{used}")
    expect(not re.search("fastrtps|fastdds", used), f"{built} includes Fast DDS:\n{used}")

    # As part of another project: it is only configured, since building it takes minutes.
    whole = folder / "whole"
    whole.mkdir()
    (whole / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(whole LANGUAGES CXX)\n"
        f"add_subdirectory({TOP}/analysis analysis)\nadd_executable(fit {example}/fit_a_sine.cpp)\n"
        "target_link_libraries(fit PRIVATE dyncal::analysis)\n"
    )
    run(options.cmake, "-G", "Ninja", "-S", whole, "-B", whole / "build")
    run(
        options.cmake,
        "--build",
        whole / "build",
        "--target",
        "CMakeFiles/fit.dir" + str(example / "fit_a_sine.cpp.o"),
    )


def check_packages(options, prefix):
    # Debian has libraries in a folder of the machine's kind.
    installed = [
        re.sub("^usr/lib/(cmake|pkgconfig|[^/]*[.]a)", r"usr/lib/any/\1", f"usr/{path}")
        for path in (path.relative_to(prefix) for path in install(options, prefix))
    ]
    debian = TOP / "deploy/debian"
    packages = {path.name: path.read_text().split() for path in debian.glob("*.install")}
    packages["not-installed"] = (debian / "not-installed").read_text().split()
    if not (options.build / "bin/dyncal-web").exists():
        del packages["dyncal-web.install"]

    def takes(pattern, path):
        return fnmatch.fnmatch(path, pattern) or fnmatch.fnmatch(path, f"{pattern}/*")

    for path in installed:
        takers = [n for n, patterns in packages.items() if any(takes(p, path) for p in patterns)]
        expect(len(takers) == 1, f"{path} is in {takers or 'no package'}")
    for package, patterns in packages.items():
        for pattern in patterns:
            expect(any(takes(pattern, path) for path in installed), f"{package}: no {pattern}")


def check_uninstall(options, prefix):
    installed = install(options, prefix)
    for path in installed:
        path.unlink()
    left = files_below(prefix)
    expect(len(installed) > 50 and not left, f"{len(installed)} removed, left: {left}")


def main():
    parser = argparse.ArgumentParser()
    for name in ["build", "cmake", "compiler", "sanitize", "version"]:
        parser.add_argument("--" + name, required=True)
    checks = {
        "Files": check_files,
        "Programs": check_programs,
        "Library": check_library,
        "Packages": check_packages,
        "Uninstall": check_uninstall,
    }
    parser.add_argument("part", choices=checks)
    options = parser.parse_args()
    options.build = pathlib.Path(options.build)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-install-"))
    try:
        checks[options.part](options, folder / "prefix")
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
