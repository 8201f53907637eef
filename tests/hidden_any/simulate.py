"""The truth: classical RK4 with held substeps, for many variants of a machine at once (arrays over variants).

An input goes delay, saturation, rate limit, lag, gain, bias before it acts; an output delay, lag, gain, offset, drift before the
noise. `test_truth.py` holds this against scipy's integrators."""

import numpy as np

INPUT = {"gain": 1.0, "bias": 0.0, "delay": 0.0, "lag": 0.0, "saturation": 0.0, "rate_limit": 0.0}
# Times this near, s, are the same: an output's values before and after it jumps.
SAME_TIME = 1e-9
OUTPUT = {"gain": 1.0, "offset": 0.0, "delay": 0.0, "lag": 0.0, "drift": 0.0}


def neutral(machine):
    """Every number that may be off, with its neutral value: parameters, ports, unlisted forces."""
    values = dict(machine.nominal())
    for one in machine.inputs:
        values |= {f"{one.name}:{kind}": value for kind, value in INPUT.items()}
    for one in machine.outputs_of:
        values |= {f"{one.name}:{kind}": value for kind, value in OUTPUT.items()}
    return values


def variants(machine, changes):
    """Arrays over variants from a list of {name: value}."""
    base = neutral(machine)
    for change in changes:
        assert set(change) <= set(base), f"unknown: {set(change) - set(base)}"
    return {name: np.array([change.get(name, value) for change in changes], float) for name, value in base.items()}


def held(times, values, at, hold):
    if hold == "linear":
        return np.interp(at, times, values)
    return values[np.clip(np.searchsorted(times, at + 1e-9, side="right") - 1, 0, len(values) - 1)]


def simulate(machine, p, times, commands, start, disturb=None):
    """Outputs {name: array (rows, variants)} at the rows' times, without noise. `commands` {input: values at the rows}, `start`
    [state] or arrays over variants; `disturb(t)` gives {extra: value}."""
    count = len(next(iter(p.values())))
    x = np.array([np.broadcast_to(np.asarray(value, float), count) for value in start])
    lagged, limited = {}, {}
    fine_t, fine_y = [], []
    commanded = {one.name: np.asarray(commands[one.name], float) for one in machine.inputs}

    def raw(one, at):
        wanted = held(times, commanded[one.name], at - p[f"{one.name}:delay"], one.hold)
        top = p[f"{one.name}:saturation"]
        return np.where(top > 0, np.clip(wanted, -np.where(top > 0, top, 1), np.where(top > 0, top, 1)), wanted)

    def mean(one, at, size):
        """Mean and slope over a substep, in which a held input may jump once: a delay is no whole number of substeps. A line with
        the jump's own mean and first moment is as good as the jump to the third order."""
        if one.hold == "linear":
            return raw(one, at + size / 2), 0.0
        delay = p[f"{one.name}:delay"]
        before, after = raw(one, at), raw(one, at + size)
        jump = times[np.clip(np.searchsorted(times, at + size - delay + 1e-9, side="right") - 1, 0, len(times) - 1)] + delay
        share = np.clip((jump - at) / size, 0.0, 1.0)
        return share * before + (1 - share) * after, 6 * share * (1 - share) * (after - before)

    def advance(one, at, size):
        """The input for the stages at begin, middle and end of a substep, and what it is just before its end; the memory of rate limit
        and lag goes there."""
        (wanted, slope), name = mean(one, at, size), one.name
        rate, lag = p[f"{name}:rate_limit"], p[f"{name}:lag"]
        if name not in limited:
            limited[name], lagged[name] = raw(one, at), raw(one, at)
        step = np.where(rate > 0, rate * size, np.inf)
        now = limited[name] + np.clip(wanted - limited[name], -step, step)
        middle = np.where(rate > 0, 0.5 * (limited[name] + now), wanted)
        share = np.where(lag > 0, np.exp(-size / np.where(lag > 0, lag, 1)), 0.0)
        # the mean of the exponential
        acting = middle + (lagged[name] - middle) * (1.0 - share) * np.where(lag > 0, lag, 0.0) / size
        limited[name], lagged[name] = now, middle + (lagged[name] - middle) * share
        tilt = np.where((rate > 0) | (lag > 0), 0.0, 0.5 * slope)
        # `held` takes times for the same that differ by 1e-9 s
        ends = raw(one, at + size if one.hold == "linear" else at + 0.999 * size)
        last = np.where(lag > 0, lagged[name], np.where(rate > 0, now, ends))
        stages = [acting - tilt, acting, acting + tilt, last]
        return [p[f"{name}:gain"] * value + p[f"{name}:bias"] for value in stages]

    now, before = dict(p), None
    for row in range(len(times)):
        gap = times[row + 1] - times[row] if row + 1 < len(times) else 0.0
        for part in range(machine.substeps if gap else 1):
            size = gap / machine.substeps
            at = times[row] + part * size
            if disturb:
                now |= {name: np.broadcast_to(value, count) for name, value in disturb(at + size / 2).items()}
            fed = {one.name: advance(one, at, max(size, 1e-12)) for one in machine.inputs}
            u0, u, u1, last = ({name: values[place] for name, values in fed.items()} for place in range(4))
            fine_t.append(at)
            # a sample is taken just before what is commanded at its time acts; what follows an input at once jumps there
            fine_y.append(machine.outputs(x, before or u, now))
            if before and gap:
                fine_t.append(at + SAME_TIME)
                fine_y.append(machine.outputs(x, u0, now))
            before = last
            if not gap:
                break
            k1 = machine.rhs(x, u0, now)
            k2 = machine.rhs(x + 0.5 * size * k1, u, now)
            k3 = machine.rhs(x + 0.5 * size * k2, u, now)
            k4 = machine.rhs(x + size * k3, u1, now)
            x = x + size / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    fine_t, fine_y = np.array(fine_t), np.array(fine_y)
    return {one.name: sensed(one.name, p, times, fine_t, fine_y[:, place]) for place, one in enumerate(machine.outputs_of)}


def sensed(name, p, times, fine_t, fine):
    """What the sensor makes of an output: (rows, variants)."""
    lag, delay = p[f"{name}:lag"], p[f"{name}:delay"]
    if np.any(lag > 0):
        out = fine.copy()
        for k in range(1, len(fine_t)):
            size = fine_t[k] - fine_t[k - 1]
            if size <= 2 * SAME_TIME:
                out[k] = np.where(lag > 0, out[k - 1], fine[k])
                continue
            tau = np.where(lag > 0, lag, 1.0)
            share = np.exp(-size / tau)
            # exact for a line between the samples
            slope = (fine[k] - fine[k - 1]) / size
            settled = fine[k] - slope * tau
            begun = fine[k - 1] - slope * tau
            out[k] = np.where(lag > 0, settled + (out[k - 1] - begun) * share, fine[k])
        fine = out
    at = np.array([np.interp(times - delay[b], fine_t, fine[:, b]) for b in range(fine.shape[1])]).T
    since = (times - times[0])[:, None]
    return p[f"{name}:gain"] * at + p[f"{name}:offset"] + p[f"{name}:drift"] * since
