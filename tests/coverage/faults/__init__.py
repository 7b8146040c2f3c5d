"""Kinds of faults that are more than a setting of the bench: a module each, found by itself.

A module has CLASSES (name of the class to its bench), EXPECTED (rows, expected_row.py), and
MORE_DRAWS where a class needs more calibrations than others (name to how many times the usual).
"""

import importlib
import pkgutil

CLASSES, EXPECTED, MORE_DRAWS = {}, [], {}


def collect():
    for found in sorted(pkgutil.iter_modules(__path__), key=lambda one: one.name):
        module = importlib.import_module(f"{__name__}.{found.name}")
        if not hasattr(module, "CLASSES"):
            continue  # what several kinds share
        twice = set(CLASSES) & set(module.CLASSES)
        if twice:
            raise ValueError(f"{found.name} has classes that another kind has: {sorted(twice)}")
        CLASSES.update(module.CLASSES)
        EXPECTED.extend(module.EXPECTED)
        MORE_DRAWS.update(getattr(module, "MORE_DRAWS", {}))
