"""Builds one data set: truth -> logs -> folder (docs/data-set.md) and, elsewhere, answer.toml."""

import hashlib
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from . import control, dynamics as dyn, loop
from .effects import UNKNOWN
from .settings import ENCODER, TORQUE, Setting, apply, off_value
from .effects import BY_NAME

SALT = "acroscope-hidden-1"
_LAWS = {}


@dataclass
class Spec:
    """A hidden case. effects: [(name, value, size in MDE)], unknown: (name, size) or None."""

    setting: Setting
    effects: list = field(default_factory=list)
    unknown: tuple = None
    part: str = "one"
    seed: int = 0
    jitter: float = 0.0  # s, timestamps
    clock_offset: float = 0.0  # s, plant log against the others (a nuisance, not an effect)
    rates: bool = False  # dq1, dq2 logged too
    note: dict = field(default_factory=dict)

    def name(self, salt=SALT):
        text = f"{salt}|{self.part}|{self.seed}|{self.setting}|{self.effects}|{self.unknown}|{self.note}"
        return "set-" + hashlib.sha256(text.encode()).hexdigest()[:10]


def generator(spec, what, salt=SALT):
    digest = hashlib.sha256(f"{salt}|{spec.name(salt)}|{what}".encode()).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))


def law_for(plant):
    key = tuple(sorted(plant.items()))
    if key not in _LAWS:
        _LAWS[key] = control.Pseudolinear(plant)
    return _LAWS[key]


def truth(spec):
    """The true plant and camera."""
    plant, camera = spec.setting.nominal()
    for name, value, _ in spec.effects:
        apply(name, value, plant, camera)
    if spec.unknown:
        key, size = UNKNOWN[spec.unknown[0]][0], spec.unknown[1]
        if key in plant:
            plant[key] = size
        elif key in camera:
            camera[key] = size
    return plant, camera


def simulate(spec, salt=SALT):
    setting = spec.setting
    plant, camera = truth(spec)
    nominal, seen_as = setting.nominal()
    runs = []
    for i, kind in enumerate(setting.excitations):
        rng = generator(spec, f"run{i}", salt)
        if setting.rig == "visual":
            runs.append(loop.visual(kind, plant, camera, law_for(nominal), rng, setting.duration, seen_as["roll"]))
        elif setting.rig == "hang":
            runs.append(loop.hanging(kind, plant, rng, setting.duration, setting.plant_rate))
        else:
            runs.append(loop.balancing(kind, plant, nominal, rng, setting.duration, setting.plant_rate,
                                       ENCODER[setting.noise]))
    return runs


def biting(spec, salt=SALT):
    """Runs in which a ceiling of the torque cuts something: it was sized on other runs, and lies above every torque at times."""
    runs = simulate(spec, salt)
    for i, (name, value, size) in enumerate(spec.effects):
        top = max(float(np.max(np.abs(run.commands[:, 1]))) for run in runs)
        if name == "plant.tau_max" and top <= value:
            spec.effects[i] = (name, float(f"{0.8 * top:.4g}"), size)
            return simulate(spec, salt)
    return runs


def applied_at(run, plant, times):
    """Torque after the actuator at given times (the actuator does not depend on the motion)."""
    c = run.commands
    grid = np.concatenate([[0.0], times]) if times[0] > 0 else np.asarray(times, float)
    nodes = np.zeros((len(grid), 5))
    dyn.simulate(np.zeros(6), np.zeros(2), grid, c[:, 0].copy(), c[:, 1].copy(), c[:, 3].copy(), len(c),
                 np.zeros(0), dyn.pack(plant), False, nodes)
    return nodes[-len(times):, 4]


def _stamps(t, jitter, rng):
    if jitter <= 0.0:
        return t
    late = np.abs(rng.normal(0.0, jitter, len(t)))
    late[rng.random(len(t)) < 0.01] += 4 * jitter
    stamp = t + late
    for i in range(1, len(stamp)):
        stamp[i] = max(stamp[i], stamp[i - 1] + 1e-6)  # rows are ordered
    return stamp


def plant_log(spec, run, plant, rng):
    s = spec.setting
    end = run.times[-1]
    t = np.arange(int(end * s.plant_rate + 1e-6) + 1) / s.plant_rate
    x = run.at(t)
    sd = ENCODER[s.noise]
    columns = [x[:, 0] + sd * rng.standard_normal(len(t)), x[:, 1] + sd * rng.standard_normal(len(t))]
    names = ["q1", "q2"]
    if spec.rates:
        names += ["dq1", "dq2"]
        columns += [x[:, 2] + 0.02 * rng.standard_normal(len(t)), x[:, 3] + 0.02 * rng.standard_normal(len(t))]
    if s.applied:
        names.append("tau_applied")
        columns.append(applied_at(run, plant, t) + TORQUE[s.noise] * rng.standard_normal(len(t)))
    stamp = t.copy()
    if spec.unknown and spec.unknown[0] == "unknown.clock_drift":
        stamp = stamp * (1.0 + spec.unknown[1])
    stamp = _stamps(stamp + max(spec.clock_offset, 0.0), spec.jitter, rng)
    rows = ["time," + ",".join(names)]
    for i in range(len(t)):
        rows.append(f"{stamp[i]:.9g}," + ",".join(f"{c[i]:.7f}" for c in columns))
    return rows


def camera_log(run, rng, late, jitter):
    rows = ["time,frame,u1,v1,u2,v2,u3,v3,area1,area2,area3,valid"]
    stamp = _stamps(np.array([f[0] for f in run.frames]) + late, jitter, rng)
    for k, (_, _, seen) in enumerate(run.frames):
        if seen is None:
            rows.append(f"{stamp[k]:.9g},{k}," + "," * 8 + ",0")
        else:
            uv = ",".join(f"{seen[i, 1]:.6f},{seen[i, 2]:.6f}" for i in range(3))
            rows.append(f"{stamp[k]:.9g},{k},{uv}," + ",".join(f"{int(a)}" for a in seen[:, 0]) + ",1")
    return rows


def controller_log(run, pinned, rng, late, jitter):
    c = run.commands
    stamp = _stamps(c[:, 0] + late, jitter, rng)
    if pinned:
        return ["time,tau,tau_1"] + [f"{t:.9g},{r[1]:.9g},{r[3]:.9g}" for t, r in zip(stamp, c)]
    return ["time,tau,z_desired"] + [f"{t:.9g},{r[1]:.9g},{r[2]:.9g}" for t, r in zip(stamp, c)]


def toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return '"' + value.replace('"', '\\"') + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(v) for v in value) + "]"
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(int(value))


def write(spec, out, answers, runs=None, salt=SALT, extra=None):
    """Writes the data set folder and its answer; returns the folder's name."""
    runs = runs if runs is not None else biting(spec, salt)
    plant, _ = truth(spec)
    s = spec.setting
    name = spec.name(salt)
    folder = Path(out) / name
    folder.mkdir(parents=True, exist_ok=True)
    late = max(-spec.clock_offset, 0.0)
    head = ["format = 1", 'scenario = "visual-servo"', "", "[set]"]
    head += [f'"{k}" = {toml(v)}' for k, v in s.declared().items()]
    noise = {}
    if s.logs != "image":
        noise = {"plant.q1": ENCODER[s.noise], "plant.q2": ENCODER[s.noise]}
        if spec.rates:
            noise |= {"plant.dq1": 0.02, "plant.dq2": 0.02}
        if s.applied:
            noise["plant.tau_applied"] = TORQUE[s.noise]
    if noise:
        head += ["", "[noise]"] + [f'"{k}" = {toml(v)}' for k, v in noise.items()]
    for i, run in enumerate(runs):
        sub = folder / f"run-{i + 1:02d}"
        sub.mkdir(exist_ok=True)
        rng = generator(spec, f"log{i}", salt)
        logs = {"controller.csv": controller_log(run, s.rig != "visual", rng, late, spec.jitter)}
        if s.logs in ("all", "plant"):
            logs["plant.csv"] = plant_log(spec, run, plant, rng)
        if s.logs in ("all", "image"):
            logs["camera.csv"] = camera_log(run, rng, late, spec.jitter)
        for file, rows in logs.items():
            (sub / file).write_text("\n".join(rows) + "\n")
        head += ["", "[[run]]", f'dir = "run-{i + 1:02d}"', f'excitation = "{run.kind}"']
    (folder / "dataset.toml").write_text("\n".join(head) + "\n")
    where = Path(answers) / name
    where.mkdir(parents=True, exist_ok=True)
    (where / "answer.toml").write_text("\n".join(answer(spec, runs, extra or {})) + "\n")
    return name


def answer(spec, runs, extra):
    verdict = "unknown" if spec.unknown else ("named" if spec.effects else "none")
    rows = [f'part = "{spec.part}"', f'verdict = "{verdict}"', f"seed = {spec.seed}",
            f'setting = "{spec.setting.key}"', f'rig = "{spec.setting.rig}"', f'logs = "{spec.setting.logs}"',
            f'noise = "{spec.setting.noise}"', f'mix = "{spec.setting.mix}"', f"arm = {spec.setting.arm}",
            f"applied = {toml(spec.setting.applied)}", f"turned = {toml(spec.setting.turned)}",
            f"velocity_nominal = {toml(spec.setting.velocity_nominal)}", f"exposure = {spec.setting.exposure!r}",
            f"jitter = {spec.jitter!r}",
            f"clock_offset = {spec.clock_offset!r}", f"fell = {toml([bool(r.fell) for r in runs])}",
            f"length = {toml([round(float(r.times[-1]), 3) for r in runs])}"]
    rows += [f"{k} = {toml(v)}" for k, v in spec.note.items()]
    if spec.unknown:
        rows += ["", "[unknown]", f'name = "{spec.unknown[0]}"', f"size = {spec.unknown[1]!r}"]
        rows += [f"{k} = {toml(v)}" for k, v in extra.get("unknown", {}).items()]
    for i, (name, value, size) in enumerate(spec.effects):
        rows += ["", "[[effect]]", f'name = "{name}"', f"value = {float(value)!r}",
                 f"off = {float(off_value(BY_NAME[name], spec.setting))!r}", f"size_mde = {float(size)!r}"]
        classes = extra.get("classes", [])
        if i < len(classes):
            rows += [f"{key} = {toml(members)}" for key, members in zip(("class", "class_wide", "class_exact"), classes[i])]
    return rows
