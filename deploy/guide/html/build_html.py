#!/usr/bin/env python3
"""Makes HTML of the guide, with cmark-gfm: its pages, those of the tree that they link to, and what
these name, so that every link leads somewhere without a network.

    build_html.py --bin PROGRAMS --output FOLDER

The pages lie in the folder itself, README.md as index.html; what they link to elsewhere in the tree
is below elsewhere/, in its own place, and pictures in images/. Links of those pages to yet others
become plain text. options.md gets the text of every --help, and the picture of the tutorial is made
by the programs. The folder appears under its name only when all of it is there.
"""

import argparse
import html
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

import command_help

HERE = pathlib.Path(__file__).resolve().parent
GUIDE = HERE.parent
TOP = GUIDE.parents[1]
TUTORIAL_PICTURE = "tutorial-transfer-function.svg"
PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="stylesheet" href="{root}style.css">
</head>
<body>
<nav aria-label="Pages of the guide">
{navigation}
</nav>
<main>
{body}</main>
<footer>{version}</footer>
</body>
</html>
"""
LINK = re.compile(r'<a href="([^"]*)">(.*?)</a>', re.S)
IMAGE = re.compile(r'<img src="([^"]*)"')


def run(*command, **more):
    return subprocess.run(
        [str(c) for c in command], check=True, capture_output=True, text=True, **more
    ).stdout


def without_comments(text):
    return re.sub(r"^<!--.*?-->\n", "", text, flags=re.M | re.S)


def slug(heading):
    """The id of a heading, as GitHub makes it."""
    text = html.unescape(re.sub(r"<[^>]*>", "", heading)).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def with_ids(body):
    used = {}

    def named(found):
        name = slug(found[2])
        used[name] = used.get(name, -1) + 1
        unique = f"{name}-{used[name]}" if used[name] else name
        return f'<{found[1]} id="{unique}">{found[2]}</{found[1]}>'

    return re.sub(r"<(h[1-6])>(.*?)</\1>", named, body, flags=re.S)


def is_elsewhere(target):
    return re.match(r"[a-z]+:", target) is not None


class Guide:
    def __init__(self, folder, output):
        self.programs = folder
        self.output = output
        self.pages = {}  # path in the tree -> path in the output
        for page in sorted(GUIDE.glob("*.md")):
            name = "index.html" if page.name == "README.md" else f"{page.stem}.html"
            self.pages[page] = pathlib.Path(name)
        for page in list(self.pages):
            for target in re.findall(r"\]\(\s*([^)\s#]+\.md)", page.read_text()):
                linked = (page.parent / target).resolve()
                if linked not in self.pages and linked.is_file():
                    place = linked.relative_to(TOP).with_suffix(".html")
                    self.pages[linked] = "elsewhere" / place
        self.version = run(folder / "dyncal", "--version").splitlines()[0]

    def markdown_of(self, page):
        text = without_comments(page.read_text())
        if page != GUIDE / "options.md":
            return text
        for program in command_help.programs(self.programs):
            for command, said in command_help.all_help(self.programs, program).items():
                text += f"\n## `{command}`\n\n```\n{said}```\n"
        return text

    def write_page(self, page):
        place = self.pages[page]
        body = run("cmark-gfm", "-e", "table", input=self.markdown_of(page))
        body = with_ids(body)
        body = LINK.sub(lambda found: self.link(page, html.unescape(found[1]), found[2]), body)
        body = IMAGE.sub(lambda found: f'<img src="{self.picture(page, found[1])}"', body)
        title = re.search(r"<h1[^>]*>(.*?)</h1>", body, re.S)
        root = "../" * (len(place.parts) - 1)
        target = self.output / place
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(
            PAGE.format(
                title=re.sub(r"<[^>]*>", "", title[1]) if title else place.stem,
                root=root,
                navigation=self.navigation(place, root),
                body=body,
                version=html.escape(self.version),
            )
        )

    def navigation(self, current, root):
        """The list of the first page, with the page that one is on."""
        entries = [("index.html", "Guide")]
        for name in re.findall(r"\]\((\w[\w-]*)\.md\)", (GUIDE / "README.md").read_text()):
            title = re.search(r"^# (.*)$", (GUIDE / f"{name}.md").read_text(), re.M)[1]
            title = re.sub(r"^(Reference|Tutorial): |^How to ", "", title)
            entries.append((f"{name}.html", title[0].upper() + title[1:]))
        lines = []
        for target, title in entries:
            here = ' aria-current="page"' if str(current) == target else ""
            lines.append(f'<a href="{root}{target}"{here}>{html.escape(title)}</a>')
        return "\n".join(lines)

    def link(self, page, target, text):
        if is_elsewhere(target):
            return f"{text} ({html.escape(target)})" if target not in text else text
        name, _, fragment = target.partition("#")
        path = (page.parent / name).resolve() if name else page
        place = self.pages.get(path)
        if place is None and path.is_file() and path.suffix != ".md" and page.parent == GUIDE:
            place = self.copy(path)
        if place is None:
            return text
        relative = os.path.relpath(place, self.pages[page].parent)
        anchor = f"#{fragment}" if fragment else ""
        return f'<a href="{relative}{anchor}">{text}</a>'

    def copy(self, path):
        place = "elsewhere" / path.relative_to(TOP)
        (self.output / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, self.output / place)
        return place

    def picture(self, page, target):
        path = (page.parent / target).resolve()
        place = pathlib.Path("images") / path.name
        (self.output / "images").mkdir(exist_ok=True)
        if path.name == TUTORIAL_PICTURE:
            self.draw_tutorial(self.output / place)
        else:
            shutil.copyfile(path, self.output / place)
        return os.path.relpath(place, self.pages[page].parent)

    def draw_tutorial(self, target):
        """The tutorial's measurement, of records in place of instruments."""
        text = (GUIDE / "python.md").read_text()
        bench = re.search(r"^```toml bench\.toml\n(.*?)^```", text, re.M | re.S)[1]
        with tempfile.TemporaryDirectory() as folder:
            place = pathlib.Path(folder)
            (place / "bench.toml").write_text(bench.replace('"python"', '"first-bench"'))
            run(self.programs / "dyncal-virtual-bench", "--record-csv", "records", "--frequencies",
                "20,40,80", "--levels", "10", "--repetitions", "2", "--settling", "0.5",
                "--duration-per-step", "1", cwd=folder)  # fmt: skip
            run(self.programs / "dyncal", "analyse", "bench.toml", "--figures", "f", cwd=folder)
            shutil.copyfile(place / "f/transfer-function-dau-acceleration_z.svg", target)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    parser.add_argument("--output", required=True, type=pathlib.Path)
    options = parser.parse_args()
    unfinished = options.output.with_name(options.output.name + ".part")
    shutil.rmtree(unfinished, ignore_errors=True)
    unfinished.mkdir(parents=True)
    guide = Guide(options.bin.resolve(), unfinished)
    for page in guide.pages:
        guide.write_page(page)
    shutil.copyfile(HERE / "style.css", unfinished / "style.css")
    shutil.rmtree(options.output, ignore_errors=True)
    unfinished.rename(options.output)


if __name__ == "__main__":
    main()
