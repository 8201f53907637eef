"""Minimum detectable effects (MDE) and which effects look alike, from this program's own model.

For a setting, one run set of the nominal machine is simulated. A candidate's signature is the change it makes to
 - image: areas and centroids of frames re-rendered without noise at the true pose (needs camera rows);
 - plant: the angles over windows of 0.5 s replayed from a free start state under the logged torque;
 - torque: tau_applied, where it is logged.
Signatures are divided by the noise; what a start state (plant) or an unmeasured pose (image without encoders) could
explain is projected out. SNR(size) = length of that vector. MDE = the size at which SNR = THRESHOLD; for lens effects what a
slightly misplaced mount (MOUNT) could explain is projected out first, so their SNR at one MDE (`strength`) is larger. Two
effects are alike where the angle between their signatures is small: at a size m·MDE the part of the one that the other
cannot copy has SNR m·strength·sqrt(1 - cos²).
"""

import math
import tomllib
from pathlib import Path

import numpy as np

from . import camera as cam, dynamics as dyn
from .effects import BY_NAME
from .settings import ENCODER, LOGS, MIXES, TORQUE, Setting, apply, off_value, value_at

THRESHOLD = 6.0
THRESHOLD_LENS = 12.0  # for the effects in MOUNT: two honest renderers may differ by some 0.003 px; gives 2e-4 for k1, as comparable tools do
WINDOW = 0.5
COARSE = 1.0 / 480.0  # s, substep of the replays: only differences between replays count
EVERY = 4  # frames taken for the image part
MOUNT = {  # what is projected out before the MDE of an effect is taken
    **{f"camera.{k}": ("u0", "v0", "roll", "scale") for k in ("k1", "k2", "p1", "p2", "s1", "s2")},
    "camera.u0": ("v0", "roll", "scale"), "camera.v0": ("u0", "roll", "scale"), "camera.roll": ("u0", "v0", "scale"),
    "camera.scale": ("u0", "v0", "roll"), "camera.pan": ("v0", "roll", "scale"), "camera.tilt": ("u0", "roll", "scale"),
}
FILE = Path(__file__).with_name("mde.toml")
LATTICE = [(i / 4 / cam.HALF, j / 4 / cam.HALF) for i in range(4) for j in range(4)]  # places on a pixel, in units of u0 and v0
_NO_NOISE = np.zeros((3, cam.BOX, cam.BOX))


class Bench:
    """Base runs of a setting and the noise of what would be logged."""

    def __init__(self, setting):
        from .sets import Spec, simulate

        self.setting = setting
        self.spec = Spec(setting, part="mde", seed=7)
        self.runs = simulate(self.spec)
        self.plant, self.camera = setting.nominal()
        self.sd_q = ENCODER[setting.noise]
        self.image = setting.rig == "visual" and setting.logs in ("all", "image")
        if self.image:
            self._frames()
        self._windows()

    # ---- image -------------------------------------------------------------------------------------------------
    def _render(self, run, t, camera):
        seen = np.zeros((3, 3))
        cam.take(t, run.dt, run.nodes, len(run.times) - 1, cam.pack(camera), _NO_NOISE, seen)
        return seen.ravel()

    def _frames(self):
        self.frames, self.clean, rest = [], [], []
        for run in self.runs:
            for _, t, seen in run.frames[::EVERY]:
                if seen is None or t < 0.2:
                    continue
                clean = self._render(run, t, self.camera)
                rest.append(seen.ravel() - clean)
                self.frames.append((run, t))
                self.clean.append([self._render(run, t, {**self.camera, "u0": self.camera["u0"] + du, "v0": self.camera["v0"] + dv})
                                   for du, dv in LATTICE])
        self.sd_image = np.std(rest, axis=0) + 1e-3
        c = cam.pack(self.camera)
        self.white = []
        for run, t in self.frames:
            q = run.at([t])[0]
            jac = np.zeros((9, 2))
            for j in range(2):
                for sign in (1, -1):
                    qq = q[:2].copy()
                    qq[j] += sign * 1e-4
                    for i in range(3):
                        xy, px = np.zeros(2), np.zeros(2)
                        cam.centre(i, qq[0], qq[1], c, xy)
                        cam.to_pixel(xy[0], xy[1], c, px)
                        jac[3 * i + 1:3 * i + 3, j] += sign * px / 2e-4
            sd = self.sd_q if self.setting.logs == "all" else 1.0
            cov = np.diag(self.sd_image**2) + sd * sd * jac @ jac.T
            self.white.append(np.linalg.cholesky(np.linalg.inv(cov)).T)
        self.sd_estimate = float(np.std([r[4] for r in rest]) * math.sqrt(2) / 158.0)

    def image_signature(self, effect, camera):
        late = camera["T_delay"] - self.camera["T_delay"] if self.setting.logs == "all" else 0.0
        late -= self._middle(camera)  # an exposure: its blur alone, about the same middle; the rest is a delay (`signature`)
        rows = []
        for (run, t), cleans in zip(self.frames, self.clean):
            change = []
            for (du, dv), clean in zip(LATTICE, cleans):
                moved = {**camera, "u0": camera["u0"] + du, "v0": camera["v0"] + dv}
                seen = self._render(run, min(max(t - late, 0.0), run.times[-1]), moved)
                change.append(seen - clean if np.all(seen[::3] >= 1) else np.full(9, 10.0))
            rows.append(np.mean(change, axis=0))
        rows = self._smooth(np.array(rows), effect)
        out = np.concatenate([w @ row for w, row in zip(self.white, rows)]) * math.sqrt(EVERY)
        return np.zeros_like(out) if effect.key in ("sigma", "drop_rate") else out

    def _middle(self, camera):
        """By how much earlier than nominal the middle of the exposure lies, s."""
        return (camera["E_t"] - self.camera["E_t"]) / (2.0 * camera["omega_cam"])

    def _smooth(self, rows, effect):
        """What an effect does to a centroid is smooth over poses (and rates, where it is one of time); the rest of what a
        noiseless frame shows, even as a mean over places on the pixel, is the lattice, and would tell exact copies apart."""
        states = np.array([run.at([t])[0][:4] for run, t in self.frames])
        x = (states - states.mean(axis=0)) / (np.abs(states - states.mean(axis=0)).max(axis=0) + 1e-9)
        timed = effect.key in ("E_t", "T_delay")
        poses = [x[:, 0] ** i * x[:, 1] ** j for i in range(5) for j in range(5) if i + j <= (3 if timed else 4)]
        rates = [x[:, 2] ** i * x[:, 3] ** j for i in range(3) for j in range(3) if i + j <= 2]
        columns = [p * r for p in poses for r in rates] if timed else poses
        design = np.array(columns).T
        if len(rows) < 4 * design.shape[1]:
            return rows
        return design @ np.linalg.lstsq(design, rows, rcond=1e-6)[0]

    def count_signature(self, camera):
        """Effects that show in the scatter or in the missing rows, not in the mean: one entry each."""
        n = EVERY * len(self.frames)
        # measured: the scatter of circle 1 grows as sigma^0.45, of 2 and 3 hardly (pose noise); 0.15 stands for all nine
        scatter = 0.15 * math.log(camera["sigma"] / self.camera["sigma"]) * math.sqrt(2.0 * 9 * n)
        lost = n * camera["drop_rate"]  # a lost frame is seen for certain: six of them count as THRESHOLD
        return np.array([scatter, lost])

    # ---- plant -------------------------------------------------------------------------------------------------
    def _replay(self, run, plant, i0, i1, start):
        c = run.commands
        times = run.times[i0:i1 + 1]
        lead = max(0.0, times[0] - 0.3)
        p = dyn.pack(plant, COARSE)
        first = max(0, int(np.searchsorted(c[:, 0], lead)) - 2)
        last = int(np.searchsorted(c[:, 0], times[-1] + 1e-9))
        ct, cv, c1 = (np.ascontiguousarray(c[first:last, j]) for j in (0, 1, 3))
        a = np.zeros(2)
        warm = np.array([lead, times[0]])
        if times[0] > 0 and len(ct):
            a[:] = cv[0]
            dyn.simulate(np.zeros(6), a, warm, ct, cv, c1, len(ct), np.zeros(0), p, False, np.zeros((2, 5)))
        s = np.array([*start, start[1] - start[0], start[3] - start[2]])
        nodes = np.zeros((len(times), 5))
        dyn.simulate(s, a, times, ct, cv, c1, len(ct), np.zeros(0), p, True, nodes)
        return nodes

    def _windows(self):
        self.windows = []
        self.step = max(1, int(round(1.0 / (self.setting.plant_rate * self.runs[0].dt))))
        for run in self.runs:
            n = int(round(WINDOW / run.dt))
            for i0 in range(0, len(run.times) - n, n):
                start = run.nodes[i0, :4]
                base = self._replay(run, self.plant, i0, i0 + n, start)[::self.step]
                cols = []
                for j in range(4):
                    e = start.copy()
                    e[j] += 1e-5
                    cols.append(((self._replay(run, self.plant, i0, i0 + n, e)[::self.step] - base)[:, :2] / 1e-5).ravel())
                q, _ = np.linalg.qr(np.array(cols).T)
                self.windows.append((run, i0, i0 + n, start, base, q))

    def plant_signature(self, plant, camera):
        image_only = self.setting.logs == "image"
        sd = self.sd_estimate if image_only else self.sd_q
        late = camera["T_delay"] - self.camera["T_delay"] + (camera["E_t"] - self.camera["E_t"]) / 60.0
        rows = []
        for run, i0, i1, start, base, q in self.windows:
            new = base if plant == self.plant else self._replay(run, plant, i0, i1, start)[::self.step]
            d = (new - base)[:, :2].copy()
            if image_only:
                t = run.times[i0:i1 + 1:self.step]
                if late != 0.0:
                    d += run.at(np.maximum(t - late, 0.0))[:, :2] - run.at(t)[:, :2]
                d += self._estimate_error(run, t, camera)
            d = d.ravel()
            rows.append((d - q @ (q.T @ d)) / sd)
            if self.setting.applied:
                rows.append((new - base)[:, 4] / TORQUE[self.setting.noise])
        return np.concatenate(rows)

    def _estimate_error(self, run, t, camera):
        """Error of the angles that a distorted lens makes (geometric; zero for the nominal camera)."""
        if camera == self.camera:
            return 0.0
        c, c0 = cam.pack(camera), cam.pack(self.camera)
        out = np.zeros((len(t), 2))
        for k, q in enumerate(run.at(t)):
            angles = []
            for cc in (c, c0):
                px = np.zeros((3, 3))
                for i in range(3):
                    xy, p = np.zeros(2), np.zeros(2)
                    cam.centre(i, q[0], q[1], cc, xy)
                    cam.to_pixel(xy[0], xy[1], cc, p)
                    px[i, 1:] = p
                angles.append(cam.estimate(px, self.camera["roll"]))
            out[k] = np.subtract(angles[0], angles[1])
        return out

    # ---- both --------------------------------------------------------------------------------------------------
    def _delayed(self, by):
        """A delay of the picture, s: that of T_delay's own probe, scaled. Two renderings that are shifted by different times
        differ by the lattice, which would tell an exposure from a delay where nothing else does."""
        effect = BY_NAME["camera.T_delay"]
        late = {**self.camera, "T_delay": self.camera["T_delay"] + effect.probe}
        return self.image_signature(effect, late) * (by / effect.probe)

    def signature(self, name, value):
        effect = BY_NAME[name]
        plant, camera = dict(self.plant), dict(self.camera)
        apply(name, value, plant, camera)
        parts = []
        if self.image:
            moved = effect.side == "camera"
            image = self.image_signature(effect, camera) if moved else np.zeros(9 * len(self.frames))
            if effect.key == "E_t":
                image = image + self._delayed(self._middle(camera))
            parts.append(image)
            parts.append(self.count_signature(camera))
        # what a start state can explain is projected out to first order only: take the slope near zero. With 1 % of a theta,
        # the second order told exact copies apart (theta_1 from theta_2 by 93 sqrt(1 - 0.9993^2) = 3.4 instead of 0.5)
        small = {"limit": 1.0, "switch": 1.0}.get(effect.shape, 1e-3)
        if effect.key in ("T_act", "tau_delay", "T_delay", "E_t"):
            small = 0.05  # shifts of commands by less than a substep of the replays
        off = off_value(effect, self.setting)
        apply(name, off + small * (value - off), plant, camera)
        parts.append(self.plant_signature(plant, camera) / small)
        return np.nan_to_num(np.concatenate(parts), nan=0.0, posinf=0.0, neginf=0.0)


def _cosine(a, b):
    return float(a @ b / (np.linalg.norm(a) * np.linalg.norm(b) + 1e-300))


def _without(v, others):
    """The part of v that the others cannot explain."""
    if not others:
        return v
    basis = np.linalg.qr(np.array(others).T)[0]
    return v - basis @ (basis.T @ v)


def study(setting):
    """Per candidate: {"mde", "strength", "alike": {other: cos}, "alike_wide": {...}} (wide: the principal point free)."""
    bench = Bench(setting)
    sizes, vectors, limits = {}, {}, {}
    for e in setting.candidates():
        size = e.probe
        if e.key.startswith("theta"):
            size = 0.01 * abs(off_value(e, setting))
        if e.shape == "limit":
            peak = max(np.abs(r.commands[:, 1]).max() for r in bench.runs)
            steps = max(np.abs(np.diff(r.commands[:, 1])).max() for r in bench.runs)
            grid = np.geomspace(0.05, 1.2, 10) * peak if e.key == "tau_max" else np.geomspace(5.0, 20000.0, 12) * steps
            limits[e.name] = _limits(bench, e.name, grid)
            size = limits[e.name][0]
            if not size:
                continue
        v = bench.signature(e.name, value_at(e, setting, size))
        if np.linalg.norm(v) > 1e-9:
            sizes[e.name], vectors[e.name] = size, v
    table = {}
    for name, v in vectors.items():
        clear = _without(v, [vectors[f"camera.{k}"] for k in MOUNT.get(name, ()) if f"camera.{k}" in vectors])
        threshold = THRESHOLD_LENS if name in MOUNT else THRESHOLD
        factor = 1.0 if name in limits else threshold / np.linalg.norm(clear)
        table[name] = {"mde": sizes[name] * factor, "strength": float(np.linalg.norm(v) * factor), **_alike(name, vectors)}
        if name in limits:
            table[name]["at"] = limits[name]
    return table


def _alike(name, vectors):
    v, alike, wide = vectors[name], {}, {}
    free = [vectors[n] for n in ("camera.u0", "camera.v0") if n in vectors and n != name]
    basis = np.linalg.qr(np.array(free).T)[0] if free else None
    a = v - basis @ (basis.T @ v) if free else v
    for other, w in vectors.items():
        if other == name:
            continue
        cos = _cosine(v, w)
        if abs(cos) > 0.5:
            alike[other] = round(cos, 7)
        if free and name.startswith("camera.") and other.startswith("camera."):
            b = w - basis @ (basis.T @ w)
            rest = np.linalg.norm(a) / np.linalg.norm(v)
            shared = _cosine(a, b) if np.linalg.norm(b) > 1e-6 * np.linalg.norm(w) else 0.0
            rest *= math.sqrt(max(0.0, 1.0 - shared**2))
            cos = math.copysign(math.sqrt(max(0.0, 1.0 - rest * rest)), cos)
            if abs(cos) > 0.5 and abs(shared) > 0.9:  # the other adds to what the principal point alone explains
                wide[other] = round(cos, 7)
    return {"alike": alike, "alike_wide": wide}


def _limits(bench, name, grid, multiples=(1.0, 3.0, 10.0)):
    """Limits whose signatures reach multiples of the threshold (grid, then bisection); 0 where none does."""

    def strong(x, m):
        return np.linalg.norm(bench.signature(name, x)) > m * THRESHOLD

    snr = np.array([np.linalg.norm(bench.signature(name, x)) for x in grid])
    found = []
    for m in multiples:
        above = np.flatnonzero(snr > m * THRESHOLD)
        if len(above) == 0 or above[-1] == len(grid) - 1:
            found.append(0.0)
            continue
        lo, hi = grid[above[-1]], grid[above[-1] + 1]
        for _ in range(6):
            mid = math.sqrt(lo * hi)
            lo, hi = (mid, hi) if strong(mid, m) else (lo, mid)
        found.append(float(lo))
    return found


# ---- the table file ------------------------------------------------------------------------------------------------
_CACHE = {}


def load():
    if not _CACHE and FILE.exists():
        _CACHE.update(tomllib.loads(FILE.read_text())["setting"])
    return _CACHE


def of(setting):
    """Table of a setting: from mde.toml, else computed now."""
    table = load()
    if setting.key not in table:
        table[setting.key] = study(setting)
    return table[setting.key]


def save(tables, path=FILE):
    rows = ["# Generated by `python -m hidden mde`: minimum detectable effects and look-alikes per setting (see mde.py).",
            f"# SNR threshold {THRESHOLD} ({THRESHOLD_LENS} for lens and mount); units as in NOTATION.md; for limits (tau_max, dtau_max) the largest limit seen."]
    for key in sorted(tables):
        for name, entry in tables[key].items():
            def inline(d):
                return "{" + ", ".join(f'"{k}" = {v!r}' for k, v in d.items()) + "}"
            rows += ["", f'[setting."{key}"."{name}"]', f"mde = {float(entry['mde']):.4g}",
                     f"strength = {float(entry['strength']):.4g}",
                     *([f"at = [{', '.join(f'{x:.5g}' for x in entry['at'])}]"] if "at" in entry else []),
                     f"alike = {inline(entry['alike'])}", f"alike_wide = {inline(entry['alike_wide'])}"]
    new = Path(path).with_suffix(".part")
    new.write_text("\n".join(rows) + "\n")
    new.replace(path)


def every_setting():
    """Settings that the parts use, and for which the table file is made."""
    chosen = [Setting("visual", logs, noise, mix) for noise in ENCODER for logs in LOGS["visual"] for mix in MIXES["visual"]]
    chosen += [Setting("hang", "plant", noise, mix, arm) for noise in ENCODER
               for mix, arm in (("mixed", 0), ("free", 1), ("gentle", 0))]
    chosen += [Setting("balance", "plant", noise, mix, arm) for noise in ENCODER for mix, arm in (("mixed", 0), ("slow", 1))]
    mid = Setting()
    chosen += [mid.with_(applied=True), mid.with_(logs="plant", applied=True), mid.with_(logs="image", turned=True),
               mid.with_(turned=True), mid.with_(mix="lively", velocity_nominal=False), mid.with_(exposure=0.5),
               mid.with_(exposure=0.25), Setting("hang", "plant", applied=True),
               Setting("hang", "plant", velocity_nominal=False), Setting("hang", "plant", arm=1)]
    return sorted(chosen, key=lambda s: s.noise != "mid")


def make_table(jobs=1, path=FILE):
    """Computes what the table file lacks, saving after each setting."""
    from concurrent.futures import ProcessPoolExecutor

    tables = dict(load())
    missing = [s for s in every_setting() if s.key not in tables]
    with ProcessPoolExecutor(jobs) as pool:
        for setting, table in zip(missing, pool.map(study, missing)):
            tables[setting.key] = table
            save(tables, path)
            print(setting.key, flush=True)
