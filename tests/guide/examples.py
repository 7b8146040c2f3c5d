"""Whole files that are accepted: those of the example laboratory, and those of the guide."""

import shutil
import tomllib

import pages
import readers

STUBS = {".csv": "frequency_hz,magnitude,phase_rad\n10,1,0\n", ".json": '{"value_s": 0, "u_s": 0}'}


def texts_in(value):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list | tuple):
        return [text for item in value for text in texts_in(item)]
    return [value] if isinstance(value, str) else []


def stub_files(tables, folder):
    """The files that an example names have to be there."""
    for text in texts_in(tables):
        path = folder / text
        if path.suffix in (".csv", ".json", ".dbc", ".log", ".npy", ".svg") and not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(STUBS.get(path.suffix, ""))


def all_examples(program, folder):
    """[(name, reader, tables)]; files that they name are put into `folder`."""
    for path in [*pages.EXAMPLES.glob("*.*"), *(pages.EXAMPLES / "documents").glob("*.*")]:
        shutil.copy(path, folder)
    sources = [(path.name, path.read_text()) for path in sorted(pages.EXAMPLES.rglob("*.toml"))]
    for page in pages.all_pages():
        for block in pages.blocks_of(page):
            if block.language == "toml" and block.words and block.words[0] != "in":
                sources.append((block.where, block.text))
    examples = []
    for name, text in sources:
        tables = tomllib.loads(text)
        stub_files(tables, folder)
        examples.append((name, readers.reader_of(tables), tables))
    questions = [
        (reader, text, folder / "x.toml")
        for (_, text), (_, reader, _) in zip(sources, examples)
    ]
    for (name, _, _), answer in zip(examples, readers.ask(program, questions)):
        if answer["problem"]:
            raise RuntimeError(f"{name} is refused: {answer['problem']}")
    return examples


def first_table(tables):
    """Of a list of tables the first stands for all."""
    if isinstance(tables, list) and tables and isinstance(tables[0], dict):
        return tables[0]
    return tables if isinstance(tables, dict) else None
