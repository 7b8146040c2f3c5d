#!/usr/bin/env python3
"""Writes the contract in Rust, from the IDL file: rust_types.py dyncal.idl dust|rustdds FILE

An enum is its number (i32 on the wire, and a value that is not known yet breaks nothing).
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


def main():
    source, crate, output = sys.argv[1:]
    text, enums = "", set()
    for statement in statements_of(pathlib.Path(source).read_text()):
        found = STATEMENT.fullmatch(statement)
        if found["constant"]:
            text += f"pub const {found['constant']}: u32 = {found['value']};\n"
        elif found["enum"]:
            enums.add(found["enum"])
            words = [word.strip() for word in found["words"].split(",")]
            text += "".join(f"pub const {word}: i32 = {i};\n" for i, word in enumerate(words))
        else:
            text += struct_of(found["struct"], found["members"], enums, crate)
    pathlib.Path(output).write_text(text)


if __name__ == "__main__":
    main()
