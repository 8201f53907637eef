"""Which names an effect of a given size can have: those that the table (mde.py) can't tell from its own."""

import math

from .effects import BY_NAME, CAMERA_NOMINAL, THETA
from .mde import of

ALIKE = 3.0  # SNR below which the difference of two explanations is taken as unseen
# The same where nobody can tell: with x standard deviations between two explanations one loses x² ± 2x of deviance, and whoever
# calls 6 enough (odds of 1 to 20) is led to a single name once in 160 sets at 1, once in 10 at 1.5, every second time at 2.5.
EXACT = 1.0
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
    """What only can be known for an effect of `size` MDE, its own name first: the class, the same with the principal point
    free, and those of the class that nobody can tell from it."""
    entry = of(setting).get(name, {})

    def members(kind, unseen):
        told = {other: _told(setting, entry, (name, other), cos, size) for other, cos in entry.get(kind, {}).items()
                if not (len(BY_NAME[other].signs) == 1 and cos * sign < 0 and BY_NAME[other].shape == "linear")}
        return [name, *(other for other, snr in told.items() if snr < unseen)]

    own, wide = members("alike", ALIKE), members("alike_wide", ALIKE)
    if name == "plant.k_tau":  # exactly the same as all of theta scaled together
        wide += [f"plant.{k}" for k in THETA]
    return own, own + [m for m in wide if m not in own], members("alike", EXACT)


def _told(setting, entry, pair, cos, size):
    """SNR of what the best copy by the other leaves."""
    share = math.sqrt(max(0.0, 1.0 - cos * cos))
    if set(pair) == {EXPOSURE, DELAY}:
        share *= _blurs(pair[0], size * entry["mde"])
    if set(pair) == LAGS:
        share = max(share, min(1.0, _lags(setting, size * entry["mde"])))
    return size * entry["strength"] * share * math.sqrt(setting.longer)
