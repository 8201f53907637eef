"""The residual unit against its equation typed in again, and a plant behind it that doesn't notice it while it is off."""

import numpy as np
import pytest

COEFFICIENTS = {
    "bias_roll": 0.01, "spring_roll": -0.2, "even_roll": 0.05, "stiff_roll": 0.3, "damp_roll": -0.02, "drag_roll": -0.01,
    "stick_roll": -0.03, "stribeck_roll": -0.04, "bias_joint": -0.02, "spring_joint": -0.1, "even_joint": 0.02,
    "stiff_joint": -0.06, "damp_joint": 0.01, "drag_joint": -0.03, "stick_joint": 0.02, "stribeck_joint": -0.05,
}  # fmt: skip
SHAPES = {"centre_roll": 0.1, "reach_roll": 0.9, "speed_joint": 2.0, "slow_roll": 0.3, "slow_joint": 0.5, "smooth": 0.05}


def terms(axis, x, v):
    centre, reach = SHAPES.get(f"centre_{axis}", 0.0), SHAPES.get(f"reach_{axis}", np.inf)
    x = np.clip(x - centre, -reach, reach)
    v = np.clip(v, -SHAPES.get(f"speed_{axis}", np.inf), SHAPES.get(f"speed_{axis}", np.inf))
    sign = np.tanh(v / SHAPES["smooth"])
    values = [1.0, x, x**2, x**3, v, v * abs(v), sign, sign * np.exp(-((v / SHAPES[f"slow_{axis}"]) ** 2))]
    names = ("bias", "spring", "even", "stiff", "damp", "drag", "stick", "stribeck")
    return sum(COEFFICIENTS[f"{name}_{axis}"] * value for name, value in zip(names, values))


def test_the_sum_is_the_documented_one(unit):
    residual = unit("residual").start(**COEFFICIENTS, **SHAPES)
    random = np.random.default_rng(1)
    for k in range(50):
        q1, q2, dq1, dq2, given_1, given_2 = random.normal(size=6)
        residual.set(q1=q1, q2=q2, dq1=dq1, dq2=dq2, tau_1_in=given_1, tau_2_in=given_2).step(k * 0.01, 0.01)
        roll, joint = terms("roll", q1, dq1), terms("joint", q2 - q1, dq2 - dq1)
        # two libraries of elementary functions, a dozen terms below 10
        assert residual.get("tau_1", "tau_2") == pytest.approx([given_1 + roll - joint, given_2 + joint], abs=1e-13)


def test_a_plant_behind_it_does_not_notice_it_while_it_is_off(unit):
    residual, behind, alone = unit("residual").start(), unit("plant").start(), unit("plant").start()
    for k in range(300):
        state = dict(zip(("q1", "q2", "dq1", "dq2"), behind.get("q1", "q2", "dq1", "dq2")))
        residual.set(**state, tau_1_in=0.02).step(k * 0.005, 0.005)
        behind.set(tau=0.1 * np.cos(k), tau_1=residual.get("tau_1"), tau_2=residual.get("tau_2")).step(k * 0.005, 0.005)
        alone.set(tau=0.1 * np.cos(k), tau_1=0.02).step(k * 0.005, 0.005)
        assert behind.outputs() == alone.outputs()


def test_directional_derivatives_are_the_differences(unit):
    residual = unit("residual")
    assert residual.description.coSimulation.providesDirectionalDerivative
    residual.start(**COEFFICIENTS, **SHAPES)
    reference = {name: variable.valueReference for name, variable in residual.variables.items()}
    state = {"q1": 0.3, "q2": -0.4, "dq1": 0.2, "dq2": -0.7}
    residual.set(**state).step(0.0, 0.01)
    outputs = ["tau_1", "tau_2", "roll", "joint"]
    seed = [0.5, -1.0, 0.25, 2.0]
    got = residual.slave.getDirectionalDerivative([reference[n] for n in outputs], [reference[n] for n in state], seed)

    def at(share):
        q1, q2, dq1, dq2 = (value + share * change for value, change in zip(state.values(), seed))
        roll, joint = terms("roll", q1, dq1), terms("joint", q2 - q1, dq2 - dq1)
        return np.array([roll - joint, joint, roll, joint])

    # second order: h**2 = 1e-10 times third derivatives of tanh(v/0.05), some 1e3
    assert got == pytest.approx((at(1e-5) - at(-1e-5)) / 2e-5, abs=1e-6)
