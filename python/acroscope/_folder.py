"""Folders of results, their pages in a notebook, and lists of names."""

from __future__ import annotations

import html
import re
import tempfile
from collections.abc import Sequence
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


def names(given: str | Sequence[str]) -> list[str]:
    """A list of names; of a single one, which is no list of its letters, that one."""
    return [given] if isinstance(given, str) else list(given)


# A link to a file beside the page.
_BESIDE = re.compile(r"""<a (?=[^>]*\bhref="(?!#|[a-z]+:))[^>]*>""")


def page(path: Path) -> str:
    """A page within a notebook's, with its own style. A page in a frame has no folder: links to files beside it would lead nowhere, so
    that their words only are left, and where the page itself lies."""
    text, links = _BESIDE.subn("<a>", path.read_text("utf-8"))
    text = html.escape(text, quote=True)
    where = f"<p>With its links it is {html.escape(str(path.absolute()))}</p>" if links else ""
    return f'{where}<iframe srcdoc="{text}" style="width: 100%; height: 40em; border: 0"></iframe>'
