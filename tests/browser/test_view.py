"""`acroscope view`, in a real browser."""

import re
import signal
import subprocess

import pytest
from conftest import LOOKS, PROGRAM, ROOT, acroscope, environment, rows, violations

# A scenario without our machine.
OTHER = """
format = 1
description = "A delay"
[experiment]
start = 0
stop = 1
[[units]]
name = "late"
fmu = "signal_effects.fmu"
interval = "1/100"
[[units]]
name = "later"
fmu = "signal_effects.fmu"
interval = "1/50"
[[connections]]
from = "late.y"
to = "later.u"
[[sources]]
to = "late.u"
kind = "linear"
points = [[0, 0], [1, 1]]
"""


@pytest.fixture(scope="session")
def views(runs):
    """Pages of one run and of two, and of a scenario without our machine."""
    acroscope("view", runs / "balanced", "-o", runs / "one.html")
    acroscope("view", runs / "balanced", runs / "fell", "-o", runs / "two.html")
    (runs / "other.toml").write_text(OTHER)
    acroscope("run", runs / "other.toml", "--out", runs / "other")
    acroscope("view", runs / "other", "-o", runs / "other.html")
    return runs


def time(page):
    return page.evaluate("acro.clock.state.time")


def pixels(page, name):
    """How many pixels of a canvas are not as its first one."""
    return page.evaluate(
        """(name) => { const canvas = document.querySelector(name);
        const all = new Uint32Array(canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data.buffer);
        return all.reduce((sum, pixel) => sum + (pixel !== all[0]), 0); }""",
        name,
    )


@pytest.mark.parametrize("width, height, scheme", LOOKS)
@pytest.mark.parametrize("name", ["one", "two", "other"])
def test_every_view_fits_and_can_be_read(views, look, name, width, height, scheme):
    page = look(views / f"{name}.html", width, height, scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= width, "it scrolls sideways"
    assert violations(page) == []


def test_it_plays_pauses_and_steps_by_frame(views, look):
    page = look(views / "one.html")
    assert pixels(page, "canvas.scene") > 500 and pixels(page, "canvas.camera") > 50
    page.select_option("#speed", "8")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("acro.clock.state.time > 1")
    page.get_by_role("button", name="Pause").click()
    stopped = time(page)
    page.wait_for_timeout(200)
    assert time(page) == stopped
    written = rows(views / "balanced")
    frame_at = {row["time"]: row["camera.frame_index"] for row in written}
    page.get_by_role("button", name="One frame on").click()
    first = frame_at[time(page)]
    page.get_by_role("button", name="One frame on").click()
    assert frame_at[time(page)] == first + 1
    page.get_by_role("button", name="One frame back").click()
    assert frame_at[time(page)] == first
    # The graphs' cursors go with the clock.
    cursor = page.evaluate("acro.graphs.map(({plot}) => plot.data[0][plot.cursor.idx])")
    assert cursor == [pytest.approx(time(page), abs=0.05)] * len(cursor)


def test_the_pose_is_that_of_the_file(views, look):
    page = look(views / "one.html")
    for row in rows(views / "balanced")[::3000]:
        drawn = page.evaluate(
            """(time) => { const run = acro.run(acro.data('view').runs[0]);
            return [run.at('q1', time), run.at('q2', time), run.part('u3', run.row(time))]; }""",
            row["time"],
        )
        assert drawn == [row["plant.q1"], row["plant.q2"], row["camera.u3"]]


def test_a_picture_that_was_kept_is_shown_itself(views, look):
    page = look(views / "one.html")
    kept = next(row["time"] for row in rows(views / "balanced") if row["camera.frame_index"] == 150)
    page.evaluate("(time) => acro.clock.go(time)", kept)
    page.wait_for_function("document.querySelector('.of-camera').textContent.includes('the picture itself')")
    page.evaluate("(time) => acro.clock.go(time)", kept + 0.1)
    said = page.locator(".of-camera").inner_text()
    assert "Frame 153, drawn" in said and "drum" in said and "tip" in said


def test_the_camera_is_compared_with_what_it_looks_at(views, look):
    # Its arm is another one than the robot's, which is drawn.
    acroscope("run", "dual-loop", "--stop", 8, "--out", views / "dual")
    acroscope("view", views / "dual", "-o", views / "dual.html")
    page = look(views / "dual.html")
    page.evaluate("acro.clock.go(7.5)")
    apart = re.search(r"Apart: (.*) px", page.locator(".of-camera").inner_text()).group(1)
    # Centroids of grey pixels are found within hundredths of a pixel; the two arms are tens of pixels apart.
    assert all(float(entry.split()[1]) < 0.2 for entry in apart.split(", ")), apart


def test_two_runs_stand_side_by_side_on_one_clock(views, look):
    page = look(views / "two.html")
    left, right = [stage.bounding_box() for stage in page.locator(".stage").all()]
    assert left["y"] == right["y"] and left["x"] < right["x"]
    labels = page.locator(".plot").first.locator(".u-label").all_inner_texts()
    assert "z (A)" in labels and "z (B)" in labels
    page.select_option("#add", "plant.dq1")
    assert page.locator(".plot").last.locator(".u-label").all_inner_texts()[1:] == ["plant.dq1 (A)", "plant.dq1 (B)"]


@pytest.mark.parametrize("width, height", [(1400, 900), (1280, 720)])
def test_the_clock_of_two_runs_is_seen_without_scrolling(views, look, width, height):
    page = look(views / "two.html", width, height)
    for name in ("#play", "#clock"):
        box = page.locator(name).bounding_box()
        assert 0 <= box["y"] and box["y"] + box["height"] <= height, (name, box)
    page.mouse.wheel(0, 600)
    page.wait_for_function("scrollY > 100")
    assert page.locator("#play").bounding_box()["y"] >= 0, "it stays"


@pytest.mark.parametrize("width, height, scheme", LOOKS)
def test_a_name_as_long_as_names_may_be_makes_no_page_wide(views, look, width, height, scheme):
    (views / "named.toml").write_text(OTHER.replace('"late', '"' + 200 * "l").replace("A delay", 200 * "d"))
    acroscope("run", views / "named.toml", "--out", views / "named")
    acroscope("view", views / "named", "-o", views / "named.html")
    for page in (look(views / "named.html", width, height, scheme), look(views / "named" / "report.html", width, height, scheme)):
        assert page.evaluate("document.documentElement.scrollWidth") <= width, "it scrolls sideways"


def test_a_scenario_without_our_machine_shows_signals_and_connections(views, look):
    page = look(views / "other.html")
    assert page.locator("canvas.scene").count() == 0 and page.locator(".plot").count() > 0
    assert page.locator("svg.wiring").count() == 1 and page.get_by_role("img", name="timing diagram").count() == 1
    assert page.get_by_role("cell", name="late.y").count() == 1
    # Results don't say in what they are measured, so no two signals share an axis; a picture of few units is not blown up.
    assert page.evaluate("acro.graphs.map(({ plot }) => plot.series.length)") == [2] * page.locator(".plot").count()
    assert page.evaluate("(([drawn]) => drawn.getBoundingClientRect().width <= Number(drawn.getAttribute('width')))(document.querySelectorAll('svg.wiring'))")


def test_it_is_served_until_it_is_told_to_end(views, look):
    words = [PROGRAM, "view", views / "balanced"]
    with subprocess.Popen(words, cwd=ROOT, env=environment(), stdout=subprocess.PIPE, text=True) as server:
        try:
            address = next(word for word in server.stdout.readline().split() if word.startswith("http"))
            assert address.startswith("http://127.0.0.1:")
            assert look(address).locator("canvas.scene").count() == 1
        finally:
            server.send_signal(signal.SIGINT)
        assert server.wait(timeout=10) == 0


def test_a_boolean_is_drawn_as_steps_and_an_angle_is_not(views, look):
    page = look(views / "one.html")
    for name, held in (("plant.contact", True), ("plant.q1", False)):
        page.select_option("#add", name)
        assert page.evaluate("acro.graphs.at(-1).described.lines[0].held") is held, name
        assert page.locator(".plot canvas").count() == page.locator(".plot").count()
