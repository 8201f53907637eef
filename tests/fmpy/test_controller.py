"""The controller alone: the manifold is an equilibrium of the law, and the closed loop has the poles asked for."""

import numpy as np
import pytest

T1, T2, T5, T7, T8, T9, T10 = 0.20386, 0.05867, 0.11, 0.01437, 0.0989, 4.779, 1.880  # Table 2


def torque(controller, x, z):
    controller.time = getattr(controller, "time", 0.0)
    controller.set(q1=x[0], q2=x[1], dq1=x[2], dq2=x[3], z_desired=z).step(controller.time, 0.01)
    controller.time += 0.01
    return controller.get("tau")


@pytest.mark.parametrize("q2", [-1.5, -0.4, 0.0, 0.7, 1.7])
def test_equilibrium_and_poles(unit, q2):
    controller = unit("controller").start()
    q1 = -np.arcsin(T10 / T9 * np.sin(q2))  # (13)
    x = np.array([q1, q2, 0.0, 0.0])
    torque(controller, x, 0.0)
    z = controller.get("z_hat")
    assert torque(controller, x, z) == pytest.approx(-T10 * np.sin(q2), abs=1e-7)  # tau_e; splines err below 1e-8

    off = T7 * np.cos(q2) + T8 * np.cos(q1 - q2)
    mass = np.array([[T1 + T2 * np.cos(q1), off], [off, T5]])
    a = np.zeros((4, 4))
    a[:2, 2:] = np.eye(2)
    a[2:, :2] = np.linalg.solve(mass, np.diag([T9 * np.cos(q1), T10 * np.cos(q2)]))
    b = np.concatenate([[0, 0], np.linalg.solve(mass, [-1.0, 1.0])])
    step = 1e-5
    gain = [(torque(controller, x + step * e, z) - torque(controller, x - step * e, z)) / (2 * step) for e in np.eye(4)]
    characteristic = np.poly(a + np.outer(b, gain))
    wanted = np.polymul([1, 2 * 0.84 * 6.11, 6.11**2], [1, 2 * 0.54 * 3.52, 3.52**2])
    assert np.allclose(characteristic, wanted, rtol=1e-5)  # differences of step 1e-5 on splines that err by 1e-8


def test_no_torque_before_the_first_estimate(unit):
    controller = unit("controller").start(frame=0, q1=0.1, z_desired=0.3)
    assert controller.get("tau") == 0.0
    controller.set(frame=1).step(0.0, 0.01)
    held = controller.get("tau")
    assert held != 0.0
    controller.set(q1=0.2).step(0.01, 0.01)
    assert controller.get("tau") == held, "held until the next estimate"


def test_directional_derivatives_are_the_gain(unit):
    controller = unit("controller")
    assert controller.description.coSimulation.providesDirectionalDerivative
    controller.start()
    names = ("q1", "q2", "dq1", "dq2")
    x = np.array([-0.1, 0.5, 0.3, -0.2])
    step = 1e-5
    ends = [(torque(controller, x + step * e, 0.1) - torque(controller, x - step * e, 0.1)) / (2 * step) for e in np.eye(4)]
    torque(controller, x, 0.1)
    reference = {name: controller.variables[name].valueReference for name in (*names, "tau", "z_desired")}

    def derivative(known):
        return controller.slave.getDirectionalDerivative([reference["tau"]], [reference[known]], [1.0])[0]

    # second order: step**2 = 1e-10 times third derivatives of order 1e3, and rounding 1e-13/step
    assert [derivative(name) for name in names] == pytest.approx(ends, abs=1e-5)
    by_place = (torque(controller, x, 0.1 + step) - torque(controller, x, 0.1 - step)) / (2 * step)
    assert derivative("z_desired") == pytest.approx(by_place, rel=1e-6)
