"""A whole scenario as one unit: the bits that it gives in FMPy and libcosim are those of `acroscope run`."""

import csv
import os
import subprocess
import zipfile
from pathlib import Path

import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave
from fmpy.validation import validate_fmu
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

STOP = 2


@pytest.fixture(scope="module")
def made(acroscope, tmp_path_factory):
    """The container, and the rows of a run outside."""
    folder = tmp_path_factory.mktemp("container")
    path = folder / "visual-servo.fmu"
    done = acroscope("container", "visual-servo", "-o", path)
    assert "3 units inside" in done.stdout
    acroscope("run", "visual-servo", "--stop", STOP, "--out", folder / "run", "--quiet")
    with (folder / "run" / "results.csv").open() as file:
        rows = list(csv.DictReader(file))
    return path, rows


class Container:
    def __init__(self, path, folder, name="c"):
        self.description = read_model_description(str(path))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=extract(str(path), unzipdir=str(folder)),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate()

    def start(self, **values):
        self.slave.setupExperiment(startTime=0.0, stopTime=float(STOP))
        self.slave.enterInitializationMode()
        for name, value in values.items():
            self.slave.setReal([self.variables[name].valueReference], [value])
        self.slave.exitInitializationMode()
        return self

    def matches(self, row):
        """How many recorded values are those of a row, to the bit; fails at the first that is not."""
        compared = 0
        for name, cell in row.items():
            variable = self.variables.get(name)
            if variable is None or variable.type == "String" or cell == "":
                continue
            value = getattr(self.slave, "get" + variable.type)([variable.valueReference])[0]
            assert float(value) == float(cell), f"{name} at {row['time']} s"
            compared += 1
        return compared


@pytest.fixture
def container(made, tmp_path):
    all_made = []

    def make(name="c"):
        all_made.append(Container(made[0], tmp_path / f"{name}-{len(all_made)}", name))
        return all_made[-1]

    yield make
    for one in all_made:
        one.slave.freeInstance()


def test_our_own_check_finds_it_without_a_fault(made, acroscope):
    """It runs the unit: a thousand instances, say, none of which may leave anything behind."""
    assert ": 0 errors, " in acroscope("check", made[0]).stdout


def test_fmpy_finds_it_valid(made):
    assert validate_fmu(str(made[0])) == []


def test_every_row_of_a_run_comes_out_of_the_container(made, container):
    one, rows = container().start(), made[1]
    compared = one.matches(rows[0])
    for before, after in zip(rows, rows[1:]):
        one.slave.doStep(float(before["time"]), float(after["time"]) - float(before["time"]))
        compared += one.matches(after)
    assert len(rows) == 600 * STOP + 1 and compared > 30 * len(rows)


@pytest.mark.parametrize("every", [7, 20, 600])
def test_longer_steps_lead_to_the_same_rows(made, container, every):
    one, rows = container().start(), made[1][::every]
    for before, after in zip(rows, rows[1:]):
        one.slave.doStep(float(before["time"]), float(after["time"]) - float(before["time"]))
        assert one.matches(after) > 30


def test_a_millisecond_holds_what_lies_between(made, container):
    one, rows = container().start(), made[1]
    for step in range(200):
        one.slave.doStep(step * 0.001, 0.001)
        # The last point of the plant that is not later: 600 a second.
        one.matches(rows[(step + 1) * 600 // 1000])


def test_states_lead_back_and_instances_are_apart(made, container):
    rows = made[1]
    one, other = container("one").start(), container("other").start(**{"plant.q1_0": 0.01})
    for instance in (one, other):
        instance.slave.doStep(0.0, 0.5)
    assert one.matches(rows[300]) > 30
    with pytest.raises(AssertionError):
        other.matches(rows[300])
    state = one.slave.getFMUState()
    as_bytes = one.slave.serializeFMUstate(state)
    one.slave.doStep(0.5, 0.5)
    assert one.matches(rows[600]) > 30
    one.slave.setFMUState(state)
    one.slave.doStep(0.5, 0.25)
    assert one.matches(rows[450]) > 30
    one.slave.freeFMUState(state)
    # In the other instance, too.
    there = other.slave.deSerializeFMUstate(as_bytes)
    other.slave.setFMUState(there)
    other.slave.doStep(0.5, 0.25)
    assert other.matches(rows[450]) > 30
    one.slave.reset()
    one.start().slave.doStep(0.0, 0.5)
    assert one.matches(rows[300]) > 30


def test_fmpys_own_loop_runs_it(made):
    rows = made[1]
    result = simulate_fmu(str(made[0]), stop_time=1.0, output_interval=0.1, output=["plant.q1", "controller.tau"])
    assert len(result) == 11
    for index, row in enumerate(result):
        assert row["plant.q1"] == float(rows[60 * index]["plant.q1"])


def test_libcosim_runs_it(made):
    path, rows = made
    execution = CosimExecution.from_step_size(step_size=5_000_000)
    index = execution.add_local_slave(CosimLocalSlave(fmu_path=str(path), instance_name="servo"))
    reference = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    assert execution.simulate_until(1_000_000_000)
    names = ["plant.q1", "plant.q2", "camera.q1_est", "controller.tau"]
    values = observer.last_real_values(index, [reference[name] for name in names])
    for name, value in zip(names, values):
        assert value == float(rows[600][name]), name


def test_a_description_of_another_scenario_is_refused(made, tmp_path):
    one = read_model_description(str(made[0]))
    slave = FMU2Slave(
        guid="{00000000-0000-0000-0000-000000000000}",
        unzipDirectory=extract(str(made[0]), unzipdir=str(tmp_path / "u")),
        modelIdentifier=one.coSimulation.modelIdentifier,
        instanceName="wrong",
    )
    with pytest.raises(Exception):
        slave.instantiate()


OWN_UNIT = r"""
#include <stdlib.h>
typedef struct { double x, crash; } Unit;
const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
void *fmi2Instantiate(const char *n, int t, const char *g, const char *r, const void *c, int v, int l) {
    return calloc(1, sizeof(Unit));
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int d, double t, double a, int s, double b) { return 0; }
int fmi2EnterInitializationMode(void *c) { return 0; }
int fmi2ExitInitializationMode(void *c) { return 0; }
int fmi2Terminate(void *c) { return 0; }
int fmi2Reset(void *c) { ((Unit *)c)->x = 0; return 0; }
int fmi2GetReal(void *c, const unsigned *r, size_t n, double *y) {
    for (size_t i = 0; i < n; i++) y[i] = r[i] ? ((Unit *)c)->crash : ((Unit *)c)->x;
    return 0;
}
int fmi2SetReal(void *c, const unsigned *r, size_t n, const double *y) {
    for (size_t i = 0; i < n; i++) if (r[i]) ((Unit *)c)->crash = y[i];
    return 0;
}
int fmi2DoStep(void *c, double t, double h, int no) {
    unsigned x = 0;
    double before;
    /* By the name that every unit exports, as many units of other tools do. */
    if (fmi2GetReal(c, &x, 1, &before)) return 3;
    ((Unit *)c)->x = before + h;
    if (((Unit *)c)->crash > 0 && before + h > ((Unit *)c)->crash) abort();
    return 0;
}
"""

OWN_DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="own" guid="{own}">
<CoSimulation modelIdentifier="own" canHandleVariableCommunicationStepSize="true"/>
<ModelVariables>
<ScalarVariable name="x" valueReference="0" causality="output" initial="exact"><Real start="0"/></ScalarVariable>
<ScalarVariable name="crash" valueReference="1" causality="parameter" variability="tunable"><Real start="0"/></ScalarVariable>
</ModelVariables>
<ModelStructure><Outputs><Unknown index="1" dependencies=""/></Outputs></ModelStructure>
</fmiModelDescription>
"""


def test_an_isolated_unit_that_crashes_ends_its_container_and_not_the_master(acroscope, tmp_path):
    source, library = tmp_path / "own.c", tmp_path / "own.so"
    source.write_text(OWN_UNIT)
    subprocess.run(["cc", "-O1", "-w", "-shared", "-fPIC", "-o", library, source], check=True)
    with zipfile.ZipFile(tmp_path / "own.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", OWN_DESCRIPTION)
        archive.write(library, "binaries/linux64/own.so")
    scenario = tmp_path / "own.toml"
    scenario.write_text(
        'format = 1\nexperiment = { stop = 2 }\n[[units]]\nname = "own"\nfmu = "own.fmu"\ninterval = 0.125\nisolate = true\n'
    )
    path = tmp_path / "one.fmu"
    acroscope("container", scenario, "-o", path)
    one, other = (Container(path, tmp_path / name, name) for name in ("one", "other"))
    one.start(**{"own.crash": 0.6})
    other.start()
    own = one.variables["own.x"].valueReference
    processes = children()
    assert len(processes) == 2, "one a unit"
    for step in range(4):
        for instance in (one, other):
            instance.slave.doStep(step * 0.125, 0.125)
            assert instance.slave.getReal([own]) == [0.125 * (step + 1)]
    with pytest.raises(Exception, match="fmi2DoStep"):
        one.slave.doStep(0.5, 0.125)
    # This process is the master; the other instance goes on, and so does a fresh start of the first.
    other.slave.doStep(0.5, 1.0)
    assert other.slave.getReal([own]) == [1.5]
    one.slave.freeInstance()
    assert children() < processes
    other.slave.freeInstance()
    assert children() == set()


def children():
    """Processes of units that this one has started."""
    task = Path("/proc/self/task") / str(os.getpid()) / "children"
    return {child for child in task.read_text().split() if "one" in Path(f"/proc/{child}/cmdline").read_text()}
