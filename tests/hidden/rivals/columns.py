"""How the windows' prediction moves with each candidate: finite differences, one replay or one set of pictures each."""

import numpy as np

from ..effects import Effect
from . import image
from .windows import STATE_STEP, Model

CLOCK = Effect("clock.offset", 0.0, 5e-4, 0.0)  # a nuisance where plant and camera are logged: never named
RENDERED = ("beta", "N", "E_t")  # effects that no projected outline knows
TIMES = ("T_act", "tau_delay", "T_delay")  # slopes are taken near zero: a late torque soon leaves the straight line
INTEGERS = {"N": (1.0, 2.0, 4.0), "beta": (1.0, 3.0, 8.0)}
QUANTILES = (0.3, 0.5, 0.7, 0.85, 0.93, 0.97, 0.99)  # of the torque, where its limit is tried
PARTS = (0.5, 0.65, 0.8, 0.9, 0.97)  # of the largest torque, too
RATES = (0.5, 2.0, 7.0, 20.0, 60.0, 200.0, 600.0, 2000.0)  # 1/s, of a large step of the torque


def continuous(effect):
    return effect.shape in ("linear", "limit")


def probe(effect, value, off):
    if effect.key in TIMES:
        return 2e-4
    if effect.key.startswith("theta"):
        return 0.01 * abs(off)
    return -0.03 * value if effect.shape == "limit" else effect.probe


def changed(model, effect, value):
    plant, camera, clock = dict(model.plant), dict(model.camera), model.clock
    if effect is CLOCK:
        clock = value
    else:
        (plant if effect.side == "plant" else camera)[effect.key] = float(value)
    return Model(plant, camera, model.starts, clock)


def value_of(model, effect):
    if effect is CLOCK:
        return model.clock
    return (model.plant if effect.side == "plant" else model.camera)[effect.key]


def limits(effect, data):
    """Levels at which a limit of the torque or of its rate is tried."""
    torque = [r.commands[:, 1] for r in data.runs if len(r.commands) > 1]
    if not torque:
        return []
    if effect.key == "tau_max":
        size = np.abs(np.concatenate(torque))
        return sorted({*np.quantile(size, QUANTILES), *(x * size.max() for x in PARTS)} - {0.0})
    step = np.quantile(np.abs(np.concatenate([np.diff(c) for c in torque])), 0.98)
    return [x * step for x in RATES] if step > 0.0 else []


def trials(effect, off, data):
    """Values of an effect without a slope at its off value: limits, integers, switches."""
    if effect.shape == "switch":
        return [1.0 - off]
    return list(INTEGERS[effect.key]) if effect.shape == "integer" else limits(effect, data)


class Lattice:
    """What rendered frames have beyond projected outlines, at fixed poses: of a model, or of one with other photometry.

    Rendering anew at every pose would give a criterion with some hundred local minima (the lattice repeats every pixel).
    """

    def __init__(self, poses, camera):
        self.poses, self.camera, self.known = poses, camera, {}

    def of(self, camera):
        key = tuple(camera[k] for k in RENDERED)
        if key not in self.known:
            here = {**self.camera, **dict(zip(RENDERED, key))}
            self.known[key] = image.rendered(self.poses, here) - image.project(self.poses, self.camera)
        return self.known[key]


class Columns:
    """Prediction of one model, and differences about it."""

    def __init__(self, windows, model, lattice=None):
        self.windows, self.model = windows, model
        self.nodes, self.poses = windows.replay(model)
        self.lattice = lattice or Lattice(self.poses, model.camera)
        self.frames = self._frames(self.poses, model.camera)
        self.turn = image.pose_jacobian(self.poses, model.camera)
        self.base = windows.stack(self.nodes, self.frames)
        self.states = np.column_stack([self._moved(*windows.replay(model, h * np.eye(4)[j])) / h
                                       for j, h in enumerate(STATE_STEP)])

    def _frames(self, poses, camera):
        return image.project(poses, camera) + self.lattice.of(camera)

    def _moved(self, nodes, poses):
        frames = np.einsum("nij,nj->ni", self.turn, (poses - self.poses)[:, :2])
        return self.windows.stack([a - b for a, b in zip(nodes, self.nodes)], frames)

    def difference(self, effect, value):
        """Prediction at `value` minus that of the model."""
        new, old = changed(self.model, effect, value), self.model.camera
        if effect.side != "camera":
            return self._moved(*self.windows.replay(new))
        late = new.camera["T_delay"] - old["T_delay"] + 0.5 * (new.camera["E_t"] - old["E_t"]) / old["omega_cam"]
        poses = self.poses.copy()
        poses[:, :2] -= late * poses[:, 2:4]
        return self.windows.stack([np.zeros_like(n) for n in self.nodes], self._frames(poses, new.camera) - self.frames)

    def slope(self, effect, off):
        value = value_of(self.model, effect)
        h = probe(effect, value, off)
        return self.difference(effect, value + h) / h
