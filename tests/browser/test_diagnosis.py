"""The page of a diagnosis, in a real browser."""

import csv
import math
import random
import subprocess
import sys

import pytest
from conftest import LOOKS, ROOT, acroscope, middle, shown, violations

DATA = ROOT / "examples" / "hidden-effect"


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    out = tmp_path_factory.mktemp("diagnosis")
    acroscope("diagnose", DATA, "--out", out)
    return out / "report.html"


@pytest.mark.parametrize("width, height, scheme", LOOKS)
def test_the_page_fits_and_can_be_read(report, look, width, height, scheme):
    page = look(report, width, height, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, "it scrolls sideways"
    assert violations(page) == []
    assert "viscous friction at the joint" in page.locator(".verdict .words").inner_text()


def test_measured_is_the_log_and_amended_comes_nearer_than_nominal(report, look):
    page = look(report)
    titles = page.locator(".graph-head h3").all_inner_texts()
    graph = titles.index("plant.q1 of run-03")
    with open(DATA / "run-03" / "plant.csv", newline="") as file:
        log = {float(row["time"]): float(row["q1"]) for row in csv.DictReader(file) if row["q1"]}
    off = {"nominal": 0.0, "amended": 0.0}
    for share in [0.12, 0.23, 0.34, 0.45, 0.56, 0.67, 0.78, 0.89]:
        box = middle(page, graph)
        page.mouse.move(box["x"] + share * box["width"], box["y"] + 30)
        page.wait_for_function(f"acro.graphs[{graph}].plot.cursor.idx != null")
        time, measured, nominal, amended = shown(page, graph)
        assert measured in [log[near] for near in log if abs(near - time) < 0.05]
        off["nominal"] += abs(nominal - measured)
        off["amended"] += abs(amended - measured)
    # Noise of the encoders is 2e-4 rad; without the friction the model is off by hundredths of a rad.
    assert off["amended"] < 0.3 * off["nominal"], off


def test_a_tab_says_of_which_data_it_is(report, look):
    page = look(report)
    assert page.title() == page.locator("h1").inner_text() == f"Diagnosis of {DATA}"


def test_no_table_is_cut_on_a_phone(report, look):
    page = look(report, 390, 844)
    cut = "(tables) => tables.map((table) => table.scrollWidth - table.clientWidth)"
    assert set(page.locator(".scroll").evaluate_all(cut)) == {0}
    # The interval stands behind its own head.
    assert page.locator("td[data-label='95 %']").first.is_visible() and not page.locator(".cards thead").first.is_visible()


def test_the_page_draws_what_was_found_and_says_nothing_else_of_it(report, look):
    page = look(report)
    titles = page.locator(".graph-head h3").all_inner_texts()
    # Friction shows in the second link's angle; the camera, which has no gap, is not taken as lacking anything.
    assert "Residual of plant.q2 over dq2" in titles and "Residual of plant.q2: autocorrelation" in titles
    words = page.locator("main").inner_text()
    assert "plant.q2 has" in words and "no memory" not in words
    camera = [title for title in titles if title.startswith("Residual of camera.")]
    assert not camera or "Memory alone does not say" in words


@pytest.fixture(scope="module")
def motor(tmp_path_factory):
    """The page of a machine that is not ours: a motor in C, whose logs lack nothing but what was hidden."""
    folder = tmp_path_factory.mktemp("motor")
    subprocess.run([sys.executable, ROOT / "examples" / "make.py"], check=True, capture_output=True, timeout=300)
    logs = [ROOT / "examples" / "motor" / "logs" / f"motor-{run}.csv" for run in (1, 2, 3)]
    acroscope("import", *logs, "--fmu", ROOT / "examples" / "motor" / "motor.fmu", "--out", folder / "set")
    acroscope("diagnose", folder / "set", "--out", folder / "out")
    return folder


@pytest.mark.parametrize("width, height, scheme", LOOKS)
def test_the_page_of_any_unit_fits_and_can_be_read(motor, look, width, height, scheme):
    page = look(motor / "out" / "report.html", width, height, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, "it scrolls sideways"
    assert violations(page) == []
    assert "viscous friction (motor.b)" in page.locator(".verdict .words").inner_text()


def test_any_units_log_is_laid_over_both_models_on_the_run_that_was_left_out(motor, look):
    page = look(motor / "out" / "report.html")
    titles = page.locator(".graph-head h3").all_inner_texts()
    # What lies farthest above its noise comes first.
    assert titles[:3] == ["motor.phi of run-03.csv", "motor.i of run-03.csv", "motor.w of run-03.csv"]
    place = titles.index("motor.w of run-03.csv")
    with open(motor / "set" / "run-03.csv", newline="") as file:
        log = {round(float(row["t [ms]"])): float(row["w [rpm]"]) for row in csv.DictReader(file)}
    off = {"nominal": 0.0, "amended": 0.0}
    rng = random.Random(27)
    for _ in range(10):
        box = middle(page, place)
        page.mouse.move(box["x"] + rng.uniform(0.02, 0.98) * box["width"], box["y"] + 30)
        page.wait_for_function(f"acro.graphs[{place}].plot.cursor.idx != null")
        time, measured, nominal, amended = shown(page, place)
        # The log is in rpm, its time in ms.
        assert measured == pytest.approx(log[round(1000 * time)] * math.pi / 30, rel=1e-9)
        off["nominal"] += abs(nominal - measured)
        off["amended"] += abs(amended - measured)
    # Noise of the speed is 0.05 rad/s; without the friction the model is off by ten times that.
    assert off["amended"] < 0.3 * off["nominal"], off
    assert "Residual of motor.w over motor.u" in titles and "Residual of motor.w: autocorrelation" in titles


@pytest.mark.parametrize("which", ["report", "motor"])
def test_no_graph_is_empty_for_the_most_of_its_axis(which, request, look):
    found = request.getfixturevalue(which)
    page = look(found if which == "report" else found / "out" / "report.html")
    shares = "acro.graphs.map(({ plot }) => [plot.data[0].at(-1) - plot.data[0][0], plot.scales.x.max - plot.scales.x.min])"
    for own, axis in page.evaluate(f"() => {shares}"):
        assert own >= 0.49 * axis
