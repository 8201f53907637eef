"""The truth agrees with scipy, and every unit with the truth, at nominal values and away from them."""

import numpy as np
import pytest
from fmpy import simulate_fmu
from scipy.integrate import solve_ivp

from . import excite
from .machines import ALL
from .replay import alone, run
from .simulate import held, neutral, simulate, variants


def run_of(machine, seed=3):
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, min(2.0, machine.duration) if machine.row < 1 else 60 * machine.row, machine.row)
    return times, excite.commands(machine, times, rng), excite.start(machine, rng)


def changed(machine):
    """Every parameter 20 % of what may be hidden off."""
    moved = {one.name: one.value * (1 + 0.2 * one.hide) if one.scale == "relative" else 0.2 * one.hide for one in machine.parameters}
    return [{}, {name: value for name, value in moved.items() if value}]


@pytest.mark.parametrize("machine", ALL.values(), ids=ALL)
def test_truth_is_scipys(machine):
    times, commands, start = run_of(machine)
    p = variants(machine, changed(machine))
    ours = simulate(machine, p, times, commands, start)
    for variant in range(2):
        one = {name: values[variant] for name, values in p.items()}
        x, rows = np.array(start, float), []
        for row, at in enumerate(times):
            now = {i.name: commands[i.name][max(row - 1, 0)] for i in machine.inputs}
            rows.append([float(y) for y in machine.outputs(x, now, one)])
            if row + 1 == len(times):
                break

            def slope(t, x):
                return machine.rhs(x, {i.name: held(times, commands[i.name], t, i.hold) for i in machine.inputs}, one)

            # within a held row, so that no jump lies inside
            ends = (at, times[row + 1] - 1e-6 * machine.row)
            x = solve_ivp(slope, ends, x, rtol=1e-9, atol=1e-12, method="DOP853").y[:, -1]
        for place, output in enumerate(machine.outputs_of):
            off = np.abs(ours[output.name][:, variant] - np.array(rows)[:, place])
            # a tenth of the sensors' noise: whoever fits to the noise sees no difference
            assert off[1:-1].max() < 0.1 * output.noise, (output.name, variant, off.max())


@pytest.mark.parametrize(("effect", "size"), [("i:delay", 1.6), ("i:delay", 0.3), ("i:lag", 1.3), ("i:lag", 0.4)])
def test_an_output_that_follows_an_input_at_once_shows_it_late_by_as_much(effect, size):
    machine = ALL["cell"]
    times, commands, start = run_of(machine)
    ours = simulate(machine, variants(machine, [{effect: size}]), times, commands, start)
    one, command = machine.nominal(), commands["i"]

    def late(t):
        """What acts just before t."""
        if effect == "i:delay":
            return command[max(0, np.searchsorted(times, t - size - 1e-6) - 1)]
        value = command[0]
        for row in range(1, np.searchsorted(times, t - 1e-6)):
            until = min(t, times[row + 1]) if row + 1 < len(times) else t
            value = command[row] + (value - command[row]) * np.exp(-(until - times[row]) / size)
        return value

    x, shown = np.array(start, float), []
    for row, at in enumerate(times):
        shown.append(machine.outputs(x, {"i": late(at)}, one)[0])
        if row + 1 < len(times):
            # a jump lies within a row
            for ends in ((at, at + size % machine.row), (at + size % machine.row, times[row + 1])):
                inside = 0.5 * (ends[0] + ends[1])

                def slope(t, x, inside=inside):
                    return machine.rhs(x, {"i": late(inside if effect == "i:delay" else t + 1e-5)}, one)

                x = solve_ivp(slope, ends, x, rtol=1e-8, atol=1e-11).y[:, -1]
    # a tenth of the sensor's noise, 1 mV
    assert np.abs(ours["v_cell"][:, 0] - np.array(shown)).max() < 1e-4


def together(machine, folder):
    """Several units in FMPy, which hands on what each gave last."""
    times, commands, start = run_of(machine)
    ours = simulate(machine, variants(machine, [{}]), times, commands, start)
    fed = {machine.full(one.name): (times, commands[one.name], one.hold) for one in machine.inputs}
    starts = {machine.full(state.start): value for state, value in zip(machine.states, start, strict=True)}
    names = [machine.full(one.name) for one in machine.outputs_of]
    found = run(alone(machine, folder), [folder], fed, starts, names, times)
    for output, name in zip(machine.outputs_of, names, strict=True):
        # held for a step between the units: below the sensors' noise, as a user's own scenario would be
        assert np.abs(found[name] - ours[output.name][:, 0])[:-1].max() < output.noise, name


def late(machine, folder):
    """A unit that heeds values in initialization mode only, where FMPy's own loop sets none. What it computes in a step only is a row late."""
    times, commands, start = run_of(machine)
    ours = simulate(machine, variants(machine, changed(machine)), times, commands, start)
    fed = {machine.full(one.name): (times, commands[one.name], one.hold) for one in machine.inputs}
    starts = {machine.full(state.start): value for state, value in zip(machine.states, start, strict=True)}
    shown = [one for one in machine.outputs_of if one.name != machine.late]
    scenario = alone(machine, folder) | {"interval": machine.row}
    for variant, change in enumerate(changed(machine)):
        values = starts | {machine.full(name): value for name, value in change.items()}
        found = run(scenario, [folder], fed, values, [machine.full(one.name) for one in shown], times)
        for output in shown:
            off = np.abs(found[machine.full(output.name)] - ours[output.name][:, variant])
            assert off.max() < 0.2 * output.noise, (output.name, variant, off.max())


@pytest.mark.parametrize("machine", ALL.values(), ids=ALL)
def test_units_are_the_truth(machine, tmp_path):
    fmu = machine.build(machine, tmp_path)
    if machine.scenario:
        return together(machine, tmp_path)
    if machine.late:
        return late(machine, tmp_path)
    times, commands, start = run_of(machine)
    names = [(one.name, float) for one in machine.inputs]
    fed = np.array([(at, *(commands[name][row] for name, _ in names)) for row, at in enumerate(times)], [("time", float), *names])
    ours = simulate(machine, variants(machine, changed(machine)), times, commands, start)
    for variant, change in enumerate(changed(machine)):
        begun = {} if machine.fixed else {state.start: value for state, value in zip(machine.states, start, strict=True)}
        values = begun | change
        table = simulate_fmu(
            str(fmu), start_time=0.0, stop_time=times[-1], output_interval=machine.step or machine.row, input=fed,
            output=[one.name for one in machine.outputs_of], start_values=values,
        )  # fmt: skip
        for output in machine.outputs_of:
            off = np.abs(np.interp(times, table["time"], table[output.name]) - ours[output.name][:, variant])
            # the unit holds what the truth draws as a line between rows: half of its steps late there, of some 60 rad/s
            bound = 0.2 * output.noise if not machine.step else 30 * machine.step * np.ptp(ours[output.name])
            assert off[2:-1].max() < bound, (output.name, variant, off.max(), bound)


def test_neutral_values_do_nothing():
    machine = ALL["motor"]
    times, commands, start = run_of(machine)
    assert neutral(machine)["u:gain"] == 1.0
    # a delay of a row is the input of the row before, a gain of two twice the input
    shifted = {"u": np.concatenate([commands["u"][:1], commands["u"][:-1]])}
    late = simulate(machine, variants(machine, [{"u:delay": machine.row}, {}]), times, commands, start)
    moved = simulate(machine, variants(machine, [{}, {"u:gain": 2.0}]), times, shifted, start)
    assert np.allclose(late["w"][:, 0], moved["w"][:, 0], atol=1e-9)
    doubled = simulate(machine, variants(machine, [{}]), times, {"u": 2 * shifted["u"]}, start)
    assert np.allclose(doubled["w"][:, 0], moved["w"][:, 1], atol=1e-9)


def test_a_delay_is_no_whole_number_of_substeps():
    machine = ALL["motor"]
    times, commands, start = run_of(machine)
    delay = 0.17 * machine.row
    ours = simulate(machine, variants(machine, [{"u:delay": delay}]), times, commands, start)["w"][:, 0]
    p = machine.nominal()
    x, found = np.array(start, float), [start[1]]
    for row in range(len(times) - 1):
        jump, old = times[row] + delay, commands["u"][max(row - 1, 0)]
        for ends, value in (((times[row], jump), old), ((jump, times[row + 1]), commands["u"][row])):
            x = solve_ivp(lambda t, x, u=value: machine.rhs(x, {"u": u}, p), ends, x, rtol=1e-9, atol=1e-12).y[:, -1]
        found.append(x[1])
    # a mean over a substep of 2.5 ms in place of the jump inside it
    assert np.abs(ours - found).max() < 0.2 * machine.outputs_of[1].noise
