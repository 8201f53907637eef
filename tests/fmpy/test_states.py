"""A state saved at any time, turned into bytes and restored in another instance, goes on with the same bytes."""

import struct

import pytest
from conftest import NAMES

STEP = 1 / 600
DRIVE = {
    "plant": lambda k: {"tau": 0.05 * ((k * 7919) % 13 - 6)},
    "camera": lambda k: {"q1": 0.0004 * k, "q2": 0.1 + 0.0006 * k, "dq1": 0.24, "dq2": 0.36},
    "controller": lambda k: {"q1": 0.001 * k, "q2": -0.002 * k, "dq1": 0.6, "dq2": -1.2, "z_desired": 0.01 * k},
    "residual": lambda k: {"q1": 0.001 * k, "q2": -0.002 * k, "dq1": 0.6, "dq2": -1.2, "tau_1_in": 0.01 * k},
    "signal": lambda k: {"u": 0.1 * ((k * 7919) % 13 - 6), "d": 0.001 * k},
}
# Friction, a lag and a delay line in the plant; noise, blur, dropped frames and images in flight in the camera.
PARAMETERS = {
    "plant": {"q1_0": 0.02, "b_joint": 0.01, "fc_joint": 0.02, "tau_delay": 0.0123, "T_act": 0.02, "dtau_max": 30.0},
    "camera": {"sigma": 15.0, "E_t": 1.0, "T_delay": 0.11, "drop_rate": 0.2, "N": 1, "k1": 0.05, "seed": 9},
    "controller": {},
    "residual": {"spring_roll": -0.2, "stiff_joint": 0.3, "drag_joint": -0.1, "stribeck_roll": 0.1, "centre_joint": 0.1},
    "signal": {"delay": 0.0123, "saturation": 0.5, "rate_limit": 30.0, "lag": 0.02, "drift": 0.1, "linear": True},
}


def bits(outputs):
    return b"".join(struct.pack("<d", float(value)) for value in outputs.values())


def advance(unit, name, first, last):
    seen = []
    for k in range(first, last):
        unit.set(**DRIVE[name](k)).step(k * STEP, STEP)
        seen.append(bits(unit.outputs()))
    return seen


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("saved_at", [0, 37, 211])
def test_restored_in_another_instance(unit, name, saved_at):
    one = unit(name).start(**PARAMETERS[name])
    advance(one, name, 0, saved_at)
    state = one.slave.getFMUstate()
    data = one.slave.serializeFMUstate(state)
    expected = advance(one, name, saved_at, saved_at + 120)
    assert len(set(expected)) > 1, "something moves"

    other = unit(name).start()
    copy = other.slave.deSerializeFMUstate(data)
    other.slave.setFMUstate(copy)
    assert advance(other, name, saved_at, saved_at + 120) == expected
    other.slave.freeFMUstate(copy)

    one.slave.setFMUstate(state)  # and back in the first
    assert advance(one, name, saved_at, saved_at + 120) == expected
    one.slave.freeFMUstate(state)


@pytest.mark.parametrize("name", NAMES)
def test_reset_goes_back_to_the_start_values(unit, name):
    def values():  # readable from initialisation mode on
        one.slave.setupExperiment(startTime=0.0)
        one.slave.enterInitializationMode()
        return {n: one.get(n) for n in one.variables}

    one = unit(name)
    start = values()
    one.set(**PARAMETERS[name])
    one.slave.exitInitializationMode()
    advance(one, name, 0, 50)
    one.slave.reset()
    assert values() == start


@pytest.mark.parametrize("name", NAMES)
def test_damaged_bytes_are_refused(unit, name):
    one = unit(name).start()
    state = one.slave.getFMUstate()
    data = bytearray(one.slave.serializeFMUstate(state))
    data[len(data) // 2] ^= 0x40
    with pytest.raises(Exception, match="fmi2DeSerializeFMUstate"):
        one.slave.deSerializeFMUstate(bytes(data))
    one.slave.freeFMUstate(state)


@pytest.mark.parametrize("name", NAMES)
def test_nan_is_refused_and_the_instance_lives_on(unit, name):
    one = unit(name).start()
    with pytest.raises(Exception, match="fmi2SetReal"):
        one.set(**{next(iter(DRIVE[name](0))): float("nan")})
    one.set(**DRIVE[name](1)).step(0.0, STEP)


@pytest.mark.parametrize("name", NAMES)
def test_rollback_over_two_steps_under_fmpys_default_flag(unit, name):
    """FMPy promises with each step that no earlier state will be set; OMSimulator's variable steps break the promise."""
    one = unit(name).start(**PARAMETERS[name])
    state = one.slave.getFMUstate()

    def two_steps():
        for k in range(2):
            one.set(**DRIVE[name](k)).step(k * STEP, STEP, no_way_back=True)
        return bits(one.outputs())

    expected = two_steps()
    for _ in range(2):
        one.slave.setFMUstate(state)
        assert two_steps() == expected
    one.slave.freeFMUstate(state)
