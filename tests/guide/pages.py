"""The pages of the guide as the tests read them: code blocks, tables, headings.

A code block says in its first line what it is:

    sh                 commands, run in order by run_page.py
    text               what the commands above print; `...` stands for what varies
    text status=1      the same of commands of which one fails with this status; several: 0,1
    toml bench.toml    a whole file, written under this name (any language)
    toml in bench.toml keys that belong into a file that is there already, or into one of
                       deploy/example-lab
    setup              in an HTML comment, `<!-- setup`: commands that a reader has no need of
"""

import dataclasses
import pathlib
import re

TOP = pathlib.Path(__file__).resolve().parents[2]
GUIDE = TOP / "deploy/guide"
EXAMPLES = TOP / "deploy/example-lab"


@dataclasses.dataclass
class Block:
    page: pathlib.Path
    line: int
    language: str
    words: list
    text: str

    @property
    def where(self):
        return f"{self.page.name}:{self.line}"


def all_pages():
    pages = sorted(GUIDE.glob("*.md"))
    if len(pages) < 5:
        raise RuntimeError(f"only {len(pages)} pages in {GUIDE}")
    return pages


def blocks_of(page):
    blocks = []
    opened = None
    lines = []
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if opened is None:
            fence = re.match(r"```(.*)|<!-- (setup)$", line)
            if fence:
                opened, lines = (number, (fence[1] or fence[2] or "").split()), []
        elif line in ("```", "-->"):
            language, *words = opened[1] or [""]
            blocks.append(Block(page, opened[0], language, words, "\n".join(lines) + "\n"))
            opened = None
        else:
            lines.append(line)
    if opened:
        raise RuntimeError(f"{page}:{opened[0]}: this block does not end")
    return blocks


def prose_of(page):
    """The page without its code blocks and comments."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.M | re.S)
    return re.sub(r"<!--.*?-->", "", text, flags=re.S)


def sections_of(page):
    """(heading, text) of every heading, of any depth."""
    parts = re.split(r"^#+ (.*)$", prose_of(page), flags=re.M)
    return list(zip(parts[1::2], parts[2::2]))


def rows_of(text):
    """Rows of the Markdown tables in a text, as dictionaries by the titles of their columns."""
    rows = []
    titles = None
    for line in text.splitlines():
        if not line.startswith("|"):
            titles = None
            continue
        cells = [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if titles is None:
            titles = cells
        elif not re.fullmatch(r"[-:| ]+", line):
            rows.append(dict(zip(titles, cells, strict=True)))
    return rows


def code_in(cell):
    """The texts in backquotes of a cell."""
    return re.findall(r"`([^`]+)`", cell)
