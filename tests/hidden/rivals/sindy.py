"""A pySINDy discrepancy fit: which few terms explain what the nominal model leaves?

Plant: the weak form of the equations of motion (weak.py) with rates by pySINDy's SmoothedFiniteDifference; a term is what
one listed effect adds to the accelerations. Picture: centroids and areas beside what the nominal camera shows at the
measured pose (or, without encoders, at the pose fitted to the picture); a term is what one effect adds to them. Both are
stacked and a sparse combination is fitted by pySINDy's STLSQ and FROLS; which of their fits is taken is decided by leaving
out one run after the other (the sparsest near the best). A term that survives is named, the largest contribution first, with
those that it stands for: a library is cleared of copies.
"""

import warnings

import numpy as np
import pysindy as ps
from scipy.interpolate import CubicHermiteSpline

from ..effects import BY_NAME
from . import counts, image
from .data import CLOCK, INTEGERS, RENDERED, TIMES, limits, probe
from .weak import SHIFT, SMOOTH, Weak

ROWS = 12  # a run needs more than the smoother's window
FLOOR = np.tile([0.05, 0.003, 0.003], 3)  # px, below which two honest renderers differ
PIXEL = 0.03  # px, a centroid's noise, for the weight of the encoders in a pose
RIDGES = (0.05, 3.0, 100.0)
THRESHOLDS = 16
ELBOW = 0.02  # of the error that the best fit takes away: less than that earns no further term
TERMS = 8  # that the forward path adds at most
COPY = 0.9999  # |cos| above which a term is a copy of an earlier one
BESIDE = np.array([2.3e-3, 3.7e-3, 0.0, 0.0])  # rad: at the camera's 26 px per world unit half a pixel and more
BLOCKS = 12  # per run, for the standard error of a prediction


class Piece:
    """One run's share: rates, weak form, pictures."""

    def __init__(self, data, run):
        self.run, self.plant, self.camera, self.world = run, data.plant, data.camera, data.world
        self.encoders = len(run.plant) >= ROWS
        self.mid = run.frame_time - self.camera["T_delay"] - 0.5 * self.camera["E_t"] / self.camera["omega_cam"]
        self.seen = run.frames.reshape(-1, 9)
        if self.encoders:
            good = np.all(np.isfinite(run.plant[:, :2]), axis=1)
            self.t, self.q = run.plant_time[good], run.plant[good, :2]
        else:
            self.t, self.q = self.mid, image.fit_poses(run.frames, self.mid, self.camera, self.world)[:, :2]
        self.sd = [data.noise.get(k) or _roughness(self.q[:, j]) for j, k in enumerate(("q1", "q2"))]
        self.smoothed, self.dq = _rates(self.t, self.q)
        self.weak = Weak(self.t, run.commands, self.sd)
        self.y = [self.weak.rest(self.q, self.dq, self.plant), np.zeros(0)]
        if len(self.seen):
            self._picture()

    def _picture(self):
        if self.encoders:
            at = np.clip(self.mid, self.t[0], self.t[-1])
            rates = np.column_stack([np.interp(at, self.t, self.dq[:, j]) for j in (0, 1)])
            known = np.column_stack([CubicHermiteSpline(self.t, self.smoothed, self.dq)(at), rates])
            trust = (PIXEL / np.mean(self.sd)) ** 2
            self.poses = image.fit_poses(self.run.frames, self.mid, self.camera, self.world, known, trust)
        else:
            self.poses = known = np.column_stack([self.q, self.dq])
        self.frames = self.world.rendered(self.poses, self.camera)
        self.beside = self.world.rendered(self.poses + BESIDE, self.camera)
        self.turn = image.pose_jacobian(self.poses, self.camera)
        pose = np.diag(self.sd) ** 2 if self.encoders else 0.05**2 * np.eye(2)
        cover = np.diag(np.maximum(self._noise(), FLOOR) ** 2) + np.einsum("nik,kl,njl->nij", self.turn, pose, self.turn)
        self.white = np.linalg.inv(np.linalg.cholesky(cover))
        # about the pose fitted to both, as the lattice there is the one seen; the encoders' share is put back by its slope
        moved = np.einsum("nij,nj->ni", self.turn, (known - self.poses)[:, :2])
        self.y[1] = self._whiten(self.seen - self.frames - moved)

    def _noise(self):
        """Noise of each channel: as the nominal camera would have it, times what circle 1 (blind to the pose) scatters."""
        poses = image.fit_poses(self.run.frames, self.mid, self.camera, self.world) if self.encoders else self.poses
        clean = self.world.rendered(poses, self.camera)
        sd = np.maximum(np.nanstd(self.world.noisy(poses, self.camera) - clean, axis=0), FLOOR)
        return sd * max(1.0, float(np.mean(image.scatter(self.seen - clean)[:3] / sd[:3])))

    def _whiten(self, frames):
        return np.nan_to_num(np.einsum("nij,nj->ni", self.white, frames)).ravel()

    def _plant_term(self, plant):
        return self.y[0] - self.weak.rest(self.q, self.dq, plant)

    def _camera_term(self, effect, value):
        """What a camera at `value` changes: in the picture, and without encoders in the angles read off it."""
        new = {**self.camera, effect.key: value}
        late = new["T_delay"] - self.camera["T_delay"] + 0.5 * (new["E_t"] - self.camera["E_t"]) / new["omega_cam"]
        poses = self.poses.copy()
        poses[:, :2] -= late * poses[:, 2:]
        if effect.key in RENDERED:  # beside the pose: there, term and rest would share the lattice's error of one picture
            change = self.world.rendered(poses + BESIDE, new) - self.beside
        else:
            change = image.project(poses, new) - image.project(self.poses, self.camera)
        if self.encoders:
            return np.zeros(len(self.y[0])), self._whiten(change)
        j = self.turn[:, image.PLACES]
        pull = np.einsum("nik,ni->nk", j, np.nan_to_num(change[:, image.PLACES]))
        q = self.q + np.linalg.solve(np.einsum("nik,nil->nkl", j, j), pull[..., None])[..., 0]
        return self.weak.rest(q, _rates(self.t, q)[1], self.plant) - self.y[0], self._whiten(change)

    def term(self, effect, value):
        """Stacked and whitened change of this run when the effect takes a value."""
        if effect is CLOCK:  # the plant's clock ahead: its motion seems late, the pictures early
            late = self._plant_term({**self.plant, "tau_delay": value})
            return np.concatenate([late, -self._camera_term(BY_NAME["camera.T_delay"], value)[1]])
        if effect.side == "plant":
            return np.concatenate([self._plant_term({**self.plant, effect.key: value}), np.zeros(len(self.y[1]))])
        if not len(self.seen):
            return np.zeros(len(self.y[0]))
        return np.concatenate(self._camera_term(effect, value))


def _roughness(x):
    """Noise of a smooth signal from its third differences (median: jumps do not count)."""
    bent = np.diff(x, 3)
    return max(float(np.sqrt(np.median(bent**2) / 0.455 / 20.0)), 1e-7)


def _rates(t, q):
    """Smoothed angles and rates."""
    rows, order = SMOOTH["slow" if np.median(np.diff(t)) > 0.015 else "fast"]
    rule = ps.SmoothedFiniteDifference(smoother_kws={"window_length": rows, "polyorder": order}, order=4)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        dq = np.asarray(rule._differentiate(q, t))
    return np.asarray(rule.smoothed_x_), dq


def _values(effect, data):
    """Values at which an effect's term is taken; several for limits, whose shape changes with the level."""
    off = 0.0 if effect is CLOCK else data.off(effect)
    if effect.shape == "switch":
        return [1.0 - off]
    if effect.shape == "integer":
        return [INTEGERS[effect.key][0]]
    if effect.shape == "limit":
        return limits(effect, data)
    if effect is CLOCK or effect.key in TIMES:
        return [off + SHIFT]
    return [off + probe(effect, off, off)]


def library(data, pieces):
    """Terms: [(effects, value of the first it was taken at, column)] without empty ones; copies of one term share it."""
    terms, units = [], []
    chosen = [e for e in data.candidates if e.shape in ("linear", "limit", "integer", "switch")]
    if data.has_frames and data.has_plant:
        chosen.append(CLOCK)
    for e in chosen:
        for value in _values(e, data):
            column = np.nan_to_num(np.concatenate([p.term(e, value) for p in pieces]))
            length = np.linalg.norm(column)
            if length < 1e-9:
                continue
            twin = next((i for i, u in enumerate(units) if abs(column @ u) > COPY * length), None)
            if twin is None:
                terms.append(([e], value, column))
                units.append(column / length)
            elif e is not CLOCK and e not in terms[twin][0]:
                terms[twin][0].append(e)
    return terms


def _paths(x, y, thresholds):
    """Coefficients on columns of unit length, (fits, terms): STLSQ by threshold and ridge, FROLS by the number of terms."""
    dropped = [ps.STLSQ(threshold=t, alpha=ridge) for t in thresholds for ridge in RIDGES]
    added, seen = np.zeros((TERMS + 1, x.shape[1])), np.linalg.norm(x, axis=0) > 1e-9  # FROLS divides by a column's length
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        found = [rule.fit(x, y).coef_[0] for rule in dropped]
        history = ps.FROLS(max_iter=TERMS, alpha=0.0).fit(x[:, seen], y).history_
    added[:len(history), seen] = np.concatenate(history)
    added[len(history):] = added[len(history) - 1]
    return np.concatenate([found, added])


def _small(x, y):
    """As few rows as terms with the same least squares: STLSQ sees nothing else of them."""
    q, r = np.linalg.qr(x)
    return r, q.T @ y


def choose(x, y, runs):
    """Coefficients of the sparsest fit whose error on left-out runs is within a standard error of the best, or at the elbow."""
    length = np.linalg.norm(x, axis=0)
    x = x / length
    pull = np.abs(y @ x).max()
    folds = [(runs == k, _small(x[runs != k], y[runs != k])) for k in set(runs)] if len(set(runs)) > 1 else []
    folds = folds or [(runs == runs[0], _small(x, y))]
    parts = np.concatenate([k * BLOCKS + np.arange(n) * BLOCKS // n for k, n in enumerate(np.bincount(runs)) if n])
    thresholds = np.geomspace(2.0, max(1.05 * pull, 4.0), THRESHOLDS)
    rests = 0.0
    for out, train in folds:
        rests = rests + np.where(out, y - _paths(*train, thresholds) @ x.T, 0.0)
    fits = _paths(*_small(x, y), thresholds)
    size = np.maximum(np.bincount(parts), 1)
    errors = np.array([np.bincount(parts, weights=r**2) / size for r in rests])
    least = errors[np.argmin(errors.mean(axis=1))]
    worse, elbow = errors - least, ELBOW * np.mean(np.bincount(parts, weights=y**2) / size - least)
    close = worse.mean(axis=1) <= np.maximum(worse.std(axis=1) / np.sqrt(worse.shape[1]), elbow) + 1e-12
    best = min(np.flatnonzero(close), key=lambda i: (np.count_nonzero(fits[i]), errors[i].mean()))
    return fits[best] / length


def fit(data):
    """(terms, their columns, coefficients) of the discrepancy; a term with a sign that physics forbids leaves the library."""
    pieces = [Piece(data, r) for r in data.runs if len(r.plant) >= ROWS or len(r.frames) >= ROWS]
    y = np.concatenate([np.concatenate(p.y) for p in pieces])
    runs = np.repeat(np.arange(len(pieces)), [sum(map(len, p.y)) for p in pieces])
    terms = library(data, pieces)
    while True:
        x = np.column_stack([c for _, _, c in terms])
        found = choose(x, y, runs)
        wrong = [i for i in np.flatnonzero(found) if found[i] < 0.0 and len(terms[i][0][0].signs) == 1]
        if not wrong:
            return terms, x, found
        terms = [t for i, t in enumerate(terms) if i not in wrong]


def _value(effect, at, share, off):
    """Parameter value that a coefficient means; a limit or a switch has the value at which its term was taken."""
    if effect.shape in ("limit", "switch"):
        return at
    value = off + share * (at - off)
    return max(1.0, round(value)) if effect.shape == "integer" else value


def diagnose(data):
    """[(names, value, standard error, None)], the largest contribution first."""
    terms, x, found = fit(data)
    live = np.flatnonzero(found)
    errors = np.sqrt(np.diag(np.linalg.pinv(x[:, live].T @ x[:, live])))
    rows, camera = {}, dict(data.camera)
    for i, error in sorted(zip(live, errors), key=lambda p: -abs(found[p[0]]) * np.linalg.norm(x[:, p[0]])):
        effects, at, _ = terms[i]
        first = effects[0]
        if first is CLOCK or first.name in rows:
            continue
        value = _value(first, at, found[i], data.off(first))
        error = error * abs(at - data.off(first)) if first.shape == "linear" else None
        rows[first.name] = ([e.name for e in effects], value, error, None)
        if first.side == "camera":
            camera[first.key] = value
    extras = counts.extras(data, camera) if camera == data.camera else counts.lost(data)  # a lens a little off scatters, too
    return [*rows.values(), *(([e.name], value, None, None) for e, value, _ in extras)]
