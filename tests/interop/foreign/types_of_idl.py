#!/usr/bin/env python3
"""Writes the contract from the IDL file: types_of_idl.py dyncal.idl dust|rustdds|table FILE

In Rust, for either crate; or as a table for programs that make types while they run: a line
"struct NAME", then a line for each member: its name, its type and, of a key, "key". An enum is its
number (32 bits on the wire, and a value that is not known yet breaks nothing).
"""

import pathlib
import re
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "idl"))
from write_types import MEMBER, STATEMENT, statements_of  # noqa: E402

NUMBERS = {
    "boolean": "bool",
    "octet": "u8",
    "long": "i32",
    "unsigned long": "u32",
    "long long": "i64",
    "unsigned long long": "u64",
    "double": "f64",
}
DERIVED = {
    "dust": "DdsType, Clone, Debug, Default",
    "rustdds": "Serialize, Deserialize, Clone, Debug, Default",
}
DERIVED_OF_KEY = (
    "Serialize, Deserialize, CdrEncodingSize, PartialEq, Eq, PartialOrd, Ord, Hash, Clone, Debug"
)


def type_of(idl, enums):
    if sequence := re.fullmatch(r"sequence<(.+)>", idl):
        return f"Vec<{type_of(sequence[1], enums)}>"
    if idl.startswith("string"):
        return "String"
    return "i32" if idl in enums else NUMBERS.get(idl, idl)


def struct_of(name, members, enums, crate):
    lines, keys = "", []
    for member in filter(None, (part.strip() for part in members.split(";"))):
        found = MEMBER.fullmatch(member)
        rust = type_of(found["type"], enums)
        if member.startswith("@key "):
            keys.append((found["name"], rust))
            lines += "    #[dust_dds(key)]\n" if crate == "dust" else ""
        lines += f"    pub {found['name']}: {rust},\n"
    text = f"#[derive({DERIVED[crate]})]\npub struct {name} {{\n{lines}}}\n"
    if keys and crate == "rustdds":
        of_key = "".join(f"    pub {key}: {rust},\n" for key, rust in keys)
        copied = "".join(f"            {key}: self.{key}.clone(),\n" for key, _ in keys)
        text += f"#[derive({DERIVED_OF_KEY})]\npub struct {name}Key {{\n{of_key}}}\n"
        text += f"impl Key for {name}Key {{}}\nimpl Keyed for {name} {{\n    type K = {name}Key;\n"
        text += f"    fn key(&self) -> Self::K {{\n        {name}Key {{\n{copied}        }}\n"
        text += "    }\n}\n"
    return text


def rows_of(name, members, enums):
    text = f"struct {name}\n"
    for member in filter(None, (part.strip() for part in members.split(";"))):
        found = MEMBER.fullmatch(member)
        idl = "long" if found["type"] in enums else found["type"]
        key = " key" if member.startswith("@key ") else ""
        text += f"{found['name']} {idl.replace(' ', '_')}{key}\n"
    return text


def main():
    source, crate, output = sys.argv[1:]
    text, enums = "", set()
    for statement in statements_of(pathlib.Path(source).read_text()):
        found = STATEMENT.fullmatch(statement)
        if found["constant"]:
            constant = f"pub const {found['constant']}: u32 = {found['value']};\n"
            text += "" if crate == "table" else constant
        elif found["enum"]:
            enums.add(found["enum"])
            words = [word.strip() for word in found["words"].split(",")]
            numbers = "".join(f"pub const {word}: i32 = {i};\n" for i, word in enumerate(words))
            text += "" if crate == "table" else numbers
        elif crate == "table":
            text += rows_of(found["struct"], found["members"], enums)
        else:
            text += struct_of(found["struct"], found["members"], enums, crate)
    pathlib.Path(output).write_text(text)


if __name__ == "__main__":
    main()
