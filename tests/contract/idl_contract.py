"""Reads the IDL of the contract: the part of OMG IDL 4.2 that idl/dyncal.idl uses, nothing more.

A construct that is not known here is refused with its line, so that nothing passes unread.
"""

import re
from dataclasses import dataclass, field

NUMBERS = {
    "double": "double",
    "octet": "octet",
    "boolean": "boolean",
    "long long": "int64",
    "unsigned long": "uint32",
    "unsigned long long": "uint64",
}


class IdlError(Exception):
    """What cannot be read, and on which line."""


@dataclass(frozen=True)
class Member:
    name: str
    type: str  # "string<64>", "uint32", "sequence<double>", or the name of a struct or enum
    is_key: bool


@dataclass
class Struct:
    name: str
    is_final: bool
    members: list = field(default_factory=list)

    @property
    def is_topic(self):
        return any(member.is_key for member in self.members)


@dataclass
class Contract:
    structs: dict = field(default_factory=dict)
    enums: dict = field(default_factory=dict)  # name -> values in order
    constants: dict = field(default_factory=dict)  # name -> (type, value)

    def nested_structs(self):
        """Names of the structs that are part of another one."""
        used = set()
        for struct in self.structs.values():
            for member in struct.members:
                used.add(element_type(member.type))
        return used & set(self.structs)


def element_type(type_name):
    inner = re.fullmatch(r"sequence<(.*)>", type_name)
    return inner[1] if inner else type_name


class _Tokens:
    def __init__(self, text):
        self._tokens = []
        for number, line in enumerate(text.splitlines(), 1):
            line = line.split("//")[0]
            place = 0
            while place < len(line):
                if line[place].isspace():
                    place += 1
                    continue
                found = re.compile(r"@?[A-Za-z_]\w*|\d+|[{}<>;,=]").match(line, place)
                if not found:
                    raise IdlError(f"line {number}: cannot read '{line[place:].strip()}'")
                self._tokens.append((found[0], number))
                place = found.end()
        self._next = 0

    def peek(self):
        return self._tokens[self._next][0] if self._next < len(self._tokens) else ""

    def line(self):
        last = len(self._tokens) - 1
        return self._tokens[min(self._next, last)][1] if self._tokens else 0

    def take(self):
        token = self.peek()
        self._next += 1
        return token

    def accept(self, token):
        if self.peek() == token:
            self._next += 1
            return True
        return False

    def expect(self, token):
        if not self.accept(token):
            raise IdlError(f"line {self.line()}: expected '{token}', found '{self.peek()}'")

    def name(self):
        if not re.fullmatch(r"[A-Za-z_]\w*", self.peek()):
            raise IdlError(f"line {self.line()}: expected a name, found '{self.peek()}'")
        return self.take()


def parse(text):
    tokens = _Tokens(text)
    contract = Contract()
    modules = 0
    while tokens.accept("module"):
        tokens.name()
        tokens.expect("{")
        modules += 1
    while tokens.peek() and tokens.peek() != "}":
        _definition(tokens, contract)
    for _ in range(modules):
        tokens.expect("}")
        tokens.expect(";")
    if tokens.peek():
        raise IdlError(f"line {tokens.line()}: '{tokens.peek()}' after the end of the module")
    if not contract.structs:
        raise IdlError("there is no struct in this file")
    return contract


def _definition(tokens, contract):
    line = tokens.line()
    if tokens.accept("enum"):
        name, values = _enum(tokens)
        place = contract.enums
    elif tokens.accept("const"):
        type_name = _type(tokens, contract)
        name = tokens.name()
        tokens.expect("=")
        values = (type_name, int(tokens.take()))
        place = contract.constants
    else:
        is_final = tokens.accept("@final")
        tokens.expect("struct")
        name = tokens.name()
        values = Struct(name, is_final, _members(tokens, contract))
        place = contract.structs
    tokens.expect(";")
    if name in contract.structs or name in contract.enums or name in contract.constants:
        raise IdlError(f"line {line}: '{name}' is defined twice")
    place[name] = values


def _enum(tokens):
    name = tokens.name()
    tokens.expect("{")
    values = [tokens.name()]
    while tokens.accept(","):
        values.append(tokens.name())
    tokens.expect("}")
    return name, values


def _members(tokens, contract):
    members = []
    tokens.expect("{")
    while not tokens.accept("}"):
        is_key = tokens.accept("@key")
        type_name = _type(tokens, contract)
        name = tokens.name()
        if any(member.name == name for member in members):
            raise IdlError(f"line {tokens.line()}: member '{name}' is there twice")
        members.append(Member(name, type_name, is_key))
        tokens.expect(";")
    return members


def _type(tokens, contract):
    if tokens.accept("string"):
        if not tokens.accept("<"):
            return "string"
        bound = tokens.take()
        tokens.expect(">")
        return f"string<{bound}>"
    if tokens.accept("sequence"):
        tokens.expect("<")
        element = _type(tokens, contract)
        tokens.expect(">")
        return f"sequence<{element}>"
    line = tokens.line()
    words = [tokens.name()]
    while tokens.peek() in ("long",) and words[-1] in ("unsigned", "long"):
        words.append(tokens.take())
    text = " ".join(words)
    if text in NUMBERS:
        return NUMBERS[text]
    if text in contract.structs or text in contract.enums:
        return text
    raise IdlError(f"line {line}: type '{text}' is not one this contract uses")
