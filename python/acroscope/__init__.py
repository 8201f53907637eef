"""A co-simulation bench for visual servoing: FMI 2.0 units, a master, and a diagnosis of what a model lacks.

    import acroscope as ac

    r = ac.run("visual-servo", {"camera.T_delay": 0.05}, stop=5)
    r.verdict                   # "lost balance at t = 1.887 s ..."
    r["plant.z"]                # a NumPy array
    polars.DataFrame(r)         # also pyarrow.table(r), pandas.DataFrame.from_arrow(r)
    r.plot()

    ac.diagnose("path/to/dataset").verdict
    ac.import_logs("log.csv", "heater.fmu", out="heater").guesses
    ac.reproduce("table-3").claims
    ac.sweep("delay-and-rate", out="map").table()

Runs and simulations happen in this process, without its lock; commands of minutes in one of their own. Ctrl-C ends both; of a simulation step
by step not while a unit that is not isolated hangs.
What is wrong with the input raises `InputError`, in the words of the command line, with its options as the arguments that they are here.
"""

import sys
from pathlib import Path

from . import _acroscope, _child
from ._acroscope import Error, InputError, __version__

if sys.executable:
    # The process of an isolated unit is Python with this package, and ends in this call.
    _acroscope.host_units(sys.executable, _child.ARGUMENTS)

_DATA = Path(__file__).resolve().parent / "data"
_acroscope.add_units(_DATA / "fmus")

from ._commands import DataSet, Diagnosis, Reproduction, check, diagnose, import_logs, new, record, reproduce  # noqa: E402
from ._runs import Results, run  # noqa: E402
from ._simulation import Simulation  # noqa: E402
from ._sweep import Sweep, sweep  # noqa: E402

__all__ = [
    "DataSet",
    "Diagnosis",
    "Error",
    "InputError",
    "Reproduction",
    "Results",
    "Simulation",
    "Sweep",
    "__version__",
    "check",
    "diagnose",
    "examples",
    "import_logs",
    "new",
    "record",
    "reproduce",
    "run",
    "scenarios",
    "sweep",
    "units",
]


def _files(folder: str, pattern: str) -> dict[str, Path]:
    return {path.stem: path for path in sorted((_DATA / folder).glob(pattern))}


def units() -> dict[str, Path]:
    """The packed units by name, for other tools: `.fmu` files with binaries for every platform they were built for.

    The blank that `acroscope container` fills is none: without a scenario inside it doesn't start."""
    return {name: path for name, path in _files("fmus", "*.fmu").items() if name != "acroscope_container"}


def scenarios() -> dict[str, Path]:
    """The shipped scenarios by name, as files to begin one's own with."""
    return _files("scenarios", "*.toml")


def examples() -> dict[str, Path]:
    """The sample data sets by name, for `diagnose`."""
    return {path.parent.name: path.parent for path in sorted((_DATA / "examples").glob("*/dataset.toml"))}
