"""Image side shared by the rivals: what the nominal camera would show at a pose, and how that moves with its parameters.

Residuals are taken against frames rendered at the same pose: against ideal centroids the pixel lattice would pass for a
lens. What is rendered is the expected frame (each pixel weighted by the chance that it is on), as a noiseless one has more
lattice than a noisy one shows. Slopes come from the projected outline, which is smooth in every parameter it knows.
"""

import math

import numpy as np
from numba import njit

from .. import camera as cam


class Unpredictable(Exception):
    """A trial that is no machine or no camera: the model can't say what would be seen."""


CORNERS = 24
_TURN = 2.0 * math.pi / CORNERS
_FAT = math.sqrt(_TURN / math.sin(_TURN))  # the polygon gets the circle's area
PLACES = np.array([1, 2, 4, 5, 7, 8])  # of the centroids among the nine


@njit(cache=True)
def _outline(q1, q2, c, out):
    """Area, u, v of the three projected circles in pixels from the image centre."""
    xy, point = np.zeros(2), np.zeros(2)
    for i in range(3):
        cam.centre(i, q1, q2, c, xy)
        area, su, sv, px, py, x0, y0 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(CORNERS + 1):
            a = _TURN * (k + 0.5)
            cam.to_pixel(xy[0] + c[cam.RAD] * _FAT * math.cos(a), xy[1] + c[cam.RAD] * _FAT * math.sin(a), c, point)
            if k == 0:
                x0, y0 = point[0], point[1]
            x, y = point[0] - x0, point[1] - y0
            if k > 0:
                cross = px * y - x * py
                area += 0.5 * cross
                su += (px + x) * cross / 6.0
                sv += (py + y) * cross / 6.0
            px, py = x, y
        out[i, 0] = area
        out[i, 1] = su / area + x0 - cam.HALF
        out[i, 2] = sv / area + y0 - cam.HALF


@njit(cache=True)
def _project(poses, c):
    out = np.zeros((len(poses), 3, 3))
    for k in range(len(poses)):
        _outline(poses[k, 0], poses[k, 1], c, out[k])
    return out.reshape(len(poses), 9)


@njit(cache=True)
def _expect(poses, c, out):
    """Expected area, u, v of each circle: a pixel counts by the chance that its noise lifts it over the threshold."""
    box, tmp = np.zeros((cam.BOX, cam.BOX)), np.zeros((cam.BOX, cam.BOX))
    left, right = np.zeros(cam.BOX * cam.SCAN), np.zeros(cam.BOX * cam.SCAN)
    xy, point, before = np.zeros(2), np.zeros(2), np.zeros(2)
    span, sigma = c[cam.ET] / c[cam.OMEGA], max(c[cam.SIGMA], 0.3)
    for k in range(len(poses)):
        lost = False
        for i in range(3):
            for side in range(2):
                h = (side - 0.5) * span
                cam.centre(i, poses[k, 0] + h * poses[k, 2], poses[k, 1] + h * poses[k, 3], c, xy)
                before[:] = point
                cam.to_pixel(xy[0], xy[1], c, point)
            x0 = int(math.floor(0.5 * (point[0] + before[0]))) - cam.BOX // 2
            y0 = int(math.floor(0.5 * (point[1] + before[1]))) - cam.BOX // 2
            samples = min(64, 1 + int(6.0 * math.hypot(point[0] - before[0], point[1] - before[1])))
            box[:] = 0.0
            for m in range(samples):
                h = span * (0.5 - (m + 0.5) / samples)
                cam.centre(i, poses[k, 0] + h * poses[k, 2], poses[k, 1] + h * poses[k, 3], c, xy)
                cam.cover(xy[0], xy[1], c, x0, y0, 1.0 / samples, box, left, right, before)
            _light(box, x0, y0, c)
            cam.blur(box, int(round(c[cam.NPASS])), tmp)
            area, su, sv = 0.0, 0.0, 0.0
            for b in range(cam.BOX):
                for a in range(cam.BOX):
                    z = (box[b, a] - c[cam.THR] + 0.5) / sigma
                    if z > -7.0:
                        chance = 1.0 if z > 7.0 else 0.5 * math.erfc(-z / 1.4142135623730951)
                        area += chance
                        su += chance * a
                        sv += chance * b
            if area < 1.0:
                lost = True
            else:
                out[k, i, 0] = area
                out[k, i, 1] = su / area + 0.5 + x0 - cam.HALF
                out[k, i, 2] = sv / area + 0.5 + y0 - cam.HALF
        if lost:
            out[k] = np.nan


@njit(cache=True)
def _light(box, x0, y0, c):
    """Coverage to grey levels, with the light's fall-off."""
    for b in range(cam.BOX):
        for a in range(cam.BOX):
            box[b, a] = c[cam.BG] + (c[cam.FG] - c[cam.BG]) * box[b, a]
            if c[cam.BETA] > 0.0:
                r = math.hypot((x0 + a + 0.5 - cam.HALF) / cam.HALF - c[cam.U0],
                               (y0 + b + 0.5 - cam.HALF) / cam.HALF - c[cam.V0])
                box[b, a] *= math.cos(math.atan(r / c[cam.F])) ** c[cam.BETA]


@njit(cache=True)
def _draw(poses, c, seed, out):
    """Noisy frames of the true camera."""
    np.random.seed(seed)
    noise, nodes = np.zeros((3, cam.BOX, cam.BOX)), np.zeros((2, 4))
    span = c[cam.ET] / c[cam.OMEGA]
    for k in range(len(poses)):
        for side in range(2):
            nodes[side, 2:] = poses[k, 2:4]
            nodes[side, :2] = poses[k, :2] + (side - 0.5) * span * poses[k, 2:4]
        for i in range(3):
            for a in range(cam.BOX):
                for b in range(cam.BOX):
                    noise[i, a, b] = np.random.standard_normal()
        cam.take(span, span, nodes, 1, c, noise, out[k])
        if min(out[k, 0, 0], out[k, 1, 0], out[k, 2, 0]) < 1.0:
            out[k] = np.nan


def project(poses, camera):
    """Ideal frames (n, 9): area, u, v of each circle at poses (n, >= 2)."""
    try:
        return _project(np.ascontiguousarray(poses), cam.pack(camera))
    except ZeroDivisionError:
        raise Unpredictable("a circle has no area") from None


def rendered(poses, camera):
    """Expected frames (n, 9) whose mid exposures see the poses (q1, q2, dq1, dq2); NaN where a circle is lost."""
    out = np.zeros((len(poses), 3, 3))
    _expect(np.ascontiguousarray(poses[:, :4]), cam.pack(camera), out)
    return out.reshape(-1, 9)


def noisy(poses, camera, seed=1):
    """Frames (n, 9) as the camera given would deliver them, noise and all."""
    out = np.zeros((len(poses), 3, 3))
    _draw(np.ascontiguousarray(poses[:, :4]), cam.pack(camera), seed, out)
    return out.reshape(-1, 9)


def pose_jacobian(poses, camera, step=1e-4):
    """d(area, u, v)/d(q1, q2): (n, 9, 2)."""
    columns = []
    for j in range(2):
        moved = np.zeros_like(poses)
        moved[:, j] = step
        columns.append((project(poses + moved, camera) - project(poses - moved, camera)) / (2 * step))
    return np.stack(columns, axis=2)


def estimates(frames, camera):
    """Angles that an ideal pinhole, mounted as declared, reads off the centroids."""
    return np.array([cam.estimate(f, camera["roll"]) for f in frames]).reshape(-1, 2)


def scatter(rest):
    """Standard deviation of each channel from second differences in time: slow misfits do not count."""
    return np.sqrt(np.nanmean((rest[2:] - 2.0 * rest[1:-1] + rest[:-2]) ** 2, axis=0) / 6.0)


def with_rates(times, poses):
    return np.column_stack([poses, np.gradient(poses, times, axis=0)])


def fit_poses(frames, times, camera, world, known=None, trust=0.0, steps=4):
    """Poses with rates (n, 4) that explain the centroids best, by least squares against rendered frames.

    Against ideal centroids they would stick to the lattice: pictures rendered there scatter less than real ones.
    known: poses measured otherwise, `trust` their weight (square of pixel noise over angle noise).
    """
    poses = with_rates(times, estimates(frames, camera)) if known is None else known.copy()
    seen = frames.reshape(len(frames), 9)[:, PLACES]
    for _ in range(steps):
        rest = np.nan_to_num(seen - world.rendered(poses, camera)[:, PLACES])
        j = pose_jacobian(poses[:, :2], camera)[:, PLACES]
        normal = np.einsum("nik,nil->nkl", j, j) + trust * np.eye(2)
        pull = np.einsum("nik,ni->nk", j, rest)
        if known is not None:
            pull += trust * (known - poses)[:, :2]
        angles = poses[:, :2] + np.linalg.solve(normal, pull[..., None])[..., 0]
        poses = with_rates(times, angles) if known is None else np.column_stack([angles, known[:, 2:]])
    return poses
