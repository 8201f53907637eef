"""Sweeps: a study's cases as one table, made by this machine or by a Dask cluster."""

from __future__ import annotations

import os
import sys
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _acroscope
from ._commands import Place, _command
from ._folder import OutFolder, page
from ._runs import _needed

if TYPE_CHECKING:
    import pyarrow
    from distributed import Client


class Sweep:
    """The data set of a sweep: `cases/part-*.parquet`, `signals/`, `report.html` in `folder`."""

    def __init__(self, folder: OutFolder) -> None:
        self._folder = folder

    @property
    def folder(self) -> Path:
        """The folder of the data set."""
        return self._folder.path

    @property
    def files(self) -> list[Path]:
        """The files of the cases, in order."""
        return sorted((self.folder / "cases").glob("part-*.parquet"))

    def table(self, kind: str = "cases") -> pyarrow.Table:
        """All cases, or "signals", as a table of pyarrow."""
        _needed("pyarrow")
        import pyarrow.parquet

        return pyarrow.parquet.read_table(self.folder / kind)

    def __repr__(self) -> str:
        return f"<Sweep: {len(self.files)} parts in {self.folder}>"

    def _repr_html_(self) -> str:
        return page(self.folder / "report.html")


def sweep(
    study: Place,
    *,
    out: Place | None = None,
    jobs: int | None = None,
    isolate: bool = False,
    client: Client | None = None,
    partitions: int | None = None,
    retries: int = 3,
) -> Sweep:
    """Runs a study, a shipped one by its name or a file by its path: one scenario with many values.

    `out`: a folder for the data set, in which parts that are there are not made again; a temporary one if none is given.
    `jobs`: threads, all cores if not given. `isolate`: a unit that crashes costs its case only.

    `client`: a client of `dask.distributed`. Its workers make the parts, `partitions` of them (4 for each thread of the
    cluster if not given), a part anew up to `retries` times; then `out` must lie where all workers see it.
    """
    name = os.fspath(study)
    name = os.path.abspath(name) if os.path.exists(name) else name
    words = ["sweep", name] + (["--isolate"] if isolate else [])
    if client is None:
        folder = OutFolder(out)
        threads = ["--jobs", jobs] if jobs else []
        _command("--quiet", *words, "--out", folder.path, *threads)
        return Sweep(folder)
    if out is None:
        raise _acroscope.InputError("out: with a client a folder is needed that all workers see")
    path = os.path.abspath(out)
    _spread(client, words, path, partitions or 4 * max(1, sum(client.nthreads().values())), jobs or 1, retries)
    # Whatever is missing, and the page.
    _command("--quiet", *words, "--out", path)
    return Sweep(OutFolder(path))


def _spread(client: Client, words: list[str], out: str, parts: int, jobs: int, retries: int) -> None:
    """Makes all parts on the workers."""
    tasks = [(words, out, part, parts, jobs) for part in range(1, parts + 1)]
    futures = client.map(_part, tasks, retries=retries, pure=False)
    from distributed.utils import is_kernel

    if sys.stderr.isatty() or is_kernel():
        from distributed import progress

        # As text in a notebook, too: there a widget would want ipywidgets, and be the last thing of a cell.
        progress(futures, notebook=False)
    refused = [said for said in client.gather(futures) if said]
    if refused:
        raise _acroscope.InputError(refused[0])


def _part(task: tuple[list[str], str | PathLike[str], int, int, int]) -> str | None:
    """Makes a part, on a worker. What is wrong with the input is answered: trying again would not mend it."""
    words, out, part, parts, jobs = task
    try:
        _command("--quiet", *words, "--out", out, "--partition", f"{part}/{parts}", "--jobs", jobs)
    except _acroscope.InputError as error:
        return str(error)
    return None


__all__: list[Any] = ["Sweep", "sweep"]
