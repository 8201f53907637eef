"""The page of a sweep, in a real browser."""

import statistics

import pyarrow.parquet as parquet
import pytest
from conftest import LOOKS, acroscope, middle, shown, violations

# A parameter over three decades.
DECADES = """
format = 1
scenario = "visual-servo"
stop = 0.3
[latin-hypercube]
count = 12
seed = 1
"camera.sigma" = { from = 0.01, to = 10, scale = "log" }
[scalars]
last = { signal = "plant.q1", reduce = "last" }
"""


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    out = tmp_path_factory.mktemp("sweep")
    grids = ["--grid", "camera.T_delay=0:0.06:0.02", "--grid", "camera.omega_cam=15,30,60"]
    rms = ["--scalar", "rms=controller.z_desired-plant.z:rms", "--scalar", "fell=plant.contact:first_true", "--until", "plant.contact", "--stop", 2]
    acroscope("sweep", "visual-servo", *grids, *rms, "--out", out / "two")
    acroscope("sweep", "visual-servo", *grids[:2], *rms, "--out", out / "one")
    return out


def cases(folder):
    return parquet.read_table(folder / "cases").to_pylist()


@pytest.mark.parametrize("width, height, scheme", LOOKS)
@pytest.mark.parametrize("name", ["one", "two"])
def test_every_page_fits_and_can_be_read(swept, look, name, width, height, scheme):
    page = look(swept / name / "report.html", width, height, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, "it scrolls sideways"
    assert violations(page) == []
    assert page.locator(".verdict").bounding_box()["y"] < page.locator("table, figure").first.bounding_box()["y"]


def test_a_curve_has_the_values_of_the_cases(swept, look):
    page = look(swept / "one" / "report.html")
    values = {case["camera.T_delay"]: case["rms"] for case in cases(swept / "one")}
    titles = page.locator(".graph-head h3").all_inner_texts()
    graph = next(number for number, title in enumerate(titles) if title.startswith("rms of"))
    for share in [0.01, 0.3, 0.6, 0.99]:
        box = middle(page, graph)
        page.mouse.move(box["x"] + share * (box["width"] - 1), box["y"] + 20)
        page.wait_for_function(f"acro.graphs[{graph}].plot.cursor.idx != null")
        delay, line, dot = shown(page, graph)
        assert line == dot == values[delay]


def test_a_map_tells_the_value_of_each_cell(swept, look):
    page = look(swept / "two" / "report.html")
    figure = page.locator("figure.map").filter(has_text="rms of")
    for case in cases(swept / "two"):
        # Each cell by the keyboard: from wherever it is, first to the corner.
        figure.focus()
        for key, times in [("ArrowLeft", 3), ("ArrowDown", 4)]:
            for _ in range(times):
                page.keyboard.press(key)
        for _ in range([15, 30, 60].index(case["camera.omega_cam"])):
            page.keyboard.press("ArrowRight")
        for _ in range(round(case["camera.T_delay"] / 0.02)):
            page.keyboard.press("ArrowUp")
        said = figure.locator(".reading").inner_text()
        assert f" {case['camera.omega_cam']:g}, " in said and said.endswith(f"rms {case['rms']!r}"), said
    figure.locator("rect.marked").hover()


def test_larger_is_darker_on_every_map_and_a_bar_says_how_large(swept, look):
    page = look(swept / "two" / "report.html")
    for name in ("rms", "fell"):
        figure = page.locator("figure.map").filter(has_text="rms of" if name == "rms" else "first time of")
        there = sorted((case["camera.T_delay"], case["camera.omega_cam"], case[name]) for case in cases(swept / "two") if case[name] is not None)
        blue = "(cells) => cells.map((cell) => parseInt((cell.getAttribute('fill') || '').slice(1, 3), 16))"
        # Rows of the map go up with the delay, as the cases do; the paper comes first, the bar last.
        red = figure.locator("rect").evaluate_all(blue)[1 : 1 + len(there)]
        values = [value for _, _, value in there]
        assert min(red) == red[values.index(max(values))] and max(red) == red[values.index(min(values))], (name, red, values)
        words = figure.locator("svg").inner_html()
        assert all(f"{end:.4g}" in words for end in (min(values), max(values))), name
    assert "earliest fell" in page.locator(".verdict").inner_text()


def test_a_map_turns_dark_with_its_page(swept, look):
    page = look(swept / "two" / "report.html", scheme="dark")
    assert "invert" in page.locator("figure.map > svg").first.evaluate("(svg) => getComputedStyle(svg).filter")


def test_cases_are_narrowed_to_those_that_fell(swept, look):
    page = look(swept / "two" / "report.html")
    fell = [case["case"] for case in cases(swept / "two") if case["fell"] is not None]
    assert 0 < len(fell) < 12
    page.get_by_role("button", name=f"with fell ({len(fell)})").click()
    assert [row.get_attribute("id") for row in page.locator(".filtered tbody tr:visible").all()] == [f"case-{case}" for case in fell]


@pytest.mark.parametrize("study", ["one", "two"])
def test_the_median_of_an_even_number_lies_between_two(swept, look, study):
    page = look(swept / study / "report.html")
    told = page.evaluate("[...document.querySelectorAll('tr')].map((row) => [...row.cells].map((cell) => cell.textContent))")
    even = 0
    for name in ("rms", "fell"):
        values = [row[name] for row in cases(swept / study) if row[name] is not None]
        row = next(cells for cells in told if cells[0] == name and len(cells) == 7)
        assert int(row[3]) == len(values)
        # Four digits are shown.
        assert float(row[5]) == pytest.approx(statistics.median(values), rel=1e-3)
        even += len(values) % 2 == 0 and len(set(values)) > 1
    assert even, "no scalar has an even number of values: the test would not fail"


def test_ticks_of_a_map_stand_at_the_values_of_the_grid(swept, look):
    texts = look(swept / "two" / "report.html").locator("figure.map").first.locator("svg text").all_text_contents()
    numbers = [float(text) for text in texts if text.strip().replace(".", "", 1).removeprefix("-").isdigit()]
    assert {15, 30, 60, 0, 0.02, 0.04, 0.06} <= set(numbers) and min(numbers) >= 0, numbers


def test_a_parameter_in_decades_has_an_axis_in_decades(swept, look):
    (swept / "decades.toml").write_text(DECADES)
    acroscope("sweep", swept / "decades.toml", "--out", swept / "decades")
    page = look(swept / "decades" / "report.html")
    places = page.evaluate("(({ plot }) => [0.01, 0.1, 1, 10].map((value) => plot.valToPos(value, 'x')))(acro.graphs[0])")
    assert statistics.pstdev(b - a for a, b in zip(places, places[1:])) < 0.5 and places[0] < places[1], places
    assert violations(page) == []
