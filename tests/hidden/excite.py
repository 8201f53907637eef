"""What the machine is asked to do: z_desired over time for balancing rigs, torques over time for hanging ones."""

import math

import numpy as np


def smooth(x):
    """C4 step from 0 to 1."""
    x = min(max(x, 0.0), 1.0)
    return x**5 * (126 + x * (-420 + x * (540 + x * (-315 + 70 * x))))


def _steps(points):
    """points: (start, length, target); returns z(t)."""

    def z(t):
        value = 0.0
        for start, length, target in points:
            if t <= start:
                break
            value += (target - value) * smooth((t - start) / length)
        return value

    return z


def desired(kind, rng, duration):
    """z_desired(t) of one balancing run."""
    if kind == "steps":
        t, points = 2.0 + rng.uniform(0, 0.5), []
        while t < duration:
            points.append((t, 1.6 + rng.uniform(0, 0.6), rng.choice([-1, 1]) * rng.uniform(0.08, 0.4)))
            t += 3.0 + rng.uniform(0, 1.0)
        return _steps(points)
    if kind == "fast":
        t, points = 1.5 + rng.uniform(0, 0.5), []
        while t < duration:
            points.append((t, 0.8, rng.choice([-1, 1]) * rng.uniform(0.05, 0.2)))
            t += 1.6 + rng.uniform(0, 0.6)
        return _steps(points)
    if kind == "ramp":
        a, b = rng.uniform(0.3, 0.5), -rng.uniform(0.3, 0.5)
        span = (duration - 3.0) / 3.0
        return _steps([(2.0, span, a), (2.0 + span, 1.2 * span, b), (2.0 + 2.3 * span, 0.6 * span, 0.0)])
    if kind == "swing":
        amp, freq, phase = rng.uniform(0.12, 0.3), rng.uniform(0.08, 0.16), rng.uniform(0, 6.28)
        return lambda t: amp * smooth(t / 2.5) * math.sin(2 * math.pi * freq * t + phase)
    if kind == "slow":
        a, b = rng.uniform(-0.12, 0.12), rng.uniform(-0.12, 0.12)
        return _steps([(2.0, duration / 2.5, a), (duration / 1.9, duration / 2.6, b)])
    if kind == "still":
        return lambda t: 0.0
    if kind in ("sweep", "fast sweep"):
        size, low, high = (0.2, 0.08, 0.5) if kind == "sweep" else (0.12, 0.3, 0.9)
        amp, phase = size * rng.uniform(0.9, 1.1), rng.uniform(0, 6.28)
        return lambda t: amp * smooth(t / 2.5) * math.sin(2 * math.pi * (low + 0.5 * (high - low) * t / duration) * t + phase)
    if kind in ("large", "small"):
        size, length = (0.3, 4.0) if kind == "large" else (0.05, 1.0)
        every, sign = length + rng.uniform(0.8, 1.2), rng.choice([-1, 1])
        count = int((duration - 1.0) / every) + 1
        return _steps([(1.0 + i * every, length, sign * (-1) ** i * size) for i in range(count)])
    raise ValueError(f"excitation {kind!r}: one of steps, fast, ramp, swing, slow, still, sweep, fast sweep, large, small")


def multisine(rng, amplitude, low, high, n=7):
    f = np.exp(rng.uniform(np.log(low), np.log(high), n))
    a = rng.uniform(0.4, 1.0, n)
    a *= amplitude / np.sqrt(0.5 * np.sum(a * a))
    phase = rng.uniform(0, 2 * np.pi, n)
    return lambda t: smooth(t / 0.5) * float(np.sum(a * np.sin(2 * np.pi * f * t + phase)))


def torques(kind, rng, plant, scale):
    """(tau(t), tau_1(t), start state) of one hanging run; angles start about pi (hanging) from the upright."""
    weight = scale * plant["theta_10"]
    rest = (math.pi, math.pi, 0.0, 0.0)
    if kind == "free":
        wide = 1.6 * scale
        q1, q2 = (math.pi + rng.choice([-1, 1]) * wide * rng.uniform(0.3, 1.0) for _ in range(2))
        return (lambda t: 0.0), (lambda t: 0.0), (q1, q2, 0.0, 0.0)
    if kind == "drive":
        return multisine(rng, 0.2 * weight, 0.2, 3.0), multisine(rng, 0.3 * weight, 0.2, 2.0), rest
    if kind == "elbow":
        return multisine(rng, 0.22 * weight, 0.2, 3.0), (lambda t: 0.0), rest
    if kind == "gentle":
        return multisine(rng, 0.08 * weight, 0.1, 0.8), multisine(rng, 0.15 * weight, 0.1, 0.8), rest
    raise ValueError(f"excitation {kind!r}: one of free, drive, elbow, gentle")
