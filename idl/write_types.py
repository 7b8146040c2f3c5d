#!/usr/bin/env python3
"""Writes the contract in C++, from the IDL file: types that name no DDS library.

  write_types.py dyncal.idl dyncal.h

Each struct becomes a class with a reading and a writing function for every member, and
visit_members(), by which it is encoded and read. What the contract does not use of IDL is refused.
"""
import re
import sys
from pathlib import Path

NUMBERS = {
    "boolean": "bool",
    "octet": "std::uint8_t",
    "long": "std::int32_t",
    "unsigned long": "std::uint32_t",
    "long long": "std::int64_t",
    "unsigned long long": "std::uint64_t",
    "double": "double",
}
STATEMENT = re.compile(
    r"const unsigned long (?P<constant>\w+) = (?P<value>\d+)"
    r"|enum (?P<enum>\w+) \{(?P<words>[^{}]*)\}"
    r"|@final struct (?P<struct>\w+) \{(?P<members>[^{}]*)\}"
)
MODULES = re.compile(r"\s*module dyncal \{\s*module wire \{(.*)\};\s*\};\s*", re.DOTALL)
MEMBER = re.compile(r"(?:@key )?(?P<type>[\w ]+|string<\d+>|sequence<[^>]+>) (?P<name>\w+)")
HEADER = """\
// The contract in C++, made from dyncal.idl when dyncal was built.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "idl/bounded_string.hpp"

namespace dyncal::wire {

"""


class Contract:
    def __init__(self):
        self.enums = {}  # their first words
        self.structs = []
        self.text = HEADER

    def type_of(self, idl):
        """Its C++ type, and the value that a new member has ("" where the type sees to it)."""
        if idl in NUMBERS:
            return NUMBERS[idl], "false" if idl == "boolean" else "0"
        if idl in self.enums:
            return idl, self.enums[idl]
        if idl == "string":
            return "std::string", ""
        if bounded := re.fullmatch(r"string<(\d+)>", idl):
            return f"BoundedString<{bounded[1]}>", ""
        if sequence := re.fullmatch(r"sequence<(.+)>", idl):
            return f"std::vector<{self.type_of(sequence[1])[0]}>", ""
        if idl in self.structs:
            return idl, ""
        raise SystemExit(f"write_types.py: the contract has no type '{idl}'")

    def add_enum(self, name, words):
        words = [word.strip() for word in words.split(",")]
        self.enums[name] = words[0]
        listed = "".join(f"  {word},\n" for word in words)
        self.text += f"enum {name} : std::uint32_t {{\n{listed}}};\n\n"

    def add_struct(self, name, members):
        functions, visits, data = "", "", ""
        for member in filter(None, (part.strip() for part in members.split(";"))):
            found = MEMBER.fullmatch(member)
            if not found:
                raise SystemExit(f"write_types.py: '{member}' of {name} is not understood")
            cpp, initial = self.type_of(found["type"])
            word = found["name"]
            if initial:
                functions += f"  {cpp} {word}() const {{ return m_{word}; }}\n"
                functions += f"  void {word}({cpp} value) {{ m_{word} = value; }}\n"
            else:
                functions += f"  const {cpp}& {word}() const {{ return m_{word}; }}\n"
                functions += f"  void {word}(const {cpp}& value) {{ m_{word} = value; }}\n"
                functions += f"  void {word}({cpp}&& value) {{ m_{word} = std::move(value); }}\n"
            functions += f"  {cpp}& {word}() {{ return m_{word}; }}\n"
            visits += f"    visit(message.m_{word});\n"
            data += f"  {cpp} m_{word}{' = ' + initial if initial else ''};\n"
        self.structs.append(name)
        self.text += (
            f"class {name} {{\npublic:\n{functions}\n"
            f"  bool operator==(const {name}& other) const = default;\n\n"
            "  // Calls visit(member) in the order of the wire, with their types.\n"
            "  template <class Message, class Visit>\n"
            "  static void visit_members(Message& message, Visit&& visit) {\n"
            f"{visits}  }}\n\nprivate:\n{data}}};\n\n"
        )

    def add(self, statement):
        found = STATEMENT.fullmatch(statement)
        if not found:
            raise SystemExit(f"write_types.py: '{statement}' is not understood")
        if found["constant"]:
            self.text += (
                f"inline constexpr std::uint32_t {found['constant']} = {found['value']};\n\n"
            )
        elif found["enum"]:
            self.add_enum(found["enum"], found["words"])
        else:
            self.add_struct(found["struct"], found["members"])


def statements_of(idl):
    """Without comments, and with one space between words."""
    module = MODULES.fullmatch(re.sub(r"//[^\n]*", "", idl))
    if not module:
        raise SystemExit("write_types.py: the contract is not one module dyncal::wire")
    text = " ".join(module[1].split())
    return [found.strip() for found in re.findall(r"((?:[^;{]|\{[^}]*\})+);", text)]


def main():
    source, target = map(Path, sys.argv[1:])
    contract = Contract()
    for statement in statements_of(source.read_text()):
        contract.add(statement)
    target.write_text(contract.text + "} // namespace dyncal::wire\n")


if __name__ == "__main__":
    main()
