"""A replayed scenario closes the gap when it holds what was hidden, and none of it when it is the nominal one."""

import json

from . import sets
from .machines import ALL
from .replay import closed

NOMINAL = 'format = 1\n[experiment]\nstop = 1\n[[units]]\nname = "motor"\nfmu = "motor.fmu"\ninterval = "1/100"\n'


def test_replay(tmp_path):
    motor = ALL["motor"]
    units = {"motor": motor.build(motor, tmp_path)}
    answer = sets.make(motor, "b", 5, tmp_path / "set", tmp_path / "answers", units)
    answer = json.loads((tmp_path / "answers" / "set.json").read_text())
    found = answer["effects"][0]["value"]
    (tmp_path / "set" / "amended.toml").write_text(NOMINAL + f"[units.set]\nb = {found}\n")
    (tmp_path / "set" / "same.toml").write_text(NOMINAL)
    # the unit's RK4 and the truth's differ by less than a hundredth of the gap
    assert closed(tmp_path / "set", tmp_path / "set" / "amended.toml", answer) > 0.99
    assert closed(tmp_path / "set", tmp_path / "set" / "same.toml", answer) == 0.0
