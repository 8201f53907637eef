"""Windows with a free start state: predictions of every log from short replays, and how they move with each effect.

Long replays of an unstable machine leave the data whatever the model; short ones whose start is fitted do not. Slopes are
finite differences, one replay or one set of pictures each.
"""

from dataclasses import dataclass

import numpy as np

from . import image
from .data import CLOCK, PLANT_COLUMNS, RENDERED, probe

WIDTH = 0.5  # s, as in mde.py
STATE_STEP = (1e-5, 1e-5, 1e-4, 1e-4)
GROUPS = (*PLANT_COLUMNS, *(f"{k}{i}" for i in (1, 2, 3) for k in ("area", "u", "v")))


@dataclass
class Cut:
    run: int
    begin: float
    rows: np.ndarray  # of plant.csv
    frames: np.ndarray  # of camera.csv
    place: slice = None  # in the stacked vector


@dataclass
class Model:
    plant: dict
    camera: dict
    starts: np.ndarray  # (cuts, 4)
    clock: float = 0.0  # s that the plant's clock is ahead of the others


class Windows:
    def __init__(self, data, width=WIDTH):
        self.data, self.cuts = data, []
        early = data.world.early if data.has_frames else data.world.early_plant
        for k, run in enumerate(data.runs):
            times = np.concatenate([run.plant_time, run.frame_time])
            if not len(times):
                continue
            for begin in np.arange(times.min(), times.max(), width):
                rows = np.flatnonzero((run.plant_time >= begin) & (run.plant_time < begin + width))
                frames = np.flatnonzero((run.frame_time >= begin) & (run.frame_time < begin + width))
                if len(rows) + 2 * len(frames) >= 6:
                    self.cuts.append(Cut(k, begin - early, rows, frames))
        self._layout()

    def _layout(self):
        at, groups, measured = 0, [np.zeros(0, int)], [np.zeros(0)]
        for cut in self.cuts:
            run = self.data.runs[cut.run]
            size = 5 * len(cut.rows) + 9 * len(cut.frames)
            cut.place = slice(at, at + size)
            at += size
            groups += [np.tile(np.arange(5), len(cut.rows)), np.tile(np.arange(5, 14), len(cut.frames))]
            measured += [run.plant[cut.rows].ravel(), run.frames[cut.frames].ravel()]
        self.groups, self.measured = np.concatenate(groups), np.concatenate(measured)

    def replay(self, model, change=None):
        """Nodes at the plant's rows by cut, and poses (n, 5) at mid exposure; change: added to every start state."""
        simulate = self.data.world.replay(model.plant)
        late = model.camera["T_delay"] + 0.5 * model.camera["E_t"] / model.camera["omega_cam"]
        rows, poses = [], [np.zeros((0, 5))]
        for cut, start in zip(self.cuts, model.starts):
            run = self.data.runs[cut.run]
            times = np.concatenate([run.plant_time[cut.rows] - model.clock, run.frame_time[cut.frames] - late])
            order, back = np.unique(np.concatenate([[cut.begin], np.maximum(times, cut.begin)]), return_inverse=True)
            nodes = simulate(run.commands, order, start if change is None else start + change)[back[1:]]
            rows.append(nodes[:len(cut.rows)])
            poses.append(nodes[len(cut.rows):])
        return rows, np.concatenate(poses)

    def stack(self, nodes, frames):
        """One long vector from nodes by cut and frames (n, 9) in the order of the cuts."""
        out, at = np.zeros(len(self.measured)), 0
        for cut, part in zip(self.cuts, nodes):
            n = len(cut.frames)
            out[cut.place] = np.concatenate([part.ravel(), frames[at:at + n].ravel()])
            at += n
        return out

    def guess(self, camera):
        """Start states from a parabola through the first rows (or pictures) of each window."""
        starts = []
        for cut in self.cuts:
            run = self.data.runs[cut.run]
            if len(cut.rows) >= 3:
                t, q = run.plant_time[cut.rows], run.plant[cut.rows, :2]
            else:
                t, q = run.frame_time[cut.frames], image.estimates(run.frames[cut.frames], camera)
            good = np.all(np.isfinite(q), axis=1) & (t - t[0] < 0.35)
            fit = np.polynomial.polynomial.polyfit(t[good] - cut.begin, q[good], min(3, good.sum() - 1))
            starts.append([*fit[0], *fit[1]])
        return np.array(starts)


def continuous(effect):
    return effect.shape in ("linear", "limit")


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


class Lattice:
    """What rendered frames have beyond projected outlines, at fixed poses: of a model, or of one with other photometry.

    Rendering anew at every pose would give a criterion with some hundred local minima (the lattice repeats every pixel).
    """

    def __init__(self, poses, camera, world):
        self.poses, self.camera, self.world, self.known = poses, camera, world, {}

    def of(self, camera):
        key = tuple(camera[k] for k in RENDERED)
        if key not in self.known:
            here = {**self.camera, **dict(zip(RENDERED, key))}
            self.known[key] = self.world.rendered(self.poses, here) - image.project(self.poses, self.camera)
        return self.known[key]


class Columns:
    """Prediction of one model, and differences about it."""

    def __init__(self, windows, model, lattice=None):
        self.windows, self.model = windows, model
        self.nodes, self.poses = windows.replay(model)
        self.lattice = lattice or Lattice(self.poses, model.camera, windows.data.world)
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
