"""The maker's own machine and camera as a rival's model: it agrees with the data far below any noise, which no user's does."""

import numpy as np

from .. import dynamics as dyn
from . import image

SUBSTEP = 1.0 / 160.0  # s: RK4 on modes of some 20 rad/s leaves 1e-7 rad in a window, far below any encoder
LEAD = 0.3  # s that the actuator runs before a window


class Maker:
    early = 0.04  # s that a window with frames begins before its first row: a delayed frame shows an earlier pose
    early_plant = 0.0  # the same where there are no frames

    def replay(self, plant):
        """(commands, times, start state) -> nodes (n, 5) at the times, the first of which is the start's."""
        p = dyn.pack(plant, SUBSTEP)
        return lambda commands, times, start: _simulate(commands, times, start, p)

    def rendered(self, poses, camera):
        return image.rendered(poses, camera)

    def noisy(self, poses, camera, seed=1):
        return image.noisy(poses, camera, seed)


def _simulate(commands, times, start, p):
    """Nodes at times[0..] from a start state at times[0] under held commands; the actuator is warm by then."""
    lead = times[0] - LEAD
    first = max(0, int(np.searchsorted(commands[:, 0], lead - p[dyn.TDEL])) - 1)
    last = int(np.searchsorted(commands[:, 0], times[-1] + 1e-9))
    ct, cv, c1 = (np.ascontiguousarray(commands[first:last, j]) for j in (0, 1, 2))
    a = np.zeros(2)
    if len(ct):
        if ct[0] <= lead:
            a[:] = cv[0]
        dyn.simulate(np.zeros(6), a, np.array([lead, times[0]]), ct, cv, c1, len(ct), np.zeros(0), p, False, np.zeros((2, 5)))
    s = np.array([*start, start[1] - start[0], start[3] - start[2]])
    nodes = np.zeros((len(times), 5))
    dyn.simulate(s, a, times, ct, cv, c1, len(ct), np.zeros(0), p, True, nodes)
    return nodes
