"""Our SSP packages in other programs: FMPy checks them against the standard's schema and runs them, libcosim runs them."""

import math

import pytest
from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver


@pytest.fixture(scope="module")
def package(acroscope, tmp_path_factory):
    path = tmp_path_factory.mktemp("ssp") / "visual-servo.ssp"
    acroscope("ssp", "visual-servo", "-o", path, "--quiet")
    return path


def test_a_package_gives_the_same_bytes_as_its_scenario(acroscope, package, tmp_path):
    for what, folder in (("visual-servo", "scenario"), (package, "package")):
        acroscope("run", what, "--stop", 2, "--out", tmp_path / folder, "--quiet")
    rows = [(tmp_path / folder / "results.csv").read_bytes() for folder in ("scenario", "package")]
    assert rows[0] == rows[1] and rows[0].count(b"\n") == 2 * 600 + 2
    acroscope("run", tmp_path / "package" / "resolved.toml", "--out", tmp_path / "again", "--quiet")
    assert (tmp_path / "again" / "results.csv").read_bytes() == rows[0]


def test_fmpy_finds_it_valid_and_runs_it(package):
    description = read_ssd(str(package), validate=True)
    assert description.version == "1.0"
    assert [element.name for element in description.system.elements] == ["plant", "camera", "controller"]
    assert len(description.system.connections) == 10
    rows = simulate_ssp(str(package), stop_time=0.5, step_size=1 / 600)
    assert len(rows) in (300, 301)
    assert all(math.isfinite(value) for name in rows.dtype.names for value in rows[name])
    # It steps all units at once, and gives the camera and the controller what the plant and the camera say.
    assert rows["camera.frame"][-1] >= 13 and abs(rows["plant.q1"][-1]) < 1.0


def test_libcosim_runs_it_from_the_start_values_inside(package):
    execution = CosimExecution.from_ssp_file(str(package))
    assert execution.num_slaves() == 3
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    plant = execution.slave_index_from_instance_name("plant")
    reference = {v.name.decode(): v.reference for v in execution.slave_variables(plant)}
    assert execution.simulate_until(100_000_000)
    q1, q1_0 = observer.last_real_values(plant, [reference["q1"], reference["q1_0"]])
    assert q1_0 == -0.05, "the package sets it"
    assert abs(q1) < 0.5 and q1 != 0.0
