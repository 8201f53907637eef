"""The true machine: eq. (12) with its velocity terms, event-driven stick-slip friction and an exact actuator.

Integration: fixed substeps of classical RK4 between events (torque switches, end of a rate-limited ramp, a friction
interface coming to rest). Coulomb friction is never smoothed: a sticking interface is a constraint whose force is
solved for (Karnopp's idea without a dead band: a crossing of zero speed is located and then held).
"""

import math

import numpy as np
from numba import njit

KEYS = ("theta_1", "theta_2", "theta_5", "theta_7", "theta_8", "theta_9", "theta_10", "velocity_terms",
        "b_roll", "b_joint", "fc_roll", "fc_joint", "I_rotor", "tau_max", "dtau_max", "T_act", "tau_delay",
        "tau_bias", "k_tau", "slope", "theta_slope", "backlash", "stribeck", "cable", "gust", "q2_max", "incline")
(T1, T2, T5, T7, T8, T9, T10, VEL, BR, BJ, FR, FJ, IR, TMAX, DTMAX, TACT, TDEL, BIAS, GAIN, SLOPE, THS,
 LASH, STRI, CABLE, GUST, QMAX, RIG) = range(len(KEYS))

STRIBECK_SPEED = 0.15  # rad/s
CONTACT_STIFFNESS = 300.0  # N·m/rad, backlash flank
CONTACT_DAMPING = 0.05
ROTOR = 2e-4  # kg·m², the inertia inside the gap
STEP = len(KEYS)  # place of the substep behind the named entries of a packed plant
SUBSTEP = 1.0 / 3840.0
SUBSTEP_LASH = 1.0 / 24000.0


def pack(plant, substep=SUBSTEP):
    return np.array([float(plant[k]) for k in KEYS] + [substep])


@njit(cache=True)
def gust_at(t, gust_times):
    g = 0.0
    for c in gust_times:
        g += math.exp(-0.5 * ((t - c) / 0.12) ** 2)
    return g


@njit(cache=True)
def forces(s, u, tau1, t, gust_times, p, out):
    """Mass matrix (out[0:3]), forces without Coulomb friction (out[3:5]), rotor acceleration (out[5])."""
    q1, q2, d1, d2 = s[0], s[1], s[2], s[3]
    incline = p[SLOPE]  # the drum's centre moves along it: its direction meets a link's at q - incline
    m11 = p[T1] + p[T2] * math.cos(q1 - incline) + p[IR]
    m12 = p[T7] * math.cos(q2 - incline) + p[T8] * math.cos(q1 - q2) - p[IR]
    m22 = p[T5] + p[IR]
    # where the whole rig is inclined, its angles are counted from what it stands on, and the weight alone knows the vertical
    f1 = p[T9] * math.sin(q1 + p[RIG]) + p[THS] * math.sin(incline + p[RIG]) + tau1
    f2 = p[T10] * math.sin(q2 + p[RIG])
    if p[VEL] != 0.0:
        sd = math.sin(q1 - q2)
        f1 += 0.5 * p[T2] * math.sin(q1 - incline) * d1 * d1 - (p[T8] * sd - p[T7] * math.sin(q2 - incline)) * d2 * d2
        f2 += p[T8] * sd * d1 * d1
    rel = d2 - d1
    f1 += -p[BR] * d1 + p[BJ] * rel
    f2 += -p[BJ] * rel
    if p[CABLE] != 0.0:
        angle = q2 - q1
        pull = p[CABLE] * (angle + 0.6 * angle * angle * angle)
        f1 += pull
        f2 -= pull
    if p[GUST] != 0.0:
        g = p[GUST] * gust_at(t, gust_times)
        f1 += g * math.cos(q1)
        f2 += 0.5 * g * math.cos(q2)
    out[5] = 0.0
    through = u
    if p[LASH] != 0.0:
        gap = s[4] - (q2 - q1)
        slip = s[5] - rel
        through = 0.0
        if gap > p[LASH]:
            through = max(0.0, CONTACT_STIFFNESS * (gap - p[LASH]) + CONTACT_DAMPING * slip)
        elif gap < -p[LASH]:
            through = min(0.0, CONTACT_STIFFNESS * (gap + p[LASH]) + CONTACT_DAMPING * slip)
        out[5] = (u - through) / ROTOR
    f1 -= u
    f2 += through
    out[0] = m11
    out[1] = m12
    out[2] = m22
    out[3] = f1
    out[4] = f2


@njit(cache=True)
def dry(p, speed):
    """Sliding friction at the joint: Coulomb plus Stribeck's falling part (size, not sign)."""
    return p[FJ] + p[STRI] * math.exp(-abs(speed) / STRIBECK_SPEED)


@njit(cache=True)
def accelerate(s, u, tau1, t, gust_times, p, mode, out, acc):
    """Accelerations under friction modes (0 free/none, ±1 sliding, 2 stuck). acc = a1, a2, rotor, force1, force2."""
    forces(s, u, tau1, t, gust_times, p, out)
    m11, m12, m22 = out[0], out[1], out[2]
    det = m11 * m22 - m12 * m12
    # mobility of the two interfaces: roll moves with a1, joint with a2 - a1; friction acts with -B f
    w11 = m22 / det
    w12 = -(m12 + m22) / det
    w22 = (m11 + m22 + 2.0 * m12) / det
    a1 = (m22 * out[3] - m12 * out[4]) / det
    a2 = (m11 * out[4] - m12 * out[3]) / det
    v1 = a1
    v2 = a2 - a1
    g1 = 0.0
    g2 = 0.0
    if mode[0] == 1 or mode[0] == -1:
        g1 = mode[0] * p[FR]
    if mode[1] == 1 or mode[1] == -1:
        g2 = mode[1] * dry(p, s[3] - s[2])
    if mode[0] == 2 and mode[1] == 2:
        dw = w11 * w22 - w12 * w12
        g1 = (w22 * v1 - w12 * v2) / dw
        g2 = (w11 * v2 - w12 * v1) / dw
    elif mode[0] == 2:
        g1 = (v1 - w12 * g2) / w11
    elif mode[1] == 2:
        g2 = (v2 - w12 * g1) / w22
    r1 = v1 - w11 * g1 - w12 * g2
    r2 = v2 - w12 * g1 - w22 * g2
    acc[0] = r1
    acc[1] = r1 + r2
    acc[2] = out[5]
    acc[3] = g1
    acc[4] = g2


@njit(cache=True)
def choose_modes(s, u, tau1, t, gust_times, p, mode, out, acc):
    """Consistent friction modes at the present state: sliding where there is speed, else stick or start to slide."""
    has1 = p[FR] > 0.0
    has2 = p[FJ] > 0.0 or p[STRI] > 0.0
    rel = s[3] - s[2]
    first1, last1 = 0, 1
    first2, last2 = 0, 1
    options = (2, 1, -1)
    if has1 and s[2] == 0.0:
        last1 = 3
    if has2 and rel == 0.0:
        last2 = 3
    for i in range(first1, last1):
        mode[0] = 0
        if has1:
            mode[0] = options[i] if s[2] == 0.0 else (1 if s[2] > 0.0 else -1)
        for j in range(first2, last2):
            mode[1] = 0
            if has2:
                mode[1] = options[j] if rel == 0.0 else (1 if rel > 0.0 else -1)
            accelerate(s, u, tau1, t, gust_times, p, mode, out, acc)
            good = True
            if has1 and s[2] == 0.0:
                if mode[0] == 2:
                    good = abs(acc[3]) <= p[FR]
                else:
                    good = acc[0] * mode[0] > 0.0
            if good and has2 and rel == 0.0:
                if mode[1] == 2:
                    good = abs(acc[4]) <= p[FJ] + p[STRI]
                else:
                    good = (acc[1] - acc[0]) * mode[1] > 0.0
            if good:
                return


@njit(cache=True)
def lagged(s, x0, slope, y0, lag):
    """Output of the first-order lag at time s into a piece on which its input is x0 + slope·s (exact)."""
    if lag <= 0.0:
        return x0 + slope * s
    return x0 + slope * s - slope * lag + (y0 - x0 + slope * lag) * math.exp(-s / lag)


@njit(cache=True)
def derivative(s, u, tau1, t, gust_times, p, mode, out, acc, d):
    accelerate(s, u, tau1, t, gust_times, p, mode, out, acc)
    d[0] = s[2]
    d[1] = s[3]
    d[2] = acc[0]
    d[3] = acc[1]
    d[4] = s[5]
    d[5] = acc[2]


@njit(cache=True)
def rk4(s, h, s0, t, piece, tau1, gust_times, p, mode, out, acc, w, result):
    """One RK4 step of length h from local time s0; piece = x0, slope, y0, lag, gain, bias."""
    k1, k2, k3, k4, tmp = w[0], w[1], w[2], w[3], w[4]
    u0 = piece[4] * lagged(s0, piece[0], piece[1], piece[2], piece[3]) + piece[5]
    um = piece[4] * lagged(s0 + 0.5 * h, piece[0], piece[1], piece[2], piece[3]) + piece[5]
    ue = piece[4] * lagged(s0 + h, piece[0], piece[1], piece[2], piece[3]) + piece[5]
    derivative(s, u0, tau1, t, gust_times, p, mode, out, acc, k1)
    for i in range(6):
        tmp[i] = s[i] + 0.5 * h * k1[i]
    derivative(tmp, um, tau1, t + 0.5 * h, gust_times, p, mode, out, acc, k2)
    for i in range(6):
        tmp[i] = s[i] + 0.5 * h * k2[i]
    derivative(tmp, um, tau1, t + 0.5 * h, gust_times, p, mode, out, acc, k3)
    for i in range(6):
        tmp[i] = s[i] + h * k3[i]
    derivative(tmp, ue, tau1, t + h, gust_times, p, mode, out, acc, k4)
    for i in range(6):
        result[i] = s[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])


@njit(cache=True)
def crossed(s, n, mode):
    """Which sliding interface changed the sign of its speed in the step from s to n: 0 none, 1 roll, 2 joint."""
    if (mode[0] == 1 or mode[0] == -1) and n[2] * mode[0] < 0.0:
        return 1
    if (mode[1] == 1 or mode[1] == -1) and (n[3] - n[2]) * mode[1] < 0.0:
        return 2
    return 0


@njit(cache=True)
def slide(s, t, length, piece, tau1, gust_times, p, w):
    """Integrates the mechanics in place over one actuator piece."""
    out = np.zeros(6)
    acc = np.zeros(5)
    mode = np.zeros(2, np.int64)
    n = np.zeros(6)
    hmax = p[STEP] if p[LASH] == 0.0 else SUBSTEP_LASH
    done = 0.0
    while done < length - 1e-13:
        h = min(hmax, length - done)
        if done < 12.0 * piece[3] and abs(piece[2] - piece[0]) > 1e-9:
            h = min(h, 0.4 * piece[3])  # resolves the lag's transient however short the lag
        u = piece[4] * lagged(done, piece[0], piece[1], piece[2], piece[3]) + piece[5]
        choose_modes(s, u, tau1, t + done, gust_times, p, mode, out, acc)
        rk4(s, h, done, t + done, piece, tau1, gust_times, p, mode, out, acc, w, n)
        which = crossed(s, n, mode)
        if which != 0:
            lo, hi = 0.0, h
            for _ in range(40):
                mid = 0.5 * (lo + hi)
                rk4(s, mid, done, t + done, piece, tau1, gust_times, p, mode, out, acc, w, n)
                if crossed(s, n, mode) != 0:
                    hi = mid
                else:
                    lo = mid
            rk4(s, hi, done, t + done, piece, tau1, gust_times, p, mode, out, acc, w, n)
            which = crossed(s, n, mode)
            h = hi
        for i in range(6):
            s[i] = n[i]
        if mode[0] == 2 or which == 1:
            rel = s[3] - s[2]
            s[2] = 0.0
            if mode[1] != 2:
                s[3] = rel
        if mode[1] == 2 or which == 2:
            s[3] = s[2]
        done += h


@njit(cache=True)
def advance(s, a, t0, t1, ct, cv, c1, lo, n, gust_times, p, moves):
    """Advances mechanics s (6) and actuator a (x, y) from t0 to t1 under the commands lo..n (times ct, cv, tau_1 c1).

    With moves False only the actuator runs. Returns the applied torque at t1.
    """
    w = np.zeros((5, 6))
    piece = np.zeros(6)
    t = t0
    piece[3], piece[4], piece[5] = p[TACT], p[GAIN], p[BIAS]
    while t < t1 - 1e-12:
        target, ext, end = 0.0, 0.0, t1
        for i in range(lo, n):  # a zero-order hold; the delay shifts tau only
            if ct[i] + p[TDEL] <= t + 1e-12:
                target = cv[i]
            elif ct[i] + p[TDEL] < end:
                end = ct[i] + p[TDEL]
            if ct[i] <= t + 1e-12:
                ext = c1[i]
            elif ct[i] < end:
                end = ct[i]
            else:
                break
        if p[TMAX] > 0.0:
            target = min(max(target, -p[TMAX]), p[TMAX])
        slope = 0.0
        if p[DTMAX] > 0.0 and abs(target - a[0]) > 1e-9 * p[DTMAX]:  # less than a nanosecond away has arrived
            slope = p[DTMAX] if target > a[0] else -p[DTMAX]
            end = min(end, t + abs(target - a[0]) / p[DTMAX])
        else:
            a[0] = target
        if p[TACT] <= 0.0:
            a[1] = a[0]
        length = end - t
        piece[0], piece[1], piece[2] = a[0], slope, a[1]
        if moves:
            slide(s, t, length, piece, ext, gust_times, p, w)
        a[1] = lagged(length, a[0], slope, a[1], p[TACT])
        a[0] = a[0] + slope * length
        t = end
    return p[GAIN] * a[1] + p[BIAS]


@njit(cache=True)
def simulate(s, a, times, ct, cv, c1, n, gust_times, p, moves, nodes):
    """Fills nodes[i] = q1, q2, dq1, dq2, tau_applied at times[i]; s and a hold at times[0] on entry, are left at the end."""
    lo = 0
    m = len(times)
    for i in range(m):
        u = p[GAIN] * a[1] + p[BIAS]
        if i > 0:
            while lo + 1 < n and ct[lo + 1] + p[TDEL] <= times[i - 1] + 1e-12:
                lo += 1
            u = advance(s, a, times[i - 1], times[i], ct, cv, c1, lo, n, gust_times, p, moves)
        for j in range(4):
            nodes[i, j] = s[j]
        nodes[i, 4] = u


@njit(cache=True)
def energy(s, p):
    q1, q2, d1, d2 = s[0], s[1], s[2], s[3]
    incline = p[SLOPE]
    m11 = p[T1] + p[T2] * math.cos(q1 - incline) + p[IR]
    m12 = p[T7] * math.cos(q2 - incline) + p[T8] * math.cos(q1 - q2) - p[IR]
    m22 = p[T5] + p[IR]
    return (0.5 * m11 * d1 * d1 + m12 * d1 * d2 + 0.5 * m22 * d2 * d2
            + p[T9] * math.cos(q1 + p[RIG]) + p[T10] * math.cos(q2 + p[RIG]) - p[THS] * math.sin(incline + p[RIG]) * q1)
