"""Commands that take minutes, each in a process of its own: what a unit breaks there does not break the notebook."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import Any

from . import _acroscope
from ._folder import OutFolder, names, page

Place = str | PathLike[str]


def _command(*arguments: object, answers: Sequence[int] = (0,)) -> str:
    """What a command prints. An exit status other than those raises, with the command's own words; so does one of those, other than
    0, that comes without an answer."""
    words = [sys.executable, "-P", "-m", "acroscope", *map(str, arguments)]
    done = subprocess.run(words, capture_output=True, text=True, encoding="utf-8")
    if done.returncode in answers and (done.returncode == 0 or done.stdout.strip()):
        return done.stdout
    # A value was given in Python, and not by an option.
    said, _, _ = done.stderr.strip().removeprefix("error: ").removeprefix("--set ").partition("\n\nFor more information")
    raise (_acroscope.InputError if done.returncode == 2 else _acroscope.Error)(said or f"exit status {done.returncode}")


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
    given = {"budget": budget, "step-limit": step_limit, "after": after}
    more += [f"--{option}={value}" for option, value in given.items() if value is not None]
    more += ["--isolate"] if isolate else []
    _command("--quiet", "diagnose", *more, f"--out={diagnosis.folder}", "--", dataset)
    return diagnosis._read()


def reproduce(*ids: str, out: Place | None = None) -> Reproduction:
    """Reproduces the paper's tables, figures and claims: those named, such as "table-3" or "C25", or all."""
    reproduction = Reproduction(out)
    _command("--quiet", "reproduce", f"--out={reproduction.folder}", "--", *ids)
    return reproduction._read()


def check(fmu: Place) -> list[dict[str, Any]]:
    """Checks an FMU against the standard: findings with rule, severity, variable and text."""
    return json.loads(_command("check", "--json", "--", fmu, answers=(0, 1)))
