"""An angle that wraps in the log: told where the unit turns on, and followed where the unit wraps as well."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from .machine import Input, Machine, Output, Parameter, State
from .unit_c import build
from .unit_python import environment

PROGRAM = Path(__file__).resolve().parents[2] / "target" / "release" / "acroscope"
TABLE = Machine(name="table", states=(State("phi", "rad", "phi_0", 0.0, 0.0),), inputs=(Input("u", "1", 0.0, 1.0, "1"),),
                outputs_of=(Output("phi", "rad", 1e-3, "deg"),),
                parameters=(Parameter("k", "rad/s", 2.0, 0.1, 10.0, "relative", "speed", 1.0),),
                rhs=None, outputs=None, row=0.02, substeps=1, duration=10.0, build=None, step=0.02)  # fmt: skip


@pytest.mark.parametrize(
    ("shown", "status", "said"),
    [("v[phi] = x[0];", 2, 'column "phi" (table.phi) jumps by a turn (360)'), ("v[phi] = remainder(x[0], 2 * 3.14159265358979323846);", 0, "")],
    ids=["turns on", "wraps"],
)  # fmt: skip
def test_an_angle_that_wraps_is_told_where_the_unit_turns_on(tmp_path, shown, status, said):
    unit = build(TABLE, tmp_path, "dx[0] = v[k] * v[u];", shown, TABLE.step)
    rng = np.random.default_rng(5)
    lines = ["format = 2", f'fmu = "{Path(unit).name}"', '[[channel]]\nvariable = "table.u"', '[[channel]]\nvariable = "table.phi"\nunit = "deg"',
             '[[state]]\nstart = "table.phi_0"\nshows = "table.phi"', '[[candidate]]\nvariable = "table.k"\nscale = "relative"']  # fmt: skip
    for run in (1, 2):
        fed = np.repeat(rng.uniform(0.2, 1.0, 20), 25)
        phi = np.concatenate([[0.0], np.cumsum(2.0 * fed * TABLE.row)[:-1]]) + 1e-3 * rng.normal(size=len(fed))
        rows = zip(TABLE.row * np.arange(len(fed)), fed, np.degrees(np.arctan2(np.sin(phi), np.cos(phi))), strict=True)
        (tmp_path / f"run-{run}.csv").write_text("time,u,phi\n" + "".join(",".join(f"{value:.9g}" for value in row) + "\n" for row in rows))
        lines.append(f'[[run]]\nfile = "run-{run}.csv"')
    (tmp_path / "dataset.toml").write_text("\n".join(lines) + "\n")
    command = [PROGRAM, "--quiet", "diagnose", tmp_path, "--out", tmp_path / "found"]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False, env=environment())
    assert done.returncode == status and said in done.stderr, done.stderr
    assert status == 0 or "numpy.unwrap(column, period=360)" in done.stderr, done.stderr
