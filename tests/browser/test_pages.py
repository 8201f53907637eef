"""The page of a run, in a real browser."""

import random

import pytest
from conftest import LOOKS, middle, rows, shown, violations


@pytest.mark.parametrize("width, height, scheme", LOOKS)
@pytest.mark.parametrize("run", ["balanced", "fell"])
def test_every_page_fits_and_can_be_read(runs, look, run, width, height, scheme):
    page = look(runs / run / "report.html", width, height, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, "it scrolls sideways"
    assert violations(page) == []
    assert page.locator(".plot canvas").count() == 4
    # The verdict comes before anything else.
    assert page.locator(".verdict").bounding_box()["y"] < page.locator("table, figure").first.bounding_box()["y"]


def test_the_picture_of_a_run_that_failed_is_of_before_and_says_when(runs, look):
    caption = look(runs / "fell" / "report.html").locator("figcaption").filter(has_text="frame").last.inner_text()
    assert "delivered at t = " in caption and "the last one kept before the failure at " in caption
    caption = look(runs / "balanced" / "report.html").locator("figcaption").filter(has_text="frame").last.inner_text()
    assert "delivered at t = " in caption and "failure" not in caption


def test_hover_gives_the_values_of_the_file(runs, look):
    page = look(runs / "balanced" / "report.html")
    by_time = {row["time"]: row for row in rows(runs / "balanced")}
    rng = random.Random(27)
    for _ in range(10):
        box = middle(page)
        page.mouse.move(box["x"] + rng.uniform(2, box["width"] - 2), box["y"] + rng.uniform(2, box["height"] - 2))
        page.wait_for_function("acro.graphs.every((graph) => graph.plot.cursor.idx != null)")
        time, desired, z = shown(page, 0)
        row = by_time[time]
        assert (desired, z) == (row["controller.z_desired"], row["plant.z"])
        # The other graphs' cursors are at the same row.
        assert shown(page, 1) == [time, row["plant.q1"], row["plant.q2"]]
        assert shown(page, 2) == [time, row["controller.tau"]]
        assert shown(page, 3) == [time, row["controller.z_desired"] - row["plant.z"]]


def ranges(page):
    return page.evaluate("acro.graphs.map(({plot}) => [plot.scales.x.min, plot.scales.x.max])")


def test_a_drag_zooms_all_graphs_and_a_double_click_shows_all(runs, look):
    page = look(runs / "balanced" / "report.html")
    assert ranges(page) == [[0, 30]] * 4
    box = middle(page)
    page.mouse.move(box["x"] + 0.2 * box["width"], box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 40, steps=8)
    page.mouse.up()
    page.wait_for_function("acro.graphs[3].plot.scales.x.max < 30")
    zoomed = ranges(page)
    assert all(part == zoomed[0] for part in zoomed)
    # A pixel is 30 s over the width of the plot.
    assert zoomed[0] == pytest.approx([6, 12], abs=3 * 30 / box["width"])
    page.mouse.dblclick(box["x"] + 50, box["y"] + 50)
    page.wait_for_function("acro.graphs[3].plot.scales.x.max === 30")
    assert ranges(page) == [[0, 30]] * 4


def test_the_keyboard_does_what_the_mouse_does(runs, look):
    page = look(runs / "balanced" / "report.html")
    page.locator(".plot").first.focus()
    for key in ["Home", "ArrowRight", "ArrowRight", "ArrowRight"]:
        page.keyboard.press(key)
    page.wait_for_function("acro.graphs[0].plot.cursor.idx === 3")
    assert shown(page, 0)[0] == rows(runs / "balanced")[3]["time"]
    page.keyboard.press("+")
    page.wait_for_function("acro.graphs[1].plot.scales.x.max < 16")
    page.keyboard.press("0")
    page.wait_for_function("acro.graphs[1].plot.scales.x.max === 30")


def test_a_fall_is_scaled_to_what_came_before_it(runs, look):
    page = look(runs / "fell" / "report.html")
    low, high = page.evaluate("[acro.graphs[2].plot.scales.y.min, acro.graphs[2].plot.scales.y.max]")
    before = [row["controller.tau"] for row in rows(runs / "fell") if row["time"] <= 1.8867]
    assert low == pytest.approx(min(before), abs=0.1 * (max(before) - min(before))) and high < 2 * max(before)
    assert "lost balance at 1.887 s" in page.locator(".graph-event").first.inner_text()


def test_without_scripts_there_are_pictures_which_are_those_that_are_saved(runs, look, tmp_path):
    page = look(runs / "balanced" / "report.html", java_script_enabled=False)
    pictures = page.locator("figure.live svg")
    assert pictures.count() == 4 and pictures.first.is_visible()
    page = look(runs / "balanced" / "report.html")
    with page.expect_download() as saved:
        page.get_by_role("button", name="Save State as SVG").click()
    text = saved.value.path().read_text()
    assert saved.value.suggested_filename == "state.svg"
    assert text.startswith("<svg") and "angle in rad" in text and text.rstrip().endswith("</svg>")


def test_nothing_is_lost_of_a_hundred_thousand_points(runs, look):
    page = look(runs / "long" / "report.html")
    written = rows(runs / "long")
    assert len(written) > 100_000
    assert page.evaluate("acro.graphs[0].plot.data[0].length") == len(written)
    q1 = page.evaluate("Array.from(acro.graphs[1].plot.data[1].filter((_, row) => row % 997 === 0))")
    assert q1 == [row["plant.q1"] for row in written[::997]]


def test_paper_is_light_and_has_no_buttons(runs, look):
    page = look(runs / "balanced" / "report.html", scheme="dark")
    page.emulate_media(media="print", color_scheme="dark")
    assert page.get_by_role("button", name="Save State as SVG").is_hidden()
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    page.emulate_media(media="screen", color_scheme="dark")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") != "rgb(255, 255, 255)"


def test_letters_of_a_still_drawing_can_be_read_in_the_hand(runs, look):
    page = look(runs / "balanced" / "report.html", 390, 844)
    drawing = page.locator("figure.still:not(:has(image)) > svg").first
    # Drawn 640 px wide with letters of 11 to 13 px: not much below that, and the page itself stands still.
    assert drawing.evaluate("(svg) => svg.getBoundingClientRect().width") >= 560
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
