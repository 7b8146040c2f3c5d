"""`dyncal analyse` on a folder of drawn files, for all that judge its results.

To be imported before what needs numpy: where that is not there, says so and leaves with status 77.
Keeps numpy to one thread a process.
"""

import json
import os
import subprocess
import sys

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"
try:
    import numpy  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing}; install python3-numpy")
    sys.exit(77)

PROCESSES = 2
ANALYSE_TIMEOUT_S = 120


def analysed(program, folder):
    """The result, or nothing where there is none; and what the program says about it."""
    result = folder / "result.json"
    result.unlink(missing_ok=True)  # of another drawing
    run = subprocess.run(
        [program, "analyse", folder / "bench.toml", "--output", result],
        capture_output=True,
        text=True,
        timeout=ANALYSE_TIMEOUT_S,
        check=False,
    )
    if run.returncode not in (0, 1) or "runtime error:" in run.stderr or "Sanitizer" in run.stderr:
        raise RuntimeError(f"dyncal analyse ended with {run.returncode}: {run.stderr}")
    return json.loads(result.read_text("utf-8")) if result.exists() else None, run.stderr
