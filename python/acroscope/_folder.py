"""Folders of results, and their pages in a notebook."""

from __future__ import annotations

import html
import tempfile
from os import PathLike
from pathlib import Path


class OutFolder:
    """The folder of a command's results; without a name a temporary one, which vanishes with this object."""

    def __init__(self, out: str | PathLike[str] | None) -> None:
        if out is None:
            self._kept = tempfile.TemporaryDirectory(prefix="acroscope-")
            out = self._kept.name
        self.path = Path(out)

    def __reduce__(self) -> tuple[type[OutFolder], tuple[str]]:
        # A pickled temporary folder still vanishes with the first object.
        return OutFolder, (str(self.path.absolute()),)


def page(path: Path) -> str:
    """A page within a notebook's, with its own style."""
    text = html.escape(path.read_text("utf-8"), quote=True)
    return f'<iframe srcdoc="{text}" style="width: 100%; height: 40em; border: 0"></iframe>'
