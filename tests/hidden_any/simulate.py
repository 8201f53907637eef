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
    return values[at_row(times, at)]


def at_row(times, at):
    """The row that holds at a time."""
    return within(np.searchsorted(times, at + 1e-9, side="right") - 1, 0, len(times) - 1)


def within(values, least, most):
    """As numpy.clip, which takes three times as long for as few values as there are variants."""
    return np.minimum(np.maximum(values, least), most)


class Input:
    """What becomes of one input on its way, for all variants at once; `advance` goes on by a substep."""

    def __init__(self, one, p, times, commanded):
        self.hold, self.times, self.commanded = one.hold, times, commanded
        self.delay, self.rate, self.lag = (p[f"{one.name}:{kind}"] for kind in ("delay", "rate_limit", "lag"))
        self.gain, self.bias, top = (p[f"{one.name}:{kind}"] for kind in ("gain", "bias", "saturation"))
        self.saturates = top > 0
        self.top = np.where(self.saturates, top, 1) if np.any(self.saturates) else None
        self.is_limited, self.lags = self.rate > 0, self.lag > 0
        self.is_plain = not np.any(self.is_limited) and not np.any(self.lags)
        self.tau, self.is_bent = np.where(self.lags, self.lag, 1), self.is_limited | self.lags
        self.limited = self.lagged = None

    def raw(self, at):
        wanted = held(self.times, self.commanded, at - self.delay, self.hold)
        return wanted if self.top is None else np.where(self.saturates, within(wanted, -self.top, self.top), wanted)

    def mean(self, at, size):
        """Mean and slope over a substep, in which a held input may jump once: a delay is no whole number of substeps. A line with
        the jump's own mean and first moment is as good as the jump to the third order."""
        if self.hold == "linear":
            return self.raw(at + size / 2), 0.0
        before, after = self.raw(at), self.raw(at + size)
        jump = self.times[at_row(self.times, at + size - self.delay)] + self.delay
        share = within((jump - at) / size, 0.0, 1.0)
        return share * before + (1 - share) * after, 6 * share * (1 - share) * (after - before)

    def advance(self, at, size):
        """The input for the stages at begin, middle and end of a substep, and what it is just before its end; the memory of rate limit
        and lag goes there."""
        wanted, slope = self.mean(at, size)
        # `held` takes times for the same that differ by 1e-9 s
        last = self.raw(at + size if self.hold == "linear" else at + 0.999 * size)
        acting, tilt = wanted, 0.5 * slope
        if not self.is_plain:
            acting, tilt, last = self.remembered(at, size, wanted, tilt, last)
        return [self.gain * value + self.bias for value in (acting - tilt, acting, acting + tilt, last)]

    def remembered(self, at, size, wanted, tilt, last):
        """What rate limit and lag make of it."""
        if self.limited is None:
            self.limited = self.lagged = self.raw(at)
        step = np.where(self.is_limited, self.rate * size, np.inf)
        now = self.limited + within(wanted - self.limited, -step, step)
        middle = np.where(self.is_limited, 0.5 * (self.limited + now), wanted)
        share = np.where(self.lags, np.exp(-size / self.tau), 0.0)
        # the mean of the exponential
        acting = middle + (self.lagged - middle) * (1.0 - share) * np.where(self.lags, self.lag, 0.0) / size
        self.limited, self.lagged = now, middle + (self.lagged - middle) * share
        last = np.where(self.lags, self.lagged, np.where(self.is_limited, now, last))
        return acting, np.where(self.is_bent, 0.0, tilt), last


def simulate(machine, p, times, commands, start, disturb=None):
    """Outputs {name: array (rows, variants)} at the rows' times, without noise. `commands` {input: values at the rows}, `start`
    [state] or arrays over variants; `disturb(t)` gives {extra: value}."""
    count = len(next(iter(p.values())))
    x = np.array([np.broadcast_to(np.asarray(value, float), count) for value in start])
    fine_t, fine_y = [], []
    inputs = {one.name: Input(one, p, times, np.asarray(commands[one.name], float)) for one in machine.inputs}
    now, before = dict(p), None
    for row in range(len(times)):
        gap = times[row + 1] - times[row] if row + 1 < len(times) else 0.0
        for part in range(machine.substeps if gap else 1):
            size = gap / machine.substeps
            at = times[row] + part * size
            if disturb:
                now |= {name: np.broadcast_to(value, count) for name, value in disturb(at + size / 2).items()}
            fed = {name: one.advance(at, max(size, 1e-12)) for name, one in inputs.items()}
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
    lags = lag > 0
    if np.any(lags):
        out, tau, own = fine.copy(), lag[lags], fine[:, lags]
        last = own[0]
        for k, size in enumerate(np.diff(fine_t), 1):
            if size > 2 * SAME_TIME:
                # exact for a line between the samples
                slope = (own[k] - own[k - 1]) / size
                last = own[k] - slope * tau + (last - (own[k - 1] - slope * tau)) * np.exp(-size / tau)
            out[k, lags] = last
        fine = out
    at = np.array([np.interp(times - delay[b], fine_t, fine[:, b]) for b in range(fine.shape[1])]).T
    since = (times - times[0])[:, None]
    return p[f"{name}:gain"] * at + p[f"{name}:offset"] + p[f"{name}:drift"] * since
