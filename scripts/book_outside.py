"""A preprocessor of mdBook: what the book links to outside docs/ becomes a page of its own, so that no link of the built book is dead.

`book.toml` names it; mdBook calls `book_outside.py supports RENDERER`, and then without words with the book as JSON on standard input.
Markdown is taken over with its links turned, anything else as a block of code.
"""

import json
import os
import re
import sys
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
LANGUAGES = {".toml": "toml", ".py": "python", ".rs": "rust", ".yaml": "yaml", ".sh": "bash", ".slurm": "bash"}
# A link with its words, or a block or span of code, in which nothing is a link.
LINK = re.compile(r"(```.*?```|`[^`\n]*`)|\]\(([^)\s]+)\)", re.S)


def place(file):
    """Where a file lies in the book, as a path below docs/: itself, or a page below outside/."""
    if file.is_relative_to(DOCS):
        return PurePosixPath(file.relative_to(DOCS).as_posix())
    name = file.relative_to(ROOT).as_posix()
    return PurePosixPath("outside", name if name.endswith(".md") else name + ".md")


def turned(text, folder, page, due):
    """The text of a file in `folder` with its links as a page at `page` needs them; files outside docs/ are added to `due`."""

    def link(match):
        code, target = match.groups()
        if code is not None or re.match(r"[a-z]+:|#", target):
            return match.group(0)
        path, mark, anchor = target.partition("#")
        file = (folder / path).resolve()
        if not file.is_relative_to(ROOT) or not file.exists():
            return match.group(0)
        if not file.is_relative_to(DOCS):
            if file.is_dir():
                file = file / "README.md"
                if not file.exists():
                    return "]"  # a folder is no page: the words stay
            due.add(file)
        return f"]({os.path.relpath(place(file), page.parent)}{mark}{anchor})"

    return LINK.sub(link, text)


def chapters(items):
    for item in items:
        if "Chapter" in item:
            yield item["Chapter"]
            yield from chapters(item["Chapter"]["sub_items"])


def outside(file, due):
    """A chapter of a file outside docs/."""
    page = place(file)
    text = file.read_text()
    if file.suffix == ".md":
        name = re.search(r"^# (.*)$", text, re.M)
        content, name = turned(text, file.parent, page, due), name.group(1) if name else file.stem
    else:
        name = file.relative_to(ROOT).as_posix()
        content = f"# `{name}`\n\n```{LANGUAGES.get(file.suffix, '')}\n{text.rstrip()}\n```\n"
    return {"Chapter": {"name": name, "content": content, "number": None, "sub_items": [], "path": str(page), "source_path": str(page),
                        "parent_names": []}}


def process(book):
    key = "items" if "items" in book else "sections"  # mdBook 0.5 and before
    due = set()
    for chapter in chapters(book[key]):
        if chapter.get("path"):
            page = PurePosixPath(chapter["path"])
            chapter["content"] = turned(chapter["content"], DOCS / page.parent, page, due)
    made = {}
    while left := sorted(file for file in due if file not in made):
        for file in left:
            made[file] = outside(file, due)
    if made:
        book[key].append({"PartTitle": "Files beside the book"})
        book[key].extend(made[file] for file in sorted(made))
    return book


if __name__ == "__main__":
    if sys.argv[1:2] == ["supports"]:
        sys.exit(0)
    _, given = json.load(sys.stdin)
    json.dump(process(given), sys.stdout)
