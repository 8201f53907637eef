"""The true camera: forward-mapped circle outlines, own coverage, own thresholding and centroids.

Coverage of a pixel: its rows are cut into thin scan lines; on each the outline's left and right crossings give the exact
covered width. Only a small box around each circle is rendered: grey levels elsewhere cannot pass the threshold.
Pixel (i, j) has its centre at (i + 1/2, j + 1/2) from the lower left corner; u = 256 · image-plane u.
"""

import math

import numpy as np
from numba import njit

KEYS = ("R", "l1", "l2", "radius", "ground", "field_of_view", "foreground", "background", "f", "omega_cam", "E_t",
        "T_delay", "threshold", "N_min", "N_max", "k1", "p1", "p2", "s1", "s2", "k2", "beta", "N", "sigma", "roll",
        "pan", "tilt", "u0", "v0", "scale", "drop_rate", "rolling_shutter", "bent_target")
(R, L1, L2, RAD, GROUND, FOV, FG, BG, F, OMEGA, ET, TDEL, THR, NMIN, NMAX, K1, P1, P2, S1, S2, K2, BETA, NPASS, SIGMA,
 ROLL, PAN, TILT, U0, V0, SCALE, DROP, SHUTTER, BENT) = range(len(KEYS))

OUTLINE = 72
SCAN = 24
BOX = 32
SIZE = 512
HALF = 256.0
_TURN = 2.0 * math.pi / OUTLINE
_FAT = math.sqrt(_TURN / math.sin(_TURN))  # the polygon gets the circle's area
MASK = (5.0 / 9.0, 2.0 / 27.0, 1.0 / 27.0)


def pack(camera):
    return np.array([float(camera[k]) for k in KEYS])


@njit(cache=True)
def centre(i, q1, q2, c, xy):
    """World place of circle i (0 drum, 1 joint, 2 tip); circle 3 may sit off its link (unknown effect)."""
    xy[0] = c[R] * q1
    xy[1] = c[GROUND] + 1.0
    if i >= 1:
        xy[0] += c[L1] * math.sin(q1)
        xy[1] += c[L1] * math.cos(q1)
    if i >= 2:
        xy[0] += c[L2] * math.sin(q2) + c[BENT] * math.cos(q2)
        xy[1] += c[L2] * math.cos(q2) - c[BENT] * math.sin(q2)


@njit(cache=True)
def to_pixel(x, y, c, out):
    """World point to pixels (from the image's lower left corner): mounting, pinhole, lens, scale, principal point."""
    half = 0.5 * c[FOV]
    far = c[F] * half
    # camera turned by +pan towards +u, then +tilt towards +v: the scene turns the other way
    xr = x * math.cos(c[PAN]) - far * math.sin(c[PAN])
    zr = x * math.sin(c[PAN]) + far * math.cos(c[PAN])
    yr = y * math.cos(c[TILT]) - zr * math.sin(c[TILT])
    zt = y * math.sin(c[TILT]) + zr * math.cos(c[TILT])
    u = c[F] * xr / zt
    v = c[F] * yr / zt
    cr, sr = math.cos(c[ROLL]), math.sin(c[ROLL])
    u, v = cr * u - sr * v, sr * u + cr * v
    r2 = u * u + v * v
    du = u * r2 * (c[K1] + c[K2] * r2) + c[P1] * (3.0 * u * u + v * v) + 2.0 * c[P2] * u * v + c[S1] * r2
    dv = v * r2 * (c[K1] + c[K2] * r2) + 2.0 * c[P1] * u * v + c[P2] * (u * u + 3.0 * v * v) + c[S2] * r2
    out[0] = HALF * (c[SCALE] * (u + du) + c[U0]) + HALF
    out[1] = HALF * (c[SCALE] * (v + dv) + c[V0]) + HALF


@njit(cache=True)
def cover(xc, yc, c, x0, y0, weight, box, left, right, point):
    """Adds weight · coverage of the circle at world (xc, yc) to box, whose lower left pixel is (x0, y0)."""
    rows = BOX * SCAN
    for r in range(rows):
        left[r] = 1e9
        right[r] = -1e9
    px, py = 0.0, 0.0
    for k in range(OUTLINE + 1):
        angle = _TURN * k
        to_pixel(xc + c[RAD] * _FAT * math.cos(angle), yc + c[RAD] * _FAT * math.sin(angle), c, point)
        x, y = point[0] - x0, point[1] - y0
        if k > 0 and y != py:
            lo, hi = min(y, py), max(y, py)
            first = max(0, int(math.ceil(lo * SCAN - 0.5)))
            last = min(rows - 1, int(math.ceil(hi * SCAN - 0.5)) - 1)
            for r in range(first, last + 1):
                cross = px + (x - px) * ((r + 0.5) / SCAN - py) / (y - py)
                left[r] = min(left[r], cross)
                right[r] = max(right[r], cross)
        px, py = x, y
    for r in range(rows):
        if right[r] > left[r]:
            a, b = max(0.0, left[r]), min(float(BOX), right[r])
            row = r // SCAN
            i = int(a)
            while i < BOX and i < b:
                box[row, i] += weight / SCAN * (min(b, i + 1.0) - max(a, float(i)))
                i += 1


@njit(cache=True)
def blur(box, passes, tmp):
    for _ in range(passes):
        for j in range(BOX):
            for i in range(BOX):
                acc = 0.0
                for dj in range(-1, 2):
                    for di in range(-1, 2):
                        jj = min(max(j + dj, 0), BOX - 1)
                        ii = min(max(i + di, 0), BOX - 1)
                        acc += MASK[abs(di) + abs(dj)] * box[jj, ii]
                tmp[j, i] = acc
        for j in range(BOX):
            for i in range(BOX):
                box[j, i] = tmp[j, i]


@njit(cache=True)
def largest_blob(on, label, stack, x0, y0, out):
    """Area and mean place of the largest 8-connected blob; out = area, u, v in pixels from the image centre."""
    out[0] = 0.0
    for j in range(BOX):
        for i in range(BOX):
            label[j, i] = 0
    for j in range(BOX):
        for i in range(BOX):
            if on[j, i] and label[j, i] == 0:
                top = 1
                stack[0] = j * BOX + i
                label[j, i] = 1
                area, su, sv = 0, 0.0, 0.0
                while top > 0:
                    top -= 1
                    jj, ii = stack[top] // BOX, stack[top] % BOX
                    area += 1
                    su += ii
                    sv += jj
                    for a in range(max(0, jj - 1), min(BOX, jj + 2)):
                        for b in range(max(0, ii - 1), min(BOX, ii + 2)):
                            if on[a, b] and label[a, b] == 0:
                                label[a, b] = 1
                                stack[top] = a * BOX + b
                                top += 1
                if area > out[0]:
                    out[0] = area
                    out[1] = su / area + 0.5 + x0 - HALF
                    out[2] = sv / area + 0.5 + y0 - HALF


@njit(cache=True)
def pose_at(t, t_first, dt, nodes, last, pose):
    """Cubic Hermite interpolation of the pose on the uniform node grid."""
    x = (t - t_first) / dt
    if x <= 0.0:
        pose[0], pose[1] = nodes[0, 0], nodes[0, 1]
        return
    i = min(int(x), last - 1)
    h = min(x - i, 1.0)
    h2, h3 = h * h, h * h * h
    for j in range(2):
        pose[j] = ((2 * h3 - 3 * h2 + 1) * nodes[i, j] + (h3 - 2 * h2 + h) * dt * nodes[i, j + 2]
                   + (3 * h2 - 2 * h3) * nodes[i + 1, j] + (h3 - h2) * dt * nodes[i + 1, j + 2])


@njit(cache=True)
def take(t_end, dt, nodes, last, c, noise, seen):
    """One frame whose exposure ends at t_end; seen[i] = area, u, v of circle i. noise: (3, BOX, BOX) standard normal."""
    box = np.zeros((BOX, BOX))
    tmp = np.zeros((BOX, BOX))
    on = np.zeros((BOX, BOX), np.bool_)
    label = np.zeros((BOX, BOX), np.int64)
    stack = np.zeros(BOX * BOX, np.int64)
    left = np.zeros(BOX * SCAN)
    right = np.zeros(BOX * SCAN)
    pose = np.zeros(2)
    early = np.zeros(2)
    xy = np.zeros(2)
    point = np.zeros(2)
    before = np.zeros(2)
    period = 1.0 / c[OMEGA]
    open_time = c[ET] * period
    for i in range(3):
        end = t_end
        if c[SHUTTER] > 0.0:  # rows are read from the top down; the bottom row ends its exposure at t_end
            pose_at(t_end, 0.0, dt, nodes, last, pose)
            centre(i, pose[0], pose[1], c, xy)
            to_pixel(xy[0], xy[1], c, point)
            end = t_end - c[SHUTTER] * period * min(max(point[1] / SIZE, 0.0), 1.0)
        pose_at(end, 0.0, dt, nodes, last, pose)
        centre(i, pose[0], pose[1], c, xy)
        to_pixel(xy[0], xy[1], c, point)
        pose_at(end - open_time, 0.0, dt, nodes, last, early)
        centre(i, early[0], early[1], c, xy)
        to_pixel(xy[0], xy[1], c, before)
        way = math.hypot(point[0] - before[0], point[1] - before[1])
        samples = min(64, 2 + int(6.0 * way))
        x0 = int(math.floor(0.5 * (point[0] + before[0]))) - BOX // 2
        y0 = int(math.floor(0.5 * (point[1] + before[1]))) - BOX // 2
        for j in range(BOX):
            for k in range(BOX):
                box[j, k] = 0.0
        for m in range(samples):
            pose_at(end - open_time * (m + 0.5) / samples, 0.0, dt, nodes, last, pose)
            centre(i, pose[0], pose[1], c, xy)
            cover(xy[0], xy[1], c, x0, y0, 1.0 / samples, box, left, right, point)
        for j in range(BOX):
            for k in range(BOX):
                level = c[BG] + (c[FG] - c[BG]) * box[j, k]
                if c[BETA] > 0.0:
                    uu = (x0 + k + 0.5 - HALF) / HALF - c[U0]
                    vv = (y0 + j + 0.5 - HALF) / HALF - c[V0]
                    r = math.sqrt(uu * uu + vv * vv)
                    level *= math.cos(math.atan(r / c[F])) ** c[BETA]
                box[j, k] = level
        blur(box, int(round(c[NPASS])), tmp)
        for j in range(BOX):
            for k in range(BOX):
                level = box[j, k]
                if c[SIGMA] > 0.0:
                    level += c[SIGMA] * noise[i, j, k]
                grey = min(max(math.floor(level + 0.5), 0.0), 255.0)
                inside = 0 <= x0 + k < SIZE and 0 <= y0 + j < SIZE
                on[j, k] = inside and grey >= c[THR]
        largest_blob(on, label, stack, x0, y0, seen[i])


def estimate(seen, mount=0.0):
    """Link angles from the three centroids of an assumed perfect pinhole, mounted turned by `mount`."""
    c, s = math.cos(mount), math.sin(mount)
    u, v = c * seen[:, 1] + s * seen[:, 2], c * seen[:, 2] - s * seen[:, 1]
    return math.atan2(u[1] - u[0], v[1] - v[0]), math.atan2(u[2] - u[1], v[2] - v[1])
