"""idl/README.md against the IDL and the topics in the code: each name there, and none besides."""

import pathlib
import re
import sys
import unittest

from idl_contract import parse

ROOT = pathlib.Path(sys.argv.pop() if len(sys.argv) > 1 else ".").resolve()
MAX_COLUMNS = 100


class ContractPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.contract = parse((ROOT / "idl/dyncal.idl").read_text("utf-8"))
        cls.page = (ROOT / "idl/README.md").read_text("utf-8")
        pieces = re.split(r"^#{2,3} (.*)$", cls.page, flags=re.MULTILINE)
        cls.sections = dict(zip(pieces[1::2], pieces[2::2]))

    def definitions(self, section):
        """(name, what is in the parentheses after it) of the list items that define something."""
        items = re.sub(r"\n {2,}", " ", self.sections[section])
        return re.findall(r"^- `(\w+)` \((.*?)\): \S", items, flags=re.MULTILINE)

    def test_has_a_section_for_every_struct_and_enum_and_each_only_once(self):
        headings = re.findall(r"^#{2,3} (.*)$", self.page, flags=re.MULTILINE)
        self.assertEqual(len(headings), len(set(headings)))
        names = set(self.contract.structs) | set(self.contract.enums)
        self.assertGreater(len(names), 30)
        self.assertEqual(
            {one for one in headings if re.fullmatch(r"[A-Z][a-z]+(?:[A-Z]\w+)+", one)} - names,
            set(),
        )
        self.assertEqual(names - set(headings), set())

    def test_names_every_member_in_order_with_its_type_and_key(self):
        for struct in self.contract.structs.values():
            with self.subTest(struct.name):
                told = [
                    (name, what.split(", ")[0], what.endswith(", key"))
                    for name, what in self.definitions(struct.name)
                ]
                self.assertEqual(
                    told, [(one.name, one.type, one.is_key) for one in struct.members]
                )

    def test_names_every_enum_value_with_its_number(self):
        for name, values in self.contract.enums.items():
            with self.subTest(name):
                self.assertEqual(
                    self.definitions(name),
                    [(value, str(number)) for number, value in enumerate(values)],
                )

    def test_units_agree_with_the_endings_of_names(self):
        endings = {"_ns": "ns", "_s": "s", "_hz": "Hz", "_rad": "rad", "_degc": "degC"}
        seen = 0
        for struct in self.contract.structs:
            for name, what in self.definitions(struct):
                unit = [one for one in what.split(", ")[1:] if one != "key"]
                for ending, wanted in endings.items():
                    if re.search(rf"(?<!rad)(?<!s_per){ending}$", name):
                        seen += 1
                        self.assertEqual(unit, [wanted], f"{struct}.{name}")
        self.assertGreater(seen, 50)

    def test_the_table_of_topics_is_that_of_the_code(self):
        code = (ROOT / "services/contract/topics.hpp").read_text("utf-8")
        in_code = {
            (topic, type_name, profile)
            for type_name, topic, profile in re.findall(
                r"Topic<wire::(\w+)>\s+\w+\{\s*\"(\w+)\",\s*Profile::(\w+)\}", code
            )
        }
        self.assertGreater(len(in_code), 10)
        self.assertEqual(len(in_code), code.count("constexpr Topic<"))
        on_page = set(
            re.findall(r"^\| `(\w+)` \| `(\w+)` \| (\w+) \|$", self.sections["In short"], re.M)
        )
        self.assertEqual(on_page, in_code)
        self.assertEqual(
            {type_name for _, type_name, _ in in_code},
            {name for name, one in self.contract.structs.items() if one.is_topic},
        )

    def test_is_readable_at_100_columns(self):
        for number, line in enumerate(self.page.splitlines(), 1):
            if not line.startswith("|"):  # a row of a table is one line
                self.assertLessEqual(len(line), MAX_COLUMNS, f"line {number}")


if __name__ == "__main__":
    unittest.main()
