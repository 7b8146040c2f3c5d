"""read_result gives what the file has, and refuses what the programs refuse, in their words:
result_test.py PROGRAMS FOLDER"""

import copy
import json
import math
import os
import pathlib
import random
import shutil
import subprocess
import sys
import unittest

import virtual_result

import dyncal

SEED = int(os.environ.get("DYNCAL_PYTHON_SEED", "1"))
CHANGES = int(os.environ.get("DYNCAL_PYTHON_CHANGES", "60"))


def run(*words):
    return subprocess.run(
        [str(PROGRAMS / words[0]), *words[1:]],
        cwd=FOLDER,
        capture_output=True,
        text=True,
        check=False,
    )


def places(value, path=()):
    """Every member and entry of a JSON value, by its path."""
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, member in items:
        yield (*path, key)
        if isinstance(member, (dict, list)):
            yield from places(member, (*path, key))


def changed(content, draw):
    """One member is another one, or gone."""
    content = copy.deepcopy(content)
    *path, last = draw.choice([one for one in places(content) if one[0] != "recipe"])
    holder = content
    for key in path:
        holder = holder[key]
    if isinstance(holder, dict) and draw.random() < 0.4:
        del holder[last]
    else:
        holder[last] = draw.choice([None, True, -1, 0.5, "text", [], {}, [1], 10**20, "a/b"])
    return content


class ResultFile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(FOLDER, ignore_errors=True)
        FOLDER.mkdir(parents=True)
        virtual_result.make(PROGRAMS, FOLDER, ["20", "40", "80"])
        cls.content = json.loads((FOLDER / "result.json").read_text())
        cls.result = dyncal.read_result(FOLDER)

    def assert_frame_has(self, frame, rows):
        self.assertEqual(len(frame), len(rows))
        compared = 0
        for (_, line), row in zip(frame.iterrows(), rows):
            for name, stated in row.items():
                found = line[name]
                if stated is None:
                    is_freedom = name.startswith("nu_eff") or name == "degrees_of_freedom"
                    self.assertTrue(math.isinf(found) if is_freedom else math.isnan(found), name)
                else:
                    self.assertEqual(found, stated, name)
                compared += 1
        self.assertGreater(compared, 10)

    def test_frames_have_every_number_of_the_file(self):
        self.assertEqual(len(self.content["transfer_function"]), 3)
        self.assert_frame_has(self.result.to_pandas(), self.content["transfer_function"])
        self.assert_frame_has(self.result.points(), self.content["points"])
        self.assert_frame_has(self.result.group_delays(), self.content["group_delay"])
        rows = [row for point in self.content["points"] for row in point["budget"]]
        self.assert_frame_has(self.result.budgets(), rows)

    def test_data_set_has_every_mean(self):
        data = self.result.to_xarray()
        for row in self.content["transfer_function"]:
            one = data.sel(channel=row["channel"], frequency_hz=row["frequency_hz"])
            for name in ("magnitude", "U_magnitude", "phase_rad", "U_phase_rad", "k_phase"):
                self.assertEqual(float(one[name]), row[name])
            self.assertAlmostEqual(abs(complex(one["h"])), row["magnitude"], places=14)
            self.assertEqual(str(one["unit"].values), row["unit"])

    def test_levels_of_one_frequency_are_no_data_set(self):
        content = copy.deepcopy(self.content)
        content["transfer_function"].append(copy.deepcopy(content["transfer_function"][0]))
        (FOLDER / "levels.json").write_text(json.dumps(content))
        result = dyncal.read_result(FOLDER / "levels.json")
        self.assertEqual(len(result.to_pandas()), 4)
        with self.assertRaises(dyncal.Error):
            result.to_xarray()

    def refusals(self, text, name):
        """What the programs say of a file, and what read_result says."""
        path = FOLDER / name
        path.write_text(text)
        by_program = run("dyncal", "means", name, "--output", "means.csv")
        try:
            dyncal.read_result(path)
            ours = None
        except dyncal.Error as error:
            self.assertEqual(error.code, "bad_file")
            ours = str(error).replace(str(path), name)
        return by_program, ours

    def test_refuses_what_the_programs_refuse_in_their_words(self):
        draw = random.Random(SEED)
        texts = ["", "{", "[]", "{}", '{"schema": 1}', '{"schema": {"name": "other"}}']
        for version in (0, 3, "2", None):
            texts.append(json.dumps({"schema": {"name": "dyncal-result", "version": version}}))
        texts += [json.dumps(changed(self.content, draw)) for _ in range(CHANGES)]
        refused = 0
        for number, text in enumerate(texts):
            with self.subTest(seed=SEED, number=number):
                by_program, ours = self.refusals(text, f"changed-{number}.json")
                if ours is None:
                    self.assertNotIn("result.schema", by_program.stderr)
                    self.assertNotRegex(by_program.stderr, r": \w.* (is missing|, not a )")
                else:
                    self.assertNotEqual(by_program.returncode, 0, ours)
                    self.assertIn(ours, by_program.stderr)
                    refused += 1
        self.assertGreater(refused, 20)

    def test_reads_version_1(self):
        content = copy.deepcopy(self.content)
        content["schema"]["version"] = 1
        content["flags"] = content.pop("flag_legend")
        for clock in content["sample_clock"]:
            clock["event_list"], clock["events"] = clock.pop("events"), clock.pop("event_count")
        named = {"fit_noise": "noise of", "reference": "reference transducer"}
        for point in content["points"]:
            for row in point["budget"]:
                row["kind"] = named.get(row["kind"], row["kind"])
        by_program, ours = self.refusals(json.dumps(content), "version-1.json")
        self.assertEqual((by_program.returncode == 0, ours), (ours is None, ours))
        if ours is None:
            again = dyncal.read_result(FOLDER / "version-1.json")
            self.assertIn("fit_noise", set(again.budgets()["kind"]))


if __name__ == "__main__":
    PROGRAMS, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1])
