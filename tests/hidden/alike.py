"""Which names an effect of a given size can have: those that the table (mde.py) can't tell from its own."""

import math

from .effects import BY_NAME, CAMERA_NOMINAL, THETA
from .mde import of

ALIKE = 3.0  # SNR below which the difference of two explanations is taken as unseen
EXPOSURE, DELAY = "camera.E_t", "camera.T_delay"
LAGS = {"plant.T_act", "plant.tau_delay"}


def _blurs(name, size):
    """Only its blur tells an exposure from a delay of the same time, by the areas, and that grows with the square: what the
    table shows at the exposure's probe is less at a smaller size. Measured (mid noise, lively): at an exposure of 0.3 the
    areas of circle 3 change by 4.4 px, at 0.035 by 0.07."""
    exposure = size if name == EXPOSURE else 2.0 * CAMERA_NOMINAL["omega_cam"] * size
    return min(1.0, exposure / BY_NAME[EXPOSURE].probe)


def _lags(setting, size):
    """A lag and a delay of the same time T are one by their slopes; what is left grows with T over the time h that a command
    is held for. Measured (plant_signature of a lag, best delay taken off, h = 1/30 s): of a lag of 3.6 ms in slow runs 0.054,
    of 1.1 ms 0.015 (T/2h); in mixed ones of 1.25 ms 0.009, of 0.38 ms 0.003 (T/4h)."""
    hold = 1.0 / CAMERA_NOMINAL["omega_cam"] if setting.rig == "visual" else 1.0 / setting.plant_rate
    return size / (hold * (2.0 if setting.mix == "slow" else 4.0))


def classes(setting, name, size, sign=1.0):
    """(class, wide class) that only can be known for an effect of `size` MDE: its own name first."""
    entry = of(setting).get(name, {})
    out = []
    for kind in ("alike", "alike_wide"):
        members = [name]
        for other, cos in entry.get(kind, {}).items():
            e = BY_NAME[other]
            if len(e.signs) == 1 and cos * sign < 0 and e.shape == "linear":
                continue
            told = math.sqrt(max(0.0, 1.0 - cos * cos))
            if {name, other} == {EXPOSURE, DELAY}:
                told *= _blurs(name, size * entry["mde"])
            if {name, other} == LAGS:
                told = max(told, min(1.0, _lags(setting, size * entry["mde"])))
            if size * entry["strength"] * told * math.sqrt(setting.longer) < ALIKE:
                members.append(other)
        out.append(members)
    if name == "plant.k_tau":  # exactly the same as all of theta scaled together
        out[1] += [f"plant.{k}" for k in THETA]
    out[1] = out[0] + [m for m in out[1] if m not in out[0]]
    return out
