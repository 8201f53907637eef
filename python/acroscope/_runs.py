"""Runs with their results, and simulations step by step."""

from __future__ import annotations

import json
import os
import struct
import tomllib
from collections.abc import Mapping, Sequence
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _acroscope
from ._folder import OutFolder, page

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

Value = float | int | bool | str


def _stop(stop: float | str | Fraction | None) -> str | None:
    return None if stop is None else str(stop)


def _needed(name: str) -> Any:
    """An optional package, or the words that say how to get it."""
    try:
        return __import__(name)
    except ImportError as missing:
        raise ImportError(f"this needs {name}: pip install 'acroscope[notebook]'") from missing


def _word(value: Value) -> str:
    """A value as it is typed after `--set NAME=`."""
    return str(value).lower() if str(value) in ("True", "False") else str(value)


def run(
    scenario: str | PathLike[str],
    values: Mapping[str, Value] | None = None,
    *,
    stop: float | str | Fraction | None = None,
    isolate: bool = False,
    out: str | PathLike[str] | None = None,
) -> Results:
    """Runs a scenario, a shipped one by its name or a file by its path.

    `values` are parameters and start values by `instance.variable`; `stop` is a time in s, exact as text or Fraction
    ("1/3"). With `isolate` each unit runs in a process of its own (on Linux), so that whatever it does ends the run and not
    Python. `out` is a folder that keeps results.csv, resolved.toml, report.html, summary.json and the frames; a temporary
    one, which vanishes with the results, if none is given.
    """
    folder = OutFolder(out)
    words = [os.fspath(scenario), "--out", str(folder.path)]
    for name, value in (values or {}).items():
        words += ["--set", f"{name}={_word(value)}"]
    if stop is not None:
        words += ["--stop", str(stop)]
    if isolate:
        words.append("--isolate")
    return Results(_acroscope.run(words), folder)


class Results:
    """What a run left: a table with a row at each communication point, a verdict, a report and frames.

    An Arrow table by the PyCapsule interface: `polars.DataFrame(r)`, `pyarrow.table(r)` take it as it is, without a copy.
    It can be pickled, for processes and clusters: the table, summary and verdict go along, files stay in the folder, of
    which a temporary one vanishes with the results that were pickled.
    """

    def __init__(self, table: _acroscope.Table, folder: OutFolder) -> None:
        self._table = table
        self._folder = folder
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

    def __getitem__(self, name: str) -> NDArray[Any]:
        """The values of a column as a NumPy array."""
        kind, values = self._table.values(name)
        numpy = _needed("numpy")
        return numpy.array(values) if kind == "str" else numpy.frombuffer(values, dtype=kind)

    def last(self, name: str) -> Value:
        """The last value of a column."""
        kind, values = self._table.values(name)
        if isinstance(values, list):
            return values[-1]
        code = {"float64": "=d", "int32": "=i", "bool": "=?"}[kind]
        value: Value = struct.unpack(code, values[-struct.calcsize(code) :])[0]
        return value

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
        """The graphs of the scenario's report, by matplotlib."""
        _needed("matplotlib")
        from ._figure import NotebookFigure

        graphs = tomllib.loads(self.resolved).get("report", {}).get("graphs", [])
        if not graphs:
            raise _acroscope.InputError("the scenario has no [[report.graphs]]; r[...] gives the signals themselves")
        figure = NotebookFigure(figsize=(8, 2.4 * len(graphs)), layout="constrained")
        axes = figure.subplots(len(graphs), sharex=True, squeeze=False)[:, 0]
        for axis, graph in zip(axes, graphs, strict=True):
            for line in graph["lines"]:
                values = self[line["signal"]] - (self[line["minus"]] if "minus" in line else 0.0)
                axis.plot(self["time"], values, linestyle=line.get("style", "solid"), label=line.get("label"))
            axis.set(title=graph["title"], ylabel=graph["y"])
            if any("label" in line for line in graph["lines"]):
                axis.legend()
        axes[-1].set_xlabel("time in s")
        return figure

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._table.__arrow_c_stream__(requested_schema)

    def __repr__(self) -> str:
        return f"<Results: {self.verdict}; {len(self)} rows of {len(self.columns)} columns>"

    def _repr_html_(self) -> str:
        return page(self.folder / "report.html")


class Simulation:
    """A scenario step by step.

        sim = ac.Simulation("full-state", inputs=["plant.tau"])
        while sim.step() is not None:
            sim.set("plant.tau", my_controller(sim.get("plant.q1"), sim.get("plant.q2")))

    `inputs` are taken from whatever drives them in the scenario, and yours to set. With `isolate` each unit runs in a process
    of its own (on Linux).
    """

    def __init__(
        self,
        scenario: str | PathLike[str],
        values: Mapping[str, Value] | None = None,
        *,
        stop: float | str | Fraction | None = None,
        inputs: Sequence[str] = (),
        isolate: bool = False,
    ) -> None:
        words = (os.fspath(scenario), dict(values or {}), _stop(stop), list(inputs), isolate)
        self._inner = _acroscope.Simulation(*words)

    @property
    def time(self) -> float:
        """Simulated time in s."""
        return self._inner.time

    @property
    def resolved(self) -> str:
        """The scenario with every value that is used, as TOML."""
        return self._inner.resolved

    @property
    def notices(self) -> list[str]:
        """What one should know, but what stops nothing."""
        return self._inner.notices

    def set(self, name: str, value: Value) -> None:
        """Gives `instance.variable` a value: any start value before the run, an input or tunable parameter in it."""
        self._inner.set(name, value)

    def get(self, name: str) -> Value:
        """The value of `instance.variable` now."""
        return self._inner.get(name)

    def step(self, until: float | None = None) -> float | None:
        """On to the next communication point, or to the last one not later than `until`; its time, or None at the end."""
        return self._inner.step() if until is None else self._inner.advance_to(float(until))

    def save(self) -> _acroscope.State:
        """The state now: of the units, the values between them, and what is under way with a delay."""
        return self._inner.save()

    def restore(self, state: _acroscope.State) -> None:
        """Back to a saved state, of this simulation or of another one of the same scenario; from there the same bits."""
        self._inner.restore(state)

    def reset(self) -> None:
        """Back to before the start; start values stay."""
        self._inner.reset()

    def __repr__(self) -> str:
        return f"<Simulation at {self.time} s>"
