"""Numbers of tests/sampled.rs: the sampled loop by numpy, put together another way.

The linearisation is typed in again from eq. (12) and Table 2; the gains are Ackermann's; the loop's matrix comes from
marching each unit vector through one period, torque by torque, with scipy's matrix exponential.

    python mechanics/tests/reference.py
"""

import numpy as np
from scipy.linalg import expm

T1, T2, T5, T7, T8, T9, T10 = 0.20386, 0.05867, 0.11, 0.01437, 0.0989, 4.779, 1.880  # Table 2


def plant(q2):
    q1 = -np.arcsin(T10 / T9 * np.sin(q2))
    off = T7 * np.cos(q2) + T8 * np.cos(q1 - q2)
    mass = np.array([[T1 + T2 * np.cos(q1), off], [off, T5]])
    a = np.zeros((4, 4))
    a[:2, 2:] = np.eye(2)
    a[2:, :2] = np.linalg.solve(mass, np.diag([T9 * np.cos(q1), T10 * np.cos(q2)]))
    b = np.concatenate([[0, 0], np.linalg.solve(mass, [-1.0, 1.0])])
    return a, b


def ackermann(a, b, polynomial):
    power = [np.linalg.matrix_power(a, k) for k in range(5)]
    controllability = np.column_stack([power[k] @ b for k in range(4)])
    target = power[4] + sum(c * p for c, p in zip(polynomial, power))
    return np.linalg.inv(controllability)[3] @ target


def radius(q2, polynomial, period, delay, differences):
    a, b = plant(q2)
    gains = ackermann(a, b, polynomial)
    pending = int(np.ceil(delay / period)) + 1  # torques on their way

    def held(x, torque, time):
        both = np.zeros((5, 5))
        both[:4, :4], both[:4, 4] = a, b
        return (expm(both * time) @ np.append(x, torque))[:4]

    def march(state):
        x, before, torques = state[:4], state[4:6], list(state[6:])  # the newest torque first
        rates = (x[:2] - before) / period if differences else x[2:]
        torques.insert(0, -gains[:2] @ x[:2] - gains[2:] @ rates)
        # torque n was computed n periods ago and acts from delay - n*period on
        now, y = 0.0, x
        for n in range(len(torques) - 1, -1, -1):
            end = period if n == 0 else min(period, max(0.0, delay - (n - 1) * period))
            begin = min(period, max(0.0, delay - n * period))
            if end > begin:
                assert abs(begin - now) < 1e-12
                y, now = held(y, torques[n], end - begin), end
        assert abs(now - period) < 1e-12
        return np.concatenate([y, x[:2], torques[:pending]])

    size = 6 + pending
    matrix = np.column_stack([march(unit) for unit in np.eye(size)])
    return np.abs(np.linalg.eigvals(matrix)).max()


POLES = [462.6, 509.5, 236.3, 14.07]
for q2 in (0.0, 0.5, 1.7559):
    for periods in (0.0, 0.4, 1.0, 1.7, 2.2):
        row = [radius(q2, POLES, 1 / 30, periods / 30, differences) for differences in (False, True)]
        print(f"({q2}, {periods}, {row[0]:.12f}, {row[1]:.12f}),")
