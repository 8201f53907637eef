"""The signal unit in a foreign master: against scipy and numpy, and as a delay line in the closed loop."""

import numpy as np
import pytest
from conftest import UNITS
from fmpy import simulate_fmu
from scipy.signal import lsim

STEP = 1 / 600
SIGNALS = ("q1", "q2", "dq1", "dq2")


def test_off_it_passes_every_bit(unit):
    signal = unit("signal").start(u=0.1)
    random = np.random.default_rng(3)
    time = 0.0
    assert signal.get("y") == 0.1
    for _ in range(500):
        size, u = random.uniform(1e-4, 0.1), random.normal() * 10.0 ** random.integers(-12, 12)
        assert signal.set(u=u).step(time, size).get("y") == u
        time += size


@pytest.mark.parametrize("linear", [False, True])
def test_delay_lag_gain_and_bias_are_those_of_scipy(unit, linear):
    """lsim with values held ("zero-order hold") and along lines; the delay is a whole number of its steps."""
    h, delay, lag = 0.01, 5, 0.033
    u = np.concatenate([np.zeros(1), np.random.default_rng(4).normal(size=400)])
    system = ([-1.7], [lag, 1.0])
    delayed = np.concatenate([np.zeros(delay), u])[: len(u)]
    time = np.arange(len(u)) * h
    # What is set before a step holds over it, so that lsim sees the value one step earlier.
    driving = delayed if linear else np.append(delayed[1:], 0.0)
    expected = lsim(system, driving, time, interp=linear)[1] + 0.2
    signal = unit("signal").start(delay=delay * h, lag=lag, gain=-1.7, bias=0.2, linear=linear)
    y = [signal.set(u=u[k]).step((k - 1) * h, h).get("y") for k in range(1, len(u))]
    # Exponentials of matrices against libm's, 400 steps.
    assert y == pytest.approx(expected[1:], abs=1e-12)


def test_a_delay_that_fits_no_step_interpolates_as_numpy_does(unit):
    random = np.random.default_rng(5)
    times = np.concatenate([[0.0], np.cumsum(random.uniform(1e-3, 0.05, 500))])
    values = np.concatenate([[0.0], random.normal(size=500)])
    signal = unit("signal").start(delay=0.0777, linear=True)
    for k in range(1, len(times)):
        signal.set(u=values[k]).step(times[k - 1], times[k] - times[k - 1])
        # numpy's own rounding at slopes of up to 1e3 per second
        assert signal.get("y") == pytest.approx(np.interp(times[k] - 0.0777, times, values), abs=1e-10)


def test_simulated_alone_by_fmpy():
    """What a user types first. FMPy sets what u is at the step's beginning; it holds over the step."""
    u = np.array([(0.0, 0.0), (0.1, 0.0), (0.1, 1.0), (1.0, 1.0)], dtype=[("time", float), ("u", float)])
    start = {"lag": 0.2, "delay": 0.1}
    result = simulate_fmu(
        str(UNITS / "signal_effects.fmu"), stop_time=1.0, output_interval=0.01, input=u, start_values=start
    )
    later = result["time"] > 0.205
    assert np.all(result["y"][result["time"] < 0.195] == 0.0)
    expected = 1.0 - np.exp(-(result["time"][later] - 0.2) / 0.2)
    assert result["y"][later] == pytest.approx(expected, abs=1e-12)


def closed_loop(unit, delay, inside):
    """Angles and torque of a balanced acrobot, with a delay inside the plant or in a signal unit before it."""
    controller = unit("controller").start(q1=-0.02, q2=0.04)
    torque = controller.get("tau")
    start = {"tau_delay": delay, "tau_0": torque} if inside else {}
    plant = unit("plant").start(q1_0=-0.02, q2_0=0.04, **start)
    signal = None if inside else unit("signal").start(u=torque, delay=delay)
    seen = []
    for k in range(1800):
        time = k * STEP
        plant.set(tau=torque).step(time, STEP)
        state = dict(zip(SIGNALS, plant.get(*SIGNALS)))
        torque = controller.set(**state).step(time, STEP).get("tau")
        if signal:
            torque = signal.set(u=torque).step(time, STEP).get("y")
        seen.append(plant.get("q1", "q2", "tau_applied"))
    return np.array(seen)


@pytest.mark.parametrize("steps", [0, 1, 7, 12])
def test_a_delay_line_in_the_closed_loop_is_the_plants_own_delay(unit, steps):
    ours, plants = (closed_loop(unit, steps * STEP, inside) for inside in (False, True))
    assert np.array_equal(ours, plants)
    assert np.abs(ours[-1, :2]).max() < 0.02, "it balances"
    if steps:
        assert not np.array_equal(ours, closed_loop(unit, 0.0, True)), "the delay is felt"
