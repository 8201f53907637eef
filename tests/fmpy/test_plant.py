"""The plant against scipy: the equations typed in again from the paper, and integrated by DOP853."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from conftest import UNITS
from scipy.integrate import solve_ivp

T1, T2, T5, T7, T8, T9, T10 = 0.20386, 0.05867, 0.11, 0.01437, 0.0989, 4.779, 1.880  # Table 2


def motion(torque, velocity_terms, b_joint=0.0):
    """dx/dt of eq. (12); the velocity terms are those of the Lagrangian."""

    def rates(t, x):
        q1, q2, d1, d2 = x
        off = T7 * np.cos(q2) + T8 * np.cos(q1 - q2)
        mass = np.array([[T1 + T2 * np.cos(q1), off], [off, T5]])
        c = np.array([-T9 * np.sin(q1), -T10 * np.sin(q2)])
        if velocity_terms:
            s = T8 * np.sin(q1 - q2)
            c += [-0.5 * T2 * np.sin(q1) * d1**2 - T7 * np.sin(q2) * d2**2 + s * d2**2, -s * d1**2]
        link = torque(t) - b_joint * (d2 - d1)
        return [d1, d2, *np.linalg.solve(mass, np.array([-1.0, 1.0]) * link - c)]

    return rates


@pytest.mark.parametrize("velocity_terms", [True, False])
@pytest.mark.parametrize("b_joint", [0.0, 0.02])
def test_free_fall_with_a_held_torque(unit, velocity_terms, b_joint):
    plant = unit("plant").start(q1_0=-0.05, q2_0=0.1, velocity_terms=velocity_terms, b_joint=b_joint, tau=0.1)
    x = np.array([-0.05, 0.1, 0.0, 0.0])
    worst = 0.0
    for k in range(100):  # 0.5 s: the unstable mode grows by exp(7.3 * 0.5) = 38
        tau = 0.1 * np.cos(k)
        plant.set(tau=tau).step(k * 0.005, 0.005)
        x = solve_ivp(motion(lambda t: tau, velocity_terms, b_joint), (0, 0.005), x, "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
        worst = max(worst, np.abs(np.array(plant.get("q1", "q2", "dq1", "dq2")) - x).max())
    assert abs(x[1]) < 2.0, "the comparison ended before contact"
    # Both integrators err below 1e-12 a step; growth by 38 and 100 steps leave 1e-9.
    assert worst < 1e-9


def test_simulated_alone_by_fmpy():
    """What a user types first: fmpy simulate, nothing set: from (14) without a torque the acrobot falls in 1 s."""
    result = simulate_fmu(str(UNITS / "acrobot_plant.fmu"), stop_time=1.0, output_interval=0.01)
    assert len(result) == 101 and (result["q1"][0], result["q2"][0]) == (-0.05, 0.1)
    assert result["contact"][-1] and not result["contact"][20]


def test_the_upright_is_an_equilibrium_to_the_bit():
    start = {"q1_0": 0.0, "q2_0": 0.0}
    result = simulate_fmu(str(UNITS / "acrobot_plant.fmu"), stop_time=1.0, output_interval=0.01, start_values=start)
    assert np.all(result["q1"] == 0.0) and np.all(result["q2"] == 0.0) and np.all(result["z"] == 0.0)


def test_contact_holds_the_state(unit):
    plant = unit("plant").start()
    seen = []
    for k in range(2000):
        plant.step(k * 0.001, 0.001)
        seen.append((plant.get("contact"), *plant.get("q1", "q2")))
    contact = np.array([row[0] for row in seen], dtype=bool)
    after = np.array([row[1:] for row in seen])[contact]
    assert contact.any() and not contact[0] and np.all(np.diff(contact.astype(int)) >= 0)
    assert np.all(after == after[0]) and abs(abs(after[0, 1]) - 2.35) < 1e-9  # located to 1e-9 rad


def test_directional_derivatives_are_the_linearised_plant(unit):
    """d(ddq)/d(tau) at the upright is the first column of M^-1 u, from Table 2."""
    plant = unit("plant").start(q1_0=0.0, q2_0=0.0)
    reference = {name: plant.variables[name].valueReference for name in ("ddq1", "ddq2", "tau")}
    got = plant.slave.getDirectionalDerivative([reference["ddq1"], reference["ddq2"]], [reference["tau"]], [1.0])
    mass = np.array([[T1 + T2, T7 + T8], [T7 + T8, T5]])
    assert np.allclose(got, np.linalg.solve(mass, [-1.0, 1.0]), rtol=1e-9)  # central differences or exact


def test_derivatives_of_outputs_are_those_of_the_motion(unit):
    """A master that extrapolates asks for them: against differences over a short step."""
    plant = unit("plant").start(q1_0=-0.05, q2_0=0.1, tau=0.1, b_joint=0.01)
    assert plant.description.coSimulation.maxOutputDerivativeOrder == 2
    q1, q2, d1, d2 = (plant.variables[n].valueReference for n in ("q1", "q2", "dq1", "dq2"))
    plant.step(0.0, 0.3)
    h = 1e-5
    told = plant.slave.getRealOutputDerivatives([q1, q2, d1, d2, q1], [1, 1, 1, 1, 2])
    before = plant.get("q1", "q2", "dq1", "dq2")
    after = plant.step(0.3, h).get("q1", "q2", "dq1", "dq2")
    slopes = (np.array(after) - before) / h
    # Differences err by h/2 times the next derivative, some 100 rad/s3 here.
    assert np.allclose(told[:4], slopes, atol=2e-3)
    assert told[4] == told[2]
