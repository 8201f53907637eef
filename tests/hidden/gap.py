"""The gap, computed again: the product's plant and camera units, called by FMPy with the values of `amended.toml`, against the logs.

Nothing of the diagnosis is used but the file that it wrote. Windows of half a second with a start state fitted to the encoders; frames are
rendered where the fitted window has the arm. What is claimed (torques, or pixels) is held against what shows here (angles, or pixels):
another quantity for a plant, but the same share. Sets without encoders, and amended models with a correction, are left out.
"""

import tomllib
from pathlib import Path

import numpy as np

from .rivals import data as rival
from .rivals.image import Unpredictable
from .rivals.units import Units

WINDOWS = 60  # of a set at most, evenly chosen
WIDTH = 0.5  # s
ROUNDS = 20  # Gauss-Newton for a start state, at most
HALVINGS = 8  # of one of its steps, at most
SETTLED = 1.0 - 1e-4  # share of the squares that a step leaves, beyond which the start state is found
STEPS = np.array([1e-5, 1e-5, 1e-4, 1e-4])
LOST = 0.5  # rad: a window that strays so far says nothing of a share
ABOVE = 1.05  # a gap must stand so far above the floor, as in the contract's null


def amended(file):
    """Values of the units `plant` and `camera` in a scenario; None if it has a unit that this can't run."""
    units = {u["name"]: u for u in tomllib.loads(Path(file).read_text())["units"]}
    if any(u["fmu"].endswith("acrobot_residual.fmu") for u in units.values()):
        return None
    return [units.get(name, {}).get("set", {}) for name in ("plant", "camera")]


def _with(nominal, given):
    return {**nominal, **{k: float(v) for k, v in given.items() if isinstance(v, (int, float)) and k in nominal}}


def _windows(data):
    every = []
    for k, run in enumerate(data.runs):
        times = run.plant_time
        for begin in np.arange(times.min(), times.max(), WIDTH) if len(times) else ():
            rows = np.flatnonzero((times >= begin) & (times < begin + WIDTH) & np.isfinite(run.plant[:, :2]).all(axis=1))
            frames = np.flatnonzero((run.frame_time >= begin + 0.15) & (run.frame_time < begin + WIDTH))
            if len(rows) >= 6:
                every.append((k, rows, frames))
    return every[:: max(1, -(-len(every) // WINDOWS))]


def _replayed(data, world, plant, camera, window, start, frames):
    k, rows, seen = window
    run = data.runs[k]
    late = camera["T_delay"] + 0.5 * camera["E_t"] / camera["omega_cam"]
    begin = run.plant_time[rows[0]] - 0.1
    times = np.concatenate([run.plant_time[rows], run.frame_time[seen] - late if frames else []])
    order, back = np.unique(np.concatenate([[begin], np.maximum(times, begin)]), return_inverse=True)
    nodes = world.replay(plant)(run.commands, order, start)[back[1:]]
    return nodes[: len(rows)], nodes[len(rows) :]


def _nearest(left, start):
    """Gauss-Newton for the start state that leaves least; None where columns aren't finite.

    A step counts only if less is left, else it is halved: where an arm tumbles, a whole one leads a window far away from its log.
    """
    rest = left(start)
    for _ in range(ROUNDS):
        columns = np.stack([(rest - left(start + s * e)).ravel() / s for s, e in zip(STEPS, np.eye(4))], axis=1)
        if not np.isfinite(columns).all():
            return None
        step = np.linalg.lstsq(columns, rest.ravel(), rcond=None)[0]
        shorter = ((start + step / 2**k) for k in range(HALVINGS))
        better = next(((at, there) for at in shorter if np.sum((there := left(at))**2) < np.sum(rest**2)), None)
        if better is None:
            break
        done = np.sum(better[1]**2) > SETTLED * np.sum(rest**2)
        start, rest = better
        if done:
            break
    return start


def _fitted(data, world, plant, camera, window):
    """What is left of the angles once the start state is fitted, and the poses at the frames; None where the window strays."""
    k, rows, _ = window
    run = data.runs[k]
    t, q = run.plant_time[rows[:5]], run.plant[rows[:5], :2]
    slope = np.polyfit(t - t[0], q, 1)
    start = np.concatenate([slope[1] - 0.1 * slope[0], slope[0]])
    try:
        start = _nearest(lambda at: run.plant[rows, :2] - _replayed(data, world, plant, camera, window, at, False)[0][:, :2], start)
        if start is None:
            return None
        nodes, poses = _replayed(data, world, plant, camera, window, start, True)
    except (Unpredictable, np.linalg.LinAlgError):
        return None
    rest = run.plant[rows, :2] - nodes[:, :2]
    return (rest, poses) if np.isfinite(rest).all() and np.abs(rest).max() < LOST else None


def _left(data, world, plant, camera):
    """By window: rest of the angles, and of the centroids (frames x 6)."""
    out = []
    for window in _windows(data):
        fitted = _fitted(data, world, plant, camera, window)
        if fitted is None:
            out.append(None)
            continue
        rest, poses = fitted
        seen = data.runs[window[0]].frames[window[2]]
        drawn = world.noisy(poses, camera).reshape(-1, 3, 3) if len(seen) else np.zeros((0, 3, 3))
        out.append((rest, (seen - drawn)[:, :, 1:].reshape(len(seen), 6)))
    return out


def _rms(parts):
    values = np.concatenate([p.ravel() for p in parts]) if parts else np.zeros(0)
    values = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(values**2))) if len(values) else None


def _scatter(parts):
    """Noise of neighbouring frames: what a straight line through three leaves of the middle one."""
    second = [(p[2:] - 2 * p[1:-1] + p[:-2]) / np.sqrt(6.0) for p in parts if len(p) > 2]
    return _rms(second)


def closed(before, after, floor):
    if None in (before, after, floor) or before <= ABOVE * floor:
        return None
    return min(1.0, 1.0 - (after**2 - floor**2) / (before**2 - floor**2))


def hidden(answer, plant, camera):
    """Both units with what was hidden in the set; None where that has no name."""
    if "effect" not in answer:
        return None
    values = {e["name"]: e["value"] for e in answer["effect"]}
    of = {side: {n.split(".", 1)[1]: v for n, v in values.items() if n.startswith(side + ".")} for side in ("plant", "camera")}
    return _with(plant, of["plant"]), _with(camera, of["camera"])


def _stated_angle(data, windows):
    """rms that the encoders' stated noise leaves; four start values of a window are fitted."""
    stated = [data.noise.get(k) for k in ("q1", "q2")]
    share = np.mean([1.0 - 4.0 / rest.size for rest, _ in windows])
    return float(np.sqrt(np.mean(np.square(stated)) * share)) if all(stated) else None


def check(folder, diagnosed, units, answer):
    """{unit: share closed} of one set by an independent run of `amended.toml`, or None where this can't say.

    The floor is what the hidden effects themselves leave, by the same windows, so that a model with the truth in it closes
    all. Where what was hidden has no name it is the stated noise, or the scatter of neighbouring frames.
    """
    values = amended(Path(diagnosed) / "amended.toml")
    if values is None:
        return None
    world = Units(units)
    data = rival.load(folder, world=world)
    if not data.has_plant:
        return None
    models = [(data.plant, data.camera), (_with(data.plant, values[0]), _with(data.camera, values[1]))]
    truth = hidden(answer, data.plant, data.camera)
    left = [_left(data, world, *model) for model in models + ([truth] if truth else [])]
    kept = [windows for windows in zip(*left) if all(w is not None for w in windows)]
    if not kept:
        return None
    before, after, *best = ([w[k] for w in kept] for k in range(len(left)))
    angles, pictures = ([[w[k] for w in model] for model in (before, after, *best)] for k in (0, 1))
    floor = _rms(angles[2]) if truth else _stated_angle(data, before)
    result = {"N·m": closed(_rms(angles[0]), _rms(angles[1]), floor)}
    if data.has_frames:
        floor = _rms(pictures[2]) if truth else min((f for f in map(_scatter, pictures) if f is not None), default=None)
        result["px"] = closed(_rms(pictures[0]), _rms(pictures[1]), floor)
    return result
