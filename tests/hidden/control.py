"""Own pseudolinearizing controller: finite-difference linearisation along the manifold, Ackermann's gain, tabulated.

z follows docs/units.md. The law was checked against the open data set `sim-none` (4e-6 N·m at most, test_open_data).
"""

import math

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import solve_discrete_are, expm

from . import dynamics as dyn
from .effects import POLES

_NO_GUST = np.zeros(0)


def plant_rate(x, tau, p, tau_1=0.0):
    """Frictionless state derivative of (q1, q2, dq1, dq2)."""
    s = np.array([x[0], x[1], x[2], x[3], x[1] - x[0], x[3] - x[2]])
    out, acc, mode = np.zeros(6), np.zeros(5), np.zeros(2, np.int64)
    dyn.accelerate(s, tau, tau_1, 0.0, _NO_GUST, p, mode, out, acc)
    return np.array([x[2], x[3], acc[0], acc[1]])


def linearise(x, tau, p, h=1e-5):
    a = np.zeros((4, 4))
    for i in range(4):
        e = np.zeros(4)
        e[i] = h
        a[:, i] = (plant_rate(x + e, tau, p) - plant_rate(x - e, tau, p)) / (2 * h)
    b = (plant_rate(x, tau + h, p) - plant_rate(x, tau - h, p)) / (2 * h)
    return a, b


class Pseudolinear:
    """Torque from state and z_desired for the nominal theta given (a dict)."""

    def __init__(self, plant, poles=POLES):
        w1, d1, w2, d2 = poles
        a = np.polymul([1, 2 * d1 * w1, w1 * w1], [1, 2 * d2 * w2, w2 * w2])
        self.t9, self.t10 = plant["theta_9"], plant["theta_10"]
        p = dyn.pack(plant)
        grid = np.linspace(0.0, 2.35, 471)
        q1 = -np.arcsin(self.t10 / self.t9 * np.sin(grid))
        gains = np.zeros((len(grid), 4))
        pull = np.zeros(len(grid))
        for i, q2 in enumerate(grid):
            x = np.array([q1[i], q2, 0.0, 0.0])
            am, bm = linearise(x, -self.t10 * math.sin(q2), p)
            ctrb = np.column_stack([bm, am @ bm, am @ am @ bm, am @ am @ am @ bm])
            n = np.linalg.solve(ctrb.T, np.array([0.0, 0.0, 0.0, 1.0]))
            row, k = n, np.zeros(4)
            for weight in (a[4], a[3], a[2], a[1], 1.0):
                k = k + weight * row
                row = row @ am
            gains[i] = k
            slope = -(self.t10 / self.t9) * math.cos(q2) / math.sqrt(1 - (self.t10 / self.t9 * math.sin(q2)) ** 2)
            pull[i] = n[0] * slope + n[1]
        raw = CubicSpline(grid, pull).antiderivative()
        arc = CubicSpline(grid, np.hypot(1.0, np.gradient(q1, grid, edge_order=2))).antiderivative()
        fine = np.linspace(0.0, 2.35, 20001)
        q_half = np.interp(0.75 * arc(2.35), arc(fine), fine)
        self.c = 0.5 / float(raw(q_half))
        self._z = CubicSpline(grid, self.c * raw(grid))
        self._k = CubicSpline(grid, gains)
        self._a0 = a[4]
        self.q2_of_half = q_half

    def z(self, q2):
        return math.copysign(float(self._z(min(abs(q2), 2.35))), q2)

    def q2_of(self, z):
        fine = np.linspace(0.0, 2.35, 4001)
        return math.copysign(np.interp(abs(z), self._z(fine), fine), z)

    def on_manifold(self, q2):
        return -math.asin(self.t10 / self.t9 * math.sin(q2))

    def __call__(self, q1, q2, d1, d2, z_desired):
        k = self._k(min(abs(q2), 2.35))
        dq1 = q1 - self.on_manifold(q2)
        return (-self.t10 * math.sin(q2) - (k[0] * dq1 + k[2] * d1 + k[3] * d2)
                - self._a0 / self.c * (self.z(q2) - z_desired))


class Balancer:
    """Sampled LQR about the upright for pinned rigs; both the joint and (optionally) the shoulder torque."""

    def __init__(self, plant, period, shoulder):
        p = dyn.pack(plant)
        x = np.zeros(4)
        a, b = linearise(x, 0.0, p)
        h = 1e-5
        b1 = (plant_rate(x, 0.0, p, h) - plant_rate(x, 0.0, p, -h)) / (2 * h)
        b = np.column_stack([b, b1]) if shoulder else b[:, None]
        m = b.shape[1]
        big = expm(np.block([[a, b], [np.zeros((m, 4 + m))]]) * period)
        ad, bd = big[:4, :4], big[:4, 4:]
        q, r = np.diag([10.0, 10.0, 1.0, 1.0]), 0.5 * np.eye(m)
        s = solve_discrete_are(ad, bd, q, r)
        self.k = np.linalg.solve(r + bd.T @ s @ bd, bd.T @ s @ ad)

    def __call__(self, x):
        u = -self.k @ x
        return float(u[0]), float(u[1]) if len(u) > 1 else 0.0
