"""A plain search by BIC: candidates are added one at a time while the Bayesian information criterion falls.

Data: every logged column over windows with a free start state. Noise: Gaussian, one level per column, estimated with the
model. A candidate is screened by its slope, the best few are refitted (Gauss-Newton on starts and parameters together).
Candidates within 2 of the best one's criterion are named beside it (Kass and Raftery: no more than a bare mention). It is
`none` where nothing lowers the criterion; strangers it does not know.
"""

import math

import numpy as np

from . import counts
from .data import CLOCK, trials
from .image import Unpredictable
from .windows import GROUPS, Columns, Lattice, Model, Windows, changed, continuous, value_of

BEST = 4  # candidates refitted per round,
NEAR = 6.0  # as long as their slope promises no worse than this
ROUNDS = 3  # effects at most
ANCHORS = 3  # renewals of the lattice
NEARLY = 0.8  # share of the best fall from which a candidate is compared with the lattice renewed
TIE = 2.0  # of the criterion, within which two candidates are not told apart
ENOUGH = 0.1  # gain of the last step
STEPS = 25  # of Gauss-Newton at most


class Linear:
    """Least squares about one model: whitened, with each window's start state projected out."""

    def __init__(self, windows, columns, sd=None):
        self.windows, self.columns = windows, columns
        rest = windows.measured - columns.base
        self.good = np.isfinite(rest) & np.all(np.isfinite(columns.states), axis=1)
        self.count = np.bincount(windows.groups[self.good], minlength=len(GROUPS))
        self.raw = np.where(self.good, rest, 0.0)
        self.sd = self._levels(self.raw**2) if sd is None else sd
        self.weight = np.where(self.good, 1.0 / self.sd[windows.groups], 0.0)
        self.basis, self.solve = [], []
        for cut in windows.cuts:
            s = np.nan_to_num(columns.states[cut.place]) * self.weight[cut.place, None]
            scale = np.linalg.norm(s, axis=0) + 1e-300
            u, d, vt = np.linalg.svd(s / scale, full_matrices=False)
            keep = d > 1e-9 * d[0]
            self.basis.append(u[:, keep])
            self.solve.append(((vt[keep].T / d[keep]) @ u[:, keep].T) / scale[:, None])
        self.y = self.project(self.raw)

    def _levels(self, squares):
        total = np.bincount(self.windows.groups, weights=squares, minlength=len(GROUPS))
        return np.sqrt(np.maximum(total, 1e-24) / np.maximum(self.count, 1))

    def project(self, column):
        out = np.nan_to_num(column, nan=0.0) * self.weight
        for cut, u in zip(self.windows.cuts, self.basis):
            part = out[cut.place]
            out[cut.place] = part - u @ (u.T @ part)
        return out

    def levels(self, rest):
        """Noise levels that a projected rest leaves."""
        return self._levels((rest * self.sd[self.windows.groups]) ** 2)

    def criterion(self, rest, k):
        if self.count.sum() < 0.95 * np.isfinite(self.windows.measured).sum():
            return math.inf  # a model that cannot follow the windows at all
        used = self.count > 0
        level = self.levels(rest)[used]
        return float(2.0 * np.sum(self.count[used] * np.log(level)) + k * math.log(self.count.sum()))

    def starts(self, rest_raw):
        """Corrections of the start states for a raw rest."""
        whole = np.nan_to_num(rest_raw) * self.weight
        return np.array([m @ whole[cut.place] for cut, m in zip(self.windows.cuts, self.solve)])


def _solve(known, column, y):
    """Coefficient of the column beside the known ones, and what stays of y."""
    x = known if column is None else np.column_stack([known, column])
    scale = np.linalg.norm(x, axis=0) + 1e-300
    beta = np.linalg.lstsq(x / scale, y, rcond=1e-10)[0] / scale
    return (beta[-1] if column is not None else None), y - x @ beta


class Search:
    def __init__(self, data):
        self.data = data
        self.windows = Windows(data)
        self.effects = [e for e in data.candidates if e.shape in ("linear", "limit", "integer", "switch")]
        if data.has_frames and data.has_plant:
            self.effects.append(CLOCK)

    def off(self, effect):
        return 0.0 if effect is CLOCK else self.data.off(effect)

    def allowed(self, effect, value):
        """What physics has room for; an infinite inertia would explain that nothing moves."""
        if effect.key == "E_t":
            return self.off(effect) <= value <= 1.0
        if effect.key.startswith("theta") or effect.key in ("k_tau", "scale"):
            return 0.5 < value / self.off(effect) < 2.0
        if effect.key == "I_rotor":
            return 0.0 <= value <= self.data.plant["theta_1"]
        one_sided = len(effect.signs) == 1 and effect.shape == "linear"
        return value >= self.off(effect) if one_sided else True

    def settle(self, model, chosen, lattice=None):
        """Gauss-Newton on the starts and the chosen parameters: (model, its linearisation, its criterion)."""
        free = [e for e in chosen if continuous(e)]
        best, sd, damp, slopes = None, None, 1.0, []
        for _ in range(STEPS):
            try:
                columns = Columns(self.windows, model, lattice)
                linear = Linear(self.windows, columns, sd)
                value = linear.criterion(linear.y, len(chosen))
            except Unpredictable:
                linear, value = None, np.inf
            if best is None and linear is None:
                return model, None, np.inf
            gain = np.inf if best is None else best[2] - value
            if gain > 0.0:
                best, damp, sd = (model, linear, value), 1.0, linear.levels(linear.y)
                slopes = [columns.slope(e, self.off(e)) for e in free]
            else:
                damp *= 0.3
            if abs(gain) < ENOUGH or damp < 0.05:
                break
            model = self._step(best, free, slopes, damp)
        return best

    def _step(self, best, free, slopes, damp):
        model, linear, _ = best
        rest, beta = linear.raw, np.zeros(0)
        if free:
            x = np.column_stack([linear.project(s) for s in slopes])
            beta = damp * np.linalg.lstsq(x, linear.y, rcond=None)[0]
            rest = linear.raw - np.nan_to_num(np.column_stack(slopes)) @ beta
        new = Model(model.plant, model.camera, model.starts + linear.starts(rest), model.clock)
        for e, b in zip(free, beta):
            value = value_of(model, e) + b
            if e.shape == "limit":
                value = max(value, 0.3 * value_of(model, e))
            elif not self.allowed(e, value):
                value = 1.0 if e.key == "E_t" and value > 1.0 else self.off(e)
            new = changed(new, e, value)
        return new

    def anchored(self, model, chosen):
        """The same with the pixel lattice taken at the poses found, again and again."""
        found = self.settle(model, chosen)
        for _ in range(ANCHORS if self.data.has_frames else 0):
            found = self.settle(found[0], chosen, Lattice(found[1].columns.poses, found[0].camera, self.data.world))
        return found

    def screen(self, linear, chosen):
        """(criterion, effect, value) of every candidate by its slope or its trial values, best first."""
        columns, found = linear.columns, []
        model = columns.model
        known = [linear.project(columns.slope(e, self.off(e))) for e in chosen if continuous(e)]
        known = np.column_stack(known) if known else np.zeros((len(linear.y), 0))
        for e in self.effects:
            if e in chosen:
                continue
            if e.shape == "linear":
                beta, rest = _solve(known, linear.project(columns.slope(e, self.off(e))), linear.y)
                if self.allowed(e, value_of(model, e) + beta):
                    found.append((linear.criterion(rest, len(chosen) + 1), e, value_of(model, e) + beta))
                continue
            for value in trials(e, self.off(e), self.data):
                _, rest = _solve(known, None, linear.y - linear.project(columns.difference(e, value)))
                found.append((linear.criterion(rest, len(chosen) + 1), e, value))
        return sorted(found, key=lambda f: f[0])

    def pruned(self, found, chosen):
        """Drops what an effect found later has made needless."""
        for e in chosen[:-1]:
            new = self.anchored(changed(found[0], e, self.off(e)), [c for c in chosen if c is not e])
            if new[2] < found[2]:
                chosen.remove(e)
                found = new
        return found

    def run(self):
        """(model, its linearisation, effects in the order found, (those tied with it, BIC weight) of each in its round)."""
        start = Model(self.data.plant, self.data.camera, self.windows.guess(self.data.camera))
        model, linear, value = self.anchored(start, [])
        chosen, beside = [], {}
        while len(chosen) < ROUNDS:
            tried = {}
            for guess, e, at in self.screen(linear, chosen):
                promising = len(tried) < BEST and guess < value + NEAR
                if e not in tried and (promising or e.shape == "switch"):  # a switch has no slope that could promise
                    tried[e] = self.settle(changed(model, e, at), [*chosen, e], linear.columns.lattice)
            falls = {e: value - new[2] for e, new in tried.items()}
            best = max(falls.values(), default=0.0)
            if best <= 0.0:
                break
            found = {e: self.anchored(tried[e][0], [*chosen, e]) for e, fall in falls.items() if fall > NEARLY * best}
            falls |= {e: value - new[2] for e, new in found.items()}
            chosen.append(min(found, key=lambda e: found[e][2]))
            behind = {e: falls[chosen[-1]] - fall for e, fall in falls.items()}
            ties = [e for e in sorted(behind, key=behind.get) if e is not chosen[-1] and behind[e] < TIE]
            weight = 1.0 / sum(math.exp(-0.5 * max(b, -100.0)) for b in (*behind.values(), falls[chosen[-1]]))
            beside[chosen[-1]] = ties, weight
            model, linear, value = self.pruned(found[chosen[-1]], chosen)
        return model, linear, chosen, beside


def standard_errors(linear, effects, off):
    """Standard errors of the continuous ones, by effect."""
    free = [e for e in effects if continuous(e)]
    if not free:
        return {}
    x = np.column_stack([linear.project(linear.columns.slope(e, off(e))) for e in free])
    return dict(zip(free, np.sqrt(np.diag(np.linalg.pinv(x.T @ x)))))


def diagnose(data):
    """[(names, value, standard error, probability)] in the order found."""
    search = Search(data)
    model, linear, chosen, beside = search.run()
    errors = standard_errors(linear, chosen, search.off)
    found = []
    for e in chosen:
        ties, weight = beside[e]
        if e is not CLOCK:
            names = [e.name, *(t.name for t in ties if t is not CLOCK and t not in chosen)]
            found.append((names, value_of(model, e), errors.get(e), weight))
    rest = counts.extras(data, model.camera)
    return found + [([e.name], value, None, 1.0 - math.exp(-0.5 * fall)) for e, value, fall in rest]
