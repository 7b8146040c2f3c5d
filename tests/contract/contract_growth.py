"""What a contract changed that it must not: everything but growth at the end.

Allowed since a release: members appended to a topic's own struct (one with keys that no other
struct holds), values appended to an enum, new types. Each violation is one sentence that names
struct and member, or enum and value.
"""

import pathlib
import sys

from idl_contract import parse


def violations(released, today):
    found = []
    for name, values in released.enums.items():
        found += _enum_violations(name, values, today)
    nested = released.nested_structs() | today.nested_structs()
    for name, struct in released.structs.items():
        found += _struct_violations(struct, today, name not in nested)
    return found + _version_violations(released, today)


def _version_violations(released, today):
    type_name, before = released.constants["CONTRACT_VERSION"]
    if "CONTRACT_VERSION" not in today.constants:
        return ["constant CONTRACT_VERSION was removed"]
    grew = (released.structs, released.enums) != (today.structs, today.enums)
    demanded = (type_name, before + 1 if grew else before)
    if today.constants["CONTRACT_VERSION"] != demanded:
        return [f"constant CONTRACT_VERSION must be {demanded[1]}, of type {type_name}"]
    return []


def _enum_violations(name, values, today):
    if name not in today.enums:
        return [f"enum {name} was removed"]
    found = []
    now = today.enums[name]
    for place, value in enumerate(values):
        if value not in now:
            found.append(f"enum {name}: value {value} was removed or renamed")
        elif now.index(value) != place:
            found.append(f"enum {name}: value {value} moved from {place} to {now.index(value)}")
    return found


def _struct_violations(struct, today, may_grow):
    name = struct.name
    if name not in today.structs:
        return [f"struct {name} was removed"]
    now = today.structs[name]
    found = []
    if struct.is_final != now.is_final:
        found.append(f"struct {name}: @final was {'removed' if struct.is_final else 'added'}")
    names = [member.name for member in now.members]
    for place, member in enumerate(struct.members):
        if member.name not in names:
            found.append(f"struct {name}: member {member.name} was removed or renamed")
            continue
        if names.index(member.name) != place:
            found.append(
                f"struct {name}: member {member.name} moved from place {place} to "
                f"{names.index(member.name)}"
            )
        other = now.members[names.index(member.name)]
        if other.type != member.type:
            found.append(
                f"struct {name}: member {member.name} changed its type from {member.type} to "
                f"{other.type}"
            )
        if other.is_key != member.is_key:
            found.append(
                f"struct {name}: member {member.name} "
                f"{'became' if other.is_key else 'is no longer'} a key"
            )
    return found + _appended_violations(struct, now, may_grow)


def _appended_violations(struct, now, may_grow):
    known = {member.name for member in struct.members}
    found = []
    for member in now.members:
        if member.name in known:
            continue
        if not struct.is_topic or not may_grow:
            found.append(
                f"struct {struct.name}: member {member.name} was added to a struct that is part "
                "of others; make a new type"
            )
        elif member.is_key:
            found.append(f"struct {struct.name}: new member {member.name} is a key")
        elif now.members.index(member) < len(struct.members):
            found.append(f"struct {struct.name}: new member {member.name} is not at the end")
    return found


def broken_rules(contract):
    """Rules that every version keeps by itself."""
    found = []
    for struct in contract.structs.values():
        if not struct.is_final:
            found.append(f"struct {struct.name} is not @final")
        keys = [member for member in struct.members if member.is_key]
        if keys != struct.members[: len(keys)]:
            found.append(f"struct {struct.name}: the keys do not come first")
        if keys and (keys[0].name, keys[0].type) != ("bench", "string<64>"):
            found.append(f"struct {struct.name}: the first key is not string<64> bench")
        for member in keys:
            if member.type == "string":
                found.append(f"struct {struct.name}: key {member.name} is not bounded")
            elif member.type != "uint32" and not member.type.startswith("string<"):
                found.append(f"struct {struct.name}: key {member.name} is of type {member.type}")
        if keys and struct.name in contract.nested_structs():
            found.append(f"struct {struct.name} has keys and is part of another struct")
    return found


def main(arguments):
    released, today = (parse(pathlib.Path(path).read_text("utf-8")) for path in arguments)
    found = broken_rules(today) + violations(released, today)
    for sentence in found:
        print(sentence)
    if not found:
        print(f"{len(released.structs)} structs and {len(released.enums)} enums only grew")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
