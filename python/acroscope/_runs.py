"""Runs with their results."""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Iterator, Mapping
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, overload

from . import _acroscope
from ._commands import _options, _words
from ._folder import OutFolder, page

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

Value = float | int | bool | str
Kind = TypeVar("Kind", float, int, bool, str)


def _of_kind(name: str, value: Value, kind: type[Kind] | None) -> Any:
    """A value, if it is of the type that is wanted; whole numbers and Booleans are numbers, too."""
    if kind is None or isinstance(value, kind):
        return value
    if kind is float and not isinstance(value, str):
        return float(value)
    raise _acroscope.InputError(f"{name} = {value!r}: it is of type {type(value).__name__}, not {kind.__name__}")


def _needed(name: str) -> Any:
    """An optional package, or the words that say how to get it."""
    try:
        return __import__(name)
    except ImportError as missing:
        wanted = "matplotlib numpy" if name in ("matplotlib", "numpy") else name
        raise ImportError(f"this needs {name}: pip install {wanted}") from missing


def _word(value: Value) -> str:
    """A value as it is typed after `--set NAME=`."""
    return str(value).lower() if str(value) in ("True", "False") else str(value)


def _settings(values: Mapping[str, Value] | None) -> list[str]:
    """What would be typed for values by name."""
    if values is not None and not isinstance(values, Mapping):
        raise TypeError(f"values: a mapping such as {{'plant.b_joint': 0.02}}, not {values!r}")
    return [f"--set={name}={_word(value)}" for name, value in (values or {}).items()]


def run(
    scenario: str | PathLike[str],
    values: Mapping[str, Value] | None = None,
    *,
    stop: float | str | Fraction | None = None,
    isolate: bool = False,
    step_limit: float | None = None,
    out: str | PathLike[str] | None = None,
) -> Results:
    """Runs a scenario, a shipped one by its name or a file by its path.

    `values` are parameters and start values by `instance.variable`; an input that a connection or source drives is none, and refused.
    `stop` is a time in s, exact as text or Fraction
    ("1/3"). With `isolate` each unit runs in a process of its own (on Linux), so that whatever it does ends the run and not
    Python; `step_limit`: seconds that a call into an isolated unit may take, 30 if neither this nor the scenario says. `out` is a folder that keeps results.csv, resolved.toml, report.html, summary.json and the frames; a temporary
    one, which vanishes with the results, if none is given.
    """
    folder = OutFolder(out)
    words = [f"--out={folder.path}"]
    words += _settings(values)
    if stop is not None:
        words.append(f"--stop={stop}")
    words += _options(isolate=bool(isolate), step_limit=step_limit)
    # What comes after `--` is no option, whatever it begins with.
    try:
        table, graphs = _acroscope.run([*words, "--", os.fspath(scenario)])
    except _acroscope.Error as error:
        raise type(error)(_words(str(error))) from None
    return Results(table, folder, json.loads(graphs))


class Results:
    """What a run left: a table with a row at each communication point, a verdict, a report and frames.

    A mapping of columns: `"plant.q1" in r`, `for name in r`, `dict(r)`; but as with a table of pandas `len(r)` counts rows, and
    `np.asarray(r)` has them. An Arrow table by the PyCapsule interface: `polars.DataFrame(r)`, `pyarrow.table(r)` take it as it is,
    without a copy.
    It can be pickled, for processes and clusters: the table, summary and verdict go along, files stay in the folder, of
    which a temporary one vanishes with the results that were pickled.
    """

    def __init__(self, table: _acroscope.Table, folder: OutFolder, graphs: list[dict[str, Any]]) -> None:
        self._table = table
        self._folder = folder
        self._graphs = graphs
        self.summary: dict[str, Any] = json.loads((folder.path / "summary.json").read_text("utf-8"))

    @property
    def folder(self) -> Path:
        """The folder with results.csv, resolved.toml, report.html, summary.json and frames."""
        return self._folder.path

    @property
    def verdict(self) -> str:
        """What came of the run, in words; `summary["verdict"]` has its figures."""
        return self.summary["verdict"]["words"]

    @property
    def resolved(self) -> str:
        """The scenario with every value that was used, as TOML."""
        return (self.folder / "resolved.toml").read_text("utf-8")

    @property
    def columns(self) -> list[str]:
        """Names of the columns, `time` first."""
        return self._table.columns

    def unit(self, name: str) -> str | None:
        """The physical unit of a column."""
        return self._table.unit(name)

    def __len__(self) -> int:
        return len(self._table)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __contains__(self, name: object) -> bool:
        return name in self.columns

    def keys(self) -> list[str]:
        """As `columns`, so that `dict(r)` is one of arrays by their names."""
        return self.columns

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Rows by columns, in the order of `columns`: numbers, with 0 and 1 for Booleans; objects where one is a text."""
        if copy is False:
            raise ValueError("a table of columns is no array of NumPy without a copy")
        numpy = _needed("numpy")
        columns = [self[name] for name in self.columns]
        common = object if any(column.dtype.kind == "U" for column in columns) else float
        whole: NDArray[Any] = numpy.stack([column.astype(dtype or common) for column in columns], axis=1)
        return whole

    def __getitem__(self, name: str) -> NDArray[Any]:
        """The values of a column as a NumPy array."""
        kind, values = self._table.values(name)
        numpy = _needed("numpy")
        return numpy.array(values) if kind == "str" else numpy.frombuffer(values, dtype=kind)

    @overload
    def last(self, name: str) -> float: ...
    @overload
    def last(self, name: str, kind: type[Kind]) -> Kind: ...
    def last(self, name: str, kind: type[Kind] | None = None) -> Any:
        """The last value of a column, in its own type: a float, an int, a bool or a str. To a type checker it is a float, of which int
        and bool are kinds; `last(name, str)` is a str to it, and an error if it is none."""
        stored, values = self._table.values(name)
        if isinstance(values, list):
            return _of_kind(name, values[-1], kind)
        code = {"float64": "=d", "int32": "=i", "bool": "=?"}[stored]
        return _of_kind(name, struct.unpack(code, values[-struct.calcsize(code) :])[0], kind)

    @property
    def frames(self) -> dict[int, NDArray[np.uint8]]:
        """The kept pictures by their number, height x width grey levels; `camera.frames_every` says how many are kept."""
        numpy = _needed("numpy")
        found = {}
        for path in sorted((self.folder / "frames").glob("frame_*.png")):
            height, width, levels = _acroscope.grey(path)
            number = int(path.stem.removeprefix("frame_"))
            found[number] = numpy.frombuffer(levels, dtype="uint8").reshape(height, width)
        return found

    def plot(self) -> Figure:
        """The graphs of the run's page, by matplotlib: those that the scenario asks for, or the outputs of each unit."""
        _needed("matplotlib")
        from ._figure import NotebookFigure

        graphs = self._graphs
        if not graphs:
            raise _acroscope.InputError("the page of this run has no graphs; r[...] gives the signals themselves")
        figure = NotebookFigure(figsize=(8, 2.4 * len(graphs)), layout="constrained")
        axes = figure.subplots(len(graphs), sharex=True, squeeze=False)[:, 0]
        for axis, graph in zip(axes, graphs, strict=True):
            for line in graph["lines"]:
                values = self[line["signal"]] - (self[line["minus"]] if line["minus"] else 0.0)
                axis.plot(self["time"], values, linestyle=line["style"], label=line["label"] or None)
            axis.set(title=graph["title"], ylabel=graph["y"])
            if any(line["label"] for line in graph["lines"]):
                axis.legend()
        axes[-1].set_xlabel("time in s")
        return figure

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._table.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        return f"<Results: {self.verdict}; {len(self)} rows of {len(self.columns)} columns>"

    def _repr_html_(self) -> str:
        return page(self.folder / "report.html")
