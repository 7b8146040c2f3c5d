"""The stacks that are tried: how each is made from the IDL, and what it cannot do."""

import dataclasses
import os
import pathlib
import shutil
import subprocess
import sys
from collections.abc import Callable

from laboratory import CannotBeSetUp

HERE = pathlib.Path(__file__).resolve().parent
IDL = HERE.parents[2] / "idl/dyncal.idl"
PROFILES = HERE.parents[2] / "idl/profiles"
SETTINGS = {
    "CYCLONEDDS_URI": f"file://{PROFILES / 'cyclone_dds.xml'}",
    "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILES / "fast_dds.xml"),
    "FASTDDS_DEFAULT_PROFILES_FILE": str(PROFILES / "fast_dds.xml"),
}
PATIENCE_S = 3000


def call(*words, **settings):
    """What it prints; CannotBeSetUp with its last lines."""
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
        raise CannotBeSetUp(str(error)) from error
    if done.returncode:
        raise CannotBeSetUp(f"{words[0]}: {' '.join(done.stdout.split())[-200:]}")
    return done.stdout


def debian_version(package):
    return call("dpkg-query", "-W", "-f", "${Version}", package).split("+")[0].split("-")[0]


def is_newer(made, *sources):
    return made.exists() and all(made.stat().st_mtime > one.stat().st_mtime for one in sources)


def install(folder, package, version, **settings):
    """The Python of an environment in the folder that has this package of PyPI."""
    python = folder / "bin/python3"
    if not python.exists():
        call(sys.executable, "-m", "venv", folder)
    name = f"{package.replace('-', '_')}-{version}.dist-info"
    if not any(folder.glob(f"lib/python3*/site-packages/{name}")):
        pip = [python, "-m", "pip", "install", "-q", "--timeout", "20", f"{package}=={version}"]
        call(*pip, **settings)
    return python


def python_types(folder):
    """As for the wheel, but for XCDR1 by the QoS alone: the package 0.10 takes no other."""
    types = folder / "contract.py"
    if not is_newer(types, IDL):
        call(sys.executable, HERE.parents[2] / "deploy/python/write_contract.py", IDL, folder)
        text = (folder / "dds/types.py").read_text()
        types.write_text(text.replace("@annotations.cdrv0\n", ""))
    return types


def python_cyclone(version):
    def make(folder):
        settings = dict(os.environ)
        if version.startswith("0."):  # from its source, against Debian's library
            home = folder / "cyclonedds"
            home.mkdir(exist_ok=True)
            multiarch = call("gcc", "-print-multiarch").strip()
            places = {"include": "include", "lib": f"lib/{multiarch}", "bin": "bin"}
            for name, place in places.items():
                if not (home / name).exists():
                    (home / name).symlink_to(f"/usr/{place}")
            settings["CYCLONEDDS_HOME"] = str(home)
        python = install(folder, "cyclonedds", version, env=settings)
        return [python, "-B", HERE / "cyclone_python.py", python_types(folder)], version

    return make


def installed_python_cyclone(folder):
    """Of the first python3 on the path."""
    version = "import importlib.metadata as packages; print(packages.version('cyclonedds'))"
    version = call("python3", "-c", version).strip()
    return ["python3", "-B", HERE / "cyclone_python.py", python_types(folder)], version


def c_by_idlc(folder):
    program = folder / "cyclone_c"
    if not is_newer(program, IDL, HERE / "cyclone_c.c"):
        call("idlc", "-t", "-Wno-implicit-extensibility", IDL, cwd=folder)
        sources = [HERE / "cyclone_c.c", "dyncal.c"]
        call("gcc", "-O1", "-I.", *sources, "-lddsc", "-o", program, cwd=folder)
    return [program], debian_version("cyclonedds-dev")


def cpp_by_fastddsgen(folder):
    program = folder / "fast_cpp"
    if not is_newer(program, IDL, HERE / "fast_cpp.cpp"):
        call("fastddsgen", "-cs", "-replace", "-d", ".", "-t", ".", IDL, cwd=folder)
        sources = [HERE / "fast_cpp.cpp", "dyncal.cxx", "dyncalPubSubTypes.cxx"]
        libraries = ["-lfastrtps", "-lfastcdr"]
        call("g++", "-std=c++20", "-I.", *sources, *libraries, "-o", program, cwd=folder)
    return [program], debian_version("libfastrtps-dev")


def cpp_of_wheel(version):
    """The wheel has the library of C++ and its headers, and no module of Python."""

    def make(folder):
        python = install(folder, "ros-fastdds", version)
        program, source = folder / "fast3_dynamic", HERE / "fast3_dynamic.cpp"
        if not is_newer(program, source):
            packages = call(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))")
            places = f"{folder / 'lib'}:{packages.strip()}/ros_fastdds.libs"
            words = ["-std=c++20", "-isystem", folder / "include", source, f"-L{folder / 'lib'}"]
            words += ["-lfastdds", "-lfastcdr", "-Wl,--allow-shlib-undefined"]
            words += [f"-Wl,--disable-new-dtags,-rpath,{places}"]
            call("g++", *words, "-o", program)
        call(sys.executable, HERE / "types_of_idl.py", IDL, "table", folder / "table")
        return [program, folder / "table"], version

    return make


def rust(crate, types):
    def make(folder):
        if not shutil.which("cargo"):
            raise CannotBeSetUp("there is no cargo")
        room = HERE / f"{crate}_rust"
        call(sys.executable, HERE / "types_of_idl.py", IDL, crate, folder / "types.rs")
        settings = {"DYNCAL_TYPES": str(folder / "types.rs"), "CARGO_TARGET_DIR": str(folder)}
        cargo = ["cargo", "build", "-q", "-j1", "--release"]
        call(*cargo, cwd=room, env={**os.environ, **settings})
        text = (room / "Cargo.toml").read_text()
        version = text.split(f'{types} = "=')[1].split('"')[0]
        return [folder / f"release/{crate}_rust"], version

    return make


def python_dust(version):
    def make(folder):
        python = install(folder, "dust-dds", version)
        return [python, "-B", HERE / "dust_python.py"], version

    return make


NO_PARTITIONS = "it has no partitions, and samples are taken in the bench's alone"
NO_LISTS = "its Python module has no lists but of bytes"


def made_elsewhere(why):
    def make(_folder):
        raise CannotBeSetUp(why)

    return make


@dataclasses.dataclass
class Stack:
    name: str
    label: str  # in the table
    make: Callable[[pathlib.Path], tuple[list, str]]
    cannot: dict[str, str] = dataclasses.field(default_factory=dict)  # read, write: why
    partitions: bool = True
    forms: tuple[bool, ...] = (False,)  # whether it is in the long form, the short one, or both


STACKS = [
    Stack("cyclone-python-0.10", "Python, `cyclonedds` 0.10", python_cyclone("0.10.5")),
    Stack("cyclone-python-11", "Python, `cyclonedds` 11", python_cyclone("11.0.1")),
    Stack("cyclone-python", "Python", installed_python_cyclone, forms=(True,)),
    Stack("cyclone-c", "C, types by `idlc`", c_by_idlc, forms=(False, True)),
    Stack("fast-cpp", "C++, types by `fastddsgen`", cpp_by_fastddsgen, forms=(False, True)),
    Stack("fast3-cpp", "C++, Fast DDS 3 of the wheel `ros-fastdds`", cpp_of_wheel("3.2.3")),
    Stack("dust-rust", "Rust, `dust_dds`", rust("dust", "dust_dds")),
    Stack(
        *("rustdds", "Rust, `rustdds`", rust("rustdds", "rustdds")),
        cannot={"write": NO_PARTITIONS},
        partitions=False,
    ),
    Stack(
        *("dust-python", "Python, `dust-dds`", python_dust("0.16.0")),
        cannot={"read": NO_LISTS, "write": NO_LISTS},
    ),
    Stack(
        *("fast-python", "Python, Fast DDS"),
        made_elsewhere("PyPI has no Python module of it: `ros-fastdds` is the library of C++"),
    ),
    Stack(
        *("ros2-topic", "ROS 2, `ros2 topic`"),
        made_elsewhere("PyPI has `ros-rclpy`, but neither `ros2cli` nor `ros2topic`"),
    ),
    Stack("java", "Java, `rtpstalk`", made_elsewhere("Maven Central does not serve it here")),
]
