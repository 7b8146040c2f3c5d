"""The names of metrics in the code, on the page about them, in the dashboard and in the alarms."""

import json
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop() if len(sys.argv) > 1 else ".").resolve()
MONITORING = ROOT / "deploy/monitoring"
NAME = r"\bdyncal_[a-z_]+"


class Monitoring(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        code = (ROOT / "services/daemon/supervision/daemon_metrics.cpp").read_text("utf-8")
        cls.in_code = set(re.findall(r'"(dyncal_[a-z_]+)"', code))
        cls.dashboard = json.loads((MONITORING / "grafana-dashboard.json").read_text("utf-8"))

    def test_the_page_names_each_and_none_besides(self):
        self.assertGreater(len(self.in_code), 10)
        page = (MONITORING / "README.md").read_text("utf-8")
        self.assertEqual(set(re.findall(r"^\| `(dyncal_\w+)`", page, re.M)), self.in_code)

    def test_the_dashboard_shows_what_there_is(self):
        shown = [
            target["expr"] for panel in self.dashboard["panels"] for target in panel["targets"]
        ]
        self.assertGreater(len(shown), 10)
        for expression in shown:
            self.assertLessEqual(set(re.findall(NAME, expression)), self.in_code)

    def test_panels_of_the_dashboard_do_not_overlap(self):
        places = set()
        for panel in self.dashboard["panels"]:
            at = panel["gridPos"]
            for x in range(at["x"], at["x"] + at["w"]):
                for y in range(at["y"], at["y"] + at["h"]):
                    self.assertLess(x, 24)
                    self.assertNotIn((x, y), places, panel["title"])
                    places.add((x, y))

    def test_alarms_watch_what_there_is(self):
        alarms = (MONITORING / "dyncal-alarms.yml").read_text("utf-8")
        names = set(re.findall(NAME, alarms))
        self.assertGreater(len(names), 3)
        self.assertLessEqual(names, self.in_code)

    def test_the_example_has_addresses_of_documentation(self):
        text = (MONITORING / "prometheus.yml").read_text("utf-8")
        addresses = re.findall(r"\d+\.\d+\.\d+\.\d+", text)
        self.assertGreater(len(addresses), 2)
        self.assertTrue(all(one.startswith("192.0.2.") for one in addresses), addresses)


if __name__ == "__main__":
    unittest.main()
