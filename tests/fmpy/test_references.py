"""The reference results inside our units: the manifest is as the Layered Standard References has it, and FMPy, given nothing but
what lies in the archive, gets the results that lie there."""

import io
import re
import zipfile
from pathlib import PurePosixPath
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import IDENTIFIERS, NAMES, ROOT, UNITS
from fmpy import simulate_fmu

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
ROLES = (
    "document|requirement|specification|model|parameter|system|testcase|experiment(/(smoke-test|validation|uncertainty-analysis))?|result"
    "|method|rationale|report|request|delivery|configuration|signature|serialized-state(/.*)?|meta-data|other"
)


@pytest.fixture(params=NAMES)
def fmu(request):
    return UNITS / f"{IDENTIFIERS[request.param]}.fmu"


def files(fmu):
    with zipfile.ZipFile(fmu) as archive:
        inside = [name for name in archive.namelist() if name.startswith(FOLDER)]
        return {str(PurePosixPath(name).relative_to(FOLDER)): archive.read(name) for name in inside}


def table(content):
    return np.genfromtxt(io.BytesIO(content), delimiter=",", names=True)


def test_the_manifest_names_each_file_with_a_role_of_the_standard(fmu):
    inside = files(fmu)
    root = ElementTree.fromstring(inside.pop("fmi-ls-manifest.xml"))
    assert root.tag == "fmiReferences"
    assert root.get(f"{NAMESPACE}fmi-ls-name") == "org.fmi-standard.fmi-ls-ref"
    assert root.get(f"{NAMESPACE}fmi-ls-version") == "1.0.0-alpha.1"
    fixed = "Layered Standard providing information on related files included in an FMU."
    assert root.get(f"{NAMESPACE}fmi-ls-description") == fixed
    related = {entry.get("source"): entry for entry in root.findall("Related")}
    assert len(related) == len(root) and set(related) == set(inside)
    for entry in related.values():
        assert re.fullmatch(ROLES, entry.get("role"))
        assert set(entry.keys()) == {"type", "source", "role", "description"}
    assert related["smoke-test.exp"].get("role") == "experiment/smoke-test"


def test_the_results_are_those_of_the_unit(fmu):
    inside = files(fmu)
    experiment = ElementTree.fromstring(inside["smoke-test.exp"]).find("Experiment")
    times = {name: float(value) for name, value in experiment.find("TransientSimulation").items()}
    parameters = {}
    if (source := experiment.find("Parameters")) is not None:
        values = ElementTree.fromstring(inside[source.get("source")])
        parameters = {one.get("name"): float(one[0].get("value")) for one in values.iter() if one.tag.endswith("}Parameter")}
    given = table(inside[experiment.find("Stimuli").get("source")])
    expected = table(inside[experiment.find("References").get("source")])
    again = simulate_fmu(
        str(fmu),
        start_time=times["startTime"],
        stop_time=times["stopTime"],
        step_size=times["stepSize"],
        output_interval=times["stepSize"],
        start_values=parameters,
        input=given,
    )
    assert again.dtype.names == expected.dtype.names and len(again) == len(expected) == 51
    for name in expected.dtype.names:
        # The unit gives the same bits on every machine; what differs is the master's sum of times, 1e-16 a step.
        np.testing.assert_allclose(again[name], expected[name], rtol=1e-9, atol=1e-12, err_msg=name)
    moves = [name for name in expected.dtype.names if np.ptp(expected[name]) > 0]
    assert len(moves) > 1, "a test in which nothing moves would say nothing"


def test_they_are_the_committed_ones(fmu):
    unit = fmu.stem.removeprefix("acrobot_")
    committed = ROOT / "fmus" / unit / "fmu" / FOLDER
    assert {path.name: path.read_bytes() for path in committed.iterdir()} == files(fmu)
