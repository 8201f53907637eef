"""The parts of the benchmark: which cases are made. Deterministic in (part, count, seed)."""

import random
import re

from . import alike, mde, sets
from .effects import BY_NAME, LISTED, UNKNOWN
from .settings import MIXES, Setting, off_value, value_at
from .sets import Spec

PARTS = ("singles", "none", "pairs", "unknown", "classes", "large", "rigs")
NOISES = ("low", "mid", "high")
MULTIPLES = (1.0, 3.0, 10.0)
PINNED = (("hang", "mixed", 0), ("hang", "free", 1), ("hang", "gentle", 0), ("balance", "mixed", 0), ("balance", "slow", 1))
MAX_TRIES = 40
FAR = 10.0  # sizes beyond this many times the size of a bad lab


def sized(name, setting, multiple, sign):
    """(value, size in MDE) of a listed effect at `multiple` MDE in a setting; None where it cannot be reached."""
    e = BY_NAME[name]
    entry = mde.of(setting).get(name)
    if entry is None:
        return None
    unit = entry["mde"]
    if e.shape == "limit":
        value = dict(zip(MULTIPLES, entry["at"])).get(multiple, 0.0)
        return (value, multiple) if value else None
    if e.shape == "switch":
        return (value_at(e, setting, 1.0), 1.0 / unit) if unit < 1.0 else None
    if e.shape == "integer":
        value = max(1.0, round(multiple * unit), 2.0 if multiple > 3 else 1.0)
        return value, value / unit
    size = multiple * unit
    if size > FAR * e.big:
        return None  # nothing excites it here: a delay of a torque that is zero
    if e.key == "drop_rate":
        size = max(min(size, 0.3), 0.004)
    if e.key == "E_t":
        size = min(size, 0.9)
    if e.key.startswith("theta") and size > 0.2 * abs(off_value(e, setting)):
        return None
    return value_at(e, setting, size, sign), size / unit


def random_setting(rng, effect=None, noise=None, mixes=None):
    noise = noise or rng.choice(NOISES)
    visual = effect is not None and (effect.side == "camera" or effect.key in ("slope", "theta_2", "theta_7"))
    if visual or rng.random() < 0.6:
        if effect is not None and effect.side == "camera":
            logs = rng.choice(("all", "all", "image"))
        else:
            logs = rng.choice(("all", "plant", "image"))
        return Setting("visual", logs, noise, rng.choice([m for m in MIXES["visual"] if not mixes or m in mixes]))
    rig, mix, arm = rng.choice([p for p in PINNED if not mixes or p[1] in mixes])
    return Setting(rig, "plant", noise, mix, arm)


def single_spec(name, multiple, setting, sign, seed, part):
    got = sized(name, setting, multiple, sign)
    if got is None:
        return None
    return Spec(setting, [(name, *got)], part=part, seed=seed, note={"multiple": float(multiple), "sign": float(sign)})


def _nuisances(spec, rng):
    """One set in five gets a nuisance: jitter of the timestamps (pinned) or a clock offset between logs."""
    if rng.random() < 0.2:
        if spec.setting.rig != "visual":
            spec.jitter = rng.choice((2e-4, 1e-3))
        elif spec.setting.logs == "all" and not spec.effects:
            spec.clock_offset = rng.uniform(-0.004, 0.004)
    return spec


def singles(count, seed, part="singles"):
    rng = random.Random(f"{part}|{seed}|{sets.SALT}")
    cases = [(e, m, n) for e in LISTED for m in MULTIPLES for n in NOISES]
    rng.shuffle(cases)
    made, i = 0, 0
    while made < count:
        e, m, n = cases[i % len(cases)]
        i += 1
        for _ in range(MAX_TRIES):
            setting = random_setting(rng, e, n)
            spec = single_spec(e.name, m, setting, rng.choice(e.signs), 1000 * seed + i, part)
            if spec is not None:
                made += 1
                yield _nuisances(spec, rng)
                break


def large(count, seed):
    """Sizes of a bad lab rather than of the detection limit (nonlinear range)."""
    rng = random.Random(f"large|{seed}|{sets.SALT}")
    cases = [e for e in LISTED if e.shape != "limit"]
    for i in range(count):
        if i % len(cases) == 0:
            rng.shuffle(cases)
        e = cases[i % len(cases)]
        setting = random_setting(rng, e, mixes=("mixed", "lively"))
        unit = mde.of(setting).get(e.name, {}).get("mde")
        if not unit:
            continue
        sign = rng.choice(e.signs)
        size = e.big if not e.key.startswith("theta") else 0.06 * abs(off_value(e, setting))
        value = value_at(e, setting, size, sign)
        yield Spec(setting, [(e.name, value, size / unit)], part="large", seed=1000 * seed + i, note={"sign": float(sign)})


def rigs(count, seed):
    """One effect of one arm, balanced at the unstable upright and hanging, at 3 and 10 MDE of each: two sets a case."""
    rng = random.Random(f"rigs|{seed}|{sets.SALT}")
    cases = [(e, arm) for e in LISTED if e.side == "plant" for arm in (0, 1)]
    made, i = 0, 0
    while made < count:
        if i % len(cases) == 0:
            rng.shuffle(cases)
        e, arm = cases[i % len(cases)]
        i += 1
        noise, multiple, sign = rng.choice(NOISES), rng.choice((3.0, 10.0)), rng.choice(e.signs)
        settings = [Setting(rig, "plant", noise, mix, at) for rig, mix, at in PINNED if at == arm and mix != "gentle"]
        both = [single_spec(e.name, multiple, setting, sign, 1000 * seed + i, "rigs") for setting in settings]
        if all(both):
            made += len(both)
            yield from both


def none(count, seed):
    rng = random.Random(f"none|{seed}|{sets.SALT}")
    for i in range(count):
        yield _nuisances(Spec(random_setting(rng), part="none", seed=1000 * seed + i), rng)


def pairs(count, seed):
    rng = random.Random(f"pairs|{seed}|{sets.SALT}")
    made = 0
    while made < count:
        a, b = rng.sample([e for e in LISTED if e.shape in ("linear", "noise", "rate")], 2)
        setting = random_setting(rng, a if a.side == "camera" else b, mixes=("mixed", "lively"))
        table = mde.of(setting)
        alike = {**table.get(a.name, {}).get("alike", {}), **table.get(a.name, {}).get("alike_wide", {})}
        if a.name not in table or b.name not in table or abs(alike.get(b.name, 0.0)) > 0.9:
            continue
        chosen = []
        for e, m in ((a, 10.0), (b, rng.choice((5.0, 10.0)))):
            got = sized(e.name, setting, m, rng.choice(e.signs))
            if got:
                chosen.append((e.name, *got))
        if len(chosen) == 2:
            made += 1
            yield Spec(setting, chosen, part="pairs", seed=1000 * seed + made)


def unknown(count, seed):
    rng = random.Random(f"unknown|{seed}|{sets.SALT}")
    names = list(UNKNOWN)
    for i in range(count):
        name = names[i % len(names)]
        key, weak, strong = UNKNOWN[name]
        if key in ("rolling_shutter", "k2", "bent_target"):
            setting = Setting("visual", rng.choice(("all", "all", "image")), rng.choice(NOISES), rng.choice(("mixed", "lively")))
        elif key == "clock_drift":
            setting = Setting("visual", "all", rng.choice(NOISES), rng.choice(("mixed", "lively")))
        else:
            setting = random_setting(rng, mixes=("mixed", "lively", "free") if key in ("cable", "stribeck") else ("mixed", "lively"))
        size = rng.choice((weak, strong))
        if key in ("k2", "bent_target"):
            size *= rng.choice((1, -1))
        yield Spec(setting, unknown=(name, size), part="unknown", seed=1000 * seed + i)


def experiments(setting):
    """What a lab could do next, as settings."""
    if setting.rig == "visual":
        if setting.logs == "image":
            yield "plant logged", setting.with_(logs="all")
            yield "mount turned by 90 degrees", setting.with_(turned=True)
        else:
            yield "torque logged", setting.with_(applied=True)
            if setting.logs == "all":
                yield "mount turned by 90 degrees", setting.with_(turned=True)
        if setting.mix != "lively":
            yield "faster steps", setting.with_(mix="lively")
    else:
        yield "torque logged", setting.with_(applied=True)


def classes(count, seed):
    """Pairs of sets with one truth: one in which only a class can be known, one after an experiment that tells."""
    rng = random.Random(f"classes|{seed}|{sets.SALT}")
    table = mde.load()
    options = []
    bases = (Setting(), Setting(logs="image"), Setting(logs="plant"), Setting(mix="slow"), Setting(logs="image", mix="slow"),
             Setting("hang", "plant"))
    for base in bases:
        for name in mde.of(base):
            e = BY_NAME[name]
            if e.shape != "linear":
                continue
            for m in (3.0, 10.0):
                if len(alike.classes(base, name, m, 1.0)[0]) < 2:
                    continue
                best = None
                for word, after in experiments(base):
                    if after.key not in table:
                        continue
                    got = sized(name, base, m, 1.0)
                    if got is None or name not in mde.of(after):
                        continue
                    size = abs(got[0] - off_value(e, after)) / mde.of(after)[name]["mde"]
                    members = alike.classes(after, name, size, 1.0)[0]
                    if best is None or len(members) < len(best[2]):
                        best = (word, after, members, size)
                if best:
                    options.append((base, name, m, best))
    rng.shuffle(options)
    for i in range(count):
        base, name, m, (word, after, members, size) = options[i % len(options)]
        value, own = sized(name, base, m, 1.0)
        seed_i = 1000 * seed + i
        note = {"pair": f"{seed_i}", "experiment": word, "resolves": len(members) == 1, "sign": 1.0}
        yield Spec(base, [(name, value, own)], part="classes", seed=seed_i, note={"stage": "before", **note})
        yield Spec(after, [(name, value, size)], part="classes", seed=seed_i, note={"stage": "after", **note})


def ci_slice(seed=1):
    """Some two dozen sets over all parts, quick to make."""
    mid, hang = Setting(), Setting("hang", "plant")
    balance = Setting("balance", "plant")
    for i, s in enumerate((mid, Setting(logs="image", mix="lively"), Setting(logs="plant"), hang)):
        yield Spec(s, part="none", seed=seed * 100 + i)
    chosen = (("camera.k1", 10.0, mid, 1), ("camera.T_delay", 10.0, mid, 1), ("camera.scale", 3.0, Setting(mix="lively"), -1),
              ("camera.N", 1.0, mid, 1), ("camera.roll", 3.0, Setting(logs="image"), 1), ("plant.b_joint", 10.0, mid, 1),
              ("plant.tau_bias", 3.0, Setting(logs="plant"), -1), ("plant.fc_joint", 10.0, hang, 1),
              ("plant.I_rotor", 3.0, hang, 1), ("plant.theta_8", 10.0, balance, -1), ("plant.fc_roll", 10.0, balance, 1))
    for i, (name, m, s, sign) in enumerate(chosen):
        spec = single_spec(name, m, s, float(sign), seed * 100 + 20 + i, "singles")
        if spec:
            yield spec
    faint = single_spec("plant.tau_bias", 1.0, mid, 1.0, seed * 100 + 39, "singles")
    if faint:
        yield faint
    for stage, s in (("before", Setting(logs="image")), ("after", mid)):  # sensor or actuator delay: the encoders tell
        value, size = 0.0015, 0.0015 / mde.of(s)["camera.T_delay"]["mde"]
        note = {"stage": stage, "pair": "0", "experiment": "plant logged", "resolves": True, "sign": 1.0}
        yield Spec(s, [("camera.T_delay", value, size)], part="classes", seed=seed * 100 + 60, note=note)
    upright = Setting("balance", "plant", "low", "mixed", 0)
    for i, (name, s) in enumerate((("plant.tau_max", upright), ("plant.dtau_max", upright.with_(noise="high")),
                                   ("plant.theta_8", Setting("balance", "plant", "high", "slow", 1)))):
        yield single_spec(name, 3.0, s, 1.0, seed * 100 + 70 + i, "rigs")
    both = [("camera.k1", *sized("camera.k1", mid, 10.0, -1.0)), ("plant.b_joint", *sized("plant.b_joint", mid, 10.0, 1.0))]
    yield Spec(mid, both, part="pairs", seed=seed * 100 + 40)
    for i, (name, size, s) in enumerate((("unknown.cable", 0.15, mid), ("unknown.bent_target", 0.15, mid),
                                         ("unknown.stribeck", 0.08, hang))):
        yield Spec(s, unknown=(name, size), part="unknown", seed=seed * 100 + 50 + i)


def specs(part, count, seed):
    maker = {"singles": singles, "none": none, "pairs": pairs, "unknown": unknown, "classes": classes, "large": large,
             "rigs": rigs}
    yield from maker[part](count, seed)


# What the words of a proposal mean; several may stand in one.
WORDS = {"halve the exposure": {"exposure": 0.005}, "double the exposure": {"exposure": 0.02}, "90 degrees": {"turned": True},
         "40 degrees": {"slanted": True}, "200 times a second": {"often": True}, "joint angles by encoders": {"logs": "all"},
         "tau_applied": {"applied": True}, "faster steps": {"mix": "lively"}, "larger steps": {"mix": "large"},
         "small steps": {"mix": "small"}, "slow ramps": {"mix": "ramps"}, "swing:": {"mix": "sweep"},
         "swing fast": {"mix": "fast sweep"}, "arm hang down": {"rig": "hang", "mix": "mixed"}}
UNABLE = ("frames a second", "refocus", "nearer", "farther")  # of the camera, what this program does not change


def follow(answer, words):
    """The same truth after the experiment that a diagnosis proposed in words; None where it can't be done here."""
    known = {k: answer[k] for k in ("rig", "logs", "noise", "mix", "arm", "applied", "velocity_nominal", "turned", "exposure")}
    setting, said = Setting(**known), words.lower()
    change = {key: to for word, one in WORDS.items() if word in said for key, to in one.items()}
    if longer := re.search(r"record (\d+) times as long", said):
        change["longer"] = int(longer[1])
    pinned = setting.rig != "visual"
    if pinned:  # no camera, and both angles are always logged, 200 times a second
        change = {key: to for key, to in change.items() if key in ("rig", "mix", "applied", "longer")}
    if not change or any(word in said for word in UNABLE) or ("rig" in change and (not pinned or setting.rig == "hang")):
        return None
    effects = [(e["name"], e["value"], e["size_mde"]) for e in answer.get("effect", [])]
    note = {"pair": answer.get("pair", ""), "stage": "after", "experiment": words[:80], "resolves": True,
            "sign": answer.get("sign", 1.0)}
    return Spec(setting.with_(**change), effects, part="classes", seed=answer["seed"] + 1, note=note)


def make(spec, out, answers, salt=sets.SALT):
    """Simulates and writes one spec with its classes; returns the folder's name."""
    classes_ = []
    for name, _, size in spec.effects:
        classes_.append(alike.classes(spec.setting, name, size, spec.note.get("sign", 1.0)))
    return sets.write(spec, out, answers, salt=salt, extra={"classes": classes_})
