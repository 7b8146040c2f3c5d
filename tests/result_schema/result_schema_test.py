#!/usr/bin/env python3
"""The schema of result files itself: it is one, it describes what it demands, and the check refuses
what it should.

    result_schema_test.py SCHEMA EXAMPLE_WRITER

EXAMPLE_WRITER prints a whole result.
"""

import copy
import json
import pathlib
import subprocess
import sys
import unittest

from check_result import Draft202012Validator, deviations

SCHEMA = json.loads(pathlib.Path(sys.argv[1]).read_text())
EXAMPLE = subprocess.run([sys.argv[2]], check=True, capture_output=True, text=True).stdout


def changed(change):
    result = json.loads(EXAMPLE)
    change(result)
    return json.dumps(result)


class Schema(unittest.TestCase):
    def test_is_a_schema(self):
        Draft202012Validator.check_schema(SCHEMA)

    def test_takes_a_whole_result(self):
        self.assertEqual(list(deviations(SCHEMA, EXAMPLE)), [])
        result = json.loads(EXAMPLE)
        for key in ("points", "transfer_function", "group_delay", "sample_clock", "sources"):
            self.assertGreater(len(result[key]), 0, key)

    def test_refuses_a_key_that_is_missing(self):
        for place in ([], ["points", 0], ["transfer_function", 0], ["sources", 0], ["steps", 0]):
            result = json.loads(EXAMPLE)
            one = result
            for part in place:
                one = one[part]
            for key in list(one):
                without = copy.deepcopy(result)
                target = without
                for part in place:
                    target = target[part]
                del target[key]
                if key in OPTIONAL:
                    continue
                self.assertTrue(list(deviations(SCHEMA, json.dumps(without))), (place, key))

    def test_refuses_a_key_that_it_does_not_describe(self):
        def add(result):
            result["points"][0]["mangitude"] = 1.0

        self.assertIn("mangitude", deviations(SCHEMA, changed(add))[0])

    def test_refuses_what_is_no_number(self):
        def put_text(result):
            result["points"][0]["magnitude"] = "nan"

        self.assertIn("magnitude", deviations(SCHEMA, changed(put_text))[0])
        text = EXAMPLE.replace('"u_magnitude": null', '"u_magnitude": NaN', 1)
        self.assertNotEqual(text, EXAMPLE)
        self.assertIn("NaN is not JSON", deviations(SCHEMA, text)[0])

    def test_refuses_a_flag_that_is_not_explained(self):
        def forget(result):
            result["flag_legend"] = []

        self.assertIn("not explained", deviations(SCHEMA, changed(forget))[0])

    def test_refuses_a_value_without_its_uncertainty(self):
        def remove(result):
            del result["points"][0]["U_magnitude"]

        self.assertTrue(deviations(SCHEMA, changed(remove)))


# May be missing: not every run has them.
OPTIONAL = {
    "roles", "corrections", "recipe", "temperature_degc", "measured_frequency_hz",
    "u_measured_frequency_hz", "measured_level_m_s2", "u_measured_level_m_s2", "fit",
    "attempt", "pauses",
}  # fmt: skip

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
