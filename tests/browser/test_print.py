"""Pages on paper: light, nothing cut at the right, no controls, every graph drawn."""

import pytest
from conftest import ROOT, acroscope

# A4 with the browser's own margins of 0.4 in, at 96 px an inch; letters are wider.
PAPER = 716
# What sticks out of the page on the right, of all that can be seen.
CUT = """() => [...document.querySelectorAll("main *")]
  .filter((one) => one.getClientRects().length && one.getBoundingClientRect().right > innerWidth + 1)
  .filter((one) => !one.parentElement.closest("svg"))
  .map((one) => one.tagName + " " + one.className + " " + one.textContent.slice(0, 40)).slice(0, 5)"""
# Graphs whose canvas shows nothing but one colour.
BLANK = """() => acro.graphs.filter(({ plot }) => {
  const pen = plot.ctx, { width, height } = pen.canvas;
  const points = pen.getImageData(0, 0, width, height).data;
  for (let at = 3; at < points.length; at += 4) if (points[at] > 0) return false;
  return true;
}).map(({ described }) => described.title)"""


@pytest.fixture(scope="module")
def made(tmp_path_factory, runs):
    """A page of each kind."""
    folder = tmp_path_factory.mktemp("paper")
    acroscope("diagnose", ROOT / "examples" / "hidden-effect", "--out", folder / "diagnosis")
    acroscope("reproduce", "C1", "C9", "C10", "--out", folder / "reproduction")
    grid = ["--grid", "camera.T_delay=0:0.06:0.02", "--stop", 2, "--until", "plant.contact"]
    acroscope("sweep", "visual-servo", *grid, "--out", folder / "sweep")
    acroscope("check", ROOT / "target" / "fmus" / "signal_effects.fmu", "--out", folder / "check")
    pages = {name: folder / name / "report.html" for name in ("diagnosis", "sweep", "check")}
    study = next((folder / "reproduction" / "studies").glob("figures-4-8.html"))
    return pages | {"run": runs / "balanced" / "report.html", "index": folder / "reproduction" / "index.html", "study": study}


@pytest.mark.parametrize("kind", ["run", "diagnosis", "index", "study", "sweep", "check"])
def test_nothing_is_cut_on_paper(made, look, kind):
    # From a wide window, as a reader prints: graphs are as wide as that before.
    page = look(made[kind], 1280, 900, "dark")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print", color_scheme="dark")
    page.set_viewport_size({"width": PAPER, "height": 1000})
    assert page.evaluate(CUT) == []
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert [one for one in page.locator("button, input[type=search]").all() if one.is_visible()] == []
    if page.locator("#graphs").count():
        assert page.evaluate(BLANK) == []


@pytest.mark.parametrize("kind", ["run", "sweep"])
def test_graphs_fit_before_the_browser_prints(made, look, kind):
    page = look(made[kind], 1280, 900)
    wide = page.evaluate("Math.max(...acro.graphs.map(({ plot }) => plot.width))")
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    # At once: an observer would come too late.
    assert page.evaluate("Math.max(...acro.graphs.map(({ plot }) => plot.width))") <= 640
    page.evaluate("dispatchEvent(new Event('afterprint'))")
    assert page.evaluate("Math.max(...acro.graphs.map(({ plot }) => plot.width))") == wide
    assert kind != "sweep" or wide > PAPER, "the graph of the sweep no longer is wider than paper: take another one"


def test_a_legend_on_paper_has_no_empty_values(made, look):
    page = look(made["run"], 1280, 900)
    page.emulate_media(media="print")
    ends = page.evaluate("[...document.querySelectorAll('.u-legend th')].map((one) => getComputedStyle(one, '::after').content)")
    assert ends and set(ends) <= {'""', "none"}
    assert [one for one in page.locator(".u-legend .u-value").all() if one.is_visible()] == []
