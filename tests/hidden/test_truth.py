"""The generator's own machine and camera against conservation laws and docs/claims.md (numbers of an independent program)."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from . import camera as cam, control, dynamics as dyn, loop
from .effects import BY_NAME, CAMERA_NOMINAL, PLANT_NOMINAL
from .settings import ARMS

LAW = control.Pseudolinear(PLANT_NOMINAL)
NONE = np.zeros(0)


def free_run(plant, start, duration, commands=((0.0, 0.0),), rate=480):
    p = dyn.pack(plant)
    times = np.arange(int(duration * rate) + 1) / rate
    s = np.array([*start, start[1] - start[0], start[3] - start[2]])
    ct, cv = (np.array(c, float) for c in zip(*commands))
    nodes = np.zeros((len(times), 5))
    dyn.simulate(s, np.zeros(2), times, ct, cv, np.zeros(len(ct)), len(ct), NONE, p, True, nodes)
    return times, nodes


def pinned(**changes):
    return dict(PLANT_NOMINAL, **ARMS[0], theta_2=0.0, theta_7=0.0, theta_slope=0.0, **changes)


@pytest.mark.parametrize("plant", [PLANT_NOMINAL, pinned(), dict(PLANT_NOMINAL, I_rotor=0.01), dict(PLANT_NOMINAL, slope=0.05),
                                   dict(PLANT_NOMINAL, slope=0.02, incline=0.05)])
def test_law_energy_is_conserved(plant):
    _, nodes = free_run(plant, (0.3, -0.4, 0.0, 0.0), 8.0)
    e = [dyn.energy(x[:4], dyn.pack(plant)) for x in nodes]
    assert np.ptp(e) < 1e-7  # RK4 at 0.26 ms; links tumble at some 20 rad/s


def test_law_an_inclined_rig_is_inclined_ground_seen_from_it():
    table = 0.03
    _, seen = free_run(dict(PLANT_NOMINAL, slope=0.01, incline=table), (0.3, -0.4, 0.0, 0.0), 1.0)
    _, upright = free_run(dict(PLANT_NOMINAL, slope=0.01 + table), (0.3 + table, -0.4 + table, 0.0, 0.0), 1.0)
    assert np.allclose(seen[:, :2] + table, upright[:, :2], atol=1e-9)


def test_law_every_candidate_of_the_diagnosis_can_be_hidden():
    text = (Path(__file__).parents[2] / "diagnosis/src/rigs/acrobot/candidates/list.rs").read_text()
    candidates = set(re.findall(r'"((?:plant|camera)\.\w+)"', text.split("#[cfg(test)]")[0]))
    assert candidates == set(BY_NAME)


def test_value_motion_agrees_with_dop853():
    plant = pinned(b_joint=0.02, tau_bias=0.1)
    p = dyn.pack(plant)

    def f(t, x):
        return control.plant_rate(x, 0.1, p)

    ref = solve_ivp(f, (0, 3), [2.0, 2.5, 0, 0], method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
    _, nodes = free_run(plant, (2.0, 2.5, 0.0, 0.0), 3.0)
    assert np.allclose(nodes[-1, :4], ref, atol=1e-8)


def test_law_coulomb_takes_energy_and_ends_at_rest():
    plant = pinned(fc_roll=0.06, fc_joint=0.05)
    p = dyn.pack(plant)
    _, nodes = free_run(plant, (math.pi + 1.0, math.pi - 0.6, 0.0, 0.0), 40.0)
    e = np.array([dyn.energy(x[:4], p) for x in nodes])
    assert np.all(np.diff(e) < 1e-9)  # never gains
    assert nodes[-1, 2] == 0.0 and nodes[-1, 3] == 0.0  # sticks exactly, no creep as with a smoothed sign
    assert abs(nodes[-1, 1] - math.pi) > 1e-4  # and not at the bottom


def test_law_stuck_joint_moves_as_one_body():
    _, nodes = free_run(pinned(fc_joint=50.0), (math.pi + 0.5, math.pi + 0.5, 0.0, 0.0), 3.0)
    assert np.ptp(nodes[:, 1] - nodes[:, 0]) < 1e-12 and np.ptp(nodes[:, 0]) > 0.9


def test_law_friction_force_breaks_away_at_its_limit():
    for torque, moves in ((0.049, False), (0.051, True)):
        _, nodes = free_run(pinned(fc_joint=0.05, fc_roll=5.0), (math.pi, math.pi, 0.0, 0.0), 0.5, ((0.0, torque),))
        assert (np.ptp(nodes[:, 1]) > 0.0) == moves


def test_value_actuator_order_delay_limit_rate_lag_gain_bias():
    plant = pinned(tau_delay=0.1, tau_max=1.0, dtau_max=10.0, T_act=0.05, k_tau=2.0, tau_bias=0.3)
    t, nodes = free_run(plant, (math.pi, math.pi, 0, 0), 1.0, ((0.0, 4.0),), rate=100)
    u = nodes[:, 4]
    assert np.all(u[t < 0.1 - 1e-9] == 0.3)
    s = 0.05  # during the ramp: y = r (s - T + T exp(-s/T))
    assert u[15] == pytest.approx(0.3 + 2 * 10 * (s - 0.05 + 0.05 * math.exp(-1)), abs=1e-9)
    y = 10 * (0.1 - 0.05 + 0.05 * math.exp(-2))
    assert u[50] == pytest.approx(0.3 + 2 * (1 + (y - 1) * math.exp(-6)), abs=1e-9)


def test_law_a_short_lag_acts_like_a_delay_of_its_length():
    commands = [(0.1 * k, 0.1 * (-1) ** k) for k in range(10)]
    ends = [free_run(pinned(**{key: 4e-5}), (math.pi, math.pi, 0, 0), 1.0, commands)[1][-1, :4] for key in ("T_act", "tau_delay")]
    plain = free_run(pinned(), (math.pi, math.pi, 0, 0), 1.0, commands)[1][-1, :4]
    moved = np.abs(ends[1] - plain)
    assert np.all(np.abs(ends[0] - ends[1]) < 0.02 * moved.max())  # the rest is of second order in the lag


def test_value_manifold_and_poles_c10_c11():
    grid = np.linspace(0, 2.35, 20001)
    q1 = np.array([LAW.on_manifold(q) for q in grid])
    assert np.abs(q1).max() == pytest.approx(0.4043, abs=1e-4)
    assert q1[-1] == pytest.approx(-0.2837, abs=1e-4)
    for z, poles in ((0.0, [7.28, 3.25, -3.25, -7.28]), (0.5, [4.35, -4.35, 1.79j, -1.79j]), (0.65858, [4.73, -4.73, 3.75j, -3.75j])):
        q2 = LAW.q2_of(z)
        a, _ = control.linearise(np.array([LAW.on_manifold(q2), q2, 0, 0]), -1.88 * math.sin(q2), dyn.pack(PLANT_NOMINAL))
        got = np.linalg.eigvals(a)
        for want in poles:
            assert np.min(np.abs(got - want)) < 1e-2


def test_value_z_scale_c12():
    assert LAW.q2_of(0.5) == pytest.approx(1.7559, abs=1e-4)
    assert LAW.z(2.35) == pytest.approx(0.6586, abs=1e-4)


# q1, q2, dq1, dq2 (from the centroids), z_desired, tau of rows 0, 2, 3, 600 of shared/data/sim-none/run-01
SIM_NONE = [
    (-0.04998792, 0.10051989, 0.0, 0.0, 0.0, -0.358899245),
    (-0.04650838, 0.09217191, 0.07135731, -0.18244937, 0.0, -0.517461473),
    (-0.03799311, 0.07911194, 0.25545815, -0.39179909, 0.0, 0.17192522),
]


@pytest.mark.parametrize("row", SIM_NONE)
def test_value_law_of_the_open_data(row):
    assert LAW(*row[:5]) == pytest.approx(row[5], abs=1e-5)  # inputs are rounded to 1e-8 rad


def shots(camera, poses, rng=None):
    c = cam.pack(camera)
    out = []
    for q1, q2 in poses:
        nodes = np.zeros((2, 5))
        nodes[:, 0], nodes[:, 1] = q1, q2
        seen = np.zeros((3, 3))
        noise = rng.standard_normal((3, cam.BOX, cam.BOX)) if rng is not None else np.zeros((3, cam.BOX, cam.BOX))
        cam.take(1.0, 1.0, nodes, 1, c, noise, seen)
        out.append(seen)
    return np.array(out)


MANIFOLD = [(LAW.on_manifold(q), q) for q in np.linspace(-2.35, 2.35, 1201)]


def test_value_areas_c15():
    for threshold, area, tol in ((191, 75.0, 0.5), (128, 82.0, 0.5)):
        assert shots(dict(CAMERA_NOMINAL, threshold=threshold), MANIFOLD)[:, :, 0].mean() == pytest.approx(area, abs=tol)


def test_value_height_c14():
    px = shots(CAMERA_NOMINAL, [(0.0, 0.0)])[0]
    world = (px[2, 2] + 256 - (-0.8 * 256 + 256)) / 256  # tip's circle to the ground, image units
    assert 100 * world / 2 == pytest.approx(70.45, abs=0.1)  # the text says about 70 %


def test_value_quantisation_c17():
    seen = shots(CAMERA_NOMINAL, MANIFOLD)
    e = np.array([np.subtract(cam.estimate(s), q) for s, q in zip(seen, MANIFOLD)])
    rms = np.sqrt(np.mean(e**2, axis=0))
    assert 3.9e-4 / 1.5 < rms[0] < 3.9e-4 * 1.5 and 3.5e-4 / 1.5 < rms[1] < 3.5e-4 * 1.5  # C17: x1.5
    assert np.abs(e).max() < 1.9e-3


TABLE3 = {"k1": (0.189, 0.115), "p1": (0.780, 0.528), "p2": (1.028, 0.816), "s1": (0.780, 0.528), "s2": (0.266, 0.408)}


@pytest.mark.parametrize("key", TABLE3)
def test_value_table_3_geometric(key):
    c = cam.pack(dict(CAMERA_NOMINAL, **{key: 0.1}))
    worst = np.zeros(2)
    for q in MANIFOLD:
        px = np.zeros((3, 3))
        for i in range(3):
            xy, p = np.zeros(2), np.zeros(2)
            cam.centre(i, q[0], q[1], c, xy)
            cam.to_pixel(xy[0], xy[1], c, p)
            px[i, 1:] = p
        worst = np.maximum(worst, np.abs(np.subtract(q, cam.estimate(px))))
    assert np.allclose(worst / 0.1, TABLE3[key], atol=0.003)  # T3: between implementations


def test_law_k1_moves_outwards_and_mount_signs():
    at = shots(CAMERA_NOMINAL, [(0.2, 0.3)])[0]
    assert np.hypot(*shots(dict(CAMERA_NOMINAL, k1=0.1), [(0.2, 0.3)])[0, 2, 1:]) > np.hypot(*at[2, 1:]) + 1
    assert np.all(shots(dict(CAMERA_NOMINAL, pan=0.01), [(0.2, 0.3)])[0, :, 1] < at[:, 1] - 4)  # axis to +u: scene to -u
    assert np.all(shots(dict(CAMERA_NOMINAL, tilt=0.01), [(0.2, 0.3)])[0, :, 2] < at[:, 2] - 4)
    turned = shots(dict(CAMERA_NOMINAL, roll=0.05), [(0.0, 0.0)])[0]
    assert turned[2, 1] < -5 and turned[0, 1] > 5  # counter-clockwise: the top goes left


def test_law_blur_shows_the_middle_of_the_exposure():
    camera = dict(CAMERA_NOMINAL, E_t=0.6)
    nodes = np.zeros((3, 5))
    nodes[:, 1], nodes[:, 3] = (0.0, 0.02, 0.04), 0.6  # 0.6 rad/s, nodes 1/30 s apart
    seen = np.zeros((3, 3))
    cam.take(2 / 30, 1 / 30, nodes, 2, cam.pack(camera), np.zeros((3, cam.BOX, cam.BOX)), seen)
    assert cam.estimate(seen)[1] == pytest.approx(0.04 - 0.5 * 0.6 * 0.02, abs=1.2e-3)  # lattice


def test_value_closed_loop_looks_like_sim_none():
    """Scatter of area, u, v about the noiseless frame at the logged pose, as measured in sim-none (three runs, sigma 4)."""
    camera = dict(CAMERA_NOMINAL, sigma=4.0)
    rng = np.random.default_rng(3)
    rest = []
    for kind in ("steps", "ramp", "swing"):
        run = loop.visual(kind, PLANT_NOMINAL, camera, LAW, rng, 20.0)
        assert not run.fell
        t = np.array([f[1] for f in run.frames])
        poses = run.at(t)[:, :2] + 2e-4 * rng.standard_normal((len(t), 2))
        rest.append(np.array([f[2] for f in run.frames]) - shots(CAMERA_NOMINAL, poses))
    sd = np.concatenate(rest).std(axis=0)
    known = np.array([[0.582, 0.028, 0.025], [0.912, 0.057, 0.035], [1.005, 0.062, 0.047]])
    assert np.all(sd / known < 1.3) and np.all(sd / known > 0.75)  # other paths over the pixel lattice
    assert np.all(np.abs(np.concatenate(rest).mean(axis=0)[:, 1:]) < 0.01)
