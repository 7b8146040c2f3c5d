#!/usr/bin/env python3
"""Follows every link, anchor and picture of the guide's HTML, from its first page on: all lead to
files of the folder, nothing is fetched from elsewhere or run, and every page of the guide and the
help of every command are there.

    html_test.py GUIDE --bin PROGRAMS
"""

import argparse
import html
import html.parser
import pathlib
import sys

import pages

sys.path.append(str(pages.GUIDE / "html"))
import command_help  # noqa: E402

FORBIDDEN = {"script", "style", "iframe", "object", "embed", "form", "base"}


class Document(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links = []
        self.ids = []
        self.wrong = []
        self.text = ""
        self.images = 0
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        if tag in FORBIDDEN:
            self.wrong.append(f"<{tag}>")
        self.images += tag == "img"
        for name, value in attributes:
            if name == "id":
                self.ids.append(value)
            if name in ("href", "src"):
                self.links.append(value)
            if name == "style" or name.startswith("on"):
                self.wrong.append(f"{name} of <{tag}>")

    def handle_data(self, data):
        self.text += data


class Folder:
    def __init__(self, folder):
        self.folder = folder.resolve()
        self.documents = {}
        self.wrong = []
        self.links = 0
        self.reached = set()

    def document(self, path):
        if path not in self.documents:
            self.documents[path] = Document(path)
        return self.documents[path]

    def follow_all(self):
        waiting = [self.folder / "index.html"]
        while waiting:
            path = waiting.pop()
            if path in self.reached:
                continue
            self.reached.add(path)
            if path.suffix == ".html":
                waiting += self.follow(path)

    def follow(self, path):
        document = self.document(path)
        self.wrong += [f"{path.name}: {what}" for what in document.wrong]
        if len(document.ids) != len(set(document.ids)):
            self.wrong.append(f"{path}: an id occurs twice")
        for link in document.links:
            self.links += 1
            name, _, fragment = link.partition("#")
            target = (path.parent / name).resolve() if name else path
            if ":" in link or link.startswith("/") or not target.is_relative_to(self.folder):
                self.wrong.append(f"{path.name}: {link} leads out of the guide")
            elif not target.is_file():
                self.wrong.append(f"{path.name}: {link} leads nowhere")
            elif fragment and fragment not in self.document(target).ids:
                self.wrong.append(f"{path.name}: {link}: that page has no such heading")
            else:
                yield target

    def expect_pages_of_tree(self):
        for page in pages.all_pages():
            name = "index.html" if page.name == "README.md" else f"{page.stem}.html"
            if self.folder / name not in self.reached:
                self.wrong.append(f"no link leads to {name}")
            elif len(self.documents[self.folder / name].text) < 0.5 * len(page.read_text()):
                self.wrong.append(f"{name} has not the text of {page.name}")
        for path in self.folder.rglob("*"):
            if path.is_file() and path not in self.reached:
                self.wrong.append(f"no link leads to {path.relative_to(self.folder)}")

    def expect_help(self, programs):
        shown = self.documents[self.folder / "options.html"].text
        texts = {}
        for program in command_help.programs(programs):
            texts.update(command_help.all_help(programs, program))
        self.wrong += [
            f"options.html lacks the help of '{command}'"
            for command, text in texts.items()
            if text not in shown
        ]
        return len(texts)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("guide", type=pathlib.Path)
    parser.add_argument("--bin", required=True, type=pathlib.Path)
    options = parser.parse_args()
    if not (options.guide / "index.html").is_file():
        print(f"SKIPPED: {options.guide} was not made: cmark-gfm is not there (Debian: cmark-gfm)")
        sys.exit(77)
    folder = Folder(options.guide)
    folder.follow_all()
    folder.expect_pages_of_tree()
    commands = folder.expect_help(options.bin)
    images = sum(document.images for document in folder.documents.values())
    if folder.links < 300 or images < 1:
        folder.wrong.append(f"only {folder.links} links, {images} pictures")
    print("\n".join(folder.wrong))
    print(f"{len(folder.reached)} files, {folder.links} links, {images} pictures")
    print(f"help of {commands} commands")
    sys.exit(1 if folder.wrong else 0)


if __name__ == "__main__":
    main()
