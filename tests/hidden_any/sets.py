"""Makes data sets: a machine, an effect (or none, or one that nobody lists), runs, logs, `dataset.toml`, and the answer apart."""

import json
from pathlib import Path

import numpy as np

from . import excite
from .machines import ALL
from .simulate import INPUT, OUTPUT, neutral, simulate, variants

# Times the sensors' scatter that a whole set shows of a hidden effect, once start states and what differs from run to run are put
# aside: well above the least detectable (6), as far as its largest size allows.
SHOWN = (25.0, 250.0)
# Copies of another effect that leave less than this of a hidden one are the same to anybody.
SAME = 3.0


def ports(machine):
    """Every effect at a port with the largest change worth hiding."""
    found = {}
    for one in machine.inputs:
        span = one.size or 1.0
        sizes = {"gain": 0.3, "bias": 0.3 * span, "delay": 8 * machine.row, "lag": 12 * machine.row, "saturation": 0.35 * span,
                 "rate_limit": None}  # fmt: skip
        if one.kind == "rough":
            sizes["saturation"] = 1.2 * span
        if abs(one.rest) > one.size:
            # a limit that is the same on both sides of zero would hold it far from where it rests
            sizes["saturation"] = None
        found |= {f"{one.name}:{kind}": size for kind, size in sizes.items() if size}
    for one in machine.outputs_of:
        sizes = {"gain": 0.3, "offset": 60 * one.noise, "delay": 8 * machine.row, "lag": 12 * machine.row,
                 "drift": 120 * one.noise / machine.duration}  # fmt: skip
        found |= {f"{one.name}:{kind}": size for kind, size in sizes.items()}
    return found


def effects(machine):
    """Every listed effect: name -> largest change."""
    listed = {one.name: one.hide * (one.value if one.scale == "relative" else 1.0) for one in machine.parameters if one.candidate}
    return listed | ports(machine)


def moved(machine, name, change):
    """The value at a change from neutral; of a saturation the share that is left."""
    value = neutral(machine)[name]
    return change if name.endswith(":saturation") else value + change


class Runs:
    """The runs of one set: times, commands, starts, and what variants of the machine give on them."""

    def __init__(self, machine, rng, count):
        self.machine, self.rng = machine, rng
        steps = round(machine.duration / machine.row)
        self.times = [machine.row * np.arange(steps + 1) for _ in range(count)]
        self.commands = [excite.commands(machine, times, rng) for times in self.times]
        self.starts = [excite.start(machine, rng) for _ in range(count)]
        self.noise = {one.name: one.noise for one in machine.outputs_of}

    def outputs(self, changes, shifts=(), disturb=None):
        """[run]{output: array (rows, variants)}: `changes`, and behind them the nominal machine with each start state shifted."""
        p = variants(self.machine, [*changes, *({} for _ in shifts)])
        found = []
        for run, times in enumerate(self.times):
            start = [np.full(len(changes) + len(shifts), value) for value in self.starts[run]]
            for place, step in enumerate(shifts):
                start[place][len(changes) + place] += step
            found.append(simulate(self.machine, p, times, self.commands[run], start, disturb[run] if disturb else None))
        return found

    def stacked(self, outputs):
        """(all rows of all outputs and runs, variants), in sensor deviations."""
        return np.vstack([np.vstack([run[name] / noise for name, noise in self.noise.items()]) for run in outputs])

    def basis(self, table, first, count):
        """What start states explain, run by run: orthonormal columns. They are the last `count` variants."""
        if not count:
            return np.zeros((len(table), 0))
        length = len(table) // len(self.times)
        columns = np.zeros((len(table), count * len(self.times)))
        for run in range(len(self.times)):
            rows = slice(run * length, (run + 1) * length)
            columns[rows, run * count : (run + 1) * count] = table[rows, -count:] - table[rows, first : first + 1]
        return np.linalg.qr(columns / np.linalg.norm(columns, axis=0))[0]


def residual(target, columns):
    """What the best sum of columns leaves."""
    columns = columns[:, np.linalg.norm(columns, axis=0) > 1e-9]
    if not columns.size:
        return target
    return target - columns @ np.linalg.lstsq(columns, target, rcond=1e-6)[0]


def sizes(machine, name, sign):
    """Changes to choose from, small to large."""
    largest = effects(machine)[name]
    shares = (0.02, 0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
    return [largest / share if name.endswith(":saturation") else sign * largest * share for share in shares]


def hide(machine, runs, name, wanted):
    """A change of an effect that shows `wanted` deviations (or the largest there is), what it shows, which other effects look the
    same, and its outputs."""
    both = name.endswith((":bias", ":offset", ":drift"))
    both |= neutral(machine)[name] != 0 and not name.endswith(":saturation")
    changes = sizes(machine, name, runs.rng.choice([-1.0, 1.0]) if both else 1.0)
    listed = effects(machine)
    others = [other for other in listed if other != name]
    # what another one's small and largest change give: what bends is copied by either, or by both together
    small = [listed[other] * (1 if other.endswith(":saturation") else 0.05) for other in others]
    variety = [{name: moved(machine, name, change)} for change in changes]
    variety += [{other: moved(machine, other, change)} for other, change in zip(others, small, strict=True)]
    variety += [{other: moved(machine, other, listed[other])} for other in others]
    shifts = [] if machine.fixed else [0.05 * (state.spread or 1e-3) for state in machine.states]
    outputs = runs.outputs([{}, *variety], shifts)
    table = runs.stacked(outputs)
    basis = runs.basis(table, 0, len(shifts))
    signatures = table[:, 1 : 1 + len(variety)] - table[:, :1]
    signatures -= basis @ (basis.T @ signatures)
    shown = np.linalg.norm(signatures[:, : len(changes)], axis=0)
    reached = np.nonzero(shown >= wanted)[0]
    place = int(reached[0]) if len(reached) else len(changes) - 1
    same = []
    for at, other in enumerate(others):
        slope, bend = signatures[:, len(changes) + at], signatures[:, len(changes) + len(others) + at]
        left = [residual(signatures[:, place], np.array(columns).T) for columns in ([slope], [bend], [slope, bend])]
        if min(np.linalg.norm(rest) for rest in left) < SAME:
            same.append(other)
    clean = [{output: values[:, 1 + place] for output, values in run.items()} for run in outputs]
    return changes[place], float(shown[place]), same, clean


def trace(machine, rng, times):
    """The course of a force that nobody lists: a door that is opened five times, five pushes."""
    name = next(iter(machine.extra))
    size, length = machine.extra[name], times[-1] - times[0]
    at = np.sort(rng.uniform(0.05, 0.9, 5)) * length + times[0]
    signs = np.ones(5) if machine.one_sided else rng.choice([-1.0, 1.0], 5)
    spans = rng.uniform(0.02, 0.06, 5) * length

    def course(t):
        return {name: size * sum(s * (a <= t < a + span) for s, a, span in zip(signs, at, spans, strict=True))}

    return name, course


def make(machine, case, seed, folder, answers, units):
    """One set. `case` is the name of an effect, `none`, `unlisted` (a term of the equations that nobody lists), or `door`."""
    rng = np.random.default_rng([seed, *case.encode()])
    # one run more, which nobody sees
    runs = Runs(machine, rng, machine.runs + 1)
    answer = {"machine": machine.name, "case": case, "verdict": case, "effects": [], "class": [], "traces": []}
    if case in effects(machine):
        size, shown, same, clean = hide(machine, runs, case, rng.uniform(*SHOWN))
        answer |= {"verdict": "ambiguous" if same else "named", "shown": shown,
                   "effects": [{"name": machine.full(case), "value": moved(machine, case, size)}],
                   "class": [machine.full(name) for name in (case, *same)]}  # fmt: skip
    else:
        change, disturb = {}, None
        if case == "unlisted":
            extra = list(machine.extra)[1]
            change = {extra: machine.extra[extra]}
        elif case == "door":
            made = [trace(machine, rng, times) for times in runs.times]
            disturb = [course for _, course in made]
            answer["traces"] = [[[float(t), course(t)[name]] for t in times] for (name, course), times in list(zip(made, runs.times, strict=True))[:-1]]
        answer["verdict"] = "none" if case == "none" else "unknown"
        clean = [{name: values[:, 0] for name, values in run.items()} for run in runs.outputs([change], disturb=disturb)]
    write(machine, runs, clean[:-1], rng, folder, units)
    answer["left_out"] = {
        "times": runs.times[-1].tolist(),
        "commands": {name: values.tolist() for name, values in runs.commands[-1].items()},
        "starts": {} if machine.fixed else {state.start: value for state, value in zip(machine.states, runs.starts[-1], strict=True)},
        "clean": {name: values.tolist() for name, values in clean[-1].items()},
    }
    answers.mkdir(parents=True, exist_ok=True)
    (answers / f"{folder.name}.json").write_text(json.dumps(answer))
    return answer


def write(machine, runs, clean, rng, folder, units):
    """The folder that a user would have."""
    folder.mkdir(parents=True, exist_ok=True)
    built = units[machine.name]
    for file in built if machine.scenario else [built]:
        (folder / Path(file).name).write_bytes(Path(file).read_bytes())
    model = f'scenario = "{machine.scenario}"' if machine.scenario else f'fmu = "{machine.name}.fmu"'
    lines = ["format = 2", model, ""]
    ms = rng.random() < 0.3
    told = rng.random() < 0.7
    for one in machine.inputs:
        lines += ["[[channel]]", f'variable = "{machine.full(one.name)}"', f'column = "{one.name}_cmd"', *converted(machine, one, rng)]
        lines += [f'hold = "{one.hold}"'] * (one.hold != "zero") + [""]
    for one in machine.outputs_of:
        lines += ["[[channel]]", f'variable = "{machine.full(one.name)}"', *converted(machine, one, rng)]
        lines += [f"noise = {one.noise / abs(one.log[0]):.6g}"] * told + [""]
    if not machine.fixed and (machine.scenario or not all(state.start in {one.name for one in machine.outputs_of} for state in machine.states)):
        shown = {one.name for one in machine.outputs_of}
        for state in machine.states:
            lines += ["[[state]]", f'start = "{machine.full(state.start)}"']
            lines += [f'shows = "{machine.full(state.name)}"'] * (state.name in shown and state.start != state.name) + [""]
    for one in machine.parameters:
        if one.candidate:
            lines += ["[[candidate]]", f'variable = "{machine.full(one.name)}"', f'scale = "{one.scale}"', ""]
    for run, times in enumerate(runs.times[: len(clean)]):
        name, first = f"run-{run + 1:02d}.csv", rng.choice([0.0, 0.0, 3.7])
        lines += ["[[run]]", f'file = "{name}"', *(['time = { column = "t", unit = "ms" }'] if ms else []), ""]
        columns = {"t" if ms else "time": (times + first) * (1e3 if ms else 1.0)}
        for one in machine.inputs:
            columns[f"{one.name}_cmd"] = (runs.commands[run][one.name] - one.log[1]) / one.log[0]
        for one in machine.outputs_of:
            measured = clean[run][one.name] + one.noise * rng.normal(size=len(times))
            columns[one.name] = (measured - one.log[1]) / one.log[0]
        rows = zip(*columns.values(), strict=True)
        text = "\n".join(",".join(f"{value:.9g}" for value in row) for row in rows)
        (folder / name).write_text(",".join(columns) + "\n" + text + "\n")
    (folder / "dataset.toml").write_text("\n".join(lines))


def converted(machine, one, rng):
    """By unit of measurement, or by numbers where there is none or the sign is turned."""
    if machine.units and one.log[0] > 0 and rng.random() < 0.6:
        return [f'unit = "{one.log_unit}"']
    return [f"scale = {one.log[0]!r}", f"offset = {one.log[1]!r}"]


def cases(machine):
    """All that can be hidden."""
    return [*effects(machine), *(["unlisted"] if len(machine.extra) > 1 else []), "door", "none"]


def slice_of(names=None):
    """The fixed cases of the tests: (machine, case)."""
    chosen = {"motor": ["none", "fc", "u:delay", "door"], "car": ["c_s"], "cell": ["R0"], "cart": ["none", "x_cart:lag"], "shed": ["none", "k_a"], "sled": ["m"]}
    return [(ALL[name], case) for name, some in chosen.items() if name in ALL and (not names or name in names) for case in some]
