#!/usr/bin/env python3
"""Writes the contract in Python, from the IDL file, when the wheel is made:

    write_contract.py dyncal.idl FOLDER

FOLDER/dds/types.py: the messages as dataclasses of the public `cyclonedds` package, whose own IDL
compiler cannot be relied on; types.pyi: the same for type checkers. FOLDER/members.py: the members
of every message with their IDL types, for readers that need no DDS. What of IDL the contract does
not use is refused, as idl/write_types.py does, whose grammar this is.
"""

import pathlib
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "idl"))
from write_types import MEMBER, STATEMENT, statements_of  # noqa: E402

NUMBERS = {
    "boolean": ("bool", "bool", "False"),
    "octet": ("types.uint8", "int", "0"),
    "long": ("types.int32", "int", "0"),
    "unsigned long": ("types.uint32", "int", "0"),
    "long long": ("types.int64", "int", "0"),
    "unsigned long long": ("types.uint64", "int", "0"),
    "double": ("types.float64", "float", "0.0"),
}
TYPES_HEADER = '''\
"""The messages of dyncal for the `cyclonedds` package, made from idl/dyncal.idl with the wheel.

idl/README.md explains every member with its unit and time base. Members have the default of their
type: 0, empty, the first word of an enum.
"""

import dataclasses

from cyclonedds import idl
from cyclonedds.idl import annotations, types

'''
STUB_HEADER = '''\
import dataclasses

from cyclonedds import idl

CONTRACT_VERSION: int

'''
MEMBERS_HEADER = '''\
"""Members and types of every message of dyncal, made from idl/dyncal.idl with the wheel."""

from __future__ import annotations

'''


class Contract:
    def __init__(self):
        self.types, self.stub, self.members = TYPES_HEADER, STUB_HEADER, MEMBERS_HEADER
        self.enums, self.structs = {}, {}

    def type_of(self, idl):
        """For the package, for type checkers, and the default."""
        if idl in NUMBERS:
            return NUMBERS[idl]
        if idl in self.enums:
            return idl, idl, f"{idl}.{self.enums[idl][0]}"
        if idl == "string":
            return "str", "str", '""'
        if bounded := re.fullmatch(r"string<(\d+)>", idl):
            return f"types.bounded_str[{bounded[1]}]", "str", '""'
        if sequence := re.fullmatch(r"sequence<(.+)>", idl):
            package, checked, _ = self.type_of(sequence[1])
            empty = "dataclasses.field(default_factory=list)"
            return f"types.sequence[{package}]", f"list[{checked}]", empty
        if idl in self.structs:
            return idl, idl, f"dataclasses.field(default_factory={idl})"
        raise SystemExit(f"write_contract.py: the contract has no type '{idl}'")

    def add_enum(self, name, words):
        self.enums[name] = [word.strip() for word in words.split(",")]
        values = "".join(f"    {word} = {i}\n" for i, word in enumerate(self.enums[name]))
        self.types += f'\n\nclass {name}(idl.IdlEnum, typename="dyncal::wire::{name}"):\n{values}'
        self.stub += f"class {name}(idl.IdlEnum):\n{values}\n"

    def add_struct(self, name, members):
        lines, stub, listed = "", "", []
        for member in filter(None, (part.strip() for part in members.split(";"))):
            found = MEMBER.fullmatch(member)
            if not found:
                raise SystemExit(f"write_contract.py: '{member}' of {name} is not understood")
            package, checked, default = self.type_of(found["type"])
            lines += f"    {found['name']}: {package} = {default}\n"
            stub += f"    {found['name']}: {checked} = ...\n"
            if member.startswith("@key "):
                lines += f'    annotations.key("{found["name"]}")\n'
            listed.append((found["name"], found["type"]))
        self.structs[name] = tuple(listed)
        self.types += (
            "\n\n@dataclasses.dataclass\n@annotations.final\n"
            f'class {name}(idl.IdlStruct, typename="dyncal::wire::{name}"):\n{lines}'
        )
        self.stub += f"@dataclasses.dataclass\nclass {name}(idl.IdlStruct):\n{stub}\n"

    def add(self, statement):
        found = STATEMENT.fullmatch(statement)
        if not found:
            raise SystemExit(f"write_contract.py: '{statement}' is not understood")
        if found["constant"]:
            self.types += f"{found['constant']} = {found['value']}\n"
        elif found["enum"]:
            self.add_enum(found["enum"], found["words"])
        else:
            self.add_struct(found["struct"], found["members"])

    def finish(self):
        self.members += "ENUMS: dict[str, tuple[str, ...]] = {\n"
        for name, words in self.enums.items():
            self.members += f"    {name!r}: {tuple(words)!r},\n"
        self.members += "}\nSTRUCTS: dict[str, tuple[tuple[str, str], ...]] = {\n"
        for name, members in self.structs.items():
            rows = "".join(f"        {member!r},\n" for member in members)
            self.members += f"    {name!r}: (\n{rows}    ),\n"
        self.members += "}\n"


def main():
    source, folder = map(pathlib.Path, sys.argv[1:])
    contract = Contract()
    for statement in statements_of(source.read_text()):
        contract.add(statement)
    contract.finish()
    (folder / "dds").mkdir(parents=True, exist_ok=True)
    (folder / "dds/types.py").write_text(contract.types)
    (folder / "dds/types.pyi").write_text(contract.stub)
    (folder / "members.py").write_text(contract.members)


if __name__ == "__main__":
    main()
