"""Weak form of the equations of motion: what the measured angles say beside the nominal machine, without second derivatives.

With a hat between three samples as test function, the integral of q'' is a difference of slopes, exactly and whatever the
torque does in between; on the other side stand the nominal accelerations at the measured state under the torque as held.
Neighbouring hats are summed under a bump, and the rests whitened by what the angles' noise becomes on both sides.
pySINDy's own weak form has no room for a torque that jumps between samples.
"""

import numpy as np
from numba import njit

from .. import dynamics as dyn

SHIFT = 2e-3  # s, over which the slope of a delay or a lag is taken
# The quadrature breaks where the torque does (and where a late one does), so that a jump never falls inside a cell.
BREAKS = (0.0, 0.5e-3, 1e-3, SHIFT, 3.5e-3, 6e-3, 10e-3, 17e-3, 25e-3)  # s after a command
# Half width of a bump in s, window and order of the smoother in rows: at 30 Hz, at 200 Hz. Of those tried on none sets
# these left the least above the noise (mean square 0.9 ... 1.1, up to 3 in lively runs at 30 Hz under the lowest noise).
HALF = {"slow": 0.10, "fast": 0.03}
SMOOTH = {"slow": (5, 4), "fast": (11, 3)}


@njit(cache=True)
def accelerations(states, tau_1, p):
    """The machine's accelerations at states (q1, q2, dq1, dq2, u), dry friction sliding as the speeds have it."""
    out, acc, mode = np.zeros(6), np.zeros(5), np.zeros(2, np.int64)
    s, none = np.zeros(6), np.zeros(0)
    result = np.zeros((len(states), 2))
    for k in range(len(states)):
        s[:4] = states[k, :4]
        s[4], s[5] = s[1] - s[0], s[3] - s[2]
        mode[0] = 0 if p[dyn.FR] == 0.0 else int(np.sign(s[2]))
        mode[1] = 0 if p[dyn.FJ] == 0.0 else int(np.sign(s[3] - s[2]))
        dyn.accelerate(s, states[k, 4], tau_1[k], 0.0, none, p, mode, out, acc)
        result[k, 0], result[k, 1] = acc[0], acc[1]
    return result


class Weak:
    """Test functions and quadrature of one run; `rest` is the whitened discrepancy of both coordinates."""

    def __init__(self, times, commands, sd):
        self.t, self.commands, self.sd, self.white = times, commands, sd, None
        self.h = np.diff(times)
        edges = np.concatenate([times, *[commands[:, 0] + b for b in BREAKS]])
        edges = np.unique(edges[(edges >= times[0]) & (edges <= times[-1])])
        self.fine, self.width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
        self.i = np.clip(np.searchsorted(times, self.fine, side="right") - 1, 0, len(times) - 2)
        self.x = (self.fine - times[self.i]) / self.h[self.i]
        self._bumps(len(times))

    def _bumps(self, n):
        pace = float(np.median(self.h))
        m = max(2, int(round(HALF["slow" if pace > 0.015 else "fast"] / pace)))
        offsets = np.arange(-m + 1, m)
        centres = np.arange(m - 1, n - 2 - (m - 1), max(1, m // 2))
        self.bumps = np.zeros((len(centres), n - 2))
        for row, c in zip(self.bumps, centres):
            row[c + offsets] = (1.0 - (offsets / m) ** 2) ** 2
        bend, k = np.zeros((n - 2, n)), np.arange(n - 2)
        bend[k, k], bend[k, k + 2] = 1.0 / self.h[:-1], 1.0 / self.h[1:]
        bend[k, k + 1] = -bend[k, k] - bend[k, k + 2]
        self.measure = self.bumps @ bend

    def _states(self, q, dq):
        """Angles (cubic Hermite) and rates (linear) at the middles of the cells."""
        i, x, h = self.i, self.x[:, None], self.h[self.i][:, None]
        angle = ((2 * x**3 - 3 * x**2 + 1) * q[i] + (3 * x**2 - 2 * x**3) * q[i + 1]
                 + h * ((x**3 - 2 * x**2 + x) * dq[i] + (x**3 - x**2) * dq[i + 1]))
        return np.hstack([angle, (1 - x) * dq[i] + x * dq[i + 1]])

    def _applied(self, plant):
        """(torque after the actuator, external torque) at the middles of the cells."""
        c, p = self.commands, dyn.pack(plant)
        grid = np.concatenate([[self.fine[0] - 0.3], self.fine])
        nodes = np.zeros((len(grid), 5))
        ct, cv, c1 = (np.ascontiguousarray(c[:, j]) for j in (0, 1, 2))
        first = cv[np.searchsorted(ct, grid[0], side="right") - 1] if len(ct) and ct[0] <= grid[0] else 0.0
        dyn.simulate(np.zeros(6), np.full(2, first), grid, ct, cv, c1, len(ct), np.zeros(0), p, False, nodes)
        held = np.searchsorted(ct, self.fine + 1e-12, side="right") - 1
        return nodes[1:, 4], np.where(held >= 0, c1[np.maximum(held, 0)], 0.0)

    def _integral(self, q, dq, plant):
        """A machine's accelerations under the bumps: (2, bumps)."""
        u, tau_1 = self._applied(plant)
        acc = accelerations(np.column_stack([self._states(q, dq), u]), tau_1, dyn.pack(plant))
        w, x = self.width[:, None] * acc, self.x[:, None]
        rising, falling = np.zeros((len(self.h), 2)), np.zeros((len(self.h), 2))
        np.add.at(rising, self.i, w * x)
        np.add.at(falling, self.i, w * (1.0 - x))
        return (self.bumps @ (rising[:-1] + falling[1:])).T

    def _whiten(self, q, dq, plant):
        """Takes the noise of the angles through both sides of the equations, once, at the nominal machine."""
        first = np.searchsorted(self.i, np.arange(len(q) - 1))
        u, tau_1 = (x[first] for x in self._applied(plant))
        p, near = dyn.pack(plant), 0.5 * (self.h[:-1] + self.h[1:])
        states = np.column_stack([q[:-1], dq[:-1], u])
        noise = [[None, None], [None, None]]
        for j in range(2):
            moved = states.copy()
            moved[:, j] += 1e-5
            stiff = (accelerations(moved, tau_1, p) - accelerations(states, tau_1, p)) / 1e-5
            for i in range(2):
                noise[i][j] = self.measure * float(i == j)
                noise[i][j][:, 1:-1] -= self.bumps * (near * stiff[1:, i])
        whole = np.block(noise) * np.repeat(self.sd, len(q))
        self.white = np.linalg.inv(np.linalg.cholesky(whole @ whole.T))

    def rest(self, q, dq, plant):
        """Whitened discrepancy of both coordinates, one after the other."""
        if not len(self.bumps):
            return np.zeros(0)
        if self.white is None:
            self._whiten(q, dq, plant)
        model = self._integral(q, dq, plant)
        return self.white @ np.concatenate([self.measure @ q[:, j] - model[j] for j in range(2)])
