"""Reference numbers for closed_loop.rs, from a closed loop that shares nothing with the units.

Run:  python3 -m venv v && v/bin/pip install scipy==1.17.1 && v/bin/python fmus/controller/tests/reference.py

The law from its definition: n is the last row of numpy's inverse of [b, Ab, A2b, A3b], powers of A by numpy, z by
quad. The plant (12) with velocity terms by DOP853 at rtol 1e-13, torque held for 1/30 s.
"""
import numpy as np
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

T1, T2, T5, T7, T8, T9, T10 = .20386, .05867, .11, .01437, .0989, 4.779, 1.880
OMEGA_1, ZETA_1, OMEGA_2, ZETA_2 = 6.11, .84, 3.52, .54


def inertia(q1, q2):
    m12 = T7*np.cos(q2) + T8*np.cos(q1 - q2)
    return np.array([[T1 + T2*np.cos(q1), m12], [m12, T5]])


def q1_e(q2):
    return -np.arcsin(T10/T9*np.sin(q2))


def dq1_e(q2):
    return -T10*np.cos(q2)/(T9*np.cos(q1_e(q2)))


def linear(q2):
    m = np.linalg.inv(inertia(q1_e(q2), q2))
    a = np.zeros((4, 4))
    a[:2, 2:] = np.eye(2)
    a[2:, :2] = m @ np.diag([T9*np.cos(q1_e(q2)), T10*np.cos(q2)])
    b = np.concatenate([[0, 0], m @ [-1, 1]])
    n = np.linalg.inv(np.column_stack([b, a @ b, a @ a @ b, a @ a @ a @ b]))[-1]
    return a, n


def rate(q2):
    return linear(q2)[1] @ [dq1_e(q2), 1, 0, 0]


def arc(q2):
    return quad(lambda x: np.hypot(1, dq1_e(x)), 0, q2, epsabs=1e-13)[0]


Q2_HALF = brentq(lambda x: arc(x) - .75*arc(2.35), .1, 2.3, xtol=1e-14)
C = .5/quad(rate, 0, Q2_HALF, epsabs=1e-14)[0]
POLY = np.polymul([1, 2*ZETA_1*OMEGA_1, OMEGA_1**2], [1, 2*ZETA_2*OMEGA_2, OMEGA_2**2])


def torque(x, z_desired):
    q2 = x[1]
    a, n = linear(q2)
    off = np.array([x[0] - q1_e(q2), 0, x[2], x[3]])
    z = C*quad(rate, 0, q2, epsabs=1e-14)[0]
    rows = [C*n @ np.linalg.matrix_power(a, i) for i in range(5)]
    y = [row @ off for row in rows[:4]]
    y[0] += z
    v = -POLY[4]*(y[0] - z_desired) - POLY[3]*y[1] - POLY[2]*y[2] - POLY[1]*y[3]
    return -T10*np.sin(q2) + v/C - rows[4] @ off/C


def plant(tau):
    def f(t, x):
        q1, q2, d1, d2 = x
        s = np.sin(q1 - q2)
        c = [-.5*T2*np.sin(q1)*d1**2 - T7*np.sin(q2)*d2**2 + T8*s*d2**2 - T9*np.sin(q1), -T8*s*d1**2 - T10*np.sin(q2)]
        return [d1, d2, *np.linalg.solve(inertia(q1, q2), np.array([-tau, tau]) - c)]
    return f


for differences in (False, True):
    x, last = np.array([-.05, .1, 0, 0]), None
    for k in range(90):
        seen = x.copy()
        if differences:
            seen[2:] = 0 if last is None else (x[:2] - last)*30
            last = x[:2].copy()
        tau = torque(seen, .3)
        if k == 0:
            print('first torque', float(tau))
        x = solve_ivp(plant(tau), (k/30, (k + 1)/30), x, method='DOP853', rtol=1e-13, atol=1e-15).y[:, -1]
    print('differences' if differences else 'true rates', [float(v) for v in x], float(tau))
