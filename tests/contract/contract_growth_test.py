"""Today's contract against the last release, and the check itself against drawn changes."""

import copy
import pathlib
import random
import re
import sys
import unittest

from contract_growth import broken_rules, violations
from idl_contract import Contract, IdlError, Member, Struct, parse

IDL = pathlib.Path(sys.argv.pop() if len(sys.argv) > 1 else "idl").resolve()
DRAWS = 60


def last_release():
    releases = {
        int(re.fullmatch(r"dyncal-(\d+)", path.stem)[1]): path
        for path in (IDL / "released").glob("dyncal-*.idl")
    }
    return max(releases), releases[max(releases)]


def read(path):
    return parse(path.read_text("utf-8"))


class TodaysContract(unittest.TestCase):
    def test_only_grew_since_the_last_release(self):
        number, path = last_release()
        released = read(path)
        self.assertEqual(released.constants["CONTRACT_VERSION"], ("uint32", number))
        self.assertEqual(violations(released, read(IDL / "dyncal.idl")), [])

    def test_keeps_its_own_rules(self):
        today = read(IDL / "dyncal.idl")
        self.assertGreater(len(today.structs), 20)
        self.assertGreater(len(today.enums), 10)
        self.assertEqual(broken_rules(today), [])

    def test_a_name_means_text_or_a_number_but_not_both(self):
        kinds = {}
        contract = read(IDL / "dyncal.idl")
        for struct in contract.structs.values():
            for member in struct.members:
                is_text = member.type.startswith("string")
                is_either = member.type not in contract.structs
                if is_either and member.name != "kind":  # each struct has its own kinds
                    kinds.setdefault(member.name, {}).setdefault(is_text, []).append(struct.name)
        self.assertIn("frequency_hz", kinds)
        self.assertEqual({name: by for name, by in kinds.items() if len(by) > 1}, {})


def renamed(member, **changes):
    return Member(**{**vars(member), **changes})


class DrawnChanges(unittest.TestCase):
    """Each test draws a struct or enum of the release, changes it, and looks at the verdict."""

    def setUp(self):
        self.released = read(last_release()[1])
        self.random = random.Random(20261122)

    def draw(self, wanted=lambda struct: True):
        today = copy.deepcopy(self.released)
        names = [name for name, struct in today.structs.items() if wanted(struct)]
        struct = today.structs[self.random.choice(names)]
        return today, struct, self.random.randrange(len(struct.members))

    def grown(self, today):
        version = today.constants["CONTRACT_VERSION"]
        today.constants["CONTRACT_VERSION"] = (version[0], version[1] + 1)
        return today

    def expect_refused(self, today, *words):
        found = violations(self.released, self.grown(today))
        self.assertTrue(found)
        for word in words:
            self.assertTrue(
                any(re.search(rf"\b{re.escape(word)}\b", line) for line in found), (word, found)
            )

    def test_a_removed_member_is_refused(self):
        for _ in range(DRAWS):
            today, struct, place = self.draw()
            member = struct.members.pop(place)
            self.expect_refused(today, struct.name, member.name, "removed")

    def test_a_renamed_member_is_refused(self):
        for _ in range(DRAWS):
            today, struct, place = self.draw()
            member = struct.members[place]
            struct.members[place] = renamed(member, name=member.name + "_x")
            self.expect_refused(today, struct.name, member.name, "renamed")

    def test_members_in_another_order_are_refused(self):
        for _ in range(DRAWS):
            today, struct, place = self.draw(lambda one: len(one.members) > 1)
            other = (place + 1) % len(struct.members)
            members = struct.members
            members[place], members[other] = members[other], members[place]
            self.expect_refused(today, struct.name, members[place].name, "moved")

    def test_a_member_of_another_type_is_refused(self):
        types = ["double", "uint32", "uint64", "int64", "boolean", "string", "sequence<double>"]
        for _ in range(DRAWS):
            today, struct, place = self.draw()
            member = struct.members[place]
            other = self.random.choice([one for one in types if one != member.type])
            struct.members[place] = renamed(member, type=other)
            self.expect_refused(today, struct.name, member.name, "type")

    def test_another_bound_of_a_key_is_refused(self):
        for _ in range(DRAWS):
            today, struct, _ = self.draw(lambda one: one.is_topic)
            place = self.random.choice(
                [i for i, one in enumerate(struct.members) if one.type.startswith("string<")]
            )
            member = struct.members[place]
            struct.members[place] = renamed(member, type="string<65>")
            self.expect_refused(today, struct.name, member.name, "65")

    def test_a_key_more_or_less_is_refused(self):
        for _ in range(DRAWS):
            today, struct, place = self.draw()
            member = struct.members[place]
            struct.members[place] = renamed(member, is_key=not member.is_key)
            self.expect_refused(today, struct.name, member.name, "key")

    def test_a_struct_that_is_no_longer_final_is_refused(self):
        for _ in range(DRAWS):
            today, struct, _ = self.draw()
            struct.is_final = False
            self.expect_refused(today, struct.name, "@final".strip("@"))
            self.assertIn(f"struct {struct.name} is not @final", broken_rules(today))

    def test_a_member_appended_to_a_nested_struct_is_refused(self):
        for _ in range(DRAWS):
            today, struct, _ = self.draw(lambda one: not one.is_topic)
            struct.members.append(Member("later", "double", False))
            self.expect_refused(today, struct.name, "later")

    def test_a_member_inserted_before_the_end_is_refused(self):
        for _ in range(DRAWS):
            today, struct, place = self.draw(lambda one: one.is_topic)
            struct.members.insert(place, Member("later", "double", False))
            self.expect_refused(today, struct.name, "later")

    def test_an_appended_key_is_refused(self):
        for _ in range(DRAWS):
            today, struct, _ = self.draw(lambda one: one.is_topic)
            struct.members.append(Member("later", "uint32", True))
            self.expect_refused(today, struct.name, "later", "key")

    def test_a_removed_struct_is_refused(self):
        for _ in range(DRAWS):
            today, struct, _ = self.draw()
            del today.structs[struct.name]
            self.expect_refused(today, struct.name)

    def test_changed_enum_values_are_refused(self):
        for _ in range(DRAWS):
            today = copy.deepcopy(self.released)
            name = self.random.choice([one for one in today.enums if len(today.enums[one]) > 1])
            values = today.enums[name]
            place = self.random.randrange(len(values))
            value = values[place]
            change = self.random.choice(["removed", "renamed", "moved", "inserted"])
            if change == "removed":
                values.pop(place)
            elif change == "renamed":
                values[place] += "_X"
            elif change == "moved":
                values.insert((place + 1) % len(values), values.pop(place))
            else:
                values.insert(place, "INSERTED")
            self.expect_refused(today, name, value)

    def test_appended_members_and_values_and_new_types_are_allowed(self):
        for _ in range(DRAWS):
            today, struct, _ = self.draw(lambda one: one.is_topic)
            for i in range(self.random.randint(1, 3)):
                struct.members.append(Member(f"later_{i}", "Later", False))
            today.structs["Later"] = Struct("Later", True, [Member("x", "double", False)])
            today.enums[self.random.choice(list(today.enums))].append("LATER")
            today.enums["LaterKind"] = ["LATER_KIND"]
            self.assertEqual(violations(self.released, self.grown(today)), [])
            self.assertEqual(broken_rules(today), [])

    def test_growth_demands_the_next_version(self):
        today, struct, _ = self.draw(lambda one: one.is_topic)
        struct.members.append(Member("later", "double", False))
        found = violations(self.released, today)
        self.assertEqual(len(found), 1)
        self.assertRegex(found[0], "CONTRACT_VERSION must be")
        unchanged = self.grown(copy.deepcopy(self.released))
        self.assertRegex(violations(self.released, unchanged)[0], "CONTRACT_VERSION must be")


class Reading(unittest.TestCase):
    def test_reads_keys_bounds_and_nested_types(self):
        contract = parse(
            "module a { enum E { X, Y }; @final struct N { E e; };\n"
            "@final struct T { @key string<64> bench; sequence<N> n; unsigned long long u; }; };"
        )
        self.assertEqual(contract.enums, {"E": ["X", "Y"]})
        self.assertEqual(
            [vars(member) for member in contract.structs["T"].members],
            [
                {"name": "bench", "type": "string<64>", "is_key": True},
                {"name": "n", "type": "sequence<N>", "is_key": False},
                {"name": "u", "type": "uint64", "is_key": False},
            ],
        )
        self.assertEqual(contract.nested_structs(), {"N"})
        self.assertEqual(broken_rules(contract), [])

    def test_refuses_what_it_does_not_know(self):
        for text, line in [
            ("struct A { float x; };", 1),
            ("struct A {\n double x[3]; };", 2),
            ("struct A { @optional double x; };", 1),
            ("struct A { double x; };\nunion B { double y; };", 2),
            ("struct A { double x; double x; };", 1),
            ("enum A { B = 3 };", 1),
            ("struct A { double x; }", 1),
        ]:
            with self.assertRaisesRegex(IdlError, f"line {line}"):
                parse(text)
        with self.assertRaises(IdlError):
            parse("module a { };")

    def test_finds_broken_rules(self):
        key = Member("bench", "string<64>", True)
        for members, words in [
            ([Member("x", "double", False), key], "keys do not come first"),
            ([Member("name", "string<64>", True)], "first key"),
            ([key, Member("run", "string", True)], "key run is not bounded"),
            ([key, Member("at", "double", True)], "key at is of type double"),
        ]:
            found = broken_rules(Contract({"T": Struct("T", True, members)}, {}, {}))
            self.assertTrue(any(words in sentence for sentence in found), (words, found))


if __name__ == "__main__":
    unittest.main()
