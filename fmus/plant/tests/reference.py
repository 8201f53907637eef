"""Reference numbers for value.rs, from an integration that shares nothing with the unit.

Run:  python3 -m venv v && v/bin/pip install scipy==1.17.1 && v/bin/python fmus/plant/tests/reference.py

DOP853 at rtol 1e-13, atol 1e-15, restarted at every corner of the torque. The velocity terms come from Christoffel
symbols of M(q) with derivatives by complex steps, the actuator's lag is integrated as a state.
"""
import numpy as np
from scipy.integrate import solve_ivp

TABLE_2 = dict(t1=.20386, t2=.05867, t5=.11, t7=.01437, t8=.0989, t9=4.779, t10=1.880)


def smooth_sign(v, friction):
    return np.tanh(v/min(1e-3, friction/100.0)) if friction else 0.0


def inertia(p, q, slope=0.0, rotor=0.0):
    m12 = p['t7']*np.cos(q[1] - slope) + p['t8']*np.cos(q[0] - q[1]) - rotor
    return np.array([[p['t1'] + p['t2']*np.cos(q[0] - slope) + rotor, m12], [m12, p['t5'] + rotor]])


def christoffel(p, q, dq, slope):
    d = []
    for k in range(2):
        z = np.array(q, complex)
        z[k] += 1e-30j
        d.append(inertia(p, z, slope).imag/1e-30)
    c = np.zeros(2)
    for i in range(2):
        for j in range(2):
            for k in range(2):
                c[i] += .5*(d[k][i, j] + d[j][i, k] - d[i][j, k])*dq[j]*dq[k]
    return c


def acceleration(p, q, dq, tau, tau_1=0.0, terms=True, slope=0.0, incline=0.0, b=(0, 0), fc=(0, 0), rotor=0.0):
    f = np.array([p['t9']*np.sin(q[0] + incline) - tau + tau_1 + .956*np.sin(slope + incline), p['t10']*np.sin(q[1] + incline) + tau])
    if terms:
        f -= christoffel(p, q, dq, slope)
    w = dq[1] - dq[0]
    f[0] -= b[0]*dq[0] + fc[0]*smooth_sign(dq[0], fc[0])
    joint = b[1]*w + fc[1]*smooth_sign(w, fc[1])
    f += [joint, -joint]
    return np.linalg.solve(inertia(p, q, slope, rotor), f)


def integrate(start, corners, tau, p=TABLE_2, lag=0.0, gain=1.0, bias=0.0, events=None, tau_1=lambda t: 0.0, **kw):
    """tau(t0) -> function of t, the torque before the lag on the stretch beginning at t0."""
    y = np.array(list(start) + [0.0])
    for a, e in zip(corners[:-1], corners[1:]):
        u = tau(a)

        def f(t, y):
            torque = y[4] if lag else u(t)
            dd = acceleration(p, y[:2], y[2:4], gain*torque + bias, tau_1(t), **kw)
            return [y[2], y[3], dd[0], dd[1], (u(t) - y[4])/lag if lag else 0.0]
        s = solve_ivp(f, (a, e), y, method='DOP853', rtol=1e-13, atol=1e-15, max_step=.01, events=events)
        if events and len(s.t_events[0]):
            return s.t_events[0][0], s.y_events[0][0]
        y = s.y[:, -1]
    return y


def show(name, y):
    print(name, [float(v) for v in np.atleast_1d(y)])


WILD = (0.5, -1.0, 1.0, -2.0)
zero = lambda a: (lambda t: 0.0)
unit_grid = np.linspace(0, 1, 2)
show('free from (14), 1 s', integrate((-.05, .1, 0, 0), unit_grid, zero)[:4])
show('wild, 1 s', integrate(WILD, unit_grid, zero)[:4])
show('wild as printed, 1 s', integrate(WILD, unit_grid, zero, terms=False)[:4])
show('wild R = 0, 1 s', integrate(WILD, unit_grid, zero, p=dict(TABLE_2, t2=0.0, t7=0.0))[:4])
show('wild slope .05, 1 s', integrate(WILD, unit_grid, zero, slope=.05)[:4])
show('wild slope .05, incline .03, 1 s', integrate(WILD, unit_grid, zero, slope=.05, incline=.03)[:4])
show('wild viscous .02 .05, 1 s', integrate(WILD, unit_grid, zero, b=(.02, .05))[:4])
show('wild coulomb .03 .05, 1 s', integrate(WILD, unit_grid, zero, fc=(.03, .05))[:4])
show('wild rotor .01, 1 s', integrate(WILD, unit_grid, zero, rotor=.01)[:4])
show('wild tau = .3 - .5 t, tau_1 = -.2 + .1 t, 1 s',
     integrate(WILD, unit_grid, lambda a: (lambda t: .3 - .5*t), tau_1=lambda t: -.2 + .1*t)[:4])

# The actuator: commands every 1/30 s, delayed .0123 s, cut at .3 N.m, limited to 8 N.m/s, lag .01 s, gain 1.1,
# bias .02 N.m. The rate limiter's corners are found by hand.
COMMANDS = [.5, -.2, .1, .4, -.6, .3, 0.0, .2, -.1, .25, -.3, .05, .15, -.05, .1]
pieces, level, t, end = [], 0.0, 0.0, .5
for k, command in enumerate([0.0] + COMMANDS):
    begin = 0.0 if k == 0 else (k - 1)/30 + .0123
    finish = min(end, k/30 + .0123)
    goal = float(np.clip(command, -.3, .3))
    if finish <= begin:
        continue
    reach = begin + abs(goal - level)/8
    ramp = 8*np.sign(goal - level)
    if begin < reach < finish:
        pieces += [(begin, level, ramp), (reach, goal, 0.0)]
        level = goal
    elif reach >= finish:
        pieces += [(begin, level, ramp)]
        level += ramp*(finish - begin)
    else:
        pieces += [(begin, goal, 0.0)]


def line(a):
    begin, value, ramp = [piece for piece in pieces if piece[0] <= a + 1e-12][-1]
    return lambda t: value + ramp*(t - begin)


y = integrate((-.05, .1, 0, 0), [piece[0] for piece in pieces] + [end], line, lag=.01, gain=1.1, bias=.02)
show('actuator, .5 s', y[:4])
show('actuator, .5 s: torque', 1.1*y[4] + .02)

# Lags far shorter than what a command is held for: COMMANDS as they are, every 1/30 s.
held = lambda a: (lambda t: COMMANDS[int(a*30 + .5)])
for lag in (1e-4, 3e-3):
    y = integrate((-.05, .1, 0, 0), [k/30 for k in range(16)], held, lag=lag)
    show(f'lag of {lag} s, .5 s', y[:4])

# Contact: the free fall from (14) until abs(q2) = 2.35.
hit = lambda t, y: abs(y[1]) - 2.35
hit.terminal = True
t, y = integrate((-.05, .1, 0, 0), [0, 5], zero, events=hit)
show('contact: time', t)
show('contact: state', y[:4])
