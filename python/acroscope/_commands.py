"""Commands that take minutes, each in a process of its own: what a unit breaks there does not break the notebook."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tomllib
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from . import _acroscope, _child
from ._folder import OutFolder, names, page

Place = str | PathLike[str]


# What the command line says beside its error, of how a command is typed.
_HELP = re.compile(r"\n\n(?:Usage: |For more information)")


# Options of the command line that Python's functions have as arguments; those of another name, and those that are on or off.
_ARGUMENTS = (
    "after budget encoder-noise encoder-rate fit fmu force grid isolate jobs out output rate scalar scenario seed set start step-limit stop "
    "torque-noise until without"
).split()
_RENAMED = {"output": "out", "scalar": "scalars", "set": "values"}
_FLAGS = ("force", "isolate")
_OPTION = re.compile(r"--([a-z]+(?:-[a-z]+)*)")


def _in_python(said: str) -> str:
    """What the command line says, with its options as the arguments that they are here."""

    def argument(option: re.Match[str]) -> str:
        name = option[1]
        if name not in _ARGUMENTS:
            return option[0]
        return f"{name}=True" if name in _FLAGS else _RENAMED.get(name, name.replace("-", "_"))

    return _OPTION.sub(argument, said)


def _words(said: str) -> str:
    """An error of the command line in the words of Python, where a value was given by an argument and not by an option."""
    return _in_python(_HELP.split(said.strip().removeprefix("error: ").removeprefix("--set "))[0])


def _said(*arguments: object, answers: Sequence[int] = (0,)) -> tuple[str, str]:
    """What a command prints, and its notes. An exit status other than those raises, with the command's own words; so does one of those,
    other than 0, that comes without an answer."""
    typed = (os.fspath(word) if isinstance(word, PathLike) else str(word) for word in arguments)
    done = subprocess.run(_child.command(*typed), capture_output=True, text=True, encoding="utf-8")
    if done.returncode in answers and (done.returncode == 0 or done.stdout.strip()):
        return done.stdout, done.stderr
    said = _words(done.stderr) or f"exit status {done.returncode}"
    raise (_acroscope.InputError if done.returncode == 2 else _acroscope.Error)(said)


def _command(*arguments: object, answers: Sequence[int] = (0,)) -> str:
    return _said(*arguments, answers=answers)[0]


def _options(**given: object) -> list[str]:
    """Options with these values, without those that are None or False."""
    kept = ((f"--{name.replace('_', '-')}", value) for name, value in given.items() if value is not None and value is not False)
    return [option if value is True else f"{option}={value}" for option, value in kept]


class _Outcome:
    def __init__(self, out: Place | None) -> None:
        self._folder = OutFolder(out)

    @property
    def folder(self) -> Path:
        """The folder of the results."""
        return self._folder.path


class Diagnosis(_Outcome):
    """What a model lacks against measured data: `diagnosis.json`, `amended.toml` and `report.html` in `folder`."""

    def _read(self) -> Diagnosis:
        self.data: dict[str, Any] = json.loads((self.folder / "diagnosis.json").read_text("utf-8"))
        return self

    @property
    def verdict(self) -> str:
        """none, named, ambiguous or unknown."""
        return self.data["verdict"]

    @property
    def effects(self) -> list[dict[str, Any]]:
        """The effects that were found: name, class, value, ci95, probability."""
        return self.data["effects"]

    @property
    def gap(self) -> dict[str, Any]:
        """How far the gap closes on runs that were left out."""
        return self.data["gap"]

    @property
    def amended(self) -> str:
        """The text of the amended scenario. `run(d.folder / "amended.toml")` runs it; `write_amended` puts it elsewhere, with the files that
        it may name: the model of any FMU reads its inputs from one."""
        return (self.folder / "amended.toml").read_text("utf-8")

    def write_amended(self, folder: Place) -> Path:
        """Writes the amended scenario with the files that it names into a folder, which is made if it is missing; the scenario's path,
        for `run`."""
        into = Path(folder)
        into.mkdir(parents=True, exist_ok=True)
        sources = tomllib.loads(self.amended).get("sources", [])
        files = {source["file"] for source in sources if "file" in source}
        if not into.samefile(self.folder):
            for name in (*sorted(files), "amended.toml"):
                shutil.copy2(self.folder / name, into / name)
        return into / "amended.toml"

    def __repr__(self) -> str:
        names = ", ".join(f"{effect['name']} = {effect['value']:.4g}" for effect in self.effects)
        return f"<Diagnosis: {self.verdict}{': ' + names if names else ''}>"

    def _repr_html_(self) -> str:
        return page(self.folder / "report.html")


class DataSet(_Outcome):
    """Measured runs and the model of what was measured, in `folder`: `diagnose` takes it as it is.

    `guesses`: what `import_logs` made of the logs, each with its evidence, as `dataset.toml` has them. `notices`: what should be looked at.
    """

    def __init__(self, out: Place | None) -> None:
        super().__init__(out)
        self.guesses: list[str] = []
        self.notices: list[str] = []

    def _make(self, command: str, *arguments: object) -> DataSet:
        printed, notes = _said(command, f"--out={self.folder}", *arguments)
        self.guesses = [line.removeprefix("  ") for line in printed.splitlines() if line.startswith("  ")]
        self.notices = [line.removeprefix("note: ") for line in notes.splitlines() if line.startswith("note: ")]
        return self

    def __fspath__(self) -> str:
        return str(self.folder)

    def __repr__(self) -> str:
        return f"<DataSet: {self.folder}>"


class Reproduction(_Outcome):
    """The paper's statements beside what we get: `claims.json` and `index.html` in `folder`."""

    def _read(self) -> Reproduction:
        self.claims: list[dict[str, Any]] = json.loads((self.folder / "claims.json").read_text("utf-8"))
        return self

    def __repr__(self) -> str:
        holding = sum(claim["holds"] for claim in self.claims)
        return f"<Reproduction: {holding} of {len(self.claims)} statements hold>"

    def _repr_html_(self) -> str:
        return page(self.folder / "index.html")


def diagnose(
    dataset: Place,
    *,
    without: str | Sequence[str] = (),
    budget: float | None = None,
    fit: str | Sequence[str] = (),
    isolate: bool = False,
    step_limit: float | None = None,
    after: Place | None = None,
    out: Place | None = None,
) -> Diagnosis:
    """Finds what a model lacks against the measured runs of a data set, a folder with `dataset.toml`.

    `without`: effects that are not to be named. `budget`: seconds after which searches end with what they have, 60 for each run if not
    given. `fit`: parameters that are fitted in place of a search (format = 2). `isolate`: each unit in a process of its own (any unit,
    on Linux), and `step_limit`: seconds that a call into a unit may take. `after`: the folder of an earlier diagnosis of the same machine.
    `out`: a folder that keeps the results; a temporary one if none is given. For `without` and `fit` a single name will do, too.
    """
    diagnosis = Diagnosis(out)
    more = [f"--without={name}" for name in names(without)]
    more += [f"--fit={','.join(names(fit))}"] if fit else []
    more += _options(budget=budget, step_limit=step_limit, after=None if after is None else os.fspath(after), isolate=bool(isolate))
    _command("--quiet", "diagnose", *more, f"--out={diagnosis.folder}", "--", dataset)
    return diagnosis._read()


def import_logs(
    logs: Place | Sequence[Place],
    fmu: Place,
    *,
    rate: float | None = None,
    start: float | None = None,
    isolate: bool = False,
    step_limit: float | None = None,
    force: bool = False,
    out: Place | None = None,
) -> DataSet:
    """Makes a data set of measured logs and the unit that models what was measured: `acroscope import`. Each guess is told with its evidence.

    `logs`: CSV files, one a run; a single path will do, too. `rate`: rows per second of logs without a column of time, and `start`: the time
    of their first row in s, 0 if not given. `isolate`: every run of the unit in a process of its own (on Linux), and `step_limit`: seconds that
    a call into it may take. `out`: a folder that keeps the data set, and `force`: one that is there is replaced; a temporary one if none is
    given.
    """
    files = [logs] if isinstance(logs, (str, PathLike)) else list(logs)
    if not files:
        raise _acroscope.InputError(f"logs = {logs!r}: the paths of CSV files, one a run")
    more = _options(rate=rate, start=start, isolate=bool(isolate), step_limit=step_limit, force=bool(force))
    return DataSet(out)._make("import", f"--fmu={os.fspath(fmu)}", *more, "--", *files)


def record(
    runs: Place | Sequence[Place],
    *,
    scenario: Place | None = None,
    encoder_noise: float | None = None,
    encoder_rate: float | None = None,
    torque_noise: float | None = None,
    seed: int | None = None,
    force: bool = False,
    out: Place | None = None,
) -> DataSet:
    """Makes a data set of finished runs, to rehearse a diagnosis: `acroscope record`.

    `runs`: folders of runs of the shipped rig, such as `run(...).folder`; a single one will do, too. `scenario`: the nominal model, without
    what is hidden in the runs, visual-servo if not given. `encoder_noise` in rad, 2e-4 if not given; `encoder_rate`: readings per second, 30 if
    not given, 0: no encoders. `torque_noise` in N.m: the applied torque is logged, too. `seed` of all noise. `out` and `force` as for
    `import_logs`.
    """
    folders = [runs] if isinstance(runs, (str, PathLike)) else list(runs)
    if not folders:
        raise _acroscope.InputError(f"runs = {runs!r}: the folders of finished runs")
    nominal = None if scenario is None else os.fspath(scenario)
    noises = _options(encoder_noise=encoder_noise, encoder_rate=encoder_rate, torque_noise=torque_noise, seed=seed)
    return DataSet(out)._make("record", *_options(scenario=nominal, force=bool(force)), *noises, "--", *folders)


def reproduce(*ids: str, out: Place | None = None) -> Reproduction:
    """Reproduces the paper's tables, figures and claims: those named, such as "table-3" or "C25", or all."""
    reproduction = Reproduction(out)
    _command("--quiet", "reproduce", f"--out={reproduction.folder}", "--", *ids)
    return reproduction._read()


def check(fmu: Place) -> list[dict[str, Any]]:
    """Checks an FMU against the standard: findings with rule, severity, variable and text."""
    return json.loads(_command("check", "--json", "--", fmu, answers=(0, 1)))


def new(*fmus: Place, out: Place | None = None, force: bool = False) -> str:
    """A first scenario of these units, in the order in which they are to be stepped, as TOML; each guess has its comment. `out`: a file that
    it is written to, and `force`: one that is there is replaced. Without `out` its paths are for a file in this folder."""
    if not fmus:
        raise _acroscope.InputError("fmus: the paths of one unit or more")
    if out is None:
        return _command("new", "--", *fmus)
    _command("--quiet", "new", f"--output={os.fspath(out)}", *_options(force=bool(force)), "--", *fmus)
    return Path(out).read_text("utf-8")
