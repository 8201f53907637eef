"""Builds the units of the examples, and writes their logs anew (they are committed; the units are not).

    .venv/bin/python examples/make.py            builds examples/*/*.fmu; needs gcc and PythonFMU
    .venv/bin/python examples/make.py --logs     also simulates the logs of motor and room, with what the unit lacks; scipy-checked
                                                 numerics of tests/hidden_any, not the unit's. The others' logs were measured.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "tests"))
from hidden_any import excite, sets  # noqa: E402
from hidden_any.machines import ALL  # noqa: E402
from hidden_any.simulate import simulate, variants  # noqa: E402
from real import REAL  # noqa: E402


def logged(machine, change, disturb, heads, runs, seed):
    """The logs of a machine as its logger writes them. `heads`: per column its head, and model = scale * log + offset."""
    rng = np.random.default_rng(seed)
    times = machine.row * np.arange(round(machine.duration / machine.row) + 1)
    for run in range(1, runs + 1):
        commands, start = excite.commands(machine, times, rng), excite.start(machine, rng)
        course = sets.trace(machine, rng, times)[1] if disturb else None
        clean = simulate(machine, variants(machine, [change]), times, commands, start, course)
        columns = {"time": times} | commands
        for one in machine.outputs_of:
            columns[one.name] = clean[one.name][:, 0] + one.noise * rng.normal(size=len(times))
        numbers = [(columns[name] - offset) / scale for name, (_, scale, offset) in heads.items()]
        lines = [";".join(head for head, *_ in heads.values())]
        lines += [";".join(f"{value:.6g}".replace(".", ",") for value in row) for row in zip(*numbers, strict=True)]
        folder = HERE / machine.name / "logs"
        folder.mkdir(exist_ok=True)
        (folder / f"{machine.name}-{run}.csv").write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--logs", action="store_true")
    arguments = parser.parse_args()
    for name, machine in ({name: ALL[name] for name in ("motor", "room")} | REAL).items():
        print(machine.build(machine, HERE / name))
    if not arguments.logs:
        return
    # the encoder of phi was mounted the other way round, and nobody wrote that down
    turn, degree = 2 * np.pi / 60, np.pi / 180
    heads = {"time": ("t [ms]", 1e-3, 0), "u": ("u [mV]", 1e-3, 0), "i": ("i [mA]", 1e-3, 0), "w": ("w [rpm]", turn, 0),
             "phi": ("phi [deg]", -degree, 0)}  # fmt: skip
    logged(ALL["motor"], {"b": 0.06}, False, heads, 3, 4)
    heads = {"time": ("time", 1, 0), "P": ("P [W]", 1, 0), "T_out": ("T_out [degC]", 1, 273.15), "T": ("T [degC]", 1, 273.15)}
    logged(ALL["room"], {}, True, heads, 3, 5)


if __name__ == "__main__":
    main()
