"""The book's pictures and numbers come from the units: made again, they are the same. Its links lead somewhere."""

import html
import importlib.util
import os
import re
import shutil
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_golden_what_the_camera_page_shows_is_what_the_unit_does(tmp_path):
    book = module("book")
    docs = tmp_path / "docs"
    docs.mkdir()
    shutil.copy(ROOT / "docs" / "camera.md", docs / "camera.md")
    book.make(docs)
    stale = "run: python scripts/book.py"
    assert (docs / "camera.md").read_text() == (ROOT / "docs" / "camera.md").read_text(), stale
    made, committed = docs / "figures" / "camera", ROOT / "docs" / "figures" / "camera"
    assert sorted(p.name for p in made.iterdir()) == sorted(p.name for p in committed.iterdir()), stale
    for file in made.iterdir():
        # Decoded, not as bytes: another zlib may pack the same picture in other bytes.
        ours, theirs = (cv2.imread(str(f), cv2.IMREAD_GRAYSCALE) for f in (file, committed / file.name))
        assert np.array_equal(ours, theirs), f"{file.name} is stale, {stale}"


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
