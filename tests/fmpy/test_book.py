"""The book's pictures and numbers come from the program: made again, they are the same. Its links lead somewhere."""

import difflib
import html
import importlib.util
import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_golden_numbers_and_pictures_of_the_book_are_those_that_are_made_today(tmp_path):
    book = module("book")
    stale = [f"{page.relative_to(ROOT)}:\n{difference(old, new)}" for page, (old, new) in book.make(tmp_path).items() if old != new]
    assert stale == [], "\n".join(["run: python scripts/book.py", *stale])
    made, committed = tmp_path / "figures" / "camera", ROOT / "docs" / "figures" / "camera"
    assert sorted(p.name for p in made.iterdir()) == sorted(p.name for p in committed.iterdir())
    for file in made.iterdir():
        # Decoded, not as bytes: another zlib may pack the same picture in other bytes.
        ours, theirs = (cv2.imread(str(f), cv2.IMREAD_GRAYSCALE) for f in (file, committed / file.name))
        assert np.array_equal(ours, theirs), f"{file.name} is stale, run: python scripts/book.py"


def difference(old, new):
    return "\n".join(line for line in difflib.unified_diff(old.splitlines(), new.splitlines(), lineterm="", n=0) if line[0] in "+-")


# What looks like a result on a page but was laid down: an input of an example, a rule, a definition. Anything else is made by
# scripts/book.py, or stands in a record, which says so with its date.
GIVEN = {
    "docs/camera.md": ["256 px", "0.9 rad", "-2 rad", "0.1 px"],
    "docs/check.md": ["2 %", "1 %"],
    "docs/cluster.md": ["3 of 16"],
    "docs/container.md": ["1 ms", "30 Hz"],
    "docs/controller.md": ["75 %"],
    "docs/diagnosis-any.md": ["2 %"],
    "docs/diagnosis-json.md": ["95 %", "100 %"],
    "docs/diagnosis-told.md": ["0.2 mrad"],
    "docs/diagnosis.md": ["0.5 s"],
    "docs/start.md": ["50 ms"],
    "docs/sweep.md": ["128 cases", "61 rows"],
    "docs/timing.md": ["600 Hz", "50 ms", "30 Hz", "600 Hz"],
    "docs/units.md": ["0.956 N·m", "256 times", "75 %"],
    "examples/README.md": ["20 s", "0.2 mrad", "0.02 N·m"],
}
UNITS = "µs|us|ms|s|minutes?|hours?|MB|MiB|GB|kB|px|N·m|rad|mrad|1/s|Hz|times|lines|rows|cases|of \\d+"
RESULT = re.compile(rf"(?<![\w./–-])[-+−]?\d[\d ]*(?:\.\d+)?(?:e-?\d+)? ?(?:%|(?:{UNITS})\b)")
# Code, links, indented blocks, and what scripts/book.py makes.
NO_PROSE = re.compile(r"```.*?```|`[^`\n]*`|<!-- from .*?<!-- end -->|\]\([^)]*\)|^    [^\n]*$", re.S | re.M)
RECORD = re.compile(r"(?:\*Record\b[^*]*?|\(record of )\d{4}-\d\d-\d\d")


def results(text):
    """Numbers of a page that nothing makes, up to where a record begins."""
    told = NO_PROSE.sub("", RECORD.split(text)[0])
    return [found.group(0) for found in RESULT.finditer(told)]


def test_law_every_result_in_the_book_is_made_or_a_record_or_given():
    # docs/speed.md is written by scripts/bench.sh as a whole.
    loose = {str(page.relative_to(ROOT)): results(page.read_text()) for page in module("book").pages() if page.name != "speed.md"}
    assert {page: numbers for page, numbers in loose.items() if numbers} == GIVEN
    records = [page for page in (ROOT / "docs" / "log").glob("*.md") if not RECORD.search("".join(page.read_text().splitlines(True)[:6]))]
    assert records == []


def test_law_every_source_of_numbers_is_used():
    book = module("book")
    named = {source for page in book.pages() for source, *_ in book.MARK.findall(page.read_text())}
    assert set(module("book_numbers").SOURCES) <= named


def test_value_what_counts_as_a_result():
    assert results("took 44 s of CPU, 87 % and 7 of 7, 2 000 rows, 1/600 s, FMI 2.0") == ["44 s", "87 %", "7 of 7", "2 000 rows"]
    assert results("<!-- from a b -->44 s<!-- end --> and `3 s`\n*Record of 2026-11-24.* 5 s") == []
    assert results("*Record.* 5 s") == ["5 s"], "a record has its date"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a <!-- from nowhere x -->1<!-- end -->", "nothing is known of `nowhere x`"),
        ("a <!-- from report/src/thin.rs NO_SUCH -->1<!-- end -->", "has 0 constants NO_SUCH"),
        ("a <!-- from tests/hidden_any/gates.json no.such -->1<!-- end -->", "nothing is known of"),
        ("a <!-- from report/src/thin.rs BUCKETS -->1", "not closed"),
        ("<!-- from report/src/thin.rs BUCKETS -->1<!-- end --> begins a line", "can't begin its line"),
    ],
)
def test_value_a_wrong_mark_is_told_with_its_page(text, says):
    with pytest.raises(SystemExit, match=says) as told:
        module("book").filled("page.md", text, {}, None)
    assert str(told.value).startswith("page.md: ")


def test_value_marks_take_constants_and_entries():
    book = module("book")
    (ROOT / "report/src/thin.rs").read_text().index("const BUCKETS: usize = 32_768;")
    text = "a <!-- from report/src/thin.rs BUCKETS -->1<!-- end -->, <!-- from tests/hidden_any/gates.json gap_closed % -->?<!-- end -->."
    gate = json.loads((ROOT / "tests/hidden_any/gates.json").read_text())["gap_closed"]
    plain = re.sub("<!--.*?-->", "", book.filled("page.md", text, {}, None))
    assert plain == f"a 32 768, {100 * gate:g} %."


LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.S)
# Beside docs/: what a reader of the repository begins with.
BESIDE = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "NOTATION.md", "examples/README.md", "python/README.md"]


def anchors(page):
    """Addresses within a page, as GitHub and mdBook make them of headings."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.S)
    made = set()
    for heading in re.findall(r"^#+ (.*)$", text, re.M):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
        made.add(re.sub(r"[^\w\- ]", "", words).replace(" ", "-"))
    return made


def pages():
    return sorted((ROOT / "docs").rglob("*.md")) + [ROOT / name for name in BESIDE]


def test_law_every_link_and_anchor_leads_somewhere():
    dead, followed = [], 0
    for page in pages():
        for link in LINK.findall(CODE.sub("", page.read_text())):
            if re.match(r"[a-z]+:", link):
                continue
            path, _, anchor = link.partition("#")
            to = (page.parent / path).resolve() if path else page
            followed += 1
            if not to.exists() or (anchor and to.suffix == ".md" and anchor not in anchors(to)):
                dead.append(f"{page.relative_to(ROOT)}: {link}")
    assert dead == [] and followed > 80, followed


def test_law_every_page_is_in_the_book():
    summary = (ROOT / "docs" / "SUMMARY.md").read_text()
    listed = {(ROOT / "docs" / link).resolve() for link in LINK.findall(summary)}
    left = [str(page.relative_to(ROOT)) for page in pages() if page.is_relative_to(ROOT / "docs") and page.name != "SUMMARY.md" and page not in listed]
    assert left == []


def module(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "scripts" / f"{name}.py")
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def test_value_links_out_of_the_book_become_pages_of_it():
    outside = module("book_outside")
    text = "[a](../python/README.md#use) [b](camera.md) `[c](../NOTATION.md)` [d](../scenarios/visual-servo.toml) [e](https://x.y)"
    chapter = {"name": "x", "content": text, "sub_items": [], "path": "start.md"}
    book = outside.process({"items": [{"Chapter": chapter}]})
    assert chapter["content"] == (
        "[a](outside/python/README.md#use) [b](camera.md) `[c](../NOTATION.md)` [d](outside/scenarios/visual-servo.toml.md) [e](https://x.y)"
    )
    made = {item["Chapter"]["path"]: item["Chapter"]["content"] for item in book["items"][2:]}
    assert "outside/python/README.md" in made and "```toml" in made["outside/scenarios/visual-servo.toml.md"]
    # Links of the pages that were taken over lead on within the book.
    for path, content in made.items():
        for link in LINK.findall(CODE.sub("", content)):
            to = link.partition("#")[0]
            if to and not re.match(r"[a-z]+:", to):
                place = os.path.normpath(os.path.join(os.path.dirname(path), to))
                assert place in made or (ROOT / "docs" / place).exists(), f"{path}: {link}"


@pytest.mark.skipif(shutil.which("mdbook") is None, reason="no mdbook on this machine: the book is not built (cargo install mdbook)")
def test_law_the_built_book_has_no_dead_link(tmp_path):
    subprocess.run(["mdbook", "build", "--dest-dir", str(tmp_path), str(ROOT)], check=True, capture_output=True, timeout=300)
    built = {page: page.read_text() for page in tmp_path.rglob("*.html") if page.name not in ("print.html", "toc.html")}
    assert len(built) > 30
    dead = []
    for page, text in built.items():
        for link in re.findall(r'(?:href|src)="([^"]+)"', text):
            path, _, anchor = html.unescape(link).partition("#")
            if re.match(r"[a-z]+:", path) or (page.name == "404.html" and path.startswith("/")):
                continue
            to = (page.parent / path).resolve() if path else page
            if not to.exists() or (anchor and to in built and f'id="{anchor}"' not in built[to]):
                dead.append(f"{page.relative_to(tmp_path)}: {link}")
    assert dead == []
