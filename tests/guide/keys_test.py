#!/usr/bin/env python3
"""Holds the guide's reference of keys against the readers of bench, laboratory and sensor files: no
key is missing or made up; type, unit, default and choices are those of the code; a key is required
exactly if a file is refused without it; the ends of its range are accepted, and what lies beyond is
refused.

    keys_test.py READ_TABLES
"""

import copy
import math
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

import asked_keys
import described_keys
import examples
import readers
import toml_text

PROGRAM = sys.argv[1]
# For keys of tables that no example has.
TABLES = {
    "corrections.adc": {"file": "adc.json", "channel": "ADC1"},
    "corrections.dso_delay": {"value_s": 1e-9, "u_s": 1e-9},
    "check": {"sensor": "x", "max_age_h": 24.0},
    "excitation.transverse_motion": {"ratio": 0.02, "source": "x"},
    "customer": {"name": "x", "city": "x", "country": "DE"},
    "conditions": {},
    "run": {"on_end": ["x"]},
}
# A value and its uncertainty go together.
COMPANIONS = {
    "play of can": ("log", "drive.log"),
    "wavelength_nm": ("u_wavelength_rel", 1e-6),
    "wavelength_vacuum_nm": ("u_wavelength_rel", 1e-6),
    "temperature_degc": ("U_temperature_k", 1.0),
    "humidity_percent": ("U_humidity_percent", 1.0),
    "pressure_hpa": ("U_pressure_hpa", 1.0),
    "U_temperature_k": ("temperature_degc", 20.0),
    "U_humidity_percent": ("humidity_percent", 20.0),
    "U_pressure_hpa": ("pressure_hpa", 1000.0),
}


# Where a quantity is found, and its uncertainty, in a bench file.
FOUND = {
    "temperature": ("U_temperature_k", 1.0),
    "humidity": ("U_humidity_percent", 1.0),
    "pressure": ("U_pressure_hpa", 1.0),
    "U_temperature_k": ("temperature", "a/b"),
    "U_humidity_percent": ("humidity", "a/b"),
    "U_pressure_hpa": ("pressure", "a/b"),
}


def real_name(tables, name):
    """Every dotted name in the file that a described name stands for: NAME is any source."""
    names = [[]]
    for part in name.split("."):
        if part == "NAME":
            names = [[*path, source] for path in names for source in tables.get("sources", {})]
        else:
            names = [[*path, part] for path in names]
    return names


def lookup(tables, path):
    for part in path:
        tables = examples.first_table(tables)
        if tables is None:
            return None
        tables = tables.get(part)
    return tables


def fits(table, conditions):
    return all(table.get(key) == value for key, value in conditions)


def bounds(text):
    """(accepted, refused) of a range of numbers."""
    if text == "any":
        return [-1.0, 0.0, 1.0], []
    if "above 0" in text:
        return [1e-3], [0.0, -1.0]
    if found := re.fullmatch(r"(\d+) or more", text):
        return [int(found[1])], [int(found[1]) - 1]
    if found := re.fullmatch(r"(-?[\d.]+) to ([\d.]+)", text):
        low, high = float(found[1]), float(found[2])
        return [low, high], [low - 1.0, high * 1.01]
    return [], []


def away_from_zero(value):
    return math.floor(value) if value < 0 else math.ceil(value)


class Keys(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="dyncal-guide-keys-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.asked = {
            reader: asked_keys.search(PROGRAM, reader, cls.folder) for reader in asked_keys.READERS
        }
        cls.described = described_keys.all_descriptions()
        cls.examples = examples.all_examples(PROGRAM, cls.folder)
        examples.stub_files([*TABLES.values(), *COMPANIONS.values()], cls.folder)

    def known_contexts(self, reader, name):
        """What the key's table may be, as its readers know it: the search tries more than that."""
        asked = self.asked[reader]
        table = name.rpartition(".")[0]
        kinds = {
            frozenset([(discriminator, choice)])
            for discriminator in asked_keys.DISCRIMINATORS
            for questions in asked.get(f"{table}.{discriminator}", {}).values()
            for question in questions
            for choice in question["choices"]
        }
        return kinds or {frozenset()}

    def contexts(self, description):
        """Those in which the described key is asked for, and all of its table."""
        known = self.known_contexts(description.reader, description.name)
        return known & self.asked[description.reader][description.name].keys(), known

    def problem(self, reader, tables):
        text = toml_text.to_toml(tables)
        return readers.ask(PROGRAM, [(reader, text, self.folder / "x.toml")])[0]["problem"]

    def test_every_key_is_described(self):
        missing = []
        for reader, asked in self.asked.items():
            for name, contexts in asked.items():
                types = {q["type"] for questions in contexts.values() for q in questions}
                tables = ("person", "equipment", "tolerance")
                if types <= {"table", ""} and (types != {""} or name in tables):
                    continue  # a table: its keys are described
                for context in contexts.keys() & self.known_contexts(reader, name):
                    where = [
                        d
                        for d in self.described
                        if d.reader == reader and d.name == name and d.conditions <= context
                    ]
                    if len(where) > 1:
                        missing.append(f"{where[0]} is described twice")
                    if not where:
                        missing.append(f"{reader} file: {name} {dict(context)} is not described")
        self.assertEqual(sorted(set(missing)), [])
        self.assertGreater(sum(len(asked) for asked in self.asked.values()), 100)

    def test_every_described_key_is_read(self):
        for description in self.described:
            self.assertIn(description.name, self.asked[description.reader], description)
            of_key, of_table = self.contexts(description)
            if not description.conditions:
                self.assertEqual(of_key, of_table, f"{description} is not for all of its table")
            else:
                self.assertIn(description.conditions, of_key, description)

    def questions(self, description):
        of_key, _ = self.contexts(description)
        contexts = [c for c in of_key if description.conditions <= c]
        return [q for c in contexts for q in self.asked[description.reader][description.name][c]]

    def test_type_unit_default_and_choices_are_those_of_the_code(self):
        for description in self.described:
            questions = [q for q in self.questions(description) if q["type"]]
            row = description.row
            with self.subTest(str(description)):
                types = {q["type"] for q in questions}
                said = {"text"} if row["type"] == "date" else {row["type"]}
                if row["type"] == "text or number":
                    said = {"text", "number"}
                if row["type"] == "text or list of texts":
                    said = {"text", "list of texts"}
                if row["type"] == "number or list of numbers":
                    types.discard("number")  # of each of them
                self.assertEqual(said, types)
                units = {q["unit"] for q in questions if q["unit"]} or {""}
                self.assertEqual({row["unit"]}, units)
                choices = [q["choices"] for q in questions if q["choices"]]
                if choices:
                    self.assertEqual(description.choices, choices[0])
                else:
                    self.assertEqual(description.choices, [])
                self.check_default(description, questions)

    def check_default(self, description, questions):
        of_code = {q["default"] for q in questions if q["default"]}
        said = re.fullmatch(r"`(.*)`", description.row["default"])
        if said:
            self.assertIn(said[1], of_code)
        elif not description.required and not description.depends and len(of_code) == 1:
            self.assertIn(of_code.pop(), ("0",), f"{description}: the default is not named")

    def uses(self, description):
        """(reader, tables, path) of every example that has the key's table."""
        for name, reader, tables in self.examples:
            if reader != description.reader:
                continue
            for path in real_name(tables, description.name):
                table = examples.first_table(lookup(tables, path[:-1]) if path[:-1] else tables)
                if table is not None and fits(table, description.conditions):
                    yield name, tables, path

    def uses_with_made_up_tables(self, description):
        yield from self.uses(description)
        table, _, key = description.name.rpartition(".")
        if key in TABLES.get(table, {}):
            for name, reader, tables in self.examples:
                path = description.name.split(".")
                if reader == description.reader and lookup(tables, path[:-1]) is None:
                    with_table = self.with_value(tables, path, TABLES[table][key])
                    if not self.problem(reader, with_table):
                        yield name, with_table, path

    def test_required_is_what_a_file_is_refused_without(self):
        removed = 0
        for description in self.described:
            seen = 0
            for name, tables, path in self.uses_with_made_up_tables(description):
                without = copy.deepcopy(tables)
                table = examples.first_table(lookup(without, path[:-1]) if path[:-1] else without)
                if path[-1] not in table or description.depends:
                    continue
                del table[path[-1]]
                refused = self.problem(description.reader, without)
                with self.subTest(f"{description}, {name}"):
                    self.assertEqual(bool(refused), description.required, refused)
                seen += 1
            removed += seen
            if description.required:
                self.assertGreater(seen, 0, f"{description} is required, but in no example")
        self.assertGreater(removed, 100)

    def with_value(self, tables, path, value):
        changed = copy.deepcopy(tables)
        table = changed
        if path[:-1]:
            of = lookup(changed, path[:-1])
            if of is None:
                outer = lookup(changed, path[:-2]) if path[:-2] else changed
                if outer is None:
                    outer = changed.setdefault(path[0], {})
                of = outer[path[-2]] = copy.deepcopy(TABLES[".".join(path[:-1])])
            table = examples.first_table(of)
        table[path[-1]] = value
        companions = FOUND if "kind" in table else COMPANIONS
        if path[-1] in companions and path[-2:-1] != ["air"]:
            table.setdefault(*companions[path[-1]])
        if path[-1] == "play" and table["driver"] == "can":
            table.setdefault(*COMPANIONS["play of can"])
        return changed

    def candidates(self, description):
        yield from ((tables, path) for _, tables, path in self.uses(description))
        if description.name.rpartition(".")[0] in TABLES:
            for _, reader, tables in self.examples:
                if reader == description.reader:
                    yield tables, description.name.split(".")

    def test_ranges(self):
        tried = 0
        for description in self.described:
            accepted, refused = bounds(description.row["range"])
            if description.choices and not accepted:
                refused = ["bogus"]
            if not accepted and not refused or description.row["type"].startswith("list"):
                continue
            if description.row["type"] == "whole number":
                accepted, refused = map(round, accepted), map(away_from_zero, refused)
                accepted, refused = [*accepted], [*refused]
            with self.subTest(str(description)):
                tables, path = self.fitting_example(description, accepted)
                for value in accepted:
                    self.assertEqual(self.problem_with(description, tables, path, value), "", value)
                for value in refused:
                    problem = self.problem_with(description, tables, path, value)
                    self.assertIn(path[-1], problem, value)
                tried += len(accepted) + len(refused)
        self.assertGreater(tried, 100)

    def problem_with(self, description, tables, path, value):
        return self.problem(description.reader, self.with_value(tables, path, value))

    def fitting_example(self, description, accepted):
        for tables, path in self.candidates(description):
            if not accepted or not self.problem_with(description, tables, path, accepted[-1]):
                return tables, path
        self.fail(f"{description}: no example takes {accepted[-1:]}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
