"""The scorer's own gap: by running the amended model, whatever the diagnosis claims."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from . import gap, parts, score
from .settings import Setting
from .sets import Spec

ROOT = Path(__file__).resolve().parents[2]
UNITS = ROOT / "target" / "fmus"
K1 = 0.05
HIDDEN = {"effect": [{"name": "camera.k1", "value": K1}]}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A set with a hidden k1, seen by encoders and camera."""
    out, answers = tmp_path_factory.mktemp("sets"), tmp_path_factory.mktemp("answers")
    spec = Spec(Setting("visual", "all", "mid", "mixed"), [("camera.k1", K1, 50.0)], part="one", seed=4)
    return out / parts.make(spec, out, answers, "gap"), answers


def diagnosed(folder, k1, claimed):
    """What a diagnosis would write that took so much of a lens and claims so much."""
    folder.mkdir(parents=True)
    units = [("plant", "acrobot_plant.fmu", ""), ("camera", "acrobot_camera.fmu", f"k1 = {k1}\n")]
    text = "".join(f'[[units]]\nname = "{n}"\nfmu = "{f}"\n[units.set]\n{s}' for n, f, s in units)
    (folder / "amended.toml").write_text("format = 1\n" + text)
    said = {"verdict": "named", "effects": [{"name": "camera.k1", "class": ["camera.k1"], "value": k1, "probability": 0.99}],
            "gap": {"before": 2.0, "after": 1.8, "floor": 1.8, "closed": claimed, "unit": "px"}}
    (folder / "diagnosis.json").write_text(json.dumps(said))


@pytest.mark.skipif(not UNITS.exists(), reason="cargo xtask pack makes the units")
def test_value_the_share_that_a_model_closes_is_found_without_its_claim(made, tmp_path):
    folder, answers = made
    # a lens's residual is linear in k1, so that half of it leaves half: 1 - 1/4
    for k1, share in ((K1, 1.0), (0.5 * K1, 0.75), (0.0, 0.0)):
        diagnosed(tmp_path / str(k1) / folder.name, k1, 0.98)
        found = gap.check(folder, tmp_path / str(k1) / folder.name, UNITS, HIDDEN)
        assert found["px"] == pytest.approx(share, abs=0.02), k1
    rows = [score.measure(cases, score.own_gaps(tmp_path / str(k1), folder.parent, UNITS, cases))
            for k1 in (K1, 0.0) for cases in [score.load(tmp_path / str(k1), answers)]]
    assert [r["gap_overclaimed"]["value"] for r in rows] == [0.0, 1.0]
    shutil.rmtree(tmp_path)


def test_law_a_start_state_is_found_where_a_whole_step_leads_away_from_it():
    there = np.array([0.3, -1.2, 2.0, -5.0])

    def left(at):
        return np.arctan(at - there).reshape(2, 2)

    # from two off, a whole step of Gauss-Newton lands 3.5 off on the other side, and the next one farther
    assert gap._nearest(left, there + 2.0) == pytest.approx(there, abs=1e-6)
    assert gap._nearest(left, there + 0.5) == pytest.approx(there, abs=1e-6)
    assert gap._nearest(lambda at: np.full((2, 2), np.nan), there) is None
