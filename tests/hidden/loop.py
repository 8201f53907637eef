"""Closed and open loop runs: truth on a fine node grid, delivered frames, commands. No measurement noise of logs here."""

import math
from dataclasses import dataclass, field

import numpy as np

from . import camera as cam
from . import control, dynamics as dyn, excite

NODES_PER_FRAME = 16


@dataclass
class Run:
    kind: str
    dt: float
    times: np.ndarray
    nodes: np.ndarray  # q1, q2, dq1, dq2, tau_applied at times
    commands: np.ndarray  # time, tau, z_desired, tau_1
    frames: list = field(default_factory=list)  # delivery time, frame time, seen (3x3) or None where lost
    gust_times: np.ndarray = None
    fell: bool = False

    def at(self, t):
        """q1, q2, dq1, dq2 at times t (cubic Hermite for the angles, linear for the rates)."""
        x = np.clip(np.asarray(t) / self.dt, 0.0, len(self.times) - 1 - 1e-9)
        i = x.astype(int)
        h = (x - i)[:, None]
        a, b = self.nodes[i], self.nodes[i + 1]
        q = ((2 * h**3 - 3 * h**2 + 1) * a[:, :2] + (h**3 - 2 * h**2 + h) * self.dt * a[:, 2:4]
             + (3 * h**2 - 2 * h**3) * b[:, :2] + (h**3 - h**2) * self.dt * b[:, 2:4])
        return np.hstack([q, (1 - h) * a[:, 2:4] + h * b[:, 2:4]])


def _gusts(rng, plant, duration):
    if plant["gust"] == 0.0:
        return np.zeros(0)
    return np.sort(rng.uniform(2.0, duration, max(2, int(duration / 6))))


def start_state(law, rng):
    q2 = rng.uniform(0.04, 0.12) * rng.choice([-1, 1])
    q1 = law.on_manifold(q2) + rng.uniform(-0.01, 0.01)
    return np.array([q1, q2, 0.0, 0.0, q2 - q1, 0.0])


def visual(kind, plant, camera, law, rng, duration, mount=0.0):
    """Rolling acrobot under visual servo. law is the nominal controller; plant and camera are the true ones.

    mount: the roll that the vision software knows of and takes out of its estimates.
    """
    p, c = dyn.pack(plant), cam.pack(camera)
    period = 1.0 / camera["omega_cam"]
    dt = period / NODES_PER_FRAME
    frames = int(round(duration / period))
    z_desired = excite.desired(kind, rng, duration)
    gusts = _gusts(rng, plant, duration)
    s = start_state(law, rng)
    a = np.zeros(2)
    times = np.arange(frames * NODES_PER_FRAME + 1) * dt
    nodes = np.zeros((len(times), 5))
    nodes[:, :4] = s[:4]
    ct, cv, c1 = np.zeros(frames + 1), np.zeros(frames + 1), np.zeros(frames + 1)
    n = 0
    commands, seen_frames = [], []
    previous, held_tau = None, 0.0
    noise = np.zeros((3, cam.BOX, cam.BOX))
    last_node, fell = 0, False
    for k in range(frames + 1):
        t = k * period
        if k > 0:
            part = slice(last_node, last_node + NODES_PER_FRAME + 1)
            block = np.zeros((NODES_PER_FRAME + 1, 5))
            lo = max(0, n - 4 - int((camera["T_delay"] + plant["tau_delay"]) / period))
            dyn.simulate(s, a, times[part], ct[lo:n], cv[lo:n], c1[lo:n], n - lo, gusts, p, True, block)
            nodes[part] = block
            last_node += NODES_PER_FRAME
            nodes[last_node + 1:, :] = block[-1]
            if abs(s[1]) >= plant["q2_max"] or abs(s[0]) > 1.3 or not np.isfinite(s[0]):
                fell = True
                break
        if camera["drop_rate"] > 0.0 and rng.random() < camera["drop_rate"]:
            continue
        if camera["sigma"] > 0.0:
            noise = rng.standard_normal(noise.shape, dtype=np.float64)
        seen = np.zeros((3, 3))
        cam.take(t, dt, nodes, max(last_node, 1), c, noise, seen)
        delivered = t + camera["T_delay"]
        ok = bool(np.all((seen[:, 0] >= camera["N_min"]) & (seen[:, 0] <= camera["N_max"])))
        if not ok:
            seen_frames.append((delivered, t, None))
            continue
        seen_frames.append((delivered, t, seen))
        q1, q2 = cam.estimate(seen, mount)
        d1 = d2 = 0.0
        if previous is not None:
            d1, d2 = (q1 - previous[1]) / (t - previous[0]), (q2 - previous[2]) / (t - previous[0])
        previous = (t, q1, q2)
        zd = z_desired(delivered)
        held_tau = law(q1, q2, d1, d2, zd)
        ct[n], cv[n] = delivered, held_tau
        n += 1
        commands.append((delivered, held_tau, zd, 0.0))
    end = times[last_node]
    keep = slice(0, last_node + 1)
    return Run(kind, dt, times[keep], nodes[keep], np.array([r for r in commands if r[0] <= end + 1e-9]),
               [f for f in seen_frames if f[0] <= end + 1e-9], gusts, fell)


def hanging(kind, plant, rng, duration, rate):
    """Pinned arm, torques played open loop and held at `rate`; weaker where the links would go round (a lab stops there)."""
    p = dyn.pack(plant)
    gusts = _gusts(rng, plant, duration)
    n = int(round(duration * rate)) + 1
    ct, seed = np.arange(n) / rate, rng.integers(1 << 62)
    for scale in 0.75 ** np.arange(12):
        tau, tau_1, start = excite.torques(kind, np.random.default_rng(seed), plant, scale)
        cv = np.array([tau(t) for t in ct])
        c1 = np.array([tau_1(t) for t in ct])
        s = np.array([*start, start[1] - start[0], start[3] - start[2]])
        nodes = np.zeros((n, 5))
        dyn.simulate(s, np.zeros(2), ct, ct, cv, c1, n, gusts, p, True, nodes)
        if np.abs(nodes[:, :2] - math.pi).max() < 2.9:
            break
    return Run(kind, 1.0 / rate, ct, nodes, np.column_stack([ct, cv, np.zeros(n), c1]), [], gusts)


def balancing(kind, plant, nominal, rng, duration, rate, encoder):
    """Pinned arm held at the upright by sampled LQR from noisy encoders; the references dither."""
    p = dyn.pack(plant)
    law = control.Balancer(nominal, 1.0 / rate, shoulder=True)
    gusts = _gusts(rng, plant, duration)
    size = {"still": 0.0, "slow": 0.1, "swing": 0.35, "drive": 0.25}[kind]
    band = {"still": (0.1, 0.3), "slow": (0.05, 0.3), "swing": (0.2, 0.6), "drive": (0.3, 2.5)}[kind]
    ref1, ref2 = excite.multisine(rng, 0.5 * size, *band), excite.multisine(rng, size, *band)
    n = int(round(duration * rate)) + 1
    ct, cv, c1 = np.arange(n) / rate, np.zeros(n), np.zeros(n)
    q = rng.uniform(-0.03, 0.03, 2)
    s = np.array([q[0], q[1], 0.0, 0.0, q[1] - q[0], 0.0])
    a = np.zeros(2)
    nodes = np.zeros((n, 5))
    old, speed = None, np.zeros(2)
    fell = n
    for k in range(n):
        if k > 0:
            block = np.zeros((2, 5))
            lo = max(0, k - 4 - int(plant["tau_delay"] * rate))
            dyn.simulate(s, a, ct[k - 1:k + 1], ct[lo:k], cv[lo:k], c1[lo:k], k - lo, gusts, p, True, block)
            nodes[k] = block[1]
        else:
            nodes[0, :4] = s[:4]
        y = s[:2] + encoder * rng.standard_normal(2)
        if old is not None:
            speed += 0.35 * ((y - old) * rate - speed)
        old = y
        x = np.array([y[0] - ref1(ct[k]), y[1] - ref2(ct[k]), speed[0], speed[1]])
        feed = -plant["theta_10"] * math.sin(ref2(ct[k]))
        u, u1 = law(x)
        cv[k] = u + feed
        c1[k] = u1 - nominal["theta_9"] * math.sin(ref1(ct[k])) + feed
        if not np.isfinite(s[0]) or abs(s[0]) > 1.5 or abs(s[1]) > 2.2:
            fell = k + 1
            break
    return Run(kind, 1.0 / rate, ct[:fell], nodes[:fell],
               np.column_stack([ct, cv, np.zeros(n), c1])[:fell], [], gusts, fell < n)
