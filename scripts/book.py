"""Numbers of the book: each that was computed or measured stands between two marks that say where it comes from.

    <!-- from SOURCE NAME -->0.01998<!-- end -->

SOURCE is a file of the repository, whose constant NAME it is (Rust) or whose entry (JSON; dots lead deeper), or one of the sources of
`scripts/book_numbers.py`, which run the program. A third word says how a constant is shown: `%`. The marks are invisible on the page;
what is between them may be a word, a table or a whole block of code.

    python scripts/book.py            makes all of them again, and the pictures of docs/camera.md (needs packed units, gcc, half a minute)
    python scripts/book.py --check    tells what is stale instead; tests/fmpy/test_book.py does that
"""

import argparse
import json
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import book_numbers  # noqa: E402

ROOT = Path(__file__).resolve().parent.parent
MARK = re.compile(r"<!-- from (\S+) (\S+?)(?: (%))? -->(.*?)<!-- end -->", re.S)


def pages():
    """Pages that may have marks: the book, and what a reader of the repository begins with."""
    return sorted((ROOT / "docs").rglob("*.md")) + [ROOT / name for name in ("README.md", "examples/README.md")]


def constant(file, name):
    """The number of a constant or of a field, as Rust's source has it."""
    found = re.findall(rf"\b{re.escape(name)}\b(?:: [\w ]+ =|:| =) ([-\d._e]+)[;,]", (ROOT / file).read_text())
    if len(found) != 1:
        raise KeyError(f"{file} has {len(found)} constants {name}, not one")
    return float(found[0].replace("_", ""))


def entry(file, path):
    value = json.loads((ROOT / file).read_text())
    for key in path.split("."):
        value = value[int(key)] if isinstance(value, list) else value[key]
    return value


def shown(value, form):
    """Digits in threes where there are five or more, as the pages write them."""
    if isinstance(value, str):
        return value
    if form == "%":
        return f"{100 * value:g} %"
    return f"{value:,.0f}".replace(",", " ") if float(value).is_integer() and abs(value) >= 10_000 else f"{value:g}"


def value(source, name, form, made, docs):
    """What belongs between the marks. `made` keeps what a source gave, so that each runs once."""
    if source.endswith(".rs"):
        return shown(constant(source, name), form)
    if source.endswith(".json"):
        return shown(entry(source, name), form)
    if source not in made:
        made[source] = book_numbers.SOURCES[source](docs)
    return shown(made[source][name], form)


def filled(page, text, made, docs):
    """The text of a page with everything between marks made again."""

    def one(match):
        source, name, form, _ = match.groups()
        try:
            new = value(source, name, form, made, docs)
        except (KeyError, FileNotFoundError, IndexError) as why:
            raise SystemExit(f"{page}: nothing is known of `{source} {name}`: {why}") from why
        return match.group(0)[: match.start(4) - match.start(0)] + new + "<!-- end -->"

    text, opened = MARK.sub(one, text), len(re.findall(r"<!-- from ", text))
    if opened != len(MARK.findall(text)) or opened != text.count("<!-- end -->"):
        raise SystemExit(f"{page}: a mark is not closed, or misspelt: {opened} begin, {len(MARK.findall(text))} are whole")
    for line in re.findall(r"^ *<!-- from .* -->.*\S.*$", text, re.M):
        # Markdown takes a line that begins with a comment for a block of its own, which would end the paragraph.
        raise SystemExit(f"{page}: a mark within a sentence can't begin its line: {line}")
    return text


def make(docs=ROOT / "docs"):
    """{page: (text as it is, text as it should be)}; pictures are written below `docs`."""
    made = {}
    texts = {page: page.read_text() for page in pages()}
    return {page: (text, filled(page.relative_to(ROOT), text, made, docs)) for page, text in texts.items() if "<!-- from" in text}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="write no page, exit 1 if one is stale")
    arguments = parser.parse_args()
    stale = {page: new for page, (old, new) in make().items() if old != new}
    for page, new in stale.items():
        print(page.relative_to(ROOT))
        if not arguments.check:
            page.write_text(new)
    sys.exit(1 if arguments.check and stale else 0)


if __name__ == "__main__":
    main()
