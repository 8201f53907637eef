"""The page of a diagnosis, in a real browser."""

import csv

import pytest
from conftest import LOOKS, ROOT, acroscope, shown
from test_pages import middle, violations

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
