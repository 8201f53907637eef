"""How a machine is driven, and where its runs begin."""

import numpy as np


def commands(machine, times, rng):
    """{input: values at the rows}."""
    return {one.name: one.rest + one.size * shape(one.kind, times, rng) for one in machine.inputs}


def start(machine, rng):
    return [state.value + (0.0 if machine.fixed else state.spread * rng.normal()) for state in machine.states]


def shape(kind, times, rng):
    if kind == "steps":
        return steps(times, rng, 0.04, 0.12)
    if kind == "on-off":
        return (steps(times, rng, 0.05, 0.15) > 0).astype(float)
    if kind == "pulses":
        return np.where(np.abs(steps(times, rng, 0.03, 0.1)) > 0.35, steps(times, rng, 0.03, 0.1), 0.0)
    if kind == "slow":
        length = times[-1] - times[0]
        return sum(rng.normal() * np.sin(2 * np.pi * k * (times - times[0]) / length + 6.3 * rng.random()) / k for k in (1, 2, 3))
    if kind == "rough":
        # a road: white noise in speed, low and high frequencies cut
        noise, low, high, values = rng.normal(size=len(times)), 0.0, 0.0, []
        for value in noise:
            low += 0.25 * (value - low)
            high += low - 0.02 * high
            values.append(high)
        return np.array(values) / np.std(values)
    raise ValueError(kind)


def steps(times, rng, shortest, longest):
    """Levels between -1 and 1, each held for a share of the run."""
    values, length = np.zeros(len(times)), times[-1] - times[0]
    at = times[0]
    while at <= times[-1]:
        span = length * rng.uniform(shortest, longest)
        values[(times >= at) & (times < at + span)] = rng.uniform(-1, 1)
        at += span
    return values
