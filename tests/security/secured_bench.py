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


class SecuredBench(BenchLaboratory):
    """`options` as BenchLaboratory has them."""

    def __init__(self, programs, folder, vendors, **options):
        self.security = pathlib.Path(folder) / "security"
        self.security.mkdir(parents=True)
        self.call(programs, "init", self.security / "authority")
        for role in sorted({*ROLES.values()}):
            self.issue(programs, role, role)
        environments = {
            program: {"DYNCAL_SECURITY": str(self.security / role)}
            for program, role in ROLES.items()
        }
        super().__init__(programs, folder, vendors, environments=environments, **options)

    def call(self, programs, *arguments):
        command = [str(pathlib.Path(programs) / "dyncal"), "security", *map(str, arguments)]
        subprocess.run(command, check=True, capture_output=True)

    def issue(self, programs, role, folder):
        bench = ["--bench", "live"] if role in OF_A_BENCH else []
        place = self.security / folder
        self.call(
            programs, "issue", self.security / "authority", role, *bench, "--output", place
        )
