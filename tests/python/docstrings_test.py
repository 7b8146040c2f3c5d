"""Every public name of the package says what it is: docstrings_test.py

Functions and classes of the compiled modules name their source, functions the errors that they
raise, and every array its element and shape. What Python modules define has a docstring, too.
"""

import inspect
import re
import unittest

import dyncal
import dyncal.acs
import dyncal.cdr
import dyncal.dds
import dyncal.errors
import dyncal.models
import dyncal.recording
import dyncal.result

MODULES = [dyncal, dyncal.acs, dyncal.cdr, dyncal.dds, dyncal.errors, dyncal.models]
MODULES += [dyncal.recording, dyncal.result]
COMPILED = ("dyncal._dyncal", "dyncal.models")
CANNOT_FAIL = {"contribution_identifier", "displacement_per_turn_m", "make_repetition"}
AS_ANOTHER = re.compile(r"Shapes, units and\s+errors\s+as\s+(\w+)")
SOURCE = re.compile(r"Source: .*(analysis/\S+\.hpp|GUM|JCGM|IEEE|paper)", re.S)
ARRAY = re.compile(r"NDArray\[numpy\.(\w+)\]")


def words(documentation):
    """Of what is said of it, without the signatures that nanobind begins with."""
    lines = (documentation or "").splitlines()
    return [word for line in lines if "->" not in line for word in line.split()]


class Docstrings(unittest.TestCase):
    def public(self, module):
        for name, value in vars(module).items():
            if name.startswith("_") or inspect.ismodule(value):
                continue
            if getattr(value, "__module__", "").startswith("dyncal"):
                yield f"{module.__name__}.{name}", value

    def test_every_public_name_is_described(self):
        described = 0
        for module in MODULES:
            self.assertGreater(len(words(module.__doc__)), 4, module.__name__)
            for name, value in self.public(module):
                if not (inspect.isclass(value) or callable(value)):
                    continue
                described += 1
                with self.subTest(name):
                    said = inspect.getdoc(value) or ""
                    self.assertGreater(len(words(said)), 2, said)
                    if value.__module__ in COMPILED:
                        self.check_compiled(name.rpartition(".")[2], value, said)
                    if inspect.isclass(value):
                        self.check_methods(name, value)
        self.assertGreater(described, 90)

    def check_compiled(self, name, value, said):
        self.assertRegex(said, SOURCE)
        if inspect.isclass(value):
            return
        if other := AS_ANOTHER.search(said):
            self.assertTrue(hasattr(dyncal, other[1]), said)
            return
        if name not in CANNOT_FAIL:
            self.assertRegex(said, r"[Rr]aises\s+Error")
        for element in set(ARRAY.findall(said)):
            self.assertIn(f"{element} (n", said.partition("\n\n")[2], "element and shape")

    def check_methods(self, name, value):
        for method, function in vars(value).items():
            is_own = callable(function) and not method.startswith("_")
            if is_own and not inspect.isclass(function):
                documented = inspect.getdoc(getattr(value, method)) or ""
                self.assertGreater(len(words(documented)), 1, f"{name}.{method}")


if __name__ == "__main__":
    unittest.main()
