"""The book's pictures and numbers come from the units: made again, they are the same."""

import importlib.util
import shutil
from pathlib import Path

import cv2
import numpy as np

ROOT = Path(__file__).resolve().parents[2]


def test_golden_what_the_camera_page_shows_is_what_the_unit_does(tmp_path):
    spec = importlib.util.spec_from_file_location("book", ROOT / "scripts" / "book.py")
    book = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(book)
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
