"""The same loop stepped by three masters: ours, a page of Python on FMPy, and libcosim."""

import csv

import pytest
from conftest import UNITS
from fmpy_closed_loop import rows
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

STOP = 3
LINKED = ("plant", "camera", "controller")


def test_fmpy_and_our_master_agree_to_the_last_bit(acroscope, tmp_path):
    acroscope("run", "visual-servo", "--stop", STOP, "--out", tmp_path, "--quiet")
    with (tmp_path / "results.csv").open() as file:
        ours = list(csv.DictReader(file))
    compared = 0
    for mine, theirs in zip(ours, rows(STOP), strict=True):
        assert float(mine["time"]) == theirs["time"]
        for name, value in theirs.items():
            if name in mine:
                compared += 1
                assert float(mine[name]) == float(value), f"{name} at {theirs['time']} s"
    assert len(ours) == 600 * STOP + 1 and compared > 20 * len(ours)


def test_libcosim_balances_the_acrobot():
    """libcosim steps all units at once (Jacobi) on a clock of whole nanoseconds: a millisecond it can express.

    libcosimpy 0.0.6 can't connect Integers, so the controller computes at every point from the newest estimate.
    """
    execution = CosimExecution.from_step_size(step_size=1_000_000)
    index = {}
    slaves = {name: CosimLocalSlave(fmu_path=str(UNITS / f"acrobot_{name}.fmu"), instance_name=name) for name in LINKED}
    for name, slave in slaves.items():
        index[name] = execution.add_local_slave(slave)
    reference = {
        name: {v.name.decode(): v.reference for v in execution.slave_variables(index[name])} for name in LINKED
    }
    execution.real_initial_value(index["plant"], reference["plant"]["q1_0"], -0.05)
    execution.real_initial_value(index["plant"], reference["plant"]["q2_0"], 0.1)
    links = [(("plant", name), ("camera", name)) for name in ("q1", "q2", "dq1", "dq2")]
    links += [(("camera", f"{name}_est"), ("controller", name)) for name in ("q1", "q2", "dq1", "dq2")]
    links += [(("controller", "tau"), ("plant", "tau"))]
    for (source, output), (target, variable) in links:
        status = execution.connect_real_variables(
            index[source], reference[source][output], index[target], reference[target][variable]
        )
        assert status == 0, f"{source}.{output} -> {target}.{variable}"
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.simulate_until(6_000_000_000)
    q1, q2 = observer.last_real_values(index["plant"], [reference["plant"]["q1"], reference["plant"]["q2"]])
    # At rest but for the chatter of quantised estimates, which moves the arm by some 0.01 rad.
    assert abs(q1) < 0.05 and abs(q2) < 0.05
    frames = observer.last_integer_values(index["camera"], [reference["camera"]["frame"]])[0]
    assert frames == pytest.approx(181, abs=1)
