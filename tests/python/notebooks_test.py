"""Every notebook of deploy/python/notebooks runs from its first to its last cell:
notebooks_test.py PROGRAMS FOLDER

They find the programs by PATH and work in a folder of their own. What a cell asserts must hold, and
every cell with code must have run.
"""

import os
import pathlib
import shutil
import sys
import unittest

import nbclient
import nbformat

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(TOP / "tests"))
from dds_domain import own_dds_domain  # noqa: E402

PATIENCE_S = 300


class Notebooks(unittest.TestCase):
    def test_every_notebook_runs(self):
        os.environ["PATH"] = f"{PROGRAMS}:{os.environ['PATH']}"
        os.environ["DYNCAL_DOMAIN"] = str(own_dds_domain())
        paths = sorted((TOP / "deploy/python/notebooks").glob("*.ipynb"))
        self.assertEqual(len(paths), 4)
        for path in paths:
            with self.subTest(path.name):
                folder = FOLDER / path.stem
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir(parents=True)
                notebook = nbformat.read(path, as_version=4)
                kept = [cell.get("outputs") for cell in notebook.cells if "outputs" in cell]
                self.assertFalse(any(kept), "outputs are not committed")
                client = nbclient.NotebookClient(
                    notebook,
                    timeout=PATIENCE_S,
                    kernel_name="python3",
                    resources={"metadata": {"path": str(folder)}},
                )
                client.execute()
                counts = [
                    cell.execution_count for cell in notebook.cells if cell.cell_type == "code"
                ]
                self.assertGreater(len(counts), 2)
                self.assertTrue(all(counts))


if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    unittest.main(argv=sys.argv[:1])
