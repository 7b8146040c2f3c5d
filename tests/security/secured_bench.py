"""A live bench for campaigns whose programs are secured, each by the folder of its role."""

import pathlib
import subprocess
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "faults"))
from bench_laboratory import BenchLaboratory  # noqa: E402

ROLES = {
    "dyncal-acs": "source",
    "dyncal-dau": "source",
    "dyncal-analysis": "analysis",
    "dyncal-guard": "guard",
    "dyncal": "operator",
}
OF_A_BENCH = ("source", "guard", "operator")


def call(programs, *arguments):
    command = [str(pathlib.Path(programs) / "dyncal"), "security", *map(str, arguments)]
    subprocess.run(command, check=True, capture_output=True)


def issue(programs, folder, role, benches, output):
    named = [word for bench in benches for word in ("--bench", bench)]
    named = named if role in OF_A_BENCH else []
    call(programs, "issue", folder / "authority", role, *named, "--output", folder / output)


def secured_environments(programs, folder, benches):
    """The variables of each program, by its name; makes an authority and a folder for each role."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True)
    call(programs, "init", folder / "authority")
    for role in sorted({*ROLES.values()}):
        issue(programs, folder, role, benches, role)
    return {program: {"DYNCAL_SECURITY": str(folder / role)} for program, role in ROLES.items()}


class SecuredBench(BenchLaboratory):
    """`options` as BenchLaboratory has them."""

    def __init__(self, programs, folder, vendors, **options):
        self.security = pathlib.Path(folder) / "security"
        environments = secured_environments(programs, self.security, ["live"])
        super().__init__(programs, folder, vendors, environments=environments, **options)

    def call(self, programs, *arguments):
        call(programs, *arguments)

    def issue(self, programs, role, folder):
        issue(programs, self.security, role, ["live"], folder)
