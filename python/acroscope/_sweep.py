"""Sweeps: a study's cases as one table, made by this machine or by a Dask cluster."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _acroscope
from ._commands import Place, _command
from ._folder import OutFolder, page
from ._runs import Value, _needed, _settings, _word

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
        if not (self.folder / kind).is_dir():
            raise _acroscope.InputError(f"table({kind!r}): the sweep keeps none; cases, or signals where the study has [signals]")
        _needed("pyarrow")
        import pyarrow.parquet

        return pyarrow.parquet.read_table(self.folder / kind)

    def __repr__(self) -> str:
        return f"<Sweep: {len(self.files)} parts in {self.folder}>"

    def _repr_html_(self) -> str:
        return page(self.folder / "report.html")


def sweep(
    study: Place,
    grid: Mapping[str, str | Sequence[float | int | bool | str]] | None = None,
    *,
    scalars: Mapping[str, str] | None = None,
    until: str | None = None,
    values: Mapping[str, Value] | None = None,
    stop: float | str | Fraction | None = None,
    out: Place | None = None,
    jobs: int | None = None,
    isolate: bool = False,
    client: Client | None = None,
    partitions: int | None = None,
    retries: int = 3,
) -> Sweep:
    """Runs a study, a shipped one by its name or a file by its path: one scenario with many values.

        ac.sweep("visual-servo", {"camera.T_delay": "0:0.06:0.005", "camera.omega_cam": [30, 60]}, until="plant.contact")

    With `grid` the name is that of a scenario, and all combinations are run: of each parameter the listed values, or those of a text
    "FROM:TO:STEP". `until` ends each run: a Boolean, or "plant.q2 > 2". `scalars` are kept of each run: {"rms":
    "controller.z_desired-plant.z:rms"}; without any the time at which `until` came. `values` are set in all runs, which `stop` ends, of a
    study, too.

    `out`: a folder for the data set, in which parts that are there are not made again; a temporary one if none is given.
    `jobs`: threads, 1 or more, all cores if not given. `isolate`: a unit that crashes costs its case only.

    `client`: a client of `dask.distributed`. Its workers make the parts, `partitions` of them (4 for each thread of the
    cluster if not given), a part anew up to `retries` times; then `out` must lie where all workers see it.
    """
    name = os.fspath(study)
    name = os.path.abspath(name) if os.path.exists(name) else name
    if jobs is not None and jobs < 1:
        raise _acroscope.InputError(f"jobs = {jobs}: a number of threads, 1 or more; without it all cores")
    words = ["sweep", *_typed(grid, scalars, until, values, stop)] + (["--isolate"] if isolate else [])
    words += ["--", name]
    if client is None:
        folder = OutFolder(out)
        threads = [f"--jobs={jobs}"] if jobs else []
        _command("--quiet", words[0], f"--out={folder.path}", *threads, *words[1:])
        return Sweep(folder)
    if out is None:
        raise _acroscope.InputError("out: with a client a folder is needed that all workers see")
    path = os.path.abspath(out)
    _spread(client, words, path, partitions or 4 * max(1, sum(client.nthreads().values())), jobs or 1, retries)
    # Whatever is missing, and the page.
    _command("--quiet", words[0], f"--out={path}", *words[1:])
    return Sweep(OutFolder(path))


def _typed(
    grid: Mapping[str, str | Sequence[float | int | bool | str]] | None,
    scalars: Mapping[str, str] | None,
    until: str | None,
    values: Mapping[str, Value] | None,
    stop: float | str | Fraction | None,
) -> list[str]:
    """What would be typed for these."""
    words = []
    for name, axis in (grid or {}).items():
        words.append(f"--grid={name}={axis if isinstance(axis, str) else ','.join(map(_word, axis))}")
    words += [f"--scalar={name}={of}" for name, of in (scalars or {}).items()]
    words += [f"--until={until}"] if until is not None else []
    words += _settings(values)
    return words + ([f"--stop={stop}"] if stop is not None else [])


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
        _command("--quiet", words[0], f"--out={out}", f"--partition={part}/{parts}", f"--jobs={jobs}", *words[1:])
    except _acroscope.InputError as error:
        return str(error)
    return None


__all__: list[Any] = ["Sweep", "sweep"]
