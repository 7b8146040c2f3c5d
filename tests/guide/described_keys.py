"""What the pages of the guide say of every key."""

import dataclasses
import re

import pages

PAGES = ("bench-file.md", "laboratory-files.md")


@dataclasses.dataclass
class Description:
    reader: str
    name: str  # dotted
    conditions: frozenset  # of the key's own table: {("driver", "can")}
    row: dict

    @property
    def required(self):
        return self.row["default"] == "required"

    @property
    def depends(self):
        return self.row["default"].startswith(("required ", "see "))

    @property
    def choices(self):
        texts = [text.strip('"') for text in pages.code_in(self.row["range"]) if text[0] == '"']
        are_examples = self.row["range"].startswith(("ISO ", "D-SI"))
        return texts if len(texts) > 1 and not are_examples else []

    def __str__(self):
        conditions = "".join(f' with {key} = "{value}"' for key, value in self.conditions)
        return f"{self.reader} file: {self.name}{conditions}"


def section_of(page, heading):
    """(reader, table, conditions), or None for a heading without keys."""
    code = pages.code_in(heading)
    table = next((text.strip("[]") for text in code if text.startswith("[")), "")
    conditions = frozenset(re.findall(r'(\w+) = "([\w-]+)"', " ".join(code)))
    if page == "bench-file.md":
        return "bench", table, conditions
    return heading.split()[0].lower(), table, conditions


def all_descriptions():
    described = []
    for page in PAGES:
        for heading, text in pages.sections_of(pages.GUIDE / page):
            reader, table, conditions = section_of(page, heading)
            for row in pages.rows_of(text):
                if "key" not in row:  # of another table, as that of units
                    continue
                key = pages.code_in(row["key"])[0]
                name = f"{table}.{key}" if table else key
                described.append(Description(reader, name, conditions, row))
    return described
